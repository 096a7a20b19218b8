//! The finest shading rate within a part of the picture, as the eye's formula gives it. For what is
//! made before the rate map is: the sizes of shadow tiles.

use glam::{Vec2, Vec3};

use super::request::densest;
use super::{RequestUniform, acuity};
use crate::stereo::Eye;
use crate::{RateCombine, RateSource, Settings};

/// Part of a block's side by which device and this bound may differ.
const ROUNDING: f32 = 0.995;

/// What the eyes' requests follow from; edges and bumps aside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FinestRate {
    /// Side of a block at the gaze in radians, and its growth per radian of eccentricity.
    block_at_gaze: f32,
    block_growth: f32,
    /// Of each eye, as in [`RequestUniform`].
    display_from_ndc: [[f32; 4]; 2],
    gaze_direction: [Vec3; 2],
    width: f32,
    coarsest: u32,
}

impl FinestRate {
    /// Of a frame that is shaded coarsely; `None` where something besides the eye may ask for finer
    /// samples.
    pub(crate) fn new(s: &Settings, eyes: &[Eye; 2]) -> Option<Self> {
        let coarse = &s.coarse;
        let is_bound = match coarse.combine {
            RateCombine::First => coarse.source == RateSource::Foveated,
            RateCombine::Coarser => {
                [coarse.source, coarse.other_source].contains(&RateSource::Foveated)
            }
            RateCombine::Finer => false,
        };
        let request = is_bound.then(|| RequestUniform::new(s, eyes, None))?;
        // Before the geometry nobody knows where bumps are: no coarser than the request of a frame that
        // does not refine them. That is finer than this frame's away from bumps, and coarser on them.
        let density = densest(s.picture.width as f32, request.display_from_ndc);
        let blocks = acuity::Blocks::WithEvenBumps.side(s.eye.quality_jod, density);
        Some(Self {
            block_at_gaze: blocks.at_gaze.min(request.block_at_gaze),
            block_growth: blocks.growth.min(request.block_growth),
            display_from_ndc: request.display_from_ndc,
            gaze_direction: request
                .gaze_direction
                .map(|[x, y, z, _]| Vec3::new(x, y, z)),
            width: s.picture.width as f32,
            coarsest: request.coarsest,
        })
    }

    /// Whether both eyes ask for the same at each place of their pictures.
    pub(crate) fn is_alike(&self) -> bool {
        self.gaze_direction[0] == self.gaze_direction[1]
            && self.display_from_ndc[0] == self.display_from_ndc[1]
    }

    /// The coarsest level there is.
    pub(crate) fn coarsest(&self) -> u32 {
        self.coarsest
    }

    /// A level that no pixel of this rectangle of an eye's picture is below, edges and bumps aside,
    /// given by its least and greatest normalized device coordinates.
    pub(crate) fn level_within(&self, eye: usize, [low, high]: [Vec2; 2]) -> u32 {
        let [sx, sy, ox, oy] = self.display_from_ndc[eye];
        let (scale, offset) = (Vec2::new(sx, sy), Vec2::new(ox, oy));
        let [low, high] = [low, high].map(|ndc| ndc * scale + offset);
        let nearest = nearest_to(self.gaze_direction[eye], low, high);
        let eccentricity = acuity::angle_between(nearest, self.gaze_direction[eye]);
        // Pixels look largest where the display is nearest.
        let at = Vec2::ZERO.clamp(low, high);
        let pixel = 2.0 * sx / self.width * at.extend(1.0).length_recip();
        let side = (self.block_at_gaze + self.block_growth * eccentricity) / pixel;
        acuity::level_of_side(side * ROUNDING).min(self.coarsest)
    }
}

/// The unit vector to a point of a rectangle at distance 1, by its least and greatest tangents, that
/// makes the smallest angle with a direction.
fn nearest_to(direction: Vec3, low: Vec2, high: Vec2) -> Vec3 {
    if direction.z > 0.0 {
        let at = direction.truncate() / direction.z;
        if at.cmpge(low).all() && at.cmple(high).all() {
            return direction;
        }
    }
    // Directions within an angle are a convex part of the plane: else the nearest lies on a side.
    let corners = [
        low,
        Vec2::new(high.x, low.y),
        high,
        Vec2::new(low.x, high.y),
    ]
    .map(|at| at.extend(1.0));
    let mut best = (f32::NEG_INFINITY, direction);
    for (i, &from) in corners.iter().enumerate() {
        let along = corners[(i + 1) % 4] - from;
        // Where the cosine to a + t d is greatest.
        let (ga, gd) = (direction.dot(from), direction.dot(along));
        let (aa, ad, dd) = (from.dot(from), from.dot(along), along.dot(along));
        let t = (gd * aa - ga * ad) / (ga * dd - gd * ad);
        for t in [
            0.0,
            if t.is_finite() {
                t.clamp(0.0, 1.0)
            } else {
                1.0
            },
        ] {
            let to = (from + along * t).normalize();
            let cosine = direction.dot(to);
            if cosine > best.0 {
                best = (cosine, to);
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use foveal_scene::Camera;

    use super::*;
    use crate::{RefineEdges, Shading};

    fn seen(gaze: [f32; 2], display: &str) -> (Settings, [Eye; 2]) {
        let s = Settings::default().with(|s| {
            s.picture.width = 320;
            s.picture.height = 180;
            s.eye.display = display.parse().expect("it can be read");
            s.eye.gaze = gaze;
            s.shading.mode = Shading::Coarse;
            // Else the request is coarser than the bound where there are no bumps.
            s.coarse.refine_edges = RefineEdges::Off;
        });
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
        let eyes = crate::stereo::eyes(&s, &camera).unwrap();
        (s, eyes)
    }

    #[test]
    fn no_pixel_of_a_part_requests_a_finer_level_and_some_request_that_or_the_next() {
        for display in ["60", "camera", "110", "20"] {
            for gaze in [[0.5, 0.5], [0.1, 0.9], [1.4, 0.3]] {
                let (s, eyes) = seen(gaze, display);
                let request = RequestUniform::new(&s, &eyes, None);
                let finest = FinestRate::new(&s, &eyes).expect("the eye asks");
                for part in 0..60u32 {
                    let random = |k: u32, most: u32| (part * k + 7 * k) % most;
                    let (x, y) = (random(37, 300), random(23, 170));
                    let (w, h) = (1 + random(11, 320 - x), 1 + random(5, 180 - y));
                    let pixels = (x..x + w).flat_map(|x| (y..y + h).map(move |y| (x, y)));
                    let least = pixels.map(|(x, y)| request.level(&s, x, y, None)).min();
                    let ndc =
                        |x: u32, y: u32| Vec2::new(x as f32 / 160.0 - 1.0, 1.0 - y as f32 / 90.0);
                    let (a, b) = (ndc(x, y), ndc(x + w, y + h));
                    let level = finest.level_within(0, [a.min(b), a.max(b)]);
                    let least = u32::from(least.unwrap());
                    assert!(
                        level <= least && least <= level + 1,
                        "{display}, {gaze:?}: {level}, {least}"
                    );
                }
            }
        }
    }

    #[test]
    fn no_pixel_requests_a_finer_level_where_bumps_are_refined() {
        for quality in [8.0, 9.0, 9.5, 9.6, 9.85, 9.9, 9.95, 10.0] {
            let (s, eyes) = seen([0.5, 0.5], "60");
            let s = s.with(|s| {
                s.eye.quality_jod = quality;
                s.coarse.refine_edges = RefineEdges::Graded;
            });
            let request = RequestUniform::new(&s, &eyes, None);
            let finest = FinestRate::new(&s, &eyes).expect("the eye asks");
            for (x, y) in [(160, 90), (200, 60), (3, 100), (319, 179)] {
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(160.0, 90.0);
                let ndc = (at - 1.0) * Vec2::new(1.0, -1.0);
                let level = u32::from(request.level(&s, x, y, None));
                assert!(
                    finest.level_within(0, [ndc, ndc]) <= level,
                    "{quality}: {x}, {y}"
                );
            }
        }
    }

    #[test]
    fn only_the_eye_is_a_bound() {
        let bound = |change: fn(&mut Settings)| {
            let (s, eyes) = seen([0.5, 0.5], "60");
            FinestRate::new(&s.with(change), &eyes).is_some()
        };
        assert!(bound(|_| ()));
        assert!(!bound(|s| s.coarse.source = RateSource::Radii));
        assert!(!bound(|s| s.coarse.combine = RateCombine::Finer));
        assert!(bound(|s| {
            s.coarse.source = RateSource::Image;
            s.coarse.other_source = RateSource::Foveated;
            s.coarse.combine = RateCombine::Coarser;
        }));
    }
}
