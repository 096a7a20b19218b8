//! Clear coat, sheen, anisotropy, iridescence, transmission.

use glam::Vec3;
use image::{Rgba, RgbaImage};
use serde_json::json;

use super::{File, Loads, warnings};
use crate::{ColorSpace, Scene, TextureRef};

fn space(scene: &Scene, slot: Option<TextureRef>) -> ColorSpace {
    scene.textures[slot.unwrap().texture as usize].color_space
}

/// A file's scene whose material has these extensions.
fn with(mut file: File, extensions: &serde_json::Value) -> Scene {
    let used: Vec<&String> = extensions.as_object().unwrap().keys().collect();
    file.json["extensionsUsed"] = json!(used);
    file.material(json!({ "extensions": extensions }));
    file.load()
}

#[test]
fn lobes_are_read_with_their_textures() {
    let mut file = File::with_triangle();
    file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    let picture = file.texture(&RgbaImage::from_pixel(1, 1, Rgba([128, 128, 255, 255])));
    let slot = json!({ "index": picture });
    let scene = with(
        file,
        &json!({
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.75,
                "clearcoatTexture": slot,
                "clearcoatRoughnessFactor": 0.5,
                "clearcoatRoughnessTexture": slot,
                "clearcoatNormalTexture": { "index": picture, "scale": 0.25 },
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [1, 0.5, 2],
                "sheenColorTexture": slot,
                "sheenRoughnessFactor": 0.3,
                "sheenRoughnessTexture": slot,
            },
            "KHR_materials_anisotropy": {
                "anisotropyStrength": 0.6,
                "anisotropyRotation": 1.5,
                "anisotropyTexture": slot,
            },
        }),
    );
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let m = &scene.materials[0];
    let (coat, sheen) = (m.clearcoat.unwrap(), m.sheen.unwrap());
    let found = (coat.factor, coat.roughness, coat.normal_scale);
    assert_eq!(found, (0.75, 0.5, 0.25));
    assert_eq!(sheen.color, Vec3::new(1.0, 0.5, 1.0), "within 0 and 1");
    assert_eq!(sheen.roughness, 0.3);
    let anisotropy = m.anisotropy.unwrap();
    assert_eq!((anisotropy.strength, anisotropy.rotation_rad), (0.6, 1.5));
    assert_eq!(space(&scene, sheen.color_texture), ColorSpace::Srgb);
    for slot in [
        coat.texture,
        coat.normal_texture,
        sheen.roughness_texture,
        anisotropy.texture,
    ] {
        assert_eq!(space(&scene, slot), ColorSpace::Linear);
    }
    assert!(m.lobe_textures()[..6].iter().all(Option::is_some));
    // Data, normals, colour.
    assert_eq!(scene.textures.len(), 3);
    // The coat's normals need tangents.
    let vertices = &scene.meshes[0].vertices;
    assert!(vertices.iter().all(|v| v.tangent != [0.0; 4]));
}

#[test]
fn transmission_is_read_with_its_volume() {
    let mut file = File::with_triangle();
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    let picture = file.texture(&RgbaImage::from_pixel(1, 1, Rgba([255; 4])));
    let slot = json!({ "index": picture });
    let scene = with(
        file,
        &json!({
            "KHR_materials_transmission": { "transmissionFactor": 0.5, "transmissionTexture": slot },
            "KHR_materials_volume": {
                "thicknessFactor": 2,
                "thicknessTexture": slot,
                "attenuationDistance": 3,
                "attenuationColor": [1, 0.5, 0.25],
            },
        }),
    );
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let t = scene.materials[0].transmission.unwrap();
    assert_eq!(
        (t.factor, t.thickness_m, t.attenuation_distance_m),
        (0.5, 2.0, 3.0)
    );
    assert_eq!(t.attenuation_color, Vec3::new(1.0, 0.5, 0.25));
    assert!(t.texture.is_some() && t.thickness_texture.is_some());
    let volume = json!({ "KHR_materials_volume": { "thicknessFactor": 2 } });
    let alone = with(File::with_triangle(), &volume);
    assert!(alone.materials[0].transmission.is_none());
}

#[test]
fn iridescence_is_read_within_what_there_is() {
    let mut file = File::with_triangle();
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    let picture = file.texture(&RgbaImage::from_pixel(1, 1, Rgba([255; 4])));
    let slot = json!({ "index": picture });
    let scene = with(
        file,
        &json!({ "KHR_materials_iridescence": {
            "iridescenceFactor": 0.5,
            "iridescenceTexture": slot,
            "iridescenceIor": 1.8,
            "iridescenceThicknessMinimum": 700,
            "iridescenceThicknessMaximum": 200,
            "iridescenceThicknessTexture": slot,
        } }),
    );
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let film = scene.materials[0].iridescence.unwrap();
    assert_eq!((film.factor, film.ior), (0.5, 1.8));
    // The extension allows the lesser one to be the maximum.
    let thickness = (film.thickness_min_nm, film.thickness_max_nm);
    assert_eq!(thickness, (700.0, 200.0));
    assert_eq!(space(&scene, film.texture), ColorSpace::Linear);
    assert_eq!(space(&scene, film.thickness_texture), ColorSpace::Linear);
    let read = |iridescence| {
        let extensions = json!({ "KHR_materials_iridescence": iridescence });
        let film = with(File::with_triangle(), &extensions).materials[0].iridescence;
        film.map(|f| (f.factor, f.ior, f.thickness_min_nm, f.thickness_max_nm))
    };
    let plain = read(json!({ "iridescenceFactor": 1 }));
    assert_eq!(plain, Some((1.0, 1.3, 100.0, 400.0)));
    let wrong = json!({
        "iridescenceFactor": 7,
        "iridescenceIor": 0.5,
        "iridescenceThicknessMinimum": -5,
        "iridescenceThicknessMaximum": -1,
    });
    assert_eq!(read(wrong), Some((1.0, 1.0, 0.0, 0.0)));
    assert_eq!(read(json!({ "iridescenceIor": 2 })), None);
}

#[test]
fn an_iridescence_that_is_no_number_is_named_with_its_place() {
    let mut file = File::with_triangle();
    file.material(json!({ "extensions": {
        "KHR_materials_iridescence": { "iridescenceThicknessMaximum": "thin" },
    } }));
    let text = file.refusal();
    let place = "extensions.KHR_materials_iridescence.iridescenceThicknessMaximum";
    assert!(text.contains(place), "{text}");
}

#[test]
fn lobes_that_show_nothing_are_left_out() {
    let scene = with(
        File::with_triangle(),
        &json!({
            "KHR_materials_clearcoat": { "clearcoatRoughnessFactor": 0.5 },
            "KHR_materials_sheen": { "sheenRoughnessFactor": 0.5 },
            "KHR_materials_anisotropy": { "anisotropyRotation": 0.5 },
        }),
    );
    assert!(!scene.materials[0].has_lobes());
    let unlit = with(
        File::with_triangle(),
        &json!({ "KHR_materials_unlit": {}, "KHR_materials_clearcoat": { "clearcoatFactor": 1 } }),
    );
    assert!(!unlit.materials[0].has_lobes());
}

#[test]
fn anisotropy_without_textures_gets_tangents_along_the_first_coordinates() {
    let mut file = File::with_triangle();
    file.attribute("NORMAL", &[0., 0., 1.].repeat(3), "VEC3");
    file.attribute("TEXCOORD_0", &[0., 1., 1., 1., 0., 0.], "VEC2");
    let strength = json!({ "KHR_materials_anisotropy": { "anisotropyStrength": 1 } });
    let scene = with(file, &strength);
    for vertex in &scene.meshes[0].vertices {
        let [x, y, z, _] = vertex.tangent;
        let length = Vec3::new(x, y, z).length();
        assert!((length - 1.0).abs() < 1e-5, "{:?}", vertex.tangent);
        assert!(vertex.uv[0] != [0.0, 0.0] || vertex.position[1] > 0.0);
    }
}

#[test]
fn textures_beyond_what_is_read_are_named() {
    let mut file = File::with_triangle();
    let mut slot = |shade: u8| {
        let texel = Rgba([shade, 0, 0, 255]);
        json!({ "index": file.texture(&RgbaImage::from_pixel(1, 1, texel)) })
    };
    let slots: Vec<_> = (0..6).map(&mut slot).collect();
    let scene = with(
        file,
        &json!({
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 1,
                "clearcoatTexture": slots[0],
                "clearcoatRoughnessTexture": slots[1],
                "clearcoatNormalTexture": slots[2],
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [1, 1, 1],
                "sheenColorTexture": slots[3],
                "sheenRoughnessTexture": slots[4],
            },
            "KHR_materials_anisotropy": { "anisotropyStrength": 1, "anisotropyTexture": slots[5] },
        }),
    );
    let text = warnings(&scene);
    assert!(
        text.contains("read 6 textures; the first 5 are read"),
        "{text}"
    );
}

#[test]
fn a_wrong_lobe_is_named_with_its_place() {
    let mut file = File::with_triangle();
    file.material(json!({ "extensions": {
        "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 7 } },
    } }));
    let text = file.refusal();
    assert!(
        text.contains("extensions.KHR_materials_clearcoat.clearcoatTexture"),
        "{text}"
    );
}
