//! Vertex positions in the layout that the transform reads.

use super::room::make_room;

/// Positions by coordinate, mesh space. Each cluster's part is padded to a multiple of eight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
}

impl Vertices {
    pub(super) fn append(&mut self, other: Self) {
        for (list, further) in [
            (&mut self.x, other.x),
            (&mut self.y, other.y),
            (&mut self.z, other.z),
        ] {
            make_room(list, further.len());
            list.extend(further);
        }
    }

    pub(super) fn shrink(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            list.shrink_to_fit();
        }
    }
}
