//! Metal: hammered brass and copper, and iron with rust.

use glam::Vec3;

use super::bake::{Baked, Texel, bake};
use super::noise::{cellular, fractal, step};

/// Hammered sheet, 0.4 m, metallic with dull patina in the hollows; nearly white, to be tinted.
pub(crate) fn hammered() -> Baked {
    bake("hammered", 256, 0.4, |p| {
        let blow = step(0.0, 0.5, cellular(p, 14, 0.85, 221).border);
        let patina = step(0.5, 0.75, fractal(p, 4, 4, 222));
        let mut texel = Texel::new(Vec3::splat(0.98 - 0.35 * patina - 0.05 * blow));
        texel.height_m = -0.0022 * blow;
        texel.roughness = 0.22 + 0.4 * patina;
        texel.metallic = 1.0 - 0.45 * patina;
        texel
    })
}

/// Forged iron, 0.5 m: dark metal with rust.
pub(crate) fn iron() -> Baked {
    bake("iron", 128, 0.5, |p| {
        let rust = step(0.48, 0.66, fractal(p, 4, 4, 231));
        let fine = fractal(p, 24, 2, 232);
        let color = Vec3::new(0.30, 0.29, 0.29).lerp(Vec3::new(0.36, 0.20, 0.12), rust);
        let mut texel = Texel::new(color * (0.8 + 0.4 * fine));
        texel.height_m = 0.001 * fine + 0.001 * rust;
        texel.roughness = 0.45 + 0.45 * rust;
        texel.metallic = 0.9 * (1.0 - rust);
        texel
    })
}
