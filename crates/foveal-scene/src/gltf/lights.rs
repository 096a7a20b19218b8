//! KHR_lights_punctual: definitions and placement.

use std::f32::consts::FRAC_PI_4;

use glam::{Mat4, Vec3};

use super::json::Obj;
use crate::error::{Flaw, Parsed};
use crate::{Code, Light, LightKind};

/// A light as the file has it.
pub(crate) struct LightDef {
    /// Without a place, or why it cannot be used.
    pub(crate) light: Result<Light, Flaw>,
}

impl LightDef {
    pub(crate) fn parse(o: Obj<'_>) -> Parsed<Self> {
        Ok(Self {
            light: parse_light(o),
        })
    }
}

fn parse_light(o: Obj<'_>) -> Parsed<Light> {
    let kind = match o.need("type", o.string("type")?)? {
        "directional" => LightKind::Directional,
        "point" => LightKind::Point,
        "spot" => {
            let angles = o.object("spot")?;
            let angle = |key, default| -> Parsed<f32> {
                match angles {
                    Some(angles) => {
                        let angle = angles.float(key).map_err(|e| e.under("spot"))?;
                        Ok(angle.unwrap_or(default))
                    }
                    None => Ok(default),
                }
            };
            let outer_rad = angle("outerConeAngle", FRAC_PI_4)?;
            LightKind::spot(angle("innerConeAngle", 0.0)?, outer_rad)
        }
        other => {
            return Err(Flaw::new(
                Code::ValueUnknown,
                format!("\"{other}\" is not a light type"),
            )
            .under("type"));
        }
    };
    Ok(Light {
        kind,
        color: o
            .floats("color")?
            .map_or(Vec3::ONE, Vec3::from)
            .max(Vec3::ZERO),
        intensity: o.float("intensity")?.unwrap_or(1.0).max(0.0),
        position: Vec3::ZERO,
        direction: Vec3::NEG_Z,
        range_m: o.float("range")?.filter(|&r| r > 0.0),
        node: None,
    })
}

/// Moves a light to its node: rays travel along the node's −z; scale does not touch it. Beyond the
/// range of numbers it is as far away as they reach, and lights nothing.
pub(crate) fn place(light: &mut Light, world_from_node: Mat4) {
    let position = world_from_node.w_axis.truncate();
    light.position = position.max(Vec3::MIN).min(Vec3::MAX);
    light.direction = (-world_from_node.z_axis.truncate())
        .try_normalize()
        .unwrap_or(Vec3::NEG_Z);
}
