//! Materials of specular-glossiness.

use glam::{Vec3, Vec4};
use image::{Rgba, RgbaImage};
use serde_json::json;

use super::{File, Loads, warnings};
use crate::ColorSpace;

const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

#[test]
fn specular_glossiness_is_a_dielectric_that_reflects_its_specular_colour() {
    let mut file = File::with_triangle();
    file.json["extensionsUsed"] = json!([NAME]);
    let gold = json!({ "diffuseFactor": [0.5, 0.25, 0, 1], "specularFactor": [1, 0.75, 0.25],
        "glossinessFactor": 0.75 });
    file.material(json!({ "extensions": { NAME: gold } }));
    let scene = file.load();
    let m = &scene.materials[0];
    assert_eq!(m.base_color, Vec4::new(0.5, 0.25, 0., 1.));
    assert_eq!((m.metallic, m.roughness), (0., 0.25));
    assert_eq!((m.ior_reflectance(), m.specular), (1., 1.));
    assert_eq!(m.specular_color, Vec3::new(1., 0.75, 0.25));
    assert_eq!(warnings(&scene), "");
    // It counts more than metallic-roughness, but is not what an unlit surface shows.
    file.json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorFactor": [0, 0, 1, 1] });
    assert_eq!(file.load().materials[0], *m);
    file.json["materials"][0]["extensions"]["KHR_materials_unlit"] = json!({});
    let unlit = &file.load().materials[0];
    assert_eq!(unlit.base_color, Vec4::new(0., 0., 1., 1.));
}

#[test]
fn glossiness_in_a_texture_s_alpha_becomes_roughness() {
    let mut file = File::with_triangle();
    let picture = RgbaImage::from_pixel(4, 4, Rgba([200, 100, 50, 102]));
    let texture = file.texture(&picture);
    file.material(json!({ "extensions": { NAME: {
        "glossinessFactor": 0.5, "specularGlossinessTexture": { "index": texture } } } }));
    let scene = file.load();
    let m = &scene.materials[0];
    assert_eq!((m.metallic, m.roughness), (0., 1.));
    let of = |slot: Option<crate::TextureRef>| &scene.textures[slot.unwrap().texture as usize];
    let rough = of(m.metallic_roughness_texture);
    assert_eq!(rough.color_space, ColorSpace::Linear);
    assert_eq!(rough.levels.len(), 3);
    let levels = rough.levels.iter().flatten();
    assert!(levels.skip(1).step_by(4).all(|&green| green == 204));
    let color = of(m.specular_color_texture);
    assert_eq!(color.color_space, ColorSpace::Srgb);
    assert_eq!(color.levels[0][..3], [200, 100, 50]);
}
