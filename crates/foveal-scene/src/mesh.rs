//! Triangle meshes: the geometry of one glTF primitive.

use bytemuck::{Pod, Zeroable};

use crate::Aabb;

/// One vertex as renderers take it; 64 bytes without padding.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Object space, metres.
    pub position: [f32; 3],
    /// Unit normal, object space.
    pub normal: [f32; 3],
    /// Unit tangent, object space; w = ±1 is the bitangent's sign as glTF defines it.
    /// All zero when the material has no normal texture and the file gives no tangents.
    pub tangent: [f32; 4],
    /// The two UV sets that the material uses, (0, 0) top left.
    pub uv: [[f32; 2]; 2],
    /// Linear RGBA, 8 bits each (vertex colours are linear in glTF); opaque white when the file
    /// gives none.
    pub color: [u8; 4],
    /// Zero. Keeps the vertex at 64 bytes.
    pub reserved: u32,
}

/// An indexed triangle list.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh {
    /// Name in the file, with the primitive's number where a glTF mesh has several.
    pub name: String,
    /// Vertices. For a deforming mesh: as posed by the last [`Scene::pose`](crate::Scene::pose).
    pub vertices: Vec<Vertex>,
    /// Three per triangle, each below `vertices.len()`; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    /// Smallest box around the vertices that the indices use, object space.
    pub bounds: Aabb,
    /// Morph targets or a skin change its vertices from pose to pose. Such a mesh belongs to one
    /// node; the vertices of a skinned one are in world space, and its instances' matrices the
    /// identity.
    pub deforms: bool,
}

impl Mesh {
    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }
}
