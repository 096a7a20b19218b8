//! The screen that boxes are projected to.

use super::boxes::ROUNDING;
use crate::depth::hiz::Hiz;
use glam::Vec3;

/// The screen that boxes are projected to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen<'a> {
    /// Clip rows in the space of the boxes.
    pub(crate) rows: [[f32; 4]; 4],
    /// Size, samples.
    pub(crate) width: f32,
    pub(crate) height: f32,
    /// Depth of the far plane, lowered for rounding; 0 if it is infinite.
    pub(crate) far_depth: f32,
    /// Growth of rectangles on each side, samples.
    pub(crate) dilate: f32,
    /// Growth of boxes on each side, metres.
    pub(crate) grow: f32,
    /// HiZ that boxes are tested against while they are projected.
    pub(crate) hiz: Option<Hiz<'a>>,
}

impl Screen<'_> {
    /// Whether a box, grown for rounding, lies wholly beyond one edge of the screen. Right for
    /// boxes that cross the near plane too.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn is_beside(&self, center: Vec3, half: Vec3) -> bool {
        let [x, y, _, w] = self.rows;
        // Sums over the axes for the left, right, upper and lower edge, by rows that are above zero
        // inside.
        let (mut most, mut terms) = ([0.0; 4], [0.0; 4]);
        for k in 0..4 {
            let rows = [
                x[k] + self.dilate * w[k],
                (self.width + self.dilate) * w[k] - x[k],
                y[k] + self.dilate * w[k],
                (self.height + self.dilate) * w[k] - y[k],
            ];
            let (c, h) = if k < 3 {
                (center[k], half[k])
            } else {
                (1.0, 0.0)
            };
            for (edge, row) in rows.into_iter().enumerate() {
                most[edge] += row * c + row.abs() * h;
                terms[edge] += row.abs() * (c.abs() + h);
            }
        }
        let mut beside = false;
        for (most, terms) in most.into_iter().zip(terms) {
            beside |= most < -ROUNDING * terms;
        }
        beside
    }
}
