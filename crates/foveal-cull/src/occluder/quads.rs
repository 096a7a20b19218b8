//! Joining triangles to quads, so that two triangles share one set-up.
//!
//! Two triangles over a shared edge are joined where they are nearly flat together and form a
//! convex quadrilateral. The rasterizer is right for any such pair, since it measures the fold in
//! every view and lowers the depth by it; the tolerance is about cost, not safety. Candidates are
//! taken best first, and triangles with few other partners before those with many.

use super::weld::Welded;
use glam::DVec3;
use std::collections::HashMap;

/// Vertices of a quad. A single triangle repeats its third.
pub(crate) type Quad = [u32; 4];

/// Largest height of the fold, as a part of the shared edge's length.
const MAX_FOLD: f64 = 0.08;

pub(crate) fn pair(mesh: &Welded) -> Vec<Quad> {
    let triangles = &mesh.triangles;
    let mut half_edges: HashMap<(u32, u32), u32> = HashMap::with_capacity(triangles.len() * 3);
    for (i, t) in triangles.iter().enumerate() {
        for e in 0..3 {
            // Where several triangles use one directed edge, the first keeps it.
            half_edges.entry((t[e], t[(e + 1) % 3])).or_insert(i as u32);
        }
    }
    let mut candidates: Vec<(f64, u32, u32, u8)> = Vec::new();
    let mut partners = vec![0u8; triangles.len()];
    for (i, t) in triangles.iter().enumerate() {
        for e in 0..3u8 {
            let (a, b, c) = (
                t[usize::from(e)],
                t[usize::from((e + 1) % 3)],
                t[usize::from((e + 2) % 3)],
            );
            let Some(&j) = half_edges.get(&(b, a)) else {
                continue;
            };
            if j as usize == i || half_edges.get(&(a, b)) != Some(&(i as u32)) {
                continue;
            }
            let Some(d) = triangles[j as usize]
                .iter()
                .copied()
                .find(|&v| v != a && v != b)
            else {
                continue;
            };
            if d == c {
                continue;
            }
            if let Some(score) = fold(mesh, [a, b, c, d]) {
                partners[i] = partners[i].saturating_add(1);
                if (i as u32) < j {
                    candidates.push((score, i as u32, j, e));
                }
            }
        }
    }
    candidates.sort_by(|x, y| {
        let lonely = |c: &(f64, u32, u32, u8)| partners[c.1 as usize].min(partners[c.2 as usize]);
        let key = |c: &(f64, u32, u32, u8)| (c.0 * 50.0).floor();
        key(x)
            .total_cmp(&key(y))
            .then(lonely(x).cmp(&lonely(y)))
            .then(x.0.total_cmp(&y.0))
            .then((x.1, x.2).cmp(&(y.1, y.2)))
    });
    let mut taken = vec![false; triangles.len()];
    let mut quads = Vec::with_capacity(triangles.len() / 2 + 1);
    for (_, i, j, e) in candidates {
        let (i, j) = (i as usize, j as usize);
        if taken[i] || taken[j] {
            continue;
        }
        let t = triangles[i];
        let e = usize::from(e);
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
