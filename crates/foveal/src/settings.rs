//! The settings of a frame: one struct that the library, the program's flags and a TOML file share.
//! In each enum the first variant is the default.

use serde::{Deserialize, Serialize};

use crate::Error;

mod coarse;
mod define;
mod eye;
mod reduced;
mod stereo;
mod variable;

pub use coarse::{
    Backend, COARSEST_LEVEL, CoarseSample, Composite, RateCombine, RateSource, RefineEdges, Shading,
};
use define::settings;
pub use define::{Kind, Setting, variant_names};
pub use eye::Display;
pub use stereo::{EyeClipping, LensProfile, Output, Stereo};
pub use variable::{Contrast, Geometry, RateStage};

/// Objects that the renderer submits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Culling {
    /// Objects in the camera's frustum.
    #[default]
    Frustum,
    /// Objects in the camera's frustum that no nearer surface hides.
    Occlusion,
    /// All objects: the reference.
    Off,
}

/// Sharing of one occlusion test between two eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CullingEyes {
    /// One exact test per eye. An object is drawn if either eye sees it.
    #[default]
    Each,
    /// One test for both eyes. It holds everywhere in the smallest sphere that contains both.
    /// Occluders are rasterized once and hide less.
    Shared,
}

/// Content of the picture: the finished frame or a debug view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// The finished frame.
    #[default]
    Final,
    /// Distance from the eye along the view axis on a logarithmic scale; near is white.
    Depth,
    /// World-space shading normals; (n + 1) / 2 as RGB.
    Normals,
    /// Base colour without light.
    BaseColor,
    /// One colour per instance.
    Instances,
    /// Motion since the previous frame: red is right, green is down. Mid-grey is no motion, full
    /// scale is 16 pixels.
    Motion,
    /// White pixels where anti-aliasing shades more than once.
    Edges,
    /// Samples that anti-aliasing shades per pixel: black is one, then blue through red to white
    /// for all sub-samples.
    Samples,
    /// The finished frame under one colour per level of coarse shading; white where every pixel is
    /// shaded.
    Rate,
    /// The finished frame with the outlines of coarse shading's blocks.
    Blocks,
    /// The finished frame where a sample was shaded, dark elsewhere.
    Shaded,
    /// The finished frame with variable shading's knowledge: red where no earlier value was found,
    /// green where a value was measured again.
    Unknown,
    /// One colour per material: the bins of the visibility buffer.
    Bins,
}

impl View {
    /// Whether this view needs lighting.
    pub(crate) fn is_lit(self) -> bool {
        match self {
            Self::Final | Self::Rate | Self::Blocks | Self::Shaded | Self::Unknown => true,
            Self::Depth | Self::Normals | Self::BaseColor | Self::Instances | Self::Motion => false,
            Self::Edges | Self::Samples | Self::Bins => false,
        }
    }
}

/// Materials of a visibility buffer that one dispatch resolves. The picture is the same to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialDispatch {
    /// The faster way on this device: `Material` on lavapipe, `Family` elsewhere.
    #[default]
    Auto,
    /// All materials that share a shader variant, texture arrays and samplers.
    Family,
    /// One material.
    Material,
}

/// Smoothing of edges. See `docs/antialiasing.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Antialiasing {
    /// One sample at each pixel's centre.
    #[default]
    None,
    /// Every sub-sample is shaded: the reference.
    Ssaa,
    /// One sample per surface that a pixel shows: several at edges, one elsewhere.
    Msaa,
}

/// Placement of a pixel's sub-samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplePattern {
    /// A regular grid of n x n, drawn at n times the resolution.
    #[default]
    Grid,
    /// A rotated grid of 4 or 8 samples, no two in one row or column. The scene is drawn once per
    /// sample.
    Rotated,
}

/// Pixels that [`Antialiasing::Msaa`] treats as edges, and the sub-samples that it shades there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeTest {
    /// Pixels whose sub-samples differ in instance, plane or direction. One sample is shaded per
    /// surface and weighted by coverage.
    #[default]
    Surface,
    /// Pixels whose reversed depths differ by more than 1e-4, as in the technique's source. All
    /// sub-samples are shaded.
    Paper,
    /// No pixels. Only the first sub-sample is shaded, as in the source's mode 'none'.
    Never,
}

/// Reflection of light by surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightingModel {
    /// glTF's metallic-roughness model: Lambert and GGX.
    #[default]
    Ggx,
    /// Lambert and Blinn-Phong, as in the techniques' sources.
    BlinnPhong,
}

/// Lights that a sample evaluates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightAssignment {
    /// Lights whose range touches the sample's cluster (froxel).
    #[default]
    Clustered,
    /// All lights: the reference.
    Brute,
}

/// Curve from scene radiance to display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// A filmic curve fitted to the ACES reference transform.
    #[default]
    Aces,
    /// Identity, clipped at 1.
    Linear,
}

settings! {
    /// All settings of a frame.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
    pub struct Settings {
        "Picture" {
            /// Width of one eye's picture in pixels. The device's texture limit is the largest
            /// value.
            width: u32 = 1280, "Width", Kind::Integer { least: 1, most: 16384 };
            /// Height of the picture in pixels. The device's texture limit is the largest value.
            height: u32 = 720, "Height", Kind::Integer { least: 1, most: 16384 };
            /// Fraction of the picture's width and height at which the frame is drawn, 0.5 to 1.
            /// The frame is stretched to full size last. Lower it for speed; 1 draws every pixel.
            render_scale: f32 = 1.0, "Render scale", Kind::Number { least: 0.5, most: 1.0 };
            /// Content of the picture: final is the finished frame, all others are debug views.
            view: View = View::default(), "View", Kind::choice::<View>();
            /// Exposure in stops, applied before the tone map. +1 doubles the light, -1 halves it,
            /// 0 leaves it as it is.
            exposure: f32 = 0.0, "Exposure", Kind::Number { least: -8.0, most: 8.0 };
            /// Curve from scene light to display values: aces rolls off bright light as film does,
            /// linear clips at 1.
            tone_map: ToneMap = ToneMap::default(), "Tone map", Kind::choice::<ToneMap>();
        }
        "Culling" {
            /// Objects that are submitted: frustum takes those in view, occlusion only those in
            /// view that nothing hides, off takes all (the reference). The picture is the same.
            culling: Culling = Culling::default(), "Culling", Kind::choice::<Culling>();
            /// Smallest apparent size of an occluder. Smaller objects hide nothing: culling is then
            /// faster and finds less. An object is too small if radius^2 < distance * size^2 *
            /// tan(fov / 2), the measure of Intel's sample, which uses 1.5. 0 uses every occluder.
            occluder_size: f32 = 0.0, "Occluder size", Kind::Number { least: 0.0, most: 5.0 };
            /// Smallest apparent size of an object that is drawn, by the same measure as
            /// occluder-size. Above 0 small objects disappear from the picture; Intel's sample uses
            /// 0.01. 0 draws every visible object.
            occludee_size: f32 = 0.0, "Object size", Kind::Number { least: 0.0, most: 1.0 };
            /// Picture pixels per occlusion buffer pixel, on each axis. 4 tests at the picture's
            /// own pixel centres, so the picture stays the same to the bit. Larger values may close
            /// gaps as thin as a pixel.
            occlusion_scale: u8 = 4, "Buffer scale", Kind::Integer { least: 1, most: 16 };
            /// Worker threads that rasterize occluders. 0 takes as many as the machine has.
            culling_threads: u8 = 0, "Threads", Kind::Integer { least: 0, most: 32 };
            /// Distance in metres that the eye may move, without turning, before culling runs
            /// again. Larger values hide slightly less. 0 runs culling in every frame.
            culling_radius: f32 = 0.0, "Valid for (m)", Kind::Number { least: 0.0, most: 1.0 };
            /// Occlusion tests with two eyes: each tests every eye by itself, shared runs one test
            /// for both, which hides less. The picture is the same.
            culling_eyes: CullingEyes = CullingEyes::default(), "Two eyes", Kind::choice::<CullingEyes>();
            /// Time in milliseconds after which no further occluder is rasterized. The nearest
            /// occluders come first; a missing one only causes more objects to be drawn. 0 sets no
            /// limit, and a host without a clock has none.
            culling_budget: f32 = 0.0, "Budget (ms)", Kind::Number { least: 0.0, most: 10.0 };
        }
        "Geometry" {
            /// Way to fill the G-buffer: gbuffer evaluates materials as it rasterizes; visibility
            /// rasterizes triangle numbers and resolves materials once per pixel. The picture is
            /// the same but for rounding. Use visibility to resolve materials at a shading rate.
            geometry: Geometry = Geometry::default(), "Path", Kind::choice::<Geometry>();
            /// Materials of a visibility buffer that one dispatch resolves: material takes one,
            /// family all that share shader, texture arrays and samplers. auto takes material on
            /// lavapipe (Mesa's driver for the CPU), family elsewhere. The picture is the same.
            material_dispatch: MaterialDispatch = MaterialDispatch::default(), "Material dispatch", Kind::choice::<MaterialDispatch>();
            /// Merging of equal meshes with equal materials into instances of one draw. Off: every
            /// object is a draw of its own, as for measurements of many draws.
            merge_draws: bool = true, "Merge draws", Kind::Switch;
        }
        "Lighting" {
            /// Reflection model: ggx is glTF's metallic-roughness model, blinn-phong the one that
            /// the techniques' sources use.
            lighting: LightingModel = LightingModel::default(), "Model", Kind::choice::<LightingModel>();
            /// Lights that a sample evaluates: clustered takes those that reach its part of the
            /// view, brute takes all (the reference). The picture is the same.
            lights: LightAssignment = LightAssignment::default(), "Lights", Kind::choice::<LightAssignment>();
            /// Largest anisotropy of texture filtering, 1 to 16. Higher values keep textures sharp
            /// at flat angles. Lavapipe always takes 1: its own anisotropic filter can take minutes
            /// for one triangle.
            anisotropy: u16 = 8, "Anisotropy", Kind::Integer { least: 1, most: 16 };
        }
        "Anti-aliasing" {
            /// Smoothing of edges: none, ssaa shades every sub-sample (the reference), msaa shades
            /// once per surface that a pixel shows.
            aa: Antialiasing = Antialiasing::default(), "Mode", Kind::choice::<Antialiasing>();
            /// Sub-samples per pixel: 4, 9, 16, ... up to 256 for the grid pattern (16 with msaa),
            /// 4 or 8 for the rotated pattern. More are smoother and slower.
            samples: u32 = 4, "Sub-samples", Kind::Integer { least: 4, most: 256 };
            /// Placement of the sub-samples: grid is regular, rotated has no two in one row or
            /// column.
            pattern: SamplePattern = SamplePattern::default(), "Pattern", Kind::choice::<SamplePattern>();
            /// Pixels that msaa treats as edges: surface takes pixels with several surfaces, paper
            /// those that differ in depth (as the technique's source does), never none.
            edge_test: EdgeTest = EdgeTest::default(), "Edge test", Kind::choice::<EdgeTest>();
        }
        "Shading rate" {
            /// Number of lighting samples: full takes one per pixel (the reference), coarse one per
            /// block of pixels, larger away from the gaze, variable one per 1x1 to 2x2 pixels as
            /// the content allows.
            shading: Shading = Shading::default(), "Shading", Kind::choice::<Shading>();
        }
        "Eye" {
            /// Display on which the picture is seen. Shading rates follow from its field of view:
            /// camera (the camera's own, as in a headset), hmd (92 degrees), h60 (60), fhd-24,
            /// uhd-27, quest-3, vision-pro, phone, degrees across, or WIDTHxDISTANCE in metres.
            display: String = "camera".to_owned(), "Display", Kind::Text;
            /// Quality in JOD at which coarse shading aims: 10 is no visible difference from full
            /// shading, 9 one that 75 % of observers would see. Lower it for speed; 9.5 suits
            /// observers who look for differences.
            quality: f32 = 9.5, "Quality", Kind::Number { least: 5.0, most: 10.0 };
            /// Point that the eye looks at, as fractions of the picture from its top left corner.
            /// The default is the centre.
            gaze: [f32; 2] = [0.5, 0.5], "Gaze", Kind::Place;
        }
        "Coarse shading" {
            /// Method that visits the samples of coarse shading: stencil draws level by level,
            /// compute dispatches over lists of blocks. auto times both in the first frames and
            /// keeps the faster.
            backend: Backend = Backend::default(), "Backend", Kind::choice::<Backend>();
            /// Coarsest level, 0 to 8: blocks have at most 2^N pixels a side. Lower it to limit the
            /// size of blocks.
            coarsest_level: u8 = COARSEST_LEVEL, "Coarsest level", Kind::Integer { least: 0, most: 8 };
            /// Source of the requested level: foveated (the eye's resolution on the display), radii
            /// (distance to the gaze), constant, image (black: every pixel, white: level 8), lens
            /// (of the headset output) or content (contrast of the previous frame, only with
            /// variable shading).
            rate: RateSource = RateSource::default(), "Rate from", Kind::choice::<RateSource>();
            /// Second source of the requested level. It counts only if rate-combine is coarser or
            /// finer.
            rate_other: RateSource = RateSource::Constant, "Second source", Kind::choice::<RateSource>();
            /// Use of the second source: first ignores it, coarser and finer take the coarser or
            /// finer level of both sources at each pixel.
            rate_combine: RateCombine = RateCombine::default(), "Combine", Kind::choice::<RateCombine>();
            /// Level that the source constant requests, 0 to 8: one sample per 2^N x 2^N pixels.
            rate_level: u8 = 0, "Constant level", Kind::Integer { least: 0, most: 8 };
            /// Picture of the source image. The library opens no files: the host hands the pixels
            /// to the renderer.
            rate_image: String = String::new(), "Image", Kind::File;
            /// Radius around the gaze within which every pixel is shaded, in picture heights. For
            /// the source radii.
            fovea_inner: f32 = 0.125, "Fovea", Kind::Number { least: 0.0, most: 1.0 };
            /// Radius from which the coarsest level is requested, in picture heights. For the
            /// source radii.
            fovea_outer: f32 = 0.9, "Periphery", Kind::Number { least: 0.0, most: 2.0 };
            /// Growth of the levels between both radii: 1 grows in even steps, more in steps that
            /// widen outwards. For the source radii.
            fovea_curve: f32 = 1.5, "Curve", Kind::Number { least: 0.1, most: 10.0 };
            /// Limit of one level between neighbouring blocks. Off: blocks of any sizes may touch.
            rate_balance: bool = true, "Balance", Kind::Switch;
            /// Finer shading at geometric edges: graded shades all edges one level finer (two where
            /// samples hold colours), inner shades edges near the gaze pixel by pixel, everywhere
            /// shades all edges so, off leaves them as requested.
            refine_edges: RefineEdges = RefineEdges::default(), "Refine edges", Kind::choice::<RefineEdges>();
            /// Pixel of a block that its sample shades: center takes the one at the centre, typical
            /// the most typical of five.
            coarse_sample: CoarseSample = CoarseSample::default(), "Sample", Kind::choice::<CoarseSample>();
            /// Reconstruction of pixels from samples: light puts each pixel's own surface into the
            /// samples' light; the others join colours, smooth by continuous patches, paper by the
            /// four taps of the technique's source, nearest not at all.
            composite: Composite = Composite::default(), "Composite", Kind::choice::<Composite>();
            /// Light history: light is kept per pixel from frame to frame, reprojected by motion
            /// and reshaded step by step. Off: every sample is reshaded in every frame. Works with
            /// the composite light and samples at centres, and not with the stencil backend.
            history: bool = true, "Keep light", Kind::Switch;
        }
        "Shading at a rate" {
            /// Work done once per sample instead of once per pixel: lighting, material (only with
            /// variable shading) or both. Materials need the visibility geometry. auto takes both
            /// where it is possible, else lighting.
            rate_stage: RateStage = RateStage::default(), "Stage", Kind::choice::<RateStage>();
        }
        "Variable shading" {
            /// Measure of contrast: quad takes differences within 2x2 pixels, neighbors to the four
            /// neighbours, sobel Sobel kernels of 3x3 pixels.
            contrast: Contrast = Contrast::default(), "Contrast", Kind::choice::<Contrast>();
            /// Contrast above which every pixel is shaded: a difference of display luma divided by
            /// the local mean + 0.1. Raise it for speed, lower it for quality.
            contrast_threshold: f32 = 0.04, "Threshold", Kind::Number { least: 0.0, most: 0.5 };
            /// Growth of the contrast threshold by motion: the part that is added per pixel that a
            /// place moves in a frame. 0 treats moving and resting places alike.
            velocity_gain: f32 = 0.1, "Velocity", Kind::Number { least: 0.0, most: 1.0 };
            /// Samples of up to 4x4 pixels. Off: 2x2 is the coarsest.
            rate_4x4: bool = false, "4x4", Kind::Switch;
            /// Keep shading at reduced rates even when that costs more than it saves. Off: it stops
            /// by itself.
            force_rate: bool = false, "Force", Kind::Switch;
        }
        "Stereo" {
            /// Number of eyes and the way to draw them. off draws one eye. Two eyes: instanced
            /// submits each draw once for both, multiview once with a layer for each, two-pass once
            /// per eye (the reference). auto takes the fastest of these that works on this device.
            stereo: Stereo = Stereo::default(), "Eyes", Kind::choice::<Stereo>();
            /// Method that keeps one eye's geometry out of the other eye's half of the target: clip
            /// uses a clip plane, discard drops fragments. auto takes the clip plane where the
            /// device has one.
            eye_clipping: EyeClipping = EyeClipping::default(), "Clipping", Kind::choice::<EyeClipping>();
            /// Distance between the eyes in metres.
            ipd: f32 = 0.063, "Eye distance", Kind::Number { least: 0.0, most: 0.2 };
            /// Distance in metres at which a point straight ahead has the same place in both eyes'
            /// pictures.
            convergence: f32 = 2.0, "Convergence", Kind::Number { least: 0.1, most: 20.0 };
            /// Frusta of both eyes as tangents: left, right, bottom and top of the left eye, then
            /// of the right eye, with commas between. Empty: the camera's frustum, shifted by the
            /// convergence.
            eye_tangents: String = String::new(), "Frusta", Kind::Text;
            /// Offset of the right eye's gaze from the left eye's, as fractions of the picture.
            gaze_shift: [f32; 2] = [0.0, 0.0], "Gaze shift", Kind::Place;
            /// Presentation of both eyes' pictures: flat shows the left eye, side-by-side and
            /// side-by-side-half both, anaglyph and anaglyph-dubois are for red-cyan glasses,
            /// headset distorts both against the lens.
            show: Output = Output::default(), "Output", Kind::choice::<Output>();
            /// Lens of the headset output: cardboard-v2, cardboard-v1, dk1, ideal, or the
            /// coefficients k1,k2,k3 and, where colours part, red's c0,c1 and blue's.
            lens: String = "cardboard-v2".to_owned(), "Lens", Kind::Text;
        }
    }
}

impl Settings {
    /// The same settings at the size at which the frame is drawn, before [`Settings::render_scale`]
    /// stretches it.
    #[must_use]
    pub fn drawn(&self) -> Self {
        let scaled = |pixels: u32| ((pixels as f32 * self.render_scale).round() as u32).max(1);
        Self {
            width: scaled(self.width),
            height: scaled(self.height),
            render_scale: 1.0,
            ..self.clone()
        }
    }

    /// Checks that the settings make sense and that a device with these limits can draw them.
    ///
    /// # Errors [`Error::Setting`] for a value that makes no sense, alone or beside the others;
    /// [`Error::Limit`] for one that the device cannot draw.
    pub fn validate(&self, limits: &wgpu::Limits) -> Result<(), Error> {
        let most = limits.max_texture_dimension_2d;
        for (name, value) in [("width", self.width), ("height", self.height)] {
            if value == 0 {
                return Err(Error::Setting {
                    name,
                    value: "0".to_owned(),
                    expected: "at least 1",
                });
            }
            if value > most {
                return Err(Error::Limit {
                    what: format!("the picture's {name} in pixels"),
                    value: u64::from(value),
                    limit: u64::from(most),
                    hint: String::new(),
                });
            }
        }
        if !self.exposure.is_finite() || self.exposure.abs() > 64.0 {
            let value = self.exposure.to_string();
            return Err(Error::Setting {
                name: "exposure",
                value,
                expected: "between -64 and 64",
            });
        }
        if !(0.5..=1.0).contains(&self.render_scale) {
            return Err(Error::Setting {
                name: "render-scale",
                value: self.render_scale.to_string(),
                expected: "between 0.5 and 1",
            });
        }
        if !(1..=16).contains(&self.anisotropy) {
            let value = self.anisotropy.to_string();
            return Err(Error::Setting {
                name: "anisotropy",
                value,
                expected: "between 1 and 16",
            });
        }
        for (name, value) in [
            ("occluder-size", self.occluder_size),
            ("occludee-size", self.occludee_size),
            ("culling-radius", self.culling_radius),
            ("culling-budget", self.culling_budget),
        ] {
            if !(0.0..=1e6).contains(&value) {
                return Err(Error::Setting {
                    name,
                    value: value.to_string(),
                    expected: "between 0 and 1000000",
                });
            }
        }
        for (name, value, range, expected) in [
            (
                "occlusion-scale",
                self.occlusion_scale,
                1..=16,
                "between 1 and 16",
            ),
            (
                "culling-threads",
                self.culling_threads,
                0..=32,
                "between 0 and 32",
            ),
        ] {
            if !range.contains(&value) {
                return Err(Error::Setting {
                    name,
                    value: value.to_string(),
                    expected,
                });
            }
        }
        if crate::gpu::is_reduced(limits) {
            reduced::validate(self)?;
        }
        coarse::validate(self)?;
        eye::validate(self)?;
        variable::validate(self)?;
        stereo::validate(self, limits)?;
        if self.shading == Shading::Coarse && self.composite == Composite::Smooth {
            crate::composite::check_limits(self, limits)?;
        }
        crate::antialias::validate(self, limits)
    }
}
