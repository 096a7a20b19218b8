//! Plaster and clay: walls that are tinted by their material's colour.

use glam::{Vec2, Vec3};

use super::bake::{Baked, Texel, bake};
use super::noise::{cellular, fractal, step, value, value_2};

/// Lime plaster with stains, streaks of rain and hair cracks, 4 m; nearly white.
pub(crate) fn plaster() -> Baked {
    bake("plaster", 512, 4.0, |p| {
        let broad = fractal(p, 3, 5, 101);
        let fine = fractal(p, 40, 3, 111);
        let streak = value_2(p, 48, 3, 121) * fractal(p, 4, 2, 131);
        // Cracks wander, and only some places are cracked at all.
        let wander = Vec2::new(value(p, 24, 142), value(p, 24, 143)) * 0.03;
        let sound = 1.0 - step(0.52, 0.60, fractal(p, 4, 3, 144));
        let crack = step(
            0.0,
            0.016,
            cellular(p + wander, 9, 0.95, 141).border + 0.05 * sound,
        );
        let worn = step(0.62, 0.70, broad + 0.12 * (fine - 0.5));
        let shade =
            0.96 - 0.22 * step(0.35, 0.75, streak) - 0.16 * (broad - 0.4) + 0.06 * (fine - 0.5);
        let lime = Vec3::splat(shade) * (0.8 + 0.2 * crack);
        let under = Vec3::new(0.74, 0.67, 0.60) * (0.8 + 0.4 * fine);
        let mut texel = Texel::new(lime.lerp(under, worn));
        texel.height_m = 0.010 * broad + 0.004 * fine - 0.012 * worn - 0.003 * (1.0 - crack);
        texel.roughness = 0.86 + 0.12 * fine;
        texel.open = 0.75 + 0.25 * crack;
        texel
    })
}

/// Thrown clay with the potter's grooves, 0.5 m; nearly white.
pub(crate) fn clay() -> Baked {
    bake("clay", 256, 0.5, |p| {
        let groove = value_2(p, 2, 48, 151);
        let broad = fractal(p, 4, 4, 161);
        let mut texel = Texel::new(Vec3::splat(0.80 + 0.22 * (broad - 0.5) + 0.08 * groove));
        texel.height_m = 0.0016 * groove + 0.002 * broad;
        texel.roughness = 0.55 + 0.4 * broad;
        texel
    })
}
