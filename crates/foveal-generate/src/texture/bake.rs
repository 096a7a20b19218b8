//! From a surface, a function of the place, to its textures.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use foveal_scene::mip::{self, Content};
use foveal_scene::{ColorSpace, Sampler, Texture, Wrap};

/// One point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Texel {
    /// sRGB-encoded colour, 0 … 1.
    pub(crate) color: Vec3,
    /// Opacity.
    pub(crate) alpha: f32,
    /// Height in metres.
    pub(crate) height_m: f32,
    /// Perceptual roughness.
    pub(crate) roughness: f32,
    /// 0 dielectric … 1 metal.
    pub(crate) metallic: f32,
    /// 1 open … 0 buried.
    pub(crate) open: f32,
}

impl Texel {
    /// A flat, rough, opaque point of a colour.
    pub(crate) const fn new(color: Vec3) -> Self {
        Self {
            color,
            alpha: 1.0,
            height_m: 0.0,
            roughness: 0.9,
            metallic: 0.0,
            open: 1.0,
        }
    }
}

/// The three textures of a surface.
#[derive(Debug)]
pub(crate) struct Baked {
    /// Colour and alpha.
    pub(crate) color: Texture,
    /// Tangent-space normals.
    pub(crate) normal: Texture,
    /// Red occlusion, green roughness, blue metallic.
    pub(crate) orm: Texture,
}

/// Evaluates `surface` at the centres of `size`² texels of a tile of `tile_m` metres.
pub(crate) fn bake(
    name: &str,
    size: u32,
    tile_m: f32,
    surface: impl Fn(Vec2) -> Texel + Sync,
) -> Baked {
    let texels = evaluate(size, surface);
    let at = |x: u32, y: u32| texels[((y % size) * size + x % size) as usize].height_m;
    let slope = size as f32 / (2.0 * tile_m);
    let normals = (0..size * size)
        .flat_map(|i| {
            let (x, y) = (i % size, i / size);
            // Green is up the picture, rows run down.
            let n = Vec3::new(
                (at(x + size - 1, y) - at(x + 1, y)) * slope,
                (at(x, y + 1) - at(x, y + size - 1)) * slope,
                1.0,
            )
            .normalize();
            let [x, y, z] = n.to_array().map(|v| (v * 127.5 + 128.0) as u8);
            [x, y, z, 255]
        })
        .collect();
    let orm = texels
        .iter()
        .flat_map(|t| [byte(t.open), byte(t.roughness), byte(t.metallic), 255])
        .collect();
    Baked {
        color: picture(name, size, color_bytes(&texels), Content::Color),
        normal: picture(&format!("{name} normal"), size, normals, Content::Normal),
        orm: picture(
            &format!("{name} occlusion-roughness-metallic"),
            size,
            orm,
            Content::Data,
        ),
    }
}

/// A colour picture alone.
pub(crate) fn paint(name: &str, size: u32, surface: impl Fn(Vec2) -> Texel + Sync) -> Texture {
    let bytes = color_bytes(&evaluate(size, surface));
    picture(name, size, bytes, Content::Color)
}

/// A colour picture whose alpha is for blending.
pub(super) fn paint_clear(
    name: &str,
    size: u32,
    surface: impl Fn(Vec2) -> Texel + Sync,
) -> Texture {
    let bytes = color_bytes(&evaluate(size, surface));
    picture(name, size, bytes, Content::Cutout { threshold: None })
}

/// A colour picture with a cut-out, not repeating.
pub(crate) fn paint_masked(
    name: &str,
    size: u32,
    surface: impl Fn(Vec2) -> Texel + Sync,
) -> Texture {
    let bytes = color_bytes(&evaluate(size, surface));
    picture_clamped(picture(
        name,
        size,
        bytes,
        Content::Cutout {
            threshold: Some(0.5),
        },
    ))
}

/// The texture, not repeating.
pub(super) fn picture_clamped(mut texture: Texture) -> Texture {
    texture.sampler.wrap_u = Wrap::ClampToEdge;
    texture.sampler.wrap_v = Wrap::ClampToEdge;
    texture
}

fn evaluate(size: u32, surface: impl Fn(Vec2) -> Texel + Sync) -> Vec<Texel> {
    (0..size * size)
        .into_par_iter()
        .with_min_len(1024)
        .map(|i| {
            let p = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
            surface(p / size as f32)
        })
        .collect()
}

fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn color_bytes(texels: &[Texel]) -> Vec<u8> {
    texels
        .iter()
        .flat_map(|t| {
            [
                byte(t.color.x),
                byte(t.color.y),
                byte(t.color.z),
                byte(t.alpha),
            ]
        })
        .collect()
}

fn picture(name: &str, size: u32, level_0: Vec<u8>, content: Content) -> Texture {
    Texture {
        name: name.to_owned(),
        width: size,
        height: size,
        color_space: match content {
            Content::Color | Content::Cutout { .. } => ColorSpace::Srgb,
            Content::Data | Content::Normal => ColorSpace::Linear,
        },
        sampler: Sampler::default(),
        encoding: foveal_scene::Encoding::Rgba8,
        levels: mip::chain(level_0, size, size, content),
    }
}
