//! Variable shading of two eyes in one target, each against its own twin and against one eye alone.

use foveal_generate as generate;
use foveal_scene::{Camera, Projection};
use glam::UVec2;

use super::probes::Probes;
use super::tests::{Film, differing, known_otherwise, reprojected, shifted, variable};
use super::twin::{self, Seen};
use crate::EyeFrusta;
use crate::gpu::read_buffer;
use crate::testing::{gpu, texels};
use crate::{Contrast, Geometry, RateStage, Settings, Stereo};

/// No multiple of a block or a quad: there are columns between the eyes' pictures.
const SIZE: (u32, u32) = (157, 101);
/// First column of the right eye.
const STRIDE: u32 = 160;
const IPD: f32 = 0.3;

/// One eye's part of the rows of a target, in steps of `step` texels.
fn part<T: Copy>(texels: &[T], eye: u32, step: u32) -> Vec<T> {
    let across = (STRIDE + SIZE.0).div_ceil(step) as usize;
    let first = (eye * STRIDE / step) as usize;
    let width = SIZE.0.div_ceil(step) as usize;
    let rows = texels.chunks_exact(across);
    rows.flat_map(|row| row[first..first + width].to_vec())
        .collect()
}

/// Two eyes that each see what a camera sees, an eye distance apart.
fn two_eyes(camera: &Camera, stereo: Stereo) -> Settings {
    let Projection::Perspective { fov_y_rad, .. } = camera.projection else {
        panic!("a perspective");
    };
    let y = (fov_y_rad * 0.5).tan();
    let x = y * SIZE.0 as f32 / SIZE.1 as f32;
    variable(SIZE).with(|s| {
        s.stereo.mode = stereo;
        s.stereo.ipd_m = IPD;
        s.stereo.frusta = EyeFrusta::Tangents([[-x, x, -y, y]; 2]);
        s.variable.blocks_4x4 = true;
        s.variable.contrast = Contrast::Neighbors;
    })
}

fn of_eye(camera: &Camera, eye: u32) -> Camera {
    let mut camera = camera.clone();
    let right = camera.world_from_view.x_axis;
    camera.world_from_view.w_axis += right * (IPD * (eye as f32 - 0.5));
    camera
}

fn seen(film: &Film, eye: u32) -> Seen {
    let g = &film.renderer.targets().gbuffer;
    Seen {
        size: UVec2::new(SIZE.0, SIZE.1),
        identity: part(&texels(&g.identity_view), eye, 1),
        depth: part(&texels(&g.depth_view), eye, 1),
    }
}

#[test]
fn each_eyes_rates_and_samples_equal_their_twins() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let settings = two_eyes(camera, Stereo::Instanced);
    let mut film = Film::new(&scene, &settings);
    let mut probes = Probes::default();
    film.draw(camera);
    probes.next();
    let mut rates_seen = [0; 8];
    for frame in 1..5 {
        let [now, previous] = [frame, frame - 1].map(|f| shifted(camera, 0.03 * f as f32));
        let before = film.known(frame);
        let shown: Vec<[u8; 4]> = texels(&film.renderer.targets().picture_view);
        let stats = film.draw(&now).variable.expect("variable shading");
        assert!(stats.shaded_fraction < 1.0 && stats.unknown_fraction < 0.5);
        probes.disturb();
        let probe = probes.next();
        let (known, found) = (film.known(frame + 1), film.mask());
        let mut samples = Vec::new();
        for eye in 0..2 {
            let seen = seen(&film, eye);
            let cameras = [&of_eye(&now, eye), &of_eye(&previous, eye)];
            let twin = twin::reproject(
                &seen,
                cameras,
                &part(&before, eye, 2),
                &part(&shown, eye, 1),
            );
            let found = part(&found, eye, 2);
            let known = reprojected(&part(&known, eye, 2), &found);
            let (off, quads) = (known_otherwise(&known, &twin), known.len());
            assert!(off <= quads / 200, "eye {eye}: {off} of {quads} known");
            let twin = twin::rates(&settings, &seen, cameras, &known, probe);
            let off = differing(&found, &twin);
            assert!(off <= quads / 400, "eye {eye}: {off} of {quads} rates");
            found.iter().for_each(|m| rates_seen[*m as usize & 7] += 1);
            let of_eye = twin::samples(&found, seen.size);
            samples.extend(of_eye.iter().map(|s| s + eye * STRIDE / 2));
        }
        let t = film.renderer.targets().variable.as_ref().expect("variable");
        let words = |buffer| -> Vec<u32> {
            let bytes = pollster::block_on(read_buffer(gpu(), buffer)).expect("read-back works");
            bytemuck::pod_collect_to_vec(&bytes)
        };
        let count = words(&t.listed)[3] as usize;
        let mut listed = words(&t.samples)[..count].to_vec();
        listed.sort_unstable();
        samples.sort_unstable();
        assert_eq!(listed, samples, "each sample of both eyes once");
    }
    let kinds = rates_seen.iter().filter(|&&n| n > 0).count();
    assert_eq!(kinds, 5, "{rates_seen:?}");
}

#[test]
fn each_eye_is_shaded_at_the_rates_of_one_eye_alone() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    for (stereo, geometry, rate_stage) in [
        (Stereo::TwoPass, Geometry::Gbuffer, RateStage::Lighting),
        (Stereo::Instanced, Geometry::Gbuffer, RateStage::Lighting),
        (Stereo::Instanced, Geometry::Visibility, RateStage::Both),
    ] {
        let both = two_eyes(camera, stereo).with(|s| {
            s.geometry.path = geometry;
            s.rate.stage = rate_stage;
        });
        let one = both.clone().with(|s| s.stereo.mode = Stereo::Off);
        let mut film = Film::new(&scene, &both);
        let mut alone = [0, 1].map(|_| Film::new(&scene, &one));
        for frame in 0..4 {
            let now = shifted(camera, 0.03 * frame as f32);
            film.draw(&now);
            for (eye, alone) in (0..).zip(&mut alone) {
                alone.draw(&of_eye(&now, eye));
                let (a, b) = (part(&film.mask(), eye, 2), alone.mask());
                let off = differing(&a, &b);
                assert!(
                    off <= a.len() / 100,
                    "eye {eye}, frame {frame}: {off} quads"
                );
                let (a, b) = (part(&film.radiance(), eye, 1), alone.radiance());
                let off = differing(&a, &b);
                // Rounding alone makes most radiances differ in the last bit of a half.
                let far = a
                    .iter()
                    .zip(&b)
                    .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8));
                let far = far.count();
                assert!(
                    far <= a.len() / 100,
                    "eye {eye}, frame {frame}: {far} pixels of {off}"
                );
            }
        }
        let coarse = film.mask().iter().filter(|&&m| m & 3 != 0).count();
        assert!(coarse > 1000, "{coarse} coarse quads");
    }
}
