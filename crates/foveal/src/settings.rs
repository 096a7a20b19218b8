//! Every choice that a user makes about a frame, as one struct that the library, the program's flags
//! and a TOML file share. Each stage's first variant is its default.

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

/// Which objects are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Culling {
    /// Those that the camera's frustum touches.
    #[default]
    Frustum,
    /// Of these, those that no nearer surface hides.
    Occlusion,
    /// All of them: the reference.
    Off,
}

/// Whom occlusion culling looks for where there are two eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CullingEyes {
    /// For each eye by itself, exactly; drawn is what either sees.
    #[default]
    Each,
    /// Once for both: what is hidden from everywhere around their middle as far as they are. Occluders are drawn once,
    /// and hide less.
    Shared,
}

/// What the written picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// The finished frame.
    #[default]
    Final,
    /// Distance from the eye along the view axis, near = white, on a logarithmic scale.
    Depth,
    /// World-space shading normals, (n + 1) / 2 as RGB.
    Normals,
    /// Base colour without light.
    BaseColor,
    /// A colour per instance.
    Instances,
    /// Motion since the last frame: red = right, green = down, 16 pixels to full scale around mid-grey.
    Motion,
    /// Pixels that anti-aliasing shades more than once: white.
    Edges,
    /// How often anti-aliasing shades each pixel: black once, then from blue through red to white for all
    /// sub-samples.
    Samples,
    /// The finished frame under a colour per level of coarse shading; white where each pixel is shaded.
    Rate,
    /// The finished frame with the borders of coarse shading's tiles.
    Blocks,
    /// The finished frame where it was shaded, dark elsewhere.
    Shaded,
    /// The finished frame under red where variable shading knew nothing of a place, green where it measured one anew.
    Unknown,
    /// A colour per material: the bins of a visibility buffer.
    Bins,
}

impl View {
    /// Whether lighting is evaluated for it.
    pub(crate) fn is_lit(self) -> bool {
        match self {
            Self::Final | Self::Rate | Self::Blocks | Self::Shaded | Self::Unknown => true,
            Self::Depth | Self::Normals | Self::BaseColor | Self::Instances | Self::Motion => false,
            Self::Edges | Self::Samples | Self::Bins => false,
        }
    }
}

/// How many materials of a visibility buffer one dispatch evaluates; the picture is the same to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialDispatch {
    /// What is the faster on this device: `Material` on lavapipe, else `Family`.
    #[default]
    Auto,
    /// All that share a shader variant, arrays of textures and samplers.
    Family,
    /// One.
    Material,
}

/// How edges are smoothed. See `docs/antialiasing.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Antialiasing {
    /// One sample at each pixel's centre.
    #[default]
    None,
    /// Every sub-sample is shaded: the reference.
    Ssaa,
    /// Pixels that several surfaces share are shaded once per surface, the others once.
    Msaa,
}

/// Where a pixel's sub-samples lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplePattern {
    /// A regular grid of n x n; drawn at n times the resolution.
    #[default]
    Grid,
    /// 4 or 8 samples, no two in one row or column: a rotated grid; drawn once per sample.
    Rotated,
}

/// Which pixels [`Antialiasing::Msaa`] takes for edges, and what it shades there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeTest {
    /// Sub-samples that differ in instance, plane or direction; shaded once per surface, weighted by coverage.
    #[default]
    Surface,
    /// The source's: reversed depths more than 1e-4 apart; all sub-samples are shaded.
    Paper,
    /// None; the first sub-sample alone is shaded: the source's 'none'.
    Never,
}

/// How light is reflected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightingModel {
    /// glTF's metallic-roughness model: Lambert + GGX.
    #[default]
    Ggx,
    /// Lambert + Blinn-Phong, as the techniques' sources use.
    BlinnPhong,
}

/// Which lights a sample looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightAssignment {
    /// Those whose range touches the sample's cluster (froxel).
    #[default]
    Clustered,
    /// All of them: the reference.
    Brute,
}

/// How scene radiance becomes display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// A filmic curve fitted to the ACES reference transform.
    #[default]
    Aces,
    /// Clipped at 1.
    Linear,
}

settings! {
    /// Everything that a user chooses about a frame.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
    pub struct Settings {
        "Picture" {
            /// Width of one eye's picture in pixels, 1 up to the device's limit
            width: u32 = 1280, "Width", Kind::Integer { least: 1, most: 16384 };
            /// Height in pixels, 1 up to the device's limit
            height: u32 = 720, "Height", Kind::Integer { least: 1, most: 16384 };
            /// Size at which the frame is drawn, by that of the picture, which is then stretched: 0.5 to 1
            render_scale: f32 = 1.0, "Render scale", Kind::Number { least: 0.5, most: 1.0 };
            /// What the picture shows
            view: View = View::default(), "View", Kind::choice::<View>();
            /// Exposure in stops: radiance is multiplied by 2^exposure before the tone map, +1 doubles the light
            exposure: f32 = 0.0, "Exposure", Kind::Number { least: -8.0, most: 8.0 };
            /// How radiance becomes display values
            tone_map: ToneMap = ToneMap::default(), "Tone map", Kind::choice::<ToneMap>();
        }
        "Culling" {
            /// Which objects are drawn: those in the frustum, of these the ones that nothing hides, or all (the
            /// reference); the picture is the same
            culling: Culling = Culling::default(), "Culling", Kind::choice::<Culling>();
            /// Occluders that look smaller are not rasterized: radius^2 < distance * size^2 * tan(fov / 2), as in Intel's
            /// sample, which takes 1.5; 0 takes all
            occluder_size: f32 = 0.0, "Occluder size", Kind::Number { least: 0.0, most: 5.0 };
            /// Objects that look smaller are not drawn, by the same measure; Intel's sample takes 0.01. Above 0 the
            /// picture changes
            occludee_size: f32 = 0.0, "Object size", Kind::Number { least: 0.0, most: 1.0 };
            /// Pixels of the picture per pixel of the occlusion buffer and axis. 4 tests at the picture's own pixel
            /// centres, so that the picture stays the same to the bit; more may take gaps as thin as a pixel for closed
            occlusion_scale: u8 = 4, "Buffer scale", Kind::Integer { least: 1, most: 16 };
            /// Threads that rasterize occluders; 0: as many as there are
            culling_threads: u8 = 0, "Threads", Kind::Integer { least: 0, most: 32 };
            /// Metres that the eye may move, without turning, before culling looks again: what was found holds as far as that.
            /// It then hides a little less; 0 looks again in every frame
            culling_radius: f32 = 0.0, "Valid for (m)", Kind::Number { least: 0.0, most: 1.0 };
            /// Whether each of two eyes is looked for by itself, or both at once, which hides less; the picture is the same
            culling_eyes: CullingEyes = CullingEyes::default(), "Two eyes", Kind::choice::<CullingEyes>();
            /// Milliseconds after which no further occluder is begun; the nearest come first, and what is left out only
            /// makes more objects drawn. 0: no limit. Without a clock there is none either
            culling_budget: f32 = 0.0, "Budget (ms)", Kind::Number { least: 0.0, most: 10.0 };
        }
        "Geometry" {
            /// How the G-buffer is filled: by the rasterizer, or by a visibility buffer whose materials are evaluated once
            /// per pixel; the picture is the same but for rounding
            geometry: Geometry = Geometry::default(), "Path", Kind::choice::<Geometry>();
            /// How many materials of a visibility buffer one dispatch evaluates: one, or a family of all that share shader,
            /// arrays of textures and samplers; auto: one on lavapipe, a family elsewhere
            material_dispatch: MaterialDispatch = MaterialDispatch::default(), "Material dispatch", Kind::choice::<MaterialDispatch>();
            /// Whether equal meshes with equal materials become instances of one draw
            merge_draws: bool = true, "Merge draws", Kind::Switch;
        }
        "Lighting" {
            /// How surfaces reflect light
            lighting: LightingModel = LightingModel::default(), "Model", Kind::choice::<LightingModel>();
            /// Which lights a sample looks at: those that reach its cluster, or all of them (the reference)
            lights: LightAssignment = LightAssignment::default(), "Lights", Kind::choice::<LightAssignment>();
            /// Largest anisotropy of texture filtering, 1 to 16. Lavapipe takes 1 whatever is asked for: its own
            /// anisotropic filter can take minutes for one triangle
            anisotropy: u16 = 8, "Anisotropy", Kind::Integer { least: 1, most: 16 };
        }
        "Anti-aliasing" {
            /// How edges are smoothed: not at all, by shading every sub-sample, or once per surface in a pixel
            aa: Antialiasing = Antialiasing::default(), "Mode", Kind::choice::<Antialiasing>();
            /// Sub-samples per pixel: 4, 9, 16, ... up to 256 for the grid (msaa: 16), 4 or 8 for the rotated
            /// pattern
            samples: u32 = 4, "Sub-samples", Kind::Integer { least: 4, most: 256 };
            /// Where the sub-samples lie
            pattern: SamplePattern = SamplePattern::default(), "Pattern", Kind::choice::<SamplePattern>();
            /// Which pixels msaa takes for edges: several surfaces, the source's depth difference, or none
            edge_test: EdgeTest = EdgeTest::default(), "Edge test", Kind::choice::<EdgeTest>();
        }
        "Shading rate" {
            /// One lighting evaluation per pixel, per tile of a rate map, or as the content allows
            shading: Shading = Shading::default(), "Shading", Kind::choice::<Shading>();
        }
        "Eye" {
            /// Display that the picture is seen on, from which rates follow: camera (it fills the camera's own field of view),
            /// hmd (92 degrees), h60 (60), fhd-24, uhd-27, quest-3, vision-pro, phone, degrees across, or WIDTHxDISTANCE in metres
            display: String = "camera".to_owned(), "Display", Kind::Text;
            /// Quality aimed at, in JOD: 10 is no visible difference from full shading, 9 one that 75 % of observers would see
            quality: f32 = 9.5, "Quality", Kind::Number { least: 5.0, most: 10.0 };
            /// Where the eye looks, as fractions of the picture from its top left corner
            gaze: [f32; 2] = [0.5, 0.5], "Gaze", Kind::Place;
        }
        "Coarse shading" {
            /// By what means tiles are visited; auto measures both
            backend: Backend = Backend::default(), "Backend", Kind::choice::<Backend>();
            /// Coarsest level, 0 to 8: tiles of at most 2^N pixels a side
            coarsest_level: u8 = COARSEST_LEVEL, "Coarsest level", Kind::Integer { least: 0, most: 8 };
            /// Where wished levels come from: what the eye resolves (foveated), radii around the gaze, a constant, an image
            /// (black: every pixel, white: level 8), the lens of the headset output, or with variable shading the content of
            /// the frame before
            rate: RateSource = RateSource::default(), "Rate from", Kind::choice::<RateSource>();
            /// A second source of wishes
            rate_other: RateSource = RateSource::Constant, "Second source", Kind::choice::<RateSource>();
            /// What becomes of the second source: not looked at, or the coarser or finer wish of both
            rate_combine: RateCombine = RateCombine::default(), "Combine", Kind::choice::<RateCombine>();
            /// The constant source's level, 0 to 8
            rate_level: u8 = 0, "Constant level", Kind::Integer { least: 0, most: 8 };
            /// The image source's file. The library opens no files: its caller hands the pixels to the renderer
            rate_image: String = String::new(), "Image", Kind::File;
            /// With rates by radii: radius around the gaze where every pixel is shaded, by the picture's height
            fovea_inner: f32 = 0.125, "Fovea", Kind::Number { least: 0.0, most: 1.0 };
            /// With rates by radii: radius from which on the coarsest level is wished, by the picture's height
            fovea_outer: f32 = 0.9, "Periphery", Kind::Number { least: 0.0, most: 2.0 };
            /// With rates by radii: how levels follow between them: 1 in even steps, above 1 in steps that widen outwards
            fovea_curve: f32 = 1.5, "Curve", Kind::Number { least: 0.1, most: 10.0 };
            /// Whether neighbouring tiles differ by one level at most
            rate_balance: bool = true, "Balance", Kind::Switch;
            /// Where geometric edges are shaded more finely: two levels everywhere (graded), pixel by pixel outside the
            /// periphery (inner) or everywhere, or nowhere
            refine_edges: RefineEdges = RefineEdges::default(), "Refine edges", Kind::choice::<RefineEdges>();
            /// Which of its pixels a tile's sample looks at: the centre, or the most typical of five
            coarse_sample: CoarseSample = CoarseSample::default(), "Sample", Kind::choice::<CoarseSample>();
            /// How samples become pixels: each pixel's own surface in the samples' light (light), or the samples' colours by
            /// continuous patches (smooth), by the source's four taps (paper), or as they are (nearest)
            composite: Composite = Composite::default(), "Composite", Kind::choice::<Composite>();
            /// Whether the samples' light is kept from frame to frame, carried along with what moves and renewed bit by bit, in
            /// place of shaded anew in each frame; with the composite of light, samples at centres and another backend than stencil
            history: bool = true, "Keep light", Kind::Switch;
        }
        "Shading at a rate" {
            /// What is done once per sample: lighting, or with a visibility buffer materials too (both) or, where shading is
            /// variable, alone; auto: both with a visibility buffer and without anti-aliasing
            rate_stage: RateStage = RateStage::default(), "Stage", Kind::choice::<RateStage>();
        }
        "Variable shading" {
            /// What contrast is measured by: differences within 2x2 pixels, to the four neighbours, or Sobel kernels
            contrast: Contrast = Contrast::default(), "Contrast", Kind::choice::<Contrast>();
            /// Contrast above which pixels are shaded one by one: difference of display luma by its local mean + 0.1
            contrast_threshold: f32 = 0.04, "Threshold", Kind::Number { least: 0.0, most: 0.5 };
            /// By what part the threshold grows per pixel that a place moves in a frame
            velocity_gain: f32 = 0.1, "Velocity", Kind::Number { least: 0.0, most: 1.0 };
            /// Whether samples may stand for 4x4 pixels
            rate_4x4: bool = false, "4x4", Kind::Switch;
            /// Goes on where it costs more than it saves, which else turns it off
            force_rate: bool = false, "Force", Kind::Switch;
        }
        "Stereo" {
            /// Whether there are two eyes, and how their geometry is submitted: each draw once for both (instanced), or once
            /// per eye (two-pass, the reference)
            stereo: Stereo = Stereo::default(), "Eyes", Kind::choice::<Stereo>();
            /// What keeps an eye's instances out of the other's half: a clip plane, or discarding
            eye_clipping: EyeClipping = EyeClipping::default(), "Clipping", Kind::choice::<EyeClipping>();
            /// Distance between the eyes in metres
            ipd: f32 = 0.063, "Eye distance", Kind::Number { least: 0.0, most: 0.2 };
            /// Distance in metres at which a point straight ahead has the same place in both pictures
            convergence: f32 = 2.0, "Convergence", Kind::Number { least: 0.1, most: 20.0 };
            /// The eyes' frusta in place of the camera's, as tangents: left, right, bottom and top border of the left eye,
            /// then of the right, with commas between
            eye_tangents: String = String::new(), "Frusta", Kind::Text;
            /// How far the right eye's gaze lies from the left one's, as fractions of the picture
            gaze_shift: [f32; 2] = [0.0, 0.0], "Gaze shift", Kind::Place;
            /// How the picture shows what both eyes see
            show: Output = Output::default(), "Output", Kind::choice::<Output>();
            /// The lens of the headset output: cardboard-v2, cardboard-v1, dk1, ideal, or its coefficients k1,k2,k3 and, if
            /// need be, red's c0,c1 and blue's
            lens: String = "cardboard-v2".to_owned(), "Lens", Kind::Text;
        }
    }
}

impl Settings {
    /// The settings at whose size the frame is drawn before it is stretched by [`Settings::render_scale`].
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

    /// Checks that the settings make sense and that a device with these limits can meet them.
    ///
    /// # Errors
    /// [`Error::Setting`] and [`Error::Limit`].
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
