//! The CPU twin of what the device carries along and reshades, of one eye.

use std::f32::consts::PI;

use foveal_scene::Camera;
use glam::{IVec2, UVec2, Vec2, Vec3};

use super::passes::HistoryParameters;
use crate::shading::sample_texel;
use crate::shading::twin::{
    Surface, environment_reflectance, luminance, position_at, squared_alpha, to_eye,
    unit_from_square, unpack_surface,
};
use crate::testing::f32_of_half;

/// The constants of `layout.wgsl` and `reproject.wgsl`.
const INSTANCE: u32 = 0xfff;
const LEVEL_SHIFT: u32 = 12;
const AT_ALL: u32 = 0x8000;
const OWN: u32 = 0x1_0000;
const DISTANCE: u32 = 0xfffe_0000;
const SAME_DISTANCE: f32 = 0.02;
const SAME_NORMAL: f32 = 0.95;
const HAS_MOVED: u32 = 1;
const MOST_TURNED: f32 = 0.1;
const TURN_AS_ERROR: f32 = 2.0;
const LEAST_SQUARED_ALPHA: f32 = 0.0004;
const HARDLY_SHOWS: f32 = 0.2;
const LEAST_FACING: f32 = 0.2;
const MOST_LARGER: f32 = 1.19;
const LEAST_RENEWAL: f32 = 1.0 / 512.0;
const MOST_A_BLOCK: f32 = 2.0;

/// What the pass reads of the frame at hand.
pub(super) struct Seen {
    pub(super) size: UVec2,
    pub(super) surface: Vec<[u32; 4]>,
    pub(super) depth: Vec<f32>,
    pub(super) identity: Vec<[u32; 2]>,
    /// Of 2 x 2 pixels each.
    pub(super) owner: Vec<u8>,
}

/// What it reads of the frame before.
pub(super) struct Before {
    pub(super) light: Vec<[u32; 4]>,
    pub(super) seen: Vec<u32>,
    /// Error and change of each tile.
    pub(super) tiles: Vec<[f32; 2]>,
}

/// What becomes of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fate {
    Backdrop,
    /// Its light is reprojected.
    Reprojected,
    /// It is shaded by itself.
    Shaded,
    /// It takes the light of the samples around it.
    Bare,
}

/// A pixel's fate, and what it keeps besides light from here on.
pub(super) type Reprojected = (Fate, u32);

/// `turn_by_width`.
fn turn_by_width(s: &Surface, v: Vec3, before: Vec3) -> f32 {
    let a2 = squared_alpha(s).max(LEAST_SQUARED_ALPHA);
    let peak = luminance(environment_reflectance(s, v)) * 0.25 / (PI * a2);
    let scattered = luminance((1.0 - s.metallic) * s.base_color / PI);
    let share = (peak / scattered.max(1e-3) - HARDLY_SHOWS).clamp(0.0, 1.0);
    v.distance(before) / a2.sqrt() * share
}

/// `was_larger`.
fn was_larger(sides: [f32; 2], facing: [f32; 2]) -> bool {
    let seen = facing.map(|cosine| cosine.abs().max(LEAST_FACING));
    sides[0] * seen[0].max(seen[1]) > MOST_LARGER * sides[1] * seen[0]
}

impl Seen {
    fn level(&self, texel: UVec2) -> u32 {
        let across = self.size.x.div_ceil(2);
        u32::from(self.owner[(texel.y / 2 * across + texel.x / 2) as usize] & 15)
    }

    fn index(&self, texel: UVec2) -> usize {
        (texel.y * self.size.x + texel.x) as usize
    }

    /// `reproject.wgsl`, of perspective cameras and without lights that have changed.
    pub(super) fn reproject(
        &self,
        [camera, previous]: [&Camera; 2],
        before: &Before,
        parameters: &HistoryParameters,
        texel: UVec2,
    ) -> Reprojected {
        let i = self.index(texel);
        let depth = self.depth[i];
        if depth == 0.0 {
            return (Fate::Backdrop, 0);
        }
        let level = self.level(texel);
        let distance = camera.clip_from_view(1.0).w_axis.z / depth;
        let pixel = texel.as_vec2() + 0.5;
        let position = position_at(camera, self.size.as_vec2(), pixel, depth);
        let aspect = self.size.x as f32 / self.size.y as f32;
        let s = unpack_surface(self.surface[i], position);
        let [v, v_then] = [camera, previous].map(|camera| to_eye(camera, position));
        let expected = (previous.clip_from_world(aspect) * position.extend(1.0)).w;
        let [who, motion] = self.identity[i];
        let has_moved = motion & HAS_MOVED != 0;
        let motion = Vec2::from([motion as u16, (motion >> 16) as u16].map(f32_of_half));
        let half_width = |camera: &Camera| 1.0 / camera.clip_from_view(aspect).x_axis.x;
        let sides = [
            half_width(previous) * expected,
            half_width(camera) * distance,
        ];
        let is_coarser = was_larger(sides, [v_then, v].map(|v| s.normal.dot(v)));
        let turned = turn_by_width(&s, v, v_then);
        let remembered = |place: Vec2| {
            let place = place.as_ivec2();
            let inside = place.cmpge(IVec2::ZERO).all() && place.as_uvec2().cmplt(self.size).all();
            let from = inside.then(|| place.as_uvec2())?;
            let mut old = before.seen[self.index(from)];
            if parameters.whole_round != 0 {
                old = (old | OWN) & !(7 << LEVEL_SHIFT);
            }
            let across = self.size.x.div_ceil(8);
            let tile = before.tiles[(from.y / 8 * across + from.x / 8) as usize];
            let bits = before.light[self.index(from)][3] >> 20;
            let part = |by: u32| (bits >> by & 63) as f32 / 31.0 - 1.0;
            let then = unit_from_square(Vec2::new(part(0), part(6)));
            let away = (f32::from_bits((old & DISTANCE) >> 1) - expected).abs();
            let known = parameters.reset == 0
                && !has_moved
                && !is_coarser
                && turned <= MOST_TURNED
                && old & AT_ALL != 0
                && (old ^ who) & INSTANCE == 0
                && away <= SAME_DISTANCE * expected
                && (old >> LEVEL_SHIFT & 7) <= level
                && tile[1] < parameters.change
                && then.dot(s.normal) > SAME_NORMAL;
            known.then_some((old, tile))
        };
        let place = pixel - motion;
        let rounded = (place + Vec2::from(parameters.rounding)).floor();
        let first = (place - 0.5).floor();
        let found = remembered(rounded).or_else(|| {
            (1..4u32).find_map(|i| {
                let step = UVec2::new(i & 1, i >> 1 & 1).as_vec2();
                remembered(first + (rounded - first - step).abs())
            })
        });
        let distance_bits = (distance.to_bits() + 0x8000) << 1 & DISTANCE;
        let now = who & INSTANCE | AT_ALL | distance_bits;
        if let Some((old, [error, _])) = found {
            let block = 0.25_f32.powi(level as i32);
            let error = error.max(TURN_AS_ERROR * turned);
            let haste =
                (error / parameters.tolerance).clamp(1.0, MOST_A_BLOCK / parameters.renewal);
            let share = (block * parameters.renewal * haste).clamp(LEAST_RENEWAL.min(block), 1.0);
            let order = (texel.x.wrapping_mul(3_242_174_889))
                .wrapping_add(texel.y.wrapping_mul(2_447_445_414));
            let is_renewed =
                (order.wrapping_add(parameters.phase) as f32) < share * 4_294_967_296.0;
            let block = texel >> level;
            let sample = sample_texel(block.into(), level, 0, self.size.into());
            let is_block_sample = level > 0 && UVec2::from(sample) == texel;
            if !is_renewed {
                return (Fate::Reprojected, now | old & (OWN | 7 << LEVEL_SHIFT));
            } else if !is_block_sample {
                return (Fate::Shaded, now | OWN);
            }
        }
        if level == 0 {
            return (Fate::Shaded, now | OWN);
        }
        (Fate::Bare, now | level.min(7) << LEVEL_SHIFT)
    }
}
