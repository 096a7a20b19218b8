//! What holds for every generated scene.

use std::sync::LazyLock;

use glam::Vec3;

use super::*;
use foveal_scene::{Aabb, Scene};

fn generate_all() -> Vec<Scene> {
    NAMES.iter().map(|name| by_name(name).unwrap()).collect()
}

/// All scenes, made once for all tests.
fn all() -> &'static [Scene] {
    static ALL: LazyLock<Vec<Scene>> = LazyLock::new(generate_all);
    &ALL
}

#[test]
fn indices_are_in_range() {
    for scene in all() {
        for mesh in &scene.meshes {
            assert!(mesh.indices.len().is_multiple_of(3) && !mesh.indices.is_empty());
            assert!(
                mesh.indices
                    .iter()
                    .all(|&i| (i as usize) < mesh.vertices.len())
            );
        }
        for (i, instance) in scene.instances.iter().enumerate() {
            assert!((instance.mesh as usize) < scene.meshes.len());
            assert!((instance.material as usize) < scene.materials.len());
            let object = &scene.objects[instance.object as usize];
            assert!(object.instances.contains(&(i as u32)));
        }
        for material in &scene.materials {
            let slots = [
                material.base_color_texture,
                material.metallic_roughness_texture,
                material.normal_texture,
                material.occlusion_texture,
                material.emissive_texture,
            ];
            for slot in slots.into_iter().flatten() {
                assert!((slot.texture as usize) < scene.textures.len());
            }
        }
    }
}

#[test]
fn vertices_are_finite_with_orthonormal_frames() {
    for scene in all() {
        for mesh in &scene.meshes {
            for v in &mesh.vertices {
                assert!(v.position.iter().chain(&v.uv[0]).all(|x| x.is_finite()));
                let (n, t) = (Vec3::from(v.normal), Vec3::from_slice(&v.tangent));
                let place = format!("{} / {}: {v:?}", scene.name, mesh.name);
                assert!((n.length() - 1.0).abs() < 1e-4, "{place}");
                assert!((t.length() - 1.0).abs() < 1e-4, "{place}");
                assert!(n.dot(t).abs() < 1e-3, "{place}");
                assert!(v.tangent[3].abs() == 1.0, "{place}");
            }
        }
    }
}

#[test]
fn triangles_face_the_way_of_their_normals() {
    for scene in all() {
        for mesh in &scene.meshes {
            for t in mesh.indices.as_chunks::<3>().0 {
                let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
                let p = |v: foveal_scene::Vertex| Vec3::from(v.position);
                let face = (p(b) - p(a)).cross(p(c) - p(a));
                let mean = Vec3::from(a.normal) + Vec3::from(b.normal) + Vec3::from(c.normal);
                let place = format!("{} / {} near {}", scene.name, mesh.name, p(a));
                assert!(face.length() > 1e-9, "sliver: {place}");
                assert!(face.dot(mean) > 0.0, "inside out: {place}");
            }
        }
    }
}

#[test]
fn bounds_are_exact() {
    for scene in all() {
        for mesh in &scene.meshes {
            let used = mesh.indices.iter().map(|&i| &mesh.vertices[i as usize]);
            assert_eq!(
                mesh.bounds,
                Aabb::of_points(used.map(|v| v.position.into()))
            );
        }
        for object in &scene.objects {
            let mut around = Aabb::EMPTY;
            for instance in
                &scene.instances[object.instances.start as usize..object.instances.end as usize]
            {
                let mesh = &scene.meshes[instance.mesh as usize];
                let exact = Aabb::of_points(mesh.indices.iter().map(|&i| {
                    let p = mesh.vertices[i as usize].position.into();
                    instance.world_from_object.transform_point3(p)
                }));
                assert_eq!(instance.bounds, exact);
                around = around.union(exact);
            }
            assert_eq!(object.bounds, around);
        }
    }
}

#[test]
fn textures_are_powers_of_two_with_whole_chains() {
    for scene in all() {
        for texture in &scene.textures {
            assert!(texture.width.is_power_of_two() && texture.height.is_power_of_two());
            let count = texture.width.max(texture.height).ilog2() + 1;
            assert_eq!(texture.levels.len() as u32, count, "{}", texture.name);
            for (k, level) in texture.levels.iter().enumerate() {
                let (w, h) = ((texture.width >> k).max(1), (texture.height >> k).max(1));
                assert_eq!(level.len() as u32, w * h * 4);
            }
        }
    }
}

#[test]
fn scenes_come_out_the_same_twice() {
    for (a, b) in all().iter().zip(generate_all()) {
        assert_eq!(a.meshes, b.meshes);
        assert_eq!(a.materials, b.materials);
        assert_eq!(a.textures, b.textures);
        assert_eq!(a.objects, b.objects);
        assert_eq!(a.instances, b.instances);
        assert_eq!(a.lights, b.lights);
        assert_eq!(a.cameras, b.cameras);
    }
}

#[test]
fn small_scenes_are_small() {
    assert!(cornell().triangle_count() < 200);
    assert_eq!(materials_grid().instances.len(), 25);
    assert!(alpha().triangle_count() < 4000);
    let mirrored = |s: &Scene| {
        s.instances
            .iter()
            .filter(|i| i.world_from_object.determinant() < 0.0)
            .count()
    };
    assert_eq!(mirrored(&alpha()), 2);
}
