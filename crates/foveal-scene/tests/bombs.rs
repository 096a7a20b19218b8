//! Small files that ask for much: each ends with a clear error, or with a scene where that is
//! cheap, and the process never holds more than 300 MB.
//!
//! The files are made here; those beside the repository (`../shared/data/bombs`) are tried too
//! where they are there.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop at once, and its figures are for reading"
)]

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use foveal_scene::{Code, Limit, LoadOptions, Scene, SceneError, Warning, load_bytes};
use foveal_seeds::crc32;
use serde_json::{Value, json};

/// A GLB in the making, with one triangle in its first accessor.
struct Bomb {
    json: Value,
    bin: Vec<u8>,
}

impl Bomb {
    fn new() -> Self {
        let corners = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
        Self {
            json: json!({
                "asset": { "version": "2.0" },
                "scene": 0,
                "scenes": [{ "nodes": [0] }],
                "nodes": [{ "mesh": 0 }],
                "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
                "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
                "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
            }),
            bin: corners.iter().flat_map(|v| v.to_le_bytes()).collect(),
        }
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend(bytes);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        views.len() - 1
    }

    /// Gives the triangle a picture for each of these views, each in a material of its own.
    fn pictures(mut self, views: &[usize]) -> Self {
        let each = |f: &dyn Fn(usize) -> Value| -> Value { (0..views.len()).map(f).collect() };
        self.json["images"] = each(&|i| json!({ "bufferView": views[i] }));
        self.json["textures"] = each(&|i| json!({ "source": i }));
        self.json["materials"] =
            each(&|i| json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": i } } }));
        self.json["meshes"][0]["primitives"] =
            each(&|i| json!({ "attributes": { "POSITION": 0 }, "material": i }));
        self
    }

    fn glb(mut self) -> Vec<u8> {
        self.json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((28 + text.len() as u32 + self.bin.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", text), (b"BIN\0", self.bin)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(chunk);
        }
        out
    }

    fn load(self) -> Result<Scene, SceneError> {
        let bytes = self.glb();
        load_bytes(&bytes, "bomb.glb", &LoadOptions::default(), &|_| {
            Err("no files".to_owned())
        })
    }

    /// The message of a file that must be refused because of this limit.
    fn refused(self, limit: Option<Limit>) -> String {
        let error = self.load().expect_err("too much");
        assert_eq!(error.limit(), limit, "{error}");
        println!("{error}");
        error.to_string()
    }
}

/// The start of a one-bit grey PNG, and as many bytes as could stand for all its texels.
fn huge_png(side: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend(side.to_be_bytes());
    header.extend(side.to_be_bytes());
    header.extend([1, 0, 0, 0, 0]);
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    png.extend(&header);
    png.extend(crc32(&header).to_be_bytes());
    let data = vec![0; (u64::from(side) * u64::from(side) / 8000) as usize];
    png.extend((data.len() as u32).to_be_bytes());
    png.extend(b"IDAT");
    png.extend(data);
    png
}

/// A whole PNG of one grey.
fn flat_png(side: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(side, side)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// The most memory that this process ever held, in bytes; `None` where the system does not say.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib << 10)
}

fn assert_small(after: &str) {
    if let Some(peak) = peak_bytes() {
        assert!(peak < 300_000_000, "{peak} bytes after {after}");
    }
}

/// One test after the other, because the peak is the process's.
static ALONE: Mutex<()> = Mutex::new(());

#[test]
fn small_files_that_ask_for_much_are_refused_before_anything_is_allocated() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for side in [65_536, 32_768, 16_384, 8_192] {
        let mut bomb = Bomb::new();
        let view = bomb.view(&huge_png(side));
        let over = u64::from(side) * u64::from(side) * 8 > LoadOptions::default().max_texture_bytes;
        let limit = if over {
            Limit::TextureBytes
        } else {
            Limit::Expansion
        };
        let text = bomb.pictures(&[view]).refused(Some(limit));
        assert!(text.contains("images") && text.contains("wants"), "{text}");
        assert_small("a huge picture");
    }

    let mut bomb = Bomb::new();
    let png = flat_png(2048);
    let views: Vec<usize> = (0..100).map(|_| bomb.view(&png)).collect();
    let text = bomb.pictures(&views).refused(Some(Limit::Expansion));
    assert!(text.contains("for textures"), "{text}");
    assert_small("a hundred flat pictures");

    // The same bytes under a hundred names are one picture, which is cheap.
    let mut bomb = Bomb::new();
    let first = bomb.view(&png);
    let view = bomb.json["bufferViews"][first].clone();
    let views: Vec<usize> = (0..100)
        .map(|_| {
            let views = bomb.json["bufferViews"].as_array_mut().unwrap();
            views.push(view.clone());
            views.len() - 1
        })
        .collect();
    let scene = bomb.pictures(&views).load().unwrap();
    assert_eq!(scene.textures.len(), 1);
    drop(scene);
    assert_small("one picture under a hundred names");

    // Accessors that overlap, each a vertex further.
    let mut bomb = Bomb::new();
    let view = bomb.view(&vec![0; 1_080_000]);
    let accessors = (0..700).map(|i| {
        json!({ "bufferView": view, "componentType": 5126, "count": 89_000, "type": "VEC3", "byteOffset": i * 12 })
    });
    let primitives = (0..700).map(|i| json!({ "attributes": { "POSITION": i } }));
    bomb.json["accessors"] = accessors.collect();
    bomb.json["meshes"][0]["primitives"] = primitives.collect();
    bomb.refused(Some(Limit::Expansion));
    assert_small("overlapping accessors");

    // The same ones, each the same bytes: built once.
    let mut bomb = Bomb::new();
    let view = bomb.view(&vec![0; 1_080_000]);
    let accessor =
        json!({ "bufferView": view, "componentType": 5126, "count": 90_000, "type": "VEC3" });
    bomb.json["accessors"] = json!(vec![accessor; 700]);
    let primitives = (0..700).map(|i| json!({ "attributes": { "POSITION": i } }));
    bomb.json["meshes"][0]["primitives"] = primitives.collect();
    let scene = bomb.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 700));
    drop(scene);
    assert_small("equal accessors");

    // Instances that nothing stores, and primitives times nodes.
    let mut bomb = Bomb::new();
    let zeros = json!({ "componentType": 5126, "count": 20_000, "type": "VEC3" });
    bomb.json["accessors"].as_array_mut().unwrap().push(zeros);
    let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
    bomb.json["nodes"] = json!(vec![json!({ "mesh": 0, "extensions": extension }); 100]);
    bomb.json["scenes"][0]["nodes"] = (0..100).collect();
    bomb.refused(Some(Limit::Expansion));
    let mut bomb = Bomb::new();
    let primitive = bomb.json["meshes"][0]["primitives"][0].clone();
    bomb.json["meshes"][0]["primitives"] = json!(vec![primitive; 1500]);
    bomb.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 1500]);
    bomb.json["scenes"][0]["nodes"] = (0..1500).collect();
    bomb.refused(Some(Limit::Expansion));
    assert_small("instances");

    // Morph targets times nodes.
    let mut bomb = Bomb::new();
    bomb.json["meshes"][0]["primitives"][0]["targets"] =
        json!(vec![json!({ "POSITION": 0 }); 10_000]);
    bomb.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 10_000]);
    bomb.json["scenes"][0]["nodes"] = (0..10_000).collect();
    bomb.refused(Some(Limit::Expansion));
    assert_small("morph targets");

    // Weights that no morph target has, times nodes.
    let mut bomb = Bomb::new();
    bomb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
    bomb.json["meshes"][0]["weights"] = json!(vec![0; 100_000]);
    bomb.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 1000]);
    bomb.json["scenes"][0]["nodes"] = (0..1000).collect();
    let scene = bomb.load().unwrap();
    let text = "nodes[0]: has 100000 weights for 1 morph targets";
    assert!(scene.warnings.iter().any(|w| w.text == text));
    drop(scene);
    assert_small("weights without targets");

    // Long names times instances.
    let mut bomb = Bomb::new();
    let zeros = json!({ "componentType": 5126, "count": 60_000, "type": "VEC3" });
    bomb.json["accessors"].as_array_mut().unwrap().push(zeros);
    bomb.json["nodes"] = json!([{ "mesh": 0, "name": "n".repeat(100_000), "extensions": {
        "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } }
    } }]);
    let scene = bomb.load().unwrap();
    assert!(scene.objects[7].name.len() == 1024);
    drop(scene);
    assert_small("long names");

    // Skins that read the same matrices.
    let mut bomb = Bomb::new();
    let view = bomb.view(&vec![0; 640_000]);
    let matrices =
        json!({ "bufferView": view, "componentType": 5126, "count": 10_000, "type": "MAT4" });
    bomb.json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(matrices);
    bomb.json["skins"] = json!(vec![
        json!({ "joints": [0], "inverseBindMatrices": 1 });
        1000
    ]);
    let node = |skin: usize| json!({ "mesh": 0, "skin": skin });
    bomb.json["nodes"] = (0..1000).map(node).collect();
    bomb.json["scenes"][0]["nodes"] = (0..1000).collect();
    bomb.refused(Some(Limit::Expansion));
    assert_small("skins");

    // A compressed view of nothing but zeros.
    let mut bomb = Bomb::new();
    let view = bomb.view(&[0xA1; 64]);
    let coded = json!({ "buffer": 0, "byteOffset": 36, "byteLength": 64, "byteStride": 256,
        "count": 1_000_000_000, "mode": "ATTRIBUTES" });
    bomb.json["bufferViews"][view]["extensions"] = json!({ "KHR_meshopt_compression": coded });
    let text = bomb.refused(Some(Limit::Expansion));
    assert!(
        text.contains("wants 256 GB for decompressed data"),
        "{text}"
    );

    // Vertices that nothing stores.
    let mut bomb = Bomb::new();
    bomb.json["accessors"][0] =
        json!({ "componentType": 5126, "count": 16_000_000, "type": "VEC3" });
    bomb.refused(Some(Limit::Expansion));
    assert_small("vertices without values");

    // Morph targets that nothing stores, of three vertices that are drawn.
    for sparse in [false, true] {
        let mut bomb = Bomb::new();
        let at = bomb.view(&[0; 4]);
        let value = bomb.view(&[0; 12]);
        let mut zeros = json!({ "componentType": 5126, "count": 20_000_000, "type": "VEC3" });
        if sparse {
            zeros["sparse"] = json!({
                "count": 1,
                "indices": { "bufferView": at, "componentType": 5123 },
                "values": { "bufferView": value },
            });
        }
        bomb.json["accessors"].as_array_mut().unwrap().push(zeros);
        let targets = json!([{ "POSITION": 1 }]);
        bomb.json["meshes"][0]["primitives"][0]["targets"] = targets;
        let text = bomb.refused(Some(Limit::Expansion));
        assert!(text.contains("elements without stored values"), "{text}");
        assert_small("morph targets without values");
    }

    // One vertex, named so often that its points take gigabytes where they are drawn; then lines, a
    // strip of which names each vertex twice.
    for mode in 0..4 {
        let mut bomb = Bomb::new();
        let zeros = json!({ "componentType": 5125, "count": 15_000_000, "type": "SCALAR" });
        bomb.json["accessors"].as_array_mut().unwrap().push(zeros);
        let primitive = &mut bomb.json["meshes"][0]["primitives"][0];
        primitive["indices"] = json!(1);
        primitive["mode"] = json!(mode);
        let text = bomb.refused(Some(Limit::Expansion));
        assert!(text.contains("for vertices and indices"), "{text}");
        assert_small("points and lines of one vertex");
    }
}

#[test]
fn long_names_are_cut_before_they_are_copied() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let long = "A".repeat(100_000);

    // Each node that has the camera shows its name.
    let mut bomb = Bomb::new();
    let lens = json!({ "yfov": 1, "znear": 0.1 });
    bomb.json["cameras"] = json!([{ "name": long, "type": "perspective", "perspective": lens }]);
    let mut nodes = vec![json!({ "camera": 0 }); 20_000];
    nodes.push(json!({ "mesh": 0 }));
    bomb.json["scenes"] = json!([{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }]);
    bomb.json["nodes"] = json!(nodes);
    assert_eq!(bomb.load().unwrap().cameras.len(), 20_000);
    assert_small("nodes with one camera");

    // Each threshold of transparency makes a texture of its own, which has the picture's name.
    let mut bomb = Bomb::new();
    bomb.json["images"] = json!([{ "uri": long }]);
    bomb.json["textures"] = json!([{ "source": 0 }]);
    let material = |i: u32| {
        json!({
            "alphaMode": "MASK", "alphaCutoff": f64::from(i) / 20_000.0,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        })
    };
    bomb.json["materials"] = (0..20_000).map(material).collect();
    assert_eq!(bomb.load().unwrap().textures.len(), 20_000);
    assert_small("textures of one picture");
}

#[test]
fn materials_count_although_they_take_three_bytes_in_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut bomb = Bomb::new();
    bomb.json["materials"] = json!(vec![json!({}); 300_000]);
    let text = bomb.refused(Some(Limit::Expansion));
    assert!(text.contains("for materials"), "{text}");
    assert_small("empty materials");
}

#[test]
fn libraries_of_materials_are_held_one_at_a_time() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let names: Vec<String> = (0..64).map(|i| format!("{i}.mtl")).collect();
    let text = format!("mtllib {}\nv 0 0 0\nf 1 1 1\n", names.join(" "));
    let resolver = |name: &str| match name.len() {
        0..=6 => Ok(vec![b' '; 8 << 20]),
        _ => Err("no such file".to_owned()),
    };
    let scene = load_bytes(text.as_bytes(), "a.obj", &LoadOptions::default(), &resolver).unwrap();
    assert_eq!(scene.warnings, []);
    assert_small("64 libraries");
}

#[test]
fn a_large_plain_picture_is_cheap_enough_to_be_shown() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut bomb = Bomb::new();
    let view = bomb.view(&flat_png(4096));
    let scene = bomb.pictures(&[view]).load().unwrap();
    assert_eq!(scene.textures[0].width, 4096);
    assert_small("a plain picture");
}

#[test]
fn more_may_be_allowed() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut bomb = Bomb::new();
    let png = flat_png(1024);
    let views: Vec<usize> = (0..60).map(|_| bomb.view(&png)).collect();
    let bytes = bomb.pictures(&views).glb();
    let with = |options: &LoadOptions| {
        load_bytes(&bytes, "bomb.glb", options, &|_| Err("no files".to_owned()))
    };
    let tight = LoadOptions {
        max_expansion: 0,
        ..LoadOptions::default()
    };
    assert!(with(&tight).is_err_and(|e| e.limit() == Some(Limit::Expansion)));
    // Beyond the textures' own limit pictures become smaller.
    let small = LoadOptions {
        max_texture_bytes: 64 << 20,
        ..LoadOptions::default()
    };
    let scene = with(&small).unwrap();
    assert!(scene.textures.iter().all(|t| t.width == 256));
    let reduced = |w: &&Warning| w.code == Code::TexturesReduced;
    let warning = scene.warnings.iter().find(reduced).unwrap().to_string();
    assert!(
        warning.contains("the limit is 67.1 MB") && warning.contains("256 texels"),
        "{warning}"
    );
}

#[test]
fn the_bombs_beside_the_repository_end_small() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bombs");
    let Ok(files) = std::fs::read_dir(&folder) else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    for file in files {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|e| e == "glb") {
            match foveal_scene::load(&path, &LoadOptions::default()) {
                Ok(scene) => println!("{}: {} objects", path.display(), scene.objects.len()),
                Err(error) => println!("{error}"),
            }
            assert_small(&path.display().to_string());
        }
    }
}
