//! An equirectangular environment: its radiance, and directions by chance, bright ones more often.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

pub(crate) struct Around {
    width: usize,
    height: usize,
    rgb: Vec<[f32; 3]>,
    /// Sums of the texels' luminance times their solid angle.
    sums: Vec<f32>,
}

impl Around {
    pub(crate) fn new(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Self {
        let (width, height) = (width as usize, height as usize);
        let mut sum = 0.0f64;
        let sums = rgb.iter().enumerate().map(|(i, rgb)| {
            let down = ((i / width) as f32 + 0.5) / height as f32 * PI;
            sum += f64::from(down.sin() * rgb.iter().sum::<f32>());
            sum as f32
        });
        let sums = sums.collect();
        Self {
            width,
            height,
            rgb,
            sums,
        }
    }

    /// Blended between four texels.
    pub(crate) fn radiance(&self, d: Vec3) -> Vec3 {
        let x = (d.z.atan2(d.x) / TAU + 0.5) * self.width as f32 - 0.5;
        let y = (d.y.clamp(-1.0, 1.0).acos() / PI * self.height as f32 - 0.5)
            .clamp(0.0, self.height as f32 - 1.001);
        let texel = |x: f32, y: f32| {
            let x = (x as i64).rem_euclid(self.width as i64) as usize;
            Vec3::from(self.rgb[y as usize * self.width + x])
        };
        let (left, top) = (x.floor(), y.floor());
        let row = |y| texel(left, y).lerp(texel(left + 1.0, y), x - left);
        row(top).lerp(row(top + 1.0), y - top)
    }

    /// A direction for three numbers between 0 and 1.
    pub(crate) fn sample(&self, at: [f32; 3]) -> Vec3 {
        let wanted = at[0] * self.sums[self.sums.len() - 1];
        let texel = self.sums.partition_point(|&sum| sum < wanted);
        let texel = texel.min(self.sums.len() - 1);
        let x = ((texel % self.width) as f32 + at[1]) / self.width as f32;
        let y = ((texel / self.width) as f32 + at[2]) / self.height as f32;
        let (sin, cos) = ((x - 0.5) * TAU).sin_cos();
        let (across, up) = (y * PI).sin_cos();
        Vec3::new(across * cos, up, across * sin)
    }

    /// Chance of a direction per solid angle.
    pub(crate) fn density(&self, d: Vec3) -> f32 {
        let x = ((d.z.atan2(d.x) / TAU + 0.5) * self.width as f32) as usize;
        let y = (d.y.clamp(-1.0, 1.0).acos() / PI * self.height as f32) as usize;
        let i = y.min(self.height - 1) * self.width + x.min(self.width - 1);
        let before = if i == 0 { 0.0 } else { self.sums[i - 1] };
        let chance = (self.sums[i] - before) / self.sums[self.sums.len() - 1];
        let texel = TAU * PI / (self.width * self.height) as f32;
        let across = (1.0 - d.y * d.y).max(1e-6).sqrt();
        chance / (texel * across)
    }
}
