//! Where a light's shadows are looked up: the receivers within its reach, grown by biases and filters.
//!
//! Mirrors `shadows.wgsl` and `shadow_sampling.wgsl` of Bevy 0.19: a place is moved by both biases, and
//! the map is read beside it.

use crate::mask::{Footprint, Mask, Projector};
use crate::receivers::Receiver;
use bevy_light::{DirectionalLight, PointLight, SpotLight};
use bevy_math::Vec3;
use bevy_reflect::structs::Struct;
use bevy_transform::components::GlobalTransform;
use core::f32::consts::SQRT_2;
use foveal_cull::{Aabb, Visibility};

/// Filters of point lights read so far beside a place, by its distance: `POINT_SHADOW_SCALE` times
/// the farthest of the samples.
const POINT_FILTER: f32 = 0.004;
/// Texels that a point light's filter reads beside that, and across the edges of faces.
const POINT_TEXELS: f32 = 3.0;
/// Texels that filters of the other lights read beside a place.
const FLAT_TEXELS: f32 = 5.0;
/// The same of the temporal filter, in metres: it is wider where cascades are small.
const FLAT_M: f32 = 0.012;

/// Where a light's shadows are looked up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Place, range, and the distance within which nothing casts a shadow; `None` for a directional
    /// light.
    sphere: Option<(Vec3, f32, f32)>,
    /// How far beside itself a place is looked up, metres, and how much farther by each metre of
    /// distance.
    beside: [f32; 2],
}

impl Reach {
    pub(crate) fn of_point_light(
        light: &PointLight,
        transform: &GlobalTransform,
        side: Option<usize>,
    ) -> Self {
        let texel = 2.0 / side.unwrap_or(1) as f32;
        let bias = light.shadow_normal_bias.abs() * SQRT_2;
        Self {
            sphere: Some((
                transform.translation(),
                light.range,
                light.shadow_map_near_z,
            )),
            beside: [
                light.shadow_depth_bias.abs(),
                texel * (bias + POINT_TEXELS) + POINT_FILTER,
            ],
        }
    }

    pub(crate) fn of_spot_light(
        light: &SpotLight,
        transform: &GlobalTransform,
        side: Option<usize>,
    ) -> Self {
        let texel = 2.0 * light.outer_angle.tan() / side.unwrap_or(1) as f32;
        let bias = light.shadow_normal_bias.abs() * SQRT_2;
        Self {
            sphere: Some((
                transform.translation(),
                light.range,
                light.shadow_map_near_z,
            )),
            beside: [light.shadow_depth_bias.abs(), texel * (bias + FLAT_TEXELS)],
        }
    }

    /// `texel`: the side of the largest texel of its cascades, metres; `coarser`: how many times as wide
    /// texels are drawn.
    pub(crate) fn of_directional_light(light: &DirectionalLight, texel: f32, coarser: f32) -> Self {
        let bias = light.shadow_normal_bias.abs() * SQRT_2;
        let filter = coarser * (texel * (bias + FLAT_TEXELS) + FLAT_M);
        Self {
            sphere: None,
            beside: [light.shadow_depth_bias.abs() + filter, 0.0],
        }
    }

    /// The receivers within it.
    pub(crate) fn of(self, receivers: &[Receiver]) -> SeenByLight {
        let mut seen = SeenByLight::default();
        for receiver in receivers {
            let (min, max) = (
                Vec3::from(receiver.bounds.min),
                Vec3::from(receiver.bounds.max),
            );
            let mut reach = f32::INFINITY;
            let mut distance = 0.0;
            if let Some((place, range, near)) = self.sphere {
                let nearest = place.clamp(min, max).distance(place);
                // Not with NaN either.
                if nearest > range * 1.0001 {
                    continue;
                }
                let farthest = (place - min).abs().max((place - max).abs()).length();
                distance = farthest.min(range);
                reach = range;
                seen.anyway |= nearest < 2.0 * near;
            }
            seen.anyway |= receiver.lit_anyway;
            if !receiver.shadowed {
                continue;
            }
            let beside = 1.01 * (self.beside[0] + self.beside[1] * distance) + 1e-4;
            let bounds = Aabb::new(min - beside, max + beside);
            seen.boxes.push(bounds);
            seen.reaches.push(f64::from(reach + beside));
        }
        seen
    }
}

/// What cameras see within a light's reach.
#[derive(Debug, Default)]
pub(crate) struct SeenByLight {
    /// Boxes that hold all places at which shadows are looked up, and the distance at which they end.
    boxes: Vec<Aabb>,
    reaches: Vec<f64>,
    /// Whether something is lit without shadows.
    pub(crate) anyway: bool,
}

impl SeenByLight {
    /// What a shadow map has to do with it.
    pub(crate) fn on_map(&self, projector: Projector) -> SeenOnMap {
        let mut mask = Mask::new(projector);
        let (mut boxes, mut footprints) = (Vec::new(), Vec::new());
        for (bounds, &reach) in self.boxes.iter().zip(&self.reaches) {
            if let Some(footprint) = mask.receive(bounds, reach) {
                boxes.push(*bounds);
                footprints.push(footprint);
            }
        }
        SeenOnMap {
            mask,
            boxes,
            footprints,
        }
    }
}

/// What cameras see within a light's reach and within a shadow map.
#[derive(Debug)]
pub(crate) struct SeenOnMap {
    mask: Mask,
    boxes: Vec<Aabb>,
    footprints: Vec<Footprint>,
}

impl SeenOnMap {
    pub(crate) fn is_nothing(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Whether a caster's shadow may fall on some of it, were all of it lit.
    pub(crate) fn may_show(&self, bounds: &Aabb) -> bool {
        !self.is_nothing() && self.mask.shows(bounds, true)
    }

    /// Finds what may be lit; returns whether something is. `look` finds what occluders hide from the
    /// light.
    pub(crate) fn light(&mut self, look: impl FnOnce(&[Aabb], &mut [Visibility])) -> bool {
        let mut results = vec![Visibility::Visible; self.boxes.len()];
        look(&self.boxes, &mut results);
        let mut lit = false;
        for (footprint, result) in self.footprints.iter().zip(results) {
            if result != Visibility::Occluded {
                self.mask.light(footprint);
                lit = true;
            }
        }
        lit
    }

    /// Whether a caster's shadow may be seen, after [`Self::light`]. `occludes`: whether it is an
    /// occluder of this map, by which receivers may be hidden.
    pub(crate) fn shows(&self, bounds: &Aabb, occludes: bool) -> bool {
        self.mask.shows(bounds, occludes)
    }
}

/// Whether a light has soft shadows, whose filters are as wide as they like. The fields are there only
/// with a feature of Bevy's.
pub(crate) fn is_soft(light: &dyn Struct) -> bool {
    let enabled = light
        .field("soft_shadows_enabled")
        .and_then(|field| field.try_downcast_ref::<bool>());
    let size = light
        .field("soft_shadow_size")
        .and_then(|field| field.try_downcast_ref::<Option<f32>>());
    enabled == Some(&true) || size.is_some_and(Option::is_some)
}
