//! Lights as shaders read them.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Light, LightKind};

/// More lights would need more workgroups in one dispatch than devices give, many times over.
pub(crate) const MAX_LIGHTS: usize = 16_384;

/// Irradiance at which a light without a range of its own ends, at an exposure in stops. An eighth of
/// the least that a picture of 8 bits shows of one light, since highlights are brighter and lights add
/// up. Half-precision radiance holds no more than 16 stops.
fn faintest(exposure_stops: f32) -> f32 {
    (-11.0 - exposure_stops.clamp(0.0, 16.0)).exp2()
}

/// Part of such a light's range within which its irradiance is above 2^-8: the root of an eighth.
const MOSTLY_SEEN: f32 = 0.353_553_4;

/// Mirrors `Light` in `shared/light.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct LightUniform {
    pub(crate) position: [f32; 3],
    pub(crate) range: f32,
    pub(crate) radiant: [f32; 3],
    pub(crate) spot_offset: f32,
    pub(crate) direction: [f32; 3],
    pub(crate) spot_scale: f32,
    pub(crate) cone_cos: f32,
    pub(crate) cone_sin: f32,
    pub(crate) kind: u32,
    pub(crate) seen_m: f32,
}

/// What precedes the lights in their table: mirrors the head of `Lights` in `shared/light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightsHeader {
    count: u32,
    words: u32,
    directional: u32,
    reserved: u32,
}

impl LightsHeader {
    pub(crate) fn new(lights: &[LightUniform]) -> Self {
        let count = lights.len() as u32;
        Self {
            count,
            words: count.div_ceil(32),
            directional: lights.iter().take_while(|l| l.is_directional()).count() as u32,
            reserved: 0,
        }
    }
}

impl LightUniform {
    /// All lights of a scene that is seen at an exposure in stops, directional ones first.
    pub(crate) fn all(lights: &[Light], exposure_stops: f32) -> Vec<Self> {
        let faintest = faintest(exposure_stops);
        let mut all: Vec<_> = lights.iter().map(|l| Self::new(l, faintest)).collect();
        all.sort_by_key(|light| !light.is_directional());
        all
    }

    /// By `kind` of `Light` in `shared/light.wgsl`.
    pub(crate) fn is_directional(&self) -> bool {
        self.kind == 0
    }

    fn new(light: &Light, faintest: f32) -> Self {
        let radiant = light.color * light.intensity;
        // An infinite light would be in every cluster: it ends where it is too faint.
        let range = (light.range_m.filter(|range| range.is_finite()))
            .unwrap_or_else(|| (radiant.max_element() / faintest).max(0.0).sqrt());
        let seen = if light.range_m.is_some_and(f32::is_finite) {
            1.0
        } else {
            MOSTLY_SEEN
        };
        let (kind, spot_scale, spot_offset, cone) = match light.kind {
            LightKind::Directional => (0, 0.0, 1.0, (-1.0, 0.0)),
            LightKind::Point => (1, 0.0, 1.0, (-1.0, 0.0)),
            LightKind::Spot {
                inner_rad,
                outer_rad,
            } => {
                // KHR_lights_punctual, 'Inner and outer cone angles'.
                let scale = 1.0 / (inner_rad.cos() - outer_rad.cos()).max(1e-3);
                (
                    2,
                    scale,
                    -outer_rad.cos() * scale,
                    (outer_rad.cos(), outer_rad.sin()),
                )
            }
        };
        Self {
            position: light.position.to_array(),
            range: range.max(1e-4),
            radiant: radiant.to_array(),
            spot_offset,
            direction: light.direction.to_array(),
            spot_scale,
            cone_cos: cone.0,
            cone_sin: cone.1,
            kind,
            seen_m: seen * range.max(1e-4),
        }
    }
}
