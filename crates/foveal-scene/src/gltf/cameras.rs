//! Cameras: definitions, and their placement with a rigid transform.

use glam::{Mat3, Mat4, Vec3};

use super::budget::Budget;
use super::json::Obj;
use super::nodes::NodeDef;
use crate::error::{Flaw, Parsed};
use crate::{Camera, Code, Projection};

/// Memory of a camera at a node with the longest name, in bytes.
const CAMERA_BYTES: u64 = 1200;

/// Counts the memory of the cameras at those nodes that are reached.
pub(crate) fn take_memory(nodes: &[NodeDef], reached: &[bool], budget: &Budget) -> Parsed<()> {
    let carriers = nodes.iter().zip(reached);
    let carriers = carriers.filter(|(node, reached)| **reached && node.camera.is_some());
    let bytes = CAMERA_BYTES.saturating_mul(carriers.count() as u64);
    budget.take(bytes, "cameras").map_err(|e| e.under("nodes"))
}

/// A camera as the file has it.
pub(crate) struct CameraDef {
    pub(crate) name: Option<String>,
    /// Or why it cannot be looked through.
    pub(crate) projection: Result<Projection, Flaw>,
}

impl CameraDef {
    pub(crate) fn parse(o: Obj<'_>) -> Parsed<Self> {
        Ok(Self {
            name: o.name("name")?,
            projection: parse_projection(o),
        })
    }

    /// The camera at a node. `node_name` is the fallback for its own name.
    pub(crate) fn place(
        &self,
        projection: Projection,
        node_name: Option<&str>,
        number: usize,
        world_from_node: Mat4,
    ) -> Camera {
        let name = [node_name, self.name.as_deref()]
            .into_iter()
            .flatten()
            .find(|n| !n.is_empty());
        Camera {
            name: name.map_or_else(|| format!("camera {number}"), str::to_owned),
            world_from_view: rigid(world_from_node),
            projection,
        }
    }
}

fn parse_projection(o: Obj<'_>) -> Parsed<Projection> {
    let positive = |of: Obj<'_>, key: &str| -> Parsed<f32> {
        let value = of.need(key, of.float(key)?)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(Flaw::new(Code::ValueOutOfRange, format!("is {value}, not above 0")).under(key))
        }
    };
    match o.need("type", o.string("type")?)? {
        "perspective" => {
            let p = o.need("perspective", o.object("perspective")?)?;
            let parse = || -> Parsed<Projection> {
                let fov_y_rad = positive(p, "yfov")?;
                if fov_y_rad >= std::f32::consts::PI {
                    return Err(Flaw::new(
                        Code::ValueOutOfRange,
                        format!("is {fov_y_rad}, not below π"),
                    )
                    .under("yfov"));
                }
                // The far plane, where there is one, is given up: depth is infinite.
                Ok(Projection::Perspective {
                    fov_y_rad,
                    near_m: positive(p, "znear")?,
                })
            };
            parse().map_err(|e| e.under("perspective"))
        }
        "orthographic" => {
            let p = o.need("orthographic", o.object("orthographic")?)?;
            let parse = || -> Parsed<Projection> {
                // Negative magnifications occur in the wild and mirror the picture; the size is
                // what is meant.
                let y_mag = p.need("ymag", p.float("ymag")?)?.abs();
                if y_mag <= 0.0 {
                    return Err(Flaw::new(Code::ValueOutOfRange, "is 0").under("ymag"));
                }
                let near_m = p.need("znear", p.float("znear")?)?;
                let far_m = p.need("zfar", p.float("zfar")?)?;
                if far_m <= near_m {
                    return Err(Flaw::new(
                        Code::ValueOutOfRange,
                        format!("is {far_m}, not beyond znear = {near_m}"),
                    )
                    .under("zfar"));
                }
                Ok(Projection::Orthographic {
                    height_m: 2.0 * y_mag,
                    near_m,
                    far_m,
                })
            };
            parse().map_err(|e| e.under("orthographic"))
        }
        other => Err(Flaw::new(
            Code::ValueUnknown,
            format!("\"{other}\" is not a camera type"),
        )
        .under("type")),
    }
}

/// The rigid transform next to a node's: its position, its −z as view direction, its y upwards;
/// scale, shear and mirroring are dropped, as the specification asks for cameras.
pub(crate) fn rigid(world_from_node: Mat4) -> Mat4 {
    let axis = |v: glam::Vec4| v.truncate().try_normalize();
    let back = axis(world_from_node.z_axis).unwrap_or(Vec3::Z);
    let up = axis(world_from_node.y_axis).unwrap_or(Vec3::Y);
    let right = up
        .cross(back)
        .try_normalize()
        .unwrap_or_else(|| back.any_orthonormal_vector());
    let up = back.cross(right);
    let place = world_from_node.w_axis.truncate();
    let place = if place.is_finite() { place } else { Vec3::ZERO };
    Mat4::from_mat3_translation(Mat3::from_cols(right, up, back), place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_scaled_sheared_or_mirrored_camera_is_rigid() {
        let place = Vec3::new(1.0, 2.0, 3.0);
        let turn = Quat::from_rotation_y(0.7);
        for scale in [
            Vec3::ONE,
            Vec3::splat(8.0),
            Vec3::new(-1.0, 1.0, 1.0),
            Vec3::new(2.0, 0.5, 3.0),
            Vec3::ZERO,
        ] {
            let matrix = rigid(Mat4::from_scale_rotation_translation(scale, turn, place));
            assert!((matrix.determinant() - 1.0).abs() < 1e-5, "{scale}");
            assert_eq!(matrix.w_axis.truncate(), place);
            let back = matrix.z_axis.truncate();
            if scale.z > 0.0 {
                assert!(back.abs_diff_eq(turn * Vec3::Z, 1e-6), "{scale}");
            }
        }
    }
}
