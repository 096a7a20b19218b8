//! Odd input is refused or answered safely; nothing panics.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::*;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

fn wall() -> Arc<OccluderMesh> {
    Arc::new(
        OccluderMesh::from_box(Aabb::new(
            Vec3::new(-2.0, -2.0, -5.2),
            Vec3::new(2.0, 2.0, -5.0),
        ))
        .unwrap(),
    )
}

fn view() -> View {
    View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, 0.1)
}

#[test]
fn boxes_that_are_no_volumes_are_visible() {
    let mut set = OccluderSet::new();
    set.add(wall(), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    culler
        .rasterize(&view(), &set, &FrameOptions::default(), &SingleThread)
        .unwrap();
    let behind = Vec3::new(0.0, 0.0, -9.0);
    let boxes = [
        Aabb::new(Vec3::NAN, behind),
        Aabb::new(behind, Vec3::NAN),
        Aabb::new(behind + 1.0, behind - 1.0),
        Aabb::EMPTY,
        Aabb::new(Vec3::splat(f32::NEG_INFINITY), Vec3::splat(f32::INFINITY)),
        Aabb::new(behind, behind),
    ];
    let mut results = [Visibility::Outside; 6];
    culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results[..5], [Visibility::Visible; 5]);
    assert_eq!(results[5], Visibility::Occluded, "a point is a volume");
    let mut results = [Visibility::Outside; 6];
    culler
        .query_tree(&OccludeeTree::build(&boxes, DVec3::ZERO), &mut results)
        .unwrap();
    assert_eq!(results[..5], [Visibility::Visible; 5]);
    assert_eq!(results[5], Visibility::Occluded);
}

#[test]
fn bad_input_is_an_error() {
    let p = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let bake = |p: &[Vec3], i: &[u32]| OccluderMesh::bake(p, i, BakeOptions::default()).err();
    assert_eq!(
        bake(&p, &[0, 1]),
        Some(CullError::NotTriangles { indices: 2 })
    );
    assert_eq!(
        bake(&p, &[0, 1, 3]),
        Some(CullError::IndexOutOfRange {
            index: 3,
            positions: 3
        })
    );
    assert_eq!(
        bake(&[Vec3::ZERO, Vec3::X, Vec3::NAN], &[0, 1, 2]),
        Some(CullError::NotFinite)
    );
    assert_eq!(bake(&p, &[]), None);
    assert_eq!(
        Culler::new(0, 8).err(),
        Some(CullError::BadSize {
            width: 0,
            height: 8
        })
    );
    let mut set = OccluderSet::new();
    let nan = DAffine3::from_translation(DVec3::NAN);
    assert_eq!(set.add(wall(), nan).err(), Some(CullError::NotFinite));
    let id = set.add(wall(), DAffine3::IDENTITY).unwrap();
    set.remove(id).unwrap();
    assert_eq!(set.remove(id).err(), Some(CullError::UnknownOccluder));
    let mut culler = Culler::new(8, 8).unwrap();
    for position in [DVec3::NAN, DVec3::INFINITY] {
        let view = View::perspective(position, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, 0.1);
        assert!(
            culler
                .rasterize(&view, &set, &FrameOptions::default(), &SingleThread)
                .is_err()
        );
    }
    for near in [0.0, -1.0, f64::NAN] {
        let view = View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, near);
        assert!(
            culler
                .rasterize(&view, &set, &FrameOptions::default(), &SingleThread)
                .is_err()
        );
    }
    let mut results = [Visibility::Outside];
    culler
        .query(
            &[Aabb::new(Vec3::ZERO, Vec3::ONE)],
            DVec3::ZERO,
            &mut results,
        )
        .unwrap();
    assert_eq!(
        results,
        [Visibility::Visible],
        "after a bad view everything is visible"
    );
}

#[test]
fn a_camera_inside_an_occluder_or_a_box_sees_what_a_renderer_shows() {
    let mut set = OccluderSet::new();
    // The eye is inside a closed box: its faces look away and hide nothing.
    let around = OccluderMesh::from_box(Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0))).unwrap();
    set.add(Arc::new(around), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    culler
        .rasterize(&view(), &set, &FrameOptions::default(), &SingleThread)
        .unwrap();
    let boxes = [
        Aabb::new(Vec3::new(-0.5, -0.5, -9.0), Vec3::new(0.5, 0.5, -8.0)),
        Aabb::new(Vec3::splat(-3.0), Vec3::splat(3.0)),
    ];
    let mut results = [Visibility::Outside; 2];
    culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results, [Visibility::Visible; 2]);
}

#[test]
fn a_box_that_crosses_the_near_plane_beside_the_picture_can_be_occluded() {
    let mut set = OccluderSet::new();
    let wide = OccluderMesh::from_box(Aabb::new(
        Vec3::new(-50.0, -50.0, -2.2),
        Vec3::new(50.0, 50.0, -2.0),
    ))
    .unwrap();
    set.add(Arc::new(wide), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    culler
        .rasterize(&view(), &set, &FrameOptions::default(), &SingleThread)
        .unwrap();
    // Beside the eye and far behind the wall; enters the picture only behind it.
    let beside = Aabb::new(Vec3::new(3.0, -1.0, -40.0), Vec3::new(5.0, 1.0, 3.0));
    let mut results = [Visibility::Outside];
    culler.query(&[beside], DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results, [Visibility::Occluded]);
}

#[test]
fn size_thresholds_and_statistics_add_up() {
    let mut set = OccluderSet::new();
    let id = set.add(wall(), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    let options = FrameOptions {
        occludee_size_threshold: 0.01,
        ..FrameOptions::default()
    };
    culler
        .rasterize(&view(), &set, &options, &SingleThread)
        .unwrap();
    let at = |z: f32, h: f32| Aabb::new(Vec3::new(-h, -h, z - h), Vec3::new(h, h, z + h));
    let boxes = [at(-9.0, 0.5), at(-3.0, 0.5), at(9.0, 0.5), at(-4.0, 0.001)];
    let mut results = [Visibility::Visible; 4];
    culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(
        results,
        [
            Visibility::Occluded,
            Visibility::Visible,
            Visibility::Outside,
            Visibility::Small
        ]
    );
    culler.count(&results, Some(&[10, 20, 30, 40]));
    let s = culler.stats();
    assert_eq!(
        (s.occludees, s.occludees_visible, s.occludees_culled()),
        (4, 1, 3)
    );
    assert_eq!(
        (s.occludees_occluded, s.occludees_outside, s.occludees_small),
        (1, 1, 1)
    );
    assert_eq!(
        (s.occludee_triangles, s.occludee_triangles_visible),
        (100, 20)
    );
    assert_eq!(
        (
            s.occluder_models,
            s.occluder_models_rasterized,
            s.occluder_triangles
        ),
        (1, 1, 12)
    );
    assert!(culler.is_covered(32, 32));
    // Switched off, it hides nothing.
    set.set_enabled(id, false).unwrap();
    culler
        .rasterize(&view(), &set, &options, &SingleThread)
        .unwrap();
    culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results[0], Visibility::Visible);
    // Too small an occluder is left out.
    set.set_enabled(id, true).unwrap();
    culler
        .rasterize(
            &view(),
            &set,
            &FrameOptions {
                occluder_size_threshold: 100.0,
                ..options
            },
            &SingleThread,
        )
        .unwrap();
    assert_eq!(culler.stats().occluder_models_rasterized, 0);
}

#[test]
fn what_is_baked_around_clusters_matters_to_two_eyes_only() {
    // A bowl towards the eyes: every inner edge is seen from both.
    let n = 24u32;
    let points: Vec<Vec3> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i as f32 / n as f32, j as f32 / n as f32)))
        .map(|(u, v)| {
            let (x, y) = (u * 8.0 - 4.0, v * 8.0 - 4.0);
            Vec3::new(x, y, -8.0 + 0.05 * (x * x + y * y))
        })
        .collect();
    let indices: Vec<u32> = (0..n)
        .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
        .flat_map(|a| [a, a + 1, a + n + 2, a, a + n + 2, a + n + 1])
        .collect();
    let eye = |x: f64| {
        let at = DVec3::new(x, 0.0, 0.0);
        let projection = Projection::perspective(1.0, 1.0, 0.1, f64::INFINITY);
        Eye::look_at(at, at + DVec3::NEG_Z, DVec3::Y, projection)
    };
    let covered = |around_the_eye: bool, view: &View| {
        let options = BakeOptions {
            around_the_eye,
            ..BakeOptions::default()
        };
        let mesh = OccluderMesh::bake(&points, &indices, options).unwrap();
        let mut set = OccluderSet::new();
        set.add(Arc::new(mesh), DAffine3::IDENTITY).unwrap();
        let mut culler = Culler::new(128, 128).unwrap();
        let options = FrameOptions::default();
        culler
            .rasterize(view, &set, &options, &SingleThread)
            .unwrap();
        let mut depth = vec![0.0; 128 * 128];
        culler.read_depth(&mut depth).unwrap();
        depth.iter().filter(|d| **d > 0.0).count()
    };
    let one = View::mono(eye(0.0));
    assert_eq!(covered(true, &one), covered(false, &one));
    let two = View::stereo(eye(-0.033), eye(0.033));
    let (with, without) = (covered(true, &two), covered(false, &two));
    assert!(without < with && with > 8_000, "{without} {with}");
}
