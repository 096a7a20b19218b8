//! Adjacency of a welded mesh, and the one-ring of each cluster that is built from it.

use super::half_edges::HalfEdges;
use super::mesh::OccluderMesh;
use super::one_ring::{Edge, FIRST_OF_RING, FIRST_OF_SECOND, NO_TRIANGLE, OneRing};
use super::quads::Quad;
use super::word_hash::{WordHash, Words3};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Most triangles of a one-ring, so that their numbers, from [`FIRST_OF_RING`] on, stay below
/// [`NO_TRIANGLE`].
const MAX_TRIANGLES: usize = 255;
/// Most vertices of a cluster and its one-ring: numbers fit a byte.
const MAX_VERTICES: usize = 256;

/// The cosine of 20 degrees. Edges that bend less are seldom a silhouette.
const SMOOTH: f64 = 0.94;

/// Adjacency of a welded mesh.
pub(super) struct Neighbors<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    edges: &'a HalfEdges,
    hash: WordHash,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]], edges: &'a HalfEdges) -> Self {
        Self {
            points,
            triangles,
            edges,
            hash: WordHash::default(),
        }
    }

    /// The triangle beyond the edge from `a` to `b`, if the edge and its reverse have at most one
    /// triangle each.
    fn beyond(&self, a: u32, b: u32) -> Option<u32> {
        self.edges.only(a, b)?;
        self.edges.only(b, a)
    }

    /// Whether the mesh continues beyond an edge and hardly bends there.
    pub(super) fn is_smooth(&self, a: u32, b: u32) -> bool {
        let normal = |triangle: u32| {
            let t = self.triangles[triangle as usize];
            let [a, b, c] = t.map(|v| self.points[v as usize].as_dvec3());
            (b - a).cross(c - a).try_normalize()
        };
        let sides = (self.edges.only(a, b)).zip(self.edges.only(b, a));
        let normals = sides.and_then(|(one, other)| normal(one).zip(normal(other)));
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

/// Local numbers of vertices, for one cluster after the other.
pub(super) struct LocalNumbers {
    /// By vertex: the last cluster that has it, and its number there.
    clusters: Vec<u32>,
    numbers: Vec<u8>,
    cluster: u32,
}

impl LocalNumbers {
    pub(super) fn new(points: usize) -> Self {
        Self {
            clusters: vec![0; points],
            numbers: vec![0; points],
            cluster: 0,
        }
    }

    /// Forgets all numbers.
    pub(super) fn next_cluster(&mut self) {
        self.cluster += 1;
    }

    pub(super) fn set(&mut self, vertex: u32, number: u8) {
        self.clusters[vertex as usize] = self.cluster;
        self.numbers[vertex as usize] = number;
    }

    pub(super) fn get(&self, vertex: u32) -> Option<u8> {
        let known = self.clusters[vertex as usize] == self.cluster;
        known.then(|| self.numbers[vertex as usize])
    }
}

/// Appends the one-ring of the cluster that was appended last. `own` are its vertices in their
/// order, whose local numbers are known.
pub(super) fn build(
    mesh: &mut OccluderMesh,
    near: &Neighbors<'_>,
    local: &mut LocalNumbers,
    own: &[u32],
    quads: impl Iterator<Item = Quad>,
) {
    let rings = &mut mesh.one_rings;
    let (first_vertex, first_group, first_edge) = (
        rings.vertices.x.len() as u32,
        rings.triangles.len() as u32,
        rings.edges.len() as u32,
    );
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
        for edge in own.iter().flat_map(|&v| near.edges.leaving(v)) {
            let corners = near.triangles[edge.triangle as usize];
            if numbers.contains_key(&name(corners)) || around.len() == MAX_TRIANGLES {
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
                .beyond(a, b)
                .and_then(|i| numbers.get(&name(near.triangles[i as usize])));
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
    let padding = others.len().next_multiple_of(8) - others.len();
    let last = others.last().copied();
    for v in others
        .iter()
        .copied()
        .chain(last.into_iter().cycle().take(padding))
    {
        let p = near.points[v as usize];
        rings.vertices.x.push(p.x);
        rings.vertices.y.push(p.y);
        rings.vertices.z.push(p.z);
    }
    rings.clusters.push(OneRing {
        first_vertex,
        vertex_count: (others.len() + padding) as u16,
        first_group,
        triangle_count: around.len() as u16,
        first_edge,
        edges: (rings.edges.len() - first_edge as usize) as u16,
    });
}
