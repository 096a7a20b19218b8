//! glTF import, with pictures and compressed geometry: an error or a scene, never a panic, and what
//! loads can be posed and keeps what renderers rely on.
//!
//! An input is a byte of options, the JSON, a zero byte, and the binary chunk: lengths of the
//! container follow from that, so that changes reach what is inside. With the first bit of the
//! options the rest is a whole file instead.

use foveal_scene::{
    Clip, LoadOptions, MissingNormals, Scene, SceneError, TextureCompression, load_bytes,
};
use foveal_seeds::{
    ETC1S, File, UASTC, UASTC_ZSTD, draco_file, draco_stream, extended, grid_file, ktx2_file,
    meshopt_file, pointers, rich, strokes, surrounded, webp_file,
};

const WHOLE_FILE: u8 = 1;
const VARIANT: u8 = 2;
const SMOOTH: u8 = 4;
const SMALL_TEXTURES: u8 = 8;
const IN_BLOCKS: u8 = 16;

/// Loads the file that an input stands for.
pub fn import(input: &[u8]) {
    let Some((&flags, rest)) = input.split_first() else {
        return;
    };
    let whole = flags & WHOLE_FILE != 0;
    let bytes = if whole {
        rest.to_vec()
    } else {
        container(rest)
    };
    let options = LoadOptions {
        clip: Clip::All,
        parallel: false,
        variant: (flags & VARIANT != 0).then(|| "0".to_owned()),
        missing_normals: if flags & SMOOTH == 0 {
            MissingNormals::Flat
        } else {
            MissingNormals::Smooth
        },
        texture_compression: if flags & IN_BLOCKS == 0 {
            TextureCompression::Off
        } else {
            TextureCompression::Small
        },
        max_texture_size: if flags & SMALL_TEXTURES == 0 { 8192 } else { 4 },
        ..LoadOptions::default()
    };
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
}

fn container(parts: &[u8]) -> Vec<u8> {
    let end = parts.iter().position(|b| *b == 0).unwrap_or(parts.len());
    let json = &parts[..end];
    let bin = parts.get(end + 1..).unwrap_or_default();
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

/// What renderers rely on.
fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        let count = mesh.vertices.len();
        let lines = mesh.lines.as_flattened();
        let used = mesh.indices.iter().chain(lines).chain(&mesh.points);
        assert!(used.copied().all(|i| (i as usize) < count));
    }
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
        assert!((instance.material as usize) < scene.materials.len());
        assert!(instance.world_from_object.is_finite());
    }
    for texture in &scene.textures {
        for (k, level) in texture.levels.iter().enumerate() {
            let (width, height) = texture.level_size(k);
            let bytes = texture.encoding.level_bytes(width, height);
            assert_eq!(level.len() as u64, bytes);
        }
    }
}

/// The parts of a good file.
fn parts(file: &File) -> Vec<u8> {
    let glb = file.glb();
    let length = glb[12..]
        .first_chunk()
        .map_or(0, |b| u32::from_le_bytes(*b) as usize);
    let mut parts = vec![0];
    parts.extend(&glb[20..20 + length]);
    parts.push(0);
    parts.extend(&glb[28 + length..]);
    parts
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    let files = [
        rich(),
        extended(),
        surrounded(4, &|[x, y, z]| [2.0 + x, 2.0 + y, 2.0 + z]),
        strokes(),
        pointers::pointers(),
        grid_file(),
        meshopt_file("EXT_meshopt_compression", 0),
        meshopt_file("KHR_meshopt_compression", 1),
        draco_file(&draco_stream(5)),
        draco_file(&draco_stream(10)),
        webp_file(),
        ktx2_file(ETC1S),
        ktx2_file(UASTC),
        ktx2_file(UASTC_ZSTD),
    ];
    let mut seeds: Vec<Vec<u8>> = files.iter().map(parts).collect();
    let mut whole = vec![WHOLE_FILE];
    whole.extend(files[1].glb());
    seeds.push(whole);
    seeds[1][0] = VARIANT | SMOOTH | SMALL_TEXTURES;
    // The KTX2 files come last before the whole one.
    for at in [0, 8, 9, 10, 11] {
        seeds[at][0] |= IN_BLOCKS;
    }
    seeds
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A seed that is refused would leave most of the importer untouched.
    #[test]
    fn the_seeds_are_good_files() {
        for (i, seed) in seeds().iter().enumerate() {
            let whole = seed[0] & WHOLE_FILE != 0;
            let bytes = if whole {
                seed[1..].to_vec()
            } else {
                container(&seed[1..])
            };
            let options = LoadOptions::default();
            let scene = load_bytes(&bytes, "seed", &options, &|_| Err(String::new()));
            let scene = scene.unwrap_or_else(|e| panic!("seed {i}: {e}"));
            let strokes = scene.line_count() + scene.point_count();
            assert!(scene.triangle_count() + strokes > 0, "seed {i}");
            for warning in &scene.warnings {
                assert!(
                    warning.text.contains("SpecularGlossiness"),
                    "seed {i}: {warning}"
                );
            }
        }
    }
}
