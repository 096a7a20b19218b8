//! Material libraries, and what they name.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{HOUSE, HOUSE_MTL, load};
use crate::{Code, LoadOptions, load_bytes};

#[test]
fn a_library_is_read_once_however_often_a_line_names_it() {
    let read = AtomicUsize::new(0);
    let resolver = |name: &str| match name {
        "house.mtl" => {
            read.fetch_add(1, Ordering::Relaxed);
            Ok(HOUSE_MTL.as_bytes().to_vec())
        }
        _ => Err("no such file".to_owned()),
    };
    let many = "house.mtl ".repeat(1000);
    let text = HOUSE.replace("house.mtl", &many);
    let scene = load_bytes(text.as_bytes(), "a.obj", &LoadOptions::default(), &resolver).unwrap();
    assert_eq!(read.into_inner(), 1);
    assert_eq!(scene.materials.len(), 2);
}

#[test]
fn libraries_beyond_the_sixty_fourth_of_a_line_are_not_read() {
    let names: Vec<String> = (0..70).map(|i| format!("{i}.mtl")).collect();
    let beside: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
    let text = HOUSE.replace("house.mtl", &names.join(" "));
    let scene = load("a.obj", text.as_bytes(), &beside).unwrap();
    assert_eq!(scene.triangle_count(), 3);
    let warning = &scene.warnings[0];
    let sentence = "mtllib: names more than 64 material libraries";
    assert_eq!(
        (warning.code, &*warning.text),
        (Code::MaterialUnreadable, sentence)
    );
}

#[test]
fn a_library_that_is_missing_hides_none_of_its_line() {
    let line = |names: &str| {
        let text = HOUSE.replace("house.mtl", names);
        load(
            "a.obj",
            text.as_bytes(),
            &[("house.mtl", "newmtl brick\nnewmtl glass\n")],
        )
        .unwrap()
    };
    for names in ["a.mtl house.mtl b.mtl", "house.mtl a.mtl b.mtl"] {
        let scene = line(names);
        assert_eq!(scene.materials.len(), 2, "{names}");
        let told: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
        let sentence = |name: &str| format!("mtllib: \"{name}\" cannot be read: there is none");
        assert_eq!(told, ["a.mtl", "b.mtl"].map(sentence), "{names}");
    }
    // Of which nothing is there may be one name.
    let scene = line("my home.mtl");
    let sentence = "mtllib: \"my home.mtl\" cannot be read: there is none";
    assert_eq!(scene.warnings[0].text, sentence);
}

#[test]
fn libraries_that_are_missing_count_among_the_sixty_four() {
    let asked = AtomicUsize::new(0);
    let resolver = |_: &str| {
        asked.fetch_add(1, Ordering::Relaxed);
        Err("no such file".to_owned())
    };
    let names: String = (0..1000).map(|i| format!("{i}.mtl ")).collect();
    let text = HOUSE.replace("house.mtl", &names);
    load_bytes(text.as_bytes(), "a.obj", &LoadOptions::default(), &resolver).unwrap();
    // The line as a whole may be a name as well.
    assert_eq!(asked.into_inner(), 1 + 64);
}

/// Files that are asked for where a library in a folder names a picture.
fn asked_for(picture: &str, in_folder: bool) -> Vec<String> {
    let asked = Mutex::new(Vec::new());
    let library = HOUSE_MTL.replace("brick.png", picture);
    let resolver = |name: &str| {
        asked.lock().unwrap().push(name.to_owned());
        match name {
            "sub/house.mtl" => Ok(library.clone().into_bytes()),
            "sub/wood.png" if in_folder => Ok(b"no picture".to_vec()),
            _ => Err("no such file".to_owned()),
        }
    };
    let text = HOUSE.replace("house.mtl", "sub\\house.mtl");
    load_bytes(text.as_bytes(), "a.obj", &LoadOptions::default(), &resolver).unwrap();
    asked.into_inner().unwrap()
}

#[test]
fn pictures_are_looked_for_beside_their_library_and_then_beside_the_scene() {
    let library = "sub/house.mtl";
    assert_eq!(asked_for("wood.png", true), [library, "sub/wood.png"]);
    assert_eq!(
        asked_for("wood.png", false),
        [library, "sub/wood.png", "wood.png"]
    );
    assert_eq!(
        asked_for("/wood.png", false),
        [library, "/wood.png", "sub/wood.png", "wood.png"]
    );
}

#[test]
fn a_library_may_stand_in_quotes_or_name_folders_of_another_machine() {
    let material = "newmtl brick\nKd 1 0 0\nnewmtl glass\n";
    for name in [
        "\"my house.mtl\"",
        "C:\\Users\\me\\my house.mtl",
        "\"/home/me/my house.mtl\" # mine",
        "models/my house.mtl",
    ] {
        let text = HOUSE.replace("house.mtl", name);
        let scene = load("a.obj", text.as_bytes(), &[("my house.mtl", material)]).unwrap();
        assert_eq!(scene.warnings, [], "{name}");
        assert_eq!(scene.materials[0].base_color.to_array(), [1., 0., 0., 1.]);
    }
    let text = HOUSE.replace("house.mtl", "\"a.mtl\" \"b.mtl\"");
    let beside = [("a.mtl", "newmtl glass\n"), ("b.mtl", "newmtl brick\n")];
    let scene = load("house.obj", text.as_bytes(), &beside).unwrap();
    assert_eq!(scene.warnings, []);
}

#[test]
fn the_library_of_the_files_own_name_has_what_others_lack() {
    let beside = [
        ("a.mtl", "newmtl brick\nKd 1 0 0\n"),
        ("other.mtl", "newmtl glass\n"),
    ];
    let with = |library: &str| {
        let text = HOUSE.replace("house.mtl", library);
        let scene = load("models/a.obj", text.as_bytes(), &beside).unwrap();
        assert!(scene.materials.iter().any(|m| m.name == "brick"));
        scene.warnings.len()
    };
    assert_eq!(with("other.mtl"), 0);
    // The library that is named, and the material that neither has.
    assert_eq!(with("house.mtl"), 2);
}

#[test]
fn a_picture_may_stand_in_quotes_before_a_comment_or_in_folders_of_another_machine() {
    for name in [
        "\"brick.png\"",
        "brick.png # red",
        "C:\\Users\\me\\brick.png",
        "C:\\\\Users\\\\me\\\\brick.png",
        "-s 1 1 1 /home/me/brick.png",
        "..\\textures\\brick.png",
    ] {
        let material = HOUSE_MTL.replace("brick.png", name);
        let beside = [("house.mtl", &*material), ("brick.png", "no picture")];
        let scene = load("a.obj", HOUSE.as_bytes(), &beside).unwrap();
        let said: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
        // It is found, and none.
        assert!(said[0].starts_with("material glass"), "{said:?}");
        assert!(!said[1].contains("there is none"), "{name}: {said:?}");
    }
}

#[test]
fn opacity_with_a_halo_is_opacity() {
    let opacity = |line: &str| {
        let library = HOUSE_MTL.replace("Tr 0.5", line);
        let scene = load("a.obj", HOUSE.as_bytes(), &[("house.mtl", &library)]).unwrap();
        let glass = scene.materials.iter().find(|m| m.name == "glass");
        glass.unwrap().base_color.w
    };
    assert_eq!([opacity("d 0.25"), opacity("d -halo 0.25")], [0.25; 2]);
}
