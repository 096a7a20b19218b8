//! Coverage of alpha masks: the share of texels that pass the threshold.

/// What a mask is to keep on all its levels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask {
    threshold: f32,
    /// Share of texels that pass.
    wanted: f32,
}

/// How a level's alphas are stored so that the mask keeps its coverage.
#[derive(Debug)]
pub(super) struct Kept {
    /// Factor on alpha.
    pub(super) scale: f32,
    /// Where that alone does not keep it.
    dither: Option<Dither>,
}

/// Which of the texels that share an alpha pass.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dither {
    /// The 16-bit alpha that they share: larger ones pass, smaller ones do not.
    shared: u16,
    /// How many share it, and how many of these pass.
    sharing: usize,
    passing: usize,
}

/// Codes between texels of one alpha that pass and those that do not.
const STEP: f32 = 64.0;

impl Mask {
    /// Of a picture in RGBA8.
    pub(super) fn of(pixels: &[u8], threshold: f32) -> Self {
        let least = least_passing(threshold);
        let texels = pixels.as_chunks::<4>().0;
        let passes = |t: &&[u8; 4]| f32::from(u16::from(t[3]) * 257) >= least;
        let passing = texels.iter().filter(passes).count();
        Self {
            threshold,
            wanted: passing as f32 / texels.len() as f32,
        }
    }

    /// For a level.
    pub(super) fn keep(self, wide: &[[u16; 4]]) -> Kept {
        let wanted = self.wanted;
        if wanted <= 0.0 || wanted >= 1.0 {
            return Kept {
                scale: 1.0,
                dither: None,
            };
        }
        let mut alphas: Vec<u16> = wide.iter().map(|t| t[3]).collect();
        alphas.sort_unstable_by(|a, b| b.cmp(a));
        // Never nothing at all: things do not vanish in the distance.
        let passing = ((wanted * alphas.len() as f32).round() as usize).max(1);
        // The smallest alpha that is to pass. Where many texels share it, all of them pass or none
        // does, whichever is nearer, if that is near enough.
        let mut least = alphas[passing - 1];
        let above = alphas.partition_point(|&a| a > least);
        let with_ties = alphas.partition_point(|&a| a >= least);
        let (over, under) = (with_ties - passing, passing - above);
        let error = over.min(under) as f32 / alphas.len() as f32;
        if error > wanted.min(1.0 - wanted) / 2.0 {
            let dither = Dither {
                shared: least,
                sharing: with_ties - above,
                passing: under,
            };
            return self.kept(f32::from(least), Some(dither));
        }
        if above > 0 && over > under {
            least = alphas[above - 1];
        }
        // The threshold goes midway between the last that passes and the first that does not: a
        // renderer interpolates between texels, and with the threshold at either of them every
        // edge would move.
        let failing = alphas[alphas.partition_point(|&a| a >= least)..]
            .first()
            .copied();
        let middle = 0.5 * (f32::from(least) + f32::from(failing.unwrap_or(least)));
        self.kept(middle, None)
    }

    /// With the threshold at a 16-bit alpha.
    fn kept(self, alpha: f32, dither: Option<Dither>) -> Kept {
        // Codes round from half a step on; a tenth is for the rounding of the factor.
        let scale = (least_passing(self.threshold) - 0.4) / alpha.max(1.0);
        Kept {
            scale: scale.max(0.25),
            dither,
        }
    }

    /// Writes the alphas of those texels of a level that the scale alone does not part.
    pub(super) fn part(self, kept: &Kept, wide: &[[u16; 4]], width: usize, level: &mut [u8]) {
        let Some(dither) = kept.dither else {
            return;
        };
        let mut sharing: Vec<usize> = (0..wide.len())
            .filter(|&i| wide[i][3] == dither.shared)
            .collect();
        sharing.sort_by_key(|&i| order(i % width, i / width));
        let [fails, passes] = self.codes(dither.passing as f32 / dither.sharing as f32);
        let (texels, _) = level.as_chunks_mut::<4>();
        for (texel, wide) in texels.iter_mut().zip(wide) {
            // The scale has a bound.
            if wide[3] < dither.shared {
                texel[3] = texel[3].min(fails);
            }
        }
        for (rank, i) in sharing.into_iter().enumerate() {
            texels[i][3] = if rank < dither.passing { passes } else { fails };
        }
    }

    /// Alphas of texels that do not pass and that do, where a share of them passes.
    fn codes(self, share: f32) -> [u8; 2] {
        // Where the threshold lies between the two: of a single texel that passes, and of a single
        // hole, bilinear interpolation makes about a texel's area.
        let below = 0.38 + 0.24 * (2.0 * share - 0.5).clamp(0.0, 1.0);
        let threshold = least_code(self.threshold);
        let step = STEP
            .min(threshold / below)
            .min((255.0 - threshold) / (1.0 - below));
        let fails = (threshold - step * below).min(threshold - 1.0).round();
        let passes = (threshold + step * (1.0 - below)).round();
        [fails as u8, passes as u8]
    }
}

/// Place of a texel in an order whose every beginning is spread evenly (Bayer 1973, 'An Optimum
/// Method for Two-level Rendition of Continuous-tone Pictures').
fn order(x: usize, y: usize) -> u64 {
    let (x, y) = (x as u32, y as u32);
    (0..32).fold(0, |rank, bit| {
        let (x, y) = (x >> bit & 1, y >> bit & 1);
        rank << 2 | u64::from((x ^ y) << 1 | y)
    })
}

/// The smallest code that passes the threshold.
fn least_code(threshold: f32) -> f32 {
    (threshold * 255.0 - 1e-3).ceil().max(0.0)
}

/// The smallest 16-bit alpha that is stored as a code which passes the threshold.
fn least_passing(threshold: f32) -> f32 {
    least_code(threshold) * 257.0 - 128.0
}

#[cfg(test)]
mod tests {
    use crate::mip::{Content, chain};

    /// Share of texels that pass a threshold.
    fn share(level: &[u8], threshold: f32) -> f32 {
        let least = super::least_code(threshold) as u8;
        let alphas = level.iter().skip(3).step_by(4);
        alphas.filter(|a| **a >= least).count() as f32 / (level.len() / 4) as f32
    }

    /// The same of places between texels, where alphas are interpolated.
    fn interpolated_share(level: &[u8], side: usize, threshold: f32) -> f32 {
        let alpha = |x: usize, y: usize| f32::from(level[(y % side * side + x % side) * 4 + 3]);
        let steps = 8;
        let mut passing = 0;
        for (x, y) in (0..side * steps).flat_map(|y| (0..side * steps).map(move |x| (x, y))) {
            let part = |v: usize| ((v % steps) as f32 + 0.5) / steps as f32;
            let (fx, fy) = (part(x), part(y));
            let row = |y| {
                let x = x / steps;
                alpha(x, y) * (1.0 - fx) + alpha(x + 1, y) * fx
            };
            let y = y / steps;
            let found = row(y) * (1.0 - fy) + row(y + 1) * fy;
            passing += usize::from(found >= threshold * 255.0);
        }
        passing as f32 / (side * steps).pow(2) as f32
    }

    fn levels(side: u32, threshold: f32, alpha: impl Fn(u32, u32) -> u8) -> Vec<Vec<u8>> {
        let texels = (0..side * side).flat_map(|i| [80, 160, 40, alpha(i % side, i / side)]);
        let content = Content::Cutout {
            threshold: Some(threshold),
        };
        chain(texels.collect(), side, side, content)
    }

    #[test]
    fn masks_of_noise_keep_their_coverage() {
        // It passes a threshold of 0.7 on 30 % of the picture.
        let side = 64;
        let noise = |x: u32, y: u32| {
            let i = y * side + x;
            let mixed = (i.wrapping_mul(0x9E37_79B1) ^ i.rotate_left(16)).wrapping_mul(0x85EB_CA6B);
            (mixed >> 24) as u8
        };
        let kept = levels(side, 0.7, noise);
        let wanted = share(&kept[0], 0.7);
        assert!((wanted - 0.3).abs() < 0.02, "{wanted}");
        for (level, tolerance) in kept.iter().zip([0.0, 0.02, 0.02, 0.03, 0.05]) {
            let found = share(level, 0.7);
            assert!((found - wanted).abs() <= tolerance, "{found}");
        }
        // A whole picture of one alpha does not vanish.
        let even = levels(4, 0.7, |_, _| 180);
        assert!(even.iter().all(|l| share(l, 0.7) == 1.0));
    }

    #[test]
    fn a_fence_keeps_its_coverage_where_a_texel_has_whole_cells() {
        for (wire, threshold) in [(1, 0.5), (1, 0.1), (1, 0.9), (1, 1.0), (3, 0.5), (7, 0.5)] {
            // Square cells of 8 texels, with wires along two sides.
            let fence = |x, y| if x % 8 < wire || y % 8 < wire { 255 } else { 0 };
            let kept = levels(512, threshold, fence);
            let wanted = share(&kept[0], threshold);
            for (k, level) in kept.iter().enumerate().take(9) {
                let side = 512 >> k;
                let texels = (side * side) as f32;
                let tolerance = 0.5 / texels + wanted.min(1.0 - wanted) / 2.0;
                let found = share(level, threshold);
                let what = format!("wire {wire}, threshold {threshold}, side {side}");
                assert!(
                    (found - wanted).abs() <= tolerance + 1e-6,
                    "{what}: {found}"
                );
                assert!(found < 1.0 || wanted > 1.0 - 0.5 / texels, "{what}");
                if (4..=32).contains(&side) && threshold < 1.0 {
                    let found = interpolated_share(level, side, threshold);
                    assert!((found - wanted).abs() < 0.07, "{what}: {found}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn masks_of_any_period_keep_their_coverage() {
        for side in [60u32, 64, 100, 127] {
            for period in [2, 3, 4, 5, 8, 12, 16] {
                for hole in 1..period {
                    let kept = levels(side, 0.5, |x, y| {
                        if x % period < hole && y % period < hole {
                            0
                        } else {
                            255
                        }
                    });
                    let wanted = share(&kept[0], 0.5);
                    for level in &kept[..kept.len() - 1] {
                        let texels = (level.len() / 4) as f32;
                        // At least one passes.
                        let whole = if wanted * texels < 0.5 { 1.0 } else { 0.5 };
                        let tolerance = whole / texels + wanted.min(1.0 - wanted) / 2.0;
                        let found = share(level, 0.5);
                        let what = format!("side {side}, period {period}, hole {hole}");
                        assert!(
                            (found - wanted).abs() <= tolerance + 1e-6,
                            "{what}, {texels} texels: {found}, not {wanted}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_sparse_mask_does_not_vanish() {
        let kept = levels(64, 0.5, |x, y| if (x + y) % 64 == 0 { 255 } else { 0 });
        assert!(kept.iter().all(|level| share(level, 0.5) > 0.0));
        let dots = levels(
            64,
            0.5,
            |x, y| if x % 8 == 0 && y % 8 == 0 { 255 } else { 0 },
        );
        assert_eq!(share(&dots[3], 0.5), 1.0 / 64.0);
    }
}
