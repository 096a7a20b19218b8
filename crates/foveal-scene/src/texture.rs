//! Textures: decoded pixels and how they are sampled.

use glam::Mat3;

/// What the bytes mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// RGB is sRGB-encoded (base colour, emissive); alpha is linear.
    Srgb,
    /// All channels are linear (normals, roughness, occlusion).
    Linear,
}

/// What happens outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture repeats.
    Repeat,
    /// The picture repeats, every second time mirrored.
    MirroredRepeat,
    /// The edge goes on.
    ClampToEdge,
}

/// How neighbouring texels are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The nearest one.
    Nearest,
    /// Interpolated.
    Linear,
}

/// How a texture is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// Wrapping in u.
    pub wrap_u: Wrap,
    /// Wrapping in v.
    pub wrap_v: Wrap,
    /// Magnification.
    pub mag: Filter,
    /// Minification within a level.
    pub min: Filter,
    /// Between mip levels; `None` reads the full-size picture alone.
    pub mip: Option<Filter>,
}

impl Default for Sampler {
    /// Trilinear, repeating: what glTF assumes where the file says nothing.
    fn default() -> Self {
        Self {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            mag: Filter::Linear,
            min: Filter::Linear,
            mip: Some(Filter::Linear),
        }
    }
}

/// A decoded picture with its sampler.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name or path in the file.
    pub name: String,
    /// Width of level 0 in texels, ≥ 1.
    pub width: u32,
    /// Height of level 0 in texels, ≥ 1.
    pub height: u32,
    /// What the bytes mean.
    pub color_space: ColorSpace,
    /// How it is read.
    pub sampler: Sampler,
    /// RGBA8 rows top to bottom, one `Vec` per mip level, level k of size max(1, width >> k) x
    /// max(1, height >> k). Level 0 alone where the sampler has no mip filter.
    pub levels: Vec<Vec<u8>>,
}

/// A texture as one material slot uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`](crate::Scene::textures).
    pub texture: u32,
    /// Which of a vertex's two UV sets it reads: 0 or 1 (the importer maps the file's sets to
    /// these).
    pub uv_set: u32,
    /// Texture coordinates from vertex coordinates (KHR_texture_transform), affine in 2-D.
    pub uv_transform: Mat3,
}
