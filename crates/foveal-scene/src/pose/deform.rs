//! Morph targets and skins: deformed vertices from a shape at rest.

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};

use crate::Vertex;

/// Joints of a skin; none of one that nothing shown needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    /// Node indices.
    pub(crate) joints: Vec<u32>,
    /// Joint space from the mesh's object space; at least one per joint.
    pub(crate) inverse_bind: Vec<Mat4>,
}

/// Per-vertex differences; an empty list means none.
#[derive(Clone, Debug, Default)]
pub(crate) struct MorphTarget {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) tangents: Vec<Vec3>,
    /// Of the two UV sets that the material uses.
    pub(crate) uvs: [Vec<Vec2>; 2],
    /// Linear RGBA.
    pub(crate) colors: Vec<Vec4>,
}

/// Up to eight joints per vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Influences {
    pub(crate) joints: Vec<[u16; 8]>,
    /// Not negative, sum 1.
    pub(crate) weights: Vec<[f32; 8]>,
}

/// What deforms of one primitive, shared by all nodes that show it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    /// Vertices at rest.
    pub(crate) rest: Vec<Vertex>,
    pub(crate) targets: Vec<MorphTarget>,
    pub(crate) influences: Option<Influences>,
    /// Every triangle has three vertices of its own and its normal is that of its plane, deformed
    /// too.
    pub(crate) flat: bool,
}

/// A shape at a node.
#[derive(Clone, Debug)]
pub(crate) struct Deformer {
    /// Index into the scene's meshes; that mesh belongs to this deformer alone.
    pub(crate) mesh: u32,
    pub(crate) node: u32,
    pub(crate) shape: std::sync::Arc<Shape>,
    /// Index into the rig's skins.
    pub(crate) skin: Option<u32>,
}

/// The mirror image of world space that skinned vertices are in where their joints mirror them.
pub(crate) const MIRROR: Mat4 = Mat4::from_cols(Vec4::NEG_X, Vec4::Y, Vec4::Z, Vec4::W);

impl Shape {
    /// Writes the vertices deformed by morph `weights` and then by `joint_matrices` (world from
    /// object). Without joint matrices the result is in object space, else in world space.
    ///
    /// True where the joints mirror most of the vertices: the result is then in [`MIRROR`]'s image
    /// of world space, in which triangles keep their winding.
    pub(crate) fn deform(
        &self,
        weights: &[f32],
        joint_matrices: Option<&[Mat4]>,
        out: &mut [Vertex],
    ) -> bool {
        let active: Vec<(&MorphTarget, f32)> = self
            .targets
            .iter()
            .zip(weights.iter().copied())
            .filter(|(_, w)| *w != 0.0)
            .collect();
        let moves_uvs = active
            .iter()
            .any(|(t, _)| t.uvs.iter().any(|list| !list.is_empty()));
        let moves_colors = active.iter().any(|(t, _)| !t.colors.is_empty());
        let skinning = joint_matrices.zip(self.influences.as_ref());
        let mut mirrored_vertices = 0;
        for (i, (vertex, rest)) in out.iter_mut().zip(&self.rest).enumerate() {
            let mut position = Vec3::from(rest.position);
            let mut normal = Vec3::from(rest.normal);
            let mut tangent = Vec4::from(rest.tangent);
            for (target, weight) in &active {
                let add = |list: &[Vec3]| list.get(i).map_or(Vec3::ZERO, |d| *d * *weight);
                position += add(&target.positions);
                normal += add(&target.normals);
                tangent += add(&target.tangents).extend(0.0);
            }
            if let Some((matrices, influences)) = skinning {
                let matrix = blend(matrices, influences, i);
                position = matrix.transform_point3(position);
                let cofactor = cofactor(matrix);
                let determinant = matrix.x_axis.truncate().dot(cofactor.x_axis);
                let handedness = if determinant < 0.0 { -1.0 } else { 1.0 };
                mirrored_vertices += usize::from(determinant < 0.0);
                normal = cofactor * (handedness * normal);
                tangent = matrix
                    .transform_vector3(tangent.truncate())
                    .extend(handedness * tangent.w);
            }
            if moves_uvs {
                vertex.uv = morphed_uvs(rest, &active, i);
            }
            if moves_colors {
                vertex.color = morphed_color(rest, &active, i);
            }
            // Weights and matrices may lead beyond the range of numbers.
            vertex.position = if position.is_finite() {
                position.to_array()
            } else {
                rest.position
            };
            vertex.normal = unit(normal, rest.normal);
            vertex.tangent = tangent
                .truncate()
                .try_normalize()
                .map_or(rest.tangent, |t| t.extend(tangent.w).to_array());
        }
        let is_mirrored = 2 * mirrored_vertices > self.rest.len();
        if is_mirrored {
            out.iter_mut().for_each(mirror);
        }
        if self.flat {
            for triangle in out.chunks_exact_mut(3) {
                let normal = crate::gltf::plane_normal(
                    triangle[0].position,
                    triangle[1].position,
                    triangle[2].position,
                );
                triangle.iter_mut().for_each(|v| v.normal = normal);
            }
        }
        is_mirrored
    }
}

/// Takes a vertex to or from [`MIRROR`]'s image.
fn mirror(vertex: &mut Vertex) {
    vertex.position[0] *= -1.0;
    vertex.normal[0] *= -1.0;
    let [x, _, _, w] = &mut vertex.tangent;
    *x *= -1.0;
    *w *= -1.0;
}

fn morphed_uvs(rest: &Vertex, active: &[(&MorphTarget, f32)], vertex: usize) -> [[f32; 2]; 2] {
    std::array::from_fn(|set| {
        let moved = active
            .iter()
            .fold(Vec2::from(rest.uv[set]), |uv, (t, weight)| {
                let delta = t.uvs[set].get(vertex).copied();
                uv + delta.unwrap_or(Vec2::ZERO) * *weight
            });
        if moved.is_finite() {
            moved.to_array()
        } else {
            rest.uv[set]
        }
    })
}

/// Clamped to what colours can be, as the specification says (section 3.7.2.2).
fn morphed_color(rest: &Vertex, active: &[(&MorphTarget, f32)], vertex: usize) -> [u16; 4] {
    let at_rest = Vec4::from(rest.color.map(f32::from)) / 65535.0;
    let moved = active.iter().fold(at_rest, |color, (t, weight)| {
        let delta = t.colors.get(vertex).copied();
        color + delta.unwrap_or(Vec4::ZERO) * *weight
    });
    if moved.is_finite() {
        (moved.clamp(Vec4::ZERO, Vec4::ONE) * 65535.0)
            .round()
            .to_array()
            .map(|x| x as u16)
    } else {
        rest.color
    }
}

fn unit(v: Vec3, fallback: [f32; 3]) -> [f32; 3] {
    v.try_normalize().map_or(fallback, |v| v.to_array())
}

/// The mean of a vertex's joints by their weights. Joints that do not exist have none.
fn blend(matrices: &[Mat4], influences: &Influences, vertex: usize) -> Mat4 {
    let (Some(joints), Some(weights)) = (
        influences.joints.get(vertex),
        influences.weights.get(vertex),
    ) else {
        return Mat4::IDENTITY;
    };
    let mut sum = Mat4::ZERO;
    let (mut found, mut is_whole) = (0.0, true);
    for (&joint, &weight) in joints.iter().zip(weights).filter(|(_, w)| **w > 0.0) {
        if let Some(matrix) = matrices.get(joint as usize) {
            sum += *matrix * weight;
            found += weight;
        } else {
            is_whole = false;
        }
    }
    if is_whole {
        sum
    } else if found > 0.0 {
        sum * (1.0 / found)
    } else {
        matrices.first().copied().unwrap_or(Mat4::IDENTITY)
    }
}

/// The inverse transpose times the determinant, whose sign normals do not take; safe for singular
/// matrices.
fn cofactor(matrix: Mat4) -> Mat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(Vec4::truncate);
    Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}
