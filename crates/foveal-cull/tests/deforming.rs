//! Meshes that deform hide nothing that is visible, and depend on their positions alone.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::promise::hidden;
use common::{Random, Scene, eye, scene, wrongly_culled};
use foveal_cull::{
    BakeOptions, CullError, Culler, Eye, FrameOptions, OccluderId, OccluderMesh, OccluderSet,
    Quantity, SingleThread, View, Visibility,
};
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

fn deformable() -> BakeOptions {
    BakeOptions::default().with_deformable(true)
}

fn placed(scene: &Scene, options: BakeOptions) -> (OccluderSet, Vec<OccluderId>) {
    let mut set = OccluderSet::new();
    let ids = (scene.objects.iter().enumerate()).map(|(i, o)| {
        let options = (options.with_two_sided(o.two_sided)).with_adjacency(i % 3 != 2);
        let mesh = OccluderMesh::bake(&o.positions, &o.indices, options).unwrap();
        set.add(Arc::new(mesh), o.transform).unwrap()
    });
    let ids = ids.collect();
    (set, ids)
}

/// Another shape of every object: waves, and every vertex by itself.
fn deform(scene: &mut Scene, r: &mut Random) {
    for object in &mut scene.objects {
        let noise = [0.0, 0.02, 0.5][r.below(3)];
        let (wave, length) = (r.vec(0.6).as_vec3(), r.range(0.5, 3.0) as f32);
        for p in &mut object.positions {
            *p += wave * (p.dot(Vec3::ONE) * length).sin();
            *p += r.vec(1.0).as_vec3() * noise;
        }
    }
}

fn answers(set: &OccluderSet, scene: &Scene, view: &View) -> (Vec<Visibility>, Vec<f32>) {
    let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let mut culler = Culler::new(72, 48).unwrap();
    culler.rasterize(view, set, &all, &SingleThread).unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    let mut depth = vec![0.0; 72 * 48];
    culler.read_depth(&mut depth).unwrap();
    (results, depth)
}

#[test]
fn meshes_that_deform_hide_nothing_that_is_visible() {
    let (mut culled, mut of_new, mut from_around) = (0, 0, 0);
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let mut scene = scene(&mut r, 5, 150, DVec3::ZERO);
        let (mut set, ids) = placed(&scene, deformable());
        for _ in 0..3 {
            deform(&mut scene, &mut r);
            for (id, object) in ids.iter().zip(&scene.objects) {
                set.set_positions(*id, &object.positions).unwrap();
            }
            let eye = eye(&mut r, DVec3::ZERO, seed % 6 == 5);
            let (results, _) = answers(&set, &scene, &View::mono(eye));
            culled += hidden(&results);
            for n in [1, 4] {
                let wrong = wrongly_culled(&scene, &eye, (72, 48), n, &results);
                assert!(wrong.is_empty(), "seed {seed}, {n}x: {wrong:?}");
            }
            let (baked, _) = placed(&scene, BakeOptions::default());
            of_new += hidden(&answers(&baked, &scene, &View::mono(eye)).0);

            let around = View::mono(eye).with_validity_radius(0.03);
            let (results, _) = answers(&set, &scene, &around);
            from_around += hidden(&results);
            for _ in 0..2 {
                let step = DAffine3::from_translation(r.vec(1.0).normalize() * 0.0299);
                let pose = step * DAffine3::from(eye.world_from_eye);
                let beside = Eye::new(pose, eye.projection);
                for n in [1, 4] {
                    let wrong = wrongly_culled(&scene, &beside, (72, 48), n, &results);
                    assert!(wrong.is_empty(), "seed {seed}, around, {n}x: {wrong:?}");
                }
            }
        }
    }
    assert!(
        culled > 3000 && from_around > 1500,
        "{culled} {from_around}"
    );
    // Clusters of another shape hide nearly as much as new ones.
    assert!(culled * 20 > of_new * 19, "{culled} of {of_new}");
}

#[test]
fn a_shape_depends_on_its_positions_alone() {
    for seed in 100..120 {
        let mut r = Random::new(seed);
        let mut scene = scene(&mut r, 4, 20, DVec3::ZERO);
        let first: Vec<Vec<Vec3>> = scene.objects.iter().map(|o| o.positions.clone()).collect();
        let (mut set, ids) = placed(&scene, deformable());
        let view = View::mono(eye(&mut r, DVec3::ZERO, false));
        let before = answers(&set, &scene, &view);
        deform(&mut scene, &mut r);
        for (id, object) in ids.iter().zip(&scene.objects) {
            set.set_positions(*id, &object.positions).unwrap();
        }
        assert_ne!(answers(&set, &scene, &view).1, before.1, "seed {seed}");
        for (id, positions) in ids.iter().zip(&first) {
            set.set_positions(*id, positions).unwrap();
        }
        assert!(answers(&set, &scene, &view) == before, "seed {seed}");
    }
}

#[test]
fn a_mesh_keeps_its_bytes_where_its_positions_stay() {
    let mut r = Random::new(7);
    for object in scene(&mut r, 30, 0, DVec3::ZERO).objects {
        for adjacency in [false, true] {
            let options = deformable().with_adjacency(adjacency);
            let mut mesh = OccluderMesh::bake(&object.positions, &object.indices, options).unwrap();
            let bytes = mesh.to_bytes();
            mesh.set_positions(&object.positions).unwrap();
            assert!(mesh.to_bytes() == bytes);
            let far: Vec<Vec3> = object.positions.iter().map(|p| *p + 1e6).collect();
            mesh.set_positions(&far).unwrap();
            assert!(mesh.to_bytes() != bytes);
            let read = OccluderMesh::from_bytes(&mesh.to_bytes()).unwrap();
            assert_eq!(read.bounds(), mesh.bounds());
            // Bytes do not say which position a vertex was.
            let again = read.clone().set_positions(&far);
            assert_eq!(again, Err(CullError::NotDeformable));
        }
    }
}

/// Only triangles with three corners count: the centre is that of what is drawn.
#[test]
fn a_corner_of_no_triangle_moves_nothing() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1e6, 0.0, 0.0]];
    let mut mesh = OccluderMesh::bake(&positions, &[0, 1, 2, 3, 3, 3], deformable()).unwrap();
    let bytes = mesh.to_bytes();
    assert_eq!(mesh.position_count(), Some(4));
    assert_eq!(mesh.triangle_count(), 1);
    assert!(mesh.bounds().max[0] < 1.01);
    mesh.set_positions(&positions).unwrap();
    assert!(mesh.to_bytes() == bytes);
}

#[test]
fn an_occluder_that_deforms_leaves_others_of_its_mesh_alone() {
    let wall = [
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
    ];
    let mesh = OccluderMesh::bake(&wall, &[0, 1, 2, 0, 2, 3], deformable()).unwrap();
    let mesh = Arc::new(mesh);
    let mut set = OccluderSet::new();
    let at = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, -5.0));
    let [left, right] = [-1.5, 1.5].map(|x| set.add(Arc::clone(&mesh), at(x)).unwrap());
    let view = View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.0, 1.0, 0.1);
    let covered = |set: &OccluderSet| {
        let mut culler = Culler::new(64, 64).unwrap();
        let options = FrameOptions::default();
        culler
            .rasterize(&view, set, &options, &SingleThread)
            .unwrap();
        let mut depth = vec![0.0; 64 * 64];
        culler.read_depth(&mut depth).unwrap();
        let of = |columns: core::ops::Range<usize>| {
            let rows = depth.chunks_exact(64).map(|row| &row[columns.clone()]);
            rows.flatten().filter(|d| **d > 0.0).count()
        };
        [of(0..32), of(32..64)]
    };
    let before = covered(&set);
    assert!(before[0] > 100 && before[1] > 100, "{before:?}");
    let small = wall.map(|p| p.map(|v| v * 0.5));
    set.set_positions(right, &small).unwrap();
    let after = covered(&set);
    assert_eq!(after[0], before[0]);
    assert!(
        after[1] * 3 < before[1] && after[1] > 20,
        "{after:?} {before:?}"
    );
    assert!(mesh.bounds().max[0] > 0.99);
    // It stays where it is, and off if it is off.
    set.set_transform(right, at(-1.5)).unwrap();
    set.set_enabled(left, false).unwrap();
    set.set_positions(left, &small).unwrap();
    assert_eq!(covered(&set), [after[1], 0]);
}

#[test]
fn positions_that_do_not_fit_are_errors_and_change_nothing() {
    let wall = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [9.0, 9.0, 9.0],
    ];
    let mut mesh = OccluderMesh::bake(&wall, &[0, 1, 2], deformable()).unwrap();
    let bytes = mesh.to_bytes();
    let short = mesh.set_positions(&wall[..3]).unwrap_err().to_string();
    assert_eq!(short, "a list has length 3 where 4 is needed");
    let mut bad = wall;
    bad[1][1] = f32::NAN;
    let not_finite = Err(CullError::NotFinite(Quantity::Position));
    assert_eq!(mesh.set_positions(&bad), not_finite);
    assert!(mesh.to_bytes() == bytes);
    // No triangle has the last one.
    let mut unused = wall;
    unused[3] = [f32::INFINITY; 3];
    mesh.set_positions(&unused).unwrap();
    assert!(mesh.to_bytes() == bytes);

    let mut set = OccluderSet::new();
    let id = set.add(Arc::new(mesh), DAffine3::IDENTITY).unwrap();
    assert_eq!(set.set_positions(id, &bad), not_finite);
    let rigid = OccluderMesh::bake(&wall, &[0, 1, 2], BakeOptions::default()).unwrap();
    let rigid = set.add(Arc::new(rigid), DAffine3::IDENTITY).unwrap();
    let refused = set.set_positions(rigid, &wall);
    assert_eq!(refused, Err(CullError::NotDeformable));
    set.remove(id).unwrap();
    let unknown = set.set_positions(id, &wall);
    assert_eq!(unknown, Err(CullError::UnknownOccluder));
}
