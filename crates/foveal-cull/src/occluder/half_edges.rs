//! The directed edges of a welded mesh, by the vertex that they leave.
//!
//! An edge is found among the few that leave its first vertex, which lie side by side in memory.
//! Where very many leave one vertex, they are sorted.

use super::word_hash::WordHash;
use std::collections::HashMap;

/// Vertices with more edges than this have a sorted list.
const LONG: usize = 32;

/// A directed edge of the vertex whose list it is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct HalfEdge {
    /// The vertex where it ends.
    pub(super) end: u32,
    /// The triangle that it belongs to.
    pub(super) triangle: u32,
}

/// The directed edges of a mesh.
#[derive(Debug)]
pub(super) struct HalfEdges {
    /// Where the list of each vertex begins, and the end of the last.
    starts: Vec<u32>,
    /// The lists, by triangle.
    edges: Vec<HalfEdge>,
    /// Lists of more than [`LONG`] edges, by their ends and then by triangle.
    sorted: HashMap<u32, Vec<HalfEdge>, WordHash>,
}

impl HalfEdges {
    /// The edges of triangles over `points` vertices. No triangle has a vertex twice.
    pub(super) fn new(points: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0u32; points + 1];
        for &v in triangles.as_flattened() {
            starts[v as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut edges = vec![
            HalfEdge {
                end: 0,
                triangle: 0
            };
            triangles.len() * 3
        ];
        // Each list is filled from its beginning, which moves on: in the end it is the next one's.
        for (triangle, t) in (0u32..).zip(triangles) {
            for k in 0..3 {
                let next = &mut starts[t[k] as usize];
                edges[*next as usize] = HalfEdge {
                    end: t[(k + 1) % 3],
                    triangle,
                };
                *next += 1;
            }
        }
        starts.rotate_right(1);
        starts[0] = 0;
        let mut all = Self {
            starts,
            edges,
            sorted: HashMap::default(),
        };
        for vertex in 0..points as u32 {
            if all.leaving(vertex).len() > LONG {
                let mut list = all.leaving(vertex).to_vec();
                list.sort_unstable();
                all.sorted.insert(vertex, list);
            }
        }
        all
    }

    /// The edges that leave a vertex, one for each of its triangles, by triangle.
    pub(super) fn leaving(&self, vertex: u32) -> &[HalfEdge] {
        let v = vertex as usize;
        &self.edges[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The first triangle with the edge from `a` to `b`, and whether there are further ones.
    pub(super) fn find(&self, a: u32, b: u32) -> Option<(u32, bool)> {
        let list = self.leaving(a);
        if list.len() > LONG {
            let list = self.sorted.get(&a)?;
            let at = list.partition_point(|e| e.end < b);
            let first = list.get(at).filter(|e| e.end == b)?;
            return Some((first.triangle, list.get(at + 1).is_some_and(|e| e.end == b)));
        }
        let mut found = list.iter().filter(|e| e.end == b);
        let first = found.next()?;
        Some((first.triangle, found.next().is_some()))
    }

    /// The triangle with the edge from `a` to `b`, if it is the only one.
    pub(super) fn only(&self, a: u32, b: u32) -> Option<u32> {
        self.find(a, b).and_then(|(t, more)| (!more).then_some(t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_found_in_short_and_in_long_lists() {
        // A fan of 100 triangles around vertex 0, one of them twice.
        let mut triangles: Vec<[u32; 3]> = (1..=100).map(|i| [i, i + 1, 0]).collect();
        triangles.push([0, 7, 8]);
        let edges = HalfEdges::new(102, &triangles);
        assert_eq!(edges.leaving(0).len(), 101);
        for i in 1..=100 {
            let twice = i == 7;
            assert_eq!(edges.find(i, i + 1), Some((i - 1, twice)));
            assert_eq!(edges.find(i + 1, 0), Some((i - 1, twice)));
            assert_eq!(edges.find(0, i), Some((i - 1, twice)));
            assert_eq!(edges.only(0, i), (!twice).then_some(i - 1));
            assert_eq!(edges.find(i + 1, i), None);
        }
        assert_eq!(edges.find(0, 101), None);
        let around: Vec<u32> = edges.leaving(0).iter().map(|e| e.triangle).collect();
        assert_eq!(around, (0..=100).collect::<Vec<_>>());
    }
}
