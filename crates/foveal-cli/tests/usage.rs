//! Wrong usage is told apart from failure: exit code 2, and nothing is read, drawn or written.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod common;

use common::{folder, foveal_in, moving_triangle, names, stderr, stdout, succeed};

#[test]
fn wrong_words_are_usage_errors() {
    let lines = [
        "",
        "paint",
        "render",
        "render -o a.png --stereo sideways",
        "render -o a.png --view sideways",
        "render -o a.png --lighting phong",
        "render -o a.png --size 12",
        "render -o a.png --size -1x5",
        "render -o a.png --exposure nan",
        "render -o a.png --exposure inf",
        "render -o a.png --anisotropy 17",
        "render -o a.png --fov 180",
        "render -o a.png --fov 0",
        "render -o a.png --time -1",
        "render -o a.png --fps 0",
        "render -o a.png --point-lights -3",
        "render -o a.png --eye 1,2 --target 0,0,0",
        "render -o a.png --eye 1,2,nan --target 0,0,0",
        "render -o a_#.png --frames 5..5",
        "render -o a_#.png --frames 9..3",
        "compare a.png",
        "compare a.png b.png --max-flip -1",
        "compare a.png b.png --max-flip nan",
        "bench coarse cornell --pairs 0",
        "adapters now",
        "scene",
    ];
    let folder = folder();
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let output = foveal_in(folder.path(), &words);
        assert_eq!(
            output.status.code(),
            Some(2),
            "foveal {line}: {}",
            stderr(&output)
        );
        assert!(stdout(&output).is_empty(), "foveal {line}");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn words_that_contradict_each_other_are_usage_errors() {
    let lines = [
        ("render -o a.png --eye 1,2,3", "--target"),
        ("render -o a.png --target 1,2,3", "--eye"),
        ("render -o a.png --up 0,0,1", "--eye"),
        ("render -o a.png --eye 1,2,3 --target 1,2,3", "same point"),
        ("view --eye 1,2,3 --target 1,2,3", "same point"),
        ("bench verdict --eye 1,2,3 --target 1,2,3", "same point"),
        (
            "bench culling --scaling a.csv --max-vertices 9",
            "--scaling",
        ),
        ("bench culling --scaling a.csv --occluders all", "--scaling"),
        ("bench culling --scaling a.csv --threads 1", "--scaling"),
        ("bench stereo --eye 1,2,3 --target 0,0,0 --up 0,0,0", "--up"),
        (
            "render -o a.png --eye 1,2,3 --target 0,0,0 --up 0,0,0",
            "--up",
        ),
        (
            "render -o a.png --camera x --eye 1,2,3 --target 0,0,0",
            "--camera",
        ),
        ("render -o a.png --camera x --path demo", "--path"),
        (
            "render -o a.png --eye 1,2,3 --target 0,0,0 --path demo",
            "--path",
        ),
        ("render cornell -o a.png --path demo", "demo"),
        ("render -o a.png --frames 0..3", "####"),
        ("render -o a_#_#.png --frames 0..3", "several"),
        ("render -o a_#.png --frames 0..3 --time 1", "--time"),
        ("render -o a.png --skip-existing", "--frames"),
        ("render -o a.png --light-seed 4", "--point-lights"),
        ("render -o a.jpg", ".png"),
        ("render -o a.png -o flat --show headset", "--show"),
        ("render -o a.png --stats a.png", "same file"),
        (
            "render -o a_#.png --frames 0..3 --share --stats s.json",
            "--share",
        ),
        ("compare a.png b.png --fps 24", "--fps"),
        (
            "compare a.png b.png --diff x.png --heat-map ./x.png",
            "same file",
        ),
        ("compare a.png b.png --diff ./a.png", "is compared"),
        ("compare a.png b.png --heat-map b.png", "is compared"),
        ("compare a.png b.png --diff x.jpg", ".png"),
        ("compare a.png b.png --heat-map -", ".png"),
        ("bench diff a.json b.json --page ./b.json", "is compared"),
        ("bench all - --report r", "standard input"),
        ("bench stereo - cornell -", "standard input"),
        ("bench culling - -", "standard input"),
        ("render -o a.png --warmup 1000001", "1000000"),
        ("render -o a.png --time -1", "0 or later"),
        ("render -o a_#.png --frames 3 --fps -1", "greater than 0"),
        ("render -o a.png --fov -1", "between 0 and 180"),
        ("compare a.png b.png --max-flip -1", "0 or more"),
        ("compare a.png b.png --ambient -1", "0 or more"),
        ("bench verdict --json triangle.glb", "must end in .json"),
        ("bench culling --json triangle.glb", "must end in .json"),
        ("cull --depth a.png --overlay ./a.png", "same file"),
        ("cull --up 0,0,1", "--eye"),
        ("cull --eye 1,2,3 --target 0,0,0 --up 0,0,0", "--up"),
        ("cull --depth a.png --json ./a.png", "same file"),
    ];
    let folder = folder();
    for (line, cause) in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let output = foveal_in(folder.path(), &words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "foveal {line}: {said}");
        assert!(said.contains(cause), "foveal {line}: {said}");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn no_file_is_written_over_the_scene() {
    let folder = folder();
    let scene = moving_triangle(folder.path());
    let before = std::fs::read(&scene).unwrap();
    for line in [
        "render triangle.gltf -o a.png --stats ./triangle.gltf",
        "cull triangle.gltf --json triangle.gltf",
        "bench verdict triangle.gltf --json ./triangle.gltf",
        "bench stereo cornell triangle.gltf --json triangle.gltf",
        "bench culling cornell triangle.gltf --json triangle.gltf",
    ] {
        let words: Vec<&str> = line.split_whitespace().collect();
        let output = foveal_in(folder.path(), &words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "foveal {line}: {said}");
        assert!(said.contains("the scene's own file"), "{said}");
    }
    assert!(std::fs::read(&scene).unwrap() == before);
}

/// Names and bytes of a folder's files.
fn contents(folder: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| {
        let bytes = std::fs::read(folder.join(&name)).unwrap();
        (name, bytes)
    };
    names(folder).into_iter().map(read).collect()
}

#[test]
fn no_file_is_written_over_one_that_is_read() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "walk.json",
        r#"[{"eye": [0, 1, 3], "target": [0, 1, 0]}, {"eye": [1, 1, 3], "target": [0, 1, 0]}]"#,
    );
    write(
        "s.toml",
        "exposure = 1.0\nenvironment-image = \"sky.hdr\"\n",
    );
    for name in ["rate.png", "sky.hdr"] {
        write(name, "a picture");
    }
    let before = contents(folder.path());
    for line in [
        "render cornell -o a.png --path walk.json --stats ./walk.json",
        "render cornell -o a.png --settings s.toml --stats s.toml",
        "render cornell -o sky.hdr --settings s.toml",
        "render cornell -o rate.png --shading coarse --rate ./rate.png",
        "cull cornell --cameras walk.json --json walk.json",
        "bench culling cornell --cameras walk.json --json walk.json",
        "bench verdict cornell --path walk.json --json walk.json",
        "bench stereo cornell --path walk.json --json walk.json",
    ] {
        let words: Vec<&str> = line.split_whitespace().collect();
        let output = foveal_in(folder.path(), &words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "foveal {line}: {said}");
    }
    assert!(contents(folder.path()) == before);
}

#[test]
fn help_and_version_are_results() {
    let folder = folder();
    assert!(stdout(&succeed(folder.path(), &["--version"])).contains(env!("CARGO_PKG_VERSION")));
    for words in [
        &["--help"][..],
        &["render", "--help"],
        &["compare", "--help"],
        &["scene", "info", "--help"],
    ] {
        assert!(stdout(&succeed(folder.path(), words)).contains("Usage: foveal"));
    }
}
