//! Mip chains by box filter, in linear light where the texture is sRGB.

use std::sync::LazyLock;

use crate::ColorSpace;

/// How a picture's texels are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// sRGB colour, weighted by alpha so that invisible texels do not bleed; linear alpha.
    Color,
    /// The same, with alpha scaled so that as many texels pass 0.5 as on level 0.
    MaskedColor,
    /// Unit vectors.
    Normal,
    /// Plain numbers.
    Linear,
}

impl Content {
    /// The colour space that a texture of this content has.
    pub(super) const fn color_space(self) -> ColorSpace {
        match self {
            Self::Color | Self::MaskedColor => ColorSpace::Srgb,
            Self::Normal | Self::Linear => ColorSpace::Linear,
        }
    }
}

/// Linear value of each sRGB byte, and the linear values halfway between bytes (to encode).
struct Srgb {
    linear: [f32; 256],
    halfway: [f32; 255],
}

static SRGB: LazyLock<Srgb> = LazyLock::new(|| Srgb {
    linear: std::array::from_fn(|i| decode(i as f64 / 255.0) as f32),
    halfway: std::array::from_fn(|i| decode((i as f64 + 0.5) / 255.0) as f32),
});

/// sRGB to linear. The power 2.4 is x² times the fifth root of x², by Newton's method, because
/// `powf` differs between platforms.
fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    let square = x * x;
    let root = (0..40).fold(1.0f64, |r, _| 0.2 * (4.0 * r + square / (r * r * r * r)));
    square * root
}

/// Linear value of an sRGB byte.
fn linear_of(byte: u8) -> f32 {
    SRGB.linear[byte as usize]
}

/// The sRGB byte nearest to a linear value.
fn byte_of(linear: f32) -> u8 {
    SRGB.halfway.partition_point(|&h| h < linear) as u8
}

/// All levels down to 1 x 1 of a square picture whose size is a power of two.
pub(super) fn chain(level_0: Vec<u8>, size: u32, content: Content) -> Vec<Vec<u8>> {
    let coverage = coverage(&level_0, 1.0);
    let mut levels = vec![level_0];
    let mut size = size as usize;
    while size > 1 {
        let mut level = halve(&levels[levels.len() - 1], size, content);
        size /= 2;
        if content == Content::MaskedColor {
            keep_coverage(&mut level, coverage);
        }
        levels.push(level);
    }
    levels
}

fn halve(fine: &[u8], size: usize, content: Content) -> Vec<u8> {
    let half = size / 2;
    let mut coarse = Vec::with_capacity(half * half * 4);
    let (fine, _) = fine.as_chunks::<4>();
    for y in 0..half {
        for x in 0..half {
            let at = 2 * y * size + 2 * x;
            let four = [at, at + 1, at + size, at + size + 1].map(|i| fine[i]);
            coarse.extend(average(four, content));
        }
    }
    coarse
}

fn average(four: [[u8; 4]; 4], content: Content) -> [u8; 4] {
    let mean = |c: usize| ((four.iter().map(|t| u32::from(t[c])).sum::<u32>() + 2) / 4) as u8;
    match content {
        Content::Linear => std::array::from_fn(mean),
        Content::Normal => {
            let sum = |c: usize| four.iter().map(|t| f32::from(t[c]) - 127.5).sum::<f32>();
            let n = glam::Vec3::new(sum(0), sum(1), sum(2)).normalize_or(glam::Vec3::Z);
            let [x, y, z] = n.to_array().map(|v| (v * 127.5 + 128.0) as u8);
            [x, y, z, 255]
        }
        Content::Color | Content::MaskedColor => {
            let weight: f32 = four.iter().map(|t| f32::from(t[3])).sum();
            let channel = |c: usize| {
                let sum: f32 = four
                    .iter()
                    .map(|t| linear_of(t[c]) * if weight > 0.0 { f32::from(t[3]) } else { 1.0 })
                    .sum();
                byte_of(sum / if weight > 0.0 { weight } else { 4.0 })
            };
            [channel(0), channel(1), channel(2), mean(3)]
        }
    }
}

/// Fraction of texels whose alpha times `scale` reaches one half.
fn coverage(level: &[u8], scale: f32) -> f32 {
    let (texels, _) = level.as_chunks::<4>();
    let passing = texels
        .iter()
        .filter(|t| f32::from(t[3]) * scale >= 127.5)
        .count();
    passing as f32 / texels.len() as f32
}

/// Scales alpha so that the coverage is the wanted one (Castaño 2010, 'Computing alpha mipmaps').
fn keep_coverage(level: &mut [u8], wanted: f32) {
    let (mut low, mut high) = (0.0f32, 8.0f32);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if coverage(level, middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    for texel in level.as_chunks_mut::<4>().0 {
        texel[3] = (f32::from(texel[3]) * high).min(255.0) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::hash::lattice;

    #[test]
    fn encoding_undoes_decoding() {
        for byte in 0..=255 {
            assert_eq!(byte_of(linear_of(byte)), byte);
        }
        assert!((linear_of(188) - 0.502_886).abs() < 1e-5);
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        let four = [
            [0, 0, 0, 255],
            [255, 255, 255, 255],
            [0, 0, 0, 255],
            [255, 255, 255, 255],
        ];
        assert_eq!(average(four, Content::Color), [188, 188, 188, 255]);
        assert_eq!(average(four, Content::Linear), [128, 128, 128, 255]);
    }

    #[test]
    fn masked_levels_keep_their_coverage() {
        let size = 64u32;
        let picture: Vec<u8> = (0..size * size)
            .flat_map(|i| [90, 120, 40, if lattice(i, 0, 9) % 3 == 0 { 255 } else { 0 }])
            .collect();
        let levels = chain(picture, size, Content::MaskedColor);
        assert_eq!(levels.len(), 7);
        assert!((coverage(&levels[2], 1.0) - 1.0 / 3.0).abs() < 0.25);
    }
}
