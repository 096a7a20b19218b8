//! Numbers at the ends of what is allowed.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::*;
use std::sync::Arc;

const ALONG_Z: [f64; 3] = [0.0, 0.0, -1.0];
const UP: [f64; 3] = [0.0, 1.0, 0.0];

fn view(tangent: f64, near_m: f64) -> View {
    View::perspective([0.0; 3], ALONG_Z, UP, 2.0 * f64::atan(tangent), 1.0, near_m)
}

/// What becomes of one box.
fn seen(view: &View, set: &OccluderSet, options: &FrameOptions<'_>, of: Aabb) -> Visibility {
    let mut culler = Culler::new(64, 64).unwrap();
    (culler.rasterize(view, set, options, &SingleThread)).unwrap();
    let mut results = [Visibility::Occluded];
    culler.query(&[of], [0.0; 3], &mut results).unwrap();
    results[0]
}

fn at(distance: f32, half: f32) -> Aabb {
    Aabb::new(
        [-half, -half, -distance - half],
        [half, half, -distance + half],
    )
}

#[test]
fn without_occluders_nothing_is_occluded_however_small_the_near_distance() {
    let (none, options) = (OccluderSet::new(), FrameOptions::default());
    for exponent in 0..120 {
        let view = view(0.5, 2f64.powi(-exponent));
        for (distance, half) in [(3.5, 0.5), (3.5, 0.05), (1e5, 1e2), (3e8, 1e6)] {
            let found = seen(&view, &none, &options, at(distance, half));
            assert_eq!(found, Visibility::Visible, "2^-{exponent}, {distance} m");
        }
    }
}

#[test]
fn a_pose_that_is_not_finite_is_refused_and_a_far_target_is_looked_at() {
    let set = OccluderSet::new();
    let mut culler = Culler::new(64, 64).unwrap();
    let mut look = |target: [f64; 3], up: [f64; 3]| {
        let view = View::perspective([0.0; 3], target, up, 1.0, 1.0, 0.1);
        culler.rasterize(&view, &set, &FrameOptions::default(), &SingleThread)?;
        let mut results = [Visibility::Occluded];
        let box_on_x = Aabb::new([4.0, -0.1, -0.1], [5.0, 0.1, 0.1]);
        culler.query(&[box_on_x], [0.0; 3], &mut results)?;
        Ok::<_, CullError>(results[0])
    };
    for far in [1.0, 1e100, 1e155, 1e300] {
        assert_eq!(
            look([far, 0.0, 0.0], UP).unwrap(),
            Visibility::Visible,
            "{far}"
        );
    }
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(look([wrong, 0.0, 0.0], UP).is_err(), "{wrong}");
        assert!(look([1.0, 0.0, 0.0], [0.0, wrong, 0.0]).is_err(), "{wrong}");
    }
}

#[test]
fn size_thresholds_go_by_the_views_own_angle() {
    // radius^2 < distance * threshold^2 * tangent.
    let options = FrameOptions::default().with_occludee_size_threshold(0.5);
    let least = (100.0 * 0.5_f32.powi(2) * 0.05).sqrt();
    let none = OccluderSet::new();
    for radius in [0.0, 1e-6] {
        let view = view(0.05, 0.1).with_validity_radius(radius);
        for (part, expected) in [(0.99, Visibility::Small), (1.02, Visibility::Visible)] {
            let half = part * least / 3f32.sqrt();
            let found = seen(&view, &none, &options, at(100.0, half));
            assert_eq!(found, expected, "{radius}, {part}");
        }
    }
}

#[test]
fn negative_thresholds_leave_out_nothing() {
    let options = FrameOptions::default()
        .with_occludee_size_threshold(-10.0)
        .with_occluder_size_threshold(-10.0);
    let mut set = OccluderSet::new();
    let wall = OccluderMesh::from_box(Aabb::new([-2.0, -2.0, -5.2], [2.0, 2.0, -5.0])).unwrap();
    set.add(Arc::new(wall), Affine::IDENTITY).unwrap();
    let view = view(0.5, 0.1);
    assert_eq!(
        seen(&view, &set, &options, at(4.0, 0.1)),
        Visibility::Visible
    );
    assert_eq!(
        seen(&view, &set, &options, at(9.0, 0.1)),
        Visibility::Occluded
    );
}

#[test]
fn a_tiny_mesh_that_is_placed_large_occludes() {
    for size in [1e-12_f32, 1e-15, 1e12] {
        let half = 2.0 * size;
        let mesh = OccluderMesh::from_box(Aabb::new([-half; 3], [half; 3])).unwrap();
        let scale = 1.0 / f64::from(size);
        let placed = Affine {
            x_axis: [scale, 0.0, 0.0],
            y_axis: [0.0, scale, 0.0],
            z_axis: [0.0, 0.0, scale],
            translation: [0.0, 0.0, -7.0],
        };
        let mut set = OccluderSet::new();
        set.add(Arc::new(mesh), placed).unwrap();
        let found = seen(
            &view(0.5, 0.1),
            &set,
            &FrameOptions::default(),
            at(12.0, 0.5),
        );
        assert_eq!(found, Visibility::Occluded, "{size}");
    }
}
