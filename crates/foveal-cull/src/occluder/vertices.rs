//! Vertex positions in the layout that the transform reads.

/// Positions by coordinate, mesh space. Each cluster's part is padded to a multiple of eight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
}

impl Vertices {
    pub(super) fn append(&mut self, other: Self) {
        self.x.extend(other.x);
        self.y.extend(other.y);
        self.z.extend(other.z);
    }
}
