//! Mip chains of RGBA8 pictures.
//!
//! Each level is the box filter of the one before, exact in area for odd sizes too (three taps with
//! weights that follow the texel borders). Colours are averaged as light, not as sRGB code values;
//! intermediate levels keep 16 bits so that rounding does not add up.

mod coverage;

use std::ops::Range;

use coverage::Mask;

use crate::Encoding;

/// What the channels mean for filtering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// sRGB colour; alpha is ignored by the material or not there.
    Color,
    /// sRGB colour with a meaningful alpha: transparent texels give no colour, and those of further
    /// levels have the colour around them. With a threshold above 0, the share of texels that pass
    /// it is kept the same on every level, by a factor on alpha (Castaño 2010, 'Computing alpha
    /// mipmaps') and, where many texels share an alpha, by dithering: as near as whole texels can
    /// come, but at least one.
    Cutout {
        /// Alpha threshold in 0 … 1 of an alpha mask; `None` for blending.
        threshold: Option<f32>,
    },
    /// Linear values.
    Data,
    /// Tangent-space normals; each texel is made unit length again.
    Normal,
}

/// Number of levels down to 1 x 1.
#[must_use]
pub fn level_count(width: u32, height: u32) -> u32 {
    32 - width.max(height).max(1).leading_zeros()
}

/// All levels of a picture, level 0 as given. `pixels` has `width * height * 4` bytes, and sides are
/// at least 1; otherwise level 0 is alone, and renderers refuse the texture by its name.
#[must_use]
pub fn chain(pixels: Vec<u8>, width: u32, height: u32, content: Content) -> Vec<Vec<u8>> {
    let bytes = Encoding::Rgba8.level_bytes(width, height);
    if bytes == 0 || pixels.len() as u64 != bytes {
        return vec![pixels];
    }
    let (mut w, mut h) = (width as usize, height as usize);
    let count = level_count(width, height) as usize;
    let mut levels = Vec::with_capacity(count);
    levels.push(pixels);
    if count == 1 {
        return levels;
    }
    let content = match content {
        // Everything passes, so every colour is seen.
        Content::Cutout {
            threshold: Some(threshold),
        } if threshold <= 0.0 => Content::Color,
        other => other,
    };
    let mask = match content {
        Content::Cutout {
            threshold: Some(threshold),
        } => Some(Mask::of(&levels[0], threshold)),
        _ => None,
    };
    let mut wide = Wide::new();
    for level in 1..count {
        wide = if level == 1 {
            // Row by row: the whole picture with 16 bits a channel would take twice its memory.
            halve(w, h, |rows, out| {
                widen(
                    &levels[0][rows.start * w * 4..rows.end * w * 4],
                    content,
                    out,
                );
            })
        } else {
            halve(w, h, |rows, out| {
                out.extend_from_slice(&wide[rows.start * w..rows.end * w]);
            })
        };
        (w, h) = ((w / 2).max(1), (h / 2).max(1));
        let kept = mask.map(|mask| (mask, mask.keep(&wide)));
        let scale = kept.as_ref().map_or(1.0, |(_, kept)| kept.scale);
        let mut narrowed = narrow(&wide, content, scale);
        if let Some((mask, kept)) = kept {
            mask.part(&kept, &wide, w, &mut narrowed);
        }
        levels.push(narrowed);
    }
    if matches!(content, Content::Cutout { .. }) {
        color_transparent(&mut levels, width as usize, height as usize);
    }
    levels
}

/// Gives texels of alpha 0 the colour around them, as the next level has it: a renderer
/// interpolates between them and their neighbours. Level 0 stays as given.
fn color_transparent(levels: &mut [Vec<u8>], width: usize, height: usize) {
    let side = |size: usize, level: usize| (size >> level).max(1);
    for level in (1..levels.len() - 1).rev() {
        let (finer, coarser) = levels.split_at_mut(level + 1);
        let w = side(width, level);
        let (next_w, next_h) = (side(width, level + 1), side(height, level + 1));
        let texels = finer[level].as_chunks_mut::<4>().0;
        for (i, texel) in texels.iter_mut().enumerate().filter(|(_, t)| t[3] == 0) {
            let (x, y) = ((i % w / 2).min(next_w - 1), (i / w / 2).min(next_h - 1));
            let from = (y * next_w + x) * 4;
            texel[..3].copy_from_slice(&coarser[0][from..from + 3]);
        }
    }
}

/// Texels as 16-bit numbers in the space where they may be averaged. Normals are offset by one
/// half.
type Wide = Vec<[u16; 4]>;

/// Appends texels as they may be averaged.
fn widen(pixels: &[u8], content: Content, out: &mut Wide) {
    let texels = pixels.as_chunks::<4>().0.iter();
    match content {
        Content::Color => {
            let linear = crate::srgb::to_linear16();
            out.extend(texels.map(|&[r, g, b, a]| {
                [
                    linear[r as usize],
                    linear[g as usize],
                    linear[b as usize],
                    u16::from(a) * 257,
                ]
            }));
        }
        Content::Cutout { .. } => {
            let linear = crate::srgb::to_linear16();
            out.extend(texels.map(|&[r, g, b, a]| {
                let alpha = u32::from(a) * 257;
                let weigh =
                    |c: u8| ((u32::from(linear[c as usize]) * alpha + 32767) / 65535) as u16;
                [weigh(r), weigh(g), weigh(b), alpha as u16]
            }));
        }
        Content::Data | Content::Normal => {
            out.extend(texels.map(|t| t.map(|c| u16::from(c) * 257)));
        }
    }
}

fn narrow(wide: &[[u16; 4]], content: Content, alpha_scale: f32) -> Vec<u8> {
    let byte = |x: u16| ((u32::from(x) + 128) / 257) as u8;
    let mut out = Vec::with_capacity(wide.len() * 4);
    match content {
        Content::Color => {
            let srgb = crate::srgb::from_linear16();
            for &[r, g, b, a] in wide {
                out.extend([
                    srgb[r as usize],
                    srgb[g as usize],
                    srgb[b as usize],
                    byte(a),
                ]);
            }
        }
        Content::Cutout { .. } => {
            let srgb = crate::srgb::from_linear16();
            for &[r, g, b, a] in wide {
                let alpha = u32::from(a).max(1);
                let plain = |c: u16| {
                    let c = (u32::from(c) * 65535 + alpha / 2) / alpha;
                    srgb[c.min(65535) as usize]
                };
                let scaled = (f32::from(a) / 65535.0 * alpha_scale).min(1.0);
                out.extend([plain(r), plain(g), plain(b), (scaled * 255.0 + 0.5) as u8]);
            }
        }
        Content::Data => {
            for texel in wide {
                out.extend(texel.map(byte));
            }
        }
        Content::Normal => {
            for &[x, y, z, a] in wide {
                let [x, y, z] = [x, y, z].map(|c| f32::from(c) / 32767.5 - 1.0);
                let length = (x * x + y * y + z * z).sqrt();
                // Opposite normals may cancel out; straight up is the neutral answer.
                let [x, y, z] = if length > 1e-3 {
                    [x, y, z].map(|c| c / length)
                } else {
                    [0.0, 0.0, 1.0]
                };
                let code = |c: f32| ((c * 0.5 + 0.5) * 255.0 + 0.5) as u8;
                out.extend([code(x), code(y), code(z), byte(a)]);
            }
        }
    }
    out
}

/// Half the size, rounded down, at least one texel each way. `read` appends the texels of a range
/// of rows.
fn halve(width: usize, height: usize, read: impl Fn(Range<usize>, &mut Wide)) -> Wide {
    let (w, h) = ((width / 2).max(1), (height / 2).max(1));
    let mut out = Vec::with_capacity(w * h);
    let mut rows = Wide::new();
    let columns: Vec<Taps> = (0..w).map(|i| Taps::of(i, width)).collect();
    for y in 0..h {
        let taps = Taps::of(y, height);
        rows.clear();
        read(taps.first..taps.first + taps.count, &mut rows);
        if width.is_multiple_of(2) && height.is_multiple_of(2) {
            halve_even(&rows, &mut out);
        } else {
            halve_odd(&rows, width, &columns, &taps, &mut out);
        }
    }
    out
}

/// One row out of one to three, by the share that each texel has.
fn halve_odd(rows: &[[u16; 4]], width: usize, columns: &[Taps], taps_y: &Taps, out: &mut Wide) {
    for taps_x in columns {
        let mut sum = [0f64; 4];
        for (row, (_, weight_y)) in rows.chunks_exact(width).zip(taps_y.iter()) {
            for (column, weight_x) in taps_x.iter() {
                for (s, c) in sum.iter_mut().zip(row[column]) {
                    *s += weight_y * weight_x * f64::from(c);
                }
            }
        }
        out.push(sum.map(|s| (s + 0.5) as u16));
    }
}

/// The common case: four texels of equal weight, from two rows.
fn halve_even(rows: &[[u16; 4]], out: &mut Wide) {
    let (upper, lower) = rows.split_at(rows.len() / 2);
    let pairs = upper
        .as_chunks::<2>()
        .0
        .iter()
        .zip(lower.as_chunks::<2>().0);
    out.extend(pairs.map(|([a, b], [c, d])| {
        std::array::from_fn(|k| {
            ((u32::from(a[k]) + u32::from(b[k]) + u32::from(c[k]) + u32::from(d[k]) + 2) / 4) as u16
        })
    }));
}

/// The texels under one texel of the next level, along one axis, and the share of each.
struct Taps {
    first: usize,
    count: usize,
    weights: [f64; 3],
}

impl Taps {
    fn of(i: usize, size: usize) -> Self {
        let n = size / 2;
        let (count, weights) = match size {
            1 => (1, [1.0, 0.0, 0.0]),
            _ if size.is_multiple_of(2) => (2, [0.5, 0.5, 0.0]),
            _ => {
                let whole = size as f64;
                let share = |x: usize| x as f64 / whole;
                (3, [share(n - i), share(n), share(i + 1)])
            }
        };
        Self {
            first: if size == 1 { 0 } else { 2 * i },
            count,
            weights,
        }
    }

    fn iter(&self) -> impl Iterator<Item = (usize, f64)> {
        (self.first..).zip(self.weights).take(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[u8]) -> Vec<u8> {
        values.iter().flat_map(|&v| [v, v, v, 255]).collect()
    }

    fn reds(level: &[u8]) -> Vec<u8> {
        level.iter().step_by(4).copied().collect()
    }

    #[test]
    fn a_picture_of_another_size_is_a_level_alone() {
        for (w, h, bytes) in [
            (2, 2, 15),
            (2, 2, 17),
            (2, 2, 0),
            (0, 0, 4),
            (0, 4, 0),
            (0, 4, 16),
            (u32::MAX, u32::MAX, 16),
        ] {
            for threshold in [None, Some(0.5)] {
                for content in [Content::Color, Content::Cutout { threshold }] {
                    let levels = chain(vec![7; bytes], w, h, content);
                    assert_eq!(levels, [vec![7; bytes]], "{w} x {h}, {bytes} bytes");
                }
            }
        }
    }

    #[test]
    fn sizes_go_down_to_one_texel() {
        for (w, h, levels) in [
            (1, 1, 1),
            (2, 1, 2),
            (8, 8, 4),
            (5, 3, 3),
            (1, 9, 4),
            (1023, 7, 10),
        ] {
            let chain = chain(vec![128; (w * h * 4) as usize], w, h, Content::Data);
            assert_eq!(chain.len() as u32, levels);
            assert_eq!(level_count(w, h), levels);
            for (k, level) in chain.iter().enumerate() {
                let texels = (w >> k).max(1) * (h >> k).max(1);
                assert_eq!(level.len() as u32, texels * 4, "{w} x {h} level {k}");
                assert!(level.iter().all(|&b| b == 128), "{w} x {h} level {k}");
            }
        }
    }

    #[test]
    fn even_sizes_average_four_texels_and_do_not_round_twice() {
        let data = chain(grey(&[0, 10, 20, 33]), 2, 2, Content::Data);
        assert_eq!(reds(&data[1]), [16]);
        // Four averages of 0.25 each would all round to 0, their sum is 0.25 again.
        let mut values = [0; 16];
        values[0] = 8;
        let chain = chain(grey(&values), 4, 4, Content::Data);
        assert_eq!(reds(&chain[1]), [2, 0, 0, 0]);
        assert_eq!(reds(&chain[2]), [1]);
    }

    #[test]
    fn odd_sizes_share_texels_by_area() {
        // Three texels to one: equal thirds.
        assert_eq!(
            reds(&chain(grey(&[0, 30, 90]), 3, 1, Content::Data)[1]),
            [40]
        );
        // Five to two: weights (2, 2, 1) / 5 and (1, 2, 2) / 5.
        let five = chain(grey(&[0, 50, 100, 150, 200]), 5, 1, Content::Data);
        assert_eq!(reds(&five[1]), [40, 160]);
        // Both axes: a 3 x 3 picture becomes its mean.
        let nine = chain(grey(&[0, 0, 0, 0, 90, 0, 0, 0, 0]), 3, 3, Content::Data);
        assert_eq!(reds(&nine[1]), [10]);
    }

    #[test]
    fn colours_are_averaged_as_light() {
        let half = chain(grey(&[0, 255]), 2, 1, Content::Color);
        assert_eq!(half[1], [188, 188, 188, 255]);
        let alpha = chain(vec![0, 0, 0, 0, 255, 255, 255, 255], 2, 1, Content::Color);
        assert_eq!(alpha[1], [188, 188, 188, 128]);
    }

    #[test]
    fn transparent_texels_give_no_colour() {
        let pixels = vec![200, 100, 50, 255, 0, 255, 0, 0];
        let blended = chain(pixels, 2, 1, Content::Cutout { threshold: None });
        assert_eq!(blended[1], [200, 100, 50, 128]);
    }

    #[test]
    fn transparent_texels_have_the_colour_around_them() {
        let cutout = |threshold| Content::Cutout { threshold };
        for content in [cutout(None), cutout(Some(0.5)), cutout(Some(0.0))] {
            for (w, h) in [(8, 1), (1, 8), (7, 1)] {
                let texel = |i| [0, 160, 0, if i < 4 { 0 } else { 255 }];
                let levels = chain((0..w * h).flat_map(texel).collect(), w, h, content);
                for level in levels {
                    let colors = level.as_chunks::<4>().0.iter().map(|t| [t[0], t[1], t[2]]);
                    assert!(colors.into_iter().all(|c| c == [0, 160, 0]), "{level:?}");
                }
            }
        }
        // Black under full transparency does not come back further up.
        let texel = |i: u32| if i < 4 { [0; 4] } else { [0, 160, 0, 255] };
        let pixels = (0..8).flat_map(texel).collect();
        let levels = chain(pixels, 8, 1, cutout(None));
        assert_eq!(levels[1][..4], [0, 160, 0, 0]);
    }

    #[test]
    fn normals_stay_unit_vectors() {
        // Straight up and 90 degrees to the side give 45 degrees.
        let pixels = vec![128, 128, 255, 255, 255, 128, 128, 255];
        let level = &chain(pixels, 2, 1, Content::Normal)[1];
        let decode = |c: u8| f32::from(c) / 127.5 - 1.0;
        let [x, y, z] = [level[0], level[1], level[2]].map(decode);
        assert!((x * x + y * y + z * z - 1.0).abs() < 0.02);
        assert!((x - z).abs() < 0.02 && y.abs() < 0.02);
    }
}
