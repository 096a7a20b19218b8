//! Vertex positions in the layout that the transform reads.

use super::room::make_room;
use glam::Vec3;

/// Positions by coordinate, mesh space. Each cluster's part is padded to a multiple of eight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    /// Of a mesh that deforms, which of its positions each is.
    pub(super) sources: Vec<u32>,
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
        make_room(&mut self.sources, other.sources.len());
        self.sources.extend(other.sources);
    }

    pub(super) fn push(&mut self, p: Vec3, source: Option<u32>) {
        self.x.push(p.x);
        self.y.push(p.y);
        self.z.push(p.z);
        self.sources.extend(source);
    }

    /// Repeats the last one until the number is a multiple of eight.
    pub(super) fn pad(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            pad(list);
        }
        pad(&mut self.sources);
    }

    pub(super) fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    pub(super) fn set(&mut self, i: usize, p: Vec3) {
        (self.x[i], self.y[i], self.z[i]) = (p.x, p.y, p.z);
    }

    pub(super) fn shrink(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            list.shrink_to_fit();
        }
        self.sources.shrink_to_fit();
    }
}

/// Points of which some become vertices.
#[derive(Clone, Copy)]
pub(super) struct Points<'a> {
    pub(super) points: &'a [Vec3],
    /// Of a mesh that deforms, which of its positions each point is.
    pub(super) sources: Option<&'a [u32]>,
}

impl Points<'_> {
    pub(super) fn at(&self, point: u32) -> Vec3 {
        self.points[point as usize]
    }

    /// Appends a point to the vertices of a mesh.
    pub(super) fn push(&self, vertices: &mut Vertices, point: u32) {
        let source = self.sources.map(|sources| sources[point as usize]);
        vertices.push(self.at(point), source);
    }
}

fn pad<T: Copy>(list: &mut Vec<T>) {
    if let Some(&last) = list.last() {
        list.resize(list.len().next_multiple_of(8), last);
    }
}
