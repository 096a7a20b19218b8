//! Files with an environment of their own (`EXT_lights_image_based`).

use std::f32::consts::PI;

use image::{Rgba, RgbaImage};
use serde_json::json;

use crate::file::File;

const NAME: &str = "EXT_lights_image_based";

/// The direction of a place on a picture of the cube, as the extension has them: +x, -x, +y, -y, +z,
/// -z, seen from within; `s` to the right, `t` down, -1 to 1. Not of unit length.
#[must_use]
pub fn seen_from_within(side: usize, s: f32, t: f32) -> [f32; 3] {
    match side {
        0 => [1.0, -t, s],
        1 => [-1.0, -t, -s],
        2 => [-s, 1.0, t],
        3 => [-s, -1.0, -t],
        4 => [-s, -t, 1.0],
        _ => [s, -t, -1.0],
    }
}

fn unit(d: [f32; 3]) -> [f32; 3] {
    let length = d.iter().map(|v| v * v).sum::<f32>().sqrt();
    d.map(|v| v / length)
}

fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// A texel of this radiance, as colours over alpha.
fn rgbd(rgb: [f32; 3]) -> Rgba<u8> {
    let most = rgb.into_iter().fold(1.0, f32::max);
    let alpha = (255.0 / most).floor().clamp(1.0, 255.0);
    let code = |v: f32| (srgb((v * alpha / 255.0).clamp(0.0, 1.0)) * 255.0).round() as u8;
    let [r, g, b] = rgb.map(code);
    Rgba([r, g, b, alpha as u8])
}

/// The triangle in an environment of this radiance, by unit direction: pictures of `side` texels and
/// the irradiance that follows from them.
#[must_use]
pub fn surrounded(side: u32, radiance: &dyn Fn([f32; 3]) -> [f32; 3]) -> File {
    let mut file = File::with_triangle();
    let place = |x: u32| (x as f32 + 0.5) * 2.0 / side as f32 - 1.0;
    let mut sums = [[0f32; 3]; 9];
    let mut sphere = 0f32;
    let mut images = Vec::new();
    for face in 0..6 {
        let picture = RgbaImage::from_fn(side, side, |x, y| {
            let far = seen_from_within(face, place(x), place(y));
            let d @ [dx, dy, dz] = unit(far);
            let weight = far.iter().map(|v| v * v).sum::<f32>().powf(-1.5);
            let rgb = radiance(d);
            let harmonics = [
                0.282_095,
                0.488_603 * dy,
                0.488_603 * dz,
                0.488_603 * dx,
                1.092_548 * dx * dy,
                1.092_548 * dy * dz,
                0.315_392 * (3.0 * dz * dz - 1.0),
                1.092_548 * dx * dz,
                0.546_274 * (dx * dx - dy * dy),
            ];
            sphere += weight;
            for (sum, harmonic) in sums.iter_mut().zip(harmonics) {
                for (sum, v) in sum.iter_mut().zip(rgb) {
                    *sum += v * harmonic * weight;
                }
            }
            rgbd(rgb)
        });
        let texture = file.texture(&picture);
        images.push(file.json["textures"][texture]["source"].clone());
    }
    // What the cosine makes of radiance.
    let (first, second) = (2.0 * PI / 3.0, PI / 4.0);
    let cosine = [
        PI, first, first, first, second, second, second, second, second,
    ];
    let coefficients: Vec<[f32; 3]> = sums
        .iter()
        .zip(cosine)
        .map(|(sum, cosine)| sum.map(|v| v * 4.0 * PI / sphere * cosine))
        .collect();
    file.json["extensionsUsed"] = json!([NAME]);
    file.json["extensions"][NAME]["lights"] = json!([{
        "name": "around",
        "irradianceCoefficients": coefficients,
        "specularImageSize": side,
        "specularImages": [images],
    }]);
    file.json["scenes"][0]["extensions"][NAME] = json!({ "light": 0 });
    file
}
