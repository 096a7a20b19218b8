//! The triangles of a mesh, to be found by their positions.
//!
//! A triangle is the same from whichever corner it is written on, and another one when it faces the
//! other way. Positions are compared bit by bit.

use super::mesh::{Cluster, OccluderMesh};
use super::one_ring::FIRST_OF_SECOND;
use super::word_hash::{WordHash, Words3};
use core::hash::{BuildHasher, Hasher};

/// The bits of a position.
pub(super) type Point = [u32; 3];

/// All triangles of a mesh, in buckets by hash.
pub(super) struct Surface<'a> {
    mesh: &'a OccluderMesh,
    hash: WordHash,
    /// Where each bucket begins, and the end of the last.
    starts: Vec<u32>,
    triangles: Vec<Place>,
}

/// Where a triangle is.
#[derive(Clone, Copy)]
struct Place {
    cluster: u32,
    /// The triangle's number in its cluster, and 24 bits of its hash, so that the others of a bucket
    /// are seldom looked at: each is elsewhere in memory.
    number: u8,
    hash: [u8; 3],
}

fn short(hash: u64) -> [u8; 3] {
    let [a, b, c, ..] = hash.to_le_bytes();
    [a, b, c]
}

impl<'a> Surface<'a> {
    /// The triangles of a mesh whose clusters are checked.
    pub(super) fn new(mesh: &'a OccluderMesh) -> Self {
        let counts = mesh.clusters.iter().map(|c| usize::from(c.triangle_count));
        let count = counts.sum::<usize>();
        let none = Place {
            cluster: 0,
            number: 0,
            hash: [0; 3],
        };
        let mut all = Self {
            mesh,
            hash: WordHash::default(),
            // One triangle a bucket, in the mean.
            starts: vec![0; count.next_power_of_two() + 1],
            triangles: vec![none; count],
        };
        let mut hashes = Vec::with_capacity(count);
        for c in &mesh.clusters {
            for (_, corners) in triangles(mesh, c) {
                let hash = all.hash(&corners.map(|v| point(mesh, c, v)));
                let next = all.bucket(hash) + 1;
                all.starts[next] += 1;
                hashes.push(hash);
            }
        }
        let mut sum = 0;
        for start in &mut all.starts {
            sum += *start;
            *start = sum;
        }
        // Each bucket is filled from its beginning, which moves on: in the end it is the next one's.
        let clusters = (0u32..).zip(&mesh.clusters);
        let places = clusters.flat_map(|(n, c)| triangles(mesh, c).map(move |(t, _)| (n, t)));
        for ((cluster, number), hash) in places.zip(hashes) {
            let bucket = all.bucket(hash);
            let at = all.starts[bucket];
            all.triangles[at as usize] = Place {
                cluster,
                number,
                hash: short(hash),
            };
            all.starts[bucket] = at + 1;
        }
        all.starts.rotate_right(1);
        all.starts[0] = 0;
        all
    }

    /// Whether a triangle is one of the mesh.
    pub(super) fn has(&self, triangle: &[Point; 3]) -> bool {
        let hash = self.hash(triangle);
        let bucket = self.bucket(hash);
        let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
        let [a, b, c] = *triangle;
        self.triangles[range].iter().any(|place| {
            place.hash == short(hash) && {
                let c_of = &self.mesh.clusters[place.cluster as usize];
                let corners = corners(self.mesh, c_of, place.number);
                let found = corners.map(|v| point(self.mesh, c_of, v));
                found == [a, b, c] || found == [b, c, a] || found == [c, a, b]
            }
        })
    }

    /// The same from each corner on.
    fn hash(&self, triangle: &[Point; 3]) -> u64 {
        let [a, b, c] = triangle.map(|p| self.hash.hash_one(Words3(p)));
        let turned = [[a, b, c], [b, c, a], [c, a, b]];
        let turned = turned.into_iter().min().unwrap_or_default();
        let mut hasher = self.hash.build_hasher();
        turned.into_iter().for_each(|h| hasher.write_u64(h));
        hasher.finish()
    }

    fn bucket(&self, hash: u64) -> usize {
        (hash >> 32) as usize & (self.starts.len() - 2)
    }
}

/// The vertices of a cluster's triangle. Second triangles of quads follow the first ones.
fn corners(mesh: &OccluderMesh, c: &Cluster, number: u8) -> [u8; 3] {
    let number = usize::from(number);
    let (q, second) = (number % FIRST_OF_SECOND, number / FIRST_OF_SECOND);
    let group = &mesh.quads[c.first_group as usize + q / 8];
    [0, 1 + second, 2 + second].map(|corner| group[corner][q % 8])
}

/// The triangles of a cluster: number and vertices.
fn triangles<'a>(
    mesh: &'a OccluderMesh,
    c: &'a Cluster,
) -> impl Iterator<Item = (u8, [u8; 3])> + 'a {
    let all = (0..c.quad_count).flat_map(|q| [q, q + FIRST_OF_SECOND as u8]);
    let all = all.map(|number| (number, corners(mesh, c, number)));
    all.filter(|(_, [_, b, c])| b != c)
}

/// The position of a cluster's own vertex.
pub(super) fn point(mesh: &OccluderMesh, c: &Cluster, vertex: u8) -> Point {
    let (v, at) = (
        &mesh.vertices,
        c.first_vertex as usize + usize::from(vertex),
    );
    [&v.x, &v.y, &v.z].map(|list| list[at].to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BakeOptions;

    #[test]
    fn triangles_are_found_from_every_corner_and_one_way_round() {
        let points: Vec<[f32; 3]> = (0..600)
            .map(|i| [(i % 20) as f32, (i / 20) as f32, ((i * i) % 7) as f32])
            .collect();
        let indices: Vec<u32> = (0..551u32).flat_map(|i| [i, i + 1, i + 21]).collect();
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert!(mesh.cluster_count() > 3);
        let surface = Surface::new(&mesh);
        let bits = |i: u32| points[i as usize].map(f32::to_bits);
        for t in indices.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(bits);
            for triangle in [[a, b, c], [b, c, a], [c, a, b]] {
                assert!(surface.has(&triangle));
            }
            let next_to = [c[0], c[1], c[2] ^ 1];
            for triangle in [[a, c, b], [c, b, a], [b, a, c], [a, b, next_to]] {
                assert!(!surface.has(&triangle));
            }
        }
    }

    #[test]
    fn an_empty_mesh_has_no_triangles() {
        let none: [[f32; 3]; 0] = [];
        let mesh = OccluderMesh::bake(&none, &[], BakeOptions::default()).unwrap();
        assert!(!Surface::new(&mesh).has(&[[0; 3], [1; 3], [2; 3]]));
    }
}
