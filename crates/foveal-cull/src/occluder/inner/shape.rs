//! The boxes inside a mesh, and whether they are worth more than the mesh itself.

use super::super::weld::Welded;
use super::closed::is_closed;
use super::greedy::Greedy;
use super::grid::Lattice;
use super::inside::inside;
use super::kept::Outlines;
use super::touched::touched;
use crate::bounds::Aabb;
use glam::DVec3;

/// Most boxes.
const MOST_BOXES: usize = 8;
/// Triangles of a mesh per box: a box has 12, and boxes must be eight times as cheap.
const TRIANGLES_PER_BOX: usize = 8 * 12;
/// Most triangles of a mesh: lists of edges are 24 bytes a triangle.
const MOST_TRIANGLES: usize = 1 << 23;
/// The part of the mesh's outline that boxes must fill, and that a box must add.
const LEAST_KEPT: f64 = 0.5;
const LEAST_ADDED: f64 = 0.01;

/// Whether a mesh of so many triangles may have boxes at all, before it is welded.
pub(in super::super) fn may_have_boxes(triangles: usize) -> bool {
    (TRIANGLES_PER_BOX..=MOST_TRIANGLES).contains(&triangles)
}

/// Boxes inside a mesh, mesh space; none where the mesh itself is the better occluder: if it is not
/// closed, if it has fewer than 96 triangles per box, or if boxes fill less than half of its
/// outline in the mean over all directions.
pub(in super::super) fn inner_boxes(mesh: &Welded) -> Option<Vec<Aabb>> {
    let count = mesh.triangles.len();
    let most = (count / TRIANGLES_PER_BOX).min(MOST_BOXES);
    if most == 0 || count > MOST_TRIANGLES || !is_closed(&mesh.triangles) {
        return None;
    }
    let point = |v: u32| mesh.points[v as usize].as_dvec3();
    let corners = || mesh.triangles.iter().map(|t| t.map(point));
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lo, hi) = corners()
        .flatten()
        .fold(start, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let lattice = Lattice::over(lo, hi)?;
    let touched = touched(&lattice, corners())?;
    let solid = inside(&lattice, &touched, corners);
    let mut greedy = Greedy::new(&solid, &lattice);
    let mut outlines = Outlines::new(&lattice, &touched);
    let (mut boxes, mut kept) = (Vec::new(), 0.0);
    while boxes.len() < most {
        // Seen along the axes a few are the best; of these the one from all directions.
        let candidates = greedy.candidates().into_iter();
        let best = candidates
            .map(|found| {
                let (lo, hi) = (lattice.corner(found.lo), lattice.corner(found.hi));
                (outlines.added_by(lo, hi), found)
            })
            .max_by(|(a, _), (b, _)| a.total_cmp(b));
        let Some((added, found)) = best.filter(|(added, _)| *added >= LEAST_ADDED) else {
            break;
        };
        let (lo, hi) = (lattice.corner(found.lo), lattice.corner(found.hi));
        outlines.add(lo, hi);
        greedy.take(found);
        kept += added;
        boxes.extend(rounded_inwards(lo, hi));
    }
    (kept >= LEAST_KEPT && !boxes.is_empty()).then_some(boxes)
}

/// A box in `f32`, no larger; none if nothing is left.
fn rounded_inwards(lo: DVec3, hi: DVec3) -> Option<Aabb> {
    let up = |v: f64| {
        let near = v as f32;
        if f64::from(near) < v {
            near.next_up()
        } else {
            near
        }
    };
    let min = lo.to_array().map(up);
    let max = hi.to_array().map(|v| -up(-v));
    let solid = (0..3).all(|k| min[k] < max[k]);
    solid.then_some(Aabb { min, max })
}
