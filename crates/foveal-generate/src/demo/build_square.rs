//! Placing the square: fountain, stalls, trees, the tower's lights, lanterns in the sky.

use glam::{Mat4, Vec3};

use super::build_houses::{WARM, wall_lantern};
use super::build_stalls::{PAPER_SHINES, stall};
use super::market::{Market, Rank, Shine};
use super::things::Kit;
use crate::hash::Rng;
use crate::trig::{shift, sin_cos_turns, stand, yaw};

/// Where the clock tower stands across the alley.
pub(super) const CLOCK_TOWER_Z: f32 = -27.0;

/// The fountain, stalls around it, lamp posts, trees and benches; the tower's lanterns.
pub(super) fn square<'a>(market: &mut Market<'a>, kit: &'a Kit, seed: u64) {
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
                intensity: 28.0,
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

/// Paper lanterns that rise from the square: as many as lights are still missing, forty at least.
pub(super) fn sky_lanterns<'a>(market: &mut Market<'a>, kit: &'a Kit, lights: usize, seed: u64) {
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
