//! The CPU twin of `film.wgsl`.

use std::f32::consts::{PI, TAU};

use foveal_scene::Iridescence;
use glam::{Mat3, Vec3};

use crate::shading::twin::Surface;

/// `Film` in the shader.
#[derive(Clone, Copy)]
pub(super) struct Film {
    pub(super) strength: f32,
    pub(super) ior: f32,
    pub(super) thickness_nm: f32,
}

impl Film {
    /// Without textures.
    pub(super) fn new(iridescence: &Iridescence) -> Self {
        let thickness_nm = iridescence.thickness_max_nm;
        Self {
            strength: iridescence.factor * (thickness_nm / 10.0).clamp(0.0, 1.0),
            ior: iridescence.ior,
            thickness_nm,
        }
    }

    /// `film_reflectance` in the shader.
    pub(super) fn reflectance(&self, base_f0: Vec3, cosine: f32) -> Vec3 {
        let schlick = |f0: f32, cosine: f32| f0 + (1.0 - f0) * (1.0 - cosine).powi(5);
        let at_normal = |to: f32, from: f32| ((to - from) / (to + from)).powi(2);
        let within = (1.0 - (1.0 - cosine * cosine) / self.ior.powi(2)).sqrt();
        let upper = schlick(at_normal(self.ior, 1.0), cosine);
        let passed = 1.0 - upper;
        let difference = 2.0 * self.ior * self.thickness_nm * within;
        let mut sum = Vec3::ZERO;
        let (mut amplitudes, mut phases) = ([Vec3::ZERO; 2], [Vec3::ZERO; 2]);
        for channel in 0..3 {
            let root = base_f0[channel].clamp(0.0, 0.9999).sqrt();
            let ior = (1.0 + root) / (1.0 - root);
            let lower = schlick(at_normal(ior, self.ior), within);
            let round = (upper * lower).clamp(1e-5, 0.9999);
            let returned = passed * passed * lower / (1.0 - round);
            sum[channel] = upper + returned;
            let phase = if ior < self.ior { TAU } else { PI };
            for (order, power) in [(0, 0.5), (1, 1.0)] {
                amplitudes[order][channel] = 2.0 * (returned - passed) * round.powf(power);
                phases[order][channel] = (order as f32 + 1.0) * phase;
            }
        }
        for order in 0..2 {
            let difference = (order as f32 + 1.0) * difference;
            sum += amplitudes[order] * interference(difference, phases[order]);
        }
        sum.clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// `film_mirrored` in the shader, of which `fresnel` is without the film.
    pub(super) fn mirrored(&self, s: &Surface, fresnel: Vec3, cosine: f32) -> (Vec3, f32) {
        let of_dielectric = self.reflectance(s.dielectric.truncate(), cosine);
        let of_metal = self.reflectance(s.base_color, cosine);
        let bare = s.dielectric.truncate();
        let bare = bare + (s.dielectric.w - bare) * (1.0 - cosine).powi(5);
        let left = 1.0 - bare.lerp(of_dielectric, self.strength).max_element();
        let mixed = of_dielectric.lerp(of_metal, s.metallic);
        (fresnel.lerp(mixed, self.strength), left)
    }

    /// `under_film` in the shader.
    pub(super) fn under(&self, s: &Surface, v: Vec3) -> Surface {
        let cosine = s.normal.dot(v).clamp(0.0, 1.0);
        let m5 = (1.0 - cosine).powi(5).min(0.9);
        let at_normal = |f0: Vec3, at_grazing: f32| {
            let found = (self.reflectance(f0, cosine) - at_grazing * m5) / (1.0 - m5);
            f0.lerp(found.clamp(Vec3::ZERO, Vec3::ONE), self.strength)
        };
        let dielectric = at_normal(s.dielectric.truncate(), s.dielectric.w);
        Surface {
            base_color: at_normal(s.base_color, 1.0),
            dielectric: dielectric.extend(s.dielectric.w),
            ..*s
        }
    }
}

/// `interference` in the shader, from the numbers of the extension's text: per metre.
fn interference(difference_nm: f32, phase: Vec3) -> Vec3 {
    let turn = f64::from(TAU * difference_nm) * 1e-9;
    let one = |amplitude: f64, position: f64, variance: f64, phase: f32| {
        let width = (std::f64::consts::TAU * variance).sqrt();
        let wave = (position * turn + f64::from(phase)).cos() * (-variance * turn * turn).exp();
        (amplitude * width * wave / 1.0685e-7) as f32
    };
    let xyz = Vec3::new(
        one(5.4856e-13, 1.6810e6, 4.3278e9, phase.x) + one(9.7470e-14, 2.2399e6, 4.5282e9, phase.x),
        one(4.4201e-13, 1.7953e6, 9.3046e9, phase.y),
        one(5.2481e-13, 2.2084e6, 6.6121e9, phase.z),
    );
    to_srgb() * xyz
}

/// Linear sRGB of X, Y and Z.
pub(super) fn to_srgb() -> Mat3 {
    Mat3::from_cols(
        Vec3::new(3.240_454_2, -0.969_266, 0.055_643_4),
        Vec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
        Vec3::new(-0.498_531_4, 0.041_556, 1.057_225_2),
    )
}
