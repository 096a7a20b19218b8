//! Changed files against the importer: an error or a scene, never a panic, and what loads can be
//! posed.

use super::File;
use super::compressed::{draco_file, draco_stream, meshopt_file, webp_file};
use super::hostile::rich;
use super::mutate::{self, Rng};
use crate::{Clip, LoadOptions, SceneError, load_bytes};

/// JSON and binary chunk, put into a container after both are changed: most changes to a whole file
/// only break that.
#[derive(Clone)]
struct Parts {
    json: Vec<u8>,
    bin: Vec<u8>,
    whole: bool,
}

impl Parts {
    fn of(file: &File) -> Self {
        let glb = file.glb();
        let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        Self {
            json: glb[20..20 + length].to_vec(),
            bin: glb[28 + length..].to_vec(),
            whole: false,
        }
    }

    fn mutate(&mut self, rng: &mut Rng) {
        let kind = rng.below(8);
        if kind == 0 {
            // The container itself, as one piece.
            self.json = self.glb();
            self.whole = true;
        }
        if kind < 6 {
            mutate::mutate(&mut self.json, rng);
        }
        if kind >= 4 {
            mutate::mutate(&mut self.bin, rng);
        }
    }

    fn glb(&self) -> Vec<u8> {
        if self.whole {
            return self.json.clone();
        }
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((28 + self.json.len() as u32 + self.bin.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &self.json), (b"BIN\0", &self.bin)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(chunk);
        }
        out
    }
}

#[test]
fn fuzz_import() {
    let seeds = [
        rich(),
        meshopt_file("EXT_meshopt_compression", 0),
        meshopt_file("KHR_meshopt_compression", 1),
        draco_file(&draco_stream(5)),
        draco_file(&draco_stream(10)),
        webp_file(),
    ];
    let seeds: Vec<Parts> = seeds.iter().map(Parts::of).collect();
    let options = LoadOptions {
        clip: Clip::All,
        parallel: false,
        ..LoadOptions::default()
    };
    mutate::run("import", &seeds, Parts::mutate, |parts| {
        let bytes = parts.glb();
        let no_files = |_: &str| Err("no files".to_owned());
        match load_bytes(&bytes, "fuzz.glb", &options, &no_files) {
            Ok(mut scene) => {
                for time_s in [0.37, 1e9, f32::NAN] {
                    scene.pose(time_s);
                }
                check(&scene);
            }
            Err(SceneError::Internal { cause, .. }) => panic!("{cause}"),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    });
}

/// What renderers rely on.
fn check(scene: &crate::Scene) {
    for mesh in &scene.meshes {
        let count = mesh.vertices.len();
        assert!(mesh.indices.iter().all(|&i| (i as usize) < count));
    }
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
        assert!((instance.material as usize) < scene.materials.len());
        assert!(instance.world_from_object.is_finite());
    }
    for texture in &scene.textures {
        for (k, level) in texture.levels.iter().enumerate() {
            let side = |size: u32| (size >> k).max(1) as usize;
            assert_eq!(level.len(), side(texture.width) * side(texture.height) * 4);
        }
    }
}
