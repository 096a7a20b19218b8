//! Numbers as programs write them.

use super::load;

#[test]
fn what_c_writes_for_nan_is_a_number() {
    // A normal without a direction is made anew, a vertex at no place takes its triangles along.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -nan(ind) 0 0\nvn nan(0x8000) -nan(ind) -NaN\n\
                f 1//1 2//1 3//1\nf 2 3 4\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let vertices = &scene.meshes[0].vertices;
    assert!(vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]));
}

#[test]
fn numbers_of_vertices_beyond_all_integers_name_none() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\nf 1 2 -99999999999999999999\n\
                f 1/9999999999999999999 2 3\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let said = &scene.warnings[0].text;
    assert!(said.starts_with("2 of 3 faces"), "{said}");
}

#[test]
fn a_colour_is_what_follows_the_place() {
    let color = |rest: &str| {
        let text = format!("v 0 0 0 {rest}\nv 1 0 0 {rest}\nv 0 1 0 {rest}\nf 1 2 3\n");
        let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
        scene.meshes[0].vertices[0].color
    };
    let red = [u16::MAX, 0, 0, u16::MAX];
    assert_eq!(
        [color("1 0 0"), color("1 0 0 1"), color("1 0 0 0.5")],
        [red; 3]
    );
    assert_eq!(color("1"), [u16::MAX; 4]);
}

#[test]
fn colours_of_a_ply_file_may_have_names_of_one_letter() {
    let file = |names: &str, values: &str| {
        let names: Vec<&str> = names.split(' ').collect();
        let lines: String = (names.iter())
            .map(|name| format!("property uchar {name}\n"))
            .collect();
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n{lines}end_header\n1 {values}\n"
        );
        let scene = load("points.ply", text.as_bytes(), &[]).unwrap();
        assert_eq!(scene.warnings, []);
        scene.meshes[0].vertices[0].color
    };
    let (red, white) = ([u16::MAX, 0, 0, u16::MAX], [u16::MAX; 4]);
    assert_eq!(file("r g b", "255 0 0"), red);
    // A radius is no colour.
    assert_eq!(file("r", "7"), white);
    assert_eq!(file("red green blue r g b", "255 0 0 7 7 7"), red);
    assert_eq!(file("r g b red green blue", "7 7 7 255 0 0"), red);
}
