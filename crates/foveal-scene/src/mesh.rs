//! Meshes: the geometry of one glTF primitive, of triangles, lines or points.

use bytemuck::{Pod, Zeroable};

use crate::Aabb;

/// One vertex as renderers take it; 64 bytes without padding.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Object space, metres.
    pub position: [f32; 3],
    /// Unit normal, object space; zero at points and lines without normals, which are not lit.
    pub normal: [f32; 3],
    /// Unit tangent, object space; w = ±1 is the bitangent's sign as glTF defines it.
    /// All zero when the material has no normal texture and the file gives no tangents.
    pub tangent: [f32; 4],
    /// The two UV sets that the material uses, (0, 0) top left.
    pub uv: [[f32; 2]; 2],
    /// Linear RGBA (vertex colours are linear in glTF), 65,535 for 1, so that dark colours stay
    /// apart; opaque white when the file gives none.
    pub color: [u16; 4],
}

/// Vertices, and what they make: triangles, lines or points, or several of these in a mesh that a
/// program puts together. Make it with `..Mesh::default()`: it may get more fields.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh {
    /// Name in the file, with the primitive's number where a glTF mesh has several.
    pub name: String,
    /// Vertices. For a deforming mesh: as posed by the last [`Scene::pose`](crate::Scene::pose).
    pub vertices: Vec<Vertex>,
    /// Three per triangle, each below `vertices.len()`; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    /// Both ends of each straight line, each below `vertices.len()`. Lines are some pixels wide at any
    /// distance. A line is lit where both its ends have normals; others show base colour and emission.
    pub lines: Vec<[u32; 2]>,
    /// The vertex of each point, below `vertices.len()`. Points are squares of some pixels at any
    /// distance. A point is lit where its vertex has a normal; others show base colour and emission.
    pub points: Vec<u32>,
    /// Smallest box around the vertices that triangles, lines and points use, object space.
    pub bounds: Aabb,
    /// Morph targets or a skin change its vertices from pose to pose; renderers have to know from the
    /// beginning. Such a mesh belongs to one
    /// node; the vertices of a skinned one are in world space, and its instances' matrices the
    /// identity. Where its joints mirror it, the vertices have x negated, and so have the matrices:
    /// triangles are clockwise in world space then, as in any mirrored instance.
    pub deforms: bool,
}

impl Mesh {
    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Number of lines and points.
    #[must_use]
    pub fn stroke_count(&self) -> usize {
        self.lines.len() + self.points.len()
    }

    /// Whether it has neither triangles nor lines nor points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangle_count() + self.stroke_count() == 0
    }

    /// Whether any of its lines and points is lit: all its vertices have normals.
    #[must_use]
    pub fn lights_strokes(&self) -> bool {
        let has_normal = |i: &u32| {
            let vertex = self.vertices.get(*i as usize);
            vertex.is_some_and(|vertex| vertex.normal != [0.0; 3])
        };
        self.points.iter().any(has_normal)
            || self.lines.iter().any(|ends| ends.iter().all(has_normal))
    }

    /// The vertices that triangles, lines and points use, some of them several times.
    pub(crate) fn used(&self) -> impl Iterator<Item = u32> {
        let lines = self.lines.as_flattened().iter();
        let all = self.indices.iter().chain(lines).chain(&self.points);
        all.copied()
    }

    /// Smallest box around the vertices that are used; `vertices` in place of its own.
    pub(crate) fn bounds_of(&self, vertices: &[Vertex]) -> Aabb {
        let position = |i: u32| vertices.get(i as usize).map(|v| v.position.into());
        Aabb::of_points(self.used().filter_map(position))
    }
}
