//! Clipping of convex polygons in homogeneous coordinates (Sutherland and Hodgman 1974), in `f64`.

use glam::DVec4;

/// Beyond this distance from a plane, in metres, an edge is cut from its other end: numbers of the
/// screen are some 1e5 times as large there, and their rounding would come near a sample's margin.
const FAR: f64 = 1e5;

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
                // same point. From the outer end where the inner one is so far away that its
                // rounding would be seen.
                let (mut p, mut q, mut dp, mut dq) = if da >= 0.0 {
                    (a, b, da, db)
                } else {
                    (b, a, db, da)
                };
                if dp > FAR && dp > -dq {
                    (p, q, dp, dq) = (q, p, dq, dp);
                }
                self.push(p + (q - p) * (dp / (dp - dq)));
            }
        }
    }
}

/// The near plane, `W - Z >= 0`.
pub(crate) const NEAR: DVec4 = DVec4::new(0.0, 0.0, -1.0, 1.0);

#[cfg(test)]
mod tests {
    use super::*;

    /// The cut was rounded like the far end, which put it into the middle of the screen.
    #[test]
    fn an_edge_from_very_far_away_is_cut_where_it_meets_the_plane() {
        let near = DVec4::new(56.0, 98.0, 1.03, 1.0);
        for far in [1e3, 1e6, 7e6, 9e6, 1e9, 1e11, 7e13, 1e15, 1e21, 1e30] {
            let way = DVec4::new(-5.0, 1.8, -0.0125, 0.0);
            for corners in [[near, near + way * far], [near + way * far, near]] {
                let mut polygon = ClipPolygon::new(&corners);
                polygon.clip(NEAR);
                let cut = near + way * (0.03 / 0.0125);
                let found = polygon.corners[..polygon.count]
                    .iter()
                    .any(|c| (*c - cut).abs().max_element() < 1e-3);
                assert!(found, "{far}: {:?}", &polygon.corners[..polygon.count]);
            }
        }
    }
}
