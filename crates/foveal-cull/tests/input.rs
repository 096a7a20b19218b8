//! Odd input is refused or answered safely; nothing panics.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::*;
use glam::{DAffine3, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
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
    assert_eq!(results[5], Visibility::Occluded, "a point is valid");
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
    let corner = [Vec3::ZERO, Vec3::X, Vec3::NAN];
    assert!(matches!(
        bake(&p, &[0, 1]),
        Some(CullError::NotTriangles { indices: 2, .. })
    ));
    assert!(matches!(
        bake(&p, &[0, 1, 3]),
        Some(CullError::IndexOutOfRange {
            index: 3,
            positions: 3,
            ..
        })
    ));
    assert_eq!(
        bake(&corner, &[0, 1, 2]),
        Some(CullError::NotFinite(Quantity::Position))
    );
    assert_eq!(bake(&p, &[]), None);
    let mut set = OccluderSet::new();
    let nan = DAffine3::from_translation(DVec3::NAN);
    assert_eq!(
        set.add(wall(), nan).err(),
        Some(CullError::NotFinite(Quantity::Transform))
    );
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
fn the_limit_of_a_side_is_the_one_that_messages_name() {
    for side in [0, MAX_SIDE_PX + 1, u32::MAX] {
        for (width, height) in [(side, 8), (8, side)] {
            let error = Culler::new(width, height).err().unwrap();
            let bad = matches!(error, CullError::BadSize { width_px, height_px, .. }
                if (width_px, height_px) == (width, height));
            assert!(bad, "{error:?}");
            let limit = format!("1 to {MAX_SIDE_PX} pixels");
            assert!(error.to_string().contains(&limit), "{error}");
        }
    }
    for (width, height) in [(MAX_SIDE_PX, 1), (1, MAX_SIDE_PX)] {
        assert_eq!(Culler::new(width, height).unwrap().size(), (width, height));
    }
}

#[test]
fn a_view_that_is_refused_says_why() {
    let error = |view: View| {
        let mut culler = Culler::new(8, 8).unwrap();
        let set = OccluderSet::new();
        let frame = culler.rasterize(&view, &set, &FrameOptions::default(), &SingleThread);
        frame.err().unwrap()
    };
    let eye = |projection| Eye::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection);
    let perspective = |near_m, far_m| eye(Projection::perspective(1.0, 1.0, near_m, far_m));
    let flat = |near_m, far_m| eye(Projection::orthographic(2.0, 1.0, near_m, far_m));
    let good = perspective(0.1, 9.0);
    let mut scaled = good;
    scaled.world_from_eye.y_axis[1] *= 2.0;
    let mut back = good;
    back.world_from_eye = DAffine3::from_rotation_y(core::f64::consts::PI).into();
    for (view, cause) in [
        (
            View::mono(perspective(0.0, 9.0)),
            ViewError::NearNotPositive,
        ),
        (
            View::mono(perspective(3.0, 2.0)),
            ViewError::FarNotBeyondNear,
        ),
        (
            View::mono(flat(0.0, f64::INFINITY)),
            ViewError::FarNotFinite,
        ),
        (
            View::mono(eye(Projection::perspective(1.0, -1.0, 0.1, 9.0))),
            ViewError::EmptyExtents,
        ),
        (View::mono(scaled), ViewError::PoseNotRigid),
        (
            View::stereo(good, flat(0.1, 9.0)),
            ViewError::StereoNotPerspective,
        ),
        (View::stereo(good, back), ViewError::EyesTooFarApart),
    ] {
        let error = error(view);
        assert_eq!(error, CullError::BadView(cause));
        let source = std::error::Error::source(&error).unwrap();
        assert_eq!(source.to_string(), cause.to_string());
    }
    let radius = |radius_m| View::mono(good).with_validity_radius(radius_m);
    for (view, expected, text) in [
        (
            View::mono(perspective(f64::NAN, 9.0)),
            CullError::NotFinite(Quantity::Projection),
            "a projection's extents and distances must be finite",
        ),
        (
            radius(f64::INFINITY),
            CullError::NotFinite(Quantity::ValidityRadius),
            "the validity radius must be finite",
        ),
        (
            radius(-1.0),
            CullError::Negative(Quantity::ValidityRadius),
            "the validity radius must not be negative",
        ),
        (
            View::perspective(DVec3::NAN, DVec3::NEG_Z, DVec3::Y, 1.0, 1.0, 0.1),
            CullError::NotFinite(Quantity::Pose),
            "the pose of an eye must be finite",
        ),
    ] {
        let error = error(view);
        assert_eq!((error, error.to_string().as_str()), (expected, text));
    }
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

/// Its faces looked inwards, and hid everything around a camera that was in it.
#[test]
fn an_occluder_box_that_is_inside_out_is_refused() {
    for axes in 0..8 {
        let side = |k: usize| [-1.0f32, 1.0][axes >> k & 1];
        let min = Vec3::new(side(0), side(1), side(2));
        let baked = OccluderMesh::from_box(Aabb::new(min, -min));
        assert_eq!(baked.is_ok(), axes == 0, "{axes}");
        if let Ok(mesh) = baked {
            assert_eq!(mesh.triangle_count(), 12);
        } else {
            assert_eq!(baked.err(), Some(CullError::InsideOut));
        }
    }
    let flat = Aabb::new([-1.0, 2.0, -1.0], [1.0, 2.0, 1.0]);
    assert!(OccluderMesh::from_box(flat).is_ok());
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn up_along_the_view_gives_a_pose(
        direction in prop::array::uniform3(-1.0..1.0f64),
        along in prop_oneof![Just(1.0), Just(-1.0), -1e6..1e6f64, -1e-6..1e-6f64],
        off in prop_oneof![Just(0.0), -1e-3..1e-3f64, -1e-14..1e-14f64],
        far in any::<bool>(),
    ) {
        let direction = DVec3::from(direction);
        prop_assume!(direction.length() > 1e-3);
        let position = DVec3::splat(if far { 1e4 } else { 0.0 });
        let up = along * (direction + off * DVec3::new(1.0, -2.0, 0.5));
        let view = View::perspective(position, position + direction, up, 1.0, 1.0, 0.1);
        let drawn = Culler::new(8, 8).unwrap().rasterize(
            &view,
            &OccluderSet::new(),
            &FrameOptions::default(),
            &SingleThread,
        );
        prop_assert_eq!(drawn, Ok(()));
    }
}

#[test]
fn an_up_that_is_the_view_direction_gives_a_pose() {
    let along = [5.0, 3.0, 1.0];
    let view = View::perspective([0.0; 3], along, along, 1.0, 1.0, 0.1);
    let mut culler = Culler::new(8, 8).unwrap();
    let (set, options) = (OccluderSet::new(), FrameOptions::default());
    culler
        .rasterize(&view, &set, &options, &SingleThread)
        .unwrap();
}

#[test]
fn size_thresholds_are_for_what_lies_farther_than_a_metre_in_a_perspective() {
    let mut set = OccluderSet::new();
    set.add(wall(), DAffine3::IDENTITY).unwrap();
    let options = FrameOptions::default()
        .with_occluder_size_threshold(1e3)
        .with_occludee_size_threshold(1e3);
    let boxes = [-0.9, -3.0].map(|z| Aabb::new([-0.01, -0.01, z], [0.01, 0.01, z + 0.01]));
    let lens = Projection::orthographic(4.0, 1.0, 0.1, 9.0);
    let flat = View::mono(Eye::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, lens));
    let (seen, small) = (Visibility::Visible, Visibility::Small);
    for (view, drawn, expected) in [(view(), 0, [seen, small]), (flat, 1, [seen; 2])] {
        let mut culler = Culler::new(64, 64).unwrap();
        culler
            .rasterize(&view, &set, &options, &SingleThread)
            .unwrap();
        let mut results = [Visibility::Occluded; 2];
        culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
        let stats = culler.stats();
        assert_eq!(
            (stats.occluder_models_rasterized, results),
            (drawn, expected)
        );
    }
}

#[test]
fn stats_of_a_set_need_a_result_and_a_triangle_count_for_each_place() {
    let mut set = OccludeeSet::new(DVec3::ZERO);
    let [first, _] = [0; 2].map(|_| set.insert(Aabb::new(Vec3::ZERO, Vec3::ONE)));
    set.remove(first).unwrap();
    let results = [Visibility::Visible; 3];
    let mut culler = Culler::new(8, 8).unwrap();
    for (results, triangles) in [
        (&results[..1], None),
        (&results[..], None),
        (&results[..2], Some(&[10][..])),
        (&results[..2], Some(&[10, 20, 30])),
    ] {
        let counted = culler.count_set(&set, results, triangles);
        let is_length = matches!(counted, Err(CullError::LengthMismatch { expected: 2, .. }));
        assert!(is_length, "{counted:?}");
        assert_eq!(culler.stats(), CullStats::default());
    }
    let counted = culler.count_set(&set, &results[..2], Some(&[10, 20]));
    assert_eq!(counted, Ok(()));
    let stats = culler.stats();
    assert_eq!((stats.occludees, stats.occludee_triangles), (1, 20));
}

#[test]
fn size_thresholds_and_statistics_add_up() {
    let mut set = OccluderSet::new();
    let id = set.add(wall(), DAffine3::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    let options = FrameOptions::default().with_occludee_size_threshold(0.01);
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
    for triangles in [&[10, 20, 30][..], &[10, 20, 30, 40, 50]] {
        let counted = culler.count(&results, Some(triangles));
        let is_length = matches!(counted, Err(CullError::LengthMismatch { expected: 4, .. }));
        assert!(is_length, "{counted:?}");
    }
    culler.count(&results, Some(&[10, 20, 30, 40])).unwrap();
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
            &options.with_occluder_size_threshold(100.0),
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
    let covered = |adjacency: bool, view: &View| {
        let options = BakeOptions::default().with_adjacency(adjacency);
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
