//! Where two eyes see a point.

use foveal_scene::{Camera, Projection, Scene};
use glam::Vec3;

use super::{WAYS, shape, two_eyes};
use crate::stereo::EyeLayout;
use crate::testing::{picture, rendered, texels};
use crate::{DebugView, Error, Frame, Renderer, Settings};

/// A disc of 128 corners in front of a camera at the origin, off its axis.
fn disc(distance: f32) -> Scene {
    let center = Vec3::new(0.07, -0.04, -1.0) * distance;
    let corners: Vec<Vec3> = (0..128)
        .map(|i| {
            let angle = i as f32 / 128.0 * std::f32::consts::TAU;
            center + 0.3 * distance * Vec3::new(angle.cos(), angle.sin(), 0.0)
        })
        .collect();
    shape(&corners)
}

/// The centroid of what each eye sees of the only object, in pixels of its picture.
fn centroids(scene: &Scene, settings: &Settings) -> [[f64; 2]; 2] {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
    let renderer = rendered(scene, &camera, settings);
    let identity: Vec<[u32; 2]> = texels(&renderer.targets().gbuffer.identity_view);
    let layout = EyeLayout::of(settings);
    let width = layout.target_size().0;
    [0, 1].map(|eye| {
        let first = eye * layout.stride;
        let mut sum = [0.0, 0.0, 0.0];
        for y in 0..layout.height {
            for x in 0..layout.width {
                if identity[(y * width + first + x) as usize][0] != 0 {
                    sum[0] += f64::from(x) + 0.5;
                    sum[1] += f64::from(y) + 0.5;
                    sum[2] += 1.0;
                }
            }
        }
        [sum[0] / sum[2], sum[1] / sum[2]]
    })
}

#[test]
fn disparity_is_that_of_the_distance_and_none_at_the_convergence_distance() {
    for (stereo, eye_clipping) in WAYS {
        for (ipd_m, convergence_m) in [(0.063, 2.0), (0.2, 3.0)] {
            let settings = two_eyes(401, 300).with(|s| {
                s.stereo.mode = stereo;
                s.stereo.clipping = eye_clipping;
                s.stereo.ipd_m = ipd_m;
                s.stereo.convergence_m = convergence_m;
            });
            // Pixels per tangent.
            let focal = 0.5 * 300.0 / (0.5f64).tan();
            for distance in [1.0f32, 2.0, 3.0, 10.0] {
                let [left, right] = centroids(&disc(distance), &settings);
                let per_metre = 1.0 / f64::from(distance) - 1.0 / f64::from(convergence_m);
                let expected = focal * f64::from(ipd_m) * per_metre;
                let seen = left[0] - right[0];
                assert!(
                    (seen - expected).abs() <= 0.1 && (left[1] - right[1]).abs() <= 0.1,
                    "{stereo:?} at {distance} m, eyes {ipd_m} m apart: {seen}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn frusta_given_by_tangents_show_points_where_the_tangents_say() {
    let eye_tangents = [[-1.2, 0.8, -0.9, 1.1], [-0.7, 1.3, -1.0, 1.0]];
    let settings = two_eyes(400, 300).with(|s| {
        s.stereo.frusta = "-1.2,0.8,-0.9,1.1,-0.7,1.3,-1,1"
            .parse()
            .expect("it can be read");
        s.stereo.ipd_m = 0.1;
    });
    for distance in [1.0, 5.0] {
        let seen = centroids(&disc(distance), &settings);
        for (eye, x) in [(0, 0.05), (1, -0.05)] {
            let [left, right, bottom, top] = eye_tangents[eye].map(f64::from);
            let tangent = [0.07 + x / f64::from(distance), -0.04];
            let expected = [
                (tangent[0] - left) / (right - left) * 400.0,
                (top - tangent[1]) / (top - bottom) * 300.0,
            ];
            for axis in 0..2 {
                let off = seen[eye][axis] - expected[axis];
                assert!(off.abs() <= 0.1, "eye {eye} at {distance} m: off by {off}");
            }
        }
    }
}

#[test]
fn cameras_that_two_eyes_cannot_use_are_errors() {
    let scene = disc(1.0);
    let settings = two_eyes(40, 30);
    pollster::block_on(async {
        let gpu = crate::testing::gpu();
        let mut renderer = Renderer::new(gpu, &settings, crate::RendererOptions::default())
            .await
            .expect("fits");
        renderer.set_scene(&scene).await.expect("fits");
        let orthographic = |near_m, far_m| Projection::Orthographic {
            height_m: 1.0,
            near_m,
            far_m,
        };
        let perspective = |fov_y_rad, near_m| Projection::Perspective { fov_y_rad, near_m };
        for (projection, name) in [
            (orthographic(0.1, 10.0), "stereo"),
            (orthographic(10.0, 10.0), "camera"),
            (orthographic(10.0, 1.0), "camera"),
            (perspective(1.0, -0.1), "camera"),
            (perspective(1.0, f32::NAN), "camera"),
            (perspective(4.0, 0.1), "camera"),
        ] {
            let mut camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
            camera.projection = projection;
            let frame = Frame::new(&camera);
            match renderer.render(&frame).await {
                Err(Error::Setting { name: found, .. }) => assert_eq!(found, name),
                other => panic!("{projection:?}: {other:?}"),
            }
        }
    });
}

#[test]
fn two_eyes_may_follow_a_frame_in_parallel_projection() {
    let scene = disc(1.0);
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
    let mut before = camera.clone();
    before.projection = Projection::Orthographic {
        height_m: 1.0,
        near_m: 0.1,
        far_m: 10.0,
    };
    let settings = two_eyes(40, 30).with(|s| s.picture.view = DebugView::Motion);
    let mut renderer = rendered(&scene, &camera, &settings);
    let resting = picture(&renderer);
    let frame = Frame::new(&camera).with_previous(&before);
    pollster::block_on(renderer.render(&frame)).expect("this frame's camera is a perspective one");
    assert!(picture(&renderer) == resting);
}
