//! Pictures of light: lit windows, lantern paper, the clock's face, the moon, steam.

use glam::{Vec2, Vec3};

use super::bake::{Texel, paint, paint_clear, picture_clamped};
use super::noise::{fractal, step, value_2};
use crate::hash::{lattice, unit};
use crate::trig::sin_cos_turns;
use foveal_scene::Texture;

/// A casement of 2 by 4 panes with light and half-drawn curtains behind; v runs down.
pub(crate) fn window() -> Texture {
    picture_clamped(paint("lit window", 128, |p| {
        let grid = p * Vec2::new(2.0, 4.0);
        let f = grid - grid.floor();
        let edge = f.min(Vec2::ONE - f) * Vec2::new(0.5, 0.25);
        let pane = step(0.010, 0.024, edge.x.min(edge.y));
        let id = lattice(grid.x as u32, grid.y as u32, 251);
        let curtain = step(0.30, 0.44, (p.x - 0.5).abs() + 0.10 * (p.y - 0.5));
        let fold = 0.85 + 0.3 * fractal(Vec2::new(p.x, 0.3), 24, 2, 252);
        let lamp = 1.0 - step(0.0, 0.75, p.distance(Vec2::new(0.5, 0.55)));
        let light = Vec3::new(0.98, 0.74, 0.42) * (0.60 + 0.40 * lamp + 0.06 * unit(id));
        let cloth = Vec3::new(0.78, 0.40, 0.20) * fold;
        Texel::new(light.lerp(cloth, 0.75 * curtain) * (0.04 + 0.96 * pane))
    }))
}

/// The face of the tower's clock at five to nine.
pub(crate) fn clock() -> Texture {
    picture_clamped(paint("clock", 256, |p| {
        let d = (p - 0.5) * 2.0;
        let r = d.length();
        let face = Vec3::new(1.0, 0.90, 0.66) * (1.0 - 0.22 * r * r);
        let mut ink = step(0.90, 0.92, r) + step(0.015, 0.0, (r - 0.70).abs());
        for hour in 0..12u8 {
            let (sin, cos) = sin_cos_turns(f32::from(hour) / 12.0);
            let axis = Vec2::new(sin, -cos);
            let (along, across) = (d.dot(axis), d.perp_dot(axis).abs());
            let width = if hour % 3 == 0 { 0.040 } else { 0.022 };
            let bar = step(0.72, 0.74, along) * step(0.88, 0.86, along);
            ink = ink.max(bar * step(width, width - 0.015, across));
        }
        for (turns, length, width) in [
            (11.0 / 12.0, 0.66, 0.028),
            (0.75 - 1.0 / 144.0, 0.44, 0.042),
        ] {
            let (sin, cos) = sin_cos_turns(turns);
            let axis = Vec2::new(sin, -cos);
            let (along, across) = (d.dot(axis), d.perp_dot(axis).abs());
            let hand = step(-0.14, -0.12, along) * step(length, length - 0.02, along);
            ink = ink.max(hand * step(width, width - 0.015, across));
        }
        Texel::new(face.lerp(Vec3::new(0.05, 0.04, 0.03), ink.clamp(0.0, 1.0)))
    }))
}

/// The moon's disc with its seas.
pub(crate) fn moon() -> Texture {
    picture_clamped(paint("moon", 128, |p| {
        let sea = step(0.48, 0.62, fractal(p, 3, 4, 261));
        let speck = fractal(p, 20, 3, 262);
        Texel::new(Vec3::new(0.96, 0.95, 0.90) * (0.98 - 0.28 * sea + 0.12 * (speck - 0.5)))
    }))
}

/// A wisp of steam that fades at all edges; v runs down.
pub(crate) fn steam() -> Texture {
    picture_clamped(paint_clear("steam", 128, |p| {
        let curl = (fractal(p, 3, 3, 271) - 0.5) * 0.35 * (1.0 - p.y);
        let narrow = 0.14 + 0.24 * (1.0 - p.y);
        let side = 1.0 - step(0.0, narrow, (p.x - 0.5 + curl).abs());
        let ends = step(0.0, 0.35, p.y) * step(1.0, 0.85, p.y);
        let mut texel = Texel::new(Vec3::new(0.95, 0.93, 0.90));
        texel.alpha = side * ends * (0.15 + 0.85 * fractal(p, 5, 4, 272));
        texel
    }))
}

/// Paper over bamboo hoops, brightest around the flame; v runs from pole to pole.
pub(crate) fn paper() -> Texture {
    paint("lantern paper", 128, |p| {
        let hoop = (p.y * 12.0).fract();
        let rib = step(0.0, 0.16, hoop.min(1.0 - hoop));
        // The flame stands a little below the middle.
        let far = (p.y - 0.56).abs() * 2.0;
        let glow = 1.0 - 0.72 * step(0.1, 1.0, far);
        let fibre = value_2(p, 6, 24, 281);
        Texel::new(Vec3::splat(
            glow * (0.72 + 0.28 * rib) * (0.9 + 0.12 * fibre),
        ))
    })
}
