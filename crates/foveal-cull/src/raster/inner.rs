//! Inside a surface: pixels by their centre, where no edge is open.
//!
//! Take the quads of a cluster that surely face the eye, without those that are very thin or very steep: a sheet. An edge of
//! one of them is open if no other of them has it too, the other way round. From a point of the sheet that is seen in a pixel
//! follow the sheet along any straight line on the screen: where it reaches an edge that is not open, it goes on
//! with the quad beyond, which lies on the other side of that edge since it faces the eye too. So the way ends at the pixel's
//! border or at an open edge. Where no open edge crosses the pixel, the sheet covers all of it once it covers
//! its centre, whatever other quads it consists of there, and whether these are drawn or not.
//!
//! Along such a way depth changes by no more than the steepest quad of the sheet does. So such a pixel belongs to the quad with
//! its centre alone, at that quad's depth there less the steepest change to the outermost samples. Both quads of an
//! edge evaluate the same line at a centre, so that one of them has it.
//!
//! This is decided by blocks: those that an open edge touches take samples as all do, from the cluster and from
//! whatever else lies there, so that what only touches closes as before.

use super::band::Band;
use super::setup::{Points, area, highest, lowest};
use crate::depth::BLOCK_SAMPLES;
use crate::occluder::{Cluster, OccluderMesh};
use crate::simd::{Kernel, Lanes, four, larger, smaller};

/// A triangle surely faces the eye if it is higher than this over the sum of its quad's sides, samples: corners are
/// rounded by 1/512 at most.
const LEAST_HEIGHT: f32 = 0.125;
/// Quads whose depth changes by more than this part of the nearest one, per sample along x plus along y, do not count.
const STEEPEST: f32 = 1.0 / 64.0;
/// More than the rounding of a change of depth, for triangles that are not too thin.
const ROUNDING: f32 = 1.2;
/// More than all rounding of lines, samples.
const MARGIN: f32 = 0.25;

/// The sheet of the cluster that is being drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inner {
    /// A bit for each quad that belongs to it.
    pub(crate) quads: u64,
    /// No quad of it changes by more, per sample along x plus along y.
    pub(crate) steepest: f32,
}

/// Finds the sheet of a cluster, and marks the blocks (first and last, inclusive) that its open edges touch.
pub(super) struct Find<'a, 'b, 'c> {
    pub(super) band: &'a mut Band<'b>,
    pub(super) points: &'a Points,
    pub(super) mesh: &'c OccluderMesh,
    pub(super) cluster: &'c Cluster,
    pub(super) mirrored: bool,
    pub(super) blocks: [u32; 4],
}

impl Kernel for Find<'_, '_, '_> {
    type Output = Inner;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Inner {
        let Self {
            band,
            points,
            mesh,
            cluster,
            mirrored,
            blocks,
        } = self;
        let first = cluster.first_group as usize;
        let groups = first..first + usize::from(cluster.quad_count).div_ceil(8);
        let (i1, i3) = if mirrored { (3, 1) } else { (1, 3) };
        let order = [0, i1, 2, i3];
        let zero = l.splat(0.0);
        let (mut quads, mut steepest) = (0, zero);
        let pairs = mesh.quads[groups.clone()]
            .iter()
            .zip(&mesh.beyond[groups.clone()]);
        for (n, (group, beyond)) in pairs.enumerate() {
            let x = four!(c => l.gather(&points.x, &group[order[c]]));
            let y = four!(c => l.gather(&points.y, &group[order[c]]));
            let z = four!(c => l.gather(&points.depth, &group[order[c]]));
            let f0 = area(l, &x, &y, 0, 1, 2);
            let f1 = area(l, &x, &y, 0, 2, 3);
            let f3 = area(l, &x, &y, 0, 1, 3);
            let f2 = l.sub(l.add(f0, f1), f3);
            let w = l.sub(highest(l, &x), lowest(l, &x));
            let h = l.sub(highest(l, &y), lowest(l, &y));
            let least = l.mul(l.add(w, h), l.splat(LEAST_HEIGHT));
            let most = l.mul(highest(l, &z), l.splat(STEEPEST));
            let faces = [f0, f1].map(|f| l.lt(least, f));
            let (change0, change1) = (change(l, &x, &y, &z, 1, 2), change(l, &x, &y, &z, 2, 3));
            // Where a triangle is missing nothing is steep.
            let flat = l.iand(
                l.ior(
                    l.lt(change0, l.mul(most, f0)),
                    l.iandnot(faces[0], l.isplat(-1)),
                ),
                l.ior(
                    l.lt(change1, l.mul(most, f1)),
                    l.iandnot(faces[1], l.isplat(-1)),
                ),
            );
            let both = l.iand(
                l.iand(faces[0], faces[1]),
                l.iand(l.lt(least, f2), l.lt(least, f3)),
            );
            let one = l.iand(l.iload(&beyond.single), l.ior(faces[0], faces[1]));
            let member = l.iand(flat, l.ior(both, one));
            quads |= u64::from(l.movemask(member)) << (8 * n);
            let steep = l.max(
                l.select(faces[0], l.div(change0, f0), zero),
                l.select(faces[1], l.div(change1, f1), zero),
            );
            steepest = l.max(steepest, l.select(member, steep, zero));
        }
        // Lanes after the last quad have no area.
        if quads != 0 {
            band.cluster += 1;
            let mut left = quads;
            while left != 0 {
                let n = left.trailing_zeros() as usize;
                left &= left - 1;
                let (group, beyond) = (&mesh.quads[first + n / 8], &mesh.beyond[first + n / 8]);
                for e in 0..4 {
                    let other = beyond.quads[e][n % 8];
                    if [quads, 0][usize::from(other >> 6 & 1)] >> (other & 63) & 1 == 0 {
                        let ends = [e, (e + 1) % 4].map(|c| usize::from(group[c][n % 8]));
                        mark(band, points, ends, blocks);
                    }
                }
            }
        }
        let mut all = [0.0; 8];
        l.store(steepest, &mut all);
        Inner {
            quads,
            steepest: all.into_iter().fold(0.0, larger) * ROUNDING,
        }
    }
}

/// The change of depth per sample along x plus along y of the triangle of corners 0, `b` and `c`, times twice its area.
#[inline(always)]
fn change<L: Lanes>(l: L, x: &[L::F; 4], y: &[L::F; 4], z: &[L::F; 4], b: usize, c: usize) -> L::F {
    let [bx, by, bz] = [x, y, z].map(|v| l.sub(v[b], v[0]));
    let [cx, cy, cz] = [x, y, z].map(|v| l.sub(v[c], v[0]));
    l.add(
        l.abs(l.sub(l.mul(cz, by), l.mul(bz, cy))),
        l.abs(l.sub(l.mul(bz, cx), l.mul(cz, bx))),
    )
}

/// Marks the blocks that an edge touches.
#[inline(always)]
fn mark(band: &mut Band<'_>, points: &Points, [a, b]: [usize; 2], blocks: [u32; 4]) {
    let (ax, ay, bx, by) = (points.x[a], points.y[a], points.x[b], points.y[b]);
    let size = BLOCK_SAMPLES as f32;
    let (left, right) = (smaller(ax, bx) - MARGIN, larger(ax, bx) + MARGIN);
    let (top, bottom) = (smaller(ay, by) - MARGIN, larger(ay, by) + MARGIN);
    let [x0, y0, x1, y1] = blocks.map(|v| v as f32);
    if (right < x0 * size)
        | (left > (x1 + 1.0) * size)
        | (bottom < y0 * size)
        | (top > (y1 + 1.0) * size)
    {
        return;
    }
    let row = |y: f32| ((y * (1.0 / size)) as u32).clamp(blocks[1], blocks[3]);
    let column = |x: f32| ((x * (1.0 / size)) as u32).clamp(blocks[0], blocks[2]);
    // An edge that is all but level touches in every row what it touches in any.
    let (dx, dy) = (bx - ax, by - ay);
    let slope = if dy.abs() > MARGIN { dx / dy } else { 0.0 };
    let level = dy.abs() <= MARGIN;
    for by in row(top)..=row(bottom) {
        let (mut from, mut to) = (left, right);
        if !level {
            let y = (by * BLOCK_SAMPLES) as f32;
            let at = |y: f32| ax + (smaller(larger(y, top), bottom) - ay) * slope;
            let (upper, lower) = (at(y - MARGIN), at(y + size + MARGIN));
            from = larger(left, smaller(upper, lower) - MARGIN);
            to = smaller(right, larger(upper, lower) + MARGIN);
        }
        let start = ((by - band.first_row) * band.blocks_x) as usize;
        for bx in column(from)..=column(to) {
            band.open[start + bx as usize] = band.cluster;
        }
    }
}
