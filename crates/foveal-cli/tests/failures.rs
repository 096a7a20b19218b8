//! What fails says so in one paragraph that names file, place and cause, and leaves nothing behind.

mod common;

use common::{fail, folder, moving_triangle, names};

#[test]
fn what_is_wrong_with_the_scene_is_named() {
    let folder = folder();
    std::fs::write(folder.path().join("broken.glb"), "glTF").unwrap();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let here = folder.path();
    fail(
        here,
        &["render", "missing.glb", "-o", "a.png"],
        &["missing.glb", "cornell"],
    );
    fail(
        here,
        &["render", "broken.glb", "-o", "a.png"],
        &["broken.glb"],
    );
    fail(
        here,
        &["render", "folder", "-o", "a.png"],
        &["folder", "directory"],
    );
    fail(here, &["render", "demo:7", "-o", "a.png"], &["1000"]);
    fail(
        here,
        &["render", "cornell", "-o", "a.png", "--clip", "7"],
        &["cornell", "clips"],
    );
    fail(here, &["scene", "info", "broken.glb"], &["broken.glb"]);
    assert_eq!(names(here), ["broken.glb", "folder"]);
}

#[test]
fn an_impossible_size_names_the_limit() {
    let folder = folder();
    fail(
        folder.path(),
        &["render", "cornell", "-o", "a.png", "--size", "0x0"],
        &["0", "at least 1"],
    );
    let size = [
        "render",
        "cornell",
        "-o",
        "a.png",
        "--size",
        "1000000x1000000",
    ];
    fail(folder.path(), &size, &["1000000", "limit"]);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_place_that_cannot_be_written_is_found_before_any_work() {
    let folder = folder();
    let here = folder.path();
    // The scene does not exist: were it looked for first, the message would be about it.
    fail(
        here,
        &["render", "missing.glb", "-o", "no/a.png"],
        &["no/a.png", "does not exist"],
    );
    fail(
        here,
        &[
            "render",
            "missing.glb",
            "-o",
            "a.png",
            "--stats",
            "no/a.json",
        ],
        &["no/a.json"],
    );
    std::fs::create_dir(here.join("b.png")).unwrap();
    fail(
        here,
        &["render", "missing.glb", "-o", "b.png"],
        &["b.png", "is a folder"],
    );
    assert_eq!(names(here), ["b.png"]);
}

#[cfg(unix)]
#[test]
fn a_device_is_not_overwritten() {
    let folder = folder();
    std::os::unix::fs::symlink("/dev/null", folder.path().join("null.png")).unwrap();
    fail(
        folder.path(),
        &["render", "cornell", "-o", "null.png"],
        &["null.png", "not a regular file"],
    );
}

#[test]
fn an_unknown_camera_lists_those_that_there_are() {
    let folder = folder();
    moving_triangle(folder.path());
    let words = [
        "render",
        "triangle.gltf",
        "-o",
        "a.png",
        "--camera",
        "cellar",
    ];
    fail(
        folder.path(),
        &words,
        &["'cellar'", "'front'", "triangle.gltf"],
    );
}

#[test]
fn an_unknown_adapter_lists_those_that_there_are() {
    let folder = folder();
    let words = ["render", "cornell", "-o", "a.png", "--adapter", "abacus"];
    fail(folder.path(), &words, &["'abacus'", "0: "]);
}

#[test]
fn a_wrong_settings_file_is_named_with_line_and_key() {
    let folder = folder();
    std::fs::write(
        folder.path().join("s.toml"),
        "width = 64\nlighting = \"candle\"\n",
    )
    .unwrap();
    let words = ["render", "cornell", "-o", "a.png", "--settings", "s.toml"];
    fail(
        folder.path(),
        &words,
        &["s.toml", "line 2", "lighting", "candle", "blinn-phong"],
    );
    let words = [
        "render",
        "cornell",
        "-o",
        "a.png",
        "--settings",
        "none.toml",
    ];
    fail(folder.path(), &words, &["none.toml"]);
}

#[test]
fn a_wrong_camera_path_is_named_with_its_place() {
    let folder = folder();
    std::fs::write(
        folder.path().join("p.json"),
        r#"[{"eye": [0, 0, 1], "target": [0, 0, 1]}]"#,
    )
    .unwrap();
    let words = ["render", "cornell", "-o", "a.png", "--path", "p.json"];
    fail(
        folder.path(),
        &words,
        &["p.json", "keyframe 0", "same point"],
    );
}

#[test]
fn without_a_vulkan_driver_the_message_says_so() {
    let folder = folder();
    let mut command = common::command(folder.path(), &["render", "cornell", "-o", "a.png"]);
    let nowhere = folder.path().join("none.json");
    command
        .env("VK_DRIVER_FILES", &nowhere)
        .env("VK_ICD_FILENAMES", &nowhere)
        .env_remove("WGPU_BACKEND");
    let output = command.output().unwrap();
    let said = common::stderr(&output);
    // With OpenGL there is a picture, and a word on what is missing; without, an error. Systems may
    // have drivers that these variables do not hide.
    if output.status.code() == Some(0) {
        let is_gl = said.contains("through OpenGL alone");
        assert!(is_gl == said.contains("(gl)"), "{said}");
        assert!(folder.path().join("a.png").exists());
        assert_eq!(common::stderr(&command.arg("-q").output().unwrap()), "");
        return;
    }
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("install a Vulkan driver"), "{said}");
}

#[test]
fn control_characters_of_a_file_never_reach_the_terminal() {
    let folder = folder();
    moving_triangle(folder.path());
    let path = folder.path().join("triangle.gltf");
    let text = std::fs::read_to_string(&path).unwrap();
    let hostile = text
        .replace("\"front\"", r#""a\u001b[2J\u009b1m\u202eb\nc""#)
        .replace("\"mode\"", "\"x\"")
        .replace(
            "\"asset\"",
            "\"extensionsUsed\": [\"\\u001bACME\"], \"asset\"",
        );
    std::fs::write(&path, hostile).unwrap();
    for words in [
        &["scene", "info", "triangle.gltf"][..],
        &["scene", "info", "triangle.gltf", "--json"],
        &["cull", "triangle.gltf", "--frames", "1"],
        &["render", "triangle.gltf", "-o", "a.png", "--camera", "none"],
    ] {
        let output = common::foveal_in(folder.path(), words);
        let said = common::stdout(&output) + &common::stderr(&output);
        let bad = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!said.contains(bad), "{words:?}: {said:?}");
        assert!(said.contains("\\u001b"), "{words:?}: {said:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_stderr_changes_no_exit_code() {
    let folder = folder();
    for (words, code) in [
        (&["scene", "info", "nothing"][..], 1),
        (&["render", "cornell", "--size", "16x9", "-o", "a.png"], 0),
        (&["render", "cornell", "-o", "a.txt"], 2),
    ] {
        let full = std::fs::File::create("/dev/full").unwrap();
        let mut command = common::command(folder.path(), words);
        let status = command.stderr(full).status().unwrap();
        assert_eq!(status.code(), Some(code), "{words:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn files_without_an_end_are_refused() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo")
        .arg(folder.path().join("pipe.png"))
        .status();
    assert!(made.is_ok_and(|status| status.success()), "mkfifo");
    let render = ["render", "cornell", "-o", "a.png"];
    for (flags, cause) in [
        (&["--settings", "/dev/zero"][..], "64 MiB"),
        (&["--path", "/dev/zero"], "64 MiB"),
        (
            &[
                "--shading",
                "coarse",
                "--rate",
                "image",
                "--rate-image",
                "pipe.png",
            ],
            "not a regular file",
        ),
    ] {
        fail(
            folder.path(),
            &[&render[..], flags].concat(),
            &[flags[flags.len() - 1], cause],
        );
    }
    fail(
        folder.path(),
        &["compare", "pipe.png", "pipe.png"],
        &["pipe.png", "not a regular file"],
    );
    fail(
        folder.path(),
        &["bench", "diff", "/dev/zero", "/dev/zero"],
        &["/dev/zero", "64 MiB"],
    );
}

#[test]
fn a_picture_and_its_stats_need_two_files_however_they_are_written() {
    let folder = folder();
    let words = ["render", "cornell", "-o", "a.png", "--stats", "./a.png"];
    let output = common::foveal_in(folder.path(), &words);
    assert_eq!(output.status.code(), Some(2));
    assert!(common::stderr(&output).contains("the same file"));
}

#[test]
fn small_files_that_ask_for_much_end_with_the_flag_that_allows_it() {
    let folder = folder();
    moving_triangle(folder.path());
    let path = folder.path().join("triangle.gltf");
    let mut json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    json["accessors"][0]["count"] = 2_000_000.into();
    json["accessors"][0]
        .as_object_mut()
        .unwrap()
        .remove("bufferView");
    std::fs::write(&path, json.to_string()).unwrap();
    fail(
        folder.path(),
        &["scene", "info", "triangle.gltf"],
        &["wants", "the limit", ": --max-expansion"],
    );
    let lights = ["render", "-o", "a.png", "--point-lights", "4294967295"];
    let output = common::foveal_in(folder.path(), &lights);
    assert_eq!(output.status.code(), Some(2));
    assert!(common::stderr(&output).contains("16384"));
}

/// A recording in which every query follows a draw of its own.
#[test]
fn a_long_recording_is_replayed_as_few_cameras() {
    let folder = folder();
    let mut bytes = 0xA701_B600_u32.to_le_bytes().to_vec();
    let floats = |bytes: &mut Vec<u8>, values: &[f32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    let words = |bytes: &mut Vec<u8>, values: &[u32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    floats(&mut bytes, &[0.1]);
    words(&mut bytes, &[64, 64]);
    for i in 0..3000 {
        let x = i as f32 * 1e-4 - 0.5;
        bytes.push(0);
        words(&mut bytes, &[0, 3, 12]);
        floats(&mut bytes, &[x, 0.0, 1.0, x + 0.1, 0.0, 1.0, x, 0.1, 1.0]);
        words(&mut bytes, &[1, 0, 1, 2]);
        bytes.push(0);
        words(&mut bytes, &[0, 0, 12, 4, 8]);
        bytes.push(1);
        words(&mut bytes, &[0]);
        floats(&mut bytes, &[-0.5, -0.5, 0.5, 0.5, 2.0]);
    }
    bytes.push(0x7F);
    std::fs::write(folder.path().join("long.mocrec"), bytes).unwrap();
    let words = ["cull", "long.mocrec", "--frames", "1"];
    let said = common::stdout(&common::succeed(folder.path(), &words));
    assert_eq!(said.matches("camera 'recorded").count(), 16, "{said}");
}

#[test]
fn benches_say_what_is_wrong_with_a_scene() {
    let folder = folder();
    let scene = "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("a.obj"), scene).unwrap();
    for words in [
        "culling a.obj --repetitions 1 --sizes 8x8 --boxes 1 --threads 1",
        "culling-frames a.obj --size 8x8 --rounds 1",
    ] {
        let words: Vec<&str> = ["bench"].into_iter().chain(words.split(' ')).collect();
        let said = common::stderr(&common::succeed(folder.path(), &words));
        assert!(said.starts_with("warning: mtllib: \"none.mtl\""), "{said}");
    }
}

#[test]
fn benches_read_scenes_within_the_limits_that_they_are_given() {
    let folder = folder();
    moving_triangle(folder.path());
    for bench in [
        "verdict",
        "culling",
        "culling-frames",
        "coarse",
        "eye",
        "antialiasing",
        "variable",
        "stereo cornell",
        "all --report r",
    ] {
        let line = format!("bench {bench} triangle.gltf --max-vertices 2");
        let words: Vec<&str> = line.split(' ').collect();
        fail(folder.path(), &words, &["triangle.gltf", "--max-vertices"]);
    }
    assert!(!folder.path().join("r").exists());
    // A clip is a file's own; a generated scene beside it has none.
    let line = "bench culling triangle.gltf cornell --max-vertices 3 --clip 0 --sizes 32x32 --boxes 5 \
                --repetitions 1 --quiet";
    let words: Vec<&str> = line.split_whitespace().collect();
    assert!(common::stdout(&common::succeed(folder.path(), &words)).contains("cornell"));
}
