//! A reference that traces rays on the CPU: direct light with shadows, and light of an environment,
//! by the same reflection model as the renderer's, without tables, maps or levels. Materials have
//! no textures, and nothing is seen behind surfaces.

mod around;
mod bvh;

use std::f32::consts::{PI, TAU};

pub(crate) use around::Around;
use bvh::Bvh;
use foveal_scene::{Camera, Light, LightKind, Material, Scene};
use glam::Vec3;

/// Samples of a pixel's environment light: by GGX, by the cosine, by the environment.
const SAMPLES: [u32; 3] = [256, 64, 512];

/// Samples of a lamp.
const LAMP_SAMPLES: u32 = 64;

/// What is traced.
pub(crate) struct Reference<'a> {
    scene: &'a Scene,
    bvh: Bvh,
    pub(crate) around: Option<&'a Around>,
    /// Whether surfaces keep light of the environment away from others.
    pub(crate) occludes: bool,
    /// Radius of point and spot lamps in metres, and tangent of half the angle that directional
    /// lights fill.
    pub(crate) lamps: [f32; 2],
}

/// A surface in view.
struct Surface {
    position: Vec3,
    normal: Vec3,
    face: Vec3,
    base_color: Vec3,
    metallic: f32,
    /// Reflectance of what is not metal: at right angles, at grazing angles.
    dielectric: (Vec3, f32),
    a2: f32,
}

/// Numbers between 0 and 1 (O'Neill 2014, PCG).
struct Chance(u32);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        ((word >> 22) ^ word) as f32 / 4_294_967_296.0
    }
}

impl<'a> Reference<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            bvh: Bvh::new(scene),
            around: None,
            occludes: false,
            lamps: [0.0; 2],
        }
    }

    /// Radiance of each pixel, row by row.
    pub(crate) fn picture(&self, camera: &Camera, width: u32, height: u32) -> Vec<Vec3> {
        use std::thread::{available_parallelism, scope};
        let mut pixels = vec![Vec3::ZERO; (width * height) as usize];
        let threads = available_parallelism().map_or(1, usize::from);
        let rows = (height as usize).div_ceil(threads);
        scope(|scope| {
            for (part, pixels) in pixels.chunks_mut(rows * width as usize).enumerate() {
                scope.spawn(move || {
                    for (i, pixel) in (0..).zip(pixels) {
                        let (x, y) = (i % width, i / width + (part * rows) as u32);
                        *pixel = self.pixel(camera, (x, y), (width, height));
                    }
                });
            }
        });
        pixels
    }

    fn pixel(&self, camera: &Camera, (x, y): (u32, u32), (width, height): (u32, u32)) -> Vec3 {
        let clip = camera.clip_from_view(width as f32 / height as f32);
        let across = (2.0 * (x as f32 + 0.5) / width as f32 - 1.0) / clip.x_axis.x;
        let up = (1.0 - 2.0 * (y as f32 + 0.5) / height as f32) / clip.y_axis.y;
        let in_view = Vec3::new(across, up, -1.0).normalize();
        let along = camera.world_from_view.transform_vector3(in_view);
        let ray = (camera.eye(), along);
        let Some(hit) = self.bvh.first_hit(ray, f32::INFINITY, |_| true) else {
            return Vec3::ZERO;
        };
        let (normal, face) = self.bvh.normals(&hit, along);
        let instance = self.bvh.triangles[hit.triangle].instance;
        let instance = &self.scene.instances[instance as usize];
        let material = &self.scene.materials[instance.material as usize];
        let position = camera.eye() + along * hit.distance;
        let s = Surface::new(material, position, normal, face);
        let mut chance = Chance(y * width + x);
        let lights = self.scene.lights.iter();
        let direct: Vec3 = lights.map(|light| self.lit_by(light, &s, -along)).sum();
        material.emissive + direct + self.lit_around(&s, -along, &mut chance)
    }

    /// Whether nothing keeps light from a surface; `light`: its place and range, where it has one,
    /// as its own lamp does not keep it.
    fn is_free(&self, s: &Surface, along: Vec3, end: f32, light: Option<(Vec3, f32)>) -> bool {
        let from = s.position + s.face * 1e-3;
        let casts = |instance: u32| {
            let instance = &self.scene.instances[instance as usize];
            let b = &instance.bounds;
            let glows = self.scene.materials[instance.material as usize].emissive != Vec3::ZERO;
            !light.is_some_and(|(at, range)| {
                let holds = at.cmpge(b.min).all() && at.cmple(b.max).all();
                glows && holds && b.size().length() <= 0.5 * range
            })
        };
        self.bvh.first_hit((from, along), end, casts).is_none()
    }

    /// Part of a lamp, a disc that faces the surface, that nothing keeps from it.
    fn passing(&self, s: &Surface, l: Vec3, end: f32, lamp: Option<(Vec3, f32)>) -> f32 {
        let tangent = match lamp {
            Some(_) => self.lamps[0] / end,
            None => self.lamps[1],
        };
        if tangent == 0.0 {
            return f32::from(u8::from(self.is_free(s, l, end, lamp)));
        }
        let (x, y) = l.any_orthonormal_pair();
        let free = (0..LAMP_SAMPLES).filter(|&i| {
            // Vogel 1979.
            let radius = ((i as f32 + 0.5) / LAMP_SAMPLES as f32).sqrt() * tangent;
            let (sine, cosine) = (2.399_963_2 * i as f32).sin_cos();
            let along = (l + radius * (x * cosine + y * sine)).normalize();
            s.normal.dot(along) > 0.0 && self.is_free(s, along, end, lamp)
        });
        free.count() as f32 / LAMP_SAMPLES as f32
    }

    fn lit_by(&self, light: &Light, s: &Surface, v: Vec3) -> Vec3 {
        let radiant = light.color * light.intensity;
        let (l, irradiance, end, lamp) = match light.kind {
            LightKind::Directional => (-light.direction, radiant, f32::INFINITY, None),
            LightKind::Point | LightKind::Spot { .. } => {
                let to_light = light.position - s.position;
                let distance = to_light.length();
                let range = light.range_m.unwrap_or(f32::INFINITY);
                let ratio = (distance / range).powi(4);
                let mut attenuation = (1.0 - ratio).clamp(0.0, 1.0) / distance.powi(2);
                if let LightKind::Spot {
                    inner_rad,
                    outer_rad,
                } = light.kind
                {
                    let cosine = -light.direction.dot(to_light / distance);
                    let scale = 1.0 / (inner_rad.cos() - outer_rad.cos()).max(1e-3);
                    let cone = ((cosine - outer_rad.cos()) * scale).clamp(0.0, 1.0);
                    attenuation *= cone * cone;
                }
                let lamp = Some((light.position, range));
                (to_light / distance, radiant * attenuation, distance, lamp)
            }
        };
        let n_dot_l = s.normal.dot(l);
        if n_dot_l <= 0.0 || irradiance.max_element() <= 0.0 {
            return Vec3::ZERO;
        }
        let passing = self.passing(s, l, end, lamp);
        s.reflected(v, l) * irradiance * (n_dot_l * passing)
    }

    /// Samples of three kinds, weighted by the balance heuristic (Veach and Guibas 1995).
    fn lit_around(&self, s: &Surface, v: Vec3, chance: &mut Chance) -> Vec3 {
        let Some(around) = self.around else {
            return Vec3::ZERO;
        };
        let mut sum = Vec3::ZERO;
        for (kind, count) in SAMPLES.into_iter().enumerate() {
            for i in 0..count {
                let stratum = (i as f32 + chance.next()) / count as f32;
                let at = [stratum, chance.next(), chance.next()];
                let l = match kind {
                    0 => s.mirrored(v, at),
                    1 => s.scattered(at),
                    _ => around.sample(at),
                };
                let n_dot_l = s.normal.dot(l);
                if n_dot_l <= 0.0 || self.occludes && !self.is_free(s, l, f32::INFINITY, None) {
                    continue;
                }
                let h = (v + l).normalize();
                let by_ggx = s.distribution(h) * s.normal.dot(h) / (4.0 * v.dot(h)).max(1e-6);
                let densities = [by_ggx, n_dot_l / PI, around.density(l)];
                let weights = SAMPLES.iter().zip(densities).map(|(&n, d)| n as f32 * d);
                let weight: f32 = weights.sum();
                sum += s.reflected(v, l) * around.radiance(l) * n_dot_l / weight;
            }
        }
        sum
    }
}

/// KHR_materials_ior and KHR_materials_specular.
fn dielectric(material: &Material) -> (Vec3, f32) {
    let color = material.specular_color * ((material.ior - 1.0) / (material.ior + 1.0)).powi(2);
    let strength = material.specular;
    (color.min(Vec3::ONE) * strength, strength)
}

impl Surface {
    fn new(material: &Material, position: Vec3, normal: Vec3, face: Vec3) -> Self {
        Self {
            position,
            normal,
            face,
            base_color: material.base_color.truncate(),
            metallic: material.metallic,
            dielectric: dielectric(material),
            a2: (material.roughness * material.roughness).max(0.002).powi(2),
        }
    }

    /// GGX.
    fn distribution(&self, h: Vec3) -> f32 {
        let n_dot_h = self.normal.dot(h).max(0.0);
        let d = n_dot_h * n_dot_h * (self.a2 - 1.0) + 1.0;
        self.a2 / (PI * d * d)
    }

    /// Radiance per irradiance: glTF 2.0 appendix B with the height-correlated visibility.
    fn reflected(&self, v: Vec3, l: Vec3) -> Vec3 {
        let h = (v + l).normalize();
        let n_dot_l = self.normal.dot(l);
        let n_dot_v = self.normal.dot(v).max(1e-4);
        let m5 = (1.0 - v.dot(h).clamp(0.0, 1.0)).powi(5);
        let (at_right_angles, at_grazing) = self.dielectric;
        let dielectric = at_right_angles + (at_grazing - at_right_angles) * m5;
        let metal = self.base_color + (1.0 - self.base_color) * m5;
        let fresnel = dielectric.lerp(metal, self.metallic);
        let masked = |a: f32, b: f32| a * (b * b * (1.0 - self.a2) + self.a2).sqrt();
        let visibility = 0.5 / (masked(n_dot_l, n_dot_v) + masked(n_dot_v, n_dot_l));
        // The dielectric's own part; nothing is scattered in the complementary colour of what it
        // mirrors.
        let left = 1.0 - dielectric.max_element();
        let diffuse = left * (1.0 - self.metallic) * self.base_color / PI;
        diffuse + fresnel * self.distribution(h) * visibility
    }

    fn around_normal(&self, cos: f32, phi: f32) -> Vec3 {
        let (x, y) = self.normal.any_orthonormal_pair();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        (x * phi.cos() + y * phi.sin()) * sin + self.normal * cos
    }

    /// As GGX's distribution has it.
    fn mirrored(&self, v: Vec3, at: [f32; 3]) -> Vec3 {
        let cos2 = (1.0 - at[0]) / (1.0 + (self.a2 - 1.0) * at[0]);
        let h = self.around_normal(cos2.sqrt(), TAU * at[1]);
        2.0 * v.dot(h) * h - v
    }

    /// By the cosine.
    fn scattered(&self, at: [f32; 3]) -> Vec3 {
        self.around_normal(at[0].sqrt(), TAU * at[1])
    }
}
