//! Polygons in triangles: a convex one as a fan, any other by its ears (Meisters 1975, 'Polygons
//! have ears'), seen along its normal (Newell's: Sutherland, Sproull and Schumacker 1974).

use glam::DVec2;

/// Comparisons that a file may ask for, beside those for each of its bytes: one second's.
const COMPARISONS: u64 = 1 << 28;
const COMPARISONS_PER_BYTE: u64 = 256;

/// Cuts the polygons of one file.
pub(super) struct Polygons {
    /// Comparisons of a corner with an ear that are left. Without, polygons are fans.
    left: u64,
    /// Corners as they are seen, counter-clockwise.
    seen: Vec<DVec2>,
    /// Numbers of the corners that are not cut off.
    ring: Vec<usize>,
}

impl Polygons {
    /// For a file of so many bytes.
    pub(super) fn of_file(bytes: usize) -> Self {
        Self {
            left: COMPARISONS.saturating_add(COMPARISONS_PER_BYTE.saturating_mul(bytes as u64)),
            seen: Vec::new(),
            ring: Vec::new(),
        }
    }

    /// Gives the numbers of the corners of each triangle, in the polygon's own sense: two less than it
    /// has corners. What has no ears, because its edges cross, is a fan.
    pub(super) fn cut(&mut self, places: &[[f32; 3]], mut give: impl FnMut([usize; 3])) {
        self.ring.clear();
        self.ring.extend(0..places.len());
        if places.len() > 3 && self.see(places) && !self.is_convex() {
            let (mut at, mut missed) = (0, 0);
            while self.ring.len() > 3 && missed < self.ring.len() {
                at %= self.ring.len();
                let corners = self.around(at);
                if self.is_ear(corners) {
                    give(corners);
                    self.ring.remove(at);
                    missed = 0;
                } else {
                    missed += 1;
                }
                at += 1;
            }
        }
        for pair in self.ring.get(1..).unwrap_or_default().windows(2) {
            give([self.ring[0], pair[0], pair[1]]);
        }
    }

    /// Sees the polygon along the axis that is nearest to its normal; false where it has none.
    fn see(&mut self, places: &[[f32; 3]]) -> bool {
        let ends = places.iter().zip(places.iter().cycle().skip(1));
        let mut normal = [0.0; 3];
        for (a, b) in ends {
            let ([ax, ay, az], [bx, by, bz]) = (a.map(f64::from), b.map(f64::from));
            normal[0] += (ay - by) * (az + bz);
            normal[1] += (az - bz) * (ax + bx);
            normal[2] += (ax - bx) * (ay + by);
        }
        let sizes = normal.map(f64::abs);
        let axis = (0..3).fold(0, |most, i| if sizes[i] > sizes[most] { i } else { most });
        let (x, y) = match normal[axis] > 0.0 {
            true => ((axis + 1) % 3, (axis + 2) % 3),
            false => ((axis + 2) % 3, (axis + 1) % 3),
        };
        self.seen.clear();
        let seen = |place: &[f32; 3]| DVec2::new(place[x].into(), place[y].into());
        self.seen.extend(places.iter().map(seen));
        normal.iter().all(|n| n.is_finite()) && sizes[axis] > 0.0
    }

    /// The corner at a place of the ring, between the one before it and the one behind it.
    fn around(&self, at: usize) -> [usize; 3] {
        let count = self.ring.len();
        [
            self.ring[(at + count - 1) % count],
            self.ring[at],
            self.ring[(at + 1) % count],
        ]
    }

    /// Twice the area of a triangle; negative where it is clockwise.
    fn area(&self, corners: [usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|i| self.seen[i]);
        (b - a).perp_dot(c - a)
    }

    fn is_convex(&self) -> bool {
        (0..self.ring.len()).all(|at| self.area(self.around(at)) >= 0.0)
    }

    /// Whether the middle one of three corners can be cut off: the triangle holds no other corner. One
    /// that lies at the same place as one of the three, where a hole is joined, does not count.
    fn is_ear(&mut self, corners: [usize; 3]) -> bool {
        let area = self.area(corners);
        let compared = self.ring.len() as u64;
        if area < 0.0 || compared > self.left {
            return false;
        }
        self.left -= compared;
        if area == 0.0 {
            // In line with its neighbours: it covers nothing.
            return true;
        }
        let [a, b, c] = corners;
        let is_within = |&other: &usize| {
            let place = self.seen[other];
            corners.iter().all(|&corner| self.seen[corner] != place)
                && [[a, b], [b, c], [c, a]]
                    .iter()
                    .all(|&[from, to]| self.area([from, to, other]) >= 0.0)
        };
        !self.ring.iter().any(is_within)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(places: &[[f32; 3]]) -> Vec<[usize; 3]> {
        let mut found = Vec::new();
        Polygons::of_file(0).cut(places, |triangle| found.push(triangle));
        found
    }

    /// Twice the areas of the triangles, along z.
    fn areas(places: &[[f32; 3]]) -> Vec<f64> {
        let at = |i: usize| DVec2::new(places[i][0].into(), places[i][1].into());
        let area = |[a, b, c]: [usize; 3]| (at(b) - at(a)).perp_dot(at(c) - at(a));
        cut(places).into_iter().map(area).collect()
    }

    fn flat(corners: &[[f32; 2]]) -> Vec<[f32; 3]> {
        corners.iter().map(|&[x, y]| [x, y, 0.0]).collect()
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        let hexagon = [[1, 0], [2, 0], [3, 1], [2, 2], [1, 2], [0, 1]];
        let places = flat(&hexagon.map(|p| p.map(|x| x as f32)));
        assert_eq!(cut(&places), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        assert_eq!(cut(&places[..3]), [[0, 1, 2]]);
        assert_eq!(cut(&places[..2]), [[0; 3]; 0]);
    }

    #[test]
    fn triangles_of_other_polygons_cover_them_once() {
        // An arrow, an L, a comb, and a square with a hole, which an edge there and back joins.
        let arrow = [[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]];
        let corner = [[2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.], [0., 0.]];
        let mut comb = vec![[20., 0.], [20., 1.], [0., 1.], [0., 0.]];
        comb.extend((0..20).flat_map(|i| {
            let x = i as f32;
            [[x, 0.], [x + 0.25, -9.], [x + 0.5, 0.]]
        }));
        let hole = [
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ];
        let cases = [
            (&arrow[..], 3.0),
            (&corner, 6.0),
            (&comb, 40.0 + 20.0 * 4.5),
            (&hole, 24.0),
        ];
        for (polygon, twice_the_area) in cases {
            for first in 0..polygon.len() {
                let mut turned = polygon.to_vec();
                turned.rotate_left(first);
                let mut places = flat(&turned);
                for side in [1.0, -1.0] {
                    let areas: Vec<f64> = areas(&places).iter().map(|a| a * side).collect();
                    assert_eq!(areas.len(), polygon.len() - 2);
                    assert!(areas.iter().all(|&area| area >= 0.0), "{areas:?}");
                    assert_eq!(areas.iter().sum::<f64>(), twice_the_area, "{turned:?}");
                    places.reverse();
                }
            }
        }
    }

    #[test]
    fn a_polygon_is_seen_along_its_normal_from_any_side() {
        let arrow = flat(&[[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]]);
        let expected = cut(&arrow);
        assert!(!expected.contains(&[0, 1, 2]), "{expected:?}");
        for turn in 0..3 {
            let turned = arrow.clone().into_iter().map(|mut place| {
                place.rotate_left(turn);
                place
            });
            assert_eq!(cut(&turned.collect::<Vec<_>>()), expected);
        }
        // What has no side is a fan.
        let line = flat(&[[0., 0.], [1., 0.], [3., 0.], [2., 0.]]);
        let nowhere = [[f32::NAN; 3]; 4];
        for places in [&line[..], &nowhere] {
            assert_eq!(cut(places), [[0, 1, 2], [0, 2, 3]]);
        }
    }

    #[test]
    fn comparisons_have_an_end() {
        let mut polygons = Polygons::of_file(0);
        polygons.left = 3;
        let mut count = 0;
        let arrow = flat(&[[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]]);
        polygons.cut(&arrow, |_| count += 1);
        assert_eq!((count, polygons.left), (2, 3));
    }

    proptest! {
        #[test]
        fn any_polygon_has_two_triangles_less_than_corners(
            corners in prop::collection::vec(prop::array::uniform3(-3i8..=3), 0..24)
        ) {
            let places: Vec<[f32; 3]> = corners.iter().map(|p| p.map(f32::from)).collect();
            let triangles = cut(&places);
            prop_assert_eq!(triangles.len(), places.len().saturating_sub(2));
            prop_assert!(triangles.as_flattened().iter().all(|&i| i < places.len()));
        }
    }
}
