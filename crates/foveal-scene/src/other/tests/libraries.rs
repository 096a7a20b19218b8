//! Material libraries, and what they name.

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
