//! Views from matrices to clip space: the same eye and the same answers as from pose and extents.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, eye, occluders, scene, wrongly_culled};
use foveal_cull::{
    Affine, BakeOptions, ClipDepth, CullError, Culler, Eye, FrameOptions, OccluderMesh,
    OccluderSet, Projection, Quantity, SingleThread, View, ViewError, Visibility,
};
use glam::{DAffine3, DMat4, DVec3, DVec4};
use std::sync::Arc;

const DEPTHS: [(ClipDepth, f64, f64); 3] = [
    (ClipDepth::ZeroToOne, 0.0, 1.0),
    (ClipDepth::OneToZero, 1.0, 0.0),
    (ClipDepth::MinusOneToOne, -1.0, 1.0),
];

/// The matrix of an eye, with y up on the screen.
fn clip_from_world(eye: &Eye, (near_depth, far_depth): (f64, f64)) -> DMat4 {
    let [l, r, b, t] = eye.projection.extents();
    let [near, far] = eye.projection.near_far_m();
    let (sx, sy) = (2.0 / (r - l), 2.0 / (t - b));
    let (cx, cy) = ((r + l) / (r - l), (t + b) / (t - b));
    let rows = if eye.projection.is_orthographic() {
        let slope = (far_depth - near_depth) / (far - near);
        [
            DVec4::new(sx, 0.0, 0.0, -cx),
            DVec4::new(0.0, sy, 0.0, -cy),
            DVec4::new(0.0, 0.0, -slope, near_depth - slope * near),
            DVec4::W,
        ]
    } else {
        let b = (near_depth - far_depth) / (1.0 / near - 1.0 / far);
        let a = far_depth - b / far;
        [
            DVec4::new(sx, 0.0, cx, 0.0),
            DVec4::new(0.0, sy, cy, 0.0),
            DVec4::new(0.0, 0.0, -a, b),
            -DVec4::Z,
        ]
    };
    let clip_from_eye = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    clip_from_eye * DMat4::from(DAffine3::from(eye.world_from_eye).inverse())
}

fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| a == b || (a - b).abs() <= tolerance * (1.0 + a.abs()))
}

fn assert_same_eye(found: &Eye, expected: &Eye, what: &str) {
    let flat = |e: &Eye| DAffine3::from(e.world_from_eye).to_cols_array();
    let (a, b) = (&found.projection, &expected.projection);
    assert_eq!(a.is_orthographic(), b.is_orthographic(), "{what}");
    let [[near_a, far_a], [near_b, far_b]] = [a.near_far_m(), b.near_far_m()];
    if a.is_orthographic() {
        // The eye is the centre of the near rectangle; its corners are where they were.
        let depth = far_b - near_b;
        assert!(near_a == 0.0, "{what}");
        assert!((depth..depth * 1.01).contains(&far_a), "{what}: {far_a}");
        assert!(
            close(&flat(found)[..9], &flat(expected)[..9], 1e-9),
            "{what}"
        );
        let corners = |e: &Eye| {
            let ([l, r, b, t], [near, _]) = (e.projection.extents(), e.projection.near_far_m());
            let corner =
                |x, y| DAffine3::from(e.world_from_eye).transform_point3(DVec3::new(x, y, -near));
            [corner(l, b).to_array(), corner(r, t).to_array()].concat()
        };
        assert!(close(&corners(found), &corners(expected), 1e-9), "{what}");
    } else {
        assert!(
            close(&a.extents(), &b.extents(), 1e-9),
            "{what}: {found:?} {expected:?}"
        );
        assert!(
            (near_a / near_b - 1.0).abs() < 1e-9,
            "{what}: {near_a} {near_b}"
        );
        assert!(far_a >= far_b, "{what}: {far_a} {far_b}");
        assert!(
            far_a < far_b * 1.01 || far_b.is_infinite(),
            "{what}: {far_a} {far_b}"
        );
        assert!(
            close(&flat(found), &flat(expected), 1e-9),
            "{what}: {found:?} {expected:?}"
        );
    }
}

#[test]
fn a_matrix_of_any_convention_is_taken_apart_into_its_eye() {
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let origin = r.vec([0.0, 50.0, 1e4][seed as usize % 3]);
        let expected = eye(&mut r, origin, seed % 4 == 3);
        for (depth, near, far) in DEPTHS {
            let matrix = clip_from_world(&expected, (near, far));
            for scale in [1.0, 3e-3, 700.0] {
                let found = Eye::from_clip_from_world(matrix * scale, depth).unwrap();
                assert_same_eye(&found, &expected, &format!("{seed} {depth:?} {scale}"));
            }
            // With y down on the screen the picture is the same.
            let flip = DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
            let found = Eye::from_clip_from_world(flip * matrix, depth).unwrap();
            assert_same_eye(&found, &expected, &format!("{seed} {depth:?} y down"));
        }
    }
}

#[test]
fn answers_of_matrices_in_f32_hide_nothing_visible_and_hardly_differ() {
    let (mut differ, mut culled) = (0, 0);
    for seed in 0..40 {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 6, 300, DVec3::ZERO);
        let eye = eye(&mut r, DVec3::ZERO, seed % 4 == 3);
        let set = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
        let (depth, near, far) = DEPTHS[seed as usize % 3];
        let matrix = clip_from_world(&eye, (near, far)).as_mat4();
        let view = View::from_clip_from_world(matrix.to_cols_array(), depth).unwrap();
        let mut culler = Culler::new(64, 48).unwrap();
        let found = answers(&mut culler, &view, &set, &scene, &SingleThread);
        let expected = answers(&mut culler, &View::mono(eye), &set, &scene, &SingleThread);
        for n in [1, 4] {
            let wrong = wrongly_culled(&scene, &eye, (64, 48), n, &found);
            assert!(wrong.is_empty(), "{seed}, {n}: {wrong:?}");
        }
        differ += found.iter().zip(&expected).filter(|(a, b)| a != b).count();
        culled += found.iter().filter(|v| **v == Visibility::Occluded).count();
    }
    assert!(culled > 500, "{culled}");
    assert!(differ < 40, "{differ} of {}", 40 * 300);
}

#[test]
fn a_left_handed_world_with_clockwise_fronts_has_the_same_answers() {
    let mut culled = 0;
    for seed in 0..20 {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 6, 300, DVec3::ZERO);
        let eye = eye(&mut r, DVec3::ZERO, seed % 4 == 3);
        let mut culler = Culler::new(64, 48).unwrap();
        let set = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
        let expected = answers(&mut culler, &View::mono(eye), &set, &scene, &SingleThread);
        let mut depths = [vec![0.0; 64 * 48], vec![0.0; 64 * 48]];
        culler.read_depth(&mut depths[0]).unwrap();
        // The same world with z the other way round: meshes, transforms, boxes, camera.
        let mirror = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
        let mut set = OccluderSet::new();
        for (i, o) in scene.objects.iter().enumerate() {
            let positions: Vec<[f32; 3]> = o.positions.iter().map(|p| [p.x, p.y, -p.z]).collect();
            let indices: Vec<u32> = o
                .indices
                .chunks(3)
                .flat_map(|t| [t[0], t[2], t[1]])
                .collect();
            let options = BakeOptions::default()
                .with_two_sided(o.two_sided)
                .with_adjacency(i % 3 != 2);
            let mesh = OccluderMesh::bake(&positions, &indices, options).unwrap();
            let place = mirror * DMat4::from(o.transform) * mirror;
            set.add(Arc::new(mesh), DAffine3::from_mat4(place)).unwrap();
        }
        let mut mirrored = scene;
        for b in &mut mirrored.boxes {
            (b.min[2], b.max[2]) = (-b.max[2], -b.min[2]);
        }
        for (depth, near, far) in DEPTHS {
            let matrix = clip_from_world(&eye, (near, far)) * mirror;
            let view = View::from_clip_from_world(matrix, depth).unwrap();
            let found = answers(&mut culler, &view, &set, &mirrored, &SingleThread);
            let differ = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
            assert!(differ <= 3, "{seed} {depth:?}: {differ}");
            culled += found.iter().filter(|v| **v == Visibility::Occluded).count();
            // Rows count from the bottom.
            culler.read_depth(&mut depths[1]).unwrap();
            let rows = depths[1].chunks(64).rev().flatten();
            let same = rows
                .zip(&depths[0])
                .filter(|(a, b)| (**a > 0.0) == (**b > 0.0))
                .count();
            assert!(same > 64 * 48 * 98 / 100, "{seed} {depth:?}: {same}");
        }
    }
    assert!(culled > 500, "{culled}");
}

#[test]
fn matrices_that_cannot_be_culled_for_are_refused_with_the_reason() {
    let at = |projection| Eye::look_at([1.0, 2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], projection);
    let eye = at(Projection::perspective(1.0, 1.5, 0.1, 50.0));
    let flat = at(Projection::orthographic(9.0, 1.5, 0.1, 50.0));
    let error = |m: DMat4, depth| Eye::from_clip_from_world(m, depth).unwrap_err();
    let refused = |m: DMat4, cause| {
        assert_eq!(error(m, ClipDepth::ZeroToOne), CullError::BadView(cause));
    };
    let good = clip_from_world(&eye, (0.0, 1.0));
    let good_flat = clip_from_world(&flat, (0.0, 1.0));
    for m in [good, good_flat] {
        let mut nan = m;
        nan.y_axis.x = f64::NAN;
        let expected = CullError::NotFinite(Quantity::ClipMatrix);
        assert_eq!(error(nan, ClipDepth::ZeroToOne), expected);
        let row = |row: usize, with: DVec4| {
            let mut rows = [0, 1, 2, 3].map(|i| m.row(i));
            rows[row] = with;
            DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
        };
        refused(row(0, DVec4::ZERO), ViewError::NoVolume);
        refused(row(1, DVec4::ZERO), ViewError::NoVolume);
        refused(row(2, DVec4::ZERO), ViewError::NoVolume);
        refused(row(3, DVec4::ZERO), ViewError::NoVolume);
        // Sheared pictures.
        refused(row(0, m.row(0) + 0.1 * m.row(1)), ViewError::Oblique);
        // An oblique near plane.
        refused(row(2, m.row(2) + 0.1 * m.row(0)), ViewError::Oblique);
    }
    refused(good_flat * -1.0, ViewError::NoVolume);
    refused(DMat4::ZERO, ViewError::NoVolume);
    // What is visible would lie behind the eye.
    refused(good * -1.0, ViewError::NearNotPositive);
    // Depth the other way round.
    let far_first = CullError::BadView(ViewError::FarNotBeyondNear);
    assert_eq!(error(good, ClipDepth::OneToZero), far_first);
    let tiny = DMat4::from_scale(DVec3::splat(1e-320));
    assert!(Eye::from_clip_from_world(tiny * good, ClipDepth::ZeroToOne).is_err());
}

#[test]
fn arrays_of_f32_and_f64_flat_and_by_columns_are_one_matrix() {
    let projection = Projection::perspective(1.0, 1.5, 0.5, f64::INFINITY);
    let eye = Eye::look_at([4.0, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0], projection);
    let m = clip_from_world(&eye, (1.0, 0.0)).as_mat4();
    let depth = ClipDepth::OneToZero;
    let first = Eye::from_clip_from_world(m.to_cols_array(), depth).unwrap();
    let others = [
        Eye::from_clip_from_world(m.to_cols_array_2d(), depth),
        Eye::from_clip_from_world(m.as_dmat4().to_cols_array(), depth),
        Eye::from_clip_from_world(m.as_dmat4().to_cols_array_2d(), depth),
        Eye::from_clip_from_world(m, depth),
    ];
    assert_eq!(others, [Ok(first); 4]);
    // A way that the matrix does not know about is added afterwards.
    let mut far_away = first;
    far_away.world_from_eye.translation[0] += 1e7;
    let mesh = OccluderMesh::from_box(foveal_cull::Aabb::new([-1.0; 3], [1.0; 3])).unwrap();
    let mut set = OccluderSet::new();
    set.add(Arc::new(mesh), Affine::from_translation([1e7, 0.0, 0.0]))
        .unwrap();
    let mut culler = Culler::new(32, 32).unwrap();
    let view = View::mono(far_away);
    culler
        .rasterize(&view, &set, &FrameOptions::default(), &SingleThread)
        .unwrap();
    assert!(culler.is_covered(16, 16));
}
