//! Joining triangles to quads, so that two triangles share one set-up.
//!
//! Two triangles over a shared edge are joined where they are nearly flat together and form a
//! convex quadrilateral. The rasterizer is right for any such pair, since it measures the fold in
//! every view and lowers the depth by it; the tolerance is about cost, not safety. Candidates are
//! taken best first, and triangles with few other partners before those with many.

use super::half_edges::HalfEdges;
use glam::{DVec3, Vec3};

/// Vertices of a quad. A single triangle repeats its third.
pub(crate) type Quad = [u32; 4];

/// Largest height of the fold, as a part of the shared edge's length.
const MAX_FOLD: f64 = 0.08;

/// Joins welded triangles, at most a chunk of them.
pub(super) fn pair(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Quad> {
    let mut taken = vec![false; triangles.len()];
    let mut quads = Vec::with_capacity(triangles.len() / 2 + 1);
    for key in in_order(points, triangles) {
        let [i, j, e] = places(key);
        if taken[i] || taken[j] {
            continue;
        }
        let t = triangles[i];
        let (a, b, c) = (t[e], t[(e + 1) % 3], t[(e + 2) % 3]);
        let Some(d) = third(triangles[j], a, b) else {
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

/// The vertex of a triangle that is neither `a` nor `b`.
fn third(triangle: [u32; 3], a: u32, b: u32) -> Option<u32> {
    triangle.into_iter().find(|&v| v != a && v != b)
}

/// The keys of all candidates, from the least on.
fn in_order(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u64> {
    let edges = HalfEdges::new(points.len(), triangles);
    debug_assert!(triangles.len() <= 1 << TRIANGLE_BITS);
    let mut candidates = Vec::with_capacity(triangles.len());
    // How many others each triangle can be joined with: at most three.
    let mut partners = vec![0u8; triangles.len()];
    for (i, t) in (0u32..).zip(triangles) {
        for e in 0..3usize {
            let (a, b, c) = (t[e], t[(e + 1) % 3], t[(e + 2) % 3]);
            // Each pair once. Where several triangles have one directed edge, the first keeps it.
            let Some((j, _)) = edges.find(b, a).filter(|&(j, _)| j > i) else {
                continue;
            };
            if edges.find(a, b).map(|f| f.0) != Some(i) {
                continue;
            }
            let Some(d) = third(triangles[j as usize], a, b).filter(|&d| d != c) else {
                continue;
            };
            if let Some(score) = fold(points, [a, b, c, d]) {
                partners[i as usize] += 1;
                partners[j as usize] += 1;
                candidates.push(candidate(score as f32, i, j, e as u8));
            }
        }
    }
    for candidate in &mut candidates {
        *candidate = key(*candidate, &partners);
    }
    candidates.sort_unstable();
    candidates
}

/// Bits of the parts of a candidate, two triangles that can be joined, from the lowest: the edge of
/// the first that both share, the second, the first, the score. The score is below [`MAX_FOLD`], so
/// that the two highest bits of its 32 are zero.
const EDGE_BITS: u32 = 2;
const TRIANGLE_BITS: u32 = super::chunks::MOST_TRIANGLES.ilog2();
const SCORE_BITS: u32 = 30;
const PLACE_BITS: u32 = EDGE_BITS + 2 * TRIANGLE_BITS;

/// A candidate, ordered by its score.
fn candidate(score: f32, first: u32, second: u32, edge: u8) -> u64 {
    let head = u64::from(score.to_bits());
    let head = (head << TRIANGLE_BITS) | u64::from(first);
    let head = (head << TRIANGLE_BITS) | u64::from(second);
    (head << EDGE_BITS) | u64::from(edge)
}

/// A number by which candidates are ordered: flatter ones in some steps first, then those with few
/// other partners, then flatter ones exactly, then by number. No two are equal.
fn key(candidate: u64, partners: &[u8]) -> u64 {
    let [first, second, _] = places(candidate);
    let score = f32::from_bits((candidate >> PLACE_BITS) as u32);
    // Below four, as the score is below 0.08.
    let step = (f64::from(score) * 50.0) as u64;
    let lonely = partners[first].min(partners[second]);
    let head = (step << 2) | u64::from(lonely);
    (head << (SCORE_BITS + PLACE_BITS)) | candidate
}

/// The two triangles and the edge of a key.
fn places(key: u64) -> [usize; 3] {
    let low = |shift: u32, bits: u32| (key >> shift) as usize & ((1 << bits) - 1);
    [
        low(EDGE_BITS + TRIANGLE_BITS, TRIANGLE_BITS),
        low(EDGE_BITS, TRIANGLE_BITS),
        low(0, EDGE_BITS),
    ]
}

/// Fold of the pair (a, b, c) and (b, a, d), 0 if flat; `None` if the two cannot be joined.
fn fold(points: &[Vec3], [a, b, c, d]: [u32; 4]) -> Option<f64> {
    let [a, b, c, d] = [a, b, c, d].map(|i| points[i as usize].as_dvec3());
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
