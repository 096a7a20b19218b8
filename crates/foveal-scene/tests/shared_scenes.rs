//! The well-formed scenes beside the repository load with the counts that their manifest states.
//!
//! Without `../shared/data` the test says so and passes.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop at once, and its figures are for reading"
)]

use std::collections::HashSet;
use std::path::Path;

use foveal_scene::{Aabb, LoadOptions, Scene, load};

/// Checks what every consumer of a scene relies on.
fn assert_sound(scene: &Scene, name: &str) {
    let below = |i: u32, n: usize| assert!((i as usize) < n, "{name}");
    for mesh in &scene.meshes {
        assert!(!mesh.indices.is_empty() && mesh.indices.len().is_multiple_of(3));
        mesh.indices
            .iter()
            .for_each(|&i| below(i, mesh.vertices.len()));
        for v in &mesh.vertices {
            let length = glam_length(v.normal);
            assert!((length - 1.0).abs() < 1e-3, "{name}: normal {:?}", v.normal);
            assert!(
                v.position
                    .iter()
                    .chain(v.uv.as_flattened())
                    .all(|x| x.is_finite())
            );
        }
    }
    for (i, instance) in scene.instances.iter().enumerate() {
        below(instance.mesh, scene.meshes.len());
        below(instance.material, scene.materials.len());
        let object = &scene.objects[instance.object as usize];
        assert!(object.instances.contains(&(i as u32)));
        assert_eq!(object.bounds.union(instance.bounds), object.bounds);
        let material = &scene.materials[instance.material as usize];
        if material.normal_texture.is_some() {
            let mesh = &scene.meshes[instance.mesh as usize];
            for v in &mesh.vertices {
                assert_eq!(v.tangent[3].abs(), 1.0, "{name}: {}", mesh.name);
            }
        }
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
            below(slot.texture, scene.textures.len());
            assert!(slot.uv_set < 2);
        }
    }
    for texture in &scene.textures {
        for (k, level) in texture.levels.iter().enumerate() {
            let (w, h) = ((texture.width >> k).max(1), (texture.height >> k).max(1));
            assert_eq!(
                level.len(),
                (w * h * 4) as usize,
                "{name}: {}",
                texture.name
            );
        }
    }
}

fn glam_length([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

/// The boxes of a sample of instances against every vertex that is used.
fn assert_exact_bounds(scene: &Scene) {
    let step = (scene.instances.len() / 200).max(1);
    for instance in scene.instances.iter().step_by(step) {
        let mesh = &scene.meshes[instance.mesh as usize];
        let points = mesh.indices.iter().map(|&i| {
            let position = mesh.vertices[i as usize].position.into();
            instance.world_from_object.transform_point3(position)
        });
        assert_eq!(instance.bounds, Aabb::of_points(points), "{}", mesh.name);
    }
}

#[test]
fn counts_agree_with_the_manifest() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let Ok(manifest) = std::fs::read_to_string(data.join("MANIFEST.tsv")) else {
        println!("skipped: {} is not there", data.display());
        return;
    };
    let mut seen = 0;
    for line in manifest.lines() {
        let columns: Vec<&str> = line.split('\t').collect();
        let name = columns[0];
        let number = |i: usize| columns[i].parse::<u64>().unwrap();
        if !name.ends_with(".glb") {
            continue;
        }
        let scene = load(&data.join(name), &LoadOptions::default()).unwrap();
        println!("{name}: {:?}", scene.timings);
        assert_sound(&scene, name);
        assert_exact_bounds(&scene);
        assert_eq!(scene.triangle_count(), number(3), "triangles of {name}");
        // Nodes without a mesh leave no object; equal primitives share a mesh.
        assert!(scene.objects.len() as u64 <= number(4), "nodes of {name}");
        assert!(
            scene.meshes.len() as u64 <= number(6),
            "primitives of {name}"
        );
        let materials: HashSet<u32> = scene.instances.iter().map(|i| i.material).collect();
        let default = u64::from(scene.materials.len() as u64 > number(7));
        assert_eq!(
            scene.materials.len() as u64,
            number(7) + default,
            "materials of {name}"
        );
        assert!(materials.len() <= scene.materials.len());
        assert_eq!(scene.is_animated(), number(9) > 0, "animations of {name}");
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
        seen += 1;
    }
    println!("{seen} scenes");
    let market = data.join("scenes/IntelCastleMarket.glb");
    if market.exists() {
        let scene = load(&market, &LoadOptions::default()).unwrap();
        assert_sound(&scene, "market");
        assert_exact_bounds(&scene);
        assert_eq!(
            (scene.objects.len(), scene.triangle_count()),
            (26_894, 1_891_747)
        );
        let occluders = scene.objects.iter().filter(|o| o.occluder == Some(true));
        assert!(occluders.count() > 0);
        assert!(scene.cameras.iter().any(|c| c.name == "sample_start"));
    }
}

#[test]
fn one_thread_and_many_give_the_same_scene() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let file = data.join("samples/AlphaBlendModeTest.glb");
    if !file.exists() {
        println!("skipped: {} is not there", file.display());
        return;
    }
    let parallel = load(&file, &LoadOptions::default()).unwrap();
    let options = LoadOptions {
        parallel: false,
        ..LoadOptions::default()
    };
    let single = load(&file, &options).unwrap();
    assert_eq!(parallel.meshes, single.meshes);
    assert_eq!(parallel.textures, single.textures);
    assert_eq!(parallel.instances, single.instances);
}

#[test]
fn generated_tangents_agree_with_those_of_the_file() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let file = data.join("samples/FlightHelmet.glb");
    let Ok(bytes) = std::fs::read(&file) else {
        println!("skipped: {} is not there", file.display());
        return;
    };
    let options = LoadOptions::default();
    let stored = load(&file, &options).unwrap();
    // An attribute by another name is not read.
    let mut renamed = bytes.clone();
    let json = 20..20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    for i in json {
        if renamed[i..].starts_with(b"\"TANGENT\"") {
            renamed[i + 1..i + 8].copy_from_slice(b"_ANGENT");
        }
    }
    let made =
        foveal_scene::load_bytes(&renamed, "made", &options, &|_| Err(String::new())).unwrap();
    let (mut corners, mut close, mut same_sign) = (0u32, 0u32, 0u32);
    for (a, b) in stored.meshes.iter().zip(&made.meshes) {
        assert_eq!(a.indices.len(), b.indices.len());
        for (&i, &j) in a.indices.iter().zip(&b.indices) {
            let (s, m) = (
                a.vertices[i as usize].tangent,
                b.vertices[j as usize].tangent,
            );
            let cosine: f32 = (0..3).map(|k| s[k] * m[k]).sum();
            corners += 1;
            close += u32::from(cosine > 0.95);
            same_sign += u32::from(s[3] == m[3]);
        }
    }
    println!("{corners} corners, {close} close, {same_sign} of the same sign");
    assert!(f64::from(close) > 0.97 * f64::from(corners));
    assert!(f64::from(same_sign) > 0.98 * f64::from(corners));
}
