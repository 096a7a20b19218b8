//! The CPU twin of `lobes.wgsl`.

use std::f32::consts::PI;

use foveal_scene::{Material, Scene};
use glam::{Vec2, Vec3};

use super::film_twin::Film;
use crate::lights::LightUniform;
use crate::shading::dielectric::PLAIN_DIELECTRIC;
use crate::shading::twin::{
    Surface, environment, environment_reflectance, ggx_lobe, gradient_around, incident,
    squared_alpha,
};

/// `LobedSurface` in the shader: a surface and its material's lobes, which have no textures here.
pub(super) struct Lobed<'a> {
    pub(super) base: Surface,
    pub(super) material: &'a Material,
    /// Unit, along the surface.
    pub(super) along: Vec3,
}

/// The shader's own table.
pub(super) fn sheen_parts() -> Vec<f32> {
    let text = include_str!("lobes.wgsl");
    let table = text.split("array<f32, 64>(").nth(1).unwrap();
    let numbers = table.split(')').next().unwrap().split(',');
    numbers.filter_map(|n| n.trim().parse().ok()).collect()
}

pub(super) fn sheen_part(table: &[f32], cosine: f32, roughness: f32) -> f32 {
    let at = (Vec2::new(cosine, roughness) * 8.0 - 0.5).clamp(Vec2::ZERO, Vec2::splat(7.0));
    let low = at.floor().min(Vec2::splat(6.0));
    let f = at - low;
    let entry = |x: f32, y: f32| table[(y * 8.0 + x) as usize];
    let row = |y: f32| entry(low.x, y) * (1.0 - f.x) + entry(low.x + 1.0, y) * f.x;
    row(low.y) * (1.0 - f.y) + row(low.y + 1.0) * f.y
}

fn fibre_shadowing(cosine: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha).powi(2);
    let between = |rough: f32, smooth: f32| rough + (smooth - rough) * t;
    let [a, b, c, d, e] = [
        (21.5473, 25.3245),
        (3.82987, 3.32435),
        (0.19823, 0.16801),
        (-1.97760, -1.27393),
        (-4.32054, -4.85967),
    ]
    .map(|(rough, smooth)| between(rough, smooth));
    let shape = |x: f32| a / (1.0 + b * x.max(1e-4).powf(c)) + d * x + e;
    if cosine < 0.5 {
        shape(cosine).exp()
    } else {
        (2.0 * shape(0.5) - shape(1.0 - cosine)).exp()
    }
}

pub(super) fn sheen_lobe(n: Vec3, v: Vec3, l: Vec3, roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    let (n_dot_v, n_dot_l) = (n.dot(v).max(1e-3), n.dot(l).max(1e-3));
    let n_dot_h = n.dot((v + l).normalize());
    let sine2 = (1.0 - n_dot_h * n_dot_h).max(1e-6);
    let distribution = (2.0 + 1.0 / alpha) * sine2.powf(0.5 / alpha) / (2.0 * PI);
    let shadowing = 1.0 + fibre_shadowing(n_dot_v, alpha) + fibre_shadowing(n_dot_l, alpha);
    distribution / (4.0 * n_dot_v * n_dot_l * shadowing)
}

fn fresnel(s: &Surface, v: Vec3, l: Vec3) -> Vec3 {
    let m5 = (1.0 - v.dot((v + l).normalize()).clamp(0.0, 1.0)).powi(5);
    let f0 = s.reflectance_at_normal();
    f0 + (s.reflectance_at_grazing() - f0) * m5
}

impl Lobed<'_> {
    fn coat(&self) -> Surface {
        let coat = self.material.clearcoat;
        Surface {
            base_color: Vec3::ZERO,
            metallic: 0.0,
            roughness: coat.map_or(1.0, |c| c.roughness),
            emissive: Vec3::ZERO,
            dielectric: PLAIN_DIELECTRIC,
            ..self.base
        }
    }

    fn film(&self) -> Option<Film> {
        self.material.iridescence.as_ref().map(Film::new)
    }

    fn clearcoat(&self) -> f32 {
        self.material.clearcoat.map_or(0.0, |c| c.factor)
    }

    fn below_coat(&self, v: Vec3) -> f32 {
        1.0 - self.clearcoat() * environment_reflectance(&self.coat(), v).x.clamp(0.0, 1.0)
    }

    fn below_sheen(&self, table: &[f32], cosine: f32) -> f32 {
        self.material.sheen.map_or(1.0, |s| {
            1.0 - s.color.max_element() * sheen_part(table, cosine, s.roughness)
        })
    }

    fn anisotropic_lobe(&self, v: Vec3, l: Vec3) -> f32 {
        let n = self.base.normal;
        let strength = self.material.anisotropy.map_or(0.0, |a| a.strength);
        let across = (self.base.roughness * self.base.roughness).max(0.002);
        let along = across + (1.0 - across) * strength * strength;
        let side = n.cross(self.along);
        let h = (v + l).normalize();
        let f = Vec3::new(
            across * self.along.dot(h),
            along * side.dot(h),
            along * across * n.dot(h),
        );
        let w2 = along * across / f.length_squared();
        let distribution = along * across * w2 * w2 / PI;
        let (n_dot_v, n_dot_l) = (n.dot(v).max(1e-4), n.dot(l));
        let masked = |d: Vec3, cosine: f32| {
            Vec3::new(along * self.along.dot(d), across * side.dot(d), cosine).length()
        };
        distribution * 0.5 / (n_dot_l * masked(v, n_dot_v) + n_dot_v * masked(l, n_dot_l))
    }

    /// Radiance per irradiance.
    pub(super) fn reflected(&self, table: &[f32], v: Vec3, l: Vec3) -> Vec3 {
        let s = &self.base;
        let n_dot_l = s.normal.dot(l);
        let m5 = (1.0 - v.dot((v + l).normalize()).clamp(0.0, 1.0)).powi(5);
        let mut left = s.left_for_scattering(m5);
        let mut mirrored = fresnel(s, v, l);
        if let Some(film) = self.film() {
            let cosine = v.dot((v + l).normalize()).clamp(0.0, 1.0);
            (mirrored, left) = film.mirrored(s, mirrored, cosine);
        }
        let lobe = if self.material.anisotropy.is_some() {
            self.anisotropic_lobe(v, l)
        } else {
            ggx_lobe(s.normal, v, l, n_dot_l, squared_alpha(s))
        };
        let scattered = left * (1.0 - s.metallic) * s.base_color / PI;
        let mut below = scattered + mirrored * lobe;
        if let Some(sheen) = self.material.sheen {
            let n_dot_v = s.normal.dot(v).clamp(0.0, 1.0);
            let left = self
                .below_sheen(table, n_dot_v)
                .min(self.below_sheen(table, n_dot_l));
            below = below * left + sheen.color * sheen_lobe(s.normal, v, l, sheen.roughness);
        }
        let coat = self.coat();
        let lobe = ggx_lobe(coat.normal, v, l, n_dot_l, squared_alpha(&coat));
        below * self.below_coat(v) + self.clearcoat() * fresnel(&coat, v, l) * lobe
    }

    /// Of the gradient's light.
    fn ambient(&self, scene: &Scene, table: &[f32], v: Vec3) -> Vec3 {
        let s = &self.base;
        let mirrored = |s: &Surface, normal: Vec3| {
            let r = 2.0 * normal.dot(v) * normal - v;
            let r = r.lerp(normal, s.roughness * s.roughness).normalize();
            let bent = Surface { normal, ..*s };
            environment_reflectance(&bent, v) * environment(scene, r)
        };
        let mut normal = s.normal;
        if let Some(anisotropy) = self.material.anisotropy {
            let side = s.normal.cross(self.along);
            let bent = side.cross(v).cross(side);
            let kept = 1.0 - anisotropy.strength * (1.0 - s.roughness);
            normal = bent.lerp(s.normal, kept.powi(4)).normalize();
        }
        let around = gradient_around(scene, s.normal);
        let filmed = self.film().map_or(*s, |film| film.under(s, v));
        let mut below = s.base_color * (1.0 - s.metallic) * around + mirrored(&filmed, normal);
        if let Some(sheen) = self.material.sheen {
            let cosine = s.normal.dot(v).clamp(0.0, 1.0);
            let part = sheen_part(table, cosine, sheen.roughness);
            below = below * self.below_sheen(table, cosine) + sheen.color * part * around;
        }
        below * self.below_coat(v) + self.clearcoat() * mirrored(&self.coat(), s.normal)
    }

    pub(super) fn lit(&self, scene: &Scene, lights: &[LightUniform], v: Vec3) -> Vec3 {
        let table = sheen_parts();
        let mut sum = self.base.emissive * self.below_coat(v) + self.ambient(scene, &table, v);
        for light in lights {
            let (l, irradiance) = incident(light, self.base.position);
            let n_dot_l = self.base.normal.dot(l);
            if n_dot_l > 0.0 {
                sum += self.reflected(&table, v, l) * irradiance * n_dot_l;
            }
        }
        sum
    }
}
