//! Materials, textures, samplers, UV sets.

use glam::{Vec2, Vec3, Vec4};
use image::{Rgba, RgbaImage};
use serde_json::json;

use super::{File, Loads, warnings};
use crate::{AlphaMode, ColorSpace, Filter, LoadOptions, Wrap};

fn checker() -> RgbaImage {
    RgbaImage::from_fn(4, 4, |x, y| {
        let on = (x + y) % 2 == 0;
        Rgba(if on { [255; 4] } else { [0, 0, 0, 255] })
    })
}

#[test]
fn emission_is_never_negative_or_infinite() {
    let mut file = File::with_triangle();
    file.material(json!({
        "emissiveFactor": [100, 1, -1],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 1e38 } },
    }));
    let emissive = file.load().materials[0].emissive;
    assert_eq!(emissive, Vec3::new(f32::MAX, 1e38, 0.0));
}

#[test]
fn factors_and_modes_are_read() {
    let mut file = File::with_triangle();
    file.material(json!({
        "name": "shiny",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.25 },
        "emissiveFactor": [1, 0.5, 0],
        "alphaMode": "MASK",
        "doubleSided": true,
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4 }, "KHR_materials_unlit": {} },
    }));
    let scene = file.load();
    let m = &scene.materials[0];
    assert_eq!(m.name, "shiny");
    assert_eq!(m.base_color, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!((m.metallic, m.roughness), (0.5, 0.25));
    assert_eq!(m.emissive, Vec3::new(4., 2., 0.));
    assert_eq!(m.alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
    assert!(m.double_sided && m.unlit);
    assert!(scene.warnings.is_empty());
}

#[test]
fn a_primitive_without_material_gets_the_default_one() {
    let scene = File::with_triangle().load();
    assert_eq!(scene.materials, [crate::Material::default()]);
    assert_eq!(scene.instances[0].material, 0);
}

#[test]
fn texture_transforms_turn_counter_clockwise_as_seen() {
    let mut file = File::with_triangle();
    let texture = file.texture(&checker());
    file.material(json!({ "pbrMetallicRoughness": { "baseColorTexture": {
        "index": texture,
        "extensions": { "KHR_texture_transform": {
            "offset": [0.5, 0.25], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 1,
        } },
    } } }));
    file.attribute("TEXCOORD_1", &[0.25; 6], "VEC2");
    let scene = file.load();
    let slot = scene.materials[0].base_color_texture.unwrap();
    let at = |u, v| slot.uv_transform.transform_point2(Vec2::new(u, v));
    assert!(at(0., 0.).abs_diff_eq(Vec2::new(0.5, 0.25), 1e-6));
    assert!(at(1., 0.).abs_diff_eq(Vec2::new(0.5, 0.25 - 2.), 1e-6));
    assert!(at(0., 1.).abs_diff_eq(Vec2::new(0.5 + 3., 0.25), 1e-6));
    // The overriding set is the only one in use, so it sits in the first slot.
    assert_eq!(slot.uv_set, 0);
    assert_eq!(scene.meshes[0].vertices[0].uv, [[0.25; 2], [0.; 2]]);
}

#[test]
fn uv_sets_in_use_are_mapped_to_the_two_slots() {
    let mut file = File::with_triangle();
    let texture = file.texture(&checker());
    let on = |set| json!({ "index": texture, "texCoord": set });
    file.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": on(3), "metallicRoughnessTexture": on(1) },
        "occlusionTexture": on(7),
    }));
    for set in [0, 1, 3, 7] {
        file.attribute(&format!("TEXCOORD_{set}"), &[set as f32; 6], "VEC2");
    }
    let scene = file.load();
    let m = &scene.materials[0];
    assert_eq!(scene.meshes[0].vertices[0].uv, [[1.; 2], [3.; 2]]);
    assert_eq!(m.base_color_texture.unwrap().uv_set, 1);
    assert_eq!(m.metallic_roughness_texture.unwrap().uv_set, 0);
    assert_eq!(m.occlusion_texture.unwrap().uv_set, 0);
    assert!(warnings(&scene).contains("materials[0]: reads more than two sets"));
}

#[test]
fn equal_uses_share_a_texture_and_different_meanings_do_not() {
    let mut file = File::with_triangle();
    let texture = file.texture(&checker());
    // The same picture under another number.
    let twin = file.json["images"][0].clone();
    let image = file.push("images", twin);
    let second = file.push("textures", json!({ "source": image }));
    file.material(json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": texture },
            "metallicRoughnessTexture": { "index": texture },
        },
        "occlusionTexture": { "index": second },
        "emissiveTexture": { "index": second },
    }));
    let scene = file.load();
    let m = &scene.materials[0];
    let number = |slot: Option<crate::TextureRef>| slot.unwrap().texture;
    assert_eq!(scene.textures.len(), 2);
    assert_eq!(number(m.base_color_texture), number(m.emissive_texture));
    assert_eq!(
        number(m.metallic_roughness_texture),
        number(m.occlusion_texture)
    );
    let spaces: Vec<_> = scene.textures.iter().map(|t| t.color_space).collect();
    assert_eq!(spaces, [ColorSpace::Srgb, ColorSpace::Linear]);
    // Half of the light is sRGB 188; half of the number is 128.
    assert_eq!(scene.textures[0].levels[1][..4], [188, 188, 188, 255]);
    assert_eq!(scene.textures[1].levels[1][..4], [128, 128, 128, 255]);
}

#[test]
fn views_that_only_begin_at_the_same_byte_are_different_pictures() {
    let mut file = File::with_triangle();
    let texture = file.texture(&checker());
    let whole = file.json["images"][texture]["bufferView"].as_u64().unwrap();
    let mut beginning = file.json["bufferViews"][whole as usize].clone();
    beginning["byteLength"] = json!(20);
    let beginning = file.push("bufferViews", beginning);
    file.json["images"][texture]["bufferView"] = json!(beginning);
    let image = file.push("images", json!({ "bufferView": whole }));
    let second = file.push("textures", json!({ "source": image }));
    file.material(json!({
        "occlusionTexture": { "index": texture },
        "emissiveTexture": { "index": second },
    }));
    let scene = file.load();
    let emissive = scene.materials[0].emissive_texture.unwrap();
    assert_eq!(scene.textures[emissive.texture as usize].width, 4);
    let text = warnings(&scene);
    assert!(
        text.contains("images[0]") && !text.contains("images[1]"),
        "{text}"
    );
}

#[test]
fn samplers_say_whether_there_are_mip_levels() {
    for (min, mip, levels) in [
        (None, Some(Filter::Linear), 3),
        (Some(9728), None, 1),
        (Some(9729), None, 1),
        (Some(9984), Some(Filter::Nearest), 3),
    ] {
        let mut file = File::with_triangle();
        let texture = file.texture(&checker());
        let mut sampler = json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 });
        if let Some(min) = min {
            sampler["minFilter"] = json!(min);
        }
        file.push("samplers", sampler);
        file.json["textures"][texture]["sampler"] = json!(0);
        file.material(json!({ "emissiveTexture": { "index": texture } }));
        let scene = file.load();
        let t = &scene.textures[0];
        assert_eq!((t.sampler.mip, t.levels.len()), (mip, levels), "{min:?}");
        assert_eq!(
            (t.sampler.wrap_u, t.sampler.wrap_v),
            (Wrap::ClampToEdge, Wrap::MirroredRepeat)
        );
        assert_eq!(t.sampler.mag, Filter::Nearest);
    }
}

#[test]
fn index_of_refraction_and_specular_are_read_with_their_textures() {
    let mut file = File::with_triangle();
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.attribute("TEXCOORD_1", &[0., 0., 1., 0., 0., 1.], "VEC2");
    let picture = file.texture(&checker());
    file.json["extensionsUsed"] = json!(["KHR_materials_ior", "KHR_materials_specular"]);
    file.material(json!({ "extensions": {
        "KHR_materials_ior": { "ior": 1.33 },
        "KHR_materials_specular": {
            "specularFactor": 0.5,
            "specularTexture": { "index": picture, "texCoord": 1 },
            "specularColorFactor": [2, 0.5, 0.25],
            "specularColorTexture": { "index": picture },
        },
    } }));
    let scene = file.load();
    assert!(scene.warnings.is_empty(), "{}", warnings(&scene));
    let m = &scene.materials[0];
    assert_eq!((m.ior, m.specular), (1.33, 0.5));
    assert_eq!(m.specular_color, Vec3::new(2.0, 0.5, 0.25));
    assert!((m.ior_reflectance() - 0.02006).abs() < 1e-5 && m.has_own_specular());
    let [strength, color] = [m.specular_texture, m.specular_color_texture].map(Option::unwrap);
    assert_eq!((strength.uv_set, color.uv_set), (1, 0));
    let space = |slot: crate::TextureRef| scene.textures[slot.texture as usize].color_space;
    assert_eq!(space(strength), ColorSpace::Linear);
    assert_eq!(space(color), ColorSpace::Srgb);
}

#[test]
fn indices_of_refraction_that_nothing_has_become_the_nearest() {
    for (given, kept, reflectance) in [
        (0.0, 0.0, 1.0),
        (-2.0, 0.0, 1.0),
        (0.5, 1.0, 0.0),
        (1.5, 1.5, 0.04),
    ] {
        let mut file = File::with_triangle();
        file.material(json!({ "extensions": { "KHR_materials_ior": { "ior": given } } }));
        let scene = file.load();
        let m = &scene.materials[0];
        assert_eq!((m.ior, m.ior_reflectance()), (kept, reflectance));
        assert_eq!(m.has_own_specular(), given != 1.5);
    }
}

#[test]
fn a_broken_picture_is_a_warning_and_a_placeholder() {
    let mut file = File::with_triangle();
    let view = file.view(b"\x89PNG not really");
    let image = file.push("images", json!({ "bufferView": view, "name": "wood" }));
    let missing = file.push("images", json!({ "uri": "nowhere/stone.png" }));
    file.push("textures", json!({ "source": image }));
    file.push("textures", json!({ "source": missing }));
    file.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "normalTexture": { "index": 1 },
        "emissiveTexture": { "index": 1 },
    }));
    let scene = file.load();
    assert_eq!(scene.textures[2].levels, [[0, 0, 0, 255]]);
    assert_eq!(
        scene.textures[0].levels[0][..8],
        [255, 0, 255, 255, 255, 255, 255, 255]
    );
    assert_eq!(scene.textures[1].levels, [[128, 128, 255, 255]]);
    let text = warnings(&scene);
    assert!(
        text.contains("images[0] (wood): cannot be decoded"),
        "{text}"
    );
    assert!(
        text.contains("images[1] (nowhere/stone.png): no files"),
        "{text}"
    );
}

#[test]
fn every_pixel_format_becomes_rgba8() {
    use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage};
    let pictures: [(DynamicImage, [u8; 4]); 5] = [
        (
            GrayImage::from_pixel(2, 2, Luma([7])).into(),
            [7, 7, 7, 255],
        ),
        (
            ImageBuffer::from_pixel(2, 2, LumaA([7u8, 9])).into(),
            [7, 7, 7, 9],
        ),
        (
            RgbImage::from_pixel(2, 2, Rgb([1, 2, 3])).into(),
            [1, 2, 3, 255],
        ),
        (
            ImageBuffer::from_pixel(2, 2, Luma([257u16 * 80])).into(),
            [80, 80, 80, 255],
        ),
        (
            ImageBuffer::from_pixel(2, 2, Rgba([257u16, 514, 65535, 0])).into(),
            [1, 2, 255, 0],
        ),
    ];
    for (picture, expected) in pictures {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let mut file = File::with_triangle();
        let view = file.view(bytes.get_ref());
        // The MIME type lies; the content decides.
        file.push(
            "images",
            json!({ "bufferView": view, "mimeType": "image/jpeg" }),
        );
        file.push("textures", json!({ "source": 0 }));
        file.material(json!({ "occlusionTexture": { "index": 0 } }));
        let scene = file.load();
        assert_eq!(
            scene.textures[0].levels[0][..4],
            expected,
            "{:?}",
            picture.color()
        );
    }
}

#[test]
fn large_pictures_are_halved_until_they_fit() {
    let mut file = File::with_triangle();
    let texture = file.texture(&RgbaImage::from_pixel(20, 9, Rgba([10, 20, 30, 255])));
    file.material(json!({ "emissiveTexture": { "index": texture } }));
    let options = LoadOptions {
        max_texture_size: 8,
        ..LoadOptions::default()
    };
    let scene = file.load_with(&options).unwrap();
    let t = &scene.textures[0];
    assert_eq!((t.width, t.height), (5, 2));
    assert_eq!(t.levels.len(), 3);
    assert_eq!(t.levels[0], [10, 20, 30, 255].repeat(10));
    assert!(warnings(&scene).contains("is 20 x 9 texels large and reduced to 5 x 2"));

    // 964 bytes with all levels do not fit beside the 720 of the decoder; 217 do beside its 1,440.
    let options = LoadOptions {
        max_texture_bytes: 1_660,
        ..LoadOptions::default()
    };
    let scene = file.load_with(&options).unwrap();
    assert_eq!((scene.textures[0].width, scene.textures[0].height), (10, 4));
    assert!(
        warnings(&scene).contains("images: want 1.7 KB for textures; the limit is 1.7 KB"),
        "{}",
        warnings(&scene)
    );

    let options = LoadOptions {
        max_texture_bytes: 1_400,
        ..LoadOptions::default()
    };
    let text = file.load_with(&options).unwrap_err().to_string();
    assert!(
        text.contains("images[0]") && text.contains("wants 1.4 KB to decode 20 x 9 texels"),
        "{text}"
    );
}

#[test]
fn pictures_are_kept_in_blocks_by_what_is_read_of_them() {
    let picture = |side: u32, texel: fn(u32, u32) -> [u8; 4]| {
        RgbaImage::from_fn(side, side, |x, y| Rgba(texel(x, y)))
    };
    let mut file = File::with_triangle();
    let color = file.texture(&picture(16, |x, y| [x as u8 * 5, 200, y as u8 * 4, 255]));
    let normal = file.texture(&picture(16, |x, y| {
        [128 + x as u8, 128 - y as u8, 250, 255]
    }));
    let open = file.texture(&picture(8, |x, _| [100 + x as u8 * 9, 3, 7, 255]));
    let odd = file.texture(&picture(10, |x, y| [x as u8, y as u8, 9, 255]));
    let index = |i: usize| json!({ "index": i });
    file.material(json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": index(color),
            "metallicRoughnessTexture": index(odd),
        },
        "normalTexture": index(normal),
        "occlusionTexture": index(open),
    }));
    let options = LoadOptions {
        texture_compression: crate::TextureCompression::Fine,
        ..LoadOptions::default()
    };
    let (plain, blocks) = (file.load(), file.load_with(&options).unwrap());
    let material = &blocks.materials[0];
    use crate::Encoding::{Bc4, Bc5, Bc7, Rgba8};
    for (slot, encoding, read) in [
        (material.base_color_texture, Bc7, 3),
        (material.normal_texture, Bc5, 2),
        (material.occlusion_texture, Bc4, 1),
        (material.metallic_roughness_texture, Rgba8, 4),
    ] {
        let at = slot.unwrap().texture as usize;
        let (old, new) = (&plain.textures[at], &blocks.textures[at]);
        assert_eq!(new.encoding, encoding);
        assert_eq!(
            (new.name.as_str(), new.levels.len()),
            (old.name.as_str(), old.levels.len())
        );
        for level in 0..new.levels.len() {
            let (old, new) = (old.decoded_level(level), new.decoded_level(level));
            for (a, b) in old.chunks_exact(4).zip(new.chunks_exact(4)) {
                assert!((0..read).all(|c| a[c].abs_diff(b[c]) < 16), "{a:?} {b:?}");
            }
        }
    }
    // A placeholder is what it was.
    let mut broken = File::with_triangle();
    broken.push("textures", json!({}));
    broken.material(json!({ "normalTexture": index(0) }));
    let scenes = [&options, &LoadOptions::default()].map(|o| broken.load_with(o).unwrap());
    assert_eq!(scenes[0].textures, scenes[1].textures);
}

#[test]
fn textures_in_blocks_are_counted_as_what_they_take() {
    use crate::TextureCompression::{Fine, Off, Small};
    let mut file = File::with_triangle();
    let count = 8;
    for _ in 0..count {
        let texture = file.texture(&RgbaImage::from_pixel(64, 64, Rgba([10, 20, 30, 255])));
        file.material(json!({ "emissiveTexture": { "index": texture } }));
    }
    let width = |texture_compression, max_texture_bytes| {
        let options = LoadOptions {
            texture_compression,
            max_texture_bytes,
            ..LoadOptions::default()
        };
        file.load_with(&options).unwrap().textures[0].width
    };
    // Blocks of all levels of all textures; the decoder's output and the levels as texels of one,
    // whose blocks come after that output.
    for (by, block) in [(Fine, 16), (Small, 8)] {
        let one = block * (256 + 64 + 16 + 4 + 1 + 1 + 1);
        let total = count * one + 64 * 64 * 4 + (64 * 64 * 16 / 3 + 4) - one;
        assert_eq!(width(by, total), 64);
        assert_eq!(width(by, total - 1), 32);
        assert!(width(Off, total) <= 32);
    }
}

#[test]
fn no_picture_is_reduced_or_refused_because_of_blocks() {
    use crate::TextureCompression::{Fine, Off, Small};
    for (width, height) in [(10, 10), (20, 9), (16, 16), (32, 8)] {
        let mut file = File::with_triangle();
        let texture = file.texture(&RgbaImage::from_pixel(width, height, Rgba([9, 8, 7, 255])));
        let index = json!({ "index": texture });
        file.material(json!({ "emissiveTexture": index, "normalTexture": index }));
        let size = |texture_compression, max_texture_bytes| {
            let options = LoadOptions {
                texture_compression,
                max_texture_bytes,
                ..LoadOptions::default()
            };
            let scene = file.load_with(&options).ok()?;
            Some((scene.textures[0].width, scene.textures[0].height))
        };
        let (mut refused, mut whole) = (0, 0);
        for limit in (1_000..6_000).step_by(7) {
            let off = size(Off, limit);
            refused += usize::from(off.is_none());
            whole += usize::from(off == Some((width, height)));
            for by in [Small, Fine] {
                let on = size(by, limit);
                assert_eq!(on.is_none(), off.is_none(), "{limit}");
                assert!(on >= off, "{limit}: {on:?}, {off:?}");
                if width % 4 != 0 || height % 4 != 0 {
                    assert!(on == off || off != Some((width, height)), "{limit}");
                }
            }
        }
        assert!(refused > 20 && whole > 20, "{refused} {whole}");
    }
}
