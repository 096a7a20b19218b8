//! The example's level: a glTF file is walked through, with the same pictures with and without
//! culling.
//!
//! Needs a Vulkan driver; Mesa's lavapipe, which draws on the processor, will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

#[path = "../examples/shared/mod.rs"]
mod shared;

use bevy::prelude::*;
use bevy_foveal_cull::CpuOcclusionStats;
use shared::headless::Headless;
use shared::level::Level;
use shared::modes::Mode;
use shared::paths::longest_walk;
use shared::place::Place;
use shared::twice::pixels_that_differ;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;

/// Centres and sizes of the boxes of two rooms with a passage, and of things in them.
fn boxes() -> Vec<(Vec3, Vec3)> {
    let mut boxes = vec![
        (Vec3::new(0.0, -0.1, 0.0), Vec3::new(20.4, 0.2, 10.4)),
        (Vec3::new(0.0, 3.1, 0.0), Vec3::new(20.4, 0.2, 10.4)),
        (Vec3::new(0.0, 1.5, -5.1), Vec3::new(20.3, 3.3, 0.2)),
        (Vec3::new(0.0, 1.5, 5.1), Vec3::new(20.3, 3.3, 0.2)),
        (Vec3::new(-10.1, 1.5, 0.0), Vec3::new(0.2, 3.2, 10.3)),
        (Vec3::new(10.1, 1.5, 0.0), Vec3::new(0.2, 3.2, 10.3)),
        // Between the rooms, with a passage at one end.
        (Vec3::new(0.0, 1.5, -1.5), Vec3::new(0.3, 3.1, 7.1)),
    ];
    for i in 0..40 {
        let (column, row) = ((i % 10) as f32, (i / 10) as f32);
        let at = Vec3::new(column * 1.9 - 8.7, 0.15, row * 1.1 - 4.2);
        boxes.push((at, Vec3::splat(0.3)));
    }
    boxes
}

/// The boxes as the bytes of a binary glTF file.
fn glb(boxes: &[(Vec3, Vec3)]) -> Vec<u8> {
    let mut binary = Vec::new();
    for i in 0..8_u8 {
        for bit in 0..3 {
            let at = f32::from(i >> bit & 1) - 0.5;
            binary.extend(at.to_le_bytes());
        }
    }
    const FACES: [[u16; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    for [a, b, c, d] in FACES {
        for index in [a, b, c, a, c, d] {
            binary.extend(index.to_le_bytes());
        }
    }
    let (mut nodes, mut roots) = (String::new(), String::new());
    for (i, (at, size)) in boxes.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        write!(
            nodes,
            r#"{comma}{{"mesh":0,"translation":{:?},"scale":{:?}}}"#,
            at.to_array(),
            size.to_array()
        )
        .unwrap();
        write!(roots, "{comma}{i}").unwrap();
    }
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{roots}]}}],
        "nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[
        {{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",
        "min":[-0.5,-0.5,-0.5],"max":[0.5,0.5,0.5]}},
        {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":96}},
        {{"buffer":0,"byteOffset":96,"byteLength":72}}],
        "buffers":[{{"byteLength":168}}]}}"#
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let mut put = |n: usize| file.extend(u32::try_from(n).unwrap().to_le_bytes());
    put(2);
    put(28 + json.len() + binary.len());
    put(json.len());
    file.extend(b"JSON");
    file.extend(&json);
    file.extend(u32::try_from(binary.len()).unwrap().to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&binary);
    file
}

fn save(name: &str, boxes: &[(Vec3, Vec3)]) -> PathBuf {
    let file = std::env::temp_dir().join(format!("{}-{name}.glb", std::process::id()));
    std::fs::write(&file, glb(boxes)).unwrap();
    file
}

#[test]
fn pictures_of_a_walk_through_a_level_are_the_same_with_and_without_culling() {
    let file = save("rooms", &boxes());
    let size = UVec2::new(160, 90);
    let mut length = 0.0;
    let [mut plain, mut culled] = [Mode::Frustum, Mode::All].map(|mode| {
        let mut level = Level::open(&file, 1);
        let mut app = Headless::new(size, Msaa::Off, |world| level.spawn(world));
        while !level.is_ready(app.world()) {
            app.frame();
        }
        mode.set(app.world());
        length = level.length();
        (app, level)
    });
    std::fs::remove_file(&file).unwrap();
    assert!(length > 15.0, "into the other room: {length}");
    let mut sum = CpuOcclusionStats::default();
    for frame in 0..30 {
        for (app, level) in [&mut plain, &mut culled] {
            let camera = app.camera;
            let pose = level.walker(length * frame as f32 / 30.0);
            *app.world().get_mut::<Transform>(camera).unwrap() = pose;
            for _ in 0..if frame == 0 { 5 } else { 1 } {
                app.frame();
            }
        }
        let (a, b) = (plain.0.picture(), culled.0.picture());
        assert!(a.iter().any(|&byte| byte != a[0]), "there is a picture");
        assert_eq!(pixels_that_differ(&a, &b), 0, "frame {frame}");
        let stats = culled.0.world().resource::<CpuOcclusionStats>();
        sum.meshes_hidden += stats.meshes_hidden;
        sum.casters_hidden += stats.casters_hidden;
        sum.casters_unseen += stats.casters_unseen;
    }
    assert!(sum.meshes_hidden > 0 && sum.casters_hidden + sum.casters_unseen > 0);
}

#[test]
fn the_longest_walk_leads_through_the_passage_at_eye_height() {
    let triangles: Vec<[Vec3; 3]> = boxes()
        .into_iter()
        .flat_map(|(at, size)| {
            let mesh = Cuboid::from_size(size).mesh().build();
            let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
            let positions = positions.as_float3().unwrap().to_vec();
            let indices: Vec<usize> = mesh.indices().unwrap().iter().collect();
            let corners = indices.as_chunks::<3>().0.to_vec();
            corners
                .into_iter()
                .map(move |c| c.map(|i| at + Vec3::from(positions[i])))
        })
        .collect();
    let walk = longest_walk(&triangles);
    let side = |x: f32| walk.iter().any(|eye| (eye.x - x).abs() < 2.0);
    assert!(side(-8.0) && side(8.0), "both rooms");
    for eye in &walk {
        assert!(eye.y > 1.5 && eye.y < 2.2, "{eye}");
        let in_wall = eye.x.abs() < 0.15 && eye.z < 2.0;
        assert!(!in_wall, "{eye}");
    }
    assert_eq!(longest_walk(&[]).len(), 0);
}

#[test]
fn a_missing_file_is_named() {
    // The example is beside the test's own folder.
    let test = std::env::current_exe().unwrap();
    let example = test.parent().unwrap().join("../examples/level");
    if !example.exists() {
        // `cargo test` builds it, `cargo test --test level` does not.
        return;
    }
    let said = Command::new(example)
        .args(["no-such-level.glb", "--frames", "1"])
        .output()
        .unwrap();
    let error = String::from_utf8(said.stderr).unwrap();
    assert!(error.contains("no-such-level.glb"), "{error}");
    assert_eq!(said.status.code(), Some(1));
}
