//! Cloth: striped awnings, canvas, rugs.

use glam::{Vec2, Vec3};

use super::bake::{Baked, Texel, bake, paint};
use super::noise::{fractal, step, value};
use crate::hash::{lattice, unit};
use foveal_scene::Texture;

/// Plain woven canvas, 0.5 m, with folds; nearly white. Its normals serve all cloths.
pub(crate) fn canvas() -> Baked {
    bake("canvas", 256, 0.5, |p| {
        let q = p * 64.0;
        let over = (q.x.floor() + q.y.floor()) as i32 % 2 == 0;
        let (f, g) = (q.x - q.x.floor() - 0.5, q.y - q.y.floor() - 0.5);
        let thread = if over {
            1.0 - 4.0 * g * g
        } else {
            1.0 - 4.0 * f * f
        };
        let soil = fractal(p, 3, 4, 201);
        let mut texel = Texel::new(Vec3::splat(0.82 + 0.10 * thread - 0.14 * (soil - 0.4)));
        texel.height_m = 0.0009 * thread + 0.006 * value(p, 4, 202);
        texel.roughness = 0.92;
        texel
    })
}

/// Awning cloth with `stripes` pairs of stripes along v over a 1.6 m tile.
pub(crate) fn stripes(name: &str, color: [f32; 3], ground: [f32; 3]) -> Texture {
    paint(name, 256, |p| {
        let x = (p.x * 4.0).fract();
        let edge = 0.02;
        let wide = step(0.08 - edge, 0.08, x) * (1.0 - step(0.5, 0.5 + edge, x));
        let thin = step(0.72 - edge, 0.72, x) * (1.0 - step(0.78, 0.78 + edge, x));
        let soil = fractal(p, 4, 4, 211);
        let thread = value(p, 128, 212);
        let color = Vec3::from(ground).lerp(Vec3::from(color), wide.max(thin));
        Texel::new(color * (1.04 - 0.20 * soil + 0.10 * (thread - 0.5)))
    })
}

/// A rug with a mirrored pattern of steps and stars within two borders; not repeating.
pub(crate) fn rug(name: &str, palette: [[f32; 3]; 4], seed: u32) -> Texture {
    let mut texture = paint(name, 256, |p| {
        // One quarter, mirrored, on a grid of knots.
        let m = (Vec2::splat(0.5) - (p - 0.5).abs()).max(Vec2::ZERO);
        let knot = (m * 64.0).floor();
        let (x, y) = (knot.x as u32, knot.y as u32);
        let rim = x.min(y);
        let diagonal = (x + 2 * y) % 16;
        let index = match rim {
            0 => 3,
            1..4 => (((x + y) / 2) % 2) as usize + 1,
            4 => 3,
            5..8 => usize::from((x.max(y) / 3) % 2 == 0) * 2,
            _ => {
                let star = ((x % 12).abs_diff(6) + (y % 12).abs_diff(6)) / 2;
                let chance = lattice(star, diagonal / 4, seed) % 4;
                if star < 2 { 3 } else { chance as usize % 3 }
            }
        };
        let wear = fractal(p, 6, 4, seed);
        let pile = unit(lattice((p.x * 256.0) as u32, (p.y * 256.0) as u32, seed));
        Texel::new(Vec3::from(palette[index]) * (0.85 + 0.25 * wear + 0.12 * (pile - 0.5)))
    });
    texture.sampler.wrap_u = foveal_scene::Wrap::MirroredRepeat;
    texture.sampler.wrap_v = foveal_scene::Wrap::MirroredRepeat;
    texture
}
