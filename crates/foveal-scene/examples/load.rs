//! Loads scenes and prints what is in them and how long each stage took: `cargo run --release
//! --example load -- FILE…`

#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use std::path::Path;

fn main() {
    for file in std::env::args().skip(1) {
        match foveal_scene::load(Path::new(&file), &foveal_scene::LoadOptions::default()) {
            Ok(scene) => {
                let t = scene.timings;
                let vertices: usize = scene.meshes.iter().map(|m| m.vertices.len()).sum();
                println!(
                    "{}: {} objects, {} instances, {} meshes, {vertices} vertices, {} triangles, {} materials, {} textures, {} lights, {} cameras",
                    scene.name,
                    scene.objects.len(),
                    scene.instances.len(),
                    scene.meshes.len(),
                    scene.triangle_count(),
                    scene.materials.len(),
                    scene.textures.len(),
                    scene.lights.len(),
                    scene.cameras.len(),
                );
                println!(
                    "  read {:.1} + parse {:.1} + geometry {:.1} + decode {:.1} + bounds {:.1} = {:.1} ms",
                    t.read_ms,
                    t.parse_ms,
                    t.geometry_ms,
                    t.decode_ms,
                    t.bounds_ms,
                    t.total_ms()
                );
                for warning in &scene.warnings {
                    println!("  warning: {warning}");
                }
            }
            Err(error) => println!("error: {error}"),
        }
    }
}
