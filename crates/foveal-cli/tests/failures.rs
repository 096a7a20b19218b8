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
