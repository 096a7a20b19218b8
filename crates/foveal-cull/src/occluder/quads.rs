//! Joining triangles to quads, so that two triangles share one set-up.
//!
//! Two triangles over a shared edge are joined where they are nearly flat together and form a
//! convex quadrilateral. The rasterizer is right for any such pair, since it measures the fold in
//! every view and lowers the depth by it; the tolerance is about cost, not safety. Candidates are
//! taken best first, and triangles with few other partners before those with many.

use super::half_edges::HalfEdges;
use super::in_parts::{in_parts, in_parts_of, part_range, parts_of};
use super::weld::Welded;
use crate::threads::Threads;
use glam::DVec3;

/// Vertices of a quad. A single triangle repeats its third.
pub(crate) type Quad = [u32; 4];

/// Largest height of the fold, as a part of the shared edge's length.
const MAX_FOLD: f64 = 0.08;

/// Fewest triangles that are worth a part.
const LEAST_TRIANGLES: usize = 4096;

pub(super) fn pair(mesh: &Welded, edges: &HalfEdges, threads: &dyn Threads) -> Vec<Quad> {
    let triangles = &mesh.triangles;
    let parts = parts_of(threads, triangles.len(), LEAST_TRIANGLES);
    let found = in_parts(threads, parts, &|i| {
        Found::of(mesh, edges, part_range(triangles.len(), parts, i))
    });
    let order = in_order(found, threads);
    let mut taken = vec![false; triangles.len()];
    let mut quads = Vec::with_capacity(triangles.len() / 2 + 1);
    for key in order {
        let [i, j, e] = places(key);
        if taken[i] || taken[j] {
            continue;
        }
        let t = triangles[i];
        let (a, b, c) = (t[e], t[(e + 1) % 3], t[(e + 2) % 3]);
        let Some(d) = triangles[j].iter().copied().find(|&v| v != a && v != b) else {
            continue;
        };
        taken[i] = true;
        taken[j] = true;
        // The diagonal is v0-v2: triangles (v0, v1, v2) and (v0, v2, v3).
        quads.push([b, c, a, d]);
    }
    quads.extend((0..triangles.len()).filter(|&i| !taken[i]).map(|i| {
        let [a, b, c] = triangles[i];
        [a, b, c, c]
    }));
    quads
}

/// The keys of all candidates, from the least on.
fn in_order(found: Vec<Found>, threads: &dyn Threads) -> Vec<u128> {
    // One list, which begins as the first part's: on a single thread nothing is copied.
    let mut found = found.into_iter();
    let Some(first) = found.next() else {
        return Vec::new();
    };
    let (mut partners, mut order) = (first.partners, first.candidates);
    for further in found {
        partners.extend(further.partners);
        order.extend(further.candidates);
    }
    let parts = parts_of(threads, order.len(), LEAST_TRIANGLES);
    let size = order.len().div_ceil(parts).max(1);
    let mut chunks: Vec<&mut [u128]> = order.chunks_mut(size).collect();
    in_parts_of(threads, &mut chunks, &|chunk| {
        for candidate in chunk.iter_mut() {
            *candidate = key(*candidate, &partners);
        }
        chunk.sort_unstable();
    });
    if chunks.len() > 1 {
        // Finds the sorted runs and merges them.
        order.sort();
    }
    order
}

/// Bits of the parts of a candidate, two triangles that can be joined, from the lowest: the edge of
/// the first that both share, the second, the first, the score. The score is below [`MAX_FOLD`], so
/// that the two highest bits of its 64 are zero.
const EDGE_BITS: u32 = 2;
const TRIANGLE_BITS: u32 = 29;
const SCORE_BITS: u32 = 62;
const PLACE_BITS: u32 = EDGE_BITS + 2 * TRIANGLE_BITS;

/// A candidate, ordered by its score.
fn candidate(score: f64, first: u32, second: u32, edge: u8) -> u128 {
    let head = u128::from(score.to_bits());
    let head = (head << TRIANGLE_BITS) | u128::from(first);
    let head = (head << TRIANGLE_BITS) | u128::from(second);
    (head << EDGE_BITS) | u128::from(edge)
}

/// A number by which candidates are ordered: flatter ones in some steps first, then those with few
/// other partners, then flatter ones exactly, then by number. No two are equal.
fn key(candidate: u128, partners: &[u8]) -> u128 {
    let [first, second, _] = places(candidate);
    let score = f64::from_bits((candidate >> PLACE_BITS) as u64);
    let step = (score * 50.0) as u128;
    // At most three.
    let lonely = partners[first].min(partners[second]);
    let head = (step << 2) | u128::from(lonely);
    (head << (SCORE_BITS + PLACE_BITS)) | candidate
}

/// The two triangles and the edge of a key.
fn places(key: u128) -> [usize; 3] {
    let low = |shift: u32, bits: u32| (key >> shift) as usize & ((1 << bits) - 1);
    [
        low(EDGE_BITS + TRIANGLE_BITS, TRIANGLE_BITS),
        low(EDGE_BITS, TRIANGLE_BITS),
        low(0, EDGE_BITS),
    ]
}

/// Candidates whose first triangle is in a range, and how many partners each triangle of it has.
struct Found {
    candidates: Vec<u128>,
    partners: Vec<u8>,
}

impl Found {
    fn of(mesh: &Welded, edges: &HalfEdges, range: core::ops::Range<usize>) -> Self {
        let triangles = &mesh.triangles;
        let mut found = Self {
            candidates: Vec::with_capacity(range.len()),
            partners: vec![0; range.len()],
        };
        for (i, partners) in range.zip(&mut found.partners) {
            let t = triangles[i];
            for e in 0..3u8 {
                let (a, b, c) = (
                    t[usize::from(e)],
                    t[usize::from((e + 1) % 3)],
                    t[usize::from((e + 2) % 3)],
                );
                // Where several triangles have one directed edge, the first keeps it.
                let Some((j, _)) = edges.find(b, a) else {
                    continue;
                };
                if j as usize == i || edges.find(a, b).map(|f| f.0) != Some(i as u32) {
                    continue;
                }
                let third = triangles[j as usize].iter().copied();
                let Some(d) = third.into_iter().find(|&v| v != a && v != b) else {
                    continue;
                };
                if d == c {
                    continue;
                }
                if let Some(score) = fold(mesh, [a, b, c, d]) {
                    *partners += 1;
                    if (i as u32) < j {
                        let new = candidate(score, i as u32, j, e);
                        found.candidates.push(new);
                    }
                }
            }
        }
        found
    }
}

/// Fold of the pair (a, b, c) and (b, a, d), 0 if flat; `None` if the two cannot be joined.
fn fold(mesh: &Welded, [a, b, c, d]: [u32; 4]) -> Option<f64> {
    let [a, b, c, d] = [a, b, c, d].map(|i| mesh.points[i as usize].as_dvec3());
    let n0 = (b - a).cross(c - a);
    let n1 = (d - a).cross(b - a);
    let n = (n0 + n1).try_normalize()?;
    // Convex around the corners a and b, seen along the mean normal.
    let orientation = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - q).dot(n);
    let scale = (b - a).length_squared().max((c - d).length_squared());
    if orientation(c, a, d) < 1e-4 * scale || orientation(d, b, c) < 1e-4 * scale {
        return None;
    }
    let height = (d - a)
        .dot(n0.try_normalize()?)
        .abs()
        .max((c - a).dot(n1.try_normalize()?).abs());
    let score = height / scale.sqrt();
    (score < MAX_FOLD).then_some(score)
}
