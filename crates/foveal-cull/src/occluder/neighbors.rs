//! Adjacency of a welded mesh, and the one-ring of each cluster that is built from it.

use super::half_edges::HalfEdges;
use super::mesh::OccluderMesh;
use super::one_ring::{Edge, FIRST_OF_RING, FIRST_OF_SECOND, NO_TRIANGLE, OneRing};
use super::quads::Quad;
use super::vertices::Points;
use super::weld::Welded;
use super::word_hash::{WordHash, Words3};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Most triangles of a one-ring, so that their numbers, from [`FIRST_OF_RING`] on, stay below
/// [`NO_TRIANGLE`].
const MAX_TRIANGLES: usize = 255;
/// Most vertices of a cluster and its one-ring: numbers fit a byte.
const MAX_VERTICES: usize = 256;

/// Most triangles that are looked at for a one-ring: 16 at each of 256 vertices, so that vertices of
/// very many triangles, which belong to many clusters, take no quadratic time.
const MOST_TOUCHING: usize = 4096;

/// The cosine of 20 degrees. Edges that bend less are seldom a silhouette.
const SMOOTH: f64 = 0.94;

/// Adjacency of a welded mesh.
pub(super) struct Neighbors<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    edges: HalfEdges,
    /// Of every point whether further triangles may have it. What lies beyond an edge of two such
    /// points is unknown; the surface ends there, which is safe.
    unknown: Vec<bool>,
    hash: WordHash,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(mesh: &'a Welded, unknown: Vec<bool>) -> Self {
        Self {
            points: &mesh.points,
            triangles: &mesh.triangles,
            edges: HalfEdges::new(mesh.points.len(), &mesh.triangles),
            unknown,
            hash: WordHash::default(),
        }
    }

    /// The triangles on either side of the edge from `a` to `b`, if there is one on each.
    fn sides(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        if self.unknown[a as usize] && self.unknown[b as usize] {
            return None;
        }
        Some([self.edges.only(a, b)?, self.edges.only(b, a)?])
    }

    /// Triangles at some vertices; the first ones, where they are very many. Those that a one-ring
    /// leaves out end it in silhouette edges, which is safe.
    fn touching(&self, vertices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
        let leaving = vertices.iter().flat_map(|&v| self.edges.leaving(v));
        leaving
            .take(MOST_TOUCHING)
            .map(|edge| self.triangles[edge.triangle as usize])
    }

    /// Whether the mesh continues beyond an edge and hardly bends there.
    pub(super) fn is_smooth(&self, a: u32, b: u32) -> bool {
        let normal = |triangle: u32| {
            let t = self.triangles[triangle as usize];
            let [a, b, c] = t.map(|v| self.points[v as usize].as_dvec3());
            (b - a).cross(c - a).try_normalize()
        };
        let sides = self.sides(a, b);
        let normals = sides.and_then(|[one, other]| normal(one).zip(normal(other)));
        normals.is_some_and(|(m, n): (DVec3, DVec3)| m.dot(n) > SMOOTH)
    }
}

/// A name for a triangle: its vertices from the smallest on.
fn name([a, b, c]: [u32; 3]) -> Words3 {
    Words3(if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    })
}

/// Local numbers of vertices, for one cluster after the other: a table of slots by hash.
pub(super) struct LocalNumbers {
    slots: Box<[Slot; SLOTS]>,
    cluster: u32,
}

/// At least twice the numbers of a cluster and its one-ring, and a power of two.
const SLOTS: usize = 1024;

#[derive(Clone, Copy)]
struct Slot {
    /// The last cluster that used it; 0 for none.
    cluster: u32,
    vertex: u32,
    number: u8,
}

impl LocalNumbers {
    pub(super) fn new() -> Self {
        let none = Slot {
            cluster: 0,
            vertex: 0,
            number: 0,
        };
        Self {
            slots: Box::new([none; SLOTS]),
            cluster: 0,
        }
    }

    /// Forgets all numbers. There is room for [`MAX_VERTICES`] new ones.
    pub(super) fn next_cluster(&mut self) {
        self.cluster += 1;
    }

    pub(super) fn set(&mut self, vertex: u32, number: u8) {
        let slot = self.slot(vertex);
        self.slots[slot] = Slot {
            cluster: self.cluster,
            vertex,
            number,
        };
    }

    pub(super) fn get(&self, vertex: u32) -> Option<u8> {
        let slot = &self.slots[self.slot(vertex)];
        (slot.cluster == self.cluster).then_some(slot.number)
    }

    /// The slot of a vertex, or the free one where it belongs.
    fn slot(&self, vertex: u32) -> usize {
        let mut at = (vertex.wrapping_mul(0x9e37_79b1) >> 22) as usize % SLOTS;
        while self.slots[at].cluster == self.cluster && self.slots[at].vertex != vertex {
            at = (at + 1) % SLOTS;
        }
        at
    }
}

/// Appends the one-ring of the cluster that was appended last. `own` are its vertices in their
/// order, whose local numbers are known.
pub(super) fn build(
    mesh: &mut OccluderMesh,
    points: Points<'_>,
    near: &Neighbors<'_>,
    local: &mut LocalNumbers,
    own: &[u32],
    quads: impl Iterator<Item = Quad>,
) {
    let rings = &mut mesh.one_rings;
    let [first_vertex, first_group, first_edge] = rings.ends();
    let edges_before = rings.edges.len();
    let mut numbers: HashMap<Words3, u16, WordHash> =
        HashMap::with_capacity_and_hasher(512, near.hash);
    // All triangles with their numbers.
    let mut all: Vec<([u32; 3], u16)> = Vec::with_capacity(512);
    let mut twice = false;
    for (n, [a, b, c, d]) in (0u16..).zip(quads) {
        let second = (c != d).then_some(([a, c, d], n + FIRST_OF_SECOND as u16));
        for (corners, number) in [([a, b, c], n)].into_iter().chain(second) {
            twice |= numbers.insert(name(corners), number).is_some();
            all.push((name(corners).0, number));
        }
    }
    let base = own.len().next_multiple_of(8);
    let mut others: Vec<u32> = Vec::new();
    let mut around: Vec<[u32; 3]> = Vec::new();
    let is_own = |local: &LocalNumbers, v: u32| local.get(v).is_some_and(|n| usize::from(n) < base);
    // Triangles that occur twice have no neighbours: their edges are silhouette edges.
    if !twice {
        for corners in near.touching(own) {
            if around.len() == MAX_TRIANGLES {
                break;
            }
            if numbers.contains_key(&name(corners)) {
                continue;
            }
            let new = corners.iter().filter(|&&v| local.get(v).is_none()).count();
            if base + (others.len() + new).next_multiple_of(8) > MAX_VERTICES {
                continue;
            }
            for v in corners {
                if local.get(v).is_none() {
                    local.set(v, (base + others.len()) as u8);
                    others.push(v);
                }
            }
            let number = (FIRST_OF_RING + around.len()) as u16;
            numbers.insert(name(corners), number);
            all.push((name(corners).0, number));
            around.push(corners);
        }
    }
    let local = &*local;
    let place = |v: u32| local.get(v).unwrap_or(0);
    all.sort_unstable_by_key(|&(_, n)| n);
    for &(t, n) in &all {
        for e in 0..3 {
            let (a, b) = (t[e], t[(e + 1) % 3]);
            if !is_own(local, a) && !is_own(local, b) {
                continue;
            }
            let beyond = near
                .sides(a, b)
                .and_then(|[_, i]| numbers.get(&name(near.triangles[i as usize])));
            let other = beyond.copied().unwrap_or(NO_TRIANGLE);
            if n < other {
                rings.edges.push(Edge {
                    triangles: [n, other],
                    vertices: [place(a), place(b)],
                });
            }
        }
    }
    for corners in around.chunks(8) {
        let mut group = [[0u8; 8]; 3];
        for (i, &t) in corners.iter().enumerate() {
            let on = t.map(|v| is_own(local, v));
            let odd = (0..3)
                .find(|&k| on[k] != on[(k + 1) % 3] && on[k] != on[(k + 2) % 3])
                .unwrap_or(0);
            for (k, corner) in group.iter_mut().enumerate() {
                corner[i] = place(t[(odd + k) % 3]);
            }
        }
        rings.triangles.push(group);
    }
    for &v in &others {
        points.push(&mut rings.vertices, v);
    }
    rings.vertices.pad();
    rings.clusters.push(OneRing {
        first_vertex,
        vertex_count: others.len().next_multiple_of(8) as u16,
        first_group,
        triangle_count: around.len() as u16,
        first_edge,
        edges: (rings.edges.len() - edges_before) as u16,
    });
}

#[cfg(test)]
mod tests {
    use super::super::weld::{By, weld};
    use super::*;
    use crate::BakeOptions;

    #[test]
    fn local_numbers_are_those_of_their_cluster_alone() {
        let mut local = LocalNumbers::new();
        for cluster in 1..200u32 {
            local.next_cluster();
            // Steps that all begin at few slots, and neighbours.
            let vertex = |n: u32| n * [1, 1 << 22, 7919, 1 << 10][cluster as usize % 4] + cluster;
            (0..256).for_each(|n| assert_eq!(local.get(vertex(n)), None));
            (0..256).for_each(|n| local.set(vertex(n), n as u8));
            (0..256).for_each(|n| assert_eq!(local.get(vertex(n)), Some(n as u8)));
            assert_eq!(local.get(vertex(256)), None);
        }
    }

    #[test]
    fn few_triangles_of_a_large_fan_are_looked_at() {
        let n = 20_000u32;
        let mut points = vec![Vec3::ZERO];
        points.extend((0..=n).map(|i| {
            let angle = i as f32 / n as f32 * 6.0;
            Vec3::new(angle.cos(), angle.sin(), 0.0)
        }));
        let triangles: Vec<[u32; 3]> = (1..=n).map(|i| [0, i, i + 1]).collect();
        let mesh = weld(
            By::Position,
            points.len(),
            &|i| points[i as usize],
            triangles.iter().copied(),
        );
        let near = Neighbors::new(&mesh, vec![false; points.len()]);
        assert_eq!(near.edges.leaving(0).len(), n as usize);
        assert_eq!(near.touching(&[0, 1, 2]).count(), MOST_TOUCHING);
        assert_eq!(near.touching(&[5, 6]).count(), 4);
        // Triangles that are left out leave silhouette edges, and no edge is missing.
        let indices = triangles.as_flattened();
        let mesh = OccluderMesh::bake(&points, indices, BakeOptions::default()).unwrap();
        assert_eq!(mesh.triangle_count(), n as usize);
        assert!(OccluderMesh::from_bytes(&mesh.to_bytes()).is_ok());
    }
}
