//! Tileable noise from integer hashes.

use glam::Vec2;

use crate::hash::{lattice, unit};

/// Smooth step from 0 at `low` to 1 at `high`.
pub(super) fn step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Value noise in [0, 1] with `cells` cells over the unit square, periodic.
pub(super) fn value(p: Vec2, cells: u32, seed: u32) -> f32 {
    value_2(p, cells, cells, seed)
}

/// Value noise with different numbers of cells in x and y.
pub(super) fn value_2(p: Vec2, cells_x: u32, cells_y: u32, seed: u32) -> f32 {
    let q = Vec2::new(p.x * cells_x as f32, p.y * cells_y as f32);
    let base = q.floor();
    let f = q - base;
    let f = f * f * (Vec2::splat(3.0) - 2.0 * f);
    let wrap = |v: f32, n: u32| (v as i32).rem_euclid(n as i32) as u32;
    let (x0, y0) = (wrap(base.x, cells_x), wrap(base.y, cells_y));
    let (x1, y1) = ((x0 + 1) % cells_x, (y0 + 1) % cells_y);
    let at = |x, y| unit(lattice(x, y, seed));
    let top = at(x0, y0) + (at(x1, y0) - at(x0, y0)) * f.x;
    let bottom = at(x0, y1) + (at(x1, y1) - at(x0, y1)) * f.x;
    top + (bottom - top) * f.y
}

/// Sum of `octaves` value noises of doubling frequency and halving weight, in [0, 1].
pub(super) fn fractal(p: Vec2, cells: u32, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut weight = 0.5;
    for o in 0..octaves {
        sum += weight * value(p, cells << o, seed.wrapping_add(o));
        weight *= 0.5;
    }
    sum / (1.0 - 2.0 * weight)
}

/// What [`cellular`] knows of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Distance to the border with the neighbour, in cells.
    pub(super) border: f32,
    /// A hash of the nearest point.
    pub(super) id: u32,
}

/// Cellular noise with `cells` cells over the unit square, periodic; `jitter` in [0, 1].
pub(super) fn cellular(p: Vec2, cells: u32, jitter: f32, seed: u32) -> Cell {
    let q = p * cells as f32;
    let base = q.floor();
    let mut nearest = (f32::INFINITY, Vec2::ZERO, 0);
    let mut points = [Vec2::ZERO; 9];
    for (i, point) in points.iter_mut().enumerate() {
        let offset = Vec2::new((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0);
        let c = base + offset;
        let wrap = |v: f32| (v as i32).rem_euclid(cells as i32) as u32;
        let h = lattice(wrap(c.x), wrap(c.y), seed);
        let shake = Vec2::new(unit(h), unit(lattice(h, 1, seed))) - 0.5;
        *point = c + 0.5 + shake * jitter;
        let d = point.distance_squared(q);
        if d < nearest.0 {
            nearest = (d, *point, h);
        }
    }
    let border = points
        .iter()
        .filter(|&&point| point != nearest.1)
        .map(|&point| {
            let between = point - nearest.1;
            ((point + nearest.1) * 0.5 - q).dot(between.normalize_or(Vec2::X))
        })
        .fold(f32::INFINITY, f32::min);
    Cell {
        border,
        id: nearest.2,
    }
}

/// Rounded dents over the unit square, 0 (edge) … 1 (middle), for hammered surfaces.
pub(crate) fn dent(p: Vec2) -> f32 {
    step(0.0, 0.35, cellular(p, 12, 0.8, 77).border)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_tiles() {
        for i in 0..50 {
            let p = Vec2::new(i as f32 * 0.019, 0.37);
            assert!((fractal(p, 4, 3, 1) - fractal(p + Vec2::X, 4, 3, 1)).abs() < 1e-3);
            let (a, b) = (cellular(p, 8, 0.8, 5), cellular(p + Vec2::Y, 8, 0.8, 5));
            assert_eq!(a.id, b.id);
            assert!((a.border - b.border).abs() < 1e-3);
        }
    }
}
