//! What *Copy command* copies draws what the window shows, byte by byte. Needs a graphics adapter.

use std::path::Path;

use clap::Parser;
use foveal::Settings;
use foveal_scene::{Camera, Clip};
use foveal_view::{Settler, Sight};
use glam::{Mat4, Vec3};
use toml::{Table, Value};

use crate::cli::{Cli, Command};
use crate::render;

/// SplitMix64.
struct Lot(u64);

impl Lot {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn of<'v, T>(&mut self, values: &'v [T]) -> &'v T {
        &values[(self.next() % values.len() as u64) as usize]
    }

    /// From `least` to `most`.
    fn number(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * (self.next() >> 40) as f32 / (1 << 24) as f32
    }
}

/// Settings from all stages that go together.
fn settings(lot: &mut Lot) -> Settings {
    let choices: [(&str, &[&str]); 16] = [
        ("view", &["final", "final", "final", "motion", "normals"]),
        ("culling", &["off", "auto", "frustum", "occlusion"]),
        ("geometry", &["gbuffer", "visibility"]),
        ("lighting", &["ggx", "blinn-phong"]),
        ("lights", &["clustered", "brute"]),
        ("tone-map", &["aces", "linear"]),
        ("aa", &["none", "none", "msaa", "ssaa"]),
        ("pattern", &["grid", "rotated"]),
        ("shading", &["full", "coarse", "variable"]),
        ("composite", &["nearest", "paper", "smooth"]),
        ("backend", &["stencil", "compute"]),
        ("rate", &["fovea", "content", "constant"]),
        ("rate-stage", &["lighting", "material", "both", "auto"]),
        ("refine-edges", &["off", "graded"]),
        ("stereo", &["off", "off", "two-pass", "instanced"]),
        ("show", &["flat", "side-by-side", "anaglyph"]),
    ];
    loop {
        let mut table = Table::try_from(Settings::default()).unwrap();
        for (key, values) in choices {
            assert!(table.contains_key(key), "{key}");
            table.insert(key.to_owned(), Value::from(*lot.of(values)));
        }
        table.insert("width".to_owned(), Value::from(*lot.of(&[96, 131])));
        table.insert("height".to_owned(), Value::from(*lot.of(&[64, 77])));
        table.insert("force-rate".to_owned(), Value::from(true));
        for (key, least, most) in [
            ("exposure", 0.2, 2.0),
            ("fovea-inner", 0.0, 0.3),
            ("ipd", 0.0, 0.1),
        ] {
            let number = f64::from(lot.number(least, most));
            table.insert(key.to_owned(), Value::from(number));
        }
        let gaze = [lot.number(0.0, 1.0), lot.number(0.0, 1.0)].map(f64::from);
        table.insert("gaze".to_owned(), Value::from(gaze.to_vec()));
        let Ok(settings) = table.try_into::<Settings>() else {
            continue;
        };
        if settings.validate(&wgpu::Limits::default()).is_ok() {
            return settings;
        }
    }
}

/// A camera near `start`, moved as by flying.
fn camera(lot: &mut Lot, start: &Camera) -> Option<Camera> {
    let turned = Mat4::from_rotation_y(lot.number(-0.4, 0.4))
        * Mat4::from_rotation_x(lot.number(-0.2, 0.2))
        * Mat4::from_rotation_z(lot.number(-0.1, 0.1));
    let moved = Vec3::new(lot.number(-0.3, 0.3), lot.number(-0.2, 0.2), 0.0);
    let camera = Camera {
        name: "free".to_owned(),
        world_from_view: start.world_from_view * Mat4::from_translation(moved) * turned,
        ..start.clone()
    };
    lot.of(&[None, Some(camera.clone()), Some(camera)]).clone()
}

const CLIPS: [Clip; 3] = [Clip::Number(0), Clip::Number(1), Clip::All];

/// Three triangles, of which one moves to and fro within two seconds; in the second clip another
/// one does.
fn write_animated(folder: &Path) -> String {
    let mut bytes = Vec::new();
    let mut push = |numbers: &[f32]| numbers.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    push(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    push(&[0.0, 1.0, 2.0]);
    push(&[0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    std::fs::write(folder.join("moving.bin"), bytes).unwrap();
    let gltf = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [0.3, 0.2, -1]}, {"mesh": 0, "translation": [-1, 0, -0.5]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [
            {"name": "one", "samplers": [{"input": 1, "output": 2}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]},
            {"name": "two", "samplers": [{"input": 1, "output": 2}], "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2]},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}, {"buffer": 0, "byteOffset": 48, "byteLength": 36}],
        "buffers": [{"byteLength": 84, "uri": "moving.bin"}]}"#;
    let path = folder.join("moving pictures.gltf");
    std::fs::write(&path, gltf).unwrap();
    path.display().to_string()
}

#[test]
fn no_scene_of_a_window_is_read_from_standard_input() {
    let args = |words: &[&str]| match Cli::try_parse_from(words).unwrap().command {
        Command::View(args) => args,
        _ => panic!("these are words for the window"),
    };
    let refused = |result: anyhow::Result<()>| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains("standard input; name a file"), "{text}");
    };
    refused(super::host(&args(&["foveal", "view", "-"])).map(drop));
    let host = super::host(&args(&["foveal", "view", "cornell"])).unwrap();
    refused((host.load)("-").map(drop));
}

#[test]
fn flags_of_one_scene_are_not_those_of_another_and_the_clip_is_the_windows() {
    let words = [
        "foveal",
        "view",
        "a.glb",
        "--clip",
        "Run",
        "--variant",
        "red",
        "--point-lights",
        "3",
        "--max-texture-size",
        "64",
        "--outside-files",
    ];
    let Command::View(args) = Cli::try_parse_from(words).unwrap().command else {
        panic!("these are words for the window");
    };
    let host = super::host(&args).unwrap();
    let flags = |scene| (host.scene_flags)(scene).join(" ");
    let of_both = "--max-texture-size 64 --outside-files --point-lights 3";
    assert_eq!(flags("a.glb"), format!("--variant red {of_both}"));
    assert_eq!(flags("b.glb"), of_both);
}

#[test]
fn the_copied_command_draws_what_the_window_shows() {
    let folder = tempfile::tempdir().unwrap();
    let animated = write_animated(folder.path());
    let mut lot = Lot(7);
    let mut states = 0;
    let mut differing = Vec::new();
    for (scene, lights) in [("cornell", "5"), ("alpha", "0"), (animated.as_str(), "3")] {
        let words = ["foveal", "view", scene, "--point-lights", lights];
        let Command::View(args) = Cli::try_parse_from(words).unwrap().command else {
            panic!("these are words for the window");
        };
        let settler = Settler::open(super::host(&args).unwrap()).unwrap();
        for _ in 0..10 {
            let sight = Sight {
                settings: settings(&mut lot),
                camera: camera(&mut lot, settler.start()),
                time_s: lot.number(0.0, 2.0),
                // A generated scene has none to choose from.
                clip: (scene == animated).then(|| lot.of(&CLIPS).clone()),
            };
            let shown = settler.settle(&sight).unwrap();
            let file = folder.path().join("picture.png");
            let words: Vec<String> = (shown.command.iter())
                .map(|word| match word.as_str() {
                    "picture.png" => file.display().to_string(),
                    _ => word.clone(),
                })
                .chain(["--quiet".to_owned()])
                .collect();
            let Command::Render(args) = Cli::try_parse_from(&words).unwrap().command else {
                panic!("these are words to render: {words:?}");
            };
            render::run(&args).unwrap();
            let drawn = image::open(&file).unwrap().to_rgb8();
            assert_eq!(drawn.dimensions(), (shown.width, shown.height));
            let pixels = shown.rgba.as_chunks::<4>().0;
            let same = pixels
                .iter()
                .zip(drawn.pixels())
                .filter(|(a, b)| a[..3] == b.0);
            let same = same.count();
            if same != pixels.len() {
                differing.push(format!(
                    "{same} of {}: {}",
                    pixels.len(),
                    shown.command.join(" ")
                ));
            }
            states += 1;
        }
    }
    assert_eq!(states, 30);
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}
