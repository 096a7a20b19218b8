//! Cube maps on the CPU, filtered across their edges as graphics devices do.

use glam::{Vec2, Vec3, Vec3A};
use rayon::prelude::*;

/// Sides of a cube.
pub(super) const SIDES: usize = 6;

/// The direction of a place on a side of the cube: `s` to the right and `t` down, -1 to 1. Sides
/// are numbered as graphics APIs number them: +x, -x, +y, -y, +z, -z. Not of unit length.
pub(super) fn direction_of(side: usize, place: Vec2) -> Vec3 {
    let Vec2 { x: s, y: t } = place;
    match side {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    }
}

/// The side that a direction points to, and the place on it.
pub(super) fn place_of(d: Vec3) -> (usize, Vec2) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        let side = usize::from(d.x < 0.0);
        let s = if d.x < 0.0 { d.z } else { -d.z };
        (side, Vec2::new(s, -d.y) / a.x)
    } else if a.y >= a.z {
        let side = 2 + usize::from(d.y < 0.0);
        let t = if d.y < 0.0 { -d.z } else { d.z };
        (side, Vec2::new(d.x, t) / a.y)
    } else {
        let side = 4 + usize::from(d.z < 0.0);
        let s = if d.z < 0.0 { -d.x } else { d.x };
        (side, Vec2::new(s, -d.y) / a.z)
    }
}

/// The solid angle of a texel at `place`, up to a factor that all texels of a level share.
pub(super) fn relative_solid_angle(place: Vec2) -> f32 {
    (1.0 + place.length_squared()).powf(-1.5)
}

/// One level of a cube map. Each side has a border of one texel, which holds its neighbours'.
#[derive(Clone, Debug)]
pub(super) struct Cube {
    /// Texels a side.
    pub(super) side: usize,
    texels: Vec<Vec3A>,
}

impl Cube {
    /// A cube whose texels are what `texel` gives for a side and a column and row.
    pub(super) fn from_texels(
        side: usize,
        texel: impl Fn(usize, usize, usize) -> Vec3A + Sync,
    ) -> Self {
        let row = side + 2;
        let mut texels = vec![Vec3A::ZERO; SIDES * row * row];
        texels
            .par_chunks_mut(row)
            .enumerate()
            .for_each(|(number, texels)| {
                let (face, y) = (number / row, number % row);
                if (1..=side).contains(&y) {
                    for (x, at) in texels[1..=side].iter_mut().enumerate() {
                        *at = texel(face, x, y - 1);
                    }
                }
            });
        let mut cube = Self { side, texels };
        cube.fill_borders();
        cube
    }

    /// The place of a texel's centre on its side.
    pub(super) fn center(&self, x: usize, y: usize) -> Vec2 {
        texel_center(self.side, x, y)
    }

    pub(super) fn texel(&self, face: usize, x: usize, y: usize) -> Vec3A {
        self.texels[self.index(face, x + 1, y + 1)]
    }

    /// `x` and `y` count the border.
    fn index(&self, face: usize, x: usize, y: usize) -> usize {
        let row = self.side + 2;
        (face * row + y) * row + x
    }

    /// The texels beyond each edge are those of the neighbouring side; a corner is the mean of the
    /// three texels around it.
    fn fill_borders(&mut self) {
        let last = self.side + 1;
        let beyond = 1.0 + 1e-3 / self.side as f32;
        for face in 0..SIDES {
            for i in 1..last {
                let along = texel_center(self.side, i - 1, 0).x;
                for (x, y, place) in [
                    (0, i, Vec2::new(-beyond, along)),
                    (last, i, Vec2::new(beyond, along)),
                    (i, 0, Vec2::new(along, -beyond)),
                    (i, last, Vec2::new(along, beyond)),
                ] {
                    let (other, there) = place_of(direction_of(face, place));
                    let side = self.side as f32;
                    let at =
                        (0.5 * (there + 1.0) * side).clamp(Vec2::ZERO, Vec2::splat(side - 1.0));
                    let texel = self.texel(other, at.x as usize, at.y as usize);
                    let index = self.index(face, x, y);
                    self.texels[index] = texel;
                }
            }
            for (x, y, dx, dy) in [
                (0, 0, 1, 1),
                (last, 0, last - 1, 1),
                (0, last, 1, last - 1),
                (last, last, last - 1, last - 1),
            ] {
                let three = [(dx, dy), (x, dy), (dx, y)];
                let sum: Vec3A = three
                    .iter()
                    .map(|&(x, y)| self.texels[self.index(face, x, y)])
                    .sum();
                let index = self.index(face, x, y);
                self.texels[index] = sum / 3.0;
            }
        }
    }

    /// Radiance in a direction, blended between four texels.
    pub(super) fn sample(&self, direction: Vec3) -> Vec3A {
        let (face, place) = place_of(direction);
        // Never below 0: a cast does what a floor would, in fewer instructions.
        let at = (place + 1.0) * (0.5 * self.side as f32) + 0.5;
        let (x, y) = (at.x as u32, at.y as u32);
        let f = at - Vec2::new(x as f32, y as f32);
        let row = self.side + 2;
        let first = self
            .index(face, x as usize, y as usize)
            .min(self.texels.len() - row - 2);
        let four = &self.texels[first..first + row + 2];
        let upper = four[0].lerp(four[1], f.x);
        let lower = four[row].lerp(four[row + 1], f.x);
        upper.lerp(lower, f.y)
    }

    /// The next coarser level: means of two by two texels, weighted by their solid angles.
    pub(super) fn halved(&self) -> Self {
        Self::from_texels(self.side / 2, |face, x, y| {
            let mut sum = Vec3A::ZERO;
            let mut weights = 0.0;
            for (x, y) in [
                (2 * x, 2 * y),
                (2 * x + 1, 2 * y),
                (2 * x, 2 * y + 1),
                (2 * x + 1, 2 * y + 1),
            ] {
                let weight = relative_solid_angle(self.center(x, y));
                sum += weight * self.texel(face, x, y);
                weights += weight;
            }
            sum / weights
        })
    }
}

/// The place of a texel's centre on a side of so many texels.
pub(super) fn texel_center(side: usize, x: usize, y: usize) -> Vec2 {
    (Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / side as f32) - 1.0
}
