//! Scenes on disk: `.gltf` with files beside it, and what may be reached from there.

#![allow(clippy::unwrap_used, reason = "a test may stop at once")]

use std::path::Path;

use foveal_scene::{LoadOptions, load};

/// A triangle whose buffer and picture are separate files.
fn write_scene(folder: &Path, buffer: &str, picture: &str) {
    let corners = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
    let bytes: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(folder.join("tri angle.bin"), bytes).unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([10, 20, 30]))
        .save(folder.join("wood.png"))
        .unwrap();
    let text = format!(
        r#"{{
            "asset": {{ "version": "2.0" }},
            "scene": 0,
            "scenes": [{{ "nodes": [0] }}],
            "nodes": [{{ "mesh": 0 }}],
            "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0, "TEXCOORD_0": 1 }}, "material": 0 }}] }}],
            "materials": [{{ "pbrMetallicRoughness": {{ "baseColorTexture": {{ "index": 0 }} }} }}],
            "textures": [{{ "source": 0 }}],
            "images": [{{ "uri": "{picture}" }}],
            "accessors": [
                {{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3 }},
                {{ "bufferView": 0, "componentType": 5126, "type": "VEC2", "count": 3 }}
            ],
            "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
            "buffers": [{{ "uri": "{buffer}", "byteLength": 36 }}]
        }}"#
    );
    let inner = folder.join("inner");
    std::fs::create_dir_all(&inner).unwrap();
    std::fs::write(folder.join("scene.gltf"), &text).unwrap();
    std::fs::write(inner.join("scene.gltf"), &text).unwrap();
}

#[test]
fn files_beside_the_scene_are_read_with_decoded_names() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), "tri%20angle.bin", "./wood.png");
    let scene = load(&folder.path().join("scene.gltf"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.name, "scene.gltf");
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(scene.textures[0].levels[0][..4], [10, 20, 30, 255]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert!(scene.timings.total_ms() > 0.0);
}

#[test]
fn files_of_pictures_count_as_files_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), "tri%20angle.bin", "wood.png");
    // More texels than any file may have, by half a megabyte that no packing makes smaller.
    let mut number = 1u32;
    let picture = image::GrayImage::from_fn(8192, 4096, |_, y| {
        number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        image::Luma([if y < 64 { (number >> 24) as u8 } else { 90 }])
    });
    picture.save(folder.path().join("wood.png")).unwrap();
    let scene = load(&folder.path().join("scene.gltf"), &LoadOptions::default()).unwrap();
    assert_eq!(
        (scene.textures[0].width, scene.textures[0].height),
        (8192, 4096)
    );
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn files_outside_the_scenes_folder_need_permission() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), "../tri%20angle.bin", "../wood.png");
    let path = folder.path().join("inner/scene.gltf");
    let error = load(&path, &LoadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("leads out of the scene's folder"), "{error}");
    assert!(
        error.contains("meshes[0].primitives[0].attributes.POSITION"),
        "{error}"
    );
    let options = LoadOptions {
        outside_files: true,
        ..LoadOptions::default()
    };
    assert_eq!(load(&path, &options).unwrap().triangle_count(), 1);
}

#[test]
fn a_missing_buffer_is_an_error_and_a_missing_picture_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    write_scene(folder.path(), "gone.bin", "wood.png");
    let error = load(&path, &LoadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("scene.gltf") && error.contains("\"gone.bin\" cannot be read"),
        "{error}"
    );
    write_scene(folder.path(), "tri%20angle.bin", "gone.png");
    let scene = load(&path, &LoadOptions::default()).unwrap();
    let warning = scene.warnings[0].to_string();
    assert!(
        warning.contains("images[0] (gone.png)") && warning.contains("placeholder"),
        "{warning}"
    );
}

#[test]
#[cfg(unix)]
fn devices_are_not_read() {
    let error = load(Path::new("/dev/zero"), &LoadOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "/dev/zero cannot be read: it is not a regular file"
    );
}
