//! The CPU twin of the forward pass: blending of unlit quads, whose colours are known.

use foveal_scene::{
    AlphaMode, Camera, Instance, Material, Mesh, Object, Scene, Transmission, Vertex,
};
use glam::{Mat4, Vec3, Vec4};

use crate::testing::{radiance, rendered, small};

/// A quad of side 2 in the xy plane that looks towards +z.
fn quad() -> Mesh {
    let vertices: Vec<Vertex> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| Vertex {
            position: [x, y, 0.0],
            normal: [0.0, 0.0, 1.0],
            tangent: [1.0, 0.0, 0.0, 1.0],
            uv: [[0.5 + 0.5 * x, 0.5 - 0.5 * y]; 2],
            color: [u16::MAX; 4],
        })
        .to_vec();
    let bounds = foveal_scene::Aabb::of_points(vertices.iter().map(|v| v.position.into()));
    Mesh {
        name: "quad".to_owned(),
        vertices,
        indices: vec![0, 1, 2, 0, 2, 3],
        bounds,
        ..Mesh::default()
    }
}

/// Quads of these materials at these depths.
pub(crate) fn quads(materials: Vec<Material>, z: &[f32]) -> Scene {
    let mesh = quad();
    let instances: Vec<Instance> = (0..)
        .zip(z)
        .map(|(i, &z)| {
            let world_from_object = Mat4::from_translation(Vec3::new(0.0, 0.0, z));
            let bounds = mesh.bounds.transformed(world_from_object);
            Instance {
                mesh: 0,
                material: i,
                object: i,
                world_from_object,
                bounds,
            }
        })
        .collect();
    let objects = (0..)
        .zip(&instances)
        .map(|(i, instance)| Object {
            name: format!("quad {i}"),
            node: i,
            element: 0,
            visible: true,
            occluder: None,
            set: None,
            bounds: instance.bounds,
            instances: i..i + 1,
        })
        .collect();
    Scene {
        meshes: vec![mesh],
        materials,
        objects,
        instances,
        ..Scene::default()
    }
}

/// Looks at the quads from the front.
pub(crate) fn front() -> Camera {
    Camera::look_at(
        Vec3::new(0.0, 0.0, 4.0),
        Vec3::ZERO,
        Vec3::Y,
        40f32.to_radians(),
    )
}

/// Glass that reflects nothing and lets pass light of a colour.
pub(super) fn glass(color: Vec3) -> Material {
    Material {
        base_color: color.extend(1.0),
        metallic: 0.0,
        roughness: 0.0,
        ior: 1.0,
        specular: 0.0,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
            thickness_m: 0.0,
            thickness_texture: None,
            attenuation_distance_m: f32::INFINITY,
            attenuation_color: Vec3::ONE,
        }),
        ..Material::default()
    }
}

/// Asserts that a pixel has its colour but for the rounding of its 16-bit floats.
pub(super) fn assert_near(found: Vec3, expected: Vec3, what: &str) {
    let off = (found - expected).abs().max_element();
    assert!(off < 4e-3, "{what}: {found} not {expected}");
}

fn unlit(color: Vec4, double_sided: bool) -> Material {
    let alpha_mode = if color.w < 1.0 {
        AlphaMode::Blend
    } else {
        AlphaMode::Opaque
    };
    Material {
        base_color: color,
        alpha_mode,
        unlit: true,
        double_sided,
        ..Material::default()
    }
}

fn center(scene: &Scene) -> Vec3 {
    radiance(&rendered(scene, &front(), &small(31, 31)))[15 * 31 + 15]
}

#[test]
fn blended_surfaces_are_composed_back_to_front_whatever_their_order() {
    let colors = [
        Vec4::new(1.0, 0.0, 0.0, 0.5),
        Vec4::new(0.0, 1.0, 0.0, 0.25),
        Vec4::new(0.25, 0.5, 1.0, 1.0),
    ];
    let z = [0.5, 1.0, 0.0];
    let expected = colors[2]
        .truncate()
        .lerp(colors[0].truncate(), 0.5)
        .lerp(colors[1].truncate(), 0.25);
    for order in [[0, 1, 2], [1, 0, 2], [2, 1, 0]] {
        let scene = quads(
            order.map(|i| unlit(colors[i], false)).to_vec(),
            &order.map(|i| z[i]),
        );
        let drawn = center(&scene);
        assert!(
            (drawn - expected).abs().max_element() < 2e-3,
            "order {order:?}: {drawn}, expected {expected}"
        );
    }
}

#[test]
fn blended_surfaces_behind_opaque_ones_are_hidden() {
    let wall = Vec4::new(0.25, 0.5, 1.0, 1.0);
    let scene = quads(
        vec![
            unlit(wall, false),
            unlit(Vec4::new(1.0, 0.0, 0.0, 0.5), false),
        ],
        &[0.5, 0.0],
    );
    assert!((center(&scene) - wall.truncate()).abs().max_element() < 2e-3);
}

#[test]
fn only_two_sided_surfaces_are_seen_from_behind() {
    let wall = Vec4::new(0.25, 0.5, 1.0, 1.0);
    for double_sided in [false, true] {
        let glass = Vec4::new(1.0, 0.0, 0.0, 0.5);
        let mut scene = quads(
            vec![unlit(wall, true), unlit(glass, double_sided)],
            &[0.0, 0.5],
        );
        for instance in &mut scene.instances {
            instance.world_from_object *= Mat4::from_rotation_y(std::f32::consts::PI);
        }
        let expected = if double_sided {
            wall.lerp(glass, 0.5)
        } else {
            wall
        };
        assert!(
            (center(&scene) - expected.truncate()).abs().max_element() < 2e-3,
            "{double_sided}"
        );
    }
}
