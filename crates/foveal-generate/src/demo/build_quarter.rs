//! Placing everything on the plan, lot by lot: what stands before, in and behind the houses.

use glam::Vec3;

use super::build_houses::{house, wall_lantern};
use super::build_ropes::over_lane;
use super::build_square::{sky_lanterns, square};
use super::build_stalls::stall;
use super::build_walls::enclosure;
use super::houses::{ARCADE_M, BAY_M, DEPTH_M, WIDTH_M};
use super::lots::{lot_place, lot_rng};
use super::market::{Market, Rank};
use super::plan::{COURT_M, Lot, Plan};
use super::things::Kit;
use crate::trig::{shift, stand, yaw};

/// The whole quarter, `lights` lanterns at least.
pub(super) fn quarter<'a>(kit: &'a Kit, plan: Plan, lights: usize, seed: u64) -> Market<'a> {
    let mut market = Market::default();
    enclosure(&mut market, kit, plan);
    square(&mut market, kit, seed);
    for lot in plan.lots() {
        house(&mut market, kit, &lot, seed);
        frontage(&mut market, kit, &lot, seed);
        if !lot.on_square && plan.side_lanes > 0 {
            court(&mut market, kit, &lot, seed);
        }
        if lot.side > 0.0 && !lot.on_square {
            over_lane(&mut market, kit, &lot, seed);
        }
    }
    sky_lanterns(&mut market, kit, lights, seed);
    market
}

/// Stalls, plants and goods before and within a house's arcade.
fn frontage<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, seed: u64) {
    let rng = &mut lot_rng(seed, lot, 2);
    let place = lot_place(lot);
    let main = lot.lane == 0;
    // Side lanes are narrow: stalls on alternating sides only.
    let sells = main || lot.number.is_multiple_of(2) == (lot.side > 0.0);
    for bay in [-1.0f32, 0.0, 1.0] {
        let at = place * shift(bay * BAY_M, 0.0, 1.38);
        let chance = match (lot.on_square, sells) {
            (true, _) => 0.55,
            (_, true) => 0.84,
            _ => 0.0,
        };
        if rng.chance(chance) {
            let shake = shift(rng.range(-0.15, 0.15), 0.0, rng.range(-0.05, 0.08));
            stall(market, kit, at * shake * yaw(rng.range(-0.006, 0.006)), rng);
        } else if main && rng.chance(0.6) {
            let plant = if rng.chance(0.5) {
                &kit.furniture.tree
            } else {
                &kit.furniture.shrub
            };
            market.put(
                plant,
                at * shift(0.0, 0.0, -0.6) * yaw(rng.unit()),
                Rank::Goods(rng.bits()),
            );
        }
    }
    // Along the arcade's inner wall; the walk before it stays free.
    for x in [-4.2f32, 4.2] {
        let wall = place * shift(x, 0.0, 0.45 - ARCADE_M);
        let rank = Rank::Goods(rng.bits());
        match rng.below(6) {
            0 => {
                market.put(&kit.goods.barrel, wall, rank);
                market.put(
                    &kit.goods.sacks[rng.below(4)],
                    wall * shift(0.7, 0.0, 0.0),
                    rank,
                );
            }
            1 => {
                market.put(&kit.stalls.shelf, wall * shift(0.0, 0.0, -0.2), rank);
                for i in 0..3u8 {
                    let jar = wall * shift(-0.55 + 0.5 * f32::from(i), 0.985, -0.2);
                    market.put(&kit.goods.bowls[rng.below(3)], jar, rank);
                }
            }
            2 => {
                let rug = wall * shift(0.0, 2.3, -0.40);
                market.put(&kit.goods.hung_rugs[rng.below(3)], rug, rank);
                market.put(
                    &kit.goods.rug_rolls[rng.below(3)],
                    wall * shift(0.0, 0.0, -0.1),
                    rank,
                );
            }
            3 => {
                market.put(&kit.stalls.table, wall, rank);
                market.put(
                    &kit.goods.baskets[rng.below(3)],
                    wall * shift(0.4, 0.71, 0.0),
                    rank,
                );
                market.put(
                    &kit.goods.pots[rng.below(2)],
                    wall * shift(-0.4, 0.71, 0.0),
                    rank,
                );
            }
            4 => {
                market.put(&kit.furniture.bench, wall, rank);
            }
            _ => {
                market.put(&kit.furniture.shrub, wall, rank);
            }
        }
    }
}

/// What stands behind a house.
fn court<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, seed: u64) {
    let rng = &mut lot_rng(seed, lot, 3);
    let back = lot_place(lot) * shift(0.0, 0.0, -DEPTH_M) * yaw(0.5);
    // Each row fills its own half of the court.
    for x in [-3.5f32, 0.5] {
        if rng.chance(0.55) {
            stall(
                market,
                kit,
                back * shift(x + rng.range(-0.3, 0.3), 0.0, 1.3),
                rng,
            );
        }
    }
    let corner = back * shift(4.4, 0.0, 0.8);
    match rng.below(3) {
        0 => {
            for (x, z) in [(0.0, 0.0), (0.75, 0.1), (0.3, 0.7)] {
                market.put(
                    &kit.goods.barrel,
                    corner * shift(x, 0.0, z),
                    Rank::Goods(rng.bits()),
                );
            }
        }
        1 => {
            market.put(
                &kit.furniture.tree,
                corner * yaw(rng.unit()),
                Rank::Goods(rng.bits()),
            );
        }
        _ => {
            for i in 0..4u8 {
                let pile = shift(0.6 * f32::from(i % 2), 0.2 * f32::from(i / 2), 0.0);
                market.put(
                    &kit.goods.crate_empty,
                    corner * pile,
                    Rank::Goods(rng.bits()),
                );
            }
        }
    }
    wall_lantern(
        market,
        kit,
        back * shift(-1.5, 3.4, 0.0),
        rng.range(0.9, 1.3),
    );
    // One of the two rows around a court closes its ends.
    let closes = if lot.lane == 0 {
        true
    } else {
        lot.side == lot.lane.signum() as f32
    };
    if closes {
        for (end, z) in [(0, -0.5 * WIDTH_M), (1, 0.5 * WIDTH_M)] {
            if lot.ends[end] {
                let middle = lot.front_x + lot.side * (DEPTH_M + 0.5 * COURT_M);
                let facing = if z < 0.0 { 0.5 } else { 0.0 };
                let at = Vec3::new(middle, 0.0, lot.z + z);
                market.put(&kit.houses.court_wall, stand(at, facing), Rank::Needed);
            }
        }
    }
}
