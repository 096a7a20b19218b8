//! Tangents by MikkTSpace, the method that glTF prescribes and normal maps are baked for.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace};

use crate::Vertex;

struct Corners<'a> {
    vertices: &'a [Vertex],
    indices: &'a [u32],
    uv_slot: usize,
    tangents: Vec<[f32; 4]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.vertices[self.indices[face * 3 + corner] as usize]
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).position
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).normal
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.vertex(face, corner).uv[self.uv_slot]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let [x, y, z, w] = space.unwrap_or_default().tangent_encoded();
        // MikkTSpace takes v upwards, glTF's v points down while its normal maps' green points up.
        self.tangents[face * 3 + corner] = [x, y, z, -w];
    }
}

/// Generates tangents for the UVs of `uv_slot`. Vertices whose corners disagree are split; the
/// result names the former vertex of each vertex when that happened.
pub(crate) fn generate(
    vertices: &mut Vec<Vertex>,
    indices: &mut [u32],
    uv_slot: usize,
) -> Option<Vec<u32>> {
    let mut corners = Corners {
        vertices,
        indices,
        uv_slot,
        tangents: vec![[1.0, 0.0, 0.0, 1.0]; indices.len()],
    };
    // The error type has no values.
    let _ = bevy_mikktspace::generate_tangents(&mut corners);
    let tangents = corners.tangents;

    let before = vertices.len();
    let mut given = vec![false; before];
    let mut twins: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let mut source: Vec<u32> = Vec::new();
    for (index, tangent) in indices.iter_mut().zip(tangents) {
        let at = *index as usize;
        if !given[at] {
            given[at] = true;
            vertices[at].tangent = tangent;
        } else if vertices[at].tangent != tangent {
            let key = (*index, tangent.map(f32::to_bits));
            *index = *twins.entry(key).or_insert_with(|| {
                vertices.push(Vertex {
                    tangent,
                    ..vertices[at]
                });
                source.push(at as u32);
                vertices.len() as u32 - 1
            });
        }
    }
    if source.is_empty() {
        return None;
    }
    Some((0..before as u32).chain(source).collect())
}
