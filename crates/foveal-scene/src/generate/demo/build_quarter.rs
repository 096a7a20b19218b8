//! Placing everything on the plan: rows, courts, square, ropes, walls.

use glam::{Mat4, Vec3};

use super::Kit;
use super::build_houses::{WARM, house, order, wall_lantern};
use super::build_stalls::{PAPER_SHINES, stall};
use super::houses::{ARCADE_M, BAY_M, DEPTH_M, WIDTH_M};
use super::lanterns::{ROPE_M, rope_point};
use super::lots::{lot_place, lot_rng};
use super::market::{Market, Rank, Shine};
use super::plan::{COURT_M, Lot, Plan, SQUARE_HALF_M};
use super::walls::{GATE_M, GROUND_M, WALL_M};
use crate::generate::hash::Rng;
use crate::generate::trig::{shift, sin_cos_turns, stand, yaw};

/// Height at which ropes span the lanes.
const ROPE_Y: f32 = 5.7;
/// Where the clock tower stands across the alley.
const CLOCK_TOWER_Z: f32 = -27.0;

/// The whole quarter, `lights` lanterns at least.
pub(super) fn quarter<'a>(kit: &'a Kit, plan: Plan, lights: usize, seed: u64) -> Market<'a> {
    let mut market = Market::default();
    enclosure(&mut market, kit, plan);
    square(&mut market, kit, seed);
    for lot in plan.lots() {
        house(&mut market, kit, &lot, seed);
        frontage(&mut market, kit, &lot, seed);
        if !lot.on_square && plan.side_lanes > 0 && !faces_square_back(&lot) {
            court(&mut market, kit, &lot, seed);
        }
        if lot.side > 0.0 && !lot.on_square {
            over_lane(&mut market, kit, &lot, seed);
        }
    }
    sky_lanterns(&mut market, kit, lights, seed);
    market
}

/// Behind these lots lies no court but a house at the square.
fn faces_square_back(lot: &Lot) -> bool {
    lot.lane.abs() == 1 && lot.z.abs() < SQUARE_HALF_M && lot.side == -(lot.lane as f32)
}

fn enclosure<'a>(market: &mut Market<'a>, kit: &'a Kit, plan: Plan) {
    let (x, z) = (plan.wall_x(), plan.wall_z());
    let walls = &kit.walls;
    let mut wall = |from: Vec3, to: Vec3, turns: f32| {
        let length = from.distance(to);
        let count = (length / WALL_M).ceil().max(1.0);
        let stretch = Mat4::from_scale(Vec3::new(length / (WALL_M * count), 1.0, 1.0));
        for i in 0..count as u32 {
            let middle = from.lerp(to, (i as f32 + 0.5) / count);
            market.put(&walls.wall, stand(middle, turns) * stretch, Rank::Needed);
        }
    };
    let p = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let (out_x, out_z, gate) = (x + 1.2, z + 1.2, 0.5 * GATE_M);
    for s in [-1.0f32, 1.0] {
        wall(p(s * out_x, -out_z), p(s * out_x, out_z), 0.25 * s);
        for side in [-1.0f32, 1.0] {
            let turns = if s > 0.0 { 0.0 } else { 0.5 };
            wall(p(side * gate, s * out_z), p(side * x, s * out_z), turns);
        }
    }
    for s in [-1.0f32, 1.0] {
        market.put(&walls.gate, shift(0.0, 0.0, s * (z + 0.6)), Rank::Needed);
        for side in [-1.0f32, 1.0] {
            let corner = stand(p(side * out_x, s * out_z), 0.0);
            market.put(&walls.corner_tower, corner, Rank::Needed);
        }
    }
    let tiles = |half: f32| ((half + 20.0) / GROUND_M + 0.5).ceil() as i32;
    for i in -tiles(x)..=tiles(x) {
        for j in -tiles(z)..=tiles(z) {
            let place = shift(i as f32 * GROUND_M, 0.0, j as f32 * GROUND_M);
            let inside = (i.abs() as f32 - 0.5) * GROUND_M < x + 14.0
                && (j.abs() as f32 - 0.5) * GROUND_M < z + 14.0;
            if inside {
                market.put(&walls.ground, place, Rank::Needed);
            }
        }
    }
    // North of the square, low above the alley: turned towards who enters from the south.
    let moon = Vec3::new(19.0, 45.0, -108.0);
    let to_eye = (Vec3::new(0.0, 1.7, 46.0) - moon).normalize();
    let right = Vec3::Y.cross(to_eye).normalize();
    let place = Mat4::from_cols(
        right.extend(0.0),
        to_eye.cross(right).extend(0.0),
        to_eye.extend(0.0),
        moon.extend(1.0),
    );
    market.put(&walls.moon, place, Rank::Needed);
    market.put(
        &walls.clock_tower,
        shift(0.0, 0.0, CLOCK_TOWER_Z),
        Rank::Needed,
    );
}

fn square<'a>(market: &mut Market<'a>, kit: &'a Kit, seed: u64) {
    let mut rng = Rng::new(seed, 0x50_0a7e);
    market.put(&kit.furniture.fountain, Mat4::IDENTITY, Rank::Needed);
    // Two arcs of stalls around the fountain; the alley's axis stays free.
    for i in 0..10u8 {
        let arc = if i < 5 { 0.25 } else { 0.75 };
        let turns = arc + 0.088 * (f32::from(i % 5) - 2.0);
        let (sin, cos) = sin_cos_turns(turns);
        let at = Vec3::new(12.4 * sin, 0.0, 12.4 * cos);
        stall(
            market,
            kit,
            stand(at, turns + 0.5 + rng.range(-0.01, 0.01)),
            &mut rng,
        );
    }
    for i in 0..4u8 {
        let turns = 0.125 + 0.25 * f32::from(i);
        let (sin, cos) = sin_cos_turns(turns);
        let post = stand(Vec3::new(6.6 * sin, 0.0, 6.6 * cos), turns);
        market.put_lamp(
            (&kit.lanterns.post, Vec3::Y * 3.1),
            post,
            Rank::Stall(0),
            None,
            Shine {
                color: [1.0, 0.74, 0.46],
                intensity: 42.0,
                range_m: 10.0,
            },
            0.0,
        );
        for off in [-0.06f32, 0.06] {
            let (sin, cos) = sin_cos_turns(turns + off);
            let tree = stand(Vec3::new(8.4 * sin, 0.0, 8.4 * cos), rng.unit());
            market.put(&kit.furniture.tree, tree, Rank::Stall(1));
        }
        let turns = 0.25 * f32::from(i) + 0.045;
        let (sin, cos) = sin_cos_turns(turns);
        let bench = stand(Vec3::new(4.6 * sin, 0.0, 4.6 * cos), turns);
        market.put(&kit.furniture.bench, bench, Rank::Goods(2));
    }
    tower_lanterns(market, kit);
}

/// Lanterns beside both mouths of the clock tower's gate, on its shaft and in its belfry.
fn tower_lanterns<'a>(market: &mut Market<'a>, kit: &'a Kit) {
    let tower = shift(0.0, 0.0, CLOCK_TOWER_Z);
    for facing in [0.0f32, 0.5] {
        let face = tower * yaw(facing);
        for x in [-3.3f32, 3.3] {
            wall_lantern(market, kit, face * shift(x, 3.9, 3.0), 0.3);
        }
        for (x, y) in [(-1.2f32, 10.6f32), (1.2, 10.6), (-1.7, 14.6), (1.7, 14.6)] {
            wall_lantern(market, kit, face * shift(x, y, 2.6), 0.4);
        }
    }
    market.put_lamp(
        (&kit.lanterns.iron, Vec3::ZERO),
        tower * shift(0.0, 23.6, 0.0),
        Rank::Goods(0),
        None,
        Shine {
            color: WARM,
            intensity: 40.0,
            range_m: 9.0,
        },
        0.0,
    );
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

/// Ropes, lanterns and bridges over a lane beside a house.
fn over_lane<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, seed: u64) {
    let rng = &mut lot_rng(seed, lot, 4);
    let span = 2.0 * Plan::lane_half(lot.lane);
    let middle = Vec3::new(Plan::lane_x(lot.lane), 0.0, lot.z);
    let main = lot.lane == 0;
    let stretch = Mat4::from_scale(Vec3::new(span / ROPE_M, 1.0, 1.0));
    if lot.number.is_multiple_of(2) && !lot.ends[1] && rng.chance(if main { 1.0 } else { 0.5 }) {
        let at = middle + Vec3::Z * (0.5 * WIDTH_M + 0.42);
        market.put(&kit.houses.bridge, stand(at, 0.0) * stretch, Rank::Needed);
    }
    let steps: &[f32] = if main { &[-4.0, 0.0, 4.0] } else { &[0.0] };
    for (i, z) in steps.iter().enumerate() {
        let rope = stand(
            middle + Vec3::new(0.0, ROPE_Y + rng.range(-0.3, 0.3), *z),
            0.0,
        ) * stretch;
        let kind = if main {
            (i as u32 + lot.number) % 3
        } else {
            rng.below(3) as u32
        };
        match kind {
            0 => {
                market.put(&kit.lanterns.bulb_rope, rope, Rank::Goods(1 << 26));
            }
            1 => paper_rope(market, kit, rope, rng),
            _ => {
                let pennants = &kit.lanterns.pennants[rng.below(3)];
                market.put(pennants, rope, Rank::Goods(1 << 27));
            }
        }
    }
}

/// A rope with three paper lanterns.
fn paper_rope<'a>(market: &mut Market<'a>, kit: &'a Kit, rope: Mat4, rng: &mut Rng) {
    let carrier = market.put(&kit.lanterns.rope, rope, Rank::Goods(1 << 26));
    for t in [0.24f32, 0.5, 0.76] {
        let color = rng.pick([0usize, 0, 0, 1, 2, 3]);
        let tall = rng.chance(0.4);
        let (lantern, half) = if tall {
            (&kit.lanterns.tall_papers[color], 0.45)
        } else {
            (&kit.lanterns.papers[color], 0.37)
        };
        let hook = rope.transform_point3(rope_point(t));
        let place = stand(hook - Vec3::Y * half, rng.unit());
        market.put_lamp(
            (lantern, Vec3::ZERO),
            place,
            Rank::Goods(rng.bits() >> 8),
            Some(carrier),
            PAPER_SHINES[color],
            order(place, rng.range(0.6, 1.1)),
        );
    }
}

/// Paper lanterns that rise from the square: as many as lights are still missing, forty at least.
fn sky_lanterns<'a>(market: &mut Market<'a>, kit: &'a Kit, lights: usize, seed: u64) {
    let missing = lights.saturating_sub(market.lamp_count());
    for i in 0..missing.max(36) {
        let mut rng = Rng::new(seed, 0x5c1_0000 + i as u64);
        let at = Vec3::new(
            rng.range(-16.0, 16.0),
            rng.range(8.0, 26.0),
            rng.range(-20.0, 22.0),
        );
        let color = rng.pick([0usize, 0, 0, 0, 1, 3]);
        let place = stand(at, rng.unit()) * Mat4::from_scale(Vec3::splat(1.5));
        market.put_lamp(
            (&kit.lanterns.tall_papers[color], Vec3::ZERO),
            place,
            Rank::Goods(3),
            None,
            PAPER_SHINES[color],
            60.0 + i as f32,
        );
    }
}
