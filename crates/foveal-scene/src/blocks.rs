//! Blocks of 4 x 4 texels: from RGBA8 texels and back, a level at a time.
//!
//! BC7 is encoded by `basisu`, the rest by `block_compression`, which decodes all:
//! docs/decisions/0305-textures-in-blocks.md.
//!
//! Levels whose sides are no multiples of 4 end in blocks whose texels beyond the border repeat the
//! last ones; nothing reads them.

use std::borrow::Cow;

use block_compression::decode::{
    decode_block_bc1, decode_block_bc4, decode_block_bc5, decode_block_bc7,
};

use crate::{Encoding, Texture};

/// Sides of a block in texels, and bytes of one of its rows as RGBA8.
const SIDE: usize = 4;
const ROW: usize = 4 * SIDE;

impl Texture {
    /// The texels of a level as RGBA8, as a device that holds the blocks would read them; empty where
    /// there is no such level or its bytes are not those of its size.
    #[must_use]
    pub fn decoded_level(&self, level: usize) -> Cow<'_, [u8]> {
        let (width, height) = self.level_size(level);
        match self.levels.get(level) {
            Some(bytes) if bytes.len() as u64 == self.encoding.level_bytes(width, height) => {
                decode(bytes, (width, height), self.encoding)
            }
            _ => Cow::Borrowed(&[]),
        }
    }
}

/// The texels of a level as RGBA8. `bytes` has [`Encoding::level_bytes`].
fn decode(bytes: &[u8], (width, height): (u32, u32), encoding: Encoding) -> Cow<'_, [u8]> {
    if encoding == Encoding::Rgba8 {
        return Cow::Borrowed(bytes);
    }
    let (width, height) = (width as usize, height as usize);
    let mut texels = vec![0; width * height * 4];
    let across = width.div_ceil(SIDE);
    let blocks = bytes.chunks_exact(encoding.block_bytes() as usize);
    for (i, block) in blocks.enumerate() {
        let decoded = decode_block(block, encoding);
        let (x, y) = (i % across * SIDE, i / across * SIDE);
        let shown = 4 * (width - x).min(SIDE);
        for (row, y) in decoded.chunks_exact(ROW).zip(y..height) {
            let at = 4 * (y * width + x);
            texels[at..at + shown].copy_from_slice(&row[..shown]);
        }
    }
    Cow::Owned(texels)
}

fn decode_block(block: &[u8], encoding: Encoding) -> [u8; SIDE * ROW] {
    let mut texels = [0; SIDE * ROW];
    match encoding {
        Encoding::Rgba8 => {}
        Encoding::Bc1 => decode_block_bc1(block, &mut texels, ROW),
        Encoding::Bc7 => decode_block_bc7(block, &mut texels, ROW),
        Encoding::Bc4 => {
            let mut red = [0; SIDE * SIDE];
            decode_block_bc4(block, &mut red, SIDE);
            for (texel, red) in texels.as_chunks_mut::<4>().0.iter_mut().zip(red) {
                *texel = [red, 0, 0, 255];
            }
        }
        Encoding::Bc5 => {
            let mut both = [0; 2 * SIDE * SIDE];
            decode_block_bc5(block, &mut both, 2 * SIDE);
            let pairs = both.as_chunks::<2>().0;
            for (texel, [red, green]) in texels.as_chunks_mut::<4>().0.iter_mut().zip(pairs) {
                *texel = [*red, *green, 0, 255];
            }
        }
    }
    texels
}

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use encoder::{encode, make_opaque};

#[cfg(not(target_arch = "wasm32"))]
mod encoder {
    use basisu::fastenc::bc7f;
    use block_compression::CompressionVariant;
    use block_compression::encode::compress_rgba8;

    use super::{Encoding, ROW, SIDE};

    /// A level of RGBA8 texels in blocks. Without `alpha` nothing reads it. With it, opaque blocks
    /// come out opaque, so that masks of any threshold keep them.
    pub(crate) fn encode(
        texels: &[u8],
        (width, height): (u32, u32),
        encoding: Encoding,
        alpha: bool,
    ) -> Vec<u8> {
        let mut blocks = vec![0; encoding.level_bytes(width, height) as usize];
        let (width, height) = (width as usize, height as usize);
        let texels = texels.as_chunks::<4>().0;
        let across = width.div_ceil(SIDE);
        let of_blocks = blocks.chunks_exact_mut(encoding.block_bytes() as usize);
        for (i, out) in of_blocks.enumerate() {
            let (x, y) = (i % across * SIDE, i / across * SIDE);
            let block = std::array::from_fn(|k| {
                let (x, y) = (x + k % SIDE, y + k / SIDE);
                let [r, g, b, a] = texels[y.min(height - 1) * width + x.min(width - 1)];
                [r, g, b, if alpha { a } else { 255 }]
            });
            encode_block(&block, encoding, alpha, out);
        }
        blocks
    }

    fn encode_block(
        texels: &[[u8; 4]; SIDE * SIDE],
        encoding: Encoding,
        alpha: bool,
        out: &mut [u8],
    ) {
        let variant = match encoding {
            Encoding::Bc1 => CompressionVariant::BC1,
            Encoding::Bc4 => CompressionVariant::BC4,
            Encoding::Bc5 => CompressionVariant::BC5,
            Encoding::Rgba8 | Encoding::Bc7 => {
                let Some(out) = out.first_chunk_mut() else {
                    return;
                };
                if alpha {
                    bc7f::fast_pack_bc7_auto_rgba(out, texels, bc7f::flags::DEFAULT);
                    if texels.iter().all(|texel| texel[3] == 255) {
                        set_parity(out);
                    }
                } else {
                    bc7f::fast_pack_bc7_auto_rgb(out, texels, bc7f::flags::DEFAULT);
                }
                return;
            }
        };
        let (texels, side) = (texels.as_flattened(), SIDE as u32);
        compress_rgba8(variant, texels, out, side, side, ROW as u32);
    }

    /// The encoder and the transcoder may give an opaque block an alpha of 254: in mode 6 the lowest
    /// bit of all channels of an endpoint is one (Khronos Data Format 1.3, section 21), and they look
    /// at colour alone.
    fn set_parity(block: &mut [u8; 16]) {
        if is_mode_6(block) {
            block[7] |= 0x80;
            block[8] |= 1;
        }
    }

    fn is_mode_6(block: &[u8; 16]) -> bool {
        block[0].trailing_zeros() == 6
    }

    /// Brings blocks of BC7 whose alpha is 254 or more at either end to 255.
    pub(crate) fn make_opaque(blocks: &mut [u8]) {
        for block in blocks.as_chunks_mut::<16>().0 {
            // The seven bits of alpha above the parity bit, of either end.
            let is_full = block[6] & 0xFE == 0xFE && block[7] & 0x7F == 0x7F;
            if is_full {
                set_parity(block);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A soft picture with an edge, and alpha of its own.
    fn soft(width: u32, height: u32) -> Vec<u8> {
        let texel = |i: u32| {
            let (x, y) = ((i % width) as f32 / 7.0, (i / width) as f32 / 9.0);
            let wave = |phase: f32| (127.0 + 90.0 * (x + phase).sin() * (y - phase).cos()) as u8;
            let edge = if i % width > width / 2 { 30 } else { 0 };
            [
                wave(0.0) + edge,
                wave(0.3) + edge,
                wave(0.6),
                255 - wave(1.9),
            ]
        };
        (0..width * height).flat_map(texel).collect()
    }

    /// Root of the mean square difference of some channels.
    fn rms(a: &[u8], b: &[u8], channels: &[usize]) -> f64 {
        let pairs = a.chunks_exact(4).zip(b.chunks_exact(4));
        let squares = pairs.flat_map(|(a, b)| {
            let square = move |&c: &usize| f64::from(a[c].abs_diff(b[c])).powi(2);
            channels.iter().map(square)
        });
        (squares.sum::<f64>() / (a.len() / 4 * channels.len()) as f64).sqrt()
    }

    #[test]
    fn blocks_give_back_what_they_hold_about_as_it_was() {
        // Bounds on the root of the mean square, a third above what the encoder reaches.
        for (encoding, alpha, channels, most) in [
            (Encoding::Bc1, false, &[0, 1, 2][..], 7.0),
            (Encoding::Bc4, false, &[0], 3.0),
            (Encoding::Bc5, false, &[0, 1], 3.0),
            (Encoding::Bc7, false, &[0, 1, 2], 4.0),
            (Encoding::Bc7, true, &[0, 1, 2, 3], 4.0),
        ] {
            for (width, height) in [(64, 48), (4, 4), (5, 3), (2, 1), (1, 1), (30, 7)] {
                let texels = soft(width, height);
                let size = (width, height);
                let blocks = encode(&texels, size, encoding, alpha);
                assert_eq!(blocks.len() as u64, encoding.level_bytes(width, height));
                let back = decode(&blocks, size, encoding);
                assert_eq!(back.len(), texels.len());
                let off = rms(&texels, &back, channels);
                assert!(off < most, "{encoding:?} {width} x {height}: {off}");
                assert!(alpha || back.iter().skip(3).step_by(4).all(|&a| a >= 254));
            }
        }
    }

    #[test]
    fn opaque_blocks_stay_opaque_beside_others() {
        let mut texels = soft(64, 16);
        for (i, texel) in texels.chunks_exact_mut(4).enumerate() {
            if i % 64 / 4 % 3 != 1 {
                texel[3] = 255;
            }
        }
        let blocks = encode(&texels, (64, 16), Encoding::Bc7, true);
        let back = decode(&blocks, (64, 16), Encoding::Bc7);
        let mut opaque = 0;
        for (old, new) in texels.chunks_exact(4).zip(back.chunks_exact(4)) {
            if old[3] == 255 {
                assert_eq!(new[3], 255);
                opaque += 1;
            }
        }
        assert!((500..1000).contains(&opaque), "{opaque}");
    }

    #[test]
    fn blocks_of_nearly_full_alpha_are_made_opaque_and_no_others() {
        let block = |mode: u32, alpha: [u64; 2]| {
            let bits = 1 << mode | 0x55 << 7 | alpha[0] << 49 | alpha[1] << 56;
            let mut block = [0xA4; 16];
            block[..8].copy_from_slice(&u64::to_le_bytes(bits));
            block
        };
        let alphas = |block: &[u8]| -> Vec<u8> {
            let texels = decode(block, (4, 4), Encoding::Bc7);
            texels.iter().skip(3).step_by(4).copied().collect()
        };
        let mut full = block(6, [127, 127]);
        assert_eq!(alphas(&full), [254; 16]);
        make_opaque(&mut full);
        assert_eq!(alphas(&full), [255; 16]);
        for (mode, alpha) in [(6, [126, 127]), (6, [127, 63]), (5, [127, 127])] {
            let before = block(mode, alpha);
            let mut after = before;
            make_opaque(&mut after);
            assert_eq!(after, before);
        }
    }

    #[test]
    fn texels_of_another_size_than_their_level_has_are_not_decoded() {
        let mut texture = Texture {
            name: String::new(),
            width: 8,
            height: 4,
            color_space: crate::ColorSpace::Linear,
            sampler: crate::Sampler::default(),
            encoding: Encoding::Bc7,
            levels: vec![vec![0; 32]],
        };
        assert_eq!(texture.decoded_level(0).len(), 8 * 4 * 4);
        assert!(texture.decoded_level(1).is_empty());
        texture.levels[0].pop();
        assert!(texture.decoded_level(0).is_empty());
        for encoding in [Encoding::Rgba8, Encoding::Bc1, Encoding::Bc7] {
            (texture.width, texture.height) = (u32::MAX, u32::MAX);
            texture.encoding = encoding;
            assert!(texture.decoded_level(0).is_empty());
        }
    }
}
