//! Rates at steps of depth within one instance, and of a background that the camera turns before.

use foveal_generate as generate;
use foveal_scene::{Camera, Mesh, Scene, Vertex};
use glam::{Mat4, UVec2, Vec3};

use super::probes::Probe;
use super::tests::{Film, differing, known_otherwise, reprojected, variable};
use super::twin;
use crate::testing::{add, picture, rendered, small};
use crate::{Contrast, EnvironmentMap, EnvironmentSource, RateSource, Settings};

const SIZE: (u32, u32) = (64, 48);
const FOV: f32 = 1.0;

/// A wall that faces +z, from one corner to the other, as four vertices.
fn wall(low: [f32; 2], high: [f32; 2], z: f32) -> [Vertex; 4] {
    [
        [low[0], low[1]],
        [high[0], low[1]],
        [high[0], high[1]],
        [low[0], high[1]],
    ]
    .map(|[x, y]| Vertex {
        position: [x, y, z],
        normal: [0.0, 0.0, 1.0],
        color: [u16::MAX; 4],
        ..bytemuck::Zeroable::zeroed()
    })
}

/// One mesh: a wall at 20 m, and one at 3 m before its part beyond `edge`, a place in half pictures
/// from the middle, `across` or down.
fn walls(edge: f32, across: bool) -> Scene {
    let mut scene = generate::cornell();
    scene.meshes.clear();
    scene.objects.clear();
    scene.instances.clear();
    let half = 3.0 * (0.5 * FOV).tan();
    let near = match across {
        true => [edge * half * SIZE.0 as f32 / SIZE.1 as f32, -10.0],
        false => [-10.0, edge * half],
    };
    let vertices = [
        wall([-90.0; 2], [90.0; 2], -20.0),
        wall(near, [10.0; 2], -3.0),
    ];
    let mesh = Mesh {
        vertices: vertices.concat(),
        indices: vec![0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7],
        ..Mesh::default()
    };
    let material = scene.materials[0].clone();
    add(&mut scene, mesh, material, Mat4::IDENTITY);
    scene
}

/// The second frame's mask, which is compared with the twin's.
fn mask(scene: &Scene, settings: &Settings) -> Vec<u32> {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, FOV);
    let mut film = Film::new(scene, settings);
    film.draw(&camera);
    film.draw(&camera);
    let mask = film.mask();
    let known = reprojected(&film.known(2), &mask);
    let twin = twin::rates(settings, &film.seen(), [&camera; 2], &known, Probe::NONE);
    assert_eq!(differing(&mask, &twin), 0);
    mask
}

fn constant(level: u8) -> Settings {
    variable(SIZE).with(|s| {
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = level;
        s.variable.contrast = Contrast::Quad;
        s.variable.blocks_4x4 = level > 1;
    })
}

/// A place in half pictures, x to the right and y upwards, of a column's or row's first side.
fn place(first: u32, across: bool) -> f32 {
    match across {
        true => 2.0 * first as f32 / SIZE.0 as f32 - 1.0,
        false => 1.0 - 2.0 * first as f32 / SIZE.1 as f32,
    }
}

#[test]
fn no_sample_reaches_over_a_step_in_depth_along_the_middle_of_a_quad() {
    let settings = constant(1);
    for (first, across) in [(31, true), (23, false)] {
        let mask = mask(&walls(place(first, across), across), &settings);
        // At the step samples are as high, or as wide, as a quad.
        let along = if across { 2 } else { 1 };
        for (i, rate) in (0..).zip(mask) {
            let quad = UVec2::new(i % (SIZE.0 / 2), i / (SIZE.0 / 2));
            let at = if across { quad.x } else { quad.y };
            let expected = if at == first / 2 { along } else { 3 };
            assert_eq!(rate, expected, "quad {quad}, {across}");
        }
    }
}

#[test]
fn no_block_reaches_over_a_step_in_depth_between_its_quads() {
    let settings = constant(2);
    for (first, across) in [(30, true), (22, false)] {
        let mask = mask(&walls(place(first, across), across), &settings);
        for (i, rate) in (0..).zip(mask) {
            let quad = UVec2::new(i % (SIZE.0 / 2), i / (SIZE.0 / 2));
            let at = if across { quad.x } else { quad.y };
            let expected = if at / 2 == first / 4 { 3 } else { 7 };
            assert_eq!(rate, expected, "quad {quad}, {across}");
        }
    }
}

#[test]
fn what_is_known_of_a_background_turns_with_the_camera() {
    let settings = variable(SIZE).with(|s| {
        s.lighting.environment = EnvironmentSource::Image;
        s.variable.contrast = Contrast::Quad;
    });
    let (width, height) = (128, 64);
    let is_white = |i: usize| (i % width / 8 + i / width / 8).is_multiple_of(2);
    let field = |i| [f32::from(u8::from(is_white(i))); 3];
    let texels: Vec<[f32; 3]> = (0..width * height).map(field).collect();
    let map = EnvironmentMap::new(width as u32, height as u32, &texels).unwrap();
    let mut scene = walls(0.0, true);
    // Nothing but the background is before the camera.
    scene.instances[0].world_from_object = Mat4::from_translation(Vec3::new(0.0, 0.0, 60.0));
    let turned = |angle: f32| {
        let target = Vec3::new(angle.sin(), 0.0, -angle.cos());
        Camera::look_at(Vec3::ZERO, target, Vec3::Y, FOV)
    };
    let mut film = Film::new(&scene, &settings);
    pollster::block_on(film.renderer.set_environment(map.clone())).unwrap();
    let [before, now] = [0.0, 0.1].map(turned);
    film.draw(&before);
    let old = film.known(1);
    let shown: Vec<[u8; 4]> = picture(&film.renderer).as_chunks().0.to_vec();
    film.draw(&now);
    let (known, mask) = (film.known(2), film.mask());
    let twin = twin::reproject(&film.seen(), [&now, &before], &old, &shown);
    let found = reprojected(&known, &mask);
    assert!(known_otherwise(&found, &twin) <= known.len() / 200);
    let unknown = known.iter().filter(|k| k[1] & twin::KNOWN == 0).count();
    assert!(
        (40..120).contains(&unknown),
        "{unknown} quads came into view"
    );

    let full = small(SIZE.0, SIZE.1).with(|s| s.lighting.environment = EnvironmentSource::Image);
    let mut fresh = rendered(&scene, &now, &full);
    pollster::block_on(fresh.set_environment(map)).unwrap();
    pollster::block_on(fresh.render(&crate::Frame::new(&now))).unwrap();
    let fresh = picture(&fresh);
    let of_first = |i: usize| {
        let across = SIZE.0 as usize / 2;
        f32::from(fresh[(i / across * 2 * SIZE.0 as usize + i % across * 2) * 4])
    };
    let off = |i: usize| (f32::from(known[i][0] as u8) - of_first(i)).abs() > 60.0;
    let wrong = (0..known.len()).filter(|&i| known[i][1] & twin::KNOWN != 0 && off(i));
    let wrong = wrong.count();
    assert!(wrong < known.len() / 10, "{wrong} of {}", known.len());
}

#[test]
fn quads_that_the_pictures_edge_cuts_are_shaded_by_pixels() {
    for across in [true, false] {
        let settings = constant(1).with(|s| {
            s.picture.width += 1;
            s.picture.height += 1;
        });
        let mask = mask(&walls(0.02, across), &settings);
        let wide = SIZE.0 as usize / 2 + 1;
        let (last, rows) = (mask.len() - wide, mask.chunks_exact(wide));
        assert!(mask[last..].iter().all(|rate| rate & 7 == 0));
        assert!(rows.into_iter().all(|row| row[wide - 1] & 7 == 0));
        assert!(mask.iter().any(|rate| rate & 7 == 3));
    }
}
