//! The triangles of a mesh, to be found by their positions. A mesh that is written says of every
//! triangle of a one-ring where it is, so that reading need not look.
//!
//! A triangle is the same from whichever corner it is written on, and another one when it faces the
//! other way. Positions are compared bit by bit.

use super::mesh::{Cluster, OccluderMesh};
use super::one_ring::{FIRST_OF_SECOND, OneRing};
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

    /// The first place of a triangle; [`Home::NONE`] if it is none of the mesh.
    pub(super) fn find(&self, triangle: &[Point; 3]) -> Home {
        let hash = self.hash(triangle);
        let bucket = self.bucket(hash);
        let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
        let alike = self.triangles[range]
            .iter()
            .filter(|p| p.hash == short(hash));
        let mut homes = alike.map(|place| Home {
            cluster: place.cluster,
            number: place.number,
        });
        homes
            .find(|home| home.is_of(self.mesh, triangle))
            .unwrap_or(Home::NONE)
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

/// A triangle of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Home {
    pub(super) cluster: u32,
    /// Its number in the cluster.
    pub(super) number: u8,
}

impl Home {
    /// No place at all.
    pub(super) const NONE: Self = Self {
        cluster: u32::MAX,
        number: 0,
    };

    /// Whether it is a triangle of these positions. The mesh's clusters are checked, the numbers
    /// are not.
    pub(super) fn is_of(self, mesh: &OccluderMesh, triangle: &[Point; 3]) -> bool {
        let Some(c) = mesh.clusters.get(self.cluster as usize) else {
            return false;
        };
        if usize::from(self.number) >= 2 * FIRST_OF_SECOND
            || self.number % FIRST_OF_SECOND as u8 >= c.quad_count
        {
            return false;
        }
        let corners = corners(mesh, c, self.number);
        let found = corners.map(|v| point(mesh, c, v));
        let [a, b, c] = *triangle;
        corners[1] != corners[2] && (found == [a, b, c] || found == [b, c, a] || found == [c, a, b])
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

impl OneRing {
    /// Vertices of triangle `t`, by their numbers.
    pub(super) fn corners(&self, mesh: &OccluderMesh, t: usize) -> [u8; 3] {
        let group = &mesh.one_rings.triangles[self.first_group as usize + t / 8];
        group.map(|corner| corner[t % 8])
    }

    /// The positions of the corners of triangle `t` of the one-ring of cluster `c`.
    pub(super) fn points(&self, mesh: &OccluderMesh, c: &Cluster, t: usize) -> [Point; 3] {
        let own = usize::from(c.vertex_count);
        let around = &mesh.one_rings.vertices;
        self.corners(mesh, t).map(|v| {
            if usize::from(v) < own {
                return point(mesh, c, v);
            }
            let at = self.first_vertex as usize + usize::from(v) - own.next_multiple_of(8);
            [&around.x, &around.y, &around.z].map(|list| list[at].to_bits())
        })
    }
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
                assert_ne!(surface.find(&triangle), Home::NONE);
                assert!(surface.find(&triangle).is_of(&mesh, &triangle));
            }
            let next_to = [c[0], c[1], c[2] ^ 1];
            for triangle in [[a, c, b], [c, b, a], [b, a, c], [a, b, next_to]] {
                assert_eq!(surface.find(&triangle), Home::NONE);
            }
        }
    }

    #[test]
    fn numbers_of_no_triangle_are_none_of_any_positions() {
        // A cluster of one quad and one triangle just above it.
        let points: [[f32; 3]; 7] = core::array::from_fn(|i| {
            let [x, y] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][i % 4];
            [x, y, (i / 4) as f32 * 0.1]
        });
        let indices = [0, 1, 2, 0, 2, 3, 4, 5, 6];
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert_eq!(mesh.clusters[0].quad_count, 2);
        let triangles = indices.as_chunks::<3>().0;
        let of = |home: Home| {
            let is =
                |t: &&[u32; 3]| home.is_of(&mesh, &t.map(|i| points[i as usize].map(f32::to_bits)));
            triangles.iter().filter(is).count()
        };
        for cluster in [0, 1, u32::MAX] {
            let found: Vec<u8> = (0..=u8::MAX)
                .filter(|&number| of(Home { cluster, number }) == 1)
                .collect();
            let expected: &[u8] = if cluster == 0 { &[0, 1, 64] } else { &[] };
            assert_eq!(found, expected);
        }
        // The second half of a triangle, whose third corner comes twice.
        let [_, b, c] = triangles[2].map(|i| points[i as usize].map(f32::to_bits));
        let half = Home {
            cluster: 0,
            number: 65,
        };
        assert!(!half.is_of(&mesh, &[b, c, c]) && !half.is_of(&mesh, &[c, c, b]));
    }

    #[test]
    fn an_empty_mesh_has_no_triangles() {
        let none: [[f32; 3]; 0] = [];
        let mesh = OccluderMesh::bake(&none, &[], BakeOptions::default()).unwrap();
        let found = Surface::new(&mesh).find(&[[0; 3], [1; 3], [2; 3]]);
        assert_eq!(found, Home::NONE);
    }
}
