//! The CPU twin of the geometry pass: a ray per pixel against every triangle.

use foveal_generate as generate;
use foveal_scene::{
    AlphaMode, Camera, ColorSpace, Filter, Material, Projection, Sampler, Scene, Texture,
    TextureRef,
};

use glam::{Mat3, Vec2, Vec3};

use crate::Geometry;
use crate::forward::twin::{front, quads};
use crate::shading::twin::{position_at, unpack_surface};
use crate::testing::{rendered, small, texels};

struct Hit {
    distance: f32,
    instance: u32,
    normal: Vec3,
    /// Distance of the hit from the triangle's edges, in barycentric units.
    inside: f32,
}

/// Möller and Trumbore 1997; two-sided where the material is.
fn intersect(scene: &Scene, origin: Vec3, direction: Vec3) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    for (index, instance) in (1..).zip(&scene.instances) {
        let mesh = &scene.meshes[instance.mesh as usize];
        let material = &scene.materials[instance.material as usize];
        if material.alpha_mode == AlphaMode::Blend {
            continue;
        }
        let m = instance.world_from_object;
        let mirrored = m.determinant() < 0.0;
        let normals = Mat3::from_mat4(m).inverse().transpose();
        for triangle in mesh.indices.chunks_exact(3) {
            let v = [0, 1, 2].map(|k| &mesh.vertices[triangle[k] as usize]);
            let p = v.map(|v| m.transform_point3(v.position.into()));
            let (e1, e2) = (p[1] - p[0], p[2] - p[0]);
            let q = direction.cross(e2);
            let det = e1.dot(q);
            let front = (det > 0.0) != mirrored;
            if det.abs() < 1e-12 || !(front || material.double_sided) {
                continue;
            }
            let s = origin - p[0];
            let b1 = s.dot(q) / det;
            let r = s.cross(e1);
            let b2 = direction.dot(r) / det;
            let t = e2.dot(r) / det;
            let inside = b1.min(b2).min(1.0 - b1 - b2);
            if inside < 0.0 || t <= 0.0 || nearest.as_ref().is_some_and(|n| n.distance <= t) {
                continue;
            }
            // Unit vectors at the vertices, interpolated: as the vertex shader and the rasterizer
            // do.
            let n = v.map(|v| (normals * Vec3::from(v.normal)).normalize());
            let normal = n[0] * (1.0 - b1 - b2) + n[1] * b1 + n[2] * b2;
            let normal = normal.normalize() * if front { 1.0 } else { -1.0 };
            nearest = Some(Hit {
                distance: t,
                instance: index,
                normal,
                inside,
            });
        }
    }
    nearest
}

fn assert_equals_twin(scene: &Scene, camera: &Camera) {
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        assert_geometry_equals_twin(scene, camera, geometry);
    }
}

fn assert_geometry_equals_twin(scene: &Scene, camera: &Camera, geometry: Geometry) {
    let (width, height) = (47, 33);
    let settings = small(width, height).with(|s| s.geometry.path = geometry);
    let renderer = rendered(scene, camera, &settings);
    let gbuffer = &renderer.targets().gbuffer;
    let words: Vec<[u32; 4]> = texels(&gbuffer.surface_view);
    let identity: Vec<[u32; 2]> = texels(&gbuffer.identity_view);
    let depth: Vec<f32> = texels(&gbuffer.depth_view);
    let size = Vec2::new(width as f32, height as f32);
    let orthographic = matches!(camera.projection, Projection::Orthographic { .. });
    let forward = -camera.world_from_view.z_axis.truncate();
    let (mut compared, mut edges) = (0, 0);
    for i in 0..depth.len() {
        let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
        let near = position_at(camera, size, pixel, 1.0);
        let direction = if orthographic {
            forward
        } else {
            (near - camera.eye()).normalize()
        };
        let hit = intersect(scene, near, direction);
        let (expected, on_edge) = hit
            .as_ref()
            .map_or((0, false), |h| (h.instance, h.inside < 0.02));
        if identity[i][0] != expected {
            // Rays and rasterizers may differ where an edge passes the pixel's centre.
            edges += 1;
            continue;
        }
        let Some(hit) = hit else { continue };
        let position = near + direction * hit.distance;
        let surface = unpack_surface(words[i], position_at(camera, size, pixel, depth[i]));
        let off = surface.position.distance(position);
        assert!(
            off < 2e-3 * (1.0 + hit.distance) || on_edge,
            "at {pixel}: {} not {position}",
            surface.position
        );
        assert!(
            surface.normal.dot(hit.normal) > 0.9995 || on_edge,
            "at {pixel}: {} not {}",
            surface.normal,
            hit.normal
        );
        let material =
            &scene.materials[scene.instances[hit.instance as usize - 1].material as usize];
        if material.base_color_texture.is_none() && !material.unlit {
            let roughness = surface.roughness - material.roughness;
            assert!(roughness.abs() < 0.01 || material.metallic_roughness_texture.is_some());
            let emissive = (surface.emissive - material.emissive).abs().max_element();
            assert!(
                emissive <= 0.01 * material.emissive.max_element()
                    || material.emissive_texture.is_some()
            );
        }
        compared += 1;
    }
    assert!(compared > 250, "only {compared} pixels see a surface");
    assert!(
        edges * 50 < depth.len(),
        "{edges} pixels see another instance"
    );
}

#[test]
fn the_gbuffer_equals_its_twin() {
    let scene = generate::cornell();
    assert_equals_twin(&scene, &scene.cameras[0]);
    let mut camera = scene.cameras[0].clone();
    camera.projection = Projection::Orthographic {
        height_m: 4.0,
        near_m: 0.05,
        far_m: 30.0,
    };
    assert_equals_twin(&scene, &camera);
}

#[test]
fn mirrored_and_scaled_instances_equal_their_twins() {
    let mut scene = generate::cornell();
    let flip = glam::Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    for instance in &mut scene.instances {
        instance.world_from_object = flip * instance.world_from_object;
    }
    assert_equals_twin(&scene, &scene.cameras[0].clone());
    let squash = glam::Mat4::from_scale(Vec3::new(0.5, 2.0, 1.0));
    for instance in &mut scene.instances {
        instance.world_from_object = squash * instance.world_from_object;
    }
    assert_equals_twin(&scene, &scene.cameras[0].clone());
}

#[test]
fn instances_of_meshes_in_small_units_equal_their_twins() {
    // Meshes of integers are scaled by a 32767th of their size.
    let small = 1e-8;
    let mut scene = generate::cornell();
    for vertex in scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.vertices) {
        vertex.position = vertex.position.map(|x| x / small);
    }
    for instance in &mut scene.instances {
        instance.world_from_object *= glam::Mat4::from_scale(Vec3::splat(small));
    }
    assert_equals_twin(&scene, &scene.cameras[0].clone());
}

/// A texture of 4 x 2 texels, each its own colour, without mips or filtering.
fn tiny_texture(color_space: ColorSpace) -> Texture {
    let nearest = Filter::Nearest;
    Texture {
        name: "tiny".to_owned(),
        width: 4,
        height: 2,
        color_space,
        sampler: Sampler {
            mag: nearest,
            min: nearest,
            mip: None,
            ..Sampler::default()
        },
        encoding: foveal_scene::Encoding::Rgba8,
        levels: vec![
            (0..8u8)
                .flat_map(|i| [i * 30, 255 - i * 30, i * 16, if i == 3 { 0 } else { 255 }])
                .collect(),
        ],
    }
}

#[test]
fn textures_are_read_where_the_uv_map_says_and_decoded_as_the_colour_space_says() {
    // Turned by a quarter, doubled, shifted; the mask cuts out texel 3.
    let uv_transform = Mat3::from_translation(Vec2::new(0.25, 0.5))
        * Mat3::from_angle(std::f32::consts::FRAC_PI_2)
        * Mat3::from_scale(Vec2::splat(2.0));
    let slot = |texture| {
        Some(TextureRef {
            texture,
            uv_set: 1,
            uv_transform,
        })
    };
    let material = Material {
        base_color_texture: slot(0),
        metallic_roughness_texture: slot(1),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.textures = vec![
        tiny_texture(ColorSpace::Srgb),
        tiny_texture(ColorSpace::Linear),
    ];
    let (width, height) = (64, 64);
    let camera = front();
    let renderer = rendered(&scene, &camera, &small(width, height));
    let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let size = Vec2::new(width as f32, height as f32);
    let (mut compared, mut holes) = (0, 0);
    for i in 0..depth.len() {
        let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
        let at_quad = position_at(&camera, size, pixel, 0.05 / 4.0);
        if at_quad.truncate().abs().max_element() > 0.99 {
            continue;
        }
        let uv = Vec2::new(0.5 + 0.5 * at_quad.x, 0.5 - 0.5 * at_quad.y);
        let texel = uv_transform.transform_point2(uv) * Vec2::new(4.0, 2.0);
        if (texel - texel.round()).abs().min_element() < 0.02 {
            continue;
        }
        let index =
            texel.x.floor().rem_euclid(4.0) as usize + 4 * texel.y.floor().rem_euclid(2.0) as usize;
        let [r, g, b, a] = [0, 1, 2, 3].map(|c| scene.textures[0].levels[0][index * 4 + c]);
        assert_eq!(depth[i] == 0.0, a == 0, "at {pixel}, texel {index}");
        if a == 0 {
            holes += 1;
            continue;
        }
        let surface = unpack_surface(words[i], Vec3::ZERO);
        let linear = Vec3::new(r.into(), g.into(), b.into())
            .map(|v| ((v / 255.0 + 0.055) / 1.055).powf(2.4));
        let off = (surface.base_color - linear).abs().max_element();
        assert!(
            off < 0.01,
            "at {pixel}: {} not {linear}",
            surface.base_color
        );
        assert!(
            (surface.roughness - f32::from(g) / 255.0).abs() < 0.004,
            "at {pixel}: green is the roughness"
        );
        assert!(
            (surface.metallic - f32::from(b) / 255.0).abs() < 0.004,
            "at {pixel}: blue is the metallic"
        );
        compared += 1;
    }
    assert!(
        compared > 500 && holes > 50,
        "{compared} texels, {holes} holes"
    );
}
