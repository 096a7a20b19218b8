//! Each step against what it promises.

use super::closed::is_closed;
use super::grid::{CELLS, Lattice, span};
use super::inner_boxes;
use super::touched::touched;
use crate::occluder::weld::{By, weld};
use glam::{DVec3, Vec3};

#[test]
fn a_mesh_is_closed_until_a_face_is_gone_or_turned() {
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    assert!(is_closed(&faces) && is_closed(&[]));
    // Two that share an edge, and the same one twice.
    let other = faces.map(|t| t.map(|v| if v > 1 { v + 2 } else { v }));
    assert!(is_closed(&[faces, other].concat()) && is_closed(&[faces, faces].concat()));
    for i in 0..4 {
        let mut open = faces.to_vec();
        open.remove(i);
        assert!(!is_closed(&open));
        let mut turned = faces;
        turned[i].swap(0, 2);
        assert!(!is_closed(&turned));
    }
}

#[test]
fn spans_of_bits_are_what_they_say() {
    for (from, to) in [(0, 0), (0, 64), (3, 7), (63, 64), (64, 64), (5, 5)] {
        let bits = (0..CELLS).filter(|i| span(from, to) >> i & 1 == 1);
        assert!(bits.eq(from..to), "{from} {to}");
    }
}

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Triangles of all sizes and slants, slivers and such without area too.
#[test]
fn every_cell_within_the_margin_of_a_triangle_is_touched() {
    let lattice = Lattice::over(DVec3::ZERO, DVec3::new(1.0, 3.0, 0.2)).unwrap();
    let mut r = Random(9);
    let size = DVec3::new(1.0, 3.0, 0.2);
    for i in 0..300 {
        let a = r.point() * size;
        let thin = [1.0, 0.1, 1e-4, 1e-12, 0.0][i % 5];
        let b = (a + (r.point() - 0.5) * size * [1.0, 0.05][i % 2]).clamp(DVec3::ZERO, size);
        let c = (a + (b - a) * r.unit() + (r.point() - 0.5) * size * thin).clamp(DVec3::ZERO, size);
        let cells = touched(&lattice, [[a, b, c]].into_iter()).unwrap();
        for _ in 0..2000 {
            let (u, v) = (r.unit(), r.unit());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let on = lattice.cells_of(a + (b - a) * u + (c - a) * v);
            let beside = on + (r.point() * 2.0 - 1.0) * lattice.margin * 0.999;
            let cell = beside.to_array().map(|x| x as usize);
            assert!(cells.has_all(cell, cell.map(|x| x + 1)), "{i}: {beside}");
        }
    }
}

/// A ball of `n` rows, whose points `shape` moves.
fn ball(n: u32, shape: impl Fn(Vec3) -> Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let point = |i: u32, j: u32| {
        let turn = i as f32 / n as f32 * core::f32::consts::TAU;
        let down = j as f32 / n as f32 * core::f32::consts::PI;
        let side = if j.is_multiple_of(n) { 0.0 } else { down.sin() };
        shape(Vec3::new(turn.cos() * side, down.cos(), -turn.sin() * side))
    };
    let points = (0..=n).flat_map(|j| (0..n).map(move |i| point(i, j)));
    let at = |i: u32, j: u32| j * n + if j.is_multiple_of(n) { 0 } else { i % n };
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j)));
    (points.collect(), triangles.collect())
}

/// Distance along a ray to a triangle's plane where the ray crosses the triangle, and the side that
/// it comes from: 1 from behind, -1 from the front.
fn crossing(from: DVec3, along: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, i32)> {
    let normal = (b - a).cross(c - a);
    let toward = normal.dot(along);
    let t = normal.dot(a - from) / toward;
    let at = from + along * t;
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(p, q)| (*q - *p).cross(at - *p).dot(normal) >= 0.0);
    (t > 0.0 && inside).then_some((t, if toward > 0.0 { 1 } else { -1 }))
}

/// By rays, which the search for boxes does not use: from anywhere on a box, out of the mesh.
#[test]
fn boxes_lie_inside_and_the_margin_away_from_the_surface() {
    let hollow = |p: Vec3| p * (1.0 + 0.45 * (p.x * 6.0).sin() * (p.z * 4.0).cos());
    let mut both = ball(24, |p| p * 1.4);
    let (points, triangles) = ball(20, |p| p * 0.5 + Vec3::new(0.3, 0.1, 0.0));
    let first = both.0.len() as u32;
    both.0.extend(points);
    // A void: faces inwards.
    both.1.extend(
        triangles
            .iter()
            .map(|&[a, b, c]| [b + first, a + first, c + first]),
    );
    let far = ball(30, |p| hollow(p) + Vec3::new(500.0, -60.0, 3.0));
    for (kind, (points, triangles)) in [ball(30, hollow), both, far].into_iter().enumerate() {
        let at = |i: u32| points[i as usize];
        let welded = weld(By::Position, points.len(), &at, triangles.into_iter());
        let boxes = inner_boxes(&welded).unwrap();
        assert!(!boxes.is_empty());
        let corners = (welded.triangles.iter()).map(|t| t.map(|v| points_of(&welded.points, v)));
        let corners: Vec<[DVec3; 3]> = corners.collect();
        let (lo, hi) = (corners.iter().flatten())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(*p), hi.max(*p))
            });
        let lattice = Lattice::over(lo, hi).unwrap();
        let margin = (lattice.margin * lattice.cell).min_element();
        let mut r = Random(3 + kind as u64);
        for bounds in boxes {
            let [min, max] = [bounds.min, bounds.max].map(|p| Vec3::from(p).as_dvec3());
            for i in 0..40 {
                let mut from = min + (max - min) * r.point();
                from[i % 3] = [min, max][i % 2][i % 3];
                let along = (r.point() - 0.5).normalize();
                let crossed = (corners.iter()).filter_map(|t| crossing(from, along, *t));
                let crossed: Vec<(f64, i32)> = crossed.collect();
                let winding: i32 = crossed.iter().map(|(_, side)| side).sum();
                assert_eq!(winding, 1, "{kind}: {from}");
                assert!(crossed.iter().all(|(t, _)| *t >= margin), "{kind}: {from}");
            }
        }
    }
}

fn points_of(points: &[Vec3], vertex: u32) -> DVec3 {
    points[vertex as usize].as_dvec3()
}
