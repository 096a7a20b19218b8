//! Choices about the picture, culling, materials, anti-aliasing and lighting.

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// Objects that the renderer submits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Culling {
    /// As [`Self::Occlusion`] while that hides at least ten times as many triangles as it
    /// rasterizes, a hidden object counting for a hundred more. After a frame in which it does not,
    /// 30 frames are culled as by [`Self::Frustum`], unless the eye turns by 26 degrees, its
    /// projection changes or another scene is set before. With shadows, always as
    /// [`Self::Occlusion`].
    #[default]
    Auto,
    /// Objects in the camera's frustum.
    Frustum,
    /// Objects in the camera's frustum that no nearer surface hides.
    Occlusion,
    /// All objects: the reference.
    Off,
}

impl Culling {
    /// Whether scenes get occluders.
    #[must_use]
    pub const fn has_occluders(self) -> bool {
        matches!(self, Self::Auto | Self::Occlusion)
    }
}

/// Sharing of one occlusion test between two eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum CullingEyes {
    /// One exact test per eye. An object is drawn if either eye sees it.
    #[default]
    Each,
    /// One test for both eyes. It holds everywhere in the smallest sphere that contains both.
    /// Occluders are rasterized once and hide less.
    Shared,
}

/// Shadows of lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Shadows {
    /// Light passes through everything.
    #[default]
    Off,
    /// One comparison per light and sample.
    Hard,
    /// Nine comparisons, each blended between texels.
    Soft,
    /// As many as it takes to fade with the distance from what casts the shadow.
    Contact,
}

/// Sizes of shadow tiles with coarse shading whose rates follow the eye's resolution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum ShadowSizes {
    /// By distance alone.
    #[default]
    View,
    /// By distance, and as much coarser as the samples are wherever a tile's shadows may be seen.
    Rate,
}

/// Occlusion of the environment's light, besides the file's own maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum AmbientOcclusion {
    /// None.
    #[default]
    Off,
    /// By what the picture's depth shows around a place.
    Screen,
}

/// Light from everywhere besides the lights of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum EnvironmentSource {
    /// The environment that the scene's file has ([`ImageLight`](foveal_scene::ImageLight)), else
    /// [`EnvironmentSource::Gradient`].
    #[default]
    Scene,
    /// The scene's sky as a formula: rough surfaces mirror it unfiltered.
    Gradient,
    /// The scene's sky, filtered by roughness.
    Sky,
    /// A picture, which hosts give to [`Renderer::set_environment`](crate::Renderer::set_environment);
    /// until then [`EnvironmentSource::Sky`].
    Image,
    /// No light, and black behind all surfaces.
    None,
}

/// What is seen behind all surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Background {
    /// The environment.
    #[default]
    Environment,
    /// The environment as a mirror of roughness 0.5 reflects it.
    Blurred,
    /// Black.
    None,
}

/// Content of the picture: the finished frame or a debug view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum DebugView {
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

impl DebugView {
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum SamplePattern {
    /// A regular grid of n x n, drawn at n times the resolution.
    #[default]
    Grid,
    /// A rotated grid of 4 or 8 samples, no two in one row or column. The scene is drawn once per
    /// sample.
    Rotated,
}

/// Pixels that [`Antialiasing::Msaa`] treats as edges, and the sub-samples that it shades there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum EdgeTest {
    /// Pixels whose sub-samples differ in instance, plane or direction. One sample is shaded per
    /// surface and weighted by coverage.
    #[default]
    Surface,
    /// Pixels whose reversed depths differ by more than 1e-4, as in the original method. All
    /// sub-samples are shaded.
    Paper,
    /// No pixels. Only the first sub-sample is shaded, as in the original method's mode 'none'.
    Never,
}

/// Reflection of light by surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum LightingModel {
    /// glTF's metallic-roughness model: Lambert and GGX.
    #[default]
    Ggx,
    /// Lambert and Blinn-Phong, as in the techniques' sources.
    BlinnPhong,
}

/// Lights that a sample evaluates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum LightAssignment {
    /// Lights whose range touches the sample's cluster (froxel).
    #[default]
    Clustered,
    /// All lights: the reference.
    Brute,
}

/// Kind of the passes that light every pixel, find its rate, or reproject its kept light. The
/// picture is the same but for rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum LightingPass {
    /// `Compute` on graphics cards of their own, `Fragment` elsewhere.
    #[default]
    Auto,
    /// The fragments of a draw.
    Fragment,
    /// A compute shader.
    Compute,
}

/// Curve from scene radiance to display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum ToneMap {
    /// A filmic curve fitted to the ACES reference transform.
    #[default]
    Aces,
    /// Identity, clipped at 1.
    Linear,
}
