//! Points and lines as the device gets them: a quad each, which the vertex shader widens to its width
//! in pixels (`stroke_corner` in `shared/stroke.wgsl`).
//!
//! A corner is a vertex whose tangent tells it from the others. Of a point: x and y are -1 or 1, z and
//! w 0. Of a line: xyz is the other end, w the side, -1 or 1.

use foveal_scene::{Mesh, Vertex};

/// Vertices of a quad.
pub(super) const CORNERS: usize = 4;

/// Its two triangles.
pub(super) const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// Quads of a mesh's lines, then of its points.
pub(super) fn quads(mesh: &Mesh) -> impl Iterator<Item = [Vertex; CORNERS]> {
    let lines = mesh.lines.iter().map(|&[from, to]| line(mesh, from, to));
    lines.chain(mesh.points.iter().map(|&at| point(mesh, at)))
}

fn line(mesh: &Mesh, from: u32, to: u32) -> [Vertex; CORNERS] {
    let [from, to] = [from, to].map(|end| mesh.vertices[end as usize]);
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
        corner(to, from, 1.0),
        corner(to, from, -1.0),
    ]
}

fn point(mesh: &Mesh, at: u32) -> [Vertex; CORNERS] {
    let at = mesh.vertices[at as usize];
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vertex {
        tangent: [x, y, 0.0, 0.0],
        ..at
    })
}
