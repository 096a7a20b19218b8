//! Clipping of convex polygons in homogeneous coordinates (Sutherland and Hodgman 1974), in `f64`.

use glam::DVec4;

/// A convex polygon of up to twelve corners in clip space.
#[derive(Clone, Copy)]
pub(crate) struct ClipPolygon {
    pub(crate) corners: [DVec4; 12],
    pub(crate) count: usize,
}

impl ClipPolygon {
    pub(crate) fn new(corners: &[DVec4]) -> Self {
        let mut p = Self {
            corners: [DVec4::ZERO; 12],
            count: 0,
        };
        corners.iter().for_each(|&c| p.push(c));
        p
    }

    fn push(&mut self, c: DVec4) {
        if let Some(slot) = self.corners.get_mut(self.count) {
            *slot = c;
            self.count += 1;
        }
    }

    /// Keeps the side where `plane . corner >= 0`.
    pub(crate) fn clip(&mut self, plane: DVec4) {
        let input = *self;
        self.count = 0;
        for i in 0..input.count {
            let (a, b) = (input.corners[i], input.corners[(i + 1) % input.count]);
            let (da, db) = (plane.dot(a), plane.dot(b));
            if da >= 0.0 {
                self.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                // From the inner to the outer end, so that both neighbours of an edge cut it at the
                // same point.
                let (p, q, dp, dq) = if da >= 0.0 {
                    (a, b, da, db)
                } else {
                    (b, a, db, da)
                };
                self.push(p + (q - p) * (dp / (dp - dq)));
            }
        }
    }
}

/// The near plane, `W - Z >= 0`.
pub(crate) const NEAR: DVec4 = DVec4::new(0.0, 0.0, -1.0, 1.0);
