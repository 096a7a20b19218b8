//! Boxes from within and from without.

use foveal_scene::{Instance, Material, Mesh, Object, Vertex};
use glam::Mat4;

use super::*;

/// A box of 12 x 3 x 4 m whose faces look outwards, or inwards when the transform mirrors them.
fn hollow_box(world_from_object: Mat4) -> Scene {
    let bounds = Aabb {
        min: Vec3::ZERO,
        max: Vec3::new(12.0, 3.0, 4.0),
    };
    let vertex = |p: Vec3| Vertex {
        position: p.into(),
        normal: [0.0; 3],
        tangent: [0.0; 4],
        uv: [[0.0; 2]; 2],
        color: [u16::MAX; 4],
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let indices = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [a, b, c, a, c, d])
        .collect();
    let mesh = Mesh {
        vertices: bounds.corners().map(vertex).to_vec(),
        indices,
        bounds,
        ..Mesh::default()
    };
    let bounds = bounds.transformed(world_from_object);
    Scene {
        meshes: vec![mesh],
        materials: vec![Material::default()],
        objects: vec![Object {
            name: String::new(),
            node: 0,
            element: 0,
            visible: true,
            occluder: None,
            set: None,
            bounds,
            instances: 0..1,
        }],
        instances: vec![Instance {
            mesh: 0,
            material: 0,
            object: 0,
            world_from_object,
            bounds,
        }],
        ..Scene::default()
    }
}

/// The same box seen from within: its faces are turned over by exchanging two corners of each.
fn room() -> Scene {
    let mut scene = hollow_box(Mat4::IDENTITY);
    for triangle in scene.meshes[0].indices.as_chunks_mut::<3>().0 {
        triangle.swap(1, 2);
    }
    scene
}

#[test]
fn a_solid_box_has_no_inside() {
    assert!(camera(&hollow_box(Mat4::IDENTITY), 1.0).is_none());
    assert!(
        camera(
            &hollow_box(Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))),
            1.0
        )
        .is_none()
    );
    assert!(camera(&Scene::default(), 1.0).is_none());
}

#[test]
fn a_room_is_seen_along_its_length() {
    let camera = camera(&room(), 1.0).unwrap();
    let forward = -camera.world_from_view.z_axis.truncate();
    assert!(forward.x.abs() > 0.9, "{forward}");
    // From the nearer end towards the farther one.
    assert!(
        (camera.eye().x - 6.0) * forward.x < -1.0,
        "{}",
        camera.eye()
    );
}

#[test]
fn a_room_without_a_wall_is_seen_from_outside() {
    let mut scene = room();
    scene.meshes[0].indices.drain(30..36);
    assert!(camera(&scene, 1.0).is_none());
}
