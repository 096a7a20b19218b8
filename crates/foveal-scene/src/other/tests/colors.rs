//! Colours of vertices.

use super::load;

#[test]
fn colours_count_where_all_vertices_have_one() {
    let with = |color: &str| {
        let text = format!("v 0 0 0 1 0 0.5\nv 1 0 0 {color}\nv 0 1 0 1 0 0.5\nf 1 2 3\n");
        let scene = load("a.obj", text.as_bytes(), &[]).unwrap();
        scene.meshes[0].vertices[1].color
    };
    let [r, g, b, _] = with("1 0 0.5");
    assert_eq!((r, g), (u16::MAX, 0));
    // As displays show it: half is a fifth of the light.
    assert!(b.abs_diff(14027) <= 2, "{b}");
    let [r, g, b, _] = with("1.5 -1 1");
    assert_eq!((r, g, b), (u16::MAX, 0, u16::MAX));
    // Without one of them all are white.
    assert_eq!(with(""), [u16::MAX; 4]);
}

#[test]
fn dark_colours_stay_apart() {
    let mut text = String::from("ply\nformat ascii 1.0\nelement vertex 30\n");
    for axis in ["x", "y", "z"] {
        text += &format!("property float {axis}\n");
    }
    for channel in ["red", "green", "blue"] {
        text += &format!("property uchar {channel}\n");
    }
    text += "element face 10\nproperty list uchar int vertex_indices\nend_header\n";
    for i in 0..30 {
        text += &format!("{i} {} 0 {i} {i} {i}\n", i * i);
    }
    for i in 0..10 {
        text += &format!("3 {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2);
    }
    let colors = |text: &str| -> std::collections::BTreeSet<u16> {
        let scene = load("scan.ply", text.as_bytes(), &[]).unwrap();
        scene.meshes[0]
            .vertices
            .iter()
            .map(|v| v.color[0])
            .collect()
    };
    let apart = colors(&text);
    assert_eq!(apart.len(), 30);
    // IEC 61966-2-1: 1 of 255 is 0.000304 of the light, and 29 of 65535 is 0.0000342.
    assert_eq!(apart.iter().nth(1), Some(&20));
    let finer = text.replace("property uchar", "property ushort");
    assert_eq!(colors(&finer).last(), Some(&2));
}
