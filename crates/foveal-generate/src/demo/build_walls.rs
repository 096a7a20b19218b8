//! Placing what encloses the quarter: walls, gates, towers, the ground, the moon.

use glam::{Mat4, Vec3};

use super::build_houses::wall_lantern;
use super::build_square::CLOCK_TOWER_Z;
use super::market::{Market, Rank};
use super::plan::Plan;
use super::things::Kit;
use super::walls::{GATE_M, GROUND_M, WALL_M};
use crate::trig::{shift, stand};

/// Walls on four sides, the ground under all, the clock tower and the moon.
pub(super) fn enclosure<'a>(market: &mut Market<'a>, kit: &'a Kit, plan: Plan) {
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
        for x in [-3.3f32, 3.3] {
            let inside = stand(p(x, s * (z + 0.6 - 3.0)), 0.25 + 0.25 * s);
            wall_lantern(market, kit, inside * shift(0.0, 3.9, 0.0), 0.5);
        }
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
