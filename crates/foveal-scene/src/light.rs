//! Lights: punctual ones as in KHR_lights_punctual, and the surroundings.

use std::f32::consts::FRAC_PI_2;

use glam::Vec3;

/// What kind of punctual light it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel rays along the light's direction; intensity in lux.
    Directional,
    /// All around; intensity in candela.
    Point,
    /// A cone around the light's direction; intensity in candela.
    Spot {
        /// Half angle in radians where the fall-off begins, 0 ≤ inner < outer.
        inner_rad: f32,
        /// Half angle in radians where the light ends, ≤ π/2.
        outer_rad: f32,
    },
}

impl LightKind {
    /// A spot light, its half angles in radians brought into their ranges; both must be numbers.
    pub(crate) fn spot(inner_rad: f32, outer_rad: f32) -> Self {
        let outer_rad = outer_rad.clamp(1e-4, FRAC_PI_2);
        Self::Spot {
            // Shaders divide by the difference of the cosines.
            inner_rad: inner_rad.clamp(0.0, outer_rad * 0.9999),
            outer_rad,
        }
    }
}

/// A punctual light in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Kind and its own parameters.
    pub kind: LightKind,
    /// Linear RGB, not multiplied by the intensity.
    pub color: Vec3,
    /// Lux for directional, candela for point and spot lights.
    pub intensity: f32,
    /// Position in metres (unused by directional lights).
    pub position: Vec3,
    /// Unit vector of travel of the light's rays (unused by point lights).
    pub direction: Vec3,
    /// Distance in metres at which it ends; `None`, or infinite: where it becomes invisible.
    pub range_m: Option<f32>,
    /// The glTF node that carries it, so that animation can move it.
    pub node: Option<u32>,
}

/// Light from everywhere else: a vertical gradient that is both backdrop and ambient term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance straight up, linear RGB.
    pub zenith: Vec3,
    /// Radiance at the horizon, linear RGB.
    pub horizon: Vec3,
    /// Radiance straight down, linear RGB.
    pub nadir: Vec3,
}

impl Default for Environment {
    /// A soft overcast day.
    fn default() -> Self {
        Self {
            zenith: Vec3::new(0.35, 0.48, 0.75),
            horizon: Vec3::new(0.75, 0.78, 0.82),
            nadir: Vec3::new(0.22, 0.20, 0.18),
        }
    }
}
