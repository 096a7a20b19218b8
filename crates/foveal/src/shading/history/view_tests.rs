//! Kept light where the eye moves: highlights, and cuts to closer views.

use foveal_scene::{Camera, Light, LightKind, Material, Projection, Scene};
use glam::{Mat4, Vec3};

use crate::forward::twin::quads;
use crate::testing::{Film, f32_of_half, shifted, small};
use crate::{RateSource, Settings, Shading};

/// A wall of a roughness, 8 m wide, and lamps before it.
fn wall(roughness: f32, lamps: impl Iterator<Item = (Vec3, f32)>) -> Scene {
    let material = Material {
        metallic: 0.0,
        roughness,
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    let place = Mat4::from_scale(Vec3::new(8.0, 8.0, 1.0));
    scene.instances[0].world_from_object = place;
    scene.instances[0].bounds = scene.meshes[0].bounds.transformed(place);
    scene.objects[0].bounds = scene.instances[0].bounds;
    let lamp = |(position, range)| Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity: range * range,
        position,
        direction: Vec3::NEG_Y,
        range_m: Some(range),
        node: None,
    };
    scene.lights = lamps.map(lamp).collect();
    scene
}

fn settings(level: u8) -> Settings {
    small(157, 101).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = level;
    })
}

/// Mean difference of the last view's picture from full shading's, in parts of the latter, after
/// the other views: with kept light, and without.
fn errors(scene: &Scene, settings: &Settings, views: &[Camera]) -> [f32; 2] {
    let full = settings.clone().with(|s| s.shading.mode = Shading::Full);
    let radiance = |settings: &Settings| {
        let mut film = Film::new(scene, settings);
        for view in views {
            film.draw(view);
        }
        let red = film.radiance().into_iter();
        red.map(|texel| f32_of_half(texel[0])).collect::<Vec<f32>>()
    };
    let right = radiance(&full);
    let sum: f32 = right.iter().sum();
    assert!(sum > 0.0);
    [true, false].map(|history| {
        let found = radiance(&settings.clone().with(|s| s.coarse.history = history));
        let off = found.iter().zip(&right).map(|(a, b)| (a - b).abs());
        off.sum::<f32>() / sum
    })
}

fn before_the_wall(distance: f32) -> Camera {
    let eye = Vec3::new(-0.5, 0.0, distance);
    Camera::look_at(eye, eye - Vec3::Z, Vec3::Y, 0.8)
}

#[test]
fn highlights_do_not_lag_behind_the_eye() {
    let lamps = (0..6u8).map(|i| (Vec3::new(f32::from(i) - 2.5, 0.3, 0.8), 2.0));
    for roughness in [0.15, 0.3] {
        let scene = wall(roughness, lamps.clone());
        let views: Vec<Camera> = (0..14u8)
            .map(|frame| shifted(&before_the_wall(3.0), 0.1 * f32::from(frame)))
            .collect();
        for level in [0, 2] {
            let [kept, anew] = errors(&scene, &settings(level), &views);
            println!("HIGHLIGHTS roughness {roughness}, level {level}: {kept}, {anew}");
            assert!(
                kept < 1.5 * anew + 0.01,
                "roughness {roughness}, level {level}: {kept}, {anew}"
            );
        }
    }
}

#[test]
fn highlights_do_not_lag_behind_a_parallel_projection_that_turns() {
    let lamps = (0..6u8).map(|i| (Vec3::new(f32::from(i) - 2.5, 0.3, 0.8), 2.0));
    let scene = wall(0.15, lamps);
    let views: Vec<Camera> = (0..14u8)
        .map(|frame| {
            let (sin, cos) = (0.05 * f32::from(frame)).sin_cos();
            let eye = 3.0 * Vec3::new(sin, 0.0, cos);
            Camera {
                projection: Projection::Orthographic {
                    height_m: 2.5,
                    near_m: 0.1,
                    far_m: 10.0,
                },
                ..Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 0.8)
            }
        })
        .collect();
    for level in [0, 2] {
        let [kept, anew] = errors(&scene, &settings(level), &views);
        println!("PARALLEL level {level}: {kept}, {anew}");
        assert!(kept < 1.5 * anew + 0.01, "level {level}: {kept}, {anew}");
    }
}

#[test]
fn a_cut_to_a_closer_view_magnifies_no_kept_light() {
    // Spots of light that a pixel of the far view can hardly tell apart.
    let lamps = (0..225u8).map(|i| {
        let (column, row) = (f32::from(i % 15), f32::from(i / 15));
        (
            Vec3::new(0.12 * (column - 11.0), 0.12 * (row - 7.0), 0.04),
            0.12,
        )
    });
    let scene = wall(0.9, lamps);
    for level in [0, 1] {
        let views = [14.0, 14.0, 14.0, 2.0].map(before_the_wall);
        let [kept, anew] = errors(&scene, &settings(level), &views);
        println!("CUT level {level}: {kept}, {anew}");
        assert!(kept < 1.2 * anew + 0.005, "level {level}: {kept}, {anew}");
    }
}
