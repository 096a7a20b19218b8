//! The CPU twin of `shared/environment.wgsl`, where a map lights the scene.

use glam::Vec3;

use super::EnvironmentMap;
use super::cube::Cube;
use super::irradiance::polynomials;
use super::prefilter::Levels;
use super::reflectance::looked_up;
use crate::Settings;
use crate::shading::twin::Surface;
use crate::testing::f32_of_half;

/// What a surface mirrors of light from everywhere, and what is left to be scattered.
pub(super) fn reflectances(s: &Surface, v: Vec3) -> [Vec3; 2] {
    let terms = looked_up(s.normal.dot(v).clamp(0.0, 1.0), s.roughness);
    let (f0, f90) = (s.reflectance_at_normal(), s.reflectance_at_grazing());
    let [at_normal, at_grazing] = s.kept_from_scattering();
    let left = (1.0 - at_normal) * terms.z + (1.0 - at_grazing) * (1.0 - terms.z);
    [f0 * terms.x + terms.y * f90, Vec3::splat(left)]
}

/// A map as shaders see it.
pub(crate) struct Around {
    cubes: Vec<Cube>,
    levels: Levels,
    irradiance: [Vec3; 9],
    /// Cosine and sine.
    turn: [f32; 2],
    intensity: f32,
}

impl Around {
    pub(crate) fn new(map: &EnvironmentMap, settings: &Settings) -> Self {
        let levels = map.levels();
        let cube = |level: u32| {
            let side = (map.side() >> level) as usize;
            let texels = map.texels(level);
            Cube::from_texels(side, |face, x, y| {
                let [r, g, b, _] = texels[(face * side + y) * side + x];
                Vec3::from([r, g, b].map(f32_of_half)).into()
            })
        };
        let turn = settings.lighting.environment_rotation_deg.to_radians();
        Self {
            cubes: (0..=levels.last as u32).map(cube).collect(),
            levels,
            irradiance: *map.irradiance(),
            turn: [turn.cos(), turn.sin()],
            intensity: settings.lighting.environment_intensity,
        }
    }

    fn in_map(&self, d: Vec3) -> Vec3 {
        let [cos, sin] = self.turn;
        Vec3::new(cos * d.x - sin * d.z, d.y, sin * d.x + cos * d.z)
    }

    pub(crate) fn environment(&self, direction: Vec3, roughness: f32) -> Vec3 {
        let d = self.in_map(direction);
        let level = self.levels.level(roughness);
        let last = self.cubes.len() - 1;
        let finer = &self.cubes[level as usize];
        let coarser = &self.cubes[(level as usize + 1).min(last)];
        let radiance = finer.sample(d).lerp(coarser.sample(d), level.fract());
        self.intensity * Vec3::from(radiance)
    }

    /// What is seen behind all surfaces.
    pub(crate) fn background(&self, direction: Vec3, roughness: f32) -> Vec3 {
        self.environment(direction, roughness)
            .min(Vec3::splat(65504.0))
    }

    pub(crate) fn irradiance(&self, normal: Vec3) -> Vec3 {
        let terms = polynomials(self.in_map(normal));
        let sum: Vec3 = self.irradiance.iter().zip(terms).map(|(&c, t)| c * t).sum();
        self.intensity * sum.max(Vec3::ZERO)
    }

    pub(crate) fn ambient(&self, s: &Surface, v: Vec3) -> Vec3 {
        let mirror = 2.0 * s.normal.dot(v) * s.normal - v;
        let mirror = mirror.lerp(s.normal, s.roughness * s.roughness).normalize();
        let [mirrored, left] = reflectances(s, v);
        let color = (1.0 - s.metallic) * s.base_color;
        let diffuse = color * left * self.irradiance(s.normal);
        (diffuse + mirrored * self.environment(mirror, s.roughness)) * s.occlusion
    }
}
