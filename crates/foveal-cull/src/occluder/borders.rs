//! What lies around the chunks of a mesh: triangles of others at vertices that they share.

use core::ops::Range;

/// The vertices that several chunks have, and their triangles.
pub(super) struct Borders {
    /// Of every vertex whether several chunks have it.
    shared: Vec<bool>,
    /// Those vertices with each of their triangles, in order.
    triangles: Vec<(u32, u32)>,
}

/// What a chunk has around it.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Around {
    /// The triangles of others that have a vertex of the chunk, in order.
    Triangles(Vec<u32>),
    /// Too many to look at.
    Unknown,
}

impl Borders {
    /// The borders of chunks that end at `ends` in a list of triangles over `points` vertices.
    pub(super) fn new(points: usize, triangles: &[[u32; 3]], ends: &[usize]) -> Self {
        const NONE: u32 = u32::MAX;
        let mut shared = vec![false; points];
        let mut first = vec![NONE; if ends.len() > 1 { points } else { 0 }];
        let mut from = 0;
        for (chunk, &end) in (0u32..).zip(ends).take_while(|_| ends.len() > 1) {
            for &v in triangles[from..end].as_flattened() {
                let first = &mut first[v as usize];
                if *first == NONE {
                    *first = chunk;
                }
                shared[v as usize] |= *first != chunk;
            }
            from = end;
        }
        drop(first);
        let corners = (0u32..)
            .zip(triangles)
            .flat_map(|(t, corners)| corners.map(|v| (v, t)));
        let mut triangles: Vec<_> = corners.filter(|&(v, _)| shared[v as usize]).collect();
        triangles.sort_unstable();
        Self { shared, triangles }
    }

    pub(super) fn is_shared(&self, vertex: u32) -> bool {
        self.shared[vertex as usize]
    }

    /// What lies around the chunk `own` of all `triangles`, if at most `most` corners of triangles,
    /// its own included, lie at vertices that it shares.
    pub(super) fn around(&self, triangles: &[[u32; 3]], own: Range<usize>, most: usize) -> Around {
        let corners = triangles[own.clone()].as_flattened().iter().copied();
        let mut vertices: Vec<u32> = corners.filter(|&v| self.is_shared(v)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut around = Vec::new();
        for v in vertices {
            let first = self.triangles.partition_point(|&(other, _)| other < v);
            let of_vertex = self.triangles[first..].iter();
            let room = most.saturating_add(1) - around.len();
            let of_vertex = of_vertex.take_while(|&&(other, _)| other == v).take(room);
            around.extend(of_vertex.map(|&(_, t)| t));
            if around.len() > most {
                return Around::Unknown;
            }
        }
        around.retain(|&t| !own.contains(&(t as usize)));
        around.sort_unstable();
        around.dedup();
        Around::Triangles(around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_has_those_around_that_share_a_vertex() {
        // A strip of triangles in a row, in chunks of three.
        let triangles: Vec<[u32; 3]> = (0..9).map(|i| [i, i + 1, i + 2]).collect();
        let borders = Borders::new(11, &triangles, &[3, 6, 9]);
        let shared: Vec<u32> = (0..11).filter(|&v| borders.is_shared(v)).collect();
        assert_eq!(shared, [3, 4, 6, 7]);
        let around = |own: Range<usize>, most| borders.around(&triangles, own, most);
        assert_eq!(around(0..3, 99), Around::Triangles(vec![3, 4]));
        assert_eq!(around(3..6, 99), Around::Triangles(vec![1, 2, 6, 7]));
        // Vertices 3 and 4 have three triangles each.
        assert_eq!(around(0..3, 6), Around::Triangles(vec![3, 4]));
        assert_eq!(around(0..3, 5), Around::Unknown);
        assert_eq!(Borders::new(11, &triangles, &[9]).triangles, []);
    }
}
