//! Points and lines as the device gets them: a quad each, which the vertex shader widens to its width
//! in pixels (`stroke_corner` in `shared/stroke.wgsl`).
//!
//! A corner is a vertex whose tangent tells it from the others. Of a point: x and y are -1 or 1, z and
//! w 0. Of a line: xyz is the other end, w the side: -1 or 1 at the first end, -2 or 2 at the second.
//! A normal of zero says that the point or line is not lit.

use bytemuck::Zeroable;
use foveal_scene::{Mesh, Vertex};

/// Vertices of a quad.
pub(super) const CORNERS: usize = 4;

/// Its two triangles.
pub(super) const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// Quads of a mesh's lines, then of its points. One that names a missing vertex has no area.
pub(super) fn quads(mesh: &Mesh) -> impl Iterator<Item = [Vertex; CORNERS]> {
    let vertex = |&i: &u32| mesh.vertices.get(i as usize).copied();
    let line = move |[from, to]: &[u32; 2]| Some(line(vertex(from)?, vertex(to)?));
    let point = move |at: &u32| Some(point(vertex(at)?));
    let all = (mesh.lines.iter().map(line)).chain(mesh.points.iter().map(point));
    all.map(|quad| quad.unwrap_or([Vertex::zeroed(); CORNERS]))
}

fn line(mut from: Vertex, mut to: Vertex) -> [Vertex; CORNERS] {
    if [from.normal, to.normal].contains(&[0.0; 3]) {
        (from.normal, to.normal) = ([0.0; 3], [0.0; 3]);
    }
    let corner = |end: Vertex, other: Vertex, side: f32| {
        let [x, y, z] = other.position;
        Vertex {
            tangent: [x, y, z, side],
            ..end
        }
    };
    // Seen from its own end, the left of one is the right of the other.
    [
        corner(from, to, 1.0),
        corner(from, to, -1.0),
        corner(to, from, 2.0),
        corner(to, from, -2.0),
    ]
}

fn point(at: Vertex) -> [Vertex; CORNERS] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vertex {
        tangent: [x, y, 0.0, 0.0],
        ..at
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_of_missing_vertices_have_no_area() {
        let mesh = Mesh {
            vertices: vec![Vertex::zeroed(); 2],
            lines: vec![[0, 1], [0, 2], [u32::MAX, 1]],
            points: vec![1, 2],
            ..Mesh::default()
        };
        let empty = |quad: &[Vertex; CORNERS]| quad.iter().all(|v| v.tangent == [0.0; 4]);
        let found: Vec<bool> = quads(&mesh).map(|quad| empty(&quad)).collect();
        assert_eq!(found, [false, true, true, false, true]);
    }
}
