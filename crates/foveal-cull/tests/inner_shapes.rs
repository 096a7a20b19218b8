//! Boxes inside a mesh hide nothing that is visible beside the mesh itself.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::promise::hidden;
use common::{Exact, Object, Random, Scene};
use foveal_cull::{
    Aabb, BakeOptions, Culler, Eye, FrameOptions, OccluderMesh, OccluderSet, Projection,
    SingleThread, View, Visibility,
};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Mesh = (Vec<Vec3>, Vec<u32>);

/// A closed ball of 4 n² triangles, whose points `shape` moves.
fn ball(n: u32, shape: impl Fn(Vec3) -> Vec3) -> Mesh {
    let around = 2 * n;
    let point = |i: u32, j: u32| {
        let turn = i as f32 / around as f32 * core::f32::consts::TAU;
        let down = j as f32 / n as f32 * core::f32::consts::PI;
        let side = if j.is_multiple_of(n) { 0.0 } else { down.sin() };
        shape(Vec3::new(turn.cos() * side, down.cos(), -turn.sin() * side))
    };
    let positions = (0..=n).flat_map(|j| (0..around).map(move |i| point(i, j)));
    let at = |i: u32, j: u32| j * around + if j.is_multiple_of(n) { 0 } else { i % around };
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [a, b, c, a, c, d]
    };
    let indices = (0..n).flat_map(|j| (0..around).flat_map(move |i| quad(i, j)));
    (positions.collect(), indices.collect())
}

/// A ring around the y axis: its hole has a radius of 1.2, the ring itself of `tube`.
fn torus(n: u32, tube: f32) -> Mesh {
    let turn = |i: u32| (i as f32 / n as f32 * core::f32::consts::TAU).sin_cos();
    let point = |i: u32, j: u32| {
        let ((s, c), (up, out)) = (turn(i), turn(j));
        let far = 1.2 + tube * (1.0 + out);
        Vec3::new(c * far, up * tube, s * far)
    };
    let positions = (0..n).flat_map(|i| (0..n).map(move |j| point(i, j)));
    let at = |i: u32, j: u32| i % n * n + j % n;
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [a, b, c, a, c, d]
    };
    let indices = (0..n).flat_map(|i| (0..n).flat_map(move |j| quad(i, j)));
    (positions.collect(), indices.collect())
}

/// A stone: bumps of several sizes, without symmetry.
fn stone(p: Vec3) -> Vec3 {
    let wave = |x: f32, y: f32, z: f32, k: f32| (p.dot(Vec3::new(x, y, z)) * k).sin();
    let bumps = 0.15 * wave(0.8, 0.3, 0.5, 5.0) + 0.08 * wave(-0.3, 0.9, 0.3, 9.0);
    p * (1.0 + bumps + 0.03 * wave(0.1, 0.5, -0.8, 40.0)) * Vec3::new(1.3, 0.8, 1.0)
}

fn join(mut a: Mesh, (positions, indices): Mesh) -> Mesh {
    let first = a.0.len() as u32;
    a.0.extend(positions);
    a.1.extend(indices.iter().map(|i| i + first));
    a
}

fn moved((mut positions, indices): Mesh, by: Vec3) -> Mesh {
    positions.iter_mut().for_each(|p| *p += by);
    (positions, indices)
}

fn turned((positions, mut indices): Mesh) -> Mesh {
    indices.chunks_exact_mut(3).for_each(|t| t.swap(0, 1));
    (positions, indices)
}

const SHAPES: usize = 9;

/// Closed meshes of all kinds: convex or not, with a hole, of several shells that cross, are hollow
/// or touch, inside out in a part, and with triangles of no area.
fn closed(kind: usize) -> Mesh {
    match kind {
        0 => ball(14, |p| p),
        1 => ball(30, stone),
        2 => torus(40, 0.7),
        3 => ball(24, |p| {
            p * (1.0 + 0.5 * (p.x * 7.0).sin() * (p.y * 5.0).cos())
        }),
        4 => join(ball(16, |p| p * 1.2), turned(ball(10, |p| p * 0.6))),
        5 => join(ball(16, |p| p), moved(ball(16, |p| p), Vec3::X * 0.9)),
        6 => join(
            ball(20, |p| p),
            turned(moved(ball(12, |p| p * 0.7), Vec3::X * 0.8)),
        ),
        7 => ball(20, |p| {
            p.clamp(Vec3::splat(-0.4), Vec3::splat(0.4)) + p * 0.2
        }),
        _ => {
            let mut both = ball(16, |p| p * Vec3::new(3.0, 0.3, 1.0));
            both.1.extend([7, 7, 8, 40, 41, 40]);
            both
        }
    }
}

fn inner() -> BakeOptions {
    BakeOptions::default().with_inner_shape(true)
}

fn bake((positions, indices): &Mesh, options: BakeOptions) -> OccluderMesh {
    OccluderMesh::bake(positions, indices, options).unwrap()
}

/// A placement: mirrored, stretched, sheared, or flat, which has no inverse.
fn place(r: &mut Random, at: DVec3) -> DAffine3 {
    let turn = DQuat::from_euler(
        glam::EulerRot::XYZ,
        r.range(-3.0, 3.0),
        r.range(-3.0, 3.0),
        r.range(-3.0, 3.0),
    );
    let mut m = DMat3::from_quat(turn) * r.range(0.5, 1.5);
    if r.below(3) == 0 {
        m *= DMat3::from_diagonal(DVec3::new(-1.0, 1.0, r.range(0.3, 2.0)));
    }
    if r.below(4) == 0 {
        m.z_axis += m.x_axis * r.range(-1.5, 1.5);
    }
    if r.below(16) == 0 {
        m.y_axis = m.x_axis * [0.0, 1e-7, 0.5][r.below(3)];
    }
    DAffine3::from_mat3_translation(m, at)
}

fn boxes(r: &mut Random) -> Vec<Aabb> {
    let one = |_| {
        let reach = [2.0, 2.0, 7.0][r.below(3)];
        let center = r.vec(reach).as_vec3();
        let half = Vec3::splat(10f64.powf(r.range(-2.0, 0.0)) as f32);
        Aabb::new(center - half, center + half)
    };
    (0..150).map(one).collect()
}

/// An eye far away, beside the surface, or inside, with near planes that cut.
fn eye(r: &mut Random, origin: DVec3) -> Eye {
    let distance = [6.0, 4.0, 3.0, 2.0, 1.6, 0.7, 0.0][r.below(7)];
    let from = r.vec(1.0).normalize();
    let position = origin + from * distance;
    let target = origin
        + r.vec(0.9)
        + if distance < 1.0 {
            r.vec(2.0)
        } else {
            DVec3::ZERO
        };
    let near_m = [0.01, 0.3, 1.5][r.below(3)];
    let (w, h) = (r.range(0.4, 1.4), r.range(0.4, 1.4));
    let projection = if r.below(4) == 0 {
        Projection::Orthographic {
            left: -3.0 * w,
            right: 2.0 * w,
            bottom: -3.0 * h,
            top: 2.0 * h,
            near_m: r.range(-4.0, 1.0),
            far_m: 30.0,
        }
    } else {
        Projection::Perspective {
            left: -w,
            right: w * r.range(0.3, 1.0),
            bottom: -h,
            top: h,
            near_m,
            far_m: [f64::INFINITY, 20.0][r.below(2)],
        }
    };
    Eye::look_at(position, target, DVec3::Y, projection)
}

fn results(set: &OccluderSet, view: &View, scene: &Scene, size: (u32, u32)) -> Vec<Visibility> {
    let mut culler = Culler::new(size.0, size.1).unwrap();
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    culler
        .rasterize(view, set, &options, &SingleThread)
        .unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    results
}

/// A scene of one object as it is drawn, and the set of its inner shape.
fn one(mesh: &Mesh, transform: DAffine3, boxes: Vec<Aabb>, origin: DVec3) -> (Scene, OccluderSet) {
    let shape = bake(mesh, inner());
    assert!(shape.is_inner_shape());
    let mut set = OccluderSet::new();
    set.add(Arc::new(shape), transform).unwrap();
    let object = Object {
        positions: mesh.0.clone(),
        indices: mesh.1.clone(),
        transform,
        two_sided: false,
    };
    let scene = Scene {
        objects: vec![object],
        boxes,
        origin,
    };
    (scene, set)
}

/// Boxes that are hidden and that one of the eyes sees, at one and four times the resolution.
fn wrong(scene: &Scene, eyes: &[Eye], size: (u32, u32), results: &[Visibility]) -> Vec<usize> {
    let of = |(eye, n): (&Eye, u32)| Exact::new(scene, eye, size, n).wrongly_culled(scene, results);
    let all = eyes.iter().flat_map(|e| [(e, 1), (e, 4)]);
    all.flat_map(of).collect()
}

/// Whether nothing visible is culled in a random scene; gives how many boxes are hidden.
fn culls_nothing_visible(seed: u64) -> Result<usize, TestCaseError> {
    let mut r = Random::new(seed);
    let origin = [DVec3::ZERO, DVec3::new(1e6, -2e5, 3e6)][r.below(2)];
    let at = origin + r.vec(0.5);
    let transform = place(&mut r, at);
    let boxes = boxes(&mut r);
    let (scene, set) = one(&closed(r.below(SHAPES)), transform, boxes, origin);
    let size = (24 + r.below(40) as u32, 16 + r.below(40) as u32);
    let mut count = 0;
    let mut check = |view: &View, eyes: &[Eye]| {
        let results = results(&set, view, &scene, size);
        count += hidden(&results);
        let wrong = wrong(&scene, eyes, size, &results);
        prop_assert!(wrong.is_empty(), "{view:?}: {wrong:?}");
        Ok(())
    };
    for _ in 0..4 {
        let center = eye(&mut r, origin);
        let mono = View::mono(center);
        check(&mono, &[center])?;
        let radius = [0.01, 0.1, 0.4][r.below(3)];
        let around = [0, 1].map(|_| {
            let step = DAffine3::from_translation(r.vec(1.0).normalize() * (radius * 0.999));
            let pose = step * DAffine3::from(center.world_from_eye);
            Eye::new(pose, center.projection)
        });
        check(&mono.with_validity_radius(radius), &around)?;
        if !center.projection.is_orthographic() {
            let apart = DAffine3::from_translation(DVec3::X * r.range(0.05, 0.6));
            let cant = DAffine3::from_rotation_y(r.range(-0.15, 0.15));
            let pose = DAffine3::from(center.world_from_eye) * apart * cant;
            let other = Eye::new(pose, center.projection);
            check(&View::stereo(center, other), &[center, other])?;
        }
    }
    Ok(count)
}

#[test]
fn inner_shapes_cull_nothing_visible() {
    let mut runner = TestRunner::new(ProptestConfig {
        cases: 300,
        rng_seed: RngSeed::Fixed(25),
        failure_persistence: None,
        ..ProptestConfig::default()
    });
    let all = AtomicUsize::new(0);
    let run = runner.run(&any::<u64>(), |seed| {
        all.fetch_add(culls_nothing_visible(seed)?, Ordering::Relaxed);
        Ok(())
    });
    run.unwrap();
    let all = all.into_inner();
    assert!(all > 5000, "{all}");
}

/// Boxes behind an object, in a ring of directions around it.
fn behind(direction: DVec3) -> Vec<Aabb> {
    let mut r = Random::new(5);
    let one = |_| {
        let center = (direction * r.range(2.5, 6.0) + r.vec(1.2)).as_vec3();
        Aabb::new(center - 0.05, center + 0.05)
    };
    (0..400).map(one).collect()
}

fn away(direction: DVec3, near_m: f64) -> View {
    let projection = Projection::perspective(0.8, 1.0, near_m, f64::INFINITY);
    View::mono(Eye::look_at(
        direction * -6.0,
        DVec3::ZERO,
        DVec3::new(0.1, 1.0, 0.2),
        projection,
    ))
}

#[test]
fn boxes_hide_most_of_what_a_ball_and_a_stone_hide() {
    for kind in [0, 1] {
        let mesh = closed(kind);
        // For one eye, for a region around it, and for two eyes.
        let (mut of_mesh, mut of_boxes) = ([0; 3], [0; 3]);
        for direction in [[1.0, 0.3, 0.2], [0.1, 0.9, 0.4], [-0.5, -0.5, 0.7]] {
            let direction = DVec3::from(direction).normalize();
            let (scene, set) = one(&mesh, DAffine3::IDENTITY, behind(direction), DVec3::ZERO);
            let mut plain = OccluderSet::new();
            let baked = bake(&mesh, BakeOptions::default());
            plain.add(Arc::new(baked), DAffine3::IDENTITY).unwrap();
            let view = away(direction, 0.1);
            let mut other = view.eye;
            other.world_from_eye.translation[1] += 0.06;
            let stereo = View::stereo(view.eye, other);
            for (i, view) in [view, view.with_validity_radius(0.02), stereo]
                .iter()
                .enumerate()
            {
                of_mesh[i] += hidden(&results(&plain, view, &scene, (96, 96)));
                of_boxes[i] += hidden(&results(&set, view, &scene, (96, 96)));
            }
        }
        // Silhouette margins leave little of a dense mesh for more than one eye.
        let enough = (0..3).all(|i| of_boxes[i] * 3 > of_mesh[0] * 2);
        assert!(
            of_mesh[0] > 1000 && enough,
            "{kind}: {of_boxes:?} of {of_mesh:?}"
        );
    }
}

#[test]
fn the_hole_of_a_ring_stays_open() {
    let view = away(DVec3::Y, 0.1);
    let through = Aabb::new([-0.4, 3.0, -0.4], [0.4, 3.2, 0.4]);
    let beside = Aabb::new([1.75, 1.0, -0.1], [1.95, 1.2, 0.1]);
    let boxes = vec![through, beside];
    let (scene, set) = one(&torus(40, 0.7), DAffine3::IDENTITY, boxes, DVec3::ZERO);
    let results = results(&set, &view, &scene, (96, 96));
    assert_eq!(results, [Visibility::Visible, Visibility::Occluded]);
}

/// Faces are not drawn from behind, so an eye inside sees out; a near plane in the surface opens
/// it.
#[test]
fn nothing_is_hidden_where_a_near_plane_may_cut_the_mesh() {
    let mesh = ball(20, |p| p * 2.0);
    let boxes = behind(DVec3::X);
    let (scene, set) = one(&mesh, DAffine3::IDENTITY, boxes, DVec3::ZERO);
    let look = |x: f64, near_m: f64| {
        let projection = Projection::perspective(0.8, 1.0, near_m, f64::INFINITY);
        let eye = Eye::look_at([x, 0.0, 0.0], [9.0, 0.0, 0.0], DVec3::Y, projection);
        View::mono(eye)
    };
    let count = |view: &View| hidden(&results(&set, view, &scene, (64, 64)));
    assert!(count(&look(-3.0, 0.1)) > 100);
    for (x, near_m) in [
        (0.0, 0.1),
        (-1.9, 0.01),
        (-1.5, 0.1),
        (-3.0, 1.1),
        (-3.0, 2.0),
    ] {
        assert_eq!(count(&look(x, near_m)), 0, "{x} {near_m}");
    }
    // So far that any of the eyes may come there.
    assert!(count(&look(-2.5, 0.1).with_validity_radius(0.03)) > 100);
    assert_eq!(count(&look(-2.5, 0.1).with_validity_radius(0.6)), 0);
    let Eye { projection, .. } = look(0.0, 0.1).eye;
    let eye = |x: f64| Eye::look_at([x, 0.0, 0.0], [9.0, 0.0, 0.0], DVec3::Y, projection);
    assert_eq!(count(&View::stereo(eye(-3.5), eye(-1.9))), 0);
    // A mesh beside the eye may reach behind it: its near rectangle is elsewhere.
    let beside = DAffine3::from_translation(DVec3::new(0.0, 0.0, -2.5));
    let mut set = OccluderSet::new();
    set.add(Arc::new(bake(&mesh, inner())), beside).unwrap();
    let projection = Projection::perspective(2.4, 1.0, 0.1, f64::INFINITY);
    let eye = Eye::look_at(DVec3::ZERO, [1.0, 0.0, -1.0], DVec3::Y, projection);
    let behind = [Aabb::new([0.5, -0.1, -6.0], [0.6, 0.1, -5.9])];
    let mut culler = Culler::new(64, 64).unwrap();
    let options = FrameOptions::default();
    culler
        .rasterize(&View::mono(eye), &set, &options, &SingleThread)
        .unwrap();
    let mut results = [Visibility::Visible];
    culler.query(&behind, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results, [Visibility::Occluded]);
}

/// Whether boxes are baked of a mesh.
fn has_boxes((positions, indices): &Mesh, options: BakeOptions) -> bool {
    let mesh = OccluderMesh::bake(positions, indices, options).unwrap();
    let lowest = positions.iter().fold(Vec3::INFINITY, |lo, p| lo.min(*p));
    // Bounds are those of what is drawn.
    let near = (Vec3::from(mesh.bounds().min) - lowest).abs().max_element();
    assert!(near <= lowest.abs().max_element() * 1e-5);
    if mesh.is_inner_shape() {
        assert!(mesh.triangle_count() <= 96 && mesh.triangle_count() * 8 <= indices.len() / 3);
        assert!(mesh.cluster_count() <= 8);
    }
    mesh.is_inner_shape()
}

#[test]
fn meshes_that_are_open_thin_small_or_change_are_baked_themselves() {
    for kind in 0..SHAPES {
        assert!(has_boxes(&closed(kind), inner()), "{kind}");
        assert!(!has_boxes(&closed(kind), BakeOptions::default()), "{kind}");
    }
    let stone = closed(1);
    assert!(!has_boxes(&stone, inner().with_two_sided(true)));
    assert!(!has_boxes(&stone, inner().with_deformable(true)));
    let (positions, mut indices) = stone.clone();
    indices.truncate(indices.len() - 3);
    assert!(!has_boxes(&(positions, indices), inner()), "a hole");
    let (positions, mut indices) = stone.clone();
    indices.swap(0, 1);
    assert!(!has_boxes(&(positions, indices), inner()), "one is turned");
    let (positions, mut indices) = stone.clone();
    indices.extend_from_within(0..3);
    assert!(
        !has_boxes(&(positions, indices), inner()),
        "one is there twice"
    );
    assert!(!has_boxes(&turned(stone), inner()), "inside out");
    assert!(!has_boxes(&ball(4, |p| p), inner()), "64 triangles");
    let shell = join(ball(20, |p| p), turned(ball(20, |p| p * 0.97)));
    assert!(!has_boxes(&shell, inner()), "a thin shell");
    let flat = ball(20, |p| p * Vec3::new(1.0, 0.0, 1.0));
    assert!(!has_boxes(&flat, inner()), "flat");
    let wall = ball(2, |p| p);
    assert!(!has_boxes(&wall, inner()));
}

#[test]
fn size_and_distance_from_zero_change_nothing_until_rounding_does() {
    let stone = closed(1);
    let of = |mesh: &Mesh| bake(mesh, inner()).triangle_count();
    let triangles = of(&stone);
    for scale in [1e-30f32, 1e-6, 1e6, 1e30, 2e38] {
        let scaled = (
            stone.0.iter().map(|p| *p * scale).collect(),
            stone.1.clone(),
        );
        assert!(has_boxes(&scaled, inner()), "{scale}");
        let near = of(&scaled).abs_diff(triangles);
        assert!(near <= 12, "{scale}: {} of {triangles}", of(&scaled));
    }
    assert!(has_boxes(
        &moved(stone.clone(), Vec3::new(-300.0, 40.0, 900.0)),
        inner()
    ));
    assert!(!has_boxes(&moved(stone, Vec3::splat(1e5)), inner()));
}

#[test]
fn a_million_triangles_become_boxes() {
    let mesh = ball(500, stone);
    assert_eq!(mesh.1.len() / 3, 1_000_000);
    assert!(has_boxes(&mesh, inner()));
}

#[test]
fn an_inner_shape_comes_back_from_bytes() {
    let mesh = bake(&closed(1), inner());
    let again = OccluderMesh::from_bytes(&mesh.to_bytes()).unwrap();
    assert!(again.is_inner_shape());
    assert_eq!(again.bounds(), mesh.bounds());
    assert_eq!(again.to_bytes(), mesh.to_bytes());
}
