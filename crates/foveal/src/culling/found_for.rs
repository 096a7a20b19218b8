//! Whether an earlier frame's result still holds.

use foveal_cull::Eye;
use glam::DAffine3;

/// Cosine of the angle, 26 degrees, by which eyes may turn and still look about the same way.
const LIKE: f64 = 0.9;

/// What a result holds for: a pose of the scene, and eyes.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundFor {
    pub(super) pose: u64,
    pub(super) eyes: [Option<Eye>; 2],
}

impl FoundFor {
    /// Whether a result that holds within `radius_m` of this one's eyes answers for the other's.
    pub(super) fn holds_for(&self, other: &Self, radius_m: f64) -> bool {
        let near = |(a, b): (&Option<Eye>, &Option<Eye>)| match (a, b) {
            (Some(a), Some(b)) => {
                let [p, q] = [a, b].map(|eye| DAffine3::from(eye.world_from_eye));
                a.projection == b.projection
                    && p.matrix3 == q.matrix3
                    && (p.translation - q.translation).length() < 0.999 * radius_m
            }
            (None, None) => true,
            _ => false,
        };
        self.pose == other.pose && self.eyes.iter().zip(&other.eyes).all(near)
    }

    /// Whether as much may be hidden from the other's eyes: they look about the same way, by the same
    /// projection.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let alike = |(a, b): (&Option<Eye>, &Option<Eye>)| match (a, b) {
            (Some(a), Some(b)) => {
                let [p, q] = [a, b].map(|eye| DAffine3::from(eye.world_from_eye));
                let ahead = p.matrix3.z_axis.normalize_or_zero();
                a.projection == b.projection
                    && ahead.dot(q.matrix3.z_axis.normalize_or_zero()) > LIKE
            }
            (None, None) => true,
            _ => false,
        };
        self.eyes.iter().zip(&other.eyes).all(alike)
    }
}
