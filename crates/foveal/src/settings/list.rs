//! The list of all settings, from which struct, defaults, flags, panels and controls are made.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use super::choices::*;
use super::coarse::*;
#[cfg(feature = "serde")]
use super::define::Kind;
use super::define::settings;
use super::eye::*;
use super::stereo::*;
use super::variable::*;

settings! {
    /// Size and curve of the picture, and what it shows.
    "Picture" picture: PictureSettings {
        /// Width of one eye's picture in pixels. The device's texture limit is the largest
        /// value.
        width => width: u32 = 1280, "Width", Kind::Integer { least: 1, most: 16384 };
        /// Height of the picture in pixels. The device's texture limit is the largest value.
        height => height: u32 = 720, "Height", Kind::Integer { least: 1, most: 16384 };
        /// Fraction of the picture's width and height at which the frame is drawn, 0.5 to 1.
        /// The frame is stretched to full size last. Lower it for speed; 1 draws every pixel.
        render_scale => render_scale: f32 = 1.0, "Render scale", Kind::Number { least: 0.5, most: 1.0 };
        /// Content of the picture: final is the finished frame, all others are debug views.
        view => view: DebugView = DebugView::default(), "View", Kind::choice::<DebugView>();
        /// Exposure in stops, applied before the tone map. +1 doubles the light, -1 halves it,
        /// 0 leaves it as it is.
        exposure => exposure_stops: f32 = 0.0, "Exposure", Kind::Number { least: -8.0, most: 8.0 };
        /// Curve from scene light to display values: aces rolls off bright light as film does,
        /// linear clips at 1.
        tone_map => tone_map: ToneMap = ToneMap::default(), "Tone map", Kind::choice::<ToneMap>();
    }
    /// Objects that are submitted.
    "Culling" culling: CullingSettings {
        /// Objects that are submitted: frustum takes those in view, occlusion only those in
        /// view that nothing hides, and leaves out shadow casters that nobody would miss; off takes
        /// all (the reference). auto is occlusion while that hides ten times as many triangles as it
        /// rasterizes, or shadows are on, else frustum. The picture is the same.
        culling => mode: Culling = Culling::default(), "Culling", Kind::choice::<Culling>();
        /// Smallest apparent size of an occluder. Smaller objects hide nothing: culling is then
        /// faster and finds less. An object is too small if radius^2 < distance * size^2 *
        /// tan(fov / 2), the measure of Intel's sample, which uses 1.5. 0 leaves out
        /// no occluder for its size.
        occluder_size => occluder_size: f32 = 0.0, "Occluder size", Kind::Number { least: 0.0, most: 5.0 };
        /// Smallest apparent size of an object that is drawn, by the same measure as
        /// occluder-size. Above 0 small objects disappear from the picture; Intel's sample uses
        /// 0.01. 0 draws every visible object.
        occludee_size => occludee_size: f32 = 0.0, "Object size", Kind::Number { least: 0.0, most: 1.0 };
        /// Picture pixels per occlusion buffer pixel, on each axis. 4 and 1 test at the picture's
        /// own pixel centres, other values at every point of the picture, which hides less. The
        /// picture is the same.
        occlusion_scale => buffer_scale: u8 = 4, "Buffer scale", Kind::Integer { least: 1, most: 16 };
        /// Threads that rasterize occluders. 0 takes as many as the machine has, up to 8.
        culling_threads => threads: u8 = 0, "Threads", Kind::Integer { least: 0, most: 32 };
        /// Distance in metres that the eye may move, without turning, before culling runs
        /// again. Larger values hide slightly less. 0 runs culling in every frame.
        culling_radius => radius_m: f32 = 0.0, "Valid for (m)", Kind::Number { least: 0.0, most: 1.0 };
        /// Occlusion tests with two eyes: each tests every eye by itself, shared runs one test
        /// for both, which hides less. The picture is the same.
        culling_eyes => eyes: CullingEyes = CullingEyes::default(), "Two eyes", Kind::choice::<CullingEyes>();
        /// Time in milliseconds after which no further occluder is rasterized. The nearest
        /// occluders come first; a missing one only causes more objects to be drawn. 0 sets no
        /// limit, and a host without a clock has none.
        culling_budget => budget_ms: f32 = 0.0, "Budget (ms)", Kind::Number { least: 0.0, most: 10.0 };
    }
    /// The way to the G-buffer.
    "Geometry" geometry: GeometrySettings {
        /// Way to fill the G-buffer: gbuffer evaluates materials as it rasterizes; visibility
        /// rasterizes triangle numbers and resolves materials once per pixel. The picture is
        /// the same but for rounding and for minified textures, whose filters get each pixel's own
        /// derivatives instead of those of 2 x 2 pixels. Use visibility to resolve materials at a
        /// shading rate.
        geometry => path: Geometry = Geometry::default(), "Path", Kind::choice::<Geometry>();
        /// Materials of a visibility buffer that one dispatch resolves: material takes one,
        /// family all that share shader, texture arrays and samplers. auto takes material on
        /// lavapipe (Mesa's driver for the CPU), family elsewhere. The picture is the same.
        material_dispatch => material_dispatch: MaterialDispatch = MaterialDispatch::default(), "Material dispatch", Kind::choice::<MaterialDispatch>();
        /// Merging of equal meshes with equal materials into instances of one draw. Off: every
        /// object is a draw of its own, as for measurements of many draws.
        merge_draws => merge_draws: bool = true, "Merge draws", Kind::Switch;
        /// Side of points in pixels of the picture, at any distance. Points are squares that face
        /// the eye, at least a pixel of what is drawn. Raise it where a cloud of points is too thin
        /// to be seen.
        point_size => point_size_px: f32 = 1.0, "Point size", Kind::Number { least: 1.0, most: 64.0 };
        /// Width of lines in pixels of the picture, at any distance; at least a pixel of what is
        /// drawn.
        line_width => line_width_px: f32 = 1.0, "Line width", Kind::Number { least: 1.0, most: 64.0 };
    }
    /// Reflection, lights and textures.
    "Lighting" lighting: LightingSettings {
        /// Reflection model: ggx is glTF's metallic-roughness model, blinn-phong the one that
        /// the techniques' sources use.
        lighting => model: LightingModel = LightingModel::default(), "Model", Kind::choice::<LightingModel>();
        /// Light that bounces more than once between the microfacets of rough surfaces: on counts it,
        /// which brightens rough metals and deepens their colour. Off: it is lost, as in glTF's
        /// own model. For the model ggx, and the environment.
        multiple_scattering => multiple_scattering: bool = true, "Multiple scattering", Kind::Switch;
        /// Lights that a sample evaluates: clustered takes those that reach its part of the
        /// view, brute takes all (the reference). The picture is the same.
        lights => assignment: LightAssignment = LightAssignment::default(), "Lights", Kind::choice::<LightAssignment>();
        /// Kind of the passes that light every pixel, find its rate, or reproject its kept light:
        /// fragment draws, compute dispatches. auto takes compute on graphics cards of their own,
        /// fragment elsewhere. The picture is the same but for rounding.
        lighting_pass => pass: LightingPass = LightingPass::default(), "Pass", Kind::choice::<LightingPass>();
        /// Shadows of all lights: off lets light pass through everything, hard compares once per
        /// light and sample, soft nine times, which smooths edges over three texels. contact fades
        /// with the distance from what casts the shadow, as by lamps with a size.
        shadows => shadows: Shadows = Shadows::default(), "Shadows", Kind::choice::<Shadows>();
        /// Side of the shadow atlas in texels, rounded down to a power of two. It takes 4 bytes a
        /// texel: 4096 takes 64 MiB. Where it is full, all shadows become coarser alike.
        shadow_atlas => shadow_atlas: u32 = 4096, "Shadow atlas", Kind::Integer { least: 256, most: 8192 };
        /// Pixels of the picture that a texel covers where most of a point or spot light's shadows are
        /// seen. Lower it for sharper shadows, as far as the atlas has room: half of it takes four
        /// times the texels. The default leaves most of 4096 x 4096 free at 1280x720.
        shadow_texel => shadow_texel_px: f32 = 2.0, "Shadow texel (px)", Kind::Number { least: 0.5, most: 8.0 };
        /// Offset of surfaces along their normals before they are compared with the atlas, in
        /// texels. Raise it where surfaces show stripes, lower it where shadows begin away from
        /// what casts them.
        shadow_bias => shadow_bias: f32 = 1.5, "Shadow bias", Kind::Number { least: 0.0, most: 8.0 };
        /// Size of shadow tiles with coarse shading by the eye's resolution: view makes them as fine
        /// as for full shading, rate as coarse as the samples that show them, which leaves more of a
        /// small atlas for what is seen sharply. Other ways of shading always take view.
        shadow_sizes => shadow_sizes: ShadowSizes = ShadowSizes::default(), "Shadow sizes", Kind::choice::<ShadowSizes>();
        /// Triangles that a frame draws into shadow tiles; 0 sets no limit. A frame stops after the
        /// tile by which it has drawn so many. Tiles that wait show shadows of some frames before, or
        /// of another size, or none yet. A scene's first frame draws all tiles, and tiles of a light
        /// that has moved do not wait.
        shadow_budget => shadow_budget: u32 = 0, "Shadow budget", Kind::Integer { least: 0, most: 100_000_000 };
        /// Radius of point and spot lamps in metres, by which contact shadows fade.
        light_radius => light_radius_m: f32 = 0.05, "Lamp radius", Kind::Number { least: 0.0, most: 0.5 };
        /// Angle in degrees that directional lights fill in the sky, by which contact shadows fade.
        /// The sun fills 0.53.
        sun_angle => sun_angle_deg: f32 = 0.53, "Sun angle", Kind::Number { least: 0.0, most: 10.0 };
        /// Light from all around: scene is what the scene's file has, else gradient, which is a sky
        /// as a formula; sky is the same filtered by roughness, image a picture of all directions,
        /// none is black. On the command line also the name of a .hdr or .exr file. With gradient
        /// rough metals mirror a hard horizon.
        environment => environment: EnvironmentSource = EnvironmentSource::default(), "Environment", Kind::choice::<EnvironmentSource>();
        /// Picture of the environment image: an equirectangular .hdr or .exr file that the program
        /// opens. Hosts of the library pass its radiance to the renderer themselves.
        environment_image => environment_image: String = String::new(), "Environment file", Kind::File;
        /// Factor by which the radiance of the environment is multiplied, background included.
        environment_intensity => environment_intensity: f32 = 1.0, "Environment light", Kind::Number { least: 0.0, most: 8.0 };
        /// Angle in degrees by which the environment is turned about the vertical axis,
        /// counter-clockwise as seen from above. Gradient and sky look the same from all sides.
        environment_rotation => environment_rotation_deg: f32 = 0.0, "Environment turn", Kind::Number { least: -180.0, most: 180.0 };
        /// What is seen behind all surfaces: environment, blurred (as in a rough mirror; a gradient
        /// stays as it is) or none (black). Light and reflections stay the same.
        background => background: Background = Background::default(), "Background", Kind::choice::<Background>();
        /// Occlusion of the environment's light by what lies around: screen finds it in the
        /// picture's depth, at the shading rate; off leaves the file's own maps alone. The light of
        /// lights is never dimmed by it.
        ambient_occlusion => ambient_occlusion: AmbientOcclusion = AmbientOcclusion::default(), "Ambient occlusion", Kind::choice::<AmbientOcclusion>();
        /// Distance in metres up to which surfaces occlude the environment for each other. Larger
        /// values darken wider and miss thin gaps. 0 takes a tenth of the scene's diagonal.
        ambient_occlusion_radius => ambient_occlusion_radius_m: f32 = 0.0, "Occlusion to (m)", Kind::Number { least: 0.0, most: 10.0 };
        /// Largest anisotropy of texture filtering, 1 to 16. Higher values keep textures sharp
        /// at flat angles. Lavapipe always takes 1: its own anisotropic filter can take minutes
        /// for one triangle.
        anisotropy => anisotropy: u16 = 8, "Anisotropy", Kind::Integer { least: 1, most: 16 };
    }
    /// Smoothing of edges.
    "Anti-aliasing" antialiasing: AntialiasingSettings {
        /// Smoothing of edges: none, ssaa shades every sub-sample (the reference), msaa shades
        /// once per surface that a pixel shows.
        aa => mode: Antialiasing = Antialiasing::default(), "Mode", Kind::choice::<Antialiasing>();
        /// Sub-samples per pixel: 4, 9, 16, ... up to 256 for the grid pattern (16 with msaa),
        /// 4 or 8 for the rotated pattern. More are smoother and slower.
        samples => samples: u32 = 4, "Sub-samples", Kind::Integer { least: 4, most: 256 };
        /// Placement of the sub-samples: grid is regular, rotated has no two in one row or
        /// column.
        pattern => pattern: SamplePattern = SamplePattern::default(), "Pattern", Kind::choice::<SamplePattern>();
        /// Pixels that msaa treats as edges: surface takes those with several surfaces, paper those
        /// that differ in depth (as the original method does), never takes none.
        edge_test => edge_test: EdgeTest = EdgeTest::default(), "Edge test", Kind::choice::<EdgeTest>();
    }
    /// The number of samples that are shaded.
    "Shading" shading: ShadingSettings {
        /// Number of lighting samples: full takes one per pixel (the reference), coarse one per
        /// block of pixels, larger away from the gaze, variable one per 1x1 to 2x2 pixels,
        /// or to 4x4 with rate-4x4. With variable, rate content makes samples as fine as the
        /// picture's contrast asks for.
        shading => mode: Shading = Shading::default(), "Mode", Kind::choice::<Shading>();
    }
    /// The eye, its display, and the difference that it may see.
    "Eye" eye: EyeSettings {
        /// Display on which the picture is seen. Shading rates follow from its field of view:
        /// camera (the camera's own, as in a headset), hmd (91.5 degrees), h60 (60), fhd-24,
        /// uhd-27, quest-3, vision-pro, phone, degrees across, or WIDTHxDISTANCE in metres.
        display => display: Display = Display::Camera, "Display", Kind::Text;
        /// Quality in JOD at which coarse shading aims: 10 is no visible difference from full
        /// shading, 9 one that 75 % of observers would see. Lower it for speed, down to 9.1: blocks
        /// grow no further below. Pictures meet the default, 9.5, on average; the hardest that are
        /// known come to 8.9. In motion, with history, videos are measured at 9.0 to 10.
        quality => quality_jod: f32 = 9.5, "Quality", Kind::Number { least: 5.0, most: 10.0 };
        /// Point that the eye looks at, as fractions of the picture from its top left corner.
        /// The default is the centre.
        gaze => gaze: [f32; 2] = [0.5, 0.5], "Gaze", Kind::Place;
    }
    /// Samples of blocks of pixels.
    "Coarse shading" coarse: CoarseSettings {
        /// Method that visits the samples of coarse shading: stencil draws level by level,
        /// compute dispatches over lists of blocks. auto times both in the first frames and
        /// keeps the faster.
        backend => backend: CoarseBackend = CoarseBackend::default(), "Backend", Kind::choice::<CoarseBackend>();
        /// Coarsest level, 0 to 8: blocks have at most 2^N pixels a side. Lower it to limit the
        /// size of blocks.
        coarsest_level => coarsest_level: u8 = COARSEST_LEVEL, "Coarsest level", Kind::Integer { least: 0, most: 8 };
        /// Source of the requested level: foveated (the eye's resolution on the display), radii
        /// (distance to the gaze), constant, image (black: every pixel, white: level 8), lens
        /// (of the headset output) or content (contrast of the previous frame, only with
        /// variable shading).
        rate => source: RateSource = RateSource::default(), "Rate from", Kind::choice::<RateSource>();
        /// Second source of the requested level. It counts only if rate-combine is coarser or
        /// finer.
        rate_other => other_source: RateSource = RateSource::Constant, "Second source", Kind::choice::<RateSource>();
        /// Use of the second source: first ignores it, coarser and finer take the coarser or
        /// finer level of both sources at each pixel.
        rate_combine => combine: RateCombine = RateCombine::default(), "Combine", Kind::choice::<RateCombine>();
        /// Level that the source constant requests, 0 to 8: one sample per 2^N x 2^N pixels.
        rate_level => constant_level: u8 = 0, "Constant level", Kind::Integer { least: 0, most: 8 };
        /// Picture of the source image: a file that the program opens. Hosts of the library pass
        /// the pixels to the renderer themselves.
        rate_image => image_name: String = String::new(), "Image", Kind::File;
        /// Radius around the gaze within which every pixel is shaded, in picture heights. For
        /// the source radii.
        fovea_inner => fovea_inner: f32 = 0.125, "Fovea", Kind::Number { least: 0.0, most: 1.0 };
        /// Radius from which the coarsest level is requested, in picture heights. For the
        /// source radii.
        fovea_outer => fovea_outer: f32 = 0.9, "Periphery", Kind::Number { least: 0.0, most: 2.0 };
        /// Growth of the levels between both radii: 1 grows in even steps, more in steps that
        /// widen outwards. For the source radii.
        fovea_curve => fovea_curve: f32 = 1.5, "Curve", Kind::Number { least: 0.1, most: 10.0 };
        /// Limit of one level between neighbouring blocks. Off: blocks of any sizes may touch.
        rate_balance => balance: bool = true, "Balance", Kind::Switch;
        /// Finer shading at geometric edges: graded shades all edges one level finer (two where
        /// samples hold colours), inner shades edges near the gaze pixel by pixel, everywhere
        /// shades all edges pixel by pixel, off leaves them as requested. Where samples hold light,
        /// graded shades bumpy surfaces two levels finer as well.
        refine_edges => refine_edges: RefineEdges = RefineEdges::default(), "Refine edges", Kind::choice::<RefineEdges>();
        /// Pixel of a block that its sample shades: center takes the one at the centre, typical
        /// the most typical of five.
        coarse_sample => sample: CoarseSample = CoarseSample::default(), "Sample", Kind::choice::<CoarseSample>();
        /// Reconstruction of pixels from samples: light puts each pixel's own surface into the
        /// samples' light. The others use the samples' colours: smooth joins them by continuous
        /// patches, paper by the four taps of the original method, nearest leaves blocks of one
        /// colour.
        composite => composite: Composite = Composite::default(), "Composite", Kind::choice::<Composite>();
        /// Light history: light is kept per pixel from frame to frame, reprojected by motion
        /// and reshaded step by step. Off: every sample is reshaded in every frame. Works with
        /// the composite light and samples at centres, and not with the stencil backend.
        history => history: bool = true, "Keep light", Kind::Switch;
    }
    /// The work that is done once per sample.
    "Work per sample" rate: RateSettings {
        /// Work done once per sample instead of once per pixel: lighting, material (only with
        /// variable shading) or both. Materials need the visibility geometry. auto takes both
        /// where it is possible, else lighting.
        rate_stage => stage: RateStage = RateStage::default(), "Work", Kind::choice::<RateStage>();
        /// Keep coarse or variable shading on even where it costs more than it saves. Off: it
        /// turns itself off there, and every pixel is shaded.
        force_rate => force: bool = false, "Force", Kind::Switch;
    }
    /// Samples of up to four by four pixels, by content.
    "Variable shading" variable: VariableSettings {
        /// Measure of contrast: quad takes differences within 2x2 pixels, neighbors to the four
        /// neighbours, sobel Sobel kernels of 3x3 pixels.
        contrast => contrast: Contrast = Contrast::default(), "Contrast", Kind::choice::<Contrast>();
        /// Contrast above which every pixel is shaded: a difference of display luma divided by
        /// the local mean + 0.1. Raise it for speed, lower it for quality.
        contrast_threshold => threshold: f32 = 0.04, "Threshold", Kind::Number { least: 0.0, most: 0.5 };
        /// Growth of the contrast threshold by motion: the part that is added per pixel that a
        /// place moves in a frame. 0 treats moving and resting places alike.
        velocity_gain => velocity_gain: f32 = 0.1, "Velocity", Kind::Number { least: 0.0, most: 1.0 };
        /// Samples of up to 4x4 pixels. Off: 2x2 is the coarsest.
        rate_4x4 => blocks_4x4: bool = false, "4x4", Kind::Switch;
    }
    /// Two eyes.
    "Stereo" stereo: StereoSettings {
        /// Number of eyes and the way to draw them. off draws one eye. Two eyes: instanced
        /// submits each draw once for both, multiview once with a layer for each, two-pass once
        /// per eye (the reference). auto takes the fastest of these that works on this device.
        stereo => mode: Stereo = Stereo::default(), "Eyes", Kind::choice::<Stereo>();
        /// Method that keeps one eye's geometry out of the other eye's half of the target: clip
        /// uses a clip plane, discard drops fragments. auto takes the clip plane where the
        /// device has one.
        eye_clipping => clipping: EyeClipping = EyeClipping::default(), "Clipping", Kind::choice::<EyeClipping>();
        /// Distance between the eyes in metres.
        ipd => ipd_m: f32 = 0.063, "Eye distance", Kind::Number { least: 0.0, most: 0.2 };
        /// Distance in metres at which a point straight ahead has the same place in both eyes'
        /// pictures.
        convergence => convergence_m: f32 = 2.0, "Convergence", Kind::Number { least: 0.1, most: 20.0 };
        /// Frusta of both eyes as tangents: left, right, bottom and top of the left eye, then
        /// of the right eye, with commas between. Empty: the camera's frustum, shifted by the
        /// convergence.
        eye_tangents => frusta: EyeFrusta = EyeFrusta::Camera, "Frusta", Kind::Text;
        /// Offset of the right eye's gaze from the left eye's, as fractions of the picture.
        gaze_shift => gaze_shift: [f32; 2] = [0.0, 0.0], "Gaze shift", Kind::Place;
        /// Presentation of both eyes' pictures: flat shows the left eye, side-by-side and
        /// side-by-side-half both, anaglyph and anaglyph-dubois are for red-cyan glasses,
        /// headset distorts both against the lens.
        show => output: Output = Output::default(), "Output", Kind::choice::<Output>();
        /// Lens of the headset output: cardboard-v2, cardboard-v1, dk1, ideal, or the
        /// coefficients k1,k2,k3 and, where colours part, red's c0,c1 and blue's.
        lens => lens: Lens = Lens::CardboardV2, "Lens", Kind::Text;
    }
}

impl Settings {
    /// The same settings, changed: `Settings::default().with(|s| s.picture.width = 640)`.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Whether a scene that was set with the settings `before` must be set again for these to take
    /// full effect: its samplers are made with it, its occluders
    /// ([`Culling::has_occluders`](crate::Culling::has_occluders)), and with these and shadows what
    /// may receive shadows. Without occluders nothing is found hidden; without receivers no shadow
    /// caster is left out.
    #[must_use]
    pub fn needs_scene_again(&self, before: &Self) -> bool {
        let occludes = |s: &Self| s.culling.mode.has_occluders();
        self.lighting.anisotropy != before.lighting.anisotropy
            || occludes(self) && !occludes(before)
            || self.finds_receivers() && !before.finds_receivers()
    }

    /// Whether what may receive shadows is made with a scene that is set.
    pub(crate) fn finds_receivers(&self) -> bool {
        self.culling.mode.has_occluders() && self.lighting.shadows != Shadows::Off
    }

    /// The same settings at the size at which the frame is drawn, before
    /// [`PictureSettings::render_scale`](crate::PictureSettings::render_scale) stretches it.
    #[must_use]
    pub fn drawn(&self) -> Self {
        let scaled =
            |pixels: u32| ((pixels as f32 * self.picture.render_scale).round() as u32).max(1);
        self.clone().with(|s| {
            s.picture.width = scaled(s.picture.width);
            s.picture.height = scaled(s.picture.height);
            // Anything thinner would have gaps.
            for pixels in [&mut s.geometry.point_size_px, &mut s.geometry.line_width_px] {
                *pixels = (*pixels * self.picture.render_scale).max(1.0);
            }
            s.picture.render_scale = 1.0;
        })
    }
}
