//! Faces of PLY files in triangles, with texture coordinates of their corners, by the texture that each
//! shows.

use std::collections::HashMap;

use super::ply_elements::{Corner, Face};
use super::polygons::Polygons;
use crate::{Code, Warning};

/// Makes vertices of the corners of faces, with the texture coordinates that faces give them. What the
/// corners have in common is one vertex.
pub(super) fn give_own_uvs(vertices: &mut Vec<Corner>, faces: &mut [Face]) {
    let mut made: Vec<Corner> = Vec::new();
    let mut number_of: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
    for face in faces {
        let own = face.has_own_uvs().then(|| face.uvs.as_chunks::<2>().0);
        for (i, corner) in face.corners.iter_mut().enumerate() {
            let Some(vertex) = vertices.get(*corner as usize) else {
                *corner = u32::MAX;
                continue;
            };
            let uv = own.map_or(vertex.uv, |uvs| [uvs[i][0], 1.0 - uvs[i][1]]);
            let next = made.len() as u32;
            let number = number_of.entry((*corner, uv.map(f32::to_bits)));
            *corner = *number.or_insert_with(|| {
                let mut corner = *vertex;
                corner.uv = uv;
                made.push(corner);
                next
            });
        }
    }
    *vertices = made;
}

/// Triangles of all faces that name vertices that exist, in a file of so many bytes: those of each of so
/// many textures, and last those that show none.
pub(super) fn triangles(
    faces: &[Face],
    vertices: &[Corner],
    textures: usize,
    file_bytes: usize,
    notes: &mut Vec<Warning>,
) -> Vec<Vec<u32>> {
    let mut parts = vec![Vec::new(); textures + 1];
    let mut polygons = Polygons::of_file(file_bytes);
    let mut places = Vec::new();
    let mut dropped = 0usize;
    for face in faces {
        let corners = &face.corners;
        let found = corners.iter().map_while(|&i| vertices.get(i as usize));
        places.clear();
        places.extend(found.map(|vertex| vertex.position));
        if corners.len() < 3 || places.len() < corners.len() {
            dropped += 1;
            continue;
        }
        let indices = &mut parts[textures.min(face.texture as usize)];
        polygons.cut(&places, |triangle| {
            indices.extend(triangle.map(|i| corners[i]));
        });
    }
    if dropped > 0 {
        let text = format!(
            "{dropped} of {} faces have fewer than three corners or name vertices that do not exist, and are left out",
            faces.len()
        );
        notes.push(Warning::new(Code::TrianglesUnusable, text));
    }
    parts
}

#[cfg(test)]
mod tests {
    use crate::{Code, LoadOptions, Scene, load_bytes};

    fn load(text: &str) -> Scene {
        let no_files = |_: &str| Err("no files".to_owned());
        load_bytes(
            text.as_bytes(),
            "scan.ply",
            &LoadOptions::default(),
            &no_files,
        )
        .unwrap()
    }

    /// Two triangles with these header lines, properties and values of faces.
    fn square(comments: &str, properties: &str, faces: [&str; 2]) -> Scene {
        load(&format!(
            "ply\nformat ascii 1.0\n{comments}element vertex 4\nproperty float x\nproperty float y\n\
             property float z\nelement face 2\nproperty list uchar int vertex_indices\n{properties}\
             end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 {}\n3 0 2 3 {}\n",
            faces[0], faces[1]
        ))
    }

    const TEXCOORD: &str = "property list uchar float texcoord\n";

    /// Place and texture coordinates of each corner, in order.
    fn corners(scene: &Scene) -> Vec<([f32; 3], [f32; 2])> {
        let instances = scene.instances.iter();
        let meshes = instances.map(|instance| &scene.meshes[instance.mesh as usize]);
        let of = |mesh: &crate::Mesh| {
            let vertices = mesh.indices.iter().map(|&i| mesh.vertices[i as usize]);
            vertices.map(|v| (v.position, v.uv[0])).collect::<Vec<_>>()
        };
        meshes.flat_map(of).collect()
    }

    #[test]
    fn corners_of_faces_have_texture_coordinates_of_their_own() {
        let faces = ["6 0 0 1 0 1 1", "6 0.5 0 1 0.75 0 1"];
        let scene = square("comment TextureFile a.png\n", TEXCOORD, faces);
        let (a, b, c, d) = ([0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]);
        let expected = [
            (a, [0., 1.]),
            (b, [1., 1.]),
            (c, [1., 0.]),
            (a, [0.5, 1.]),
            (c, [1., 0.25]),
            (d, [0., 0.]),
        ];
        assert_eq!(corners(&scene), expected);
        assert!(scene.materials[0].base_color_texture.is_some());
        // The picture is not there; nothing else is missing.
        let codes: Vec<Code> = scene.warnings.iter().map(|w| w.code).collect();
        assert_eq!(codes, [Code::ImageUnreadable]);
    }

    #[test]
    fn faces_without_texture_coordinates_stay_among_others() {
        let texture = "comment TextureFile a.png\n";
        let scene = square(texture, TEXCOORD, ["0", "6 0.5 0 1 0.75 0 1"]);
        let uvs: Vec<[f32; 2]> = corners(&scene).into_iter().map(|(_, uv)| uv).collect();
        assert_eq!(uvs[..3], [[0.0; 2]; 3]);
        assert_eq!(uvs[3], [0.5, 1.0]);
    }

    #[test]
    fn vertices_stay_where_there_are_no_faces_with_texture_coordinates() {
        let scene = load(&format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 0\n\
             property list uchar int vertex_indices\n{TEXCOORD}end_header\n7\n"
        ));
        assert_eq!((scene.point_count(), &scene.warnings[..]), (1, &[][..]));
    }

    #[test]
    fn faces_show_the_texture_of_their_number() {
        let files = "comment TextureFile a.png\ncomment TextureFile b.png\n";
        let properties = format!("{TEXCOORD}property int texnumber\n");
        let shown = |numbers: [i32; 2]| -> Vec<Option<String>> {
            let faces = numbers.map(|number| format!("6 0 0 1 0 1 1 {number}"));
            let scene = square(files, &properties, [&faces[0], &faces[1]]);
            assert_eq!(scene.triangle_count(), 2);
            let instances = scene.instances.iter();
            let materials = instances.map(|i| &scene.materials[i.material as usize]);
            let name = |m: &crate::Material| {
                let slot = m.base_color_texture?;
                Some(scene.textures[slot.texture as usize].name.clone())
            };
            materials.map(name).collect()
        };
        let [a, b] = ["a.png", "b.png"].map(|name| Some(name.to_owned()));
        assert_eq!(shown([0, 0]), std::slice::from_ref(&a));
        assert_eq!(shown([1, 0]), [a, b.clone()]);
        assert_eq!(shown([-1, 1]), [b.clone(), None]);
        assert_eq!(shown([7, 1]), [b, None]);
    }
}
