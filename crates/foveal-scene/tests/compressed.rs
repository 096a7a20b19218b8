//! The samples beside the repository, compressed by `gltf-transform`, against their originals: the
//! same geometry and pictures but for what the compression loses.
//!
//! Without `../shared/data/compressed` the test says so and passes.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop at once, and its figures are for reading"
)]

use std::path::Path;

use foveal_scene::{LoadOptions, Scene, load};

/// Area of all surfaces in world space.
fn area(scene: &Scene) -> f64 {
    let triangles = scene.instances.iter().flat_map(|instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        mesh.indices.chunks_exact(3).map(move |t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| {
                let position = mesh.vertices[i as usize].position.into();
                instance.world_from_object.transform_point3(position)
            });
            f64::from((b - a).cross(c - a).length()) * 0.5
        })
    });
    triangles.sum()
}

/// Mean difference of two pictures per channel, of 255. What is transparent has no colour: lossy
/// WebP drops it.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    let texels = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
    let sum: u64 = texels
        .map(|(a, b)| {
            let color: u64 = (0..3).map(|k| u64::from(a[k].abs_diff(b[k]))).sum();
            color * u64::from(a[3]) / 255 + u64::from(a[3].abs_diff(b[3]))
        })
        .sum();
    sum as f64 / a.len() as f64
}

#[test]
fn compressed_samples_are_their_originals() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let Ok(files) = std::fs::read_dir(data.join("compressed")) else {
        println!("skipped: {} is not there", data.display());
        return;
    };
    let mut names: Vec<String> = files
        .filter_map(|file| file.unwrap().file_name().into_string().ok())
        .filter(|name| name.ends_with(".glb"))
        .collect();
    names.sort();
    for name in &names {
        let scene = load(&data.join("compressed").join(name), &LoadOptions::default()).unwrap();
        let (stem, _) = name.split_once('.').unwrap();
        let original = data.join("samples").join(format!("{stem}.glb"));
        let original = load(&original, &LoadOptions::default()).unwrap();
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
        assert_eq!(scene.objects.len(), original.objects.len(), "{name}");
        assert_eq!(scene.textures.len(), original.textures.len(), "{name}");
        assert_eq!(
            scene.animation_duration_s(),
            original.animation_duration_s(),
            "{name}"
        );
        let (bounds, expected) = (scene.bounds(), original.bounds());
        let size = expected.size().length();
        let moved = (bounds.min - expected.min)
            .abs()
            .max((bounds.max - expected.max).abs());
        assert!(
            moved.max_element() < 0.002 * size,
            "{name}: {bounds:?} instead of {expected:?}"
        );
        let ratio = area(&scene) / area(&original);
        assert!((ratio - 1.0).abs() < 0.005, "{name}: {ratio} of the area");
        let (triangles, before) = (scene.triangle_count(), original.triangle_count());
        // Triangles that quantization makes empty may be gone.
        assert!(
            triangles <= before && triangles * 100 >= before * 95,
            "{name}: {triangles} triangles instead of {before}"
        );
        let mut largest = 0f64;
        for texture in &scene.textures {
            let twin = original.textures.iter().filter(|t| {
                (t.width, t.height, t.color_space)
                    == (texture.width, texture.height, texture.color_space)
            });
            let nearest = twin
                .map(|t| difference(&t.levels[0], &texture.levels[0]))
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest < 6.0,
                "{name}: '{}' differs by {nearest}",
                texture.name
            );
            largest = largest.max(nearest);
        }
        println!("{name}: area {ratio:.5}, pictures within {largest:.2}");
    }
    println!("{} files", names.len());
}
