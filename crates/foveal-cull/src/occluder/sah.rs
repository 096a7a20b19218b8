//! The surface-area heuristic: where quads are best cut apart, by position and normal.

use super::quads::Quad;
use glam::{Vec3, Vec4};

/// A quad with its bounds and its normal.
pub(super) struct Item {
    pub(super) quad: Quad,
    lo: Vec4,
    hi: Vec4,
    normal: Vec4,
}

impl Item {
    pub(super) fn new(points: &[Vec3], quad: Quad) -> Self {
        let p = quad.map(|i| points[i as usize]);
        let (lo, hi) = p
            .iter()
            .fold((p[0], p[0]), |(lo, hi), &q| (lo.min(q), hi.max(q)));
        let normal = quad_normals(p)
            .into_iter()
            .flatten()
            .sum::<Vec3>()
            .normalize_or_zero();
        Self {
            quad,
            lo: lo.extend(0.0),
            hi: hi.extend(0.0),
            normal: normal.extend(0.0),
        }
    }

    pub(super) fn key(&self, axis: usize) -> f32 {
        if axis < 3 {
            self.lo[axis] + self.hi[axis]
        } else {
            self.normal[axis - 3]
        }
    }
}

/// Whether a cut leaves nearly all quads on one side.
pub(super) fn is_lopsided(at: usize, count: usize) -> bool {
    at.min(count - at) < count / 64
}

/// Unit normals of the quad's one or two triangles.
pub(super) fn quad_normals(p: [Vec3; 4]) -> [Option<Vec3>; 2] {
    let n = |a: Vec3, b: Vec3, c: Vec3| {
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        (b - a).cross(c - a).try_normalize().map(|n| n.as_vec3())
    };
    [n(p[0], p[1], p[2]), n(p[0], p[2], p[3])]
}

/// A split: the first `at` quads in the order of an axis (three of position, three of the normal).
#[derive(Clone, Copy)]
pub(super) struct Cut {
    pub(super) cost: f32,
    pub(super) axis: usize,
    pub(super) at: usize,
}

/// Cost of setting up a cluster, in quads.
const COST_OF_CLUSTER: f32 = 32.0;

/// Most lopsided cuts on the way to a cluster. Each takes time in proportion to all quads and leaves
/// nearly all of them.
pub(super) const MOST_LOPSIDED: u32 = 64;

/// Bins per axis.
const BINS: usize = 32;

/// The cheapest split between bins along the six axes, by the surface-area heuristic; halves where
/// that says nothing, or after too many lopsided cuts.
pub(super) fn cut(items: &[Item], lopsided: u32) -> Cut {
    let (mut lo, mut hi) = ([Vec4::INFINITY; 2], [Vec4::NEG_INFINITY; 2]);
    for item in items {
        for (k, key) in [item.lo + item.hi, item.normal].into_iter().enumerate() {
            (lo[k], hi[k]) = (lo[k].min(key), hi[k].max(key));
        }
    }
    let scale = [0, 1].map(|k| Vec4::splat(BINS as f32) / (hi[k] - lo[k]));
    let mut bins = [[Part::NONE; BINS]; 6];
    for item in items {
        let part = Part::one(item);
        for (k, key) in [item.lo + item.hi, item.normal].into_iter().enumerate() {
            // Where the scale is not finite, any bin will do.
            let bin = ((key - lo[k]) * scale[k]).to_array();
            for axis in 0..3 {
                let bin = &mut bins[3 * k + axis][(bin[axis] as usize).min(BINS - 1)];
                *bin = bin.with(&part);
            }
        }
    }
    let halves = Cut {
        cost: f32::INFINITY,
        axis: 0,
        at: items.len() / 2,
    };
    let mut best = halves;
    for (axis, bins) in bins.iter().enumerate() {
        if !scale[axis / 3][axis % 3].is_finite() {
            continue;
        }
        let mut after = [Part::NONE; BINS + 1];
        for k in (0..BINS).rev() {
            after[k] = after[k + 1].with(&bins[k]);
        }
        let mut before = Part::NONE;
        for k in 1..BINS {
            before = before.with(&bins[k - 1]);
            if before.count == 0 || after[k].count == 0 {
                continue;
            }
            let cost = before.cost() + after[k].cost();
            if cost < best.cost {
                (best.cost, best.axis, best.at) = (cost, axis, before.count);
            }
        }
    }
    // Of surfaces too small for `f32` all costs are alike, and the first border is no better.
    let says_nothing = best.cost < f32::MIN_POSITIVE;
    if says_nothing || lopsided >= MOST_LOPSIDED && is_lopsided(best.at, items.len()) {
        halves
    } else {
        best
    }
}

/// Bounds of some quads and of their normals.
#[derive(Clone, Copy)]
pub(super) struct Part {
    count: usize,
    lo: Vec4,
    hi: Vec4,
    normal_lo: Vec4,
    normal_hi: Vec4,
}

impl Part {
    const NONE: Self = Self {
        count: 0,
        lo: Vec4::INFINITY,
        hi: Vec4::NEG_INFINITY,
        normal_lo: Vec4::INFINITY,
        normal_hi: Vec4::NEG_INFINITY,
    };

    fn one(item: &Item) -> Self {
        Self {
            count: 1,
            lo: item.lo,
            hi: item.hi,
            normal_lo: item.normal,
            normal_hi: item.normal,
        }
    }

    pub(super) fn of(items: &[Item]) -> Self {
        let mut part = Self::NONE;
        items.iter().for_each(|i| part = part.with(&Self::one(i)));
        part
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            normal_lo: self.normal_lo.min(other.normal_lo),
            normal_hi: self.normal_hi.max(other.normal_hi),
        }
    }

    /// The mean cost of drawing the quads: how often they are seen (the surface of their box, times
    /// the part of all directions from which any of them faces the eye), times what set-up then
    /// takes.
    pub(super) fn cost(&self) -> f32 {
        let size = (self.hi - self.lo).truncate();
        let surface = size.dot(Vec3::new(size.y, size.z, size.x));
        // At least the sine of the half angle of the cone of normals.
        let normals = (self.normal_hi - self.normal_lo).truncate();
        let spread = (normals.length() * 0.5).min(1.0);
        surface * (0.5 + 0.5 * spread) * (self.count.next_multiple_of(8) as f32 + COST_OF_CLUSTER)
    }
}
