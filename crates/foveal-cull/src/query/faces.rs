//! A box where it really is: its faces on the screen, for boxes whose rectangle says too little.
//!
//! A ray enters a box where it crosses the last of the (at most three) planes that face the eye, and leaves it
//! at the first of the others. The depth of a plane is affine over the screen, so a bound for all rays through
//! a pixel, or a whole block, takes a few multiplications; and where a front plane lies behind a back plane
//! the ray misses the box.

use crate::depth::{BLOCK, BLOCK_SAMPLES, EMPTY, SAMPLES, encode};
use crate::query::project::Boxes8;
use crate::simd::Lanes;
use crate::view::Camera;
use glam::{DMat3, DVec3, Vec3};

/// Relative error of a plane's depth, of the largest term; generous.
const ROUNDING: f32 = 4e-6;
/// Rays up to one sample beside a sample count as its own, as for rectangles; from the centre of a pixel and of
/// a block to there, samples.
const PIXEL_REACH: f32 = 2.5;
const BLOCK_REACH: f32 = 16.5;

/// A value that is affine over the screen, in samples, and more than its rounding.
#[derive(Clone, Copy, Debug, Default)]
struct Affine {
    x: f32,
    y: f32,
    at_zero: f32,
    error: f32,
}

impl Affine {
    /// The largest value around a point.
    #[inline(always)]
    fn most(&self, x: f32, y: f32, reach: f32) -> f32 {
        self.x * x + self.y * y + self.at_zero + (self.x.abs() + self.y.abs()) * reach + self.error
    }

    /// Largest and smallest value around a point.
    #[inline(always)]
    fn range(&self, x: f32, y: f32, reach: f32) -> (f32, f32) {
        let middle = self.x * x + self.y * y + self.at_zero;
        let reach = (self.x.abs() + self.y.abs()) * reach + self.error;
        (middle + reach, middle - reach)
    }

    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            at_zero: self.at_zero - other.at_zero,
            error: self.error + other.error,
        }
    }
}

/// How planes across the world's axes lie on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes {
    /// Per axis: depth of the plane at 1 m (perspective), or at 0 m from the eye.
    axes: [Affine; 3],
    /// Orthographic: change of depth per metre; perspective views divide by the metres.
    per_metre: Option<[f32; 3]>,
    /// From the eye to the boxes' origin, metres.
    from_eye: Vec3,
}

impl Planes {
    /// `None` for a view that cannot be turned round.
    pub(crate) fn new(camera: &Camera, origin: DVec3, width: f32, height: f32) -> Option<Self> {
        let [x, y, z, w] = camera.rows;
        let last = if camera.orthographic {
            camera.forward
        } else {
            w.truncate()
        };
        // Rows X, Y, and distance; the inverse takes (x, y, distance) to a point relative to the eye.
        let inverse = DMat3::from_cols(x.truncate(), y.truncate(), last)
            .transpose()
            .inverse();
        if !inverse.is_finite() {
            return None;
        }
        let affine = |at: DVec3| {
            let terms = at.x.abs() * f64::from(width) + at.y.abs() * f64::from(height) + at.z.abs();
            Affine {
                x: at.x as f32,
                y: at.y as f32,
                at_zero: at.z as f32,
                error: ROUNDING * terms as f32,
            }
        };
        let from_eye = (origin - camera.eye).as_vec3();
        let rows = [0, 1, 2].map(|axis| inverse.row(axis));
        if !camera.orthographic {
            return Some(Self {
                axes: rows.map(|r| affine(r * camera.near)),
                per_metre: None,
                from_eye,
            });
        }
        // A point is at (x - X.w, y - Y.w) on the screen and at distance t: p = a (x - X.w) + b (y - Y.w) + f t.
        // At p = k, t = (k - a (x - X.w) - b (y - Y.w)) / f, and the depth falls by `fall` per metre of t.
        let fall = z.truncate().dot(camera.forward);
        let per_metre = rows.map(|r| {
            if r.z.abs() < 1e-5 {
                f64::NAN
            } else {
                fall / r.z
            }
        });
        let axes = [0, 1, 2].map(|axis| {
            let (r, k) = (rows[axis], per_metre[axis]);
            let shift = r.x * x.w + r.y * y.w;
            affine(DVec3::new(-r.x * k, -r.y * k, shift * k + z.w))
        });
        Some(Self {
            axes,
            per_metre: Some(per_metre.map(|v| v as f32)),
            from_eye,
        })
    }

    /// Code of the depth where the ray through (x, y) enters a box; the lowest where it does not. Neither rounded up
    /// nor down: enough to call a box visible, which is never wrong.
    #[inline(always)]
    pub(crate) fn entry(&self, x: f32, y: f32, center: Vec3, half: Vec3) -> i16 {
        let center = center + self.from_eye;
        // Distances along the ray in units that grow with distance, from the last front to the first back plane.
        let (mut enter, mut leave) = (0.0f32, f32::INFINITY);
        for axis in 0..3 {
            let a = &self.axes[axis];
            let depth = a.x * x + a.y * y + a.at_zero;
            let (lo, hi) = (center[axis] - half[axis], center[axis] + half[axis]);
            let (lo, hi) = match self.per_metre {
                None => {
                    let per_depth = 1.0 / depth;
                    (lo * per_depth, hi * per_depth)
                }
                Some(k) if k[axis].is_nan() => continue,
                Some(k) => (1.0 - (depth + k[axis] * lo), 1.0 - (depth + k[axis] * hi)),
            };
            enter = enter.max(lo.min(hi));
            leave = leave.min(lo.max(hi));
        }
        if enter >= leave {
            return EMPTY;
        }
        encode(match self.per_metre {
            None => 1.0 / enter,
            Some(_) => 1.0 - enter,
        })
    }

    /// The same for eight boxes in perspective views, each at its own pixel.
    #[inline(always)]
    pub(crate) fn entries<L: Lanes>(
        &self,
        l: L,
        pixels: [&[i32; 8]; 2],
        boxes: &Boxes8,
    ) -> Option<[i32; 8]> {
        if self.per_metre.is_some() {
            return None;
        }
        let [x, y] = pixels.map(|v| l.load(&v.map(|v| (v as f32 + 0.5) * SAMPLES as f32)));
        let (one, mut enter, mut leave) = (l.splat(1.0), l.splat(0.0), l.splat(f32::INFINITY));
        for (axis, a) in self.axes.iter().enumerate() {
            let depth = l.add(
                l.add(l.mul(l.splat(a.x), x), l.mul(l.splat(a.y), y)),
                l.splat(a.at_zero),
            );
            let per_depth = l.div(one, depth);
            let center = l.add(l.load(&boxes.center[axis]), l.splat(self.from_eye[axis]));
            let half = l.load(&boxes.half[axis]);
            let (lo, hi) = (
                l.mul(l.sub(center, half), per_depth),
                l.mul(l.add(center, half), per_depth),
            );
            enter = l.max(enter, l.min(lo, hi));
            leave = l.min(leave, l.max(lo, hi));
        }
        let depth = l.select(l.lt(enter, leave), l.div(one, enter), l.splat(0.0));
        let mut codes = [0; 8];
        l.istore(l.codes(depth), &mut codes);
        Some(codes)
    }

    #[inline(always)]
    fn plane(&self, axis: usize, k: f32) -> Affine {
        let a = self.axes[axis];
        match self.per_metre {
            None => {
                let u = 1.0 / k;
                Affine {
                    x: a.x * u,
                    y: a.y * u,
                    at_zero: a.at_zero * u,
                    error: a.error * u.abs(),
                }
            }
            Some(per_metre) => {
                let v = per_metre[axis] * k;
                Affine {
                    at_zero: a.at_zero + v,
                    error: a.error + ROUNDING * v.abs(),
                    ..a
                }
            }
        }
    }
}

/// The planes of one box.
pub(crate) struct Faces {
    front: [Affine; 3],
    fronts: usize,
    /// Front minus back planes: above zero where a ray may meet the box.
    gaps: [Affine; 9],
    gap_count: usize,
}

impl Faces {
    /// `None` if the eye may be inside. `center` and `half` relative to the boxes' origin, grown for rounding.
    #[inline(always)]
    pub(crate) fn new(planes: &Planes, center: Vec3, half: Vec3) -> Option<Self> {
        let center = center + planes.from_eye;
        let (lo, hi) = (center - half, center + half);
        let mut faces = Self {
            front: [Affine::default(); 3],
            fronts: 0,
            gaps: [Affine::default(); 9],
            gap_count: 0,
        };
        let mut back = [(Affine::default(), 0); 6];
        let mut front_axes = [0; 3];
        let mut backs = 0;
        for axis in 0..3 {
            // Which of the two planes faces the eye: the lower one (1), the upper one (-1) or none.
            let facing = match planes.per_metre {
                None if lo[axis] > 0.0 => 1.0,
                None if hi[axis] < 0.0 => -1.0,
                None => 0.0,
                // Depth falls with distance.
                Some(per_metre) if per_metre[axis].is_nan() => continue,
                Some(per_metre) => -per_metre[axis].signum(),
            };
            let ends = [lo[axis], hi[axis]].map(|k| planes.plane(axis, k));
            let [near, far] = if facing < 0.0 {
                [ends[1], ends[0]]
            } else {
                ends
            };
            if facing != 0.0 {
                faces.front[faces.fronts] = near;
                front_axes[faces.fronts] = axis;
                faces.fronts += 1;
            } else {
                back[backs] = (near, axis);
                backs += 1;
            }
            back[backs] = (far, axis);
            backs += 1;
        }
        for (front, front_axis) in faces.front[..faces.fronts].iter().zip(front_axes) {
            for (plane, axis) in &back[..backs] {
                let gap = front.minus(plane);
                if *axis != front_axis && gap.at_zero.is_finite() && faces.gap_count < 9 {
                    faces.gaps[faces.gap_count] = gap;
                    faces.gap_count += 1;
                }
            }
        }
        (faces.fronts > 0).then_some(faces)
    }

    /// Whether the box may be seen in any of the pixels `seen` of a block.
    #[inline(always)]
    pub(crate) fn seen<L: Lanes>(
        &self,
        l: L,
        bx: u32,
        by: u32,
        seen: u64,
        min: i16,
        depth: L::D,
    ) -> bool {
        let half = BLOCK_SAMPLES as f32 * 0.5;
        let (x, y) = (
            (bx * BLOCK_SAMPLES) as f32 + half,
            (by * BLOCK_SAMPLES) as f32 + half,
        );
        let (fronts, gaps) = (&self.front[..self.fronts], &self.gaps[..self.gap_count]);
        let mut open = 0u32;
        for (i, g) in gaps.iter().enumerate() {
            let (most, least) = g.range(x, y, BLOCK_REACH);
            if most < 0.0 {
                return false;
            }
            open |= u32::from(least < 0.0) << i;
        }
        let mut nearest = f32::INFINITY;
        for f in fronts {
            nearest = nearest.min(f.range(x, y, BLOCK_REACH).0);
        }
        if encode(nearest) < min {
            return false;
        }
        // Pixel by pixel, from the middle of the first one; only with planes that matter in this block.
        let pixel = SAMPLES as f32;
        let (px, py) = (x - half + 0.5 * pixel, y - half + 0.5 * pixel);
        let mut seen = seen;
        for f in fronts {
            if f.range(x, y, BLOCK_REACH).1 <= nearest {
                seen &= !l.dgt(depth, block_codes(l, f, px, py, 1.0));
            }
        }
        while open != 0 && seen != 0 {
            let g = &gaps[open.trailing_zeros() as usize];
            open &= open - 1;
            // Only the sign counts; scaled, so that nothing above zero becomes the lowest code.
            seen &= l.dgt(block_codes(l, g, px, py, 1e6), l.dsplat(i16::MIN));
        }
        seen != 0
    }
}

/// Codes of the largest value in each pixel, times `scale`; (x, y) is the middle of the first pixel.
#[inline(always)]
fn block_codes<L: Lanes>(l: L, a: &Affine, x: f32, y: f32, scale: f32) -> L::D {
    const COLUMNS: [f32; BLOCK as usize] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let pixel = SAMPLES as f32;
    let first = a.most(x, y, PIXEL_REACH) * scale;
    let columns = l.add(
        l.splat(first),
        l.mul(l.load(&COLUMNS), l.splat(a.x * pixel * scale)),
    );
    l.depths(columns, a.y * pixel * scale, 0.0, i16::MAX)
}
