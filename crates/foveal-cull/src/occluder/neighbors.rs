//! Adjacency of a welded mesh, and the one-ring of each cluster that is built from it.

use super::mesh::OccluderMesh;
use super::one_ring::{Edge, FIRST_OF_RING, FIRST_OF_SECOND, NO_TRIANGLE, OneRing};
use super::quads::Quad;
use glam::Vec3;
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
    /// The triangle of each directed edge; `None` where several have it.
    edges: HashMap<(u32, u32), Option<u32>>,
    /// Triangles by vertex: where each vertex's list begins, and the lists.
    starts: Vec<u32>,
    around: Vec<u32>,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        let mut edges = HashMap::with_capacity(triangles.len() * 3);
        let mut starts = vec![0u32; points.len() + 1];
        for (i, t) in (0u32..).zip(triangles) {
            for e in 0..3 {
                edges
                    .entry((t[e], t[(e + 1) % 3]))
                    .and_modify(|several| *several = None)
                    .or_insert(Some(i));
                starts[t[e] as usize + 1] += 1;
            }
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut next = starts.clone();
        let mut around = vec![0; triangles.len() * 3];
        for (i, t) in (0u32..).zip(triangles) {
            for v in t {
                let at = &mut next[*v as usize];
                around[*at as usize] = i;
                *at += 1;
            }
        }
        Self {
            points,
            triangles,
            edges,
            starts,
            around,
        }
    }

    fn around(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.around[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The triangle beyond the edge from `a` to `b`, if the edge and its reverse have at most one
    /// triangle each.
    fn beyond(&self, a: u32, b: u32) -> Option<u32> {
        let here = self.edges.get(&(a, b)).copied().flatten();
        here?;
        self.edges.get(&(b, a)).copied().flatten()
    }

    /// Whether the mesh continues beyond an edge and hardly bends there.
    pub(super) fn is_smooth(&self, a: u32, b: u32) -> bool {
        let normal = |triangle: Option<u32>| {
            let t = self.triangles[triangle? as usize];
            let [a, b, c] = t.map(|v| self.points[v as usize].as_dvec3());
            (b - a).cross(c - a).try_normalize()
        };
        let sides = [self.beyond(b, a), self.beyond(a, b)].map(normal);
        matches!(sides, [Some(m), Some(n)] if m.dot(n) > SMOOTH)
    }
}

/// A name for a triangle: its vertices from the smallest on.
fn name([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Appends the one-ring of the cluster that was appended last. `own` are its vertices in their
/// order.
pub(super) fn build(
    mesh: &mut OccluderMesh,
    near: &Neighbors<'_>,
    own: &[u32],
    quads: impl Iterator<Item = Quad>,
) {
    let rings = &mut mesh.one_rings;
    let (first_vertex, first_group, first_edge) = (
        rings.vertices.x.len() as u32,
        rings.triangles.len() as u32,
        rings.edges.len() as u32,
    );
    let mut numbers: HashMap<[u32; 3], u16> = HashMap::new();
    let mut twice = false;
    for (n, [a, b, c, d]) in (0u16..).zip(quads) {
        twice |= numbers.insert(name([a, b, c]), n).is_some();
        if c != d {
            twice |= numbers
                .insert(name([a, c, d]), n + FIRST_OF_SECOND as u16)
                .is_some();
        }
    }
    let base = own.len().next_multiple_of(8);
    let mut others: Vec<u32> = Vec::new();
    let mut around: Vec<[u32; 3]> = Vec::new();
    let is_own = |v: u32| own.binary_search(&v).is_ok();
    // Triangles that occur twice have no edge of their own. Without a number their edges only
    // become silhouette edges.
    if !twice {
        for &t in own.iter().flat_map(|&v| near.around(v)) {
            let corners = near.triangles[t as usize];
            if numbers.contains_key(&name(corners)) || around.len() == MAX_TRIANGLES {
                continue;
            }
            let new: Vec<u32> = corners
                .into_iter()
                .filter(|&v| !is_own(v) && !others.contains(&v))
                .collect();
            if base + (others.len() + new.len()).next_multiple_of(8) > MAX_VERTICES {
                continue;
            }
            others.extend(new);
            numbers.insert(name(corners), (FIRST_OF_RING + around.len()) as u16);
            around.push(corners);
        }
    }
    let local = |v: u32| {
        let there = || others.iter().position(|&o| o == v).map(|i| base + i);
        own.binary_search(&v).ok().or_else(there).unwrap_or(0) as u8
    };
    let mut edges = Vec::new();
    let mut all: Vec<([u32; 3], u16)> = numbers.iter().map(|(&t, &n)| (t, n)).collect();
    all.sort_unstable_by_key(|&(_, n)| n);
    for &(t, n) in &all {
        for e in 0..3 {
            let (a, b) = (t[e], t[(e + 1) % 3]);
            if !is_own(a) && !is_own(b) {
                continue;
            }
            let beyond = near
                .beyond(a, b)
                .and_then(|i| numbers.get(&name(near.triangles[i as usize])));
            let other = beyond.copied().unwrap_or(NO_TRIANGLE);
            if n < other {
                edges.push(Edge {
                    triangles: [n, other],
                    vertices: [local(a), local(b)],
                });
            }
        }
    }
    for corners in around.chunks(8) {
        let mut group = [[0u8; 8]; 3];
        for (i, &t) in corners.iter().enumerate() {
            let on = t.map(is_own);
            let odd = (0..3)
                .find(|&k| on[k] != on[(k + 1) % 3] && on[k] != on[(k + 2) % 3])
                .unwrap_or(0);
            for (k, corner) in group.iter_mut().enumerate() {
                corner[i] = local(t[(odd + k) % 3]);
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
        edges: edges.len() as u16,
    });
    rings.edges.extend(edges);
}
