//! Placing houses on their lots, with arcades, windows and the lanterns that belong to them.

use glam::{Mat4, Vec3};

use super::houses::{ARCADE_HEIGHT_M, ARCADE_M, BAY_M, DEPTH_M, STOREY_M};
use super::lanterns::{CHAIN_M, LONG_CHAIN_M};
use super::lots::{lot_place, lot_rng};
use super::market::{Market, Rank, Shine};
use super::plan::Lot;
use super::things::Kit;
use crate::hash::Rng;
use crate::trig::{shift, yaw};

/// A lantern's warm light.
pub(super) const WARM: [f32; 3] = [1.0, 0.60, 0.28];

const ARCADE_SHINE: Shine = Shine {
    color: WARM,
    intensity: 24.0,
    range_m: 8.0,
};

/// Builds one house.
pub(super) fn house<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, seed: u64) {
    let rng = &mut lot_rng(seed, lot, 1);
    let place = lot_place(lot);
    let houses = &kit.houses;
    // Lower houses around the square let the sky in; the others vary.
    let floors = if lot.on_square {
        2
    } else {
        rng.pick([1usize, 2, 2, 2, 3])
    };
    let height = ARCADE_HEIGHT_M + STOREY_M * floors as f32;
    let wall = rng.below(6);
    market.put(&houses.cores[floors - 1][wall], place, Rank::Needed);
    market.put(&houses.roof, place * shift(0.0, height, 0.0), Rank::Needed);
    for y in [ARCADE_HEIGHT_M, height - 0.1] {
        market.put(
            &houses.course,
            place * shift(0.0, y, 0.0),
            Rank::Detail(3 << 29),
        );
    }
    arcade(market, kit, lot, place);
    for floor in 0..floors {
        let y = ARCADE_HEIGHT_M + STOREY_M * floor as f32 + 0.85;
        for bay in [-1.0f32, 0.0, 1.0] {
            window(
                market,
                kit,
                place * shift(bay * BAY_M, y, 0.0),
                floor == 0,
                rng,
            );
        }
    }
    // A house with its back to the square's neighbour shows some windows there too.
    if rng.chance(0.6) {
        let back = place * shift(0.0, 0.0, -DEPTH_M) * yaw(0.5);
        for bay in [-1.0f32, 1.0] {
            window(
                market,
                kit,
                back * shift(bay * BAY_M, ARCADE_HEIGHT_M + 0.85, 0.0),
                false,
                rng,
            );
        }
    }
    if rng.chance(0.7) {
        let on_roof = shift(rng.range(-5.0, 5.0), height + 1.2, rng.range(-6.5, -1.5));
        market.put(&houses.chimney, place * on_roof, Rank::Detail(rng.bits()));
    }
}

/// Columns, arches, door and lantern of the ground floor.
fn arcade<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, place: Mat4) {
    let houses = &kit.houses;
    for bay in [-1.0f32, 0.0, 1.0] {
        let at = place * shift(bay * BAY_M, 0.0, 0.0);
        market.put(&houses.arch, at, Rank::Needed);
        market.put(
            &houses.column,
            at * shift(-0.5 * BAY_M, 0.0, -0.225),
            Rank::Needed,
        );
    }
    // Local +x is +z on the positive side of a lane, −z on the other.
    let ends_here = lot.ends[usize::from(lot.side > 0.0)];
    if ends_here {
        let last = place * shift(1.5 * BAY_M, 0.0, -0.225);
        market.put(&houses.column, last, Rank::Needed);
    }
    market.put(
        &houses.door,
        place * shift(0.0, 0.0, -ARCADE_M),
        Rank::Detail(1 << 30),
    );
    let ceiling = place * shift(0.0, ARCADE_HEIGHT_M - LONG_CHAIN_M, -0.5 * ARCADE_M - 0.2);
    market.put_lamp(
        (&kit.lanterns.long_iron, Vec3::ZERO),
        ceiling,
        Rank::Goods(1 << 24),
        None,
        ARCADE_SHINE,
        order(ceiling, 0.8),
    );
}

fn window<'a>(
    market: &mut Market<'a>,
    kit: &'a Kit,
    place: Mat4,
    first_floor: bool,
    rng: &mut Rng,
) {
    let light = rng.pick([0usize, 0, 1, 1, 2, 2, 2]);
    let color = rng.below(3);
    market.put(
        &kit.houses.windows[light][color],
        place,
        Rank::Detail(rng.bits() >> 2),
    );
    if first_floor && rng.chance(0.3) {
        let balcony = place * shift(0.0, -0.15, 0.0);
        market.put(&kit.houses.balcony, balcony, Rank::Detail(rng.bits()));
        if rng.chance(0.5) {
            let rug = kit.goods.hung_rugs.get(rng.below(3));
            let rail = balcony * shift(rng.range(-0.4, 0.4), 0.95, 0.90);
            if let Some(rug) = rug {
                market.put(rug, rail, Rank::Goods(rng.bits()));
            }
        }
    }
}

/// A lantern on an arm at a wall's face (place: on the wall, facing out).
pub(super) fn wall_lantern<'a>(market: &mut Market<'a>, kit: &'a Kit, place: Mat4, weight: f32) {
    let arm = market.put(&kit.lanterns.arm, place, Rank::Goods(1 << 25));
    let hung = place * shift(0.0, -CHAIN_M, 0.56);
    market.put_lamp(
        (&kit.lanterns.iron, Vec3::ZERO),
        hung,
        Rank::Goods(1 << 25),
        Some(arm),
        ARCADE_SHINE,
        order(hung, weight),
    );
}

/// How late a lantern at `place` gets a light: by distance from the main alley and the square,
/// times `weight`.
pub(super) fn order(place: Mat4, weight: f32) -> f32 {
    let p = place.w_axis.truncate();
    let from_square = (p.x * p.x + p.z * p.z).sqrt();
    let from_alley = 2.2 * (p.x.abs() - 5.0).max(0.0) + 0.5 * p.z.abs();
    weight * (8.0 + from_square.min(from_alley))
}
