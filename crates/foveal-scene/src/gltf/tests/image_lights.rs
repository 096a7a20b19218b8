//! Environments of files.

use foveal_seeds::surrounded;
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{File, Loads, warnings};
use crate::image_light::direction_of;
use crate::{Code, ImageLight, Limit, LoadOptions, harmonics};

/// Another colour towards each side, and bright above.
fn colors([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        0.5 + 0.4 * x,
        0.5 + 0.4 * z,
        if y > 0.6 { 6.0 } else { 0.2 },
    ]
}

fn light(file: &mut File) -> &mut Value {
    &mut file.json["extensions"]["EXT_lights_image_based"]["lights"][0]
}

fn read(file: &File) -> ImageLight {
    let scene = file.load();
    assert_eq!(warnings(&scene), "");
    scene.image_light.expect("the file has one")
}

fn assert_shows(light: &ImageLight, radiance: impl Fn([f32; 3]) -> [f32; 3]) {
    let side = light.side as usize;
    assert_eq!(light.radiance.len(), 6 * side * side);
    for (i, texel) in light.radiance.iter().enumerate() {
        let place = |x: usize| (x as f32 + 0.5) * 2.0 / side as f32 - 1.0;
        let (x, y) = (i % side, i / side % side);
        let d = direction_of(i / (side * side), place(x), place(y)).normalize();
        for (found, wanted) in texel.iter().zip(radiance(d.to_array())) {
            let near = (found - wanted).abs() <= 0.02 * wanted.max(0.5);
            assert!(near, "towards {d}: {texel:?}, {wanted}");
        }
    }
}

#[test]
fn an_environment_is_read_with_the_directions_of_the_world() {
    let mut file = surrounded(16, &colors);
    let plain = read(&file);
    assert_shows(&plain, colors);
    assert_eq!((plain.side, plain.intensity), (16, 1.0));
    assert_eq!(plain.rotation, Quat::IDENTITY);
    assert_eq!(plain.name, "around");
    // More light falls on what faces +x than on what faces -x, of the first colour.
    let falls = |n: Vec3, c: usize| -> f32 {
        let terms = harmonics(n).into_iter().zip(plain.irradiance);
        terms.map(|(h, sum)| h * sum[c]).sum()
    };
    assert!(falls(Vec3::X, 0) > 1.5 * falls(Vec3::NEG_X, 0));
    assert!(falls(Vec3::Z, 1) > 1.5 * falls(Vec3::NEG_Z, 1));
    assert!(falls(Vec3::Y, 2) > 3.0 * falls(Vec3::NEG_Y, 2));
    light(&mut file)["rotation"] = json!([0.0, 2.0, 0.0, 0.0]);
    light(&mut file)["intensity"] = json!(3);
    let turned = read(&file);
    assert_eq!(turned.rotation, Quat::from_xyzw(0.0, 1.0, 0.0, 0.0));
    assert_eq!(turned.intensity, 3.0);
    assert_eq!(turned.radiance, plain.radiance);
    assert!(!file.load().light_by_default(), "it needs no sun");
}

#[test]
fn what_the_extension_leaves_open_is_read_as_the_file_agrees_with_itself() {
    let plain = read(&surrounded(16, &colors));
    // Babylon.js has the first two pictures in the other order, and signs of its own.
    let mut swapped = surrounded(16, &colors);
    let images = &mut light(&mut swapped)["specularImages"][0];
    images.as_array_mut().unwrap().swap(0, 1);
    assert_eq!(read(&swapped).radiance, plain.radiance);
    // Khronos's EnvironmentTest has them upside down besides. Seen from within, a world whose y is
    // mirrored shows all but above and below so.
    let mut turned = surrounded(16, &|[x, y, z]| colors([x, -y, z]));
    let images = &mut light(&mut turned)["specularImages"][0];
    images.as_array_mut().unwrap().swap(2, 3);
    assert_eq!(read(&turned).radiance, plain.radiance);
    let images = &mut light(&mut turned)["specularImages"][0];
    images.as_array_mut().unwrap().swap(0, 1);
    assert_eq!(read(&turned).radiance, plain.radiance);
    for signs in [
        [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0],
    ] {
        let mut file = surrounded(16, &colors);
        let coefficients = &mut light(&mut file)["irradianceCoefficients"];
        for (row, sign) in coefficients.as_array_mut().unwrap().iter_mut().zip(signs) {
            for value in row.as_array_mut().unwrap() {
                *value = json!(value.as_f64().unwrap() * sign);
            }
        }
        assert_eq!(read(&file).irradiance, plain.irradiance);
    }
}

#[test]
fn a_picture_without_alpha_is_no_brighter_than_white() {
    let mut file = surrounded(4, &|_| [0.25; 3]);
    let white = image::RgbImage::from_pixel(4, 4, image::Rgb([255; 3]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    white
        .write_to(&mut bytes, image::ImageFormat::Jpeg)
        .unwrap();
    let view = file.view(bytes.get_ref());
    let number = file.push(
        "images",
        json!({ "bufferView": view, "mimeType": "image/jpeg" }),
    );
    light(&mut file)["specularImages"][0] = json!(vec![number; 6]);
    assert!(
        read(&file)
            .radiance
            .iter()
            .flatten()
            .all(|v| (v - 1.0).abs() < 1e-3)
    );
}

#[test]
fn a_broken_environment_is_left_out_with_its_place_and_cause() {
    type Change = fn(&mut Value);
    let cases: &[(Code, &str, Change)] = &[
        (
            Code::ValueType,
            "irradianceCoefficients: has 8 coefficients",
            |light| {
                light["irradianceCoefficients"]
                    .as_array_mut()
                    .unwrap()
                    .pop();
            },
        ),
        (
            Code::ValueType,
            "irradianceCoefficients[3]: has 2 numbers",
            |light| {
                light["irradianceCoefficients"][3] = json!([1, 2]);
            },
        ),
        (
            Code::ValueMissing,
            "irradianceCoefficients: is missing",
            |light| {
                light
                    .as_object_mut()
                    .unwrap()
                    .remove("irradianceCoefficients");
            },
        ),
        (
            Code::ValueType,
            "specularImages[0]: has 5 numbers",
            |light| {
                light["specularImages"][0].as_array_mut().unwrap().pop();
            },
        ),
        (
            Code::IndexOutOfRange,
            "specularImages[0][2]: names number 99",
            |light| {
                light["specularImages"][0][2] = json!(99);
            },
        ),
        (Code::ValueType, "specularImages: has no level", |light| {
            light["specularImages"] = json!([]);
        }),
        (Code::ValueOutOfRange, "specularImageSize: is 12", |light| {
            light["specularImageSize"] = json!(12);
        }),
        (Code::ValueOutOfRange, "has 8 x 8 texels", |light| {
            light["specularImageSize"] = json!(16);
        }),
        (Code::ValueOutOfRange, "rotation: is no rotation", |light| {
            light["rotation"] = json!([0, 0, 0, 0]);
        }),
    ];
    for (code, text, change) in cases {
        let mut file = surrounded(8, &colors);
        change(light(&mut file));
        let scene = file.load();
        assert!(scene.image_light.is_none(), "{text}");
        let all = warnings(&scene);
        assert!(all.contains(text), "{text}: {all}");
        assert!(all.contains("the environment is left out"), "{all}");
        assert_eq!(scene.warnings[0].code, *code, "{all}");
    }
    let mut file = surrounded(8, &colors);
    file.json["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = json!(4);
    let all = warnings(&file.load());
    assert!(
        all.contains("scenes[0].extensions.EXT_lights_image_based.light: names number 4"),
        "{all}"
    );
    // One that nothing shows may be as it likes.
    let mut file = surrounded(8, &colors);
    file.json["scenes"][0]
        .as_object_mut()
        .unwrap()
        .remove("extensions");
    *light(&mut file) = json!({});
    let scene = file.load();
    assert!(scene.image_light.is_none());
    assert_eq!(warnings(&scene), "");
}

#[test]
fn a_picture_that_cannot_be_read_leaves_the_environment_out() {
    let mut file = surrounded(8, &colors);
    let view = file.view(b"no picture");
    file.json["images"][3]["bufferView"] = json!(view);
    let scene = file.load();
    assert!(scene.image_light.is_none());
    let all = warnings(&scene);
    assert!(
        all.contains("images[3]") && all.contains("the environment is left out"),
        "{all}"
    );
    assert_eq!(scene.warnings[0].code, Code::ImageUnreadable);
}

#[test]
fn an_environment_beyond_the_limit_is_refused_before_it_is_decoded() {
    let options = LoadOptions {
        max_texture_bytes: 10_000,
        ..LoadOptions::default()
    };
    let error = surrounded(32, &colors).load_with(&options).unwrap_err();
    assert_eq!(error.code(), Code::LimitExceeded);
    assert_eq!(error.limit(), Some(Limit::TextureBytes));
    assert!(
        error.to_string().contains("the pictures of an environment"),
        "{error}"
    );
}

#[test]
fn an_extension_that_is_no_object_leaves_the_rest_of_the_file() {
    for at_root in [true, false] {
        let mut file = surrounded(4, &colors);
        let holder = if at_root {
            &mut file.json
        } else {
            &mut file.json["scenes"][0]
        };
        holder["extensions"]["EXT_lights_image_based"] = json!(5);
        let scene = file.load();
        assert!(scene.image_light.is_none());
        let text = warnings(&scene);
        assert!(text.contains("EXT_lights_image_based"), "{text}");
        assert!(text.contains("the environment is left out"), "{text}");
    }
}

#[test]
fn smaller_cubes_are_means() {
    let mut light = read(&surrounded(16, &colors));
    let sum = |light: &ImageLight| light.radiance.iter().map(|t| t[1]).sum::<f32>();
    let before = sum(&light);
    light.halve_to(5);
    assert_eq!((light.side, light.radiance.len()), (4, 6 * 16));
    let after = sum(&light) * 16.0;
    assert!((after - before).abs() < 1e-3 * before, "{before} {after}");
}
