//! A file that shows whatever JSON pointers can animate (KHR_animation_pointer), and the same file
//! with the values of one moment.

use serde_json::{Value, json};

use crate::file::File;

/// A property with its values at the beginning and at the end of a second.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// The JSON pointer.
    pub pointer: &'static str,
    /// Type of the accessor's elements; `BOOL` for a boolean and `TURN` for a rotation, which change at
    /// the end.
    pub kind: &'static str,
    /// As many numbers as an element has, or for lists as the list has.
    pub from: &'static [f32],
    /// The same at the end.
    pub to: &'static [f32],
}

impl Moved {
    /// Whether the value stays until the end.
    fn steps(&self) -> bool {
        matches!(self.kind, "BOOL" | "TURN")
    }

    /// The value at a time from 0 to 1 second, as importers interpolate it.
    #[must_use]
    pub fn at(&self, time_s: f32) -> Value {
        let at = |(from, to): (&f32, &f32)| match time_s {
            end if end >= 1.0 => *to,
            _ if self.steps() => *from,
            time_s => from + (to - from) * time_s,
        };
        let value: Vec<f32> = self.from.iter().zip(self.to).map(at).collect();
        match (self.kind, value.as_slice()) {
            ("BOOL", value) => json!(value == [1.0]),
            ("SCALAR", [one]) => json!(one),
            (_, many) => json!(many),
        }
    }
}

macro_rules! moves {
    ($($pointer:literal $kind:ident $from:expr => $to:expr,)+) => {
        &[$(Moved { pointer: $pointer, kind: stringify!($kind), from: &$from, to: &$to },)+]
    };
}

/// Everything that [`movable`] shows and pointers move, with values that importers take as they are.
pub const MOVES: &[Moved] = moves![
    "/nodes/0/translation" VEC3 [0.0, 0.0, 0.0] => [0.25, 0.5, 0.0],
    "/nodes/1/scale" VEC3 [1.0, 1.0, 1.0] => [0.5, 1.5, 1.0],
    "/nodes/2/rotation" TURN [0.0, 0.0, 0.0, 1.0] => [0.0, 0.0, 1.0, 0.0],
    "/nodes/3/weights" SCALAR [0.0, 0.5] => [1.0, 0.25],
    "/nodes/4/extensions/KHR_node_visibility/visible" BOOL [1.0] => [0.0],
    "/nodes/5/extensions/KHR_node_visibility/visible" BOOL [0.0] => [1.0],
    "/cameras/0/perspective/yfov" SCALAR [0.8] => [1.1],
    "/cameras/0/perspective/znear" SCALAR [0.1] => [0.5],
    "/extensions/KHR_lights_punctual/lights/0/color" VEC3 [1.0, 0.5, 0.25] => [0.25, 1.0, 0.5],
    "/extensions/KHR_lights_punctual/lights/0/intensity" SCALAR [40.0] => [10.0],
    "/extensions/KHR_lights_punctual/lights/0/range" SCALAR [12.0] => [4.0],
    "/extensions/KHR_lights_punctual/lights/1/intensity" SCALAR [90.0] => [45.0],
    "/extensions/KHR_lights_punctual/lights/1/spot/innerConeAngle" SCALAR [0.25] => [0.125],
    "/extensions/KHR_lights_punctual/lights/1/spot/outerConeAngle" SCALAR [0.5] => [0.75],
    "/materials/0/pbrMetallicRoughness/baseColorFactor" VEC4
        [1.0, 0.5, 0.25, 1.0] => [0.25, 0.5, 1.0, 1.0],
    "/materials/0/pbrMetallicRoughness/metallicFactor" SCALAR [0.0] => [1.0],
    "/materials/0/pbrMetallicRoughness/roughnessFactor" SCALAR [0.25] => [0.75],
    "/materials/0/emissiveFactor" VEC3 [0.0, 0.0, 0.0] => [0.0, 0.25, 0.5],
    "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength" SCALAR [1.0] => [3.0],
    "/materials/0/normalTexture/scale" SCALAR [1.0] => [0.25],
    "/materials/0/occlusionTexture/strength" SCALAR [1.0] => [0.5],
    "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset" VEC2
        [0.0, 0.0] => [0.5, 0.25],
    "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/rotation"
        SCALAR [0.0] => [0.75],
    "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale" VEC2
        [1.0, 1.0] => [2.0, 3.0],
    "/materials/0/normalTexture/extensions/KHR_texture_transform/offset" VEC2
        [0.0, 0.0] => [0.25, 0.5],
    "/materials/0/normalTexture/extensions/KHR_texture_transform/rotation" SCALAR [0.0] => [1.5],
    "/materials/1/extensions/KHR_materials_ior/ior" SCALAR [1.5] => [2.5],
    "/materials/1/extensions/KHR_materials_specular/specularFactor" SCALAR [1.0] => [0.5],
    "/materials/1/extensions/KHR_materials_specular/specularColorFactor" VEC3
        [1.0, 1.0, 1.0] => [1.0, 0.25, 0.5],
    "/materials/2/alphaCutoff" SCALAR [0.25] => [0.75],
    "/materials/2/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset" VEC2
        [0.25, 0.0] => [0.5, 0.5],
    "/materials/3/extensions/KHR_materials_clearcoat/clearcoatFactor" SCALAR [0.0] => [1.0],
    "/materials/3/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor" SCALAR [0.0] => [0.5],
    "/materials/3/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale" SCALAR
        [1.0] => [0.5],
    "/materials/3/extensions/KHR_materials_sheen/sheenColorFactor" VEC3
        [0.0, 0.0, 0.0] => [0.5, 0.25, 1.0],
    "/materials/3/extensions/KHR_materials_sheen/sheenRoughnessFactor" SCALAR [0.25] => [0.75],
    "/materials/3/extensions/KHR_materials_anisotropy/anisotropyStrength" SCALAR [0.0] => [0.75],
    "/materials/3/extensions/KHR_materials_anisotropy/anisotropyRotation" SCALAR [0.0] => [1.0],
    "/materials/3/extensions/KHR_materials_iridescence/iridescenceFactor" SCALAR [0.0] => [0.5],
    "/materials/3/extensions/KHR_materials_iridescence/iridescenceIor" SCALAR [1.25] => [2.0],
    "/materials/3/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum" SCALAR
        [100.0] => [300.0],
    "/materials/3/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum" SCALAR
        [400.0] => [200.0],
    "/materials/4/extensions/KHR_materials_transmission/transmissionFactor" SCALAR [0.0] => [0.75],
    "/materials/4/extensions/KHR_materials_transmission/transmissionTexture/extensions/KHR_texture_transform/scale"
        VEC2 [1.0, 1.0] => [0.5, 2.0],
    "/materials/4/extensions/KHR_materials_volume/thicknessFactor" SCALAR [0.0] => [0.5],
    "/materials/4/extensions/KHR_materials_volume/attenuationDistance" SCALAR [2.0] => [0.5],
    "/materials/4/extensions/KHR_materials_volume/attenuationColor" VEC3
        [1.0, 1.0, 1.0] => [0.5, 1.0, 0.25],
    "/materials/5/pbrMetallicRoughness/baseColorFactor" VEC4
        [1.0, 0.25, 0.25, 0.75] => [0.25, 0.25, 1.0, 0.5],
];

/// Vertices along a side of a bump.
const SIDE: u16 = 6;

/// A still file with all that [`MOVES`] names: six bumps with different materials above a floor, two
/// lights, a camera.
#[must_use]
pub fn movable() -> File {
    let mut file = File::with_mesh();
    let grid = |f: &dyn Fn(f32, f32) -> Vec<f32>| -> Vec<f32> {
        let step = |i: u16| f32::from(i) / f32::from(SIDE - 1);
        let all = (0..SIDE).flat_map(|v| (0..SIDE).map(move |u| (step(u), step(v))));
        all.flat_map(|(u, v)| f(u, v)).collect()
    };
    let height = |u: f32, v: f32| 0.25 - (u - 0.5).powi(2) - (v - 0.5).powi(2);
    file.attribute(
        "POSITION",
        &grid(&|u, v| vec![u - 0.5, 0.5 - v, height(u, v)]),
        "VEC3",
    );
    file.attribute(
        "NORMAL",
        &grid(&|u, v| {
            let (x, y) = (2.0 * (u - 0.5), -2.0 * (v - 0.5));
            let length = (x * x + y * y + 1.0).sqrt();
            vec![x / length, y / length, 1.0 / length]
        }),
        "VEC3",
    );
    file.attribute("TANGENT", &grid(&|_, _| vec![1.0, 0.0, 0.0, 1.0]), "VEC4");
    file.attribute("TEXCOORD_0", &grid(&|u, v| vec![u, v]), "VEC2");
    let cells = (0..SIDE - 1).flat_map(|v| (0..SIDE - 1).map(move |u| v * SIDE + u));
    let corners = cells.flat_map(|at| {
        let below = at + SIDE;
        [at, below, at + 1, at + 1, below, below + 1]
    });
    file.indices(&corners.collect::<Vec<u16>>());
    let raised = grid(&|u, v| vec![0.0, 0.0, height(u, v)]);
    let aside = grid(&|_, v| vec![0.25 * v, 0.0, 0.0]);
    let [raised, aside] = [raised, aside].map(|deltas| file.floats(&deltas, "VEC3"));

    let picture = |f: &dyn Fn(u32, u32) -> [u8; 4]| {
        image::RgbaImage::from_fn(8, 8, |x, y| image::Rgba(f(x, y)))
    };
    let colors = picture(&|x, y| [255 - 20 * x as u8, 100 + 15 * y as u8, 160, 255]);
    let bumps = picture(&|x, y| [100 + 8 * x as u8, 150 - 6 * y as u8, 250, 255]);
    let holes = picture(&|x, y| [255, 255, 255, (x * 16 + y * 16) as u8]);
    let [colors, bumps, holes] = [colors, bumps, holes].map(|picture| file.texture(&picture));
    // Mip levels keep the holes' size at the file's own cutoff.
    let nearest = file.push("samplers", json!({ "magFilter": 9728, "minFilter": 9728 }));
    file.json["textures"][holes]["sampler"] = json!(nearest);
    let moving =
        |texture: usize| json!({ "index": texture, "extensions": { "KHR_texture_transform": {} } });
    let matte = |extensions: Value| {
        json!({
            "pbrMetallicRoughness": {
                "metallicFactor": 0.25, "roughnessFactor": 0.5, "baseColorFactor": [0.75, 0.75, 0.5, 1.0],
            },
            "extensions": extensions,
        })
    };
    file.json["materials"] = json!([
        {
            "pbrMetallicRoughness": {
                "baseColorTexture": moving(colors),
                "metallicRoughnessTexture": { "index": colors },
            },
            "normalTexture": moving(bumps),
            "occlusionTexture": { "index": colors },
            "emissiveFactor": [0.25, 0.125, 0.0],
            "emissiveTexture": { "index": colors },
            "extensions": { "KHR_materials_emissive_strength": {} },
        },
        matte(json!({ "KHR_materials_ior": {}, "KHR_materials_specular": {} })),
        {
            "pbrMetallicRoughness": { "baseColorTexture": moving(holes), "metallicFactor": 0.0 },
            "alphaMode": "MASK",
            "doubleSided": true,
        },
        matte(json!({
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.5, "clearcoatNormalTexture": { "index": bumps },
            },
            "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.5, 0.5] },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5 },
            "KHR_materials_iridescence": { "iridescenceFactor": 0.5 },
        })),
        matte(json!({
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": moving(colors),
            },
            "KHR_materials_volume": {
                "thicknessFactor": 0.25, "attenuationDistance": 2.0, "attenuationColor": [1.0, 0.5, 0.5],
            },
        })),
        { "alphaMode": "BLEND", "pbrMetallicRoughness": {} },
        { "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorFactor": [0.5, 0.5, 0.5, 1.0] } },
    ]);
    let primitive = file.primitive().clone();
    let mesh = |material: u32| {
        let mut primitive = primitive.clone();
        primitive["material"] = json!(material);
        json!({ "primitives": [primitive] })
    };
    file.json["meshes"] = (0..7).map(mesh).collect();
    file.json["meshes"][3]["primitives"][0]["targets"] =
        json!([{ "POSITION": raised }, { "POSITION": aside }]);
    let at = |i: u32| {
        [
            (i % 3) as f32 * 1.25 - 1.25,
            (i / 3) as f32 * 1.25 - 0.625,
            0.0,
        ]
    };
    file.json["nodes"] = json!([
        { "children": [6], "translation": [0, 0, 0] },
        { "mesh": 1, "translation": at(1) },
        { "mesh": 2, "translation": at(2) },
        { "mesh": 3, "translation": at(3) },
        { "mesh": 4, "children": [12], "translation": at(4), "extensions": { "KHR_node_visibility": {} } },
        { "children": [7, 8], "extensions": { "KHR_node_visibility": { "visible": false } } },
        { "mesh": 0, "translation": at(0) },
        { "mesh": 5, "translation": at(5) },
        { "mesh": 1, "translation": [0.5, 0.0, 0.75], "scale": [0.25, 0.25, 0.25] },
        { "mesh": 6, "translation": [0, 0, -1], "scale": [5, 4, 0.25] },
        { "camera": 0, "translation": [0.25, 0, 4] },
        { "translation": [-1, 1.5, 2.5], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "translation": [1.5, -1, 4], "extensions": { "KHR_lights_punctual": { "light": 1 } } },
    ]);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4, 5, 9, 10, 11]);
    file.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "range": 12 },
        { "type": "spot", "spot": {} },
    ] } });
    file
}

/// Adds a clip of one second that moves all these.
pub fn animate(file: &mut File, moves: &[Moved]) {
    let times = file.floats(&[0.0, 1.0], "SCALAR");
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for moved in moves {
        let values = [moved.from, moved.to].concat();
        let bytes: Vec<u8> = values.iter().map(|v| *v as u8).collect();
        let output = match moved.kind {
            "BOOL" => file.accessor(&bytes, 5121, "SCALAR", 2),
            "TURN" => file.floats(&values, "VEC4"),
            kind => file.floats(&values, kind),
        };
        let mode = if moved.steps() { "STEP" } else { "LINEAR" };
        channels.push(json!({ "sampler": samplers.len(), "target": {
            "path": "pointer",
            "extensions": { "KHR_animation_pointer": { "pointer": moved.pointer } },
        } }));
        samplers.push(json!({ "input": times, "output": output, "interpolation": mode }));
    }
    let name = format!("clip {}", moves.len());
    let clip = json!({ "name": name, "samplers": samplers, "channels": channels });
    file.push("animations", clip);
    file.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
}

/// Gives all these the values that they have at a time.
pub fn hold(file: &mut File, moves: &[Moved], time_s: f32) {
    for moved in moves {
        let (holder, key) = moved.pointer.rsplit_once('/').unwrap();
        file.json.pointer_mut(holder).unwrap()[key] = moved.at(time_s);
    }
}

/// A file in which everything moves that pointers can move.
#[must_use]
pub fn pointers() -> File {
    let mut file = movable();
    // What has no default must be there.
    hold(&mut file, MOVES, 0.0);
    animate(&mut file, MOVES);
    file
}
