//! A mesh in the making: vertices in metres with box-mapped or explicit UVs, tangents at the end.

use glam::{Mat3, Mat4, Vec2, Vec3};

use foveal_scene::{Aabb, Mesh, Vertex};

/// Collects triangles; see [`shapes`](super::shapes) for what it can draw.
///
/// UVs are in metres (v downwards), the texture's size is the material's UV transform.
#[derive(Debug)]
pub(crate) struct MeshBuilder {
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
    place: Mat4,
    normal_place: Mat3,
    color: [u16; 4],
    pub(super) grain: bool,
}

impl MeshBuilder {
    /// An empty mesh.
    pub(crate) fn new() -> Self {
        Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            place: Mat4::IDENTITY,
            normal_place: Mat3::IDENTITY,
            color: [u16::MAX; 4],
            grain: false,
        }
    }

    /// Puts what follows at `place`, an affine transform that does not mirror.
    pub(crate) fn at(&mut self, place: Mat4) -> &mut Self {
        self.place = place;
        self.normal_place = Mat3::from_mat4(place).inverse().transpose();
        self
    }

    /// Gives what follows this linear vertex colour, 255 for 1.
    pub(crate) fn tint(&mut self, color: [u8; 3]) -> &mut Self {
        let [r, g, b] = color.map(|c| 257 * u16::from(c));
        self.color = [r, g, b, u16::MAX];
        self
    }

    /// Lets u run along the longest edge of the boxes that follow, as the grain of a beam does.
    pub(crate) fn along_grain(&mut self) -> &mut Self {
        self.grain = true;
        self
    }

    /// Adds a vertex and returns its index.
    pub(crate) fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        let index = self.vertices.len() as u32;
        let normal = (self.normal_place * normal)
            .try_normalize()
            .unwrap_or(Vec3::Y);
        self.vertices.push(Vertex {
            position: self.place.transform_point3(position).to_array(),
            normal: normal.to_array(),
            tangent: [0.0; 4],
            uv: [uv.to_array(), [0.0; 2]],
            color: self.color,
        });
        index
    }

    /// The index that the next vertex will get.
    pub(super) const fn next_index(&self) -> u32 {
        self.vertices.len() as u32
    }

    /// Adds a triangle, counter-clockwise from the front.
    pub(crate) fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.indices.extend([a, b, c]);
    }

    /// Adds two triangles, counter-clockwise from the front.
    pub(crate) fn quad(&mut self, a: u32, b: u32, c: u32, d: u32) {
        self.indices.extend([a, b, c, a, c, d]);
    }

    /// The finished mesh, with tangents for every vertex and exact bounds.
    pub(crate) fn finish(mut self, name: &str) -> Mesh {
        self.compute_tangents();
        Mesh {
            name: name.to_owned(),
            bounds: Aabb::of_points(
                self.indices
                    .iter()
                    .map(|&i| Vec3::from(self.vertices[i as usize].position)),
            ),
            vertices: self.vertices,
            indices: self.indices,
            ..Mesh::default()
        }
    }

    /// Tangents are dP/du, averaged over the triangles of a vertex. As v runs down the picture and
    /// a normal map's green up, the sign is +1 where (u, −v) is not mirrored.
    fn compute_tangents(&mut self) {
        let mut sums = vec![(Vec3::ZERO, 0.0f32); self.vertices.len()];
        for t in self.indices.as_chunks::<3>().0 {
            let [a, b, c] = t.map(|i| &self.vertices[i as usize]);
            let p = |v: &Vertex| Vec3::from(v.position);
            let uv = |v: &Vertex| Vec2::from(v.uv[0]);
            let (e1, e2) = (p(b) - p(a), p(c) - p(a));
            let (d1, d2) = (uv(b) - uv(a), uv(c) - uv(a));
            let det = d1.x * d2.y - d1.y * d2.x;
            let along_u = (e1 * d2.y - e2 * d1.y) * det.signum();
            let weight = e1.cross(e2).length();
            if let Some(along_u) = along_u.try_normalize() {
                for &i in t {
                    sums[i as usize].0 += along_u * weight;
                    sums[i as usize].1 -= det.signum() * weight;
                }
            }
        }
        for (vertex, (sum, sign)) in self.vertices.iter_mut().zip(sums) {
            let n = Vec3::from(vertex.normal);
            let t = (sum - n * n.dot(sum))
                .try_normalize()
                .unwrap_or_else(|| n.any_orthonormal_vector());
            vertex.tangent = t.extend(if sign < 0.0 { -1.0 } else { 1.0 }).to_array();
        }
    }
}
