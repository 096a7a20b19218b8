//! Textures: texels, plain or in blocks, and how they are sampled.

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

/// How the texels of a level lie in its bytes. The block formats are those of Direct3D 11 and of the
/// Khronos Data Format Specification 1.3, sections 19 (BC1), 20 (BC4, BC5) and 21 (BC7): blocks of
/// 4 x 4 texels, row by row, the last ones of a row or column padded. Unsigned numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Red, green, blue, alpha: 4 bytes a texel.
    #[default]
    Rgba8,
    /// Red, green, blue: 8 bytes a block. Alpha is 1.
    Bc1,
    /// Red alone: 8 bytes a block. Green and blue are 0, alpha is 1. Always linear: there is no sRGB
    /// of it.
    Bc4,
    /// Red and green: 16 bytes a block. Blue is 0, alpha is 1. Always linear, like BC4. As a
    /// material's normal map it holds x and y, and z is `sqrt(1 - x² - y²)`, at least 0.001.
    Bc5,
    /// Red, green, blue, alpha: 16 bytes a block.
    Bc7,
}

/// Whether textures are kept in blocks that graphics devices read as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureCompression {
    /// RGBA8 texels.
    #[default]
    Off,
    /// BC5 for normal maps, BC4 for what only red is read of (both where it is linear), BC1 for other
    /// textures whose alpha is not read, BC7 for the rest.
    Small,
    /// The same with BC7 for BC1: twice the bytes, less error.
    Fine,
}

impl Encoding {
    /// Width and height of a block in texels.
    #[must_use]
    pub const fn block_side(self) -> u32 {
        match self {
            Self::Rgba8 => 1,
            Self::Bc1 | Self::Bc4 | Self::Bc5 | Self::Bc7 => 4,
        }
    }

    /// Bytes of a block.
    #[must_use]
    pub const fn block_bytes(self) -> u32 {
        match self {
            Self::Rgba8 => 4,
            Self::Bc1 | Self::Bc4 => 8,
            Self::Bc5 | Self::Bc7 => 16,
        }
    }

    /// Bytes of a level of `width` x `height` texels; [`u64::MAX`] where they are more.
    #[must_use]
    pub fn level_bytes(self, width: u32, height: u32) -> u64 {
        let blocks = |texels: u32| u64::from(texels.div_ceil(self.block_side()));
        (blocks(width) * blocks(height)).saturating_mul(u64::from(self.block_bytes()))
    }

    /// Whether a texture of this size can be on a device so: WebGPU wants whole blocks on level 0.
    #[must_use]
    pub const fn fits(self, width: u32, height: u32) -> bool {
        width.is_multiple_of(self.block_side()) && height.is_multiple_of(self.block_side())
    }
}

/// A picture with its sampler.
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
    /// How texels lie in `levels`.
    pub encoding: Encoding,
    /// Rows of texels or of blocks top to bottom, one `Vec` per mip level, level k of size
    /// max(1, width >> k) x max(1, height >> k). Level 0 alone where the sampler has no mip filter.
    pub levels: Vec<Vec<u8>>,
}

impl Texture {
    /// Width and height of a mip level in texels.
    #[must_use]
    pub fn level_size(&self, level: usize) -> (u32, u32) {
        let side = |size: u32| size.checked_shr(level as u32).unwrap_or(0).max(1);
        (side(self.width), side(self.height))
    }

    /// Bytes of all levels.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.len() as u64).sum()
    }
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
