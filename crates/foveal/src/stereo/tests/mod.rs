//! Two eyes on the device.

mod equal;
mod lens;
mod multiview;
mod parallax;
mod present;

use foveal_scene::{Camera, Material, Mesh, Scene, Vertex};
use glam::{Mat4, Vec3};

use crate::testing::{add, picture, rendered, small};
use crate::{EyeClipping, Output, Settings, Stereo};

/// The ways in which two eyes' geometry can be submitted.
const WAYS: [(Stereo, EyeClipping); 3] = [
    (Stereo::TwoPass, EyeClipping::Auto),
    (Stereo::Instanced, EyeClipping::Clip),
    (Stereo::Instanced, EyeClipping::Discard),
];

/// Settings for two eyes side by side.
fn two_eyes(width: u32, height: u32) -> Settings {
    small(width, height).with(|s| {
        s.stereo.mode = Stereo::TwoPass;
        s.stereo.output = Output::SideBySide;
    })
}

/// The left and the right half of a picture drawn with the output `side-by-side`.
fn halves(scene: &Scene, camera: &Camera, settings: &Settings) -> [Vec<[u8; 4]>; 2] {
    let renderer = rendered(scene, camera, settings);
    let both: Vec<[u8; 4]> = bytemuck::pod_collect_to_vec(&picture(&renderer));
    let width = settings.picture.width as usize;
    let half = |first: usize| {
        let rows = both.chunks_exact(2 * width);
        rows.flat_map(|row| row[first..first + width].to_vec())
            .collect()
    };
    [half(0), half(width)]
}

/// A flat shape that faces +z, given by its corners in order, in a scene of its own; white and
/// without light.
fn shape(corners: &[Vec3]) -> Scene {
    let vertex = |p: &Vec3| Vertex {
        position: p.to_array(),
        normal: [0.0, 0.0, 1.0],
        color: [u16::MAX; 4],
        ..bytemuck::Zeroable::zeroed()
    };
    let last = corners.len() as u32 - 1;
    let mesh = Mesh {
        vertices: corners.iter().map(vertex).collect(),
        indices: (1..last).flat_map(|i| [0, i, i + 1]).collect(),
        ..Mesh::default()
    };
    let white = Material {
        unlit: true,
        ..Material::default()
    };
    let mut scene = Scene::default();
    add(&mut scene, mesh, white, Mat4::IDENTITY);
    scene
}
