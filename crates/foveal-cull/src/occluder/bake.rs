//! Baking: any triangle mesh becomes clusters that can be culled as a whole.
//!
//! Baking welds equal positions, joins neighbouring triangles to nearly flat quads (half the set-up
//! work), and groups them into clusters of up to 64 quads with a bounding box and a normal cone.
//! Positions stay as they are. Bounds are relative to the mesh's own centre, so that large local
//! coordinates keep their precision. Large meshes are baked in chunks.

use super::borders::{Around, Borders};
use super::chunks::{self, Chunking};
use super::in_parts::in_order;
use super::inner::{inner_boxes, may_have_boxes};
use super::mesh::OccluderMesh;
use super::neighbors::Neighbors;
use super::one_ring::OneRings;
use super::vertices::{Points, Vertices};
use super::weld::{By, Welded, weld};
use super::{cluster, quads};
use crate::bounds::Aabb;
use crate::error::{CullError, Quantity};
use crate::threads::{SingleThread, Threads};
use glam::{DVec3, Vec3};

/// Options of baking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BakeOptions {
    /// Whether triangles occlude from behind as well (glTF `doubleSided`); `false` by default.
    /// Otherwise only counter-clockwise faces occlude, which is what a renderer with back-face
    /// culling draws.
    pub two_sided: bool,
    /// Whether to bake the adjacency of every cluster, for view regions
    /// ([`View::stereo`](crate::View::stereo),
    /// [`View::with_validity_radius`](crate::View::with_validity_radius)); `true` by default.
    /// Baking then takes up to twice as long, and the mesh three times the memory. Without
    /// it view regions are just as safe but hide less, since every polygon shrinks by itself. Views
    /// of one exact eye do not need it. Two-sided meshes never have it.
    pub adjacency: bool,
    /// Whether the mesh can be given new positions by
    /// [`set_positions`](OccluderMesh::set_positions); `false` by default. Then equal positions are
    /// not joined, since they may part: triangles are neighbours only where they share indices.
    pub deformable: bool,
    /// Whether to bake a few boxes inside the mesh in its place, where they are the better
    /// occluder; `false` by default. For what a renderer draws with back-face culling and without
    /// holes: a rock, a statue, a car. Boxes are taken if the mesh is closed (every edge is there
    /// as often in one direction as in the other, and triangles face outwards), if it has 96
    /// triangles or more for each of up to eight boxes, and if the boxes fill half of its outline
    /// or more in the mean over all directions. Otherwise, and for meshes that are two-sided or
    /// deformable, the mesh itself is baked. [`OccluderMesh::is_inner_shape`] says which. Where a
    /// near plane may cut the mesh's bounds, boxes hide nothing.
    pub inner_shape: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            two_sided: false,
            adjacency: true,
            deformable: false,
            inner_shape: false,
        }
    }
}

impl BakeOptions {
    /// Sets [`two_sided`](Self::two_sided).
    #[must_use]
    pub fn with_two_sided(mut self, two_sided: bool) -> Self {
        self.two_sided = two_sided;
        self
    }

    /// Sets [`adjacency`](Self::adjacency).
    #[must_use]
    pub fn with_adjacency(mut self, adjacency: bool) -> Self {
        self.adjacency = adjacency;
        self
    }

    /// Sets [`deformable`](Self::deformable).
    #[must_use]
    pub fn with_deformable(mut self, deformable: bool) -> Self {
        self.deformable = deformable;
        self
    }

    /// Sets [`inner_shape`](Self::inner_shape).
    #[must_use]
    pub fn with_inner_shape(mut self, inner_shape: bool) -> Self {
        self.inner_shape = inner_shape;
        self
    }
}

/// Most triangles of a mesh: offsets of clusters, vertices and adjacency are 32 bits.
pub(super) const MAX_TRIANGLES: usize = (u32::MAX / 8) as usize;

impl OccluderMesh {
    /// Bakes a triangle list: `positions` in mesh space (metres) and `indices`, three per triangle,
    /// counter-clockwise from outside.
    ///
    /// Baking welds positions that are bit-equal, drops degenerate triangles, joins neighbouring
    /// triangles to nearly flat quads, and groups quads into clusters of up to 64 by the
    /// surface-area heuristic over position and normal. Equal input gives an equal mesh.
    ///
    /// O(n log n): about 0.5 microseconds per triangle on one core, 0.8 with adjacency. Bake when a
    /// level loads, not per frame, or once for all by [`to_bytes`](Self::to_bytes). An
    /// [inner shape](BakeOptions::inner_shape) of a closed mesh takes 25 milliseconds and 0.35
    /// microseconds per triangle.
    ///
    /// # Errors
    /// [`CullError::NotTriangles`], [`CullError::IndexOutOfRange`], [`CullError::NotFinite`] for a
    /// position in use, or [`CullError::TooManyTriangles`] for more than 2^29 - 1.
    pub fn bake<P: Copy + Into<[f32; 3]> + Sync>(
        positions: &[P],
        indices: &[u32],
        options: BakeOptions,
    ) -> Result<Self, CullError> {
        Self::bake_on(positions, indices, options, &SingleThread)
    }

    /// [`bake`](Self::bake) on several threads. The mesh is the same.
    ///
    /// # Errors
    /// As [`bake`](Self::bake).
    pub fn bake_on<P: Copy + Into<[f32; 3]> + Sync>(
        positions: &[P],
        indices: &[u32],
        options: BakeOptions,
        threads: &dyn Threads,
    ) -> Result<Self, CullError> {
        Self::bake_in(positions, indices, options, Chunking::USUAL, threads)
    }

    /// [`bake_on`](Self::bake_on) in chunks of another size.
    pub(super) fn bake_in<P: Copy + Into<[f32; 3]> + Sync>(
        positions: &[P],
        indices: &[u32],
        options: BakeOptions,
        chunking: Chunking,
        threads: &dyn Threads,
    ) -> Result<Self, CullError> {
        let position = |i: u32| Vec3::from(positions[i as usize].into());
        Input {
            positions: positions.len(),
            position: &position,
            indices,
            chunking,
        }
        .bake(options, threads)
    }
}

/// What is baked.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    /// Number of positions.
    pub(super) positions: usize,
    pub(super) position: &'a (dyn Fn(u32) -> Vec3 + Sync),
    pub(super) indices: &'a [u32],
    pub(super) chunking: Chunking,
}

impl Input<'_> {
    fn bake(self, options: BakeOptions, threads: &dyn Threads) -> Result<OccluderMesh, CullError> {
        let center = self.center()?;
        if options.inner_shape
            && !(options.two_sided || options.deformable)
            && let Some(shape) = self.inner_shape(options)
        {
            return Ok(shape);
        }
        Ok(self.bake_around(center, options, threads))
    }

    /// Boxes inside the mesh, if they are the better occluder.
    fn inner_shape(&self, options: BakeOptions) -> Option<OccluderMesh> {
        if !may_have_boxes(self.indices.len() / 3) {
            return None;
        }
        let triangles = (0..self.indices.len() / 3).map(|t| self.triangle(t));
        let welded = weld(By::Position, self.positions, self.position, triangles);
        let boxes = inner_boxes(&welded)?;
        let solid = Aabb::of_points(welded.points);
        Some(OccluderMesh::of_boxes(&boxes, Some(solid), options))
    }

    /// Bakes a checked input. Bounds are relative to `center`.
    pub(super) fn bake_around(
        self,
        center: DVec3,
        options: BakeOptions,
        threads: &dyn Threads,
    ) -> OccluderMesh {
        let mut mesh = OccluderMesh {
            vertices: Vertices::default(),
            quads: Vec::new(),
            clusters: Vec::new(),
            one_rings: OneRings::default(),
            bounds8: Vec::new(),
            center,
            half: Vec3::ZERO,
            two_sided: options.two_sided,
            hash: 0,
            triangles: 0,
            positions: options.deformable.then_some(self.positions),
            solid: None,
        };
        if options.adjacency && !options.two_sided {
            self.with_adjacency(&mut mesh, threads);
        } else {
            self.without_adjacency(&mut mesh, threads);
        }
        if options.deformable {
            mesh.reshape();
        }
        mesh.finish();
        mesh
    }

    /// The centre of all positions in use; an error for input that is no triangle mesh.
    fn center(&self) -> Result<DVec3, CullError> {
        let triangles = self.indices.len() / 3;
        if !self.indices.len().is_multiple_of(3) {
            return Err(CullError::NotTriangles {
                indices: self.indices.len(),
            });
        }
        if triangles > MAX_TRIANGLES {
            return Err(CullError::TooManyTriangles {
                triangles,
                most: MAX_TRIANGLES,
            });
        }
        let outside = |&&i: &&u32| i as usize >= self.positions;
        if let Some(&index) = self.indices.iter().find(outside) {
            return Err(CullError::IndexOutOfRange {
                index,
                positions: self.positions,
            });
        }
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &i in self.indices {
            let p = (self.position)(i);
            if !p.is_finite() {
                return Err(CullError::NotFinite(Quantity::Position));
            }
            (lo, hi) = (lo.min(p), hi.max(p));
        }
        Ok(if triangles == 0 {
            DVec3::ZERO
        } else {
            (lo.as_dvec3() + hi.as_dvec3()) * 0.5
        })
    }

    fn triangle(&self, triangle: usize) -> [u32; 3] {
        let first = 3 * triangle;
        [0, 1, 2].map(|corner| self.indices[first + corner])
    }

    /// Each chunk by itself.
    fn without_adjacency(&self, mesh: &mut OccluderMesh, threads: &dyn Threads) {
        let corners = |t: usize| self.triangle(t).map(self.position);
        let chunks = chunks::apart(
            self.indices.len() / 3,
            &corners,
            self.chunking.triangles,
            threads,
        );
        let empty = mesh.clone();
        let by = mesh.welded_by();
        let make = |chunk: usize| {
            let triangles = chunks[chunk].iter().map(|&t| self.triangle(t as usize));
            let welded = weld(by, self.positions, self.position, triangles);
            let quads = quads::pair(&welded.points, &welded.triangles);
            let mut part = empty.clone();
            part.triangles = welded.triangles.len() as u32;
            let source = cluster::Source {
                points: Points {
                    points: &welded.points,
                    sources: empty.positions.map(|_| &welded.sources[..]),
                },
                near: None,
            };
            cluster::build(&mut part, source, quads);
            part
        };
        in_order(threads, chunks.len(), &make, &mut |part| mesh.append(part));
    }

    /// Chunks of a mesh that is welded as a whole, each with the triangles around it, which its
    /// one-rings reach.
    fn with_adjacency(&self, mesh: &mut OccluderMesh, threads: &dyn Threads) {
        let by = mesh.welded_by();
        let triangles = (0..self.indices.len() / 3).map(|t| self.triangle(t));
        let all = weld(by, self.positions, self.position, triangles);
        let point = |i: u32| all.points[i as usize];
        let corners = |t: usize| all.triangles[t].map(point);
        let most = self.chunking.triangles;
        let chunks = chunks::apart(all.triangles.len(), &corners, most, threads);
        if chunks.len() == 1 {
            mesh.triangles = all.triangles.len() as u32;
            let quads = quads::pair(&all.points, &all.triangles);
            let near = Neighbors::new(&all, vec![false; all.points.len()]);
            let source = cluster::Source {
                points: Points {
                    points: &all.points,
                    sources: mesh.positions.map(|_| &all.sources[..]),
                },
                near: Some(&near),
            };
            cluster::build(mesh, source, quads);
            return;
        }
        // Chunk by chunk, so that what lies together is together in memory.
        let length = |end: &mut usize, chunk: &Vec<u32>| {
            *end += chunk.len();
            Some(*end)
        };
        let ends: Vec<usize> = chunks.iter().scan(0, length).collect();
        let order = chunks.into_iter().flatten();
        let triangles: Vec<[u32; 3]> = order.map(|t| all.triangles[t as usize]).collect();
        let Welded {
            points, sources, ..
        } = all;
        let sources = mesh.positions.map(|_| sources);
        let point = |i: u32| points[i as usize];
        let borders = Borders::new(points.len(), &triangles, &ends);
        let most = self.chunking.corners_around;
        let empty = mesh.clone();
        let make = |chunk: usize| {
            let first = chunk.checked_sub(1).map_or(0, |before| ends[before]);
            let own = first..ends[chunk];
            let (around, known) = match borders.around(&triangles, own.clone(), most) {
                Around::Triangles(around) => (around, true),
                Around::Unknown => (Vec::new(), false),
            };
            let (before, after) =
                around.split_at(around.partition_point(|&t| (t as usize) < first));
            // In the order of all triangles.
            let near: Vec<[u32; 3]> = (before.iter().map(|&t| t as usize))
                .chain(own.clone())
                .chain(after.iter().map(|&t| t as usize))
                .map(|t| triangles[t])
                .collect();
            let local = weld(by, points.len(), &point, near.iter().copied());
            let unknown = |v: &u32| !known && borders.is_shared(*v);
            let near = Neighbors::new(&local, local.sources.iter().map(unknown).collect());
            let own_triangles = &local.triangles[before.len()..][..own.len()];
            let quads = quads::pair(&local.points, own_triangles);
            let mut part = empty.clone();
            part.triangles = own.len() as u32;
            let of_positions: Option<Vec<u32>> =
                (sources.as_ref()).map(|s| local.sources.iter().map(|&v| s[v as usize]).collect());
            let source = cluster::Source {
                points: Points {
                    points: &local.points,
                    sources: of_positions.as_deref(),
                },
                near: Some(&near),
            };
            cluster::build(&mut part, source, quads);
            part
        };
        in_order(threads, ends.len(), &make, &mut |part| mesh.append(part));
        mesh.one_rings.keep_below(u32::MAX as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::super::one_ring::{Edge, NO_TRIANGLE};
    use super::*;

    /// A torus of `n` times `m` quads, 2 n m triangles, without an end anywhere.
    fn torus(n: u32, m: u32) -> (Vec<[f32; 3]>, Vec<u32>) {
        let turn = |i: u32, of: u32| (i as f32 / of as f32 * core::f32::consts::TAU).sin_cos();
        let point = |i: u32, j: u32| {
            let ((s, c), (up, out)) = (turn(i, n), turn(j, m));
            [c * (3.0 + out), up, s * (3.0 + out)]
        };
        let points = (0..n).flat_map(|i| (0..m).map(move |j| point(i, j)));
        let quad = |i: u32, j: u32| {
            let at = |i: u32, j: u32| i % n * m + j % m;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [a, b, c, a, c, d]
        };
        let quads = (0..n).flat_map(|i| (0..m).flat_map(move |j| quad(i, j)));
        (points.collect(), quads.collect())
    }

    #[test]
    fn one_rings_reach_across_chunks() {
        let (points, indices) = torus(300, 100);
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert!(mesh.triangle_count() > 3 * chunks::MOST_TRIANGLES);
        let open = |edge: &&Edge| edge.triangles.contains(&NO_TRIANGLE);
        assert_eq!(mesh.one_rings.edges.iter().filter(open).count(), 0);
        assert!(mesh.clusters.iter().all(|c| c.creased == 0.0));
    }

    #[test]
    fn surfaces_end_where_what_is_around_a_chunk_is_not_looked_at() {
        let (points, indices) = torus(40, 20);
        let edges = |corners_around| {
            let chunking = Chunking {
                triangles: 200,
                corners_around,
            };
            let options = BakeOptions::default();
            let mesh =
                OccluderMesh::bake_in(&points, &indices, options, chunking, &SingleThread).unwrap();
            assert_eq!(mesh.triangle_count(), 1600);
            assert!(OccluderMesh::from_bytes(&mesh.to_bytes()).is_ok());
            let open = |edge: &&Edge| edge.triangles.contains(&NO_TRIANGLE);
            let all = mesh.one_rings.edges;
            [all.iter().filter(open).count(), all.len()]
        };
        assert_eq!(edges(usize::MAX)[0], 0);
        let [open, all] = edges(0);
        assert!(open > 100 && open < all / 2, "{open} of {all}");
    }
}
