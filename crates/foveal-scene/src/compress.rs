//! Which textures are kept in blocks, and in which ones: by what materials read of them.
//!
//! | read | blocks | bytes a texel |
//! |---|---|---|
//! | a normal map and nothing else | BC5: x and y | 1 |
//! | red alone (occlusion, factors of lobes) | BC4 | 0.5 |
//! | no alpha | BC1 or BC7 | 0.5 or 1 |
//! | anything else | BC7 | 1 |
//!
//! BC4 and BC5 have no sRGB: a texture of that colour space is BC1 or BC7. Textures whose sides are
//! no multiples of 4 stay as they are: WebGPU has no blocks for them, and another size would move
//! their texels.

use crate::{AlphaMode, ColorSpace, Encoding, Material, TextureCompression};

/// What materials read of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Channels(u8);

impl Channels {
    const RED: Self = Self(1);
    const RGB: Self = Self(7);
    const ALPHA: Self = Self(8);
    const RGBA: Self = Self(15);
    /// A direction in tangent space.
    const NORMAL: Self = Self(16);

    /// How a texture of this colour space and size that is read so is kept.
    pub(crate) fn encoding(
        self,
        by: TextureCompression,
        color_space: ColorSpace,
        (width, height): (u32, u32),
    ) -> Encoding {
        let encoding = match (self, color_space, by) {
            (_, _, TextureCompression::Off) => Encoding::Rgba8,
            (Self::NORMAL, ColorSpace::Linear, _) => Encoding::Bc5,
            (Self::RED, ColorSpace::Linear, _) => Encoding::Bc4,
            (read, _, TextureCompression::Small) if read.0 & !Self::RGB.0 == 0 => Encoding::Bc1,
            _ => Encoding::Bc7,
        };
        if encoding.fits(width, height) {
            encoding
        } else {
            Encoding::Rgba8
        }
    }

    /// Whether anything reads alpha.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn has_alpha(self) -> bool {
        self.0 & Self::ALPHA.0 != 0
    }
}

/// What these materials read of each of so many textures.
pub(crate) fn channels(materials: &[Material], textures: usize) -> Vec<Channels> {
    let mut read = vec![Channels::default(); textures];
    for material in materials {
        let base = match material.alpha_mode {
            AlphaMode::Opaque => Channels::RGB,
            AlphaMode::Mask { .. } | AlphaMode::Blend => Channels::RGBA,
        };
        let own = [
            (material.base_color_texture, base),
            (material.metallic_roughness_texture, Channels::RGB),
            (material.normal_texture, Channels::NORMAL),
            (material.occlusion_texture, Channels::RED),
            (material.emissive_texture, Channels::RGB),
            (material.specular_texture, Channels::ALPHA),
            (material.specular_color_texture, Channels::RGB),
        ];
        // Coat, its roughness and normal, sheen, its roughness, anisotropy, transmission, thickness,
        // iridescence, its film's thickness.
        let of_lobes = [
            Channels::RED,
            Channels::RGB,
            Channels::NORMAL,
            Channels::RGB,
            Channels::ALPHA,
            Channels::RGB,
            Channels::RED,
            Channels::RGB,
            Channels::RED,
            Channels::RGB,
        ];
        let lobes = material.lobe_textures().into_iter().zip(of_lobes);
        for (slot, channels) in own.into_iter().chain(lobes) {
            let slot = slot.and_then(|slot| read.get_mut(slot.texture as usize));
            if let Some(of_texture) = slot {
                of_texture.0 |= channels.0;
            }
        }
    }
    read
}

#[cfg(not(target_arch = "wasm32"))]
mod encoder {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::{Channels, channels};
    use crate::{Encoding, Scene, Texture, TextureCompression, blocks, threads};

    impl Scene {
        /// Keeps textures of plain texels in blocks, but for those whose sides are no multiples of 4
        /// and those that the encoder fails on. Decides by what the materials read as they are now:
        /// one that later reads another channel finds what its blocks have of it
        /// ([`Encoding`]). For scenes that programs make; the importer has
        /// [`LoadOptions::texture_compression`](crate::LoadOptions::texture_compression), which never
        /// holds all texels at once. Uses the threads of the current rayon pool where `parallel`. Not
        /// there on wasm32, which has no encoder.
        pub fn compress_textures(&mut self, by: TextureCompression, parallel: bool) {
            let read = channels(&self.materials, self.textures.len());
            let mut textures: Vec<_> = self.textures.iter_mut().zip(read).collect();
            threads::each(parallel, &mut textures, |(texture, read)| {
                compress(texture, *read, by);
            });
        }
    }

    /// Encodes the texels, and frees them where all levels are encoded.
    pub(crate) fn compress(texture: &mut Texture, read: Channels, by: TextureCompression) {
        compress_with(texture, read, by, blocks::encode);
    }

    /// An encoder's panic leaves the texture as it is.
    pub(super) fn compress_with(
        texture: &mut Texture,
        read: Channels,
        by: TextureCompression,
        encode: impl Fn(&[u8], (u32, u32), Encoding, bool) -> Vec<u8>,
    ) {
        let size = (texture.width, texture.height);
        let encoding = read.encoding(by, texture.color_space, size);
        if texture.encoding != Encoding::Rgba8 || encoding == Encoding::Rgba8 {
            return;
        }
        let fits = |level: usize| {
            let (width, height) = texture.level_size(level);
            texture.levels[level].len() as u64 == Encoding::Rgba8.level_bytes(width, height)
        };
        // A program's own texture may hold anything; the renderer says what is wrong with it.
        if !(0..texture.levels.len()).all(fits) {
            return;
        }
        let levels = catch_unwind(AssertUnwindSafe(|| {
            let levels = texture.levels.iter().enumerate();
            let in_blocks = levels.map(|(level, texels)| {
                encode(
                    texels,
                    texture.level_size(level),
                    encoding,
                    read.has_alpha(),
                )
            });
            in_blocks.collect()
        }));
        if let Ok(levels) = levels {
            texture.levels = levels;
            texture.encoding = encoding;
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use encoder::compress;

/// There is no encoder in browsers.
#[cfg(target_arch = "wasm32")]
pub(crate) fn compress(_: &mut crate::Texture, _: Channels, _: TextureCompression) {}

#[cfg(test)]
mod tests {
    use glam::Mat3;

    use super::*;
    use crate::{Clearcoat, Sampler, Scene, Texture, TextureRef};

    fn texture(side: u32, texel: impl Fn(u32) -> [u8; 4]) -> Texture {
        let texels = (0..side * side).flat_map(texel).collect();
        Texture {
            name: String::new(),
            width: side,
            height: side,
            color_space: ColorSpace::Linear,
            sampler: Sampler::default(),
            encoding: Encoding::Rgba8,
            levels: crate::mip::chain(texels, side, side, crate::mip::Content::Data),
        }
    }

    #[test]
    fn textures_are_encoded_by_what_is_read_of_them() {
        let slot = |texture| {
            Some(TextureRef {
                texture,
                uv_set: 0,
                uv_transform: Mat3::IDENTITY,
            })
        };
        let first = Material {
            base_color_texture: slot(0),
            normal_texture: slot(1),
            occlusion_texture: slot(2),
            metallic_roughness_texture: slot(3),
            clearcoat: Some(Clearcoat {
                factor: 1.0,
                texture: slot(2),
                roughness: 0.5,
                roughness_texture: None,
                normal_texture: slot(4),
                normal_scale: 1.0,
            }),
            ..Material::default()
        };
        // One that reads a normal map as colour, too, one of red and green, one of another size.
        let second = Material {
            emissive_texture: slot(4),
            metallic_roughness_texture: slot(5),
            occlusion_texture: slot(5),
            normal_texture: slot(6),
            specular_texture: slot(99),
            ..Material::default()
        };
        let mut scene = Scene {
            materials: vec![first, second],
            ..Scene::default()
        };
        scene.textures = (0..7).map(|_| texture(8, |i| [i as u8; 4])).collect();
        scene.textures[6] = texture(6, |i| [i as u8; 4]);
        let before = scene.clone();
        use Encoding::{Bc1, Bc4, Bc5, Bc7, Rgba8};
        use TextureCompression::{Fine, Off, Small};
        for (by, expected) in [
            (Off, [Rgba8; 7]),
            (Small, [Bc1, Bc5, Bc4, Bc1, Bc7, Bc1, Rgba8]),
            (Fine, [Bc7, Bc5, Bc4, Bc7, Bc7, Bc7, Rgba8]),
        ] {
            scene = before.clone();
            scene.compress_textures(by, false);
            let encodings: Vec<_> = scene.textures.iter().map(|t| t.encoding).collect();
            assert_eq!(encodings, expected);
        }
        for (old, new) in before.textures.iter().zip(&scene.textures) {
            assert_eq!(old.levels.len(), new.levels.len());
            for level in 0..new.levels.len() {
                let (width, height) = new.level_size(level);
                let bytes = new.encoding.level_bytes(width, height);
                assert_eq!(new.levels[level].len() as u64, bytes);
                let (old, new) = (old.decoded_level(level), new.decoded_level(level));
                let off = old.iter().step_by(4).zip(new.iter().step_by(4));
                assert!(off.map(|(a, b)| a.abs_diff(*b)).all(|d| d < 12));
            }
        }
        let (mut parallel, again) = (before, scene.clone());
        parallel.compress_textures(Fine, true);
        assert_eq!(parallel.textures, scene.textures);
        scene.compress_textures(Fine, true);
        assert_eq!(scene.textures, again.textures, "what is encoded stays");
    }

    #[test]
    fn srgb_textures_have_no_blocks_of_one_channel_or_two() {
        use TextureCompression::{Fine, Small};
        for (read, by, linear, srgb) in [
            (Channels::RED, Small, Encoding::Bc4, Encoding::Bc1),
            (Channels::RED, Fine, Encoding::Bc4, Encoding::Bc7),
            (Channels::NORMAL, Small, Encoding::Bc5, Encoding::Bc7),
            (Channels::NORMAL, Fine, Encoding::Bc5, Encoding::Bc7),
        ] {
            assert_eq!(read.encoding(by, ColorSpace::Linear, (8, 8)), linear);
            assert_eq!(read.encoding(by, ColorSpace::Srgb, (8, 8)), srgb);
        }
    }

    #[test]
    fn an_encoders_panic_leaves_the_texture_as_it_is() {
        let before = texture(8, |i| [i as u8; 4]);
        let mut after = before.clone();
        let fine = TextureCompression::Fine;
        encoder::compress_with(&mut after, Channels::RGB, fine, |_, size, encoding, _| {
            assert!(size.0 > 2, "a level that the encoder fails on");
            vec![0; encoding.level_bytes(size.0, size.1) as usize]
        });
        assert_eq!(after, before);
        compress(&mut after, Channels::RGB, fine);
        assert_eq!(after.encoding, Encoding::Bc7);
    }

    #[test]
    fn cut_outs_keep_their_coverage() {
        let side = 64;
        let blob = |i: u32| {
            let (x, y) = ((i % side) as f32 / 5.0, (i / side) as f32 / 6.0);
            let alpha = (127.0 + 400.0 * x.sin() * y.cos()).clamp(0.0, 255.0);
            [90, 160 + (i % 64) as u8, 40, alpha as u8]
        };
        let mut texture = texture(side, blob);
        let coverage = |texture: &Texture, level| {
            let texels = texture.decoded_level(level);
            let passed = texels.iter().skip(3).step_by(4).filter(|a| **a >= 128);
            passed.count() as f32 / (texels.len() / 4) as f32
        };
        let before: Vec<_> = (0..4).map(|level| coverage(&texture, level)).collect();
        compress(&mut texture, Channels::RGBA, TextureCompression::Small);
        assert_eq!(texture.encoding, Encoding::Bc7);
        for (level, wanted) in before.into_iter().enumerate() {
            let found = coverage(&texture, level);
            assert!((found - wanted).abs() < 0.02, "{level}: {found} {wanted}");
        }
    }
}
