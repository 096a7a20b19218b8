//! Placing what spans the lanes: bridges, ropes, bulbs, pennants, paper lanterns.

use glam::{Mat4, Vec3};

use super::build_houses::order;
use super::build_stalls::PAPER_SHINES;
use super::houses::WIDTH_M;
use super::lanterns::{ROPE_M, rope_point};
use super::lots::lot_rng;
use super::market::{Market, Rank};
use super::plan::{Lot, Plan};
use super::things::Kit;
use crate::hash::Rng;
use crate::trig::stand;

/// Height at which ropes span the lanes.
const ROPE_Y: f32 = 5.7;

/// Ropes, lanterns and bridges over a lane beside a house.
pub(super) fn over_lane<'a>(market: &mut Market<'a>, kit: &'a Kit, lot: &Lot, seed: u64) {
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
