//! Silhouette margins: the pixels that a silhouette edge comes too near to.
//!
//! A margin only affects surfaces as deep as the patch can be within reach of the edge. Where the
//! cluster folds, its farther part stays.

use super::extent::out;
use super::points::Points;
use crate::depth::band::Band;
use crate::format::{BLOCK, BLOCK_SAMPLES, SAMPLES, encode};
use crate::simd::{Lanes, four, larger, smaller};

/// Distance from a sample to the farthest point that is nearer to it than to other samples, and
/// more than all rounding.
pub(super) const AROUND_SAMPLE: f32 = 0.8;

/// More than all rounding, samples.
const MARGIN: f32 = 0.0625;

/// The reach of silhouette edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Shift of a point at depth 1 along x and y, samples.
    pub(super) shifts: [f32; 2],
    /// Largest change of depth per sample on the patch, along x plus along y.
    pub(super) steepness: f32,
    /// Blocks in which the cluster is drawn: first and last, inclusive.
    pub(super) blocks: [u32; 4],
}

/// One silhouette edge, and the place and depth of its margin.
#[derive(Clone, Copy)]
struct SilhouetteEdge {
    /// One of its ends, samples.
    x: f32,
    y: f32,
    /// Change of x per y. Edges that are all but horizontal (NaN where both ends are the same) span
    /// their whole width in every row.
    slope: f32,
    /// Least x and y, and greatest.
    ends: [f32; 4],
    /// Reach along x and y, samples.
    reach: [f32; 2],
    /// First and last block within reach.
    blocks: [u32; 4],
    /// Depth code: what is not nearer is hidden whatever this edge does.
    code: i16,
    /// Farthest and nearest depth code that the patch can have within reach.
    depths: [i16; 2],
}

/// Edges with a larger slope count as horizontal.
const LEVEL: f32 = 1e4;

/// Marks the margins of the first `count` of eight silhouette edges, given by the vertices of their
/// ends.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn mark_margins<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    margin_blocks: &mut Vec<u32>,
    points: &Points,
    [from, to]: [&[u8; 8]; 2],
    count: usize,
    reach: &Reach,
) {
    let (ax, bx) = (l.gather(&points.x, from), l.gather(&points.x, to));
    let (ay, by) = (l.gather(&points.y, from), l.gather(&points.y, to));
    let (az, bz) = (l.gather(&points.depth, from), l.gather(&points.depth, to));
    let (near, far) = (az.max(bz), az.min(bz));
    let margin = l.splat(MARGIN);
    let [shift_x, shift_y] = reach.shifts;
    let reach_x = near * (shift_x * 1.001) + margin;
    let reach_y = near * (shift_y * 1.001) + margin;
    let ends = [ax.min(bx), ay.min(by), ax.max(bx), ay.max(by)];
    let grown = [
        ends[0] - reach_x,
        ends[1] - reach_y,
        ends[2] + reach_x,
        ends[3] + reach_y,
    ];
    // Only edges that come near to the blocks of the cluster.
    let size = BLOCK_SAMPLES as f32;
    let edge = four!(k => l.splat((reach.blocks[k] + k as u32 / 2) as f32 * size));
    let meets = grown[0].lt(edge[2])
        & !grown[2].lt(edge[0])
        & (grown[1].lt(edge[3]) & !grown[3].lt(edge[1]));
    let mut live = meets.bits() & ((1 << count) - 1);
    if live == 0 {
        return;
    }
    let blocks = four!(k => {
        let (first, last) = (reach.blocks[k % 2] as i32, reach.blocks[k % 2 + 2] as i32);
        let block = (grown[k] * (1.0 / size)).trunc();
        let mut out = [0; 8];
        block.max(l.int(first)).min(l.int(last)).store(&mut out);
        out
    });
    let around =
        l.splat(reach.steepness) * (l.splat(AROUND_SAMPLE) + reach_x.max(reach_y)) + near * 1e-5;
    let slope = (bx - ax) / (by - ay);
    let ends = four!(k => out(ends[k]));
    let (x, y, slope) = (out(ax), out(ay), out(slope));
    let (reach_x, reach_y) = (out(reach_x), out(reach_y));
    let near_codes = out(near * 1.001);
    let (far, near) = (out(far - around), out(near + around));
    while live != 0 {
        let i = live.trailing_zeros() as usize;
        live &= live - 1;
        let edge = SilhouetteEdge {
            x: x[i],
            y: y[i],
            slope: slope[i],
            ends: four!(k => ends[k][i]),
            reach: [reach_x[i], reach_y[i]],
            blocks: four!(k => blocks[k][i] as u32),
            code: encode(near_codes[i]).saturating_add(1),
            depths: [encode(far[i]), encode(near[i]).saturating_add(1)],
        };
        mark_margin(l, band, margin_blocks, &edge);
    }
}

/// Marks the margin of one silhouette edge.
#[cfg_attr(not(unoptimized), inline(always))]
fn mark_margin<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    margin_blocks: &mut Vec<u32>,
    edge: &SilhouetteEdge,
) {
    const PIXELS: [f32; 8] = [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0];
    let SilhouetteEdge {
        x,
        y,
        slope,
        ends: [x_lo, y_lo, x_hi, y_hi],
        reach: [reach_x, reach_y],
        blocks: [first, by0, last, by1],
        code,
        depths,
    } = *edge;
    // A cluster behind everything there is hidden whatever this edge does; in front of it, the edge
    // is behind.
    if band.hides(edge.blocks, code) {
        return;
    }
    let size = BLOCK_SAMPLES as f32;
    let level = slope.is_nan() || slope.abs() > LEVEL;
    let (lo, hi) = (l.splat(x_lo), l.splat(x_hi));
    for by in by0..=by1 {
        let top = (by * BLOCK_SAMPLES) as f32;
        let (mut bx0, mut bx1) = (first, last);
        if bx0 != bx1 && !level {
            // The edge is straight: no farther to the sides than where it enters and leaves the
            // reach of this row of blocks.
            let at = |row: f32| x + (smaller(larger(row, y_lo), y_hi) - y) * slope;
            let (p, q) = (at(top - reach_y), at(top + (size + reach_y)));
            let (p, q) = (smaller(p, q), larger(p, q));
            // Casts saturate.
            let column = |x: f32| ((x * (1.0 / size)) as u32).clamp(first, last);
            bx0 = column(smaller(larger(p, x_lo), x_hi) - reach_x);
            bx1 = column(smaller(larger(q, x_lo), x_hi) + reach_x);
        }
        let rows = l.load(&PIXELS) + top;
        let (above, below) = (rows - reach_y, rows + (reach_y + SAMPLES as f32));
        let beside = l.splat(y_hi).lt(above) | below.lt(l.splat(y_lo));
        let (mut from, mut to) = (lo, hi);
        if !level {
            let (top, bottom) = (l.splat(y_lo), l.splat(y_hi));
            let p = above.max(top).min(bottom) - y;
            let q = below.max(top).min(bottom) - y;
            let p = l.splat(x) + p * slope;
            let q = l.splat(x) + q * slope;
            from = p.min(q).max(lo).min(hi);
            to = p.max(q).max(lo).min(hi);
        }
        let from = beside.select(l.splat(1e9), from - reach_x);
        let to = beside.select(l.splat(-1e9), to + reach_x);
        // The first pixel of each row within reach, and the first after.
        let pixel = l.splat(1.0 / SAMPLES as f32);
        let from = (from * pixel).trunc();
        let to = (to * pixel + 1.0).trunc();
        for bx in bx0..=bx1 {
            let i = ((by - band.first_row) * band.blocks_x + bx) as usize;
            if code <= band.min[i] {
                continue;
            }
            let left = l.int((bx * BLOCK) as i32);
            let bits = (from - left).rows_to(to - left);
            if bits != 0 {
                band.has_margins = true;
                let (pixels, edge) = (&mut band.margin[i], &mut band.margin_depths[i]);
                if *pixels == 0 {
                    margin_blocks.push(i as u32);
                    *edge = [i16::MAX, i16::MIN];
                }
                *pixels |= bits;
                *edge = [edge[0].min(depths[0]), edge[1].max(depths[1])];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::buffer::OcclusionBuffer;
    use crate::simd::portable::Portable;

    /// Whether a segment meets a rectangle (least x and y, greatest), by cutting it at each side.
    fn meets(a: [f64; 2], b: [f64; 2], rect: [f64; 4]) -> bool {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let (start, along) = (a[axis], b[axis] - a[axis]);
            let (lo, hi) = (rect[axis] - start, rect[axis + 2] - start);
            if along == 0.0 {
                if lo > 0.0 || hi < 0.0 {
                    return false;
                }
                continue;
            }
            let (p, q) = (lo / along, hi / along);
            from = from.max(p.min(q));
            to = to.min(p.max(q));
        }
        from <= to
    }

    #[test]
    fn pixels_within_reach_of_a_silhouette_edge_are_its_margin_and_no_others() {
        let (width, height) = (80, 56);
        let mut seed = 1u32;
        let mut random = move |most: f32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32 * most
        };
        let mut counts = [0; 2];
        for round in 0..300 {
            let mut buffer = OcclusionBuffer::new(width, height);
            let mut points = Points::default();
            let mut ends = [[0u8; 8]; 2];
            let size = SAMPLES as f32;
            for v in 0..16u8 {
                // Some are horizontal, some upright, some short, some partly outside.
                let short = if round % 3 == 0 { 9.0 } else { 400.0 };
                let (x, y) = match v {
                    9 => (f64::from(points.x[8]), f64::from(random(short))),
                    11 => (f64::from(random(short)), f64::from(points.y[10])),
                    _ => (
                        f64::from(random(short) - 20.0),
                        f64::from(random(short) - 20.0),
                    ),
                };
                points.set(usize::from(v), x, y, 0.25 + random(0.5));
                ends[usize::from(v % 2)][usize::from(v / 2)] = v;
            }
            let reach = Reach {
                shifts: [random(12.0), random(3.0)],
                steepness: 0.01,
                blocks: [1, 0, 8, 5],
            };
            let count = 1 + round % 8;
            let mut margin_blocks = Vec::new();
            let [from, to] = &ends;
            let mut band = buffer.band();
            mark_margins(
                Portable,
                &mut band,
                &mut margin_blocks,
                &points,
                [from, to],
                count,
                &reach,
            );
            for by in 0..height / BLOCK {
                for bx in 0..width / BLOCK {
                    let i = by * (width / BLOCK) + bx;
                    let pixels = band.margin[i as usize];
                    assert_eq!(pixels != 0, margin_blocks.contains(&i));
                    if !(1..=8).contains(&bx) || by > 5 {
                        assert_eq!(pixels, 0);
                        continue;
                    }
                    for pixel in 0..BLOCK * BLOCK {
                        let left = (bx * BLOCK + pixel % BLOCK) as f32 * size;
                        let top = (by * BLOCK + pixel / BLOCK) as f32 * size;
                        let near = |slack: f64| {
                            (0..count).any(|e| {
                                let [a, b] = [from[e], to[e]].map(usize::from);
                                let depth = points.depth[a].max(points.depth[b]);
                                let [rx, ry] = reach
                                    .shifts
                                    .map(|s| f64::from(depth * s * 1.001 + MARGIN) + slack);
                                let rect = [
                                    f64::from(left) - rx,
                                    f64::from(top) - ry,
                                    f64::from(left + size) + rx,
                                    f64::from(top + size) + ry,
                                ];
                                let at =
                                    |v: usize| [f64::from(points.x[v]), f64::from(points.y[v])];
                                meets(at(a), at(b), rect)
                            })
                        };
                        let is = pixels >> pixel & 1 != 0;
                        assert!(is || !near(-1e-3), "round {round}: {left} {top}");
                        assert!(!is || near(1e-3), "round {round}: {left} {top}");
                        counts[usize::from(is)] += 1;
                    }
                }
            }
        }
        assert!(counts.iter().all(|&n| n > 10_000), "{counts:?}");
    }
}
