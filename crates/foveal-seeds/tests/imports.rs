//! The order of the crate's rooms.
#![allow(clippy::unwrap_used, reason = "tests")]

#[test]
fn no_files_import_each_other_in_a_circle() {
    let circles = foveal_imports::circles(env!("CARGO_MANIFEST_DIR")).unwrap();
    let told: String = circles.iter().map(|c| format!("{c}\n")).collect();
    assert!(circles.is_empty(), "{told}");
}
