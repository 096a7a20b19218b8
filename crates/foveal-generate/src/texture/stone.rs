//! Stone: wet cobbles, ashlar and brick.

use glam::{Vec2, Vec3};

use super::bake::{Baked, Texel, bake};
use super::noise::{cellular, fractal, step, value};
use crate::hash::{lattice, unit};

/// Rounded cobbles, 4 m, worn smooth on top and wet in the hollows.
pub(crate) fn cobbles() -> Baked {
    bake("cobbles", 1024, 4.0, |p| {
        let warp = Vec2::new(value(p, 9, 21), value(p, 9, 22)) * 0.012;
        let cell = cellular(p + warp, 26, 0.72, 11);
        let stone = step(0.03, 0.20, cell.border);
        let dome = step(0.0, 0.55, cell.border);
        let broad = fractal(p, 4, 4, 31);
        let fine = fractal(p, 64, 3, 41);
        let shade = 0.40 + 0.17 * unit(cell.id) + 0.08 * (fine - 0.5);
        let warm = unit(lattice(cell.id, 3, 5)) - 0.5;
        let top = Vec3::new(1.03 + 0.10 * warm, 0.98, 0.93 - 0.12 * warm) * shade;
        let joint = Vec3::new(0.22, 0.19, 0.16) * (0.7 + 0.5 * fine);
        let puddle = step(0.60, 0.68, broad) * (1.0 - 0.55 * dome);
        let mut texel = Texel::new(joint.lerp(top, stone) * (1.0 - 0.22 * puddle));
        let tilt = (unit(lattice(cell.id, 7, 5)) - 0.5) * 0.006;
        let height = 0.022 * dome + tilt * stone + 0.002 * fine;
        texel.height_m = height * (1.0 - puddle) + 0.012 * puddle;
        texel.roughness =
            (0.82 - 0.36 * stone - 0.10 * broad + 0.12 * fine) * (1.0 - puddle) + 0.09 * puddle;
        texel.open = 0.45 + 0.55 * stone;
        texel
    })
}

/// Where a point lies in a wall of blocks: distance to the joint in metres, and the block's hash.
fn course(p: Vec2, tile_m: f32, rows: u32, columns: u32, seed: u32) -> (f32, u32) {
    let y = p.y * rows as f32;
    let row = (y.floor() as i32).rem_euclid(rows as i32) as u32;
    // Rows are shifted by about half a block.
    let shift = 0.5 * (row % 2) as f32 + 0.2 * (unit(lattice(row, 1, seed)) - 0.5);
    let x = p.x * columns as f32 + shift;
    let column = (x.floor() as i32).rem_euclid(columns as i32) as u32;
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let to_x = fx.min(1.0 - fx) * tile_m / columns as f32;
    let to_y = fy.min(1.0 - fy) * tile_m / rows as f32;
    (to_x.min(to_y), lattice(column, row, seed))
}

/// Dressed limestone blocks, 2.4 m.
pub(crate) fn ashlar() -> Baked {
    bake("ashlar", 512, 2.4, |p| {
        let warp = Vec2::new(value(p, 16, 1), value(p, 16, 2)) * 0.006;
        let (joint, id) = course(p + warp, 2.4, 6, 3, 51);
        let block = step(0.004, 0.020, joint);
        let fine = fractal(p, 24, 4, 61);
        let stain = fractal(p, 3, 4, 71);
        let shade = 0.60 + 0.12 * unit(id) + 0.22 * (fine - 0.5) - 0.22 * step(0.5, 0.8, stain);
        let mut texel = Texel::new(Vec3::new(1.0, 0.93, 0.82) * shade * (0.55 + 0.45 * block));
        texel.height_m = 0.012 * block + 0.010 * fine + 0.004 * unit(id);
        texel.roughness = 0.78 + 0.2 * fine;
        texel.open = 0.5 + 0.5 * block;
        texel
    })
}

/// Thin old bricks, 1.2 m.
pub(crate) fn bricks() -> Baked {
    bake("bricks", 512, 1.2, |p| {
        let warp = Vec2::new(value(p, 24, 3), value(p, 24, 4)) * 0.006;
        let (joint, id) = course(p + warp, 1.2, 16, 5, 81);
        let brick = step(0.003, 0.011, joint);
        let fine = fractal(p, 32, 4, 91);
        let burnt = unit(lattice(id, 2, 4));
        let clay = Vec3::new(0.60, 0.33, 0.23).lerp(Vec3::new(0.42, 0.24, 0.20), burnt);
        let mortar = Vec3::new(0.58, 0.53, 0.46);
        let color = mortar.lerp(clay, brick) * (0.75 + 0.45 * fine);
        let mut texel = Texel::new(color);
        texel.height_m = 0.007 * brick + 0.005 * fine;
        texel.roughness = 0.85 + 0.12 * fine;
        texel.open = 0.55 + 0.45 * brick;
        texel
    })
}
