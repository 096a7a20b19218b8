//! Materials of Wavefront MTL files.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::builder::Builder;
use super::lines::{Line, as_utf8, lines, name_of, uncommented};
use crate::{Code, Warning};

/// A material as the file has it.
#[derive(Default)]
pub(super) struct Material {
    pub(super) name: String,
    diffuse: Option<[f32; 3]>,
    emissive: Option<[f32; 3]>,
    opacity: Option<f32>,
    transparency: Option<f32>,
    exponent: Option<f32>,
    metallic: Option<f32>,
    roughness: Option<f32>,
    diffuse_map: Option<Map>,
    emissive_map: Option<Map>,
    normal_map: Option<Map>,
    /// Keywords that change the surface and are not read.
    ignored: BTreeSet<&'static str>,
}

/// A picture and how it lies on the surface.
struct Map {
    file: String,
    scale: [f32; 2],
    offset: [f32; 2],
}

/// What changes a surface and is left out. Exporters write a specular colour (Ks) for every material;
/// it means another thing in each, and is no news.
const IGNORED: &[&str] = &[
    "map_Ks", "map_Ns", "map_d", "map_Pr", "map_Pm", "map_Bump", "bump", "disp", "decal", "refl",
    "Ps", "Pc", "Pcr", "aniso",
];

/// All materials of a file.
pub(super) fn parse(bytes: &[u8]) -> Vec<Material> {
    let mut all: Vec<Material> = Vec::new();
    for Line { text, .. } in lines(&as_utf8(bytes)) {
        let (key, rest) = text.split_once(char::is_whitespace).unwrap_or((&text, ""));
        let rest = rest.trim();
        if key.eq_ignore_ascii_case("newmtl") {
            all.push(Material {
                name: name_of(rest),
                ..Material::default()
            });
            continue;
        }
        let Some(material) = all.last_mut() else {
            continue;
        };
        match key.to_ascii_lowercase().as_str() {
            "kd" => material.diffuse = color(rest),
            "ke" => material.emissive = color(rest),
            // That opacity changes towards the rim is left out.
            "d" => material.opacity = number(rest.trim_start_matches("-halo")),
            "tr" => material.transparency = number(rest),
            "ns" => material.exponent = number(rest),
            "pm" => material.metallic = number(rest),
            "pr" => material.roughness = number(rest),
            "map_kd" => material.diffuse_map = map(rest),
            "map_ke" => material.emissive_map = map(rest),
            "norm" => material.normal_map = map(rest),
            other => {
                let known = IGNORED.iter().find(|k| k.eq_ignore_ascii_case(other));
                material.ignored.extend(known);
            }
        }
    }
    all
}

fn numbers(text: &str) -> impl Iterator<Item = f32> {
    text.split_whitespace()
        .map_while(|word| word.parse().ok())
        .filter(|x: &f32| x.is_finite())
}

fn number(text: &str) -> Option<f32> {
    numbers(text).next()
}

/// Red, green and blue; one number stands for all three.
fn color(text: &str) -> Option<[f32; 3]> {
    let given: Vec<f32> = numbers(text).take(3).collect();
    match given[..] {
        [r, g, b] => Some([r, g, b]),
        [grey, ..] => Some([grey; 3]),
        [] => None,
    }
}

/// A picture's file after its options (`-s 2 2 1 -clamp on wood.png`).
fn map(text: &str) -> Option<Map> {
    let (mut scale, mut offset) = ([1.0; 2], [0.0; 2]);
    let mut rest = text;
    while let Some(option) = rest.strip_prefix('-') {
        let (key, after) = option.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        let most = match key {
            "s" | "o" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        for i in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let value = word.parse::<f32>().ok();
            // One number to three are allowed; the file follows.
            if most > 1 && value.is_none() {
                break;
            }
            if let (Some(value), true) = (value, i < 2) {
                match key {
                    "s" => scale[i] = value,
                    "o" => offset[i] = value,
                    _ => {}
                }
            }
            rest = after.trim_start();
        }
    }
    let file = uncommented(rest.trim());
    let is_finite = scale.iter().chain(&offset).all(|x| x.is_finite());
    (!file.is_empty() && is_finite).then(|| Map {
        file: file.to_owned(),
        scale,
        offset,
    })
}

impl Map {
    /// A reference to the texture. Rows are counted from below here, from above in glTF: `s v + o`
    /// becomes `s v + 1 - s - o`.
    fn texture(&self, folder: &str, builder: &mut Builder) -> Value {
        let mut texture = json!({ "index": builder.texture(folder, &self.file) });
        if self.scale != [1.0; 2] || self.offset != [0.0; 2] {
            let offset = [self.offset[0], 1.0 - self.scale[1] - self.offset[1]];
            texture["extensions"] = json!({ "KHR_texture_transform": {
                "scale": self.scale, "offset": offset
            } });
        }
        texture
    }
}

impl Material {
    /// The same as metallic-roughness: Kd and map_Kd are the base colour, Ke and map_Ke emission, d
    /// or 1 - Tr opacity, Ns the exponent of a Blinn-Phong lobe; Pm, Pr and norm, the format's
    /// extension for physically based materials, are taken as they are. A lobe of exponent n has the
    /// roughness `sqrt(2 / (n + 2))`, squared in glTF's terms (Walter et al. 2007, section 5.2).
    /// `folder` is the library's.
    pub(super) fn surface(
        &self,
        folder: &str,
        builder: &mut Builder,
        notes: &mut Vec<Warning>,
    ) -> Value {
        let unit = |x: f32| x.clamp(0.0, 1.0);
        // `Tr 1` alone is what MeshLab writes for opaque surfaces.
        let transparency = self.transparency.filter(|tr| *tr < 1.0);
        let opacity = self.opacity.or(transparency.map(|tr| 1.0 - tr));
        let opacity = unit(opacity.unwrap_or(1.0));
        let mut color = self.diffuse.unwrap_or([1.0; 3]).map(unit);
        if self.diffuse_map.is_some() && color == [0.0; 3] {
            // Exporters write black where the picture says it all.
            color = [1.0; 3];
        }
        let from_exponent = |n: f32| (2.0 / (n.max(0.0) + 2.0)).sqrt().sqrt();
        let roughness = self.roughness.or(self.exponent.map(from_exponent));
        let mut surface = json!({
            "name": self.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [color[0], color[1], color[2], opacity],
                "metallicFactor": unit(self.metallic.unwrap_or(0.0)),
                "roughnessFactor": unit(roughness.unwrap_or(1.0)),
            },
            "alphaMode": if opacity < 1.0 { "BLEND" } else { "OPAQUE" },
            "doubleSided": true,
        });
        if let Some(map) = &self.diffuse_map {
            surface["pbrMetallicRoughness"]["baseColorTexture"] = map.texture(folder, builder);
        }
        if let Some(map) = &self.normal_map {
            surface["normalTexture"] = map.texture(folder, builder);
        }
        if let Some(map) = &self.emissive_map {
            surface["emissiveTexture"] = map.texture(folder, builder);
        }
        let by_default = self.emissive_map.as_ref().map(|_| [1.0; 3]);
        if let Some(emission) = self.emissive.or(by_default) {
            let emission = emission.map(|x| x.max(0.0));
            let most = emission.iter().copied().fold(1.0, f32::max);
            surface["emissiveFactor"] = json!(emission.map(|x| x / most));
            if most > 1.0 {
                let strength = json!({ "emissiveStrength": most });
                surface["extensions"] = json!({ "KHR_materials_emissive_strength": strength });
            }
        }
        if !self.ignored.is_empty() {
            let all: Vec<&str> = self.ignored.iter().copied().collect();
            let text = format!("material {}: not read: {}", self.name, all.join(", "));
            notes.push(Warning::new(Code::MaterialIgnored, text));
        }
        surface
    }
}
