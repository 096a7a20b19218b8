//! Equirectangular pictures: checked, and looked up by direction.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3, Vec3A};

use crate::Error;

/// Most texels of a picture: 8192 x 4096.
pub(super) const MOST_TEXELS: u64 = 1 << 25;

/// Radiance of texels that are infinite, the largest half: files of halves overflow there.
const INFINITE: f32 = 65504.0;
/// Radiance that nothing exceeds.
const MOST: f32 = 1e9;

/// The whole sphere of directions as longitudes across and latitudes down. The centre is +x, the
/// right half of the picture +z, the top +y.
#[derive(Debug)]
pub(super) struct Equirectangular {
    width: usize,
    height: usize,
    texels: Vec<Vec3A>,
}

fn clean(v: f32) -> f32 {
    if v == f32::INFINITY {
        INFINITE
    } else if v > 0.0 {
        v.min(MOST)
    } else {
        // Negative, or no number.
        0.0
    }
}

impl Equirectangular {
    /// # Errors
    /// [`Error::Environment`] for a picture that is not twice as wide as high or has another number
    /// of texels than its size says, [`Error::Limit`] for one that is too large.
    pub(super) fn new(width: u32, height: u32, rgb: &[[f32; 3]]) -> Result<Self, Error> {
        let wrong = |cause| Err(Error::Environment { cause });
        if height == 0 || u64::from(width) != 2 * u64::from(height) {
            return wrong(format!(
                "it is {width} x {height} texels, and an equirectangular picture is twice as wide as high"
            ));
        }
        let count = u64::from(width) * u64::from(height);
        if count > MOST_TEXELS {
            return Err(Error::Limit {
                what: format!("the number of texels of an environment of {width} x {height}"),
                value: count,
                limit: MOST_TEXELS,
                hint: ": scale it down to 8192 x 4096".to_owned(),
            });
        }
        if rgb.len() as u64 != count {
            return wrong(format!(
                "it has {} texels, and {width} x {height} are {count}",
                rgb.len()
            ));
        }
        let texels = rgb.iter().map(|&rgb| Vec3A::from(rgb.map(clean)));
        Ok(Self {
            width: width as usize,
            height: height as usize,
            texels: texels.collect(),
        })
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// The same picture with half as many texels across and down.
    pub(super) fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let texel = |i: usize| {
            let (x, y) = (2 * (i % width), 2 * (i / width));
            let row = |y: usize| {
                let first = y * self.width + x;
                self.texels[first] + self.texels[first + 1]
            };
            0.25 * (row(y) + row(y + 1))
        };
        Self {
            width,
            height,
            texels: (0..width * height).map(texel).collect(),
        }
    }

    /// The same picture with as even a resolution as a sphere has: towards the poles texels of a row
    /// lie closer together than at the equator, and become the mean of as many as are as wide
    /// together. So a few lookups for a solid angle miss none of them.
    pub(super) fn evened(mut self) -> Self {
        let mut sums = Vec::with_capacity(self.width + 1);
        for (row, texels) in self.texels.chunks_exact_mut(self.width).enumerate() {
            let sine = ((row as f32 + 0.5) / self.height as f32 * PI).sin();
            // To each side.
            let reach = ((0.5 / sine) as usize).min((self.width - 1) / 2);
            if reach == 0 {
                continue;
            }
            sums.clear();
            let mut sum = DVec3::ZERO;
            for texel in texels.iter() {
                sums.push(sum);
                sum += Vec3::from(*texel).as_dvec3();
            }
            // Of the texels before a place, which may lie beyond the row's ends.
            let before = |at: isize| {
                let width = sums.len() as isize;
                sum * at.div_euclid(width) as f64 + sums[at.rem_euclid(width) as usize]
            };
            let count = (2 * reach + 1) as f64;
            for (i, texel) in (0..).zip(texels.iter_mut()) {
                let reach = reach as isize;
                let mean = (before(i + reach + 1) - before(i - reach)) / count;
                *texel = mean.as_vec3a();
            }
        }
        self
    }

    /// Each row: the sine of the angle from the pole, and its directions with what comes from there.
    pub(super) fn rows(&self) -> impl Iterator<Item = (f32, impl Iterator<Item = (Vec3, Vec3A)>)> {
        let (width, height) = (self.width as f32, self.height as f32);
        let rows = self.texels.chunks_exact(self.width).enumerate();
        rows.map(move |(row, texels)| {
            let (sine, y) = ((row as f32 + 0.5) / height * PI).sin_cos();
            let directions = texels.iter().enumerate().map(move |(i, &texel)| {
                let (z, x) = (((i as f32 + 0.5) / width - 0.5) * TAU).sin_cos();
                (Vec3::new(sine * x, y, sine * z), texel)
            });
            (sine, directions)
        })
    }

    /// Radiance in a unit direction, blended between four texels.
    pub(super) fn sample(&self, d: Vec3) -> Vec3A {
        let across = (d.z.atan2(d.x) / TAU + 0.5) * self.width as f32 - 0.5;
        let down = (d.y.clamp(-1.0, 1.0).acos() / PI) * self.height as f32 - 0.5;
        let (left, top) = (across.floor(), down.floor());
        let (fx, fy) = (across - left, down - top);
        let width = self.width as i32;
        let x = (left as i32).rem_euclid(width) as usize;
        let next = (x + 1) % self.width;
        let row = |y: i32| {
            let first = y.clamp(0, self.height as i32 - 1) as usize * self.width;
            self.texels[first + x].lerp(self.texels[first + next], fx)
        };
        row(top as i32).lerp(row(top as i32 + 1), fy)
    }
}
