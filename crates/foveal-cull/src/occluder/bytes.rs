//! Baked meshes as bytes, so that a level loads without baking.
//!
//! | offset | bytes | |
//! |---|---|---|
//! | 0 | 8 | `fovealOM` |
//! | 8 | 4 | version of the format |
//! | 12 | 4 | bit 0: two-sided; bit 1: with adjacency; bit 2: an inner shape |
//! | 16 | 8 | number of all bytes |
//! | 24 | 8 | checksum of all bytes but these eight |
//! | 32 | 24 | centre |
//! | 56 | 28 | seven numbers of elements, in the order of the lists below |
//! | 84 | 24 | lower and upper corner of the mesh that an inner shape is inside; else zeros |
//! | 108 | | clusters of 36 bytes, with adjacency 6 more each |
//! | | | vertices of 12, groups of eight quads of 32 |
//! | | | vertices of one-rings of 12, groups of eight triangles of 24, edges of 6 |
//! | | | where each triangle of a one-ring is among the clusters', 3; 5 with over 65,536 clusters |
//!
//! Numbers are little-endian. Lists of vertices are by coordinate. What follows from the rest is not
//! written: bounds, where the parts of each cluster begin, and the hash of the mesh. Where the triangles
//! of one-rings are would follow too, but looking them up takes a fifth to half as long as baking.

use super::bake::MAX_TRIANGLES;
use super::check;
use super::mesh::{Cluster, OccluderMesh, bounds_of, relative};
use super::one_ring::{Edge, OneRing, OneRings};
use super::surface::{Home, Surface};
use super::vertices::Vertices;
use crate::bounds::Aabb;
use crate::error::{CullError, MeshBytesError};
use glam::{DVec3, Vec3};

const MAGIC: [u8; 8] = *b"fovealOM";
/// Rises with every change of the format, or of what the fields mean.
const VERSION: u32 = 3;
const TWO_SIDED: u32 = 1;
const ADJACENCY: u32 = 2;
const INNER: u32 = 4;
const CHECKSUM: usize = 24;
pub(crate) const HEADER: usize = 108;
const LISTS: usize = 7;
/// Bytes of an element of each list.
const CLUSTER: u64 = 36;
const RING: u64 = 6;
const SIZES: [u64; LISTS] = [CLUSTER, 12, 32, 12, 24, 6, HOME];
/// Bytes of the place of a triangle in one of a few clusters: the cluster and the number there.
const HOME: u64 = 3;
/// What it takes more with very many clusters.
const WIDER_HOME: u64 = 2;

impl OccluderMesh {
    /// The mesh as bytes, for a file: 12 to 17 a triangle, 25 to 40 with adjacency. The same on
    /// every machine. [`from_bytes`](Self::from_bytes) reads them. A
    /// [`deformable`](crate::BakeOptions::deformable) mesh keeps the shape that it has, and can be
    /// deformed no more.
    ///
    /// ```
    /// use foveal_cull::{Aabb, OccluderMesh};
    ///
    /// let mesh = OccluderMesh::from_box(Aabb::new([0.0; 3], [1.0, 2.0, 3.0]))?;
    /// let bytes = mesh.to_bytes();
    /// let again = OccluderMesh::from_bytes(&bytes)?;
    /// assert_eq!(again.bounds(), mesh.bounds());
    /// assert!(OccluderMesh::from_bytes(&bytes[1..]).is_err());
    /// # Ok::<(), foveal_cull::CullError>(())
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let rings = &self.one_rings;
        let (counts, with_adjacency) = self.counts();
        let length = length(counts, with_adjacency);
        let mut bytes = Vec::with_capacity(length as usize);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        let flags = [
            (self.two_sided, TWO_SIDED),
            (with_adjacency, ADJACENCY),
            (self.solid.is_some(), INNER),
        ];
        let flags: u32 = flags.iter().map(|(on, flag)| u32::from(*on) * flag).sum();
        bytes.extend(flags.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend([0; 8]);
        bytes.extend(self.center.to_array().iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(counts.iter().flat_map(|n| n.to_le_bytes()));
        let solid = self.solid.map_or([[0.0; 3]; 2], |s| [s.min, s.max]);
        bytes.extend(solid.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        for c in &self.clusters {
            let [x, y, z] = c.cone_axis.to_array();
            let numbers = [x, y, z, c.cone_sin, c.cone_cos, c.fill, c.creased];
            bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
            bytes.extend(c.hash.to_le_bytes());
            bytes.extend(c.vertex_count.to_le_bytes());
            bytes.extend([c.quad_count, c.triangle_count]);
        }
        for r in &rings.clusters {
            let counts = [r.vertex_count, r.triangle_count, r.edges];
            bytes.extend(counts.iter().flat_map(|n| n.to_le_bytes()));
        }
        put_vertices(&mut bytes, &self.vertices);
        bytes.extend(self.quads.as_flattened().as_flattened());
        put_vertices(&mut bytes, &rings.vertices);
        bytes.extend(rings.triangles.as_flattened().as_flattened());
        for e in &rings.edges {
            bytes.extend(e.triangles.iter().flat_map(|n| n.to_le_bytes()));
            bytes.extend(e.vertices);
        }
        if with_adjacency {
            let surface = Surface::new(self);
            for (c, ring) in self.clusters.iter().zip(&rings.clusters) {
                for t in 0..usize::from(ring.triangle_count) {
                    let home = surface.find(&ring.points(self, c, t));
                    put_home(&mut bytes, home, has_wide_homes(counts));
                }
            }
        }
        seal(&mut bytes);
        bytes
    }

    /// The number of bytes that [`to_bytes`](Self::to_bytes) gives, without making them.
    #[must_use]
    pub fn bytes_len(&self) -> usize {
        let (counts, with_adjacency) = self.counts();
        length(counts, with_adjacency) as usize
    }

    /// Numbers of elements of the lists, and whether there is adjacency.
    fn counts(&self) -> ([u32; LISTS], bool) {
        let rings = &self.one_rings;
        let counts = [
            self.clusters.len(),
            self.vertices.x.len(),
            self.quads.len(),
            rings.vertices.x.len(),
            rings.triangles.len(),
            rings.edges.len(),
            rings.triangle_count() as usize,
        ];
        (counts.map(|n| n as u32), !rings.clusters.is_empty())
    }

    /// The mesh of [`to_bytes`](Self::to_bytes). It gives the same results bit by bit.
    ///
    /// Nothing is trusted: any single word that is wrong is noticed by the checksum, and all
    /// numbers are checked even where the checksum is right. What is accepted is a mesh whose
    /// surface never hides what it does not cover. That an inner shape is inside its mesh cannot be
    /// checked without the mesh. Takes 7 to 9 ms for a million triangles, with adjacency a tenth as
    /// long as baking.
    ///
    /// # Errors
    /// [`CullError::BadMeshBytes`], with the reason.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CullError> {
        read(bytes).map_err(CullError::BadMeshBytes)
    }
}

/// Number of all bytes.
fn length(counts: [u32; LISTS], with_adjacency: bool) -> u64 {
    let rings = u64::from(with_adjacency) * RING * u64::from(counts[0]);
    let lists = counts
        .iter()
        .zip(SIZES)
        .map(|(n, size)| u64::from(*n) * size);
    let wider = u64::from(has_wide_homes(counts)) * WIDER_HOME * u64::from(counts[LISTS - 1]);
    HEADER as u64 + rings + lists.sum::<u64>() + wider
}

/// Whether numbers of clusters take more than 16 bits.
fn has_wide_homes(counts: [u32; LISTS]) -> bool {
    counts[0] > 1 << 16
}

fn put_home(bytes: &mut Vec<u8>, home: Home, wide: bool) {
    if wide {
        bytes.extend(home.cluster.to_le_bytes());
    } else {
        // What is none of the mesh is none of its first clusters either.
        bytes.extend((home.cluster as u16).to_le_bytes());
    }
    bytes.push(home.number);
}

fn put_vertices(bytes: &mut Vec<u8>, vertices: &Vertices) {
    for list in [&vertices.x, &vertices.y, &vertices.z] {
        bytes.extend(list.iter().flat_map(|v| v.to_le_bytes()));
    }
}

/// Writes the checksum.
pub(crate) fn seal(bytes: &mut [u8]) {
    let sum = checksum(bytes).to_le_bytes();
    bytes[CHECKSUM..CHECKSUM + 8].copy_from_slice(&sum);
}

/// The checksum of all bytes but its own. Every step is one-to-one in the sum so far and in the
/// word, so that one wrong word always changes the result.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, word: u64| {
        (sum ^ word)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
    };
    let (before, rest) = bytes.split_at(CHECKSUM.min(bytes.len()));
    let parts = [before, rest.get(8..).unwrap_or_default()];
    parts.iter().fold(0, |sum, part| {
        let (words, end) = part.as_chunks::<8>();
        let sum = words
            .iter()
            .fold(sum, |sum, word| step(sum, u64::from_le_bytes(*word)));
        end.iter()
            .fold(sum, |sum, byte| step(sum, u64::from(*byte)))
    })
}

/// What is left of the bytes.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], MeshBytesError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(ENDS)?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], MeshBytesError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(ENDS)?;
        self.0 = rest;
        Ok(*taken)
    }

    fn u16(&mut self) -> Result<u16, MeshBytesError> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, MeshBytesError> {
        self.array().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Result<f32, MeshBytesError> {
        self.array().map(f32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, MeshBytesError> {
        self.array().map(f64::from_le_bytes)
    }

    fn vertices(&mut self, count: u32) -> Result<Vertices, MeshBytesError> {
        let mut list = || -> Result<Vec<f32>, MeshBytesError> {
            let (all, _) = self.take(count as usize * 4)?.as_chunks::<4>();
            Ok(all.iter().map(|v| f32::from_le_bytes(*v)).collect())
        };
        Ok(Vertices {
            x: list()?,
            y: list()?,
            z: list()?,
            sources: Vec::new(),
        })
    }

    /// A list of `count` elements that are there.
    fn list<T>(
        &mut self,
        count: u32,
        read: impl Fn(&mut Self) -> Result<T, MeshBytesError>,
    ) -> Result<Vec<T>, MeshBytesError> {
        let mut list = Vec::with_capacity(count as usize);
        for _ in 0..count {
            list.push(read(self)?);
        }
        Ok(list)
    }

    /// Groups of eight, by corner.
    fn groups<const N: usize>(&mut self, count: u32) -> Result<Vec<[[u8; 8]; N]>, MeshBytesError> {
        let (rows, _) = self.take(count as usize * N * 8)?.as_chunks::<8>();
        Ok(rows.as_chunks::<N>().0.to_vec())
    }
}

const ENDS: MeshBytesError = MeshBytesError::Invalid("a list ends too early");

fn read(bytes: &[u8]) -> Result<OccluderMesh, MeshBytesError> {
    let mut from = Reader(bytes);
    if from.array() != Ok(MAGIC) {
        return Err(MeshBytesError::NotAMesh);
    }
    let found = bytes.len() as u64;
    let short = MeshBytesError::WrongLength {
        expected: HEADER as u64,
        found,
    };
    let version = from.u32().map_err(|_| short)?;
    if version != VERSION {
        return Err(MeshBytesError::OtherVersion {
            found: version,
            known: VERSION,
        });
    }
    let flags = from.u32().map_err(|_| short)?;
    let expected = from.array().map(u64::from_le_bytes).map_err(|_| short)?;
    if found < HEADER as u64 || found != expected {
        return Err(MeshBytesError::WrongLength {
            expected: expected.max(HEADER as u64),
            found,
        });
    }
    if from.array().map(u64::from_le_bytes) != Ok(checksum(bytes)) {
        return Err(MeshBytesError::Corrupt);
    }
    if flags & !(TWO_SIDED | ADJACENCY | INNER) != 0 {
        return Err(MeshBytesError::Invalid("a flag is not known"));
    }
    let (two_sided, with_adjacency) = (flags & TWO_SIDED != 0, flags & ADJACENCY != 0);
    let center = DVec3::new(from.f64()?, from.f64()?, from.f64()?);
    let mut counts = [0; LISTS];
    for count in &mut counts {
        *count = from.u32()?;
    }
    let solid = solid(&mut from, flags & INNER != 0)?;
    // From here on no list is longer than the bytes that are there.
    if length(counts, with_adjacency) != expected {
        return Err(MeshBytesError::Invalid("the lists do not fill the bytes"));
    }
    let [
        clusters,
        vertices,
        groups,
        ring_vertices,
        ring_groups,
        edges,
        homes,
    ] = counts;
    let rings = if with_adjacency { clusters } else { 0 };
    let clusters = from.list(clusters, cluster)?;
    let triangles = total_triangles(clusters.iter().map(|c| c.triangle_count))?;
    let rings = from.list(rings, ring)?;
    let mut mesh = OccluderMesh {
        vertices: from.vertices(vertices)?,
        quads: from.groups(groups)?,
        clusters,
        one_rings: OneRings {
            clusters: rings,
            vertices: from.vertices(ring_vertices)?,
            triangles: from.groups(ring_groups)?,
            edges: from.list(edges, edge)?,
        },
        bounds8: Vec::new(),
        center,
        half: Vec3::ZERO,
        two_sided,
        hash: 0,
        triangles,
        positions: None,
        solid,
    };
    let wide = has_wide_homes(counts);
    let homes = from.list(homes, |from| home(from, wide))?;
    lay_out(&mut mesh)?;
    if mesh.one_rings.triangle_count() != homes.len() as u64 {
        return Err(NOT_FILLED);
    }
    check::check(&mesh, &homes).map_err(MeshBytesError::Invalid)?;
    mesh.derive()?;
    check::check_solid(&mesh).map_err(MeshBytesError::Invalid)?;
    Ok(mesh)
}

/// The bounds of the mesh that an inner shape is inside, which other meshes have not.
fn solid(from: &mut Reader<'_>, is_inner: bool) -> Result<Option<Aabb>, MeshBytesError> {
    let mut corner = || Ok([from.f32()?, from.f32()?, from.f32()?]);
    let corners = [corner()?, corner()?];
    let none = corners.as_flattened().iter().all(|v| v.to_bits() == 0);
    match is_inner {
        true => Ok(Some(Aabb::new(corners[0], corners[1]))),
        false if none => Ok(None),
        false => Err(MeshBytesError::Invalid(
            "bounds of an inner shape where there is none",
        )),
    }
}

/// The number of all triangles; an error for more than baking takes.
fn total_triangles(of_clusters: impl Iterator<Item = u8>) -> Result<u32, MeshBytesError> {
    let total: u64 = of_clusters.map(u64::from).sum();
    if total <= MAX_TRIANGLES as u64 {
        Ok(total as u32)
    } else {
        Err(MeshBytesError::Invalid("there are too many triangles"))
    }
}

fn cluster(from: &mut Reader<'_>) -> Result<Cluster, MeshBytesError> {
    let cluster = Cluster {
        center: Vec3::ZERO,
        half: Vec3::ZERO,
        cone_axis: Vec3::new(from.f32()?, from.f32()?, from.f32()?),
        cone_sin: from.f32()?,
        cone_cos: from.f32()?,
        fill: from.f32()?,
        creased: from.f32()?,
        hash: from.u32()?,
        first_vertex: 0,
        first_group: 0,
        vertex_count: from.u16()?,
        quad_count: from.array::<1>()?[0],
        triangle_count: from.array::<1>()?[0],
    };
    check::check_counts(&cluster).map_err(MeshBytesError::Invalid)?;
    Ok(cluster)
}

fn ring(from: &mut Reader<'_>) -> Result<OneRing, MeshBytesError> {
    Ok(OneRing {
        first_vertex: 0,
        vertex_count: from.u16()?,
        first_group: 0,
        triangle_count: from.u16()?,
        first_edge: 0,
        edges: from.u16()?,
    })
}

fn edge(from: &mut Reader<'_>) -> Result<Edge, MeshBytesError> {
    Ok(Edge {
        triangles: [from.u16()?, from.u16()?],
        vertices: from.array()?,
    })
}

fn home(from: &mut Reader<'_>, wide: bool) -> Result<Home, MeshBytesError> {
    Ok(Home {
        cluster: if wide {
            from.u32()?
        } else {
            from.u16()?.into()
        },
        number: from.array::<1>()?[0],
    })
}

const NOT_FILLED: MeshBytesError = MeshBytesError::Invalid("the clusters do not fill the lists");

/// Finds where the parts of each cluster begin. They fill their lists.
fn lay_out(mesh: &mut OccluderMesh) -> Result<(), MeshBytesError> {
    let (mut vertices, mut groups) = (0u64, 0u64);
    for c in &mut mesh.clusters {
        (c.first_vertex, c.first_group) = (vertices as u32, groups as u32);
        vertices += u64::from(c.vertex_count).next_multiple_of(8);
        groups += u64::from(c.quad_count.div_ceil(8));
    }
    let rings = &mut mesh.one_rings;
    let (mut ring_vertices, mut ring_groups, mut edges) = (0u64, 0u64, 0u64);
    for r in &mut rings.clusters {
        (r.first_vertex, r.first_group) = (ring_vertices as u32, ring_groups as u32);
        r.first_edge = edges as u32;
        ring_vertices += u64::from(r.vertex_count);
        ring_groups += u64::from(r.triangle_count.div_ceil(8));
        edges += u64::from(r.edges);
    }
    let found = [
        mesh.vertices.x.len(),
        mesh.quads.len(),
        rings.vertices.x.len(),
        rings.triangles.len(),
        rings.edges.len(),
    ];
    if found.map(|n| n as u64) == [vertices, groups, ring_vertices, ring_groups, edges] {
        Ok(())
    } else {
        Err(NOT_FILLED)
    }
}

impl OccluderMesh {
    /// Sets what follows from vertices and quads.
    fn derive(&mut self) -> Result<(), MeshBytesError> {
        for c in &mut self.clusters {
            let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let first = c.first_vertex as usize;
            for i in first..first + usize::from(c.vertex_count) {
                let p = self.vertices.at(i);
                (lo, hi) = (lo.min(p), hi.max(p));
            }
            // Of infinite numbers bounds would be NaN, which is left out of the mesh's.
            if ![lo, hi]
                .iter()
                .all(|&p| relative(self.center, p).is_finite())
            {
                return Err(MeshBytesError::Invalid("the centre is too far away"));
            }
            (c.center, c.half) = bounds_of(self.center, lo, hi);
        }
        self.finish();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
