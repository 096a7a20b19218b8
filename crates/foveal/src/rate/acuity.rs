//! How coarsely the eye resolves: the largest block that it does not tell from its pixels.
//!
//! The smallest angle that the eye resolves grows in proportion to the angle to the gaze (Guenter,
//! Finch, Drucker, Tan and Snyder 2012, 'Foveated 3D graphics', eq. 1): `ACUITY + SLOPE *
//! eccentricity`, in degrees a cycle. A block's side is that times a factor, which
//! [`EyeSettings::quality_jod`](crate::EyeSettings::quality_jod) names by the difference that is
//! left.

use glam::Vec3;

use crate::Settings;
use crate::stereo::Eye;

#[cfg(test)]
use super::RequestUniform;

/// Smallest resolvable angle at the gaze, in radians a cycle: 1/48 degree.
const ACUITY: f32 = 1.0 / 48.0 * std::f32::consts::PI / 180.0;
/// Its growth per angle of eccentricity: the slope with which Guenter et al. found no visible
/// difference.
const SLOPE: f32 = 0.0275;

/// Qualities in JOD, best first, and the factor on Guenter's angle that gives the blocks of each.
type Qualities = [(f32, f32); 7];

/// Of a frame by itself: found by means over the demo scene, Sponza and the castle with 1280 pixels over
/// 60 degrees, five pictures (docs/benchmarks/coarse.md), which are 0.03 to 0.17 above the quality: other
/// pictures are harder. That of 10 is extrapolated.
const QUALITIES: Qualities = [
    (10.0, 0.07),
    (9.8, 0.4),
    (9.7, 0.68),
    (9.6, 1.0),
    (9.5, 1.4),
    (9.3, 2.2),
    (9.1, 3.5),
];

/// Where light is kept from frame to frame. A block's share of the samples of a frame does not depend
/// on its size, so that large ones renew the light around moving shadows too slowly: by videos of the
/// demo scene, Sponza and two levels (docs/decisions/0270-led-pixels.md).
const KEPT_QUALITIES: Qualities = [
    (10.0, 0.05),
    (9.8, 0.15),
    (9.59, 0.35),
    (9.5, 0.52),
    (9.38, 0.77),
    (9.3, 1.08),
    (9.11, 1.7),
];

/// Where bumpy surfaces request no finer levels than others: those of 9.85 and 8.91 by three pictures
/// of five, before pixels were shaded by themselves where samples disagree.
const EVEN_QUALITIES: Qualities = [
    (10.0, 0.05),
    (9.85, 0.15),
    (9.61, 0.3),
    (9.5, 0.42),
    (9.3, 0.8),
    (9.08, 1.3),
    (8.91, 2.0),
];

/// What is assumed where a camera's rays are parallel, so that its picture tells no angle: 60
/// degrees across.
const PARALLEL_ACROSS: f32 = std::f32::consts::FRAC_PI_3;

/// Pixels per radian in the display's centre from which on blocks become finer than the tables
/// say: those of 1280 pixels over 60 degrees, 1108.51, by which the qualities were measured.
const MEASURED_DENSITY: f32 = 1108.52;

/// Blocks shrink with the density's ratio to that power. A denser display shows finer detail, which
/// blocks of the same angle leave out: found by measurement (docs/decisions/0208-denser-displays.md).
const DENSER: f32 = 0.75;

/// Sides of blocks: at the gaze in radians, and growth per radian of eccentricity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    pub(super) at_gaze: f32,
    pub(super) growth: f32,
}

/// What blocks are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Blocks {
    /// Bumpy surfaces request finer levels than others; all light is the frame's own.
    OfOneFrame,
    /// The same, and light is kept from frame to frame.
    OfKeptLight,
    /// Bumpy surfaces request what others do.
    WithEvenBumps,
}

impl Blocks {
    /// The largest blocks that keep a quality on a display with so many pixels per radian in its
    /// centre.
    pub(super) fn side(self, quality_jod: f32, density: f32) -> Side {
        let qualities = match self {
            Self::OfOneFrame => QUALITIES,
            Self::OfKeptLight => KEPT_QUALITIES,
            Self::WithEvenBumps => EVEN_QUALITIES,
        };
        let after = qualities.partition_point(|&(q, _)| q > quality_jod);
        let [(q0, f0), (q1, f1)] = match after {
            0 => [qualities[0]; 2],
            n if n == qualities.len() => [qualities[n - 1]; 2],
            n => [qualities[n - 1], qualities[n]],
        };
        let along = if q0 == q1 {
            0.0
        } else {
            (quality_jod - q0) / (q1 - q0)
        };
        let finer = (MEASURED_DENSITY / density).min(1.0).powf(DENSER);
        let factor = f0 * (f1 / f0).powf(along) * finer;
        Side {
            at_gaze: factor * ACUITY,
            growth: factor * SLOPE,
        }
    }
}

/// Tangents on the display of a point of an eye's picture, from normalized device coordinates:
/// scale in xy, offset in zw.
pub(super) fn display_from_ndc(s: &Settings, eye: &Eye) -> [f32; 4] {
    let across = match s.eye.display.across() {
        Some(across) => across,
        None if eye.orthographic => PARALLEL_ACROSS,
        None => return eye.view_from_ndc(),
    };
    let half = (0.5 * across).tan();
    [
        half,
        half * s.picture.height as f32 / s.picture.width as f32,
        0.0,
        0.0,
    ]
}

/// Unit vector to a place of the picture, given as fractions of it.
pub(super) fn direction(display_from_ndc: [f32; 4], place: [f32; 2]) -> [f32; 4] {
    let [x, y] = tangents(display_from_ndc, place);
    let length = (x * x + y * y + 1.0).sqrt();
    [x / length, y / length, 1.0 / length, 0.0]
}

fn tangents([sx, sy, ox, oy]: [f32; 4], [x, y]: [f32; 2]) -> [f32; 2] {
    [(2.0 * x - 1.0) * sx + ox, (1.0 - 2.0 * y) * sy + oy]
}

/// Angle between two unit vectors in radians: twin of `angle_between` in `rate/fovea.wgsl`.
pub(super) fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let half = (0.5 * a.distance(b)).min(0.75);
    let s = half * half;
    2.0 * half * (1.0 + s * (1.0 / 6.0 + s * (3.0 / 40.0 + s * (15.0 / 336.0))))
}

/// The level of the largest block that is no larger than `side` pixels.
pub(super) fn level_of_side(side: f32) -> u32 {
    side.log2().floor().max(0.0) as u32
}

/// The level that the left or only eye's picture requests at a position in pixels: twin of
/// `foveated_level` in `rate/fovea.wgsl`.
#[cfg(test)]
pub(super) fn level(request: &RequestUniform, s: &Settings, pixel: [f32; 2]) -> u32 {
    let to_display = request.display_from_ndc[0];
    let place = [
        pixel[0] / s.picture.width as f32,
        pixel[1] / s.picture.height as f32,
    ];
    let vector = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z);
    let to_pixel = vector(direction(to_display, place));
    let eccentricity = angle_between(to_pixel, vector(request.gaze_direction[0]));
    let pixel_side = 2.0 * to_display[0] / s.picture.width as f32 * to_pixel.z;
    let side = (request.block_at_gaze + request.block_growth * eccentricity) / pixel_side;
    level_of_side(side).min(request.coarsest)
}
