//! A file of points and lines.

use serde_json::json;

use crate::file::File;

/// Points, lines, a loop and a strip of lines, each beside the others, all of the same six coloured
/// vertices; with indices, a morph target, and normals at the strip.
#[must_use]
pub fn strokes() -> File {
    let mut file = File::with_mesh();
    let corners = [
        0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.2, 0.5, 1.5, 0., 0.5, 0.5, 0.5,
    ];
    file.attribute("POSITION", &corners, "VEC3");
    let colors = [
        1., 0., 0., 1., 0., 1., 0., 1., 0., 0., 1., 1., 1., 1., 0., 1., 0., 1., 1., 1., 1., 0., 1.,
        1.,
    ];
    file.attribute("COLOR_0", &colors, "VEC4");
    let delta = file.floats(&[0.05; 18], "VEC3");
    file.primitive()["targets"] = json!([{ "POSITION": delta }]);
    file.primitive()["mode"] = json!(0);
    file.material(json!({ "pbrMetallicRoughness": { "metallicFactor": 0 } }));
    let points = file.primitive().clone();
    file.indices(&[0, 1, 2, 3, 4, 5]);
    let indices = file.primitive()["indices"].clone();
    let normals = file.floats(&[0., 0., 1.].repeat(6), "VEC3");
    file.json["meshes"] = json!([]);
    file.json["nodes"] = json!([]);
    for mode in [0, 1, 2, 3] {
        let mut primitive = points.clone();
        primitive["mode"] = json!(mode);
        if mode > 0 {
            primitive["indices"] = indices.clone();
        }
        if mode == 3 {
            primitive["attributes"]["NORMAL"] = json!(normals);
        }
        let mesh = file.push(
            "meshes",
            json!({ "primitives": [primitive], "weights": [0.5] }),
        );
        let (x, y) = (1.5 * (mode % 2) as f32, -2.0 * (mode / 2) as f32);
        file.push("nodes", json!({ "mesh": mesh, "translation": [x, y, 0] }));
    }
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    file
}
