//! The faces of a box on the screen, for boxes that their rectangle leaves undecided.
//!
//! A ray enters a box where it crosses the last of the (at most three) planes that face the eye,
//! and leaves it at the first of the others. The depth of a plane is affine over the screen, so
//! that a bound for all rays through a pixel or a whole block takes a few multiplications. Where a
//! front plane lies behind a back plane, the ray misses the box.
//!
//! All planes of one box are evaluated at once, one lane each, so that nothing branches on which of
//! them face the eye.

use super::axis_planes::AxisPlanes;
use super::plane_lanes::{AxisPlaneLanes, FRONTS, GAPS, NEARER, OF_AXIS, ROUNDING};
use crate::format::{BLOCK, BLOCK_SAMPLES, EMPTY, SAMPLES, decode};
use crate::simd::{Depths, F16, Lanes, Sixteen, four, three, two};
use glam::Vec3;

/// Distance from the centre of a pixel, or of a block, to rays that count as its own, samples: up
/// to one sample beside a sample, as for rectangles.
const PIXEL_REACH: f32 = 2.5;
const BLOCK_REACH: f32 = 16.5;

/// The planes of one box.
pub(crate) struct Faces<W: Sixteen> {
    /// Change to the right and downwards, depth at zero, and more than its rounding.
    x: F16<W>,
    y: F16<W>,
    at_zero: F16<W>,
    error: F16<W>,
    /// Absolute change to the right plus downwards.
    slope: F16<W>,
    /// Bit per lane with a front plane.
    fronts: u32,
}

impl<W: Sixteen> Faces<W> {
    /// `None` if the eye may be inside the box. `center` and `half` are relative to the boxes'
    /// origin, grown for rounding.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn new(w: W, planes: &AxisPlanes, center: Vec3, half: Vec3) -> Option<Self> {
        let center = center + planes.from_eye;
        let ends = [center - half, center + half];
        let [[lo, hi], [back_lo, back_hi]] = two!(n => two!(k => by_axis(w, ends[k], &OF_AXIS[n])));
        let AxisPlaneLanes { affine, parallel } = &planes.lanes;
        let [front, back] = two!(n => four!(k => w.load(&affine[n][k])));
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let (down, facing, known) = match parallel {
            None => {
                let down = [hi.lt(zero), back_hi.lt(zero)];
                let up = [zero.lt(lo), zero.lt(back_lo)];
                (down, two!(k => (down[k] | up[k]).bits()), !0)
            }
            Some(p) => (p.down.map(|bits| w.mask(bits)), [!0; 2], p.known),
        };
        let fronts = facing[0] & known & FRONTS;
        let gaps = facing[0] & !(facing[1] & NEARER) & known & GAPS;
        let near = down[0].select(hi, lo);
        let far = down[1].flipped(NEARER).select(back_lo, back_hi);
        let (at, errors) = match parallel {
            None => {
                let (u, v) = (one / near, w.mask(GAPS).select(one / far, zero));
                let at = three!(k => front[k] * u - back[k] * v);
                (at, [front[3] * u.abs(), back[3] * v.abs()])
            }
            Some(p) => {
                let u = w.load(&p.per_metre[0]) * near;
                let v = w.load(&p.per_metre[1]) * far;
                let at_zero = front[2] + u - (back[2] + v);
                let rounding = w.splat(ROUNDING);
                (
                    [front[0] - back[0], front[1] - back[1], at_zero],
                    [front[3] + rounding * u.abs(), back[3] + rounding * v.abs()],
                )
            }
        };
        let endless = w.splat(f32::INFINITY);
        let slope = at[0].abs() + at[1].abs();
        // Planes through the eye, or nearly so, decide nothing.
        let finite = (at[2].abs() + slope).lt(endless).bits();
        let (gaps, fronts) = (gaps & finite, fronts & finite);
        (fronts != 0).then_some(Self {
            x: at[0],
            y: at[1],
            // Lanes without a plane of this box never decide.
            at_zero: w.mask(gaps | fronts).select(at[2], endless),
            error: errors[0] + errors[1],
            slope,
            fronts,
        })
    }

    /// Whether the box is invisible in a block with farthest depth `min`, whatever its pixels are.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn miss(&self, w: W, bx: u32, by: u32, min: i16) -> bool {
        let [most, _] = self.over_block(bx, by);
        self.misses(w, most, min)
    }

    /// The same from the largest values in the block.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn misses(&self, w: W, most: F16<W>, min: i16) -> bool {
        // In a block with empty pixels no depth is too far.
        let nearer = if min == EMPTY {
            f32::NEG_INFINITY
        } else {
            decode(min)
        };
        let least = w.mask(GAPS).select(w.splat(0.0), w.splat(nearer));
        most.lt(least).bits() & (GAPS | FRONTS) != 0
    }

    /// Largest and smallest values in a block.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn over_block(&self, bx: u32, by: u32) -> [F16<W>; 2] {
        let center = |v: u32| (v * BLOCK_SAMPLES) as f32 + BLOCK_SAMPLES as f32 * 0.5;
        let value = self.at(center(bx), center(by));
        let reach = self.slope * BLOCK_REACH + self.error;
        [value + reach, value - reach]
    }

    /// Whether the box may be visible in any of the pixels `seen` of a block.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn seen<L: Lanes<W = W>>(
        &self,
        l: L,
        bx: u32,
        by: u32,
        seen: u64,
        min: i16,
        depth: Depths<L>,
    ) -> bool {
        let w = l.wide();
        let [most, least] = self.over_block(bx, by);
        if self.misses(w, most, min) {
            return false;
        }
        // Pixel by pixel, from the centre of the first one; only with gaps that may close in this
        // block.
        let mut open = least.lt(w.splat(0.0)).bits() & GAPS;
        let mut fronts = self.fronts;
        let pixel = SAMPLES as f32;
        let first = |v: u32| (v * BLOCK_SAMPLES) as f32 + 0.5 * pixel;
        let first = self.at(first(bx), first(by));
        let reach = self.slope * PIXEL_REACH;
        let first = first + reach + self.error;
        let (mut values, mut right, mut down) = ([0.0; 16], [0.0; 16], [0.0; 16]);
        first.store(&mut values);
        (self.x * pixel).store(&mut right);
        (self.y * pixel).store(&mut down);
        let mut seen = seen;
        while fronts != 0 {
            let i = fronts.trailing_zeros() as usize % 16;
            fronts &= fronts - 1;
            seen &= !depth.gt(block_codes(l, values[i], right[i], down[i], 1.0));
        }
        while open != 0 && seen != 0 {
            let i = open.trailing_zeros() as usize % 16;
            open &= open - 1;
            // Only the sign counts. Scaled by the largest term, so that nothing above its rounding
            // becomes the lowest code.
            let span = BLOCK as f32 * (right[i].abs() + down[i].abs());
            let scale = 1.0 / (values[i].abs() + span);
            if !scale.is_finite() {
                continue;
            }
            let codes = block_codes(l, values[i], right[i], down[i], scale);
            seen &= codes.gt(l.depth(i16::MIN));
        }
        seen != 0
    }

    /// The values at a point, rounded.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn at(&self, x: f32, y: f32) -> F16<W> {
        let slopes = self.x * x + self.y * y;
        slopes + self.at_zero
    }
}

/// The coordinate along each lane's axis.
#[cfg_attr(not(unoptimized), inline(always))]
fn by_axis<W: Sixteen>(w: W, v: Vec3, of: &[[f32; 16]; 3]) -> F16<W> {
    let [x, y, z] = three!(k => w.splat(v[k]) * w.load(&of[k]));
    x + y + z
}

/// Depth codes of the pixels of a block, from the largest value in the first one and its change
/// from pixel to pixel, times `scale`.
#[cfg_attr(not(unoptimized), inline(always))]
fn block_codes<L: Lanes>(l: L, first: f32, right: f32, down: f32, scale: f32) -> Depths<L> {
    const COLUMNS: [f32; BLOCK as usize] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let columns = l.splat(first * scale) + l.load(&COLUMNS) * (right * scale);
    columns.plane(down * scale, 0.0, i16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use crate::camera::Camera;
    use crate::simd::Kernel;
    use crate::{Eye, Projection, View};
    use glam::DVec3;

    /// One pixel, in a block of the same depth everywhere.
    struct Seen<'a>(&'a AxisPlanes, (Vec3, Vec3), [u32; 2], i16);

    impl Kernel for Seen<'_> {
        type Output = Option<bool>;

        #[cfg_attr(not(unoptimized), inline(always))]
        fn run<L: Lanes>(self, l: L) -> Option<bool> {
            let Self(planes, (center, half), [x, y], code) = self;
            let faces = Faces::new(l.wide(), planes, center, half)?;
            let bit = 1 << (y % BLOCK * BLOCK + x % BLOCK);
            Some(faces.seen(l, x / BLOCK, y / BLOCK, bit, code, l.depth(code)))
        }
    }

    #[test]
    fn a_box_is_seen_where_rays_enter_it_and_hardly_elsewhere() {
        let (width, height) = (160.0, 96.0);
        let mut seed = 1u32;
        let mut random = move |lo: f32, hi: f32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            lo + (hi - lo) * (seed >> 8) as f32 / (1 << 24) as f32
        };
        for projection in [
            Projection::perspective(1.0, width / height, 0.1, f64::INFINITY),
            Projection::orthographic(20.0, width / height, 0.1, 100.0),
        ] {
            let position = DVec3::new(3.0, 4.0, 12.0);
            let eye = Eye::look_at(position, DVec3::new(0.4, 0.3, 0.0), DVec3::Y, projection);
            let samples = f64::from(SAMPLES);
            let camera = Camera::new(&View::mono(eye), width * samples, height * samples).unwrap();
            let [w, h] = [width, height].map(|v| (v * samples) as f32);
            let planes = AxisPlanes::new(&camera, DVec3::ZERO, w, h).unwrap();
            let (mut entered, mut loose) = (0, 0);
            for _ in 0..6000 {
                let center = Vec3::from_array([0; 3].map(|_| random(-3.0, 3.0)));
                let half = Vec3::from_array([0; 3].map(|_| random(0.3, 4.0)));
                let pixel = [random(0.0, 160.0) as u32, random(0.0, 96.0) as u32];
                let nearest = |reach: f32| {
                    let steps = (-6..=6).map(|k| k as f32 / 6.0 * reach);
                    let [x, y] = pixel.map(|v| (v as f32 + 0.5) * SAMPLES as f32);
                    steps
                        .clone()
                        .flat_map(|dy| steps.clone().map(move |dx| (x + dx, y + dy)))
                        .map(|(x, y)| planes.entry(x, y, center, half))
                        .max()
                };
                let Some((inside, around)) =
                    nearest(0.99 * PIXEL_REACH).zip(nearest(1.2 * PIXEL_REACH))
                else {
                    continue;
                };
                // Just hidden, were it not for the rays.
                let code = if inside == EMPTY { EMPTY } else { inside - 1 };
                let ask =
                    |set: InstructionSet, code| set.run(Seen(&planes, (center, half), pixel, code));
                let seen = ask(InstructionSet::detect(), code);
                assert_eq!(seen, ask(InstructionSet::Portable, code));
                assert_eq!(seen, ask(InstructionSet::Sse2, code));
                assert_eq!(seen, ask(InstructionSet::Avx2, code));
                assert!(seen.is_some(), "the eye is outside");
                if inside > EMPTY {
                    entered += 1;
                    assert_eq!(seen, Some(true), "{center} {half} {pixel:?}");
                }
                // Nearer than all of the box, or beside it.
                let nearer = if around == EMPTY { EMPTY } else { around + 6 };
                if ask(InstructionSet::detect(), nearer) == Some(true) {
                    loose += 1;
                }
            }
            assert!(entered > 200, "too few rays enter: {entered}");
            // Each plane may be nearest in another corner of the pixel.
            assert!(loose < 60, "too many pixels without a ray: {loose}");
        }
    }
}
