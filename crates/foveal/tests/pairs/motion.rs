//! Cameras and scenes that move by chance.

use foveal_scene::{Camera, Projection, Scene};
use glam::{Mat4, Vec3};

use crate::settings::Chance;

/// The cameras of some frames: three steps and turns, then rest.
pub(crate) fn cameras(chance: &mut Chance<'_>, scene: &Scene, frames: usize) -> Vec<Camera> {
    let first = chance.of(&[0, 1, 2]) % scene.cameras.len();
    let step = chance.of(&[0.0, 0.02, 0.3]);
    let turn = chance.of(&[0.0, 0.01, 0.2]);
    let zoom: f32 = chance.of(&[1.0, 1.0, 1.0, 0.8, 1.02]);
    let parallel = chance.of(&[false, false, false, true]);
    let cut = chance.of(&[4, 4, 2]);
    (0..frames)
        .map(|frame| {
            let frame = frame.min(3);
            let from = if frame >= cut { first + 1 } else { first };
            let frame = frame as f32;
            let mut camera = scene.cameras[from % scene.cameras.len()].clone();
            let moved = Mat4::from_translation(Vec3::new(step * frame, 0.0, 0.0));
            camera.world_from_view *= moved * Mat4::from_rotation_y(turn * frame);
            if parallel {
                camera.projection = Projection::Orthographic {
                    height_m: 4.0,
                    near_m: 0.05,
                    far_m: 60.0,
                };
            }
            match &mut camera.projection {
                Projection::Perspective {
                    fov_y_rad: size, ..
                }
                | Projection::Orthographic { height_m: size, .. } => *size *= zoom.powf(frame),
            }
            camera
        })
        .collect()
}

/// The scene's poses in some frames; after the last one it rests.
pub(crate) fn poses(chance: &mut Chance<'_>, scene: &Scene) -> Vec<Scene> {
    let what = chance.of(&[
        "", "", "thing", "lamp", "dim", "color", "shape", "aim", "all",
    ]);
    let which = usize::from(chance.of(&[0_u8, 1, 7, 50, 255]));
    let frames = if what.is_empty() { 1 } else { 4 };
    (0..frames)
        .map(|frame| posed(scene, what, which, frame as f32))
        .collect()
}

fn posed(scene: &Scene, what: &str, which: usize, frame: f32) -> Scene {
    let mut scene = scene.clone();
    let moves = |one| what == one || what == "all";
    let along = Mat4::from_translation(Vec3::new(0.1, 0.02, -0.05) * frame);
    if moves("thing") {
        let count = scene.instances.len();
        let instance = &mut scene.instances[which % count];
        instance.world_from_object = along * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(along);
        let object = &mut scene.objects[instance.object as usize];
        object.bounds = object.bounds.union(instance.bounds);
    }
    let lamps = scene.lights.len();
    let lamp = &mut scene.lights[which % lamps];
    if moves("lamp") {
        lamp.position += Vec3::new(0.2, 0.1, 0.0) * frame;
    }
    if moves("hide") {
        let count = scene.objects.len();
        scene.objects[which % count].visible = frame < 2.0;
    }
    if moves("aim") {
        let turn = Mat4::from_rotation_z(0.2 * frame);
        lamp.direction = turn.transform_vector3(lamp.direction);
    }
    if moves("dim") {
        lamp.intensity *= 1.0 - 0.3 * frame;
    }
    if moves("color") {
        let materials = scene.materials.len();
        scene.materials[which % materials].base_color[0] *= 1.0 - 0.2 * frame;
    }
    if moves("shape") {
        let mesh = scene.instances.last().expect("an instance").mesh;
        let shape = &mut scene.meshes[mesh as usize];
        for vertex in &mut shape.vertices {
            vertex.position[0] *= 1.0 + 0.1 * frame;
        }
        shape.bounds =
            shape
                .bounds
                .transformed(Mat4::from_scale(Vec3::new(1.0 + 0.1 * frame, 1.0, 1.0)));
        let bounds = shape.bounds;
        for instance in scene.instances.iter_mut().filter(|i| i.mesh == mesh) {
            instance.bounds = bounds.transformed(instance.world_from_object);
            let object = &mut scene.objects[instance.object as usize];
            object.bounds = object.bounds.union(instance.bounds);
        }
    }
    scene
}
