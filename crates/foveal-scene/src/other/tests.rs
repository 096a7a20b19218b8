//! OBJ and PLY files made on the spot.

mod colors;
mod libraries;
mod lines;
mod numbers;
mod shapes;

use proptest::prelude::*;

use crate::{AlphaMode, Code, Limit, LoadOptions, Scene, SceneError, load_bytes};

fn load(name: &str, bytes: &[u8], beside: &[(&str, &str)]) -> Result<Scene, SceneError> {
    let resolver = |uri: &str| {
        let found = beside.iter().find(|(name, _)| *name == uri);
        let found = found.map(|(_, text)| text.as_bytes().to_vec());
        found.ok_or_else(|| format!("\"{uri}\" cannot be read: there is none"))
    };
    load_bytes(bytes, name, &LoadOptions::default(), &resolver)
}

const HOUSE: &str = "\
mtllib house.mtl
o wall
v 0 0 0
v 2 0 0
v 2 2 0
v 0 2 0
vt 0 0.25
vt 1 0.25
vt 1 1
vt 0 1
usemtl brick
f 1/1 2/2 3/3 4/4
o roof
v 0 2 0
v 2 2 0
v 1 3 0
usemtl glass
f -3 -2 -1
";

const HOUSE_MTL: &str = "\
newmtl brick
Kd 0.5 0.25 0.125
Ks 0 0 0
Ns 6
Ke 0 2 0
map_Kd brick.png
newmtl glass
Kd 1 1 1
Tr 0.5
Pm 1
Pr 0.25
map_d leaf.png
";

#[test]
fn an_obj_file_is_read_with_its_materials() {
    let scene = load("house.obj", HOUSE.as_bytes(), &[("house.mtl", HOUSE_MTL)]).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["wall", "roof"]);
    assert_eq!(scene.triangle_count(), 3);
    assert_eq!(scene.bounds().max.to_array(), [2.0, 3.0, 0.0]);
    let wall = &scene.meshes[scene.instances[0].mesh as usize];
    // Rows are counted from below in OBJ, from above in glTF.
    assert!(wall.vertices.iter().any(|v| v.uv[0] == [1.0, 0.75]));
    assert!(wall.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]));
    let [brick, glass] = [0, 1].map(|i| &scene.materials[scene.instances[i].material as usize]);
    assert_eq!(brick.base_color.to_array(), [0.5, 0.25, 0.125, 1.0]);
    assert_eq!((brick.metallic, brick.alpha_mode), (0.0, AlphaMode::Opaque));
    // sqrt(2 / (6 + 2)) = 1/2 is the square of glTF's roughness.
    assert!((brick.roughness - 0.5f32.sqrt()).abs() < 1e-6);
    assert_eq!(brick.emissive.to_array(), [0.0, 2.0, 0.0]);
    assert_eq!((glass.metallic, glass.roughness), (1.0, 0.25));
    assert_eq!(
        (glass.alpha_mode, glass.base_color.w),
        (AlphaMode::Blend, 0.5)
    );
    let sentence = "material glass: not read: map_d";
    let warning = &scene.warnings[0];
    assert_eq!(
        (warning.code, &*warning.text),
        (Code::MaterialIgnored, sentence)
    );
}

#[test]
fn a_material_without_a_name_is_none() {
    let text = HOUSE.replace("usemtl glass", "usemtl \r");
    let scene = load("house.obj", text.as_bytes(), &[("house.mtl", HOUSE_MTL)]).unwrap();
    assert_eq!(scene.triangle_count(), 3);
    let roof = &scene.materials[scene.instances[1].material as usize];
    assert_eq!(roof.base_color.to_array(), [1.0; 4]);
}

#[test]
fn what_exporters_write_is_understood() {
    // Comments, bytes of Latin-1, tabs, indents, lines joined, one texture coordinate, grey as one
    // number, a face that no vertex is left of, texture coordinates on some faces alone.
    let text =
        b"# Gr\xf6\xdfe\nmtllib\tm.mtl\n  v 0 0 0 # here\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5\n\
        usemtl\tred\nf 1/1 2/1 \\\n 3/1 # first\nf 1 3 4\nf\nf 1 2 9\n";
    let scene = load("a.obj", text, &[("m.mtl", "newmtl red\nKd 0.5\n")]).unwrap();
    assert_eq!(scene.triangle_count(), 2);
    let red = &scene.materials[scene.instances[0].material as usize];
    assert_eq!(red.base_color.to_array(), [0.5, 0.5, 0.5, 1.0]);
    let text = "2 of 4 faces, lines and points have too few corners or name vertices that do not exist, \
                and are left out";
    let texts: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
    assert_eq!(texts, [text]);
}

#[test]
fn faces_of_one_name_and_material_are_one_object() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
    let faces = "o a\nf 1//1 2//1 3//1\no b\nf 1 2 3\no a\nusemtl x\nusemtl\nf 3 2 1\n";
    let scene = load("a.obj", (corners.to_owned() + faces).as_bytes(), &[]).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    let codes: Vec<Code> = scene.warnings.iter().map(|w| w.code).collect();
    assert_eq!(codes, [Code::MaterialUnreadable, Code::Normals]);
}

#[test]
fn opacity_wins_over_transparency_and_nothing_is_wholly_transparent_by_it() {
    for (lines, opacity) in [
        ("Tr 1", 1.0),
        ("Tr 0.25", 0.75),
        ("Tr 1\nd 0.5", 0.5),
        ("d 0.5\nTr 0", 0.5),
    ] {
        let material = format!("newmtl brick\n{lines}\nnewmtl glass\n");
        let scene = load("house.obj", HOUSE.as_bytes(), &[("house.mtl", &material)]).unwrap();
        let brick = &scene.materials[scene.instances[0].material as usize];
        assert_eq!(brick.base_color.w, opacity, "{lines}");
    }
}

#[test]
fn scale_and_offset_of_a_map_are_kept() {
    let material = "newmtl brick\nmap_Kd -clamp on -s 2 3 1 -o 0.25 0.5 my wood.png\n";
    let scene = load("house.obj", HOUSE.as_bytes(), &[("house.mtl", material)]).unwrap();
    let brick = &scene.materials[scene.instances[0].material as usize];
    let texture = brick.base_color_texture.unwrap();
    // Of the vertex (u, 1 - v): 2 u + 0.25 and 1 - (3 v + 0.5).
    let uv = texture
        .uv_transform
        .transform_point2(glam::Vec2::new(0.5, 1.0 - 0.25));
    assert!(uv.abs_diff_eq(glam::Vec2::new(1.25, -0.25), 1e-6), "{uv}");
    let said = scene
        .warnings
        .iter()
        .any(|w| w.text.contains("\"my wood.png\""));
    assert!(said, "{:?}", scene.warnings);
}

#[test]
fn a_file_may_not_ask_for_more_than_it_is_worth() {
    let mut text = String::from("v 0 0 0\n");
    for i in 0..30_000 {
        text += &format!("o {i:x}\nf 1 1 1\n");
    }
    let error = load("a.obj", text.as_bytes(), &[]).unwrap_err();
    assert_eq!(error.code(), Code::LimitExceeded, "{error}");
    // A library that is named a thousand times is read once.
    let many = "mtllib house.mtl\n".repeat(1000) + HOUSE;
    let scene = load("a.obj", many.as_bytes(), &[("house.mtl", HOUSE_MTL)]).unwrap();
    assert_eq!(scene.materials.len(), 2);
    let options = LoadOptions {
        max_vertices: 3,
        ..LoadOptions::default()
    };
    let none = |_: &str| Err(String::new());
    let error = load_bytes(SQUARE.as_bytes(), "a.ply", &options, &none).unwrap_err();
    assert_eq!(error.limit(), Some(Limit::Vertices), "{error}");
    let long = SQUARE
        .replace("made by hand", &"x".repeat(5000))
        .replace("wood.png", &"x".repeat(5000));
    let error = load("a.ply", long.as_bytes(), &[]).unwrap_err();
    assert!(
        error.to_string().contains("its header has a line"),
        "{error}"
    );
}

#[test]
fn warnings_beyond_the_hundredth_are_counted_once() {
    let mut materials = String::new();
    let mut text = String::from("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for i in 0..150 {
        materials += &format!("newmtl m{i}\nmap_d a.png\n");
        text += &format!("usemtl m{i}\nf 1 2 3\n");
    }
    let scene = load("a.obj", text.as_bytes(), &[("m.mtl", &materials)]).unwrap();
    assert_eq!(scene.warnings.len(), 101);
    assert_eq!(scene.warnings[100].text, "50 more warnings are not listed");
}

#[test]
fn lines_and_points_of_an_obj_file_are_read() {
    let text =
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 5 5\nvt 0 0\nl 1/1 2 3/1 1\np 2 -1\nl 4\np 9\nl 1 9\n";
    let scene = load("a.obj", text, &[]).unwrap();
    let [lines, points] = &scene.meshes[..] else {
        panic!("{} meshes", scene.meshes.len());
    };
    let ends: Vec<[[f32; 3]; 2]> = (lines.lines.iter())
        .map(|ends| ends.map(|end| lines.vertices[end as usize].position))
        .collect();
    let [a, b, c] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]];
    assert_eq!(ends, [[a, b], [b, c], [c, a]]);
    let at = |&point: &u32| points.vertices[point as usize].position;
    let places: Vec<[f32; 3]> = points.points.iter().map(at).collect();
    assert_eq!(places, [b, [5.; 3]]);
    assert_eq!(scene.objects.len(), 1);
    assert_eq!((scene.line_count(), scene.point_count()), (3, 2));
    let sentence = "3 of 6 faces, lines and points have too few corners or name vertices that do not exist, \
                    and are left out";
    assert_eq!(scene.warnings[0].text, sentence);
}

#[test]
fn curves_are_a_warning() {
    let scene = load("a.obj", b"v 0 0 0\ncurv 0 1 1\n", &[]).unwrap();
    assert_eq!(scene.warnings[0].code, Code::PrimitiveMode);
}

#[test]
fn a_missing_material_file_is_a_warning() {
    let scene = load("house.OBJ", HOUSE.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 3);
    let sentence = "mtllib: \"house.mtl\" cannot be read: there is none";
    assert_eq!(scene.warnings[0].text, sentence);
    assert_eq!(scene.warnings[0].code, Code::MaterialUnreadable);
}

#[test]
fn pictures_of_an_obj_file_are_looked_for_beside_it() {
    let material = "newmtl brick\nKd 0 0 0\nmap_Kd wood\\#1.png\nnewmtl glass\n";
    let scene = load("house.obj", HOUSE.as_bytes(), &[("house.mtl", material)]).unwrap();
    let brick = &scene.materials[scene.instances[0].material as usize];
    assert!(brick.base_color_texture.is_some());
    assert_eq!(brick.base_color.to_array(), [1.0; 4]);
    let text = &scene.warnings[0].text;
    assert!(text.contains("\"wood/#1.png\" cannot be read"), "{text}");
}

const SQUARE: &str = "\
ply
format ascii 1.0
comment TextureFile wood.png
element vertex 4
property float x
property float y
property double z
property uchar red
property uchar green
property uchar blue
property float s
property float t
element face 2
property list uchar int vertex_indices
end_header
0 0 0 255 0 188 0 0
1 0 0 255 0 188 1 0
1 1 0 255 0 188 1 1
0 1 0 255 0 188 0 1
4 0 1 2 3
3 0 1 9
";

#[test]
fn a_ply_file_is_read_with_colours_and_texture_coordinates() {
    let scene = load("square.ply", SQUARE.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 2);
    let vertices = &scene.meshes[0].vertices;
    let corner = vertices.iter().find(|v| v.position == [1.0, 1.0, 0.0]);
    let corner = corner.unwrap();
    assert_eq!(corner.uv[0], [1.0, 0.0]);
    assert_eq!(corner.normal, [0.0, 0.0, 1.0]);
    let [red, green, blue, _] = corner.color;
    assert_eq!((red, green), (u16::MAX, 0));
    // IEC 61966-2-1: 188 of 255 is 0.5029 of the light.
    assert!(blue.abs_diff(32_957) <= 2, "{blue}");
    let text = "1 of 2 faces have fewer than three corners or name vertices that do not exist, and are left out";
    assert_eq!(scene.warnings[0].text, text);
}

/// The square without colours in binary.
fn binary(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut out = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement junk 1\nproperty list uchar uchar x\nelement face 1\n\
         property list uchar uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut word = |bits: u32| {
        out.extend(if big_endian {
            bits.to_be_bytes()
        } else {
            bits.to_le_bytes()
        });
    };
    for x in [0.0f32, 0., 0., 1., 0., 0., 0., 1., 0.] {
        word(x.to_bits());
    }
    out.extend([2, 7, 7, 3]);
    for index in [0u32, 1, 2] {
        let bytes = if big_endian {
            index.to_be_bytes()
        } else {
            index.to_le_bytes()
        };
        out.extend(bytes);
    }
    out
}

#[test]
fn binary_ply_files_of_either_byte_order_are_read() {
    for big_endian in [false, true] {
        // Known by its first line, whatever its name is.
        let scene = load("scan.bin", &binary(big_endian), &[]).unwrap();
        assert_eq!(scene.triangle_count(), 1);
        assert_eq!(scene.bounds().max.to_array(), [1.0, 1.0, 0.0]);
    }
}

#[test]
fn broken_files_are_named_with_their_format() {
    let refusal = |name: &str, text: &str| {
        let error = load(name, text.as_bytes(), &[]).unwrap_err();
        assert_eq!(error.code(), Code::NotMesh, "{error}");
        error.to_string()
    };
    let cases = [
        ("\nv 1 2\n", "line 2: a vertex has fewer than three numbers"),
        ("v 1 2 x\n", "line 1: \"x\" is not a number"),
        ("v 0 0 0\nf 1/x 2 3\n", "line 2: \"x\" is not a number"),
    ];
    for (text, cause) in cases {
        assert_eq!(refusal("a.obj", text), format!("a.obj is not OBJ: {cause}"));
    }
    assert_eq!(
        refusal("empty.ply", ""),
        "empty.ply is not PLY: its first line is not \"ply\""
    );
    let many = SQUARE.replace("vertex 4", "vertex 4000000000");
    assert_eq!(
        refusal("a.ply", &many),
        format!(
            "a.ply is not PLY: element vertex promises 4000000000 of them in {} bytes",
            many.len()
        )
    );
    let endless = "ply\nformat binary_little_endian 1.0\nelement x 5\nend_header\n";
    assert_eq!(
        refusal("a.ply", endless),
        "a.ply is not PLY: element x has no properties"
    );
    let cut = &SQUARE[..SQUARE.len() - 20];
    assert_eq!(
        refusal("a.ply", cut),
        "a.ply is not PLY: line 19: has too few numbers"
    );
    assert_eq!(
        refusal("a.ply", &SQUARE.replace("1 1 0", "1 x 0")),
        "a.ply is not PLY: line 18: \"x\" is not a number"
    );
    assert_eq!(
        refusal("a.ply", &SQUARE.replace("3 0 1 9", "300 0 1 9")),
        "a.ply is not PLY: line 21: has too few numbers"
    );
    assert_eq!(
        refusal("a.ply", &SQUARE.replace("3 0 1 9\n", "")),
        "a.ply is not PLY: has 1 elements face instead of 2"
    );
}

#[test]
fn a_ply_file_without_faces_is_points_or_lines() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty uchar red\n\
                end_header\n1 255\n2 0\n";
    let scene = load("points.ply", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.warnings, []);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.points, [0, 1]);
    assert_eq!(mesh.vertices[0].color, [u16::MAX, 0, 0, u16::MAX]);
    assert!(!mesh.lights_strokes() && scene.triangle_count() == 0);

    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float nx\n\
                element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n\
                1 1\n2 1\n1 0\n-1 0\n";
    let scene = load("edges.ply", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.meshes[0].lines, [[1, 0]]);
    assert!(scene.meshes[0].lights_strokes());
    assert_eq!(scene.warnings[0].code, Code::TrianglesUnusable);

    // Scanners write zeros where they know no normal.
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float nx\n\
                end_header\n1 0\n2 0\n";
    let scene = load("scan.ply", text.as_bytes(), &[]).unwrap();
    assert!(!scene.meshes[0].lights_strokes());
    assert_eq!(scene.warnings[0].code, Code::Normals);
}

proptest! {
    #[test]
    fn changed_files_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        kind in 0..4usize,
    ) {
        let (name, mut bytes) = match kind {
            0 => ("a.obj", HOUSE.as_bytes().to_vec()),
            1 => ("a.ply", SQUARE.as_bytes().to_vec()),
            2 => ("a.ply", binary(true)),
            _ => ("a.obj", HOUSE_MTL.replace("newmtl", "usemtl").into_bytes()),
        };
        let mut material = HOUSE_MTL.as_bytes().to_vec();
        for (at, byte) in changes {
            let i = at.index(bytes.len());
            bytes[i] = byte;
            let i = at.index(material.len());
            material[i] = byte;
        }
        let material = String::from_utf8_lossy(&material).into_owned();
        // Panics are caught; they would be these.
        match load(name, &bytes, &[("house.mtl", &material)]) {
            Err(SceneError::Internal { cause, .. }) => panic!("{cause}"),
            Err(SceneError::NotMesh { cause, .. }) => prop_assert_ne!(cause, "the decoder failed"),
            _ => {}
        }
    }
}

#[test]
fn a_face_that_is_left_out_takes_no_normals_from_the_others() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0.6 0.8\nf 1//1 2//1 3//1\nf 1 2\nf 1 2 99\n";
    let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let vertices = &scene.meshes[0].vertices;
    assert!(vertices.iter().all(|v| v.normal == [0.0, 0.6, 0.8]));
    let said: Vec<String> = scene.warnings.iter().map(|w| w.to_string()).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("2 of 3 faces"), "{said:?}");
}

#[test]
fn faces_without_a_library_are_no_metal_and_seen_from_both_sides() {
    let face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let missing = format!("mtllib none.mtl\nusemtl red\n{face}");
    for text in [face, &missing] {
        let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
        let material = &scene.materials[scene.instances[0].material as usize];
        assert_eq!((material.metallic, material.double_sided), (0.0, true));
    }
}
