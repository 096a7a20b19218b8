//! Screen

use super::boxes::ROUNDING;
use crate::depth::hiz::Coarse;
use glam::Vec3;

/// What boxes are projected with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen<'a> {
    /// Clip rows in the space of the boxes.
    pub(crate) rows: [[f32; 4]; 4],
    /// Samples.
    pub(crate) width: f32,
    pub(crate) height: f32,
    /// Depth of the far plane, lowered a little; 0 when infinite.
    pub(crate) far_depth: f32,
    /// By how much rectangles grow on each side, samples.
    pub(crate) dilate: f32,
    /// By how much boxes grow on each side, metres.
    pub(crate) grow: f32,
    /// Boxes are tested against it at once.
    pub(crate) coarse: Option<Coarse<'a>>,
}

impl Screen<'_> {
    /// Whether all of a box, grown for rounding, lies beyond one border of the screen, wherever the near plane is.
    #[inline(always)]
    pub(crate) fn is_beside(&self, center: Vec3, half: Vec3) -> bool {
        let [x, y, _, w] = self.rows;
        // Sums over the axes, for the borders left, right, above and below; by rows that are above zero within.
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
            for (border, row) in rows.into_iter().enumerate() {
                most[border] += row * c + row.abs() * h;
                terms[border] += row.abs() * (c.abs() + h);
            }
        }
        let mut beside = false;
        for (most, terms) in most.into_iter().zip(terms) {
            beside |= most < -ROUNDING * terms;
        }
        beside
    }
}
