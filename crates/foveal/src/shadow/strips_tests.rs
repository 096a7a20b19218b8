//! Samples of blocks notice strips of shadow between their places.

use foveal_scene::Camera;
use glam::Vec3;

use super::contact_tests::{floor, level};
use super::culling_tests::add;
use super::tests::shadowed;
use crate::composite::deviation_from_bits;
use crate::gpu::read_level;
use crate::testing::{gpu, picture, rendered};
use crate::{RateSource, Settings, Shading, Shadows};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 150;
/// Blocks of 16 x 16 pixels.
const LEVEL: u32 = 4;
const SIDE: u32 = 1 << LEVEL;

/// The first row and the number of rows of each strip that is dark over the whole width of a column of
/// blocks, and that no sample lies in.
fn strips(dark: &[bool], column: u32) -> Vec<[u32; 2]> {
    let is_dark = |y: u32| {
        let first = (y * WIDTH + column * SIDE) as usize;
        dark[first..first + SIDE as usize].iter().all(|&dark| dark)
    };
    let mut found: Vec<[u32; 2]> = Vec::new();
    for y in (0..HEIGHT).filter(|&y| is_dark(y)) {
        match found.last_mut() {
            Some([first, rows]) if *first + *rows == y => *rows += 1,
            _ => found.push([y, 1]),
        }
    }
    found.retain(|&[first, rows]| (first..first + rows).all(|y| y % SIDE != SIDE / 2));
    found
}

/// Deviations within blocks that coarse samples hold, row by row.
fn deviations(settings: &Settings, scene: &foveal_scene::Scene, camera: &Camera) -> Vec<f32> {
    let renderer = rendered(scene, camera, settings);
    let coarse = renderer.targets().coarse.as_ref().unwrap();
    let light = &coarse.light.as_ref().unwrap().samples;
    let size = light.blocks(LEVEL);
    let bytes = pollster::block_on(read_level(gpu(), &light.texture, LEVEL, size)).unwrap();
    let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
    words
        .iter()
        .map(|w| deviation_from_bits(w[2] >> 28))
        .collect()
}

/// A board above a floor, seen from the side: its shadow is some six rows of pixels high.
#[test]
fn samples_notice_strips_of_shadow_between_them() {
    let camera = Camera::look_at(Vec3::new(0.0, 1.5, 4.0), Vec3::ZERO, Vec3::Y, 0.8);
    let soft = shadowed(Shadows::Soft).with(|s| {
        s.picture.width = WIDTH;
        s.picture.height = HEIGHT;
    });
    let coarse = soft.clone().with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = LEVEL as u8;
        s.coarse.history = false;
    });
    let open = floor(Vec3::new(0.0, 2.0, 0.0));
    let lit = picture(&rendered(&open, &camera, &soft));
    let (mut noticed, mut seen) = (0, 0);
    for step in 0..20 {
        let from = 0.35 + 0.02 * step as f32;
        let mut scene = open.clone();
        add(&mut scene, [level([-3.0, 3.0], 1.0, [from, from + 0.12])]);
        let shown = picture(&rendered(&scene, &camera, &soft));
        let dark: Vec<bool> = (shown.chunks(4).zip(lit.chunks(4)))
            .map(|(shown, lit)| u32::from(shown[1]) * 10 < u32::from(lit[1]) * 9)
            .collect();
        let deviations = deviations(&coarse, &scene, &camera);
        // Farther out, blocks reach from one side of the lamp's cube into another.
        for column in 2..13 {
            for [first, rows] in strips(&dark, column) {
                let most = (first / SIDE..=(first + rows - 1) / SIDE)
                    .map(|row| deviations[(row * WIDTH.div_ceil(SIDE) + column) as usize])
                    .fold(0.0, f32::max);
                seen += u32::from(rows >= 5);
                noticed += u32::from(rows >= 5 && most > 0.2);
            }
        }
    }
    assert!(seen > 50 && noticed == seen, "{noticed} of {seen}");
}
