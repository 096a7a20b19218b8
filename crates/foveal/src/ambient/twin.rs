//! The CPU twin of `horizons.wgsl` and `resolve.wgsl`, for one eye.

use std::f32::consts::{FRAC_PI_2, PI};

use foveal_scene::{Camera, Projection};
use glam::{IVec2, UVec2, Vec2, Vec3};

use super::OcclusionUniform;
use crate::shading::sample_texel as coarse_sample_texel;
use crate::shading::twin::normal_of_depth;

const SLICES: u32 = 2;
const BLOCK_SLICES: u32 = 4;
const STEPS: u32 = 4;
const LEAST_RISE: f32 = 0.02;
const FULL_RISE: f32 = 0.06;
const ELSEWHERE: f32 = 1e-3;
const OFF_PLANE: Vec2 = Vec2::new(0.05, 0.5);

/// A picture's reversed depth, and how far its places look.
pub(super) struct Twin<'a> {
    pub(super) camera: &'a Camera,
    pub(super) size: UVec2,
    pub(super) depths: &'a [f32],
    pub(super) reach: OcclusionUniform,
}

struct Pattern {
    turn: f32,
    jitter: f32,
    slices: u32,
}

fn pattern_of(place: UVec2, level: u32) -> Pattern {
    let (number, count, turns, jitters, slices) = if level == 0 {
        (place.x % 3 + 3 * (place.y % 3), 9, 4, 2, SLICES)
    } else {
        ((place.x & 1) + 2 * (place.y & 1), 4, 3, 1, BLOCK_SLICES)
    };
    let part = |n: u32| ((n % count) as f32 + 0.5) / count as f32;
    Pattern {
        turn: part(number * turns),
        jitter: part(number * jitters + 1),
        slices,
    }
}

fn arc(horizon: f32, normal: f32) -> f32 {
    0.25 * (normal.cos() + 2.0 * horizon * normal.sin() - (2.0 * horizon - normal).cos())
}

struct Seer {
    texel: UVec2,
    position: Vec3,
    normal: Vec3,
    view: Vec3,
    reach: f32,
}

impl Twin<'_> {
    fn depth(&self, at: UVec2) -> f32 {
        self.depths[(at.y * self.size.x + at.x) as usize]
    }

    fn is_flat(&self) -> bool {
        matches!(self.camera.projection, Projection::Orthographic { .. })
    }

    pub(super) fn distance(&self, depth: f32) -> f32 {
        match self.camera.projection {
            Projection::Perspective { near_m, .. } => near_m / depth,
            Projection::Orthographic { near_m, far_m, .. } => {
                near_m + (1.0 - depth) * (far_m - near_m)
            }
        }
    }

    /// View-space x and y per normalized device coordinate, at a distance of 1.
    fn to_view(&self) -> Vec2 {
        let clip_from_view = self
            .camera
            .clip_from_view(self.size.x as f32 / self.size.y as f32);
        1.0 / Vec2::new(clip_from_view.x_axis.x, clip_from_view.y_axis.y)
    }

    fn place_seen(&self, texel: UVec2, depth: f32) -> Vec3 {
        let distance = self.distance(depth);
        let ndc = Vec2::new(2.0, -2.0) * (texel.as_vec2() + 0.5) / self.size.as_vec2()
            + Vec2::new(-1.0, 1.0);
        let wide = if self.is_flat() { 1.0 } else { distance };
        (ndc * self.to_view() * wide).extend(-distance)
    }

    fn horizon_along(&self, s: &Seer, toward: Vec2, pixels: f32, low: f32, jitter: f32) -> f32 {
        (0..STEPS).fold(low, |horizon, k| {
            let part = (k as f32 + jitter) / STEPS as f32;
            let away = (part * part * pixels).max(k as f32 + 1.0);
            let step = toward * away;
            let at = s.texel.as_ivec2()
                + Vec2::new(step.x.round_ties_even(), step.y.round_ties_even()).as_ivec2();
            let inside = at.cmpge(IVec2::ZERO).all() && at.cmplt(self.size.as_ivec2()).all();
            if !inside || self.depth(at.as_uvec2()) == 0.0 {
                return horizon;
            }
            let at = at.as_uvec2();
            let delta = self.place_seen(at, self.depth(at)) - s.position;
            let size = delta.length();
            let near = (2.0 - 2.0 * size / s.reach).clamp(0.0, 1.0);
            let rise = delta.dot(s.normal) / size;
            let rises = ((rise - LEAST_RISE) / (FULL_RISE - LEAST_RISE)).clamp(0.0, 1.0);
            let counts = near * rises;
            horizon.max(low * (1.0 - counts) + delta.dot(s.view) / size * counts)
        })
    }

    fn visibility_from(&self, texel: UVec2, pattern: &Pattern) -> f32 {
        let depth = self.depth(texel);
        let normal = normal_of_depth(self.camera, self.size, self.depths, texel);
        let normal = self
            .camera
            .world_from_view
            .inverse()
            .transform_vector3(normal);
        let position = self.place_seen(texel, depth);
        let (view, distance) = if self.is_flat() {
            (Vec3::Z, 1.0)
        } else {
            (-position.normalize(), -position.z)
        };
        let scale = self.size.as_vec2() / (2.0 * self.to_view().abs()) / distance;
        let reach = self
            .reach
            .radius
            .min(self.reach.most_pixels / scale.max_element());
        let s = Seer {
            texel,
            position,
            normal,
            view,
            reach,
        };
        let (mut free, mut all) = (0.0, 1e-6);
        for i in 0..pattern.slices {
            let angle = PI * (i as f32 + pattern.turn) / pattern.slices as f32;
            let along = Vec3::new(angle.cos(), angle.sin(), 0.0);
            let axis = along.cross(view).normalize();
            let in_slice = normal - axis * normal.dot(axis);
            let size = in_slice.length().max(1e-6);
            let cosine = (in_slice.dot(view) / size).clamp(0.0, 1.0);
            let ahead_of_view = (along - view * along.dot(view)).dot(in_slice) >= 0.0;
            let tilt = if ahead_of_view {
                cosine.acos()
            } else {
                -cosine.acos()
            };
            let on_screen = Vec2::new(along.x, -along.y) * scale;
            let pixels = on_screen.length();
            let toward = on_screen / pixels;
            let low = tilt.sin();
            let ahead = self.horizon_along(&s, toward, pixels * reach, -low, pattern.jitter);
            let behind = self.horizon_along(&s, -toward, pixels * reach, low, pattern.jitter);
            let most = ahead.clamp(-1.0, 1.0).acos().min(tilt + FRAC_PI_2);
            let least = (-behind.clamp(-1.0, 1.0).acos()).max(tilt - FRAC_PI_2);
            free += size * (arc(most, tilt) + arc(least, tilt));
            all += size * (cosine + tilt * low);
        }
        (free / all).clamp(0.0, 1.0)
    }

    /// What is found at a texel that stands for its block of a level.
    pub(super) fn found(&self, texel: UVec2, level: u32) -> f32 {
        self.visibility_from(texel, &pattern_of(texel >> level, level))
    }

    /// What a texel with a surface is given, from samples of blocks of these levels.
    pub(super) fn resolved(&self, texel: UVec2, level_at: &dyn Fn(UVec2) -> u32) -> f32 {
        let sample_of = |block: UVec2, level| {
            let (x, y) = coarse_sample_texel(block.into(), level, 0, self.size.into());
            UVec2::new(x, y)
        };
        let depth = self.depth(texel);
        let level = level_at(texel);
        let side = (1 << level) as f32;
        let last = ((self.size - 1) >> level).as_ivec2();
        let place = (texel.as_vec2() - (0.5 * side).floor()) / side;
        let nearest = (place + 0.5).floor();
        let past = place - nearest;
        let slope = self.slope(texel);
        let (mut sum, mut weights) = (0.0, 0.0);
        for i in 0..9 {
            let step = IVec2::new(i % 3, i / 3) - 1;
            let block = nearest.as_ivec2() + step;
            if block.cmplt(IVec2::ZERO).any() || block.cmpgt(last).any() {
                continue;
            }
            let of_level = if level == 0 {
                block.as_uvec2()
            } else {
                sample_of(block.as_uvec2(), level)
            };
            let own = level_at(of_level);
            let at = if own == 0 {
                of_level
            } else {
                sample_of(of_level >> own, own)
            };
            if self.depth(at) == 0.0 {
                continue;
            }
            let there = self.distance(self.depth(at));
            let offset = at.as_vec2() - texel.as_vec2();
            let expected = self.distance((depth + slope.dot(offset)).max(1e-20));
            let wide = if self.is_flat() { 1.0 } else { there };
            let pixel_side = 2.0 * self.to_view().x / self.size.x as f32 * wide;
            let allowed = OFF_PLANE.dot(Vec2::new(self.reach.radius, offset.length() * pixel_side))
                + 1e-5 * there.abs();
            let tent = if level == 0 {
                Vec2::ONE
            } else {
                (1.0 - step.as_vec2().abs() * 0.5 + step.as_vec2() * past)
                    .clamp(Vec2::ZERO, Vec2::ONE)
            };
            let off = (there - expected).abs() / allowed;
            let near = (2.0 - off).clamp(0.0, 1.0) + ELSEWHERE / (1.0 + off * off);
            let weight = tent.x * tent.y * near;
            sum += weight * self.found(at, own);
            weights += weight;
        }
        if weights > 0.0 { sum / weights } else { 1.0 }
    }

    /// Change of depth per texel right and down, as `depth_step` finds it.
    fn slope(&self, texel: UVec2) -> Vec2 {
        let here = self.depth(texel);
        let step = |axis: IVec2| {
            let at = |away: i32| {
                let other = texel.as_ivec2() + away * axis;
                self.depth(
                    other
                        .clamp(IVec2::ZERO, self.size.as_ivec2() - 1)
                        .as_uvec2(),
                )
            };
            let [before_2, before, after, after_2] = [-2, -1, 1, 2].map(at);
            let bends = [before_2 - 2.0 * before + here, after_2 - 2.0 * after + here];
            let along = texel.as_ivec2().dot(axis);
            let is_last = along == self.size.as_ivec2().dot(axis) - 1;
            if along == 0 || (!is_last && bends[1].abs() <= bends[0].abs()) {
                after - here
            } else {
                here - before
            }
        };
        Vec2::new(step(IVec2::X), step(IVec2::Y))
    }
}
