//! The quarter's plan: where lanes, rows, square and walls lie.
//!
//! Lanes run along z, the main alley on x = 0, the square around the origin. Rows of houses of
//! 12 m line the lanes; after every fourth house a cross alley runs along x. Between the backs of
//! two rows lie courts. The middle never changes, whatever the quarter's size.

use super::houses::{DEPTH_M, WIDTH_M};

/// Half the main alley's width between the columns.
pub(super) const MAIN_HALF_M: f32 = 4.5;
/// Half a side lane's width.
pub(super) const LANE_HALF_M: f32 = 3.5;
/// Width of the courts between two rows.
pub(super) const COURT_M: f32 = 7.0;
/// Half the square's length along z, cross alleys excluded.
pub(super) const SQUARE_HALF_M: f32 = 18.0;
/// Width of the cross alleys.
pub(super) const CROSS_M: f32 = 6.0;
/// Houses between two cross alleys.
const ROW: u32 = 4;

/// How large the quarter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    /// Lanes on each side of the main alley.
    pub(super) side_lanes: u32,
    /// Houses along each lane north, and as many south, of the square.
    pub(super) houses: u32,
}

/// Where one house stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lot {
    /// The lane's number: 0 is the main alley, negative ones lie at negative x.
    pub(super) lane: i32,
    /// −1 where the house lies at the lane's negative x side, else 1. The front faces the lane.
    pub(super) side: f32,
    /// x of the front.
    pub(super) front_x: f32,
    /// z of the middle.
    pub(super) z: f32,
    /// At the square's edge.
    pub(super) on_square: bool,
    /// The row ends here towards (−z, +z).
    pub(super) ends: [bool; 2],
    /// Number along the lane, counted from the square, for patterns.
    pub(super) number: u32,
}

impl Plan {
    /// The smallest quarter.
    const MIN_HOUSES: u32 = 2;

    /// About `lots` houses, longer than wide.
    pub(super) fn with_lots(lots: u32) -> Self {
        let mut best = Self {
            side_lanes: 0,
            houses: Self::MIN_HOUSES,
        };
        let mut best_error = f32::INFINITY;
        for side_lanes in 0..16 {
            let per_house = 4 * (2 * side_lanes + 1);
            let houses = (lots.saturating_sub(6) / per_house).max(Self::MIN_HOUSES);
            let plan = Self { side_lanes, houses };
            let error = (plan.wall_z() / plan.wall_x() - 1.7).abs();
            if error < best_error {
                best = plan;
                best_error = error;
            }
        }
        best
    }

    /// x of a lane's middle.
    pub(super) fn lane_x(lane: i32) -> f32 {
        if lane == 0 {
            return 0.0;
        }
        let block = 2.0 * DEPTH_M + COURT_M;
        let first = MAIN_HALF_M + block + LANE_HALF_M;
        let pitch = 2.0 * LANE_HALF_M + block;
        lane.signum() as f32 * (first + pitch * (lane.abs() - 1) as f32)
    }

    /// Half a lane's width.
    pub(super) const fn lane_half(lane: i32) -> f32 {
        if lane == 0 { MAIN_HALF_M } else { LANE_HALF_M }
    }

    /// Numbers of all lanes.
    pub(super) fn lanes(self) -> std::ops::RangeInclusive<i32> {
        -(self.side_lanes as i32)..=self.side_lanes as i32
    }

    /// Distance from the origin to the inner end of the `number`th house beyond the square.
    pub(super) fn house_z(number: u32) -> f32 {
        SQUARE_HALF_M + CROSS_M + WIDTH_M * number as f32 + CROSS_M * (number / ROW) as f32
    }

    /// Half the length within the walls.
    pub(super) fn wall_z(self) -> f32 {
        Self::house_z(self.houses - 1) + WIDTH_M + CROSS_M
    }

    /// Half the width within the walls.
    pub(super) fn wall_x(self) -> f32 {
        if self.side_lanes == 0 {
            // The houses at the square stand back by a house and a court.
            return MAIN_HALF_M + COURT_M + 2.0 * DEPTH_M + 1.0;
        }
        Self::lane_x(self.side_lanes as i32) + LANE_HALF_M + DEPTH_M + COURT_M
    }

    /// All houses.
    pub(super) fn lots(self) -> Vec<Lot> {
        let mut lots = Vec::new();
        for lane in self.lanes() {
            for side in [-1.0f32, 1.0] {
                self.square_lots(lane, side, &mut lots);
                for north in [false, true] {
                    self.row_lots(lane, side, north, &mut lots);
                }
            }
        }
        lots
    }

    fn square_lots(self, lane: i32, side: f32, lots: &mut Vec<Lot>) {
        // Where the main alley's houses stand back, they take the place of their neighbours.
        if lane.abs() == 1 && side == -(lane as f32) {
            return;
        }
        let back = if lane == 0 { DEPTH_M + COURT_M } else { 0.0 };
        for k in -1..=1i32 {
            lots.push(Lot {
                lane,
                side,
                front_x: Self::lane_x(lane) + side * (Self::lane_half(lane) + back),
                z: k as f32 * WIDTH_M,
                on_square: lane == 0,
                ends: [k == -1, k == 1],
                number: (k + 1) as u32,
            });
        }
    }

    fn row_lots(self, lane: i32, side: f32, north: bool, lots: &mut Vec<Lot>) {
        for number in 0..self.houses {
            let z = Self::house_z(number) + 0.5 * WIDTH_M;
            let inner = number % ROW == 0;
            let outer = number % ROW == ROW - 1 || number + 1 == self.houses;
            lots.push(Lot {
                lane,
                side,
                front_x: Self::lane_x(lane) + side * Self::lane_half(lane),
                z: if north { -z } else { z },
                on_square: false,
                ends: if north {
                    [outer, inner]
                } else {
                    [inner, outer]
                },
                number,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn houses_do_not_overlap_and_lie_within_the_walls() {
        for plan in [
            Plan::with_lots(10),
            Plan::with_lots(75),
            Plan::with_lots(600),
        ] {
            let lots = plan.lots();
            let boxes: Vec<[f32; 4]> = lots
                .iter()
                .map(|l| {
                    let (a, b) = (l.front_x, l.front_x + l.side * DEPTH_M);
                    [a.min(b), a.max(b), l.z - 0.5 * WIDTH_M, l.z + 0.5 * WIDTH_M]
                })
                .collect();
            for (i, a) in boxes.iter().enumerate() {
                assert!(a[0].abs().max(a[1].abs()) <= plan.wall_x());
                assert!(a[2].abs().max(a[3].abs()) <= plan.wall_z());
                for b in &boxes[..i] {
                    let apart = a[1] <= b[0] + 1e-3
                        || b[1] <= a[0] + 1e-3
                        || a[3] <= b[2] + 1e-3
                        || b[3] <= a[2] + 1e-3;
                    assert!(apart, "{a:?} {b:?}");
                }
            }
        }
    }
}
