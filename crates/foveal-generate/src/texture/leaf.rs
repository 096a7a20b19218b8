//! Leaf cards: a spray of leaves with cut-out alpha.

use glam::{Vec2, Vec3};

use super::bake::{Texel, paint_masked};
use super::noise::step;
use crate::hash::Rng;
use crate::trig::sin_cos_turns;
use foveal_scene::Texture;

struct Leaf {
    foot: Vec2,
    axis: Vec2,
    length: f32,
    shade: f32,
}

/// A spray of pointed leaves; alpha is the cut-out, colour goes on beyond it.
pub(crate) fn leaves() -> Texture {
    let mut rng = Rng::new(241, 0);
    let spray: Vec<Leaf> = (0..46)
        .map(|i| {
            let around = sin_cos_turns(rng.unit());
            let from_middle = 0.34 * i as f32 / 46.0;
            let out = Vec2::from(around);
            let (sin, cos) = sin_cos_turns(rng.range(-0.14, 0.14));
            Leaf {
                foot: Vec2::splat(0.5) + out * from_middle,
                axis: Vec2::new(out.x * cos - out.y * sin, out.x * sin + out.y * cos),
                length: rng.range(0.11, 0.17),
                shade: rng.unit(),
            }
        })
        .collect();
    paint_masked("leaves", 256, |p| {
        let mut texel = Texel::new(Vec3::new(0.20, 0.30, 0.12));
        texel.alpha = 0.0;
        for leaf in &spray {
            let d = p - leaf.foot;
            let along = d.dot(leaf.axis) / leaf.length;
            let across = d.perp_dot(leaf.axis).abs() / leaf.length;
            if !(0.0..1.0).contains(&along) {
                continue;
            }
            // A parabola with its widest point below the middle, pointed at the tip.
            let width = 1.15 * along * (1.0 - along) * (1.3 - 0.6 * along);
            let inside = step(-0.03, 0.03, width - across);
            if inside > 0.0 {
                let rib = 1.0 - step(0.0, 0.04, across);
                let green =
                    Vec3::new(0.20, 0.36, 0.13).lerp(Vec3::new(0.42, 0.52, 0.20), leaf.shade);
                let color = green * (0.8 + 0.3 * along) + 0.10 * rib;
                texel.color = texel.color.lerp(color, inside);
                texel.alpha = texel.alpha.max(inside);
            }
        }
        texel
    })
}
