//! Tangents by MikkTSpace, the method that glTF prescribes and normal maps are baked for.
//!
//! The implementation at hand takes time in the square of the triangles around a vertex, recurses
//! over them, and searches the whole mesh for each triangle without area. So the latter are kept
//! from it, and meshes with excessive fans get the same angle-weighted means without the search for
//! connected fans, which is what MikkTSpace yields for clean surfaces.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace};
use glam::{Mat2, Mat3, Vec2, Vec3};

use super::normals;
use crate::Vertex;
use crate::pose::{MorphTarget, turn_of_uvs};

/// Most triangles around a vertex: bounds the recursion.
const MAX_FAN: u64 = 1024;
/// Most squares of fans, summed over the mesh: bounds the time (about 10 ns each).
const MAX_WORK: u64 = 50_000_000;

/// The texture coordinates that tangents follow: those that the normal map is read at.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct TangentUvs {
    /// The vertex's UV slot.
    slot: usize,
    /// What KHR_texture_transform makes of them, as bits: the columns of a matrix.
    turn: [u32; 4],
}

impl TangentUvs {
    /// A shift changes no direction, nor does a stretch along u or v: with these alone, meshes are
    /// shared.
    pub(crate) fn new(slot: usize, transform: Mat3) -> Self {
        let turn = turn_of_uvs(transform);
        let [[a, b], [c, d]] = turn.to_cols_array_2d();
        let stretches = b == 0.0 && c == 0.0 && a > 0.0 && d > 0.0;
        let turn = if stretches { Mat2::IDENTITY } else { turn };
        let turn = turn.to_cols_array().map(f32::to_bits);
        Self { slot, turn }
    }

    fn of(&self, vertex: &Vertex) -> Vec2 {
        let uv = Vec2::from(vertex.uv[self.slot]);
        let turn = Mat2::from_cols_array(&self.turn.map(f32::from_bits));
        // To the bit where nothing turns: a sum with zero would turn -0 into 0.
        if turn == Mat2::IDENTITY {
            uv
        } else {
            turn * uv
        }
    }
}

struct Corners<'a> {
    vertices: &'a [Vertex],
    /// Corners of the triangles with area.
    indices: &'a [u32],
    uvs: TangentUvs,
    tangents: Vec<[f32; 4]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.vertices[self.indices[face * 3 + corner] as usize]
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).position
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).normal
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs.of(self.vertex(face, corner)).to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let [x, y, z, w] = space.unwrap_or_default().tangent_encoded();
        // MikkTSpace takes v upwards, glTF's v points down while its normal maps' green points up.
        self.tangents[face * 3 + corner] = [x, y, z, -w];
    }
}

/// Generates tangents that follow `uvs`. Vertices whose corners disagree are split; the
/// result names the former vertex of each vertex when that happened.
pub(crate) fn generate(
    vertices: &mut Vec<Vertex>,
    indices: &mut [u32],
    uvs: TangentUvs,
) -> Option<Vec<u32>> {
    let at = |i: u32| vertices[i as usize].position;
    let has_area = |t: &[u32]| {
        let [a, b, c] = [at(t[0]), at(t[1]), at(t[2])];
        a != b && b != c && c != a
    };
    let solid: Vec<u32> = indices
        .chunks_exact(3)
        .filter(|t| has_area(t))
        .flatten()
        .copied()
        .collect();
    let tangents = if is_tame(vertices, &solid, uvs.slot) {
        let mut corners = Corners {
            vertices,
            indices: &solid,
            uvs,
            tangents: vec![[1.0, 0.0, 0.0, 1.0]; solid.len()],
        };
        // The error type has no values.
        let _ = bevy_mikktspace::generate_tangents(&mut corners);
        corners.tangents
    } else {
        means(vertices, &solid, uvs)
    };
    let mut of_solid = tangents.into_iter();
    let mut split = Split::new(vertices.len());
    for triangle in indices.chunks_exact_mut(3) {
        if has_area_of(vertices, triangle) {
            for (index, tangent) in triangle.iter_mut().zip(&mut of_solid) {
                let tangent = unit_or(tangent, vertices[*index as usize].normal);
                *index = split.assign(vertices, *index, tangent);
            }
        }
    }
    // What only triangles without area use is never seen, but must be a unit vector.
    for (vertex, given) in vertices.iter_mut().zip(&split.given) {
        if !given {
            vertex.tangent = unit_or([0.0; 4], vertex.normal);
        }
    }
    split.sources()
}

/// The tangent, or any one across the normal where positions or UVs of extreme size gave none.
fn unit_or(tangent: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let [x, y, z, w] = tangent;
    let length = Vec3::new(x, y, z).length();
    if (length - 1.0).abs() < 1e-3 {
        return tangent;
    }
    let across = Vec3::from(normal).any_orthonormal_vector();
    across.extend(if w < 0.0 { -1.0 } else { 1.0 }).to_array()
}

fn has_area_of(vertices: &[Vertex], t: &[u32]) -> bool {
    let [a, b, c] = [t[0], t[1], t[2]].map(|i| vertices[i as usize].position);
    a != b && b != c && c != a
}

/// Hands out tangents to vertices and makes a twin where one has another already.
struct Split {
    given: Vec<bool>,
    twins: HashMap<(u32, [u32; 4]), u32>,
    source: Vec<u32>,
}

impl Split {
    fn new(count: usize) -> Self {
        Self {
            given: vec![false; count],
            twins: HashMap::new(),
            source: Vec::new(),
        }
    }

    fn assign(&mut self, vertices: &mut Vec<Vertex>, index: u32, tangent: [f32; 4]) -> u32 {
        let at = index as usize;
        if !self.given[at] {
            self.given[at] = true;
            vertices[at].tangent = tangent;
            return index;
        }
        if vertices[at].tangent == tangent {
            return index;
        }
        let key = (index, tangent.map(f32::to_bits));
        *self.twins.entry(key).or_insert_with(|| {
            vertices.push(Vertex {
                tangent,
                ..vertices[at]
            });
            self.source.push(index);
            vertices.len() as u32 - 1
        })
    }

    fn sources(self) -> Option<Vec<u32>> {
        let before = self.given.len() as u32;
        (!self.source.is_empty()).then(|| (0..before).chain(self.source).collect())
    }
}

/// Position, normal and UV, by which MikkTSpace joins corners.
fn weld_key(vertex: &Vertex, uv_slot: usize) -> [u32; 8] {
    let ([a, b, c], [d, e, f]) = (vertex.position, vertex.normal);
    let [u, v] = vertex.uv[uv_slot];
    [a, b, c, d, e, f, u, v].map(f32::to_bits)
}

/// Whether the implementation's worst cases are far away.
fn is_tame(vertices: &[Vertex], solid: &[u32], uv_slot: usize) -> bool {
    let mut corners = vec![0u64; vertices.len()];
    solid.iter().for_each(|&i| corners[i as usize] += 1);
    // Only when single vertices could add up to a large fan must they be welded to know.
    let mut keys: Vec<([u32; 8], u64)> = vertices
        .iter()
        .zip(&corners)
        .filter(|(_, n)| **n > 0)
        .map(|(v, n)| (weld_key(v, uv_slot), *n))
        .collect();
    keys.sort_unstable();
    let mut work = 0u64;
    for group in keys.chunk_by(|a, b| a.0 == b.0) {
        let fan: u64 = group.iter().map(|(_, n)| n).sum();
        work = work.saturating_add(fan.saturating_mul(fan));
        if fan > MAX_FAN {
            return false;
        }
    }
    work <= MAX_WORK.max(solid.len() as u64 * 64)
}

/// What the corners of a triangle add to tangents: the direction in which u grows, along the surface at
/// each corner and by its angle; and whether u and v are as the triangle runs.
fn shares(of: [&Vertex; 3], uvs: TangentUvs) -> ([Vec3; 3], bool) {
    let p = of.map(|v| Vec3::from(v.position));
    let uv = of.map(|v| uvs.of(v));
    let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
    let area = d1.perp_dot(d2);
    let along = ((p[1] - p[0]) * d2.y - (p[2] - p[0]) * d1.y) * area.signum();
    let share = |k: usize| {
        let normal = Vec3::from(of[k].normal);
        let flat = |v: Vec3| v.reject_from_normalized(normal).normalize_or_zero();
        let (e1, e2) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        let angle = flat(e1).dot(flat(e2)).clamp(-1.0, 1.0).acos();
        flat(along) * angle
    };
    (std::array::from_fn(share), area > 0.0)
}

/// Angle-weighted means per welded vertex and orientation; one tangent per corner.
fn means(vertices: &[Vertex], solid: &[u32], uvs: TangentUvs) -> Vec<[f32; 4]> {
    let mut sums: HashMap<([u32; 8], bool), Vec3> = HashMap::new();
    let mut corners = Vec::with_capacity(solid.len());
    for t in solid.chunks_exact(3) {
        let of = [t[0], t[1], t[2]].map(|i| &vertices[i as usize]);
        let (shares, is_along) = shares(of, uvs);
        for (vertex, share) in of.into_iter().zip(shares) {
            let key = (weld_key(vertex, uvs.slot), is_along);
            *sums.entry(key).or_default() += share;
            corners.push((key, Vec3::from(vertex.normal)));
        }
    }
    corners
        .into_iter()
        .map(|(key, normal)| {
            let tangent = sums
                .get(&key)
                .and_then(|s| s.try_normalize())
                .unwrap_or_else(|| normal.any_orthonormal_vector());
            tangent.extend(if key.1 { -1.0 } else { 1.0 }).to_array()
        })
        .collect()
}

/// Gives morph targets that have no tangents the differences that they make to generated ones: those of
/// the means at rest and where a target is in full effect (glTF 2.0, section 3.7.2.2). `flat`: normals
/// are those of the planes.
pub(crate) fn add_to_targets(
    targets: &mut [MorphTarget],
    vertices: &[Vertex],
    indices: &[u32],
    uvs: TangentUvs,
    flat: bool,
) {
    let moves = |t: &MorphTarget| {
        !(t.positions.is_empty() && t.normals.is_empty() && t.uvs[uvs.slot].is_empty())
    };
    let mut at_rest = None;
    for target in targets
        .iter_mut()
        .filter(|t| t.tangents.is_empty() && moves(t))
    {
        let at_rest = at_rest.get_or_insert_with(|| means_of_vertices(vertices, indices, uvs));
        let mut morphed = vertices.to_vec();
        for (i, vertex) in morphed.iter_mut().enumerate() {
            morph(vertex, i, target, uvs.slot);
        }
        if flat {
            normals::flat(&mut morphed);
        }
        let now = means_of_vertices(&morphed, indices, uvs);
        // Where the triangles of a vertex tell no direction, its tangent stays.
        let delta = |(now, before): (Option<Vec3>, &Option<Vec3>)| {
            now.zip(*before)
                .map_or(Vec3::ZERO, |(now, before)| now - before)
        };
        target.tangents = now.into_iter().zip(at_rest.iter()).map(delta).collect();
    }
}

/// Moves what the tangent of a vertex follows by a target in full effect.
fn morph(vertex: &mut Vertex, i: usize, target: &MorphTarget, uv_slot: usize) {
    let delta = |list: &[Vec3]| list.get(i).copied().unwrap_or(Vec3::ZERO);
    let normal = Vec3::from(vertex.normal) + delta(&target.normals);
    vertex.position = (Vec3::from(vertex.position) + delta(&target.positions)).to_array();
    vertex.normal = normal.normalize_or(vertex.normal.into()).to_array();
    let moved = target.uvs[uv_slot].get(i).copied().unwrap_or(Vec2::ZERO);
    vertex.uv[uv_slot] = (Vec2::from(vertex.uv[uv_slot]) + moved).to_array();
}

/// Angle-weighted means, one per vertex; `None` where its triangles tell no direction.
fn means_of_vertices(vertices: &[Vertex], indices: &[u32], uvs: TangentUvs) -> Vec<Option<Vec3>> {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for t in indices.chunks_exact(3) {
        let (shares, _) = shares([t[0], t[1], t[2]].map(|i| &vertices[i as usize]), uvs);
        for (&i, share) in t.iter().zip(shares) {
            sums[i as usize] += share;
        }
    }
    sums.into_iter().map(Vec3::try_normalize).collect()
}
