//! Placing stalls and filling them with goods.

use glam::{Mat4, Vec3};

use super::build_houses::{WARM, order};
use super::lanterns::CHAIN_M;
use super::market::{Market, Rank, Shine};
use super::stalls::COUNTER_M;
use super::things::Kit;
use crate::hash::Rng;
use crate::trig::{pitch, shift, yaw};

const STALL_SHINE: Shine = Shine {
    color: WARM,
    intensity: 12.0,
    range_m: 6.0,
};

/// The papers' lights, in the order of the paper materials.
pub(super) const PAPER_SHINES: [Shine; 4] = [
    Shine {
        color: [1.0, 0.56, 0.22],
        intensity: 20.0,
        range_m: 7.0,
    },
    Shine {
        color: [1.0, 0.30, 0.16],
        intensity: 17.0,
        range_m: 7.0,
    },
    Shine {
        color: [0.14, 0.85, 0.85],
        intensity: 17.0,
        range_m: 7.0,
    },
    Shine {
        color: [1.0, 0.22, 0.58],
        intensity: 17.0,
        range_m: 7.0,
    },
];

/// Puts a stall at `place` (front +z), with wares and a lantern.
pub(super) fn stall<'a>(market: &mut Market<'a>, kit: &'a Kit, place: Mat4, rng: &mut Rng) {
    let (shape, cloth) = (rng.below(3), rng.below(7));
    let stall = market.put(
        &kit.stalls.stalls[shape][cloth],
        place,
        Rank::Stall(rng.bits()),
    );
    let mut wares = Wares {
        market,
        kit,
        place,
        rng,
    };
    match wares.rng.below(9) {
        0 | 1 => wares.fruit(),
        2 => wares.pottery(),
        3 => wares.rugs(),
        4 => wares.baskets(),
        5 => wares.metal(),
        6 => wares.spices(),
        7 => wares.glass(),
        _ => wares.food(),
    }
    wares.clutter();
    let lantern = place * shift(wares.rng.range(-0.5, 0.5), 2.28 - CHAIN_M, 0.62);
    if wares.rng.chance(0.72) {
        let shine = STALL_SHINE;
        let weight = wares.rng.range(0.7, 1.2);
        let flame = (&kit.lanterns.iron, Vec3::ZERO);
        let rank = Rank::Goods(wares.rng.bits() >> 8);
        market.put_lamp(
            flame,
            lantern,
            rank,
            Some(stall),
            shine,
            order(lantern, weight),
        );
    } else {
        let color = wares.rng.pick([0usize, 0, 1, 2, 3]);
        let shine = Shine {
            intensity: 10.0,
            range_m: 5.5,
            ..PAPER_SHINES[color]
        };
        let weight = wares.rng.range(0.7, 1.2);
        let rank = Rank::Goods(wares.rng.bits() >> 8);
        let flame = (&kit.lanterns.papers[color], Vec3::ZERO);
        market.put_lamp(
            flame,
            lantern,
            rank,
            Some(stall),
            shine,
            order(lantern, weight),
        );
    }
}

/// One stall being filled; x along the counter, z towards the customers.
struct Wares<'m, 'a> {
    market: &'m mut Market<'a>,
    kit: &'a Kit,
    place: Mat4,
    rng: &'m mut Rng,
}

impl<'a> Wares<'_, 'a> {
    fn put(&mut self, thing: &'a super::kit::Thing, place: Mat4) {
        let rank = Rank::Goods(self.rng.bits() | 1 << 28);
        self.market.put(thing, self.place * place, rank);
    }

    /// On the counter, turned a little by chance.
    fn on_counter(&mut self, thing: &'a super::kit::Thing, x: f32, z: f32, lift: f32) {
        let turn = yaw(self.rng.range(-0.03, 0.03));
        self.put(thing, shift(x, COUNTER_M + lift, z) * turn);
    }

    /// On the ground, turned any way.
    fn on_ground(&mut self, thing: &'a super::kit::Thing, x: f32, z: f32) {
        let turn = yaw(self.rng.unit());
        self.put(thing, shift(x, 0.0, z) * turn);
    }

    fn fruit(&mut self) {
        let kit = self.kit;
        for i in 0..4u8 {
            let x = -1.02 + 0.68 * f32::from(i) + self.rng.range(-0.03, 0.03);
            let crate_of = &kit.goods.fruit_crates[self.rng.below(4)];
            let turn = yaw(self.rng.range(-0.012, 0.012));
            self.put(
                crate_of,
                shift(x, COUNTER_M + 0.04, 0.60) * turn * pitch(0.03),
            );
        }
        let basket = &kit.goods.baskets[1];
        let x = self.rng.range(-1.1, 1.1);
        self.on_ground(basket, x, 1.28);
        self.on_ground(&kit.goods.fruit_crates[1], -x, 1.25);
    }

    fn pottery(&mut self) {
        let kit = self.kit;
        for i in 0..5u8 {
            let x = -1.1 + 0.55 * f32::from(i);
            let bowl = &kit.goods.bowls[self.rng.below(3)];
            let z = self.rng.range(0.35, 0.75);
            self.on_counter(bowl, x, z, 0.0);
        }
        for x in [-1.2f32, -0.6, 0.9] {
            let jar = &kit.goods.jars[self.rng.below(3)];
            let z = self.rng.range(1.25, 1.45);
            self.on_ground(jar, x, z);
        }
        let jar = &kit.goods.jars[self.rng.below(3)];
        self.on_counter(jar, self.place.w_axis.x.signum() * 0.2, 0.3, 0.0);
    }

    fn rugs(&mut self) {
        let kit = self.kit;
        for (x, y, z) in [(-0.5, 0.0, 0.35), (-0.5, 0.0, 0.60), (-0.5, 0.19, 0.47)] {
            let rug = &kit.goods.rug_rolls[self.rng.below(3)];
            self.on_counter(rug, x, z, y);
        }
        for x in [-0.85, 0.25] {
            let rug = &kit.goods.hung_rugs[self.rng.below(3)];
            self.put(rug, shift(x, 2.55, -0.78));
        }
        let rug = &kit.goods.hung_rugs[self.rng.below(3)];
        self.put(
            rug,
            shift(0.85, COUNTER_M + 0.02, 0.97) * Mat4::from_scale(Vec3::new(0.9, 0.5, 1.0)),
        );
    }

    fn baskets(&mut self) {
        let kit = self.kit;
        for i in 0..4u8 {
            let x = -1.02 + 0.68 * f32::from(i);
            let basket = &kit.goods.baskets[self.rng.pick([0usize, 0, 1, 2])];
            self.on_counter(basket, x, 0.55, 0.0);
        }
        for x in [-1.0, 0.1] {
            self.on_ground(&kit.goods.baskets[0], x, 1.3);
            self.put(&kit.goods.baskets[0], shift(x, 0.16, 1.3) * yaw(0.1));
        }
    }

    fn metal(&mut self) {
        let kit = self.kit;
        for i in 0..4u8 {
            let x = -1.05 + 0.7 * f32::from(i);
            let tray = &kit.goods.trays[self.rng.below(2)];
            self.put(tray, shift(x, COUNTER_M + 0.25, 0.30));
            let pot = &kit.goods.pots[self.rng.below(2)];
            self.on_counter(pot, x + 0.1, 0.66, 0.0);
        }
        let tray = &kit.goods.trays[self.rng.below(2)];
        self.put(
            tray,
            shift(0.5, 1.75, -0.80) * Mat4::from_scale(Vec3::splat(1.5)),
        );
    }

    fn spices(&mut self) {
        let kit = self.kit;
        for i in 0..4u8 {
            let x = -1.05 + 0.7 * f32::from(i);
            self.on_ground(&kit.goods.sacks[usize::from(i)], x, 1.30);
            let bowl = &kit.goods.bowls[self.rng.below(3)];
            self.on_counter(bowl, x, 0.6, 0.0);
        }
        let sack = &kit.goods.sacks[self.rng.below(4)];
        self.on_counter(sack, 0.3, 0.42, 0.0);
    }

    fn glass(&mut self) {
        let kit = self.kit;
        for i in 0..4u8 {
            let x = -1.05 + 0.7 * f32::from(i);
            let z = self.rng.range(0.4, 0.7);
            self.on_counter(&kit.goods.bottles, x, z, 0.0);
        }
        for x in [-0.9, 0.95] {
            let paper = &kit.lanterns.tall_papers[self.rng.below(4)];
            self.put(paper, shift(x, 1.86, 0.66));
        }
    }

    fn food(&mut self) {
        let kit = self.kit;
        for x in [-0.9, 0.0] {
            self.on_counter(&kit.goods.pots[1], x, 0.5, 0.0);
        }
        let mut steam = shift(-0.45, COUNTER_M + 0.35, 0.5);
        steam *= yaw(self.rng.unit());
        self.put(&kit.goods.steam, steam);
        self.on_counter(&kit.goods.loaves, 0.75, 0.5, -0.23);
        self.on_counter(&kit.goods.bowls[0], -0.45, 0.75, 0.0);
        self.on_ground(&kit.goods.baskets[2], 1.0, 1.3);
    }

    /// Behind and beside: barrels, crates, a table.
    fn clutter(&mut self) {
        let kit = self.kit;
        if self.rng.chance(0.6) {
            self.on_ground(&kit.goods.barrel, 1.05, -0.5);
        }
        if self.rng.chance(0.5) {
            self.on_ground(&kit.goods.crate_empty, -0.9, -0.5);
            let turn = yaw(self.rng.range(0.0, 0.2));
            self.put(&kit.goods.crate_empty, shift(-0.9, 0.2, -0.5) * turn);
        }
        if self.rng.chance(0.3) {
            self.put(&kit.stalls.shelf, shift(0.0, 0.0, -0.7));
        }
    }
}
