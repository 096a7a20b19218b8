//! Roofs of hollow tiles.

use glam::Vec3;

use super::bake::{Baked, Texel, bake};
use super::noise::{fractal, step};
use crate::hash::{lattice, unit};

/// Monk-and-nun tiles, 1.6 m: eight columns of four tiles; v runs down the slope.
pub(crate) fn roof_tiles() -> Baked {
    bake("roof tiles", 512, 1.6, |p| {
        let x = p.x * 8.0;
        let column = x.floor() as u32 % 8;
        let f = x - x.floor() - 0.5;
        // Every second row of covers is laid a little lower.
        let y = p.y * 4.0 + 0.13 * unit(lattice(column, 0, 191));
        let row = (y.floor() as i32).rem_euclid(4) as u32;
        let along = y - y.floor();
        let id = lattice(column, row, 192);
        let cover = (1.0 - 6.5 * f * f).max(0.0).sqrt();
        let lip = step(0.0, 0.06, 1.0 - along);
        let fine = fractal(p, 24, 3, 193);
        let moss = step(0.58, 0.75, fractal(p, 5, 4, 194)) * (1.0 - cover);
        let tone = 0.74 + 0.26 * unit(id) + 0.25 * (fine - 0.5);
        let clay =
            Vec3::new(0.78, 0.44, 0.30).lerp(Vec3::new(0.66, 0.46, 0.36), unit(lattice(id, 1, 1)));
        let color = (clay * tone).lerp(Vec3::new(0.20, 0.22, 0.13), 0.7 * moss);
        let mut texel = Texel::new(color * (0.6 + 0.4 * cover.max(0.25)) * (0.7 + 0.3 * lip));
        texel.height_m = 0.05 * cover + 0.025 * along * lip + 0.003 * fine;
        texel.roughness = 0.8 + 0.15 * fine;
        texel.open = (0.4 + 0.6 * cover) * (0.6 + 0.4 * lip);
        texel
    })
}
