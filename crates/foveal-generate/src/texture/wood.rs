//! Wood and wicker.

use glam::{Vec2, Vec3};

use super::bake::{Baked, Texel, bake};
use super::noise::{fractal, step, value_2};
use crate::hash::{lattice, unit};

/// Planks 16 cm wide with the grain along u, 1.28 m; nearly white, to be tinted.
pub(crate) fn planks() -> Baked {
    bake("planks", 512, 1.28, |p| {
        let y = p.y * 8.0;
        let plank = y.floor() as u32 % 8;
        let across = y - y.floor();
        let gap = step(0.0, 0.05, across.min(1.0 - across));
        let id = lattice(plank, 0, 171);
        let shifted = Vec2::new(p.x + unit(id), p.y);
        let bend = 0.02 * value_2(shifted, 3, 8, 172);
        let grain = value_2(shifted + Vec2::new(0.0, bend), 4, 96, 173);
        let fibre = value_2(shifted, 16, 200, 174);
        let tone = 0.72 + 0.2 * unit(lattice(id, 1, 1)) - 0.22 * grain - 0.12 * fibre;
        let mut texel = Texel::new(Vec3::new(1.0, 0.94, 0.88) * tone * (0.45 + 0.55 * gap));
        texel.height_m = 0.004 * gap + 0.0016 * (1.0 - grain) + 0.0008 * fibre;
        texel.roughness = 0.62 + 0.25 * grain + 0.1 * fibre;
        texel.open = 0.5 + 0.5 * gap;
        texel
    })
}

/// Plaited wicker, 0.32 m: 8 by 8 crossings.
pub(crate) fn wicker() -> Baked {
    bake("wicker", 256, 0.32, |p| {
        let q = p * Vec2::new(8.0, 16.0);
        let cell = q.floor();
        let f = q - cell - 0.5;
        let over = (cell.x + cell.y) as i32 % 2 == 0;
        // A strand rises in the middle of its crossing and is round across.
        let round = (1.0 - 4.0 * f.y * f.y).max(0.0).sqrt();
        let arch = 1.0 - 4.0 * f.x * f.x;
        let height = if over {
            round * (0.45 + 0.55 * arch)
        } else {
            round * (0.75 - 0.55 * arch)
        };
        let fibre = value_2(p, 64, 16, 181);
        let stain = fractal(p, 2, 3, 182);
        let tone = 0.28 + 0.42 * height + 0.12 * (fibre - 0.5) + 0.1 * (stain - 0.5);
        let mut texel = Texel::new(Vec3::new(1.0, 0.80, 0.52) * tone);
        texel.height_m = 0.006 * height;
        texel.roughness = 0.7 + 0.2 * fibre;
        texel.open = 0.4 + 0.6 * height;
        texel
    })
}
