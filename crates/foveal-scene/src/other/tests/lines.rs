//! Lines that are joined, and what stands around them.

use super::load;
use crate::{LoadOptions, load_bytes};

#[test]
fn a_comment_that_ends_in_a_backslash_leaves_the_next_line_alone() {
    let text = "# from C:\\models\\\nv 0 0 0 # C:\\\nv 1 0 0\nv 0 1 \\\n0\nf 1 2 3\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(scene.bounds().max.to_array(), [1.0, 1.0, 0.0]);
}

#[test]
fn millions_of_joined_lines_are_read_once_each() {
    // A time that grows with the square of the lines would be hours.
    let joined = "\\\n".repeat(2 << 20);
    let text = format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nl 1 {joined}2\nusemtl red\nl 2 1\n");
    let material = format!("newmtl red\nKd 1 {joined}0 0\n");
    let scene = load("a.obj", text.as_bytes(), &[("a.mtl", &material)]).unwrap();
    assert_eq!((scene.line_count(), scene.warnings.len()), (2, 0));
}

#[test]
fn a_byte_order_mark_before_the_first_line_is_no_part_of_it() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\nusemtl red\nf 1 2 3\n";
    let material = "newmtl red\nKd 1 0 0\n";
    let with = |mark: &str| {
        let text = format!("{mark}{text}");
        let material = format!("{mark}{material}");
        load("a.obj", text.as_bytes(), &[("a.mtl", &material)]).unwrap()
    };
    let (plain, marked) = (with(""), with("\u{feff}"));
    assert_eq!(marked.warnings, []);
    assert_eq!(marked.meshes, plain.meshes);
    assert_eq!(marked.materials, plain.materials);
}

#[test]
fn a_comment_behind_a_name_is_no_part_of_it() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let text = format!(
        "mtllib a.mtl # by hand\n{corners}o roof\t# in the west\nusemtl red # tiles\nf 1 2 3\n\
         usemtl Material #25\nf 1 2 3\nusemtl # none\nf 1 2 3\n"
    );
    let material = "newmtl red # as bricks\nnewmtl Material #25\n";
    let scene = load("a.obj", text.as_bytes(), &[("a.mtl", material)]).unwrap();
    assert_eq!(scene.warnings, []);
    assert!(scene.objects.iter().all(|o| o.name == "roof"));
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names[..2], ["red", "Material #25"]);
}

#[test]
fn lines_may_end_in_a_carriage_return_alone() {
    let text = "# by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\nusemtl red\nf 1 \\\n2 3\n";
    let material = "newmtl red\nKd 1 0 0\n";
    for end in ["\n", "\r\n", "\r"] {
        let [text, material] = [text, material].map(|t| t.replace('\n', end));
        let scene = load("a.obj", text.as_bytes(), &[("a.mtl", &material)]).unwrap();
        assert_eq!(scene.triangle_count(), 1);
        assert_eq!(scene.materials[0].base_color.to_array(), [1., 0., 0., 1.]);
        let wrong = text.replace("0 1 0", "0 x 0");
        let said = load("a.obj", wrong.as_bytes(), &[])
            .unwrap_err()
            .to_string();
        assert!(said.ends_with("line 4: \"x\" is not a number"), "{said}");
    }
}

#[test]
fn text_may_be_utf_16_with_a_byte_order_mark() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\no Dächer 🏠\nusemtl red\nf 1 2 3\n";
    let material = "newmtl red\nKd 1 0 0\n";
    let read = |encode: &dyn Fn(&str) -> Vec<u8>| {
        let library = encode(material);
        let resolver = |_: &str| Ok(library.clone());
        load_bytes(&encode(text), "a.obj", &LoadOptions::default(), &resolver)
    };
    let plain = read(&|text| text.as_bytes().to_vec()).unwrap();
    assert_eq!(plain.objects[0].name, "Dächer 🏠");
    for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let encode = |mark: &str, text: &str| -> Vec<u8> {
            let text = format!("{mark}{text}");
            text.encode_utf16().flat_map(to_bytes).collect()
        };
        let scene = read(&|text| encode("\u{feff}", text)).unwrap();
        assert_eq!(scene.warnings, []);
        assert_eq!(scene.meshes, plain.meshes);
        assert_eq!(scene.materials, plain.materials);
        assert_eq!(scene.objects, plain.objects);
        let error = read(&|text| encode("", text)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a.obj is not OBJ: has bytes of 0: it is no text, or UTF-16 without a byte order mark"
        );
    }
}
