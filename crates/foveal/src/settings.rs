//! Every choice that a user makes about a frame, as one struct that the library, the program's flags
//! and a TOML file share. Each stage's first variant is its default.

use serde::{Deserialize, Serialize};

use crate::Error;

mod coarse;
mod variable;

pub use coarse::{
    Backend, COARSEST_LEVEL, CoarseSample, Composite, RateCombine, RateSource, RefineEdges, Shading,
};
pub use variable::Geometry;

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
}

impl View {
    /// Whether lighting is evaluated for it.
    pub(crate) fn is_lit(self) -> bool {
        match self {
            Self::Final | Self::Rate | Self::Blocks | Self::Shaded => true,
            Self::Depth | Self::Normals | Self::BaseColor | Self::Instances | Self::Motion => false,
            Self::Edges | Self::Samples => false,
        }
    }
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

/// Everything that a user chooses about a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Settings {
    /// Width in pixels, 1 up to the device's limit.
    pub width: u32,
    /// Height in pixels, 1 up to the device's limit.
    pub height: u32,
    /// What the picture shows.
    pub view: View,
    /// Which objects are drawn. The picture is the same with each.
    pub culling: Culling,
    /// How the G-buffer is filled. The picture is the same but for rounding.
    pub geometry: Geometry,
    /// How light is reflected.
    pub lighting: LightingModel,
    /// Which lights a sample looks at.
    pub lights: LightAssignment,
    /// Exposure in stops: radiance is multiplied by 2^exposure before the tone map.
    pub exposure: f32,
    /// The tone map.
    pub tone_map: ToneMap,
    /// Largest anisotropy of texture filtering, 1 to 16. Lavapipe takes 1 whatever is asked for: its own
    /// anisotropic filter can take minutes for one triangle.
    pub anisotropy: u16,
    /// How edges are smoothed.
    pub aa: Antialiasing,
    /// Sub-samples per pixel where `aa` is not none: a square from 4 to 256 for the grid (16 at most with
    /// msaa), 4 or 8 for the rotated pattern.
    pub samples: u32,
    /// Where the sub-samples lie.
    pub pattern: SamplePattern,
    /// Which pixels msaa takes for edges.
    pub edge_test: EdgeTest,
    /// How many samples the deferred stage shades. All settings below are of coarse shading.
    pub shading: Shading,
    /// By what means coarse samples are visited.
    pub backend: Backend,
    /// Coarsest level in use, 0 to 8: blocks have at most 2^level pixels a side.
    pub coarsest_level: u8,
    /// Where wished levels come from.
    pub rate: RateSource,
    /// A second source of wishes.
    pub rate_other: RateSource,
    /// What becomes of the second source.
    pub rate_combine: RateCombine,
    /// The level of the constant source, 0 to 8.
    pub rate_level: u8,
    /// The image source's file. The library opens no files: its caller hands the pixels to
    /// [`crate::Renderer::set_rate_image`].
    pub rate_image: String,
    /// Where the eye looks, as fractions of the picture from its top left corner.
    pub gaze: [f32; 2],
    /// Radius around the gaze within which every pixel is shaded, as a fraction of the picture's height.
    pub fovea_inner: f32,
    /// Radius from which on the coarsest level is wished, as a fraction of the picture's height.
    pub fovea_outer: f32,
    /// How levels follow between the radii: 1 in even steps, above 1 in steps that widen outwards.
    pub fovea_curve: f32,
    /// Neighbouring blocks differ by one level at most.
    pub rate_balance: bool,
    /// Where pixels at geometric edges are shaded one by one.
    pub refine_edges: RefineEdges,
    /// Which of its pixels a block's sample looks at.
    pub coarse_sample: CoarseSample,
    /// How samples become pixels.
    pub composite: Composite,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            view: View::default(),
            culling: Culling::default(),
            geometry: Geometry::default(),
            lighting: LightingModel::default(),
            lights: LightAssignment::default(),
            exposure: 0.0,
            tone_map: ToneMap::default(),
            anisotropy: 8,
            aa: Antialiasing::default(),
            samples: 4,
            pattern: SamplePattern::default(),
            edge_test: EdgeTest::default(),
            shading: Shading::default(),
            backend: Backend::default(),
            coarsest_level: COARSEST_LEVEL,
            rate: RateSource::default(),
            rate_other: RateSource::Constant,
            rate_combine: RateCombine::default(),
            rate_level: 0,
            rate_image: String::new(),
            gaze: [0.5, 0.5],
            fovea_inner: 0.125,
            fovea_outer: 0.9,
            fovea_curve: 1.5,
            rate_balance: true,
            refine_edges: RefineEdges::default(),
            coarse_sample: CoarseSample::default(),
            composite: Composite::default(),
        }
    }
}

impl Settings {
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
        if !(1..=16).contains(&self.anisotropy) {
            let value = self.anisotropy.to_string();
            return Err(Error::Setting {
                name: "anisotropy",
                value,
                expected: "between 1 and 16",
            });
        }
        coarse::validate(self)?;
        crate::antialias::validate(self, limits)
    }
}
