//! The twin of samples' light and of the composite that puts pixels' surfaces into it.

use foveal_scene::{Camera, Projection, Scene};
use glam::{IVec2, UVec2, Vec2, Vec2Swizzles, Vec3};

use crate::gpu::read_level;
use crate::lights::LightUniform;
use crate::shading::sample_texel;
use crate::shading::twin::{
    ALL_ARRIVES, Arriving, Surface, ambient, environment_reflectance, ggx_lobe, incident,
    light_surface_with, luminance, position_at, squared_alpha, to_eye, unit_from_square,
    unpack_shared_exponent, unpack_surface,
};

use crate::shadow::{Lookup, lookup};
use crate::testing::{f32_of_half, gpu, rate_cells, texels};
use crate::{Renderer, Settings, Shadows};

/// The constants of `light.wgsl`, here and in `shading/coarse`.
const LEAST_COSINE: f32 = 0.1;
const SPREAD: f32 = 0.1;
const MOST_OFF_PLANE: f32 = 0.3;
const OFF_PLANE: f32 = 0.6;
const ON_PLANE: f32 = 0.2;
const LEAST_ALIKE: f32 = 0.005;
const LEAST_WEIGHT: f32 = 0.02;
const WITHIN_A_BLOCK: f32 = 0.175;
const DARK: f32 = 0.05;
const TILT: f32 = 0.5;
const WHOLLY_TILTED: f32 = 0.1;
const NORMAL_ROUNDING: f32 = 0.0023;
const VARIANCE_OF_NORMALS: f32 = 0.2;
const LED_FROM: u32 = 2;
const LED_NORMAL: f32 = 0.95;
const LED_OFF_PLANE: f32 = 0.005;
const LED_APART: f32 = 0.05;

/// As in `shading/coarse/light.wgsl`.
const LIGHT_UNIT: f32 = 16.0;

/// What the samples around a pixel make of it.
pub(super) struct Joined {
    /// `None`: it is shaded by itself.
    pub(super) radiance: Option<Vec3>,
    /// Float by float may decide otherwise.
    pub(super) is_close: bool,
    /// Samples speak for it, but may differ.
    pub(super) is_disputed: bool,
    /// They agree; what they stand for differs within their blocks.
    pub(super) is_uneven: bool,
}

/// A sample's light; directions are unit.
pub(super) struct SampleLight {
    pub(super) diffuse: Vec3,
    pub(super) specular: Vec3,
    pub(super) direction: Vec3,
    pub(super) specular_direction: Vec3,
    pub(super) spread: f32,
    pub(super) normal: Vec3,
    pub(super) deviation: f32,
    pub(super) tilted_deviation: f32,
}

/// What a surface makes of light that it scatters.
fn scattered(s: &Surface) -> Vec3 {
    (1.0 - s.metallic) * s.base_color / std::f32::consts::PI
}

pub(super) fn highlight(n: Vec3, v: Vec3, l: Vec3, a2: f32) -> f32 {
    let n_dot_l = n.dot(l).max(LEAST_COSINE);
    n_dot_l * ggx_lobe(n, v, l, n_dot_l, a2.min(1.0))
}

/// `tilted_from` in `shading/coarse/block_light.wgsl`, without those that do not count.
fn tilted_from(normal: Vec3, v: Vec3, level: u32) -> Vec<Vec3> {
    let (x, y) = normal.any_orthonormal_pair();
    let tilted = [x, -x, y, -y].map(|by| (normal + TILT * by).normalize());
    let counts = |n: &Vec3| level > 0 && n.dot(v) > 0.0;
    tilted.into_iter().filter(counts).collect()
}

/// As in `shading/coarse/light.wgsl`.
pub(crate) fn deviation_from_bits(bits: u32) -> f32 {
    0.5 * bits as f32 / (15.5 - bits as f32)
}

pub(super) fn unpack_light(words: [u32; 4]) -> SampleLight {
    let unit = |word: u32, shift: [u32; 2], most: u32| {
        let part = |by: u32| (word >> by & (2 * most + 1)) as f32 / most as f32 - 1.0;
        unit_from_square(Vec2::new(part(shift[0]), part(shift[1])))
    };
    let root = (words[2] >> 20 & 0xf) as f32 / 15.0;
    SampleLight {
        diffuse: LIGHT_UNIT * unpack_shared_exponent(words[0]),
        specular: LIGHT_UNIT * unpack_shared_exponent(words[1]),
        direction: unit(words[2], [0, 10], 511),
        specular_direction: unit(words[3], [0, 10], 511),
        spread: SPREAD * root * root,
        normal: unit(words[3], [20, 26], 31),
        deviation: deviation_from_bits(words[2] >> 28),
        tilted_deviation: deviation_from_bits(words[2] >> 24 & 0xf),
    }
}

/// What both passes read, of one eye.
pub(super) struct Inputs<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    settings: &'a Settings,
    size: UVec2,
    lights: &'a [LightUniform],
    surface: Vec<[u32; 4]>,
    depth: Vec<f32>,
    owner: Vec<u8>,
    /// Per level: radiance and candidate, and light.
    samples: Vec<Vec<[f32; 4]>>,
    pub(super) light: Vec<Vec<[u32; 4]>>,
    /// `None` without shadows.
    lookup: Option<Lookup>,
}

impl<'a> Inputs<'a> {
    pub(super) fn of(renderer: &'a Renderer, scene: &'a Scene, camera: &'a Camera) -> Self {
        let targets = renderer.targets();
        let coarse = targets.coarse.as_ref().unwrap();
        let read = |texture: &wgpu::Texture, mip, size| {
            pollster::block_on(read_level(gpu(), texture, mip, size)).unwrap()
        };
        let (samples, light) = (&coarse.samples, &coarse.light.as_ref().unwrap().samples);
        let settings = renderer.settings();
        Self {
            scene,
            camera,
            settings,
            size: UVec2::new(settings.picture.width, settings.picture.height),
            lights: renderer.lights().1,
            lookup: (settings.lighting.shadows != Shadows::Off).then(|| lookup(renderer)),
            surface: texels(&targets.gbuffer.surface_view),
            depth: texels(&targets.gbuffer.depth_view),
            owner: rate_cells(&coarse.rate.owner, 1),
            samples: (samples.range())
                .map(|level| {
                    let bytes = read(&samples.texture, level, samples.blocks(level));
                    let halves: Vec<[u16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
                    halves.iter().map(|texel| texel.map(f32_of_half)).collect()
                })
                .collect(),
            light: (light.range())
                .map(|level| {
                    bytemuck::pod_collect_to_vec(&read(&light.texture, level, light.blocks(level)))
                })
                .collect(),
        }
    }

    fn at(&self, texel: UVec2) -> usize {
        (texel.y * self.size.x + texel.x) as usize
    }

    pub(super) fn level(&self, texel: UVec2) -> u32 {
        let across = self.size.x.div_ceil(2);
        u32::from(self.owner[(texel.y / 2 * across + texel.x / 2) as usize] & 15)
    }

    pub(super) fn depth(&self, texel: UVec2) -> f32 {
        self.depth[self.at(texel)]
    }

    pub(super) fn surface(&self, texel: UVec2) -> Surface {
        let depth = self.depth(texel).max(1e-20);
        let pixel = texel.as_vec2() + 0.5;
        let position = position_at(self.camera, self.size.as_vec2(), pixel, depth);
        unpack_surface(self.surface[self.at(texel)], position)
    }

    fn distance(&self, depth: f32) -> f32 {
        match self.camera.projection {
            Projection::Perspective { near_m, .. } => near_m / depth,
            Projection::Orthographic { near_m, far_m, .. } => {
                near_m + (1.0 - depth) * (far_m - near_m)
            }
        }
    }

    /// `pixel_width_at` in `shared/frame.wgsl`.
    fn pixel_width(&self, distance: f32) -> f32 {
        let clip_from_view = (self.camera).clip_from_view(self.size.x as f32 / self.size.y as f32);
        let in_metres = match self.camera.projection {
            Projection::Perspective { .. } => distance,
            Projection::Orthographic { .. } => 1.0,
        };
        2.0 / clip_from_view.x_axis.x / self.size.x as f32 * in_metres
    }

    pub(super) fn sample(&self, block: UVec2, level: u32, candidate: u32) -> UVec2 {
        sample_texel(block.into(), level, candidate, self.size.into()).into()
    }

    pub(super) fn index(&self, block: UVec2, level: u32) -> usize {
        (block.y * self.size.x.div_ceil(1 << level) + block.x) as usize
    }

    /// The candidate that a block was sampled at.
    fn candidate(&self, block: UVec2, level: u32) -> u32 {
        (self.samples[level as usize][self.index(block, level)][3] + 0.5) as u32 - 1
    }

    /// `four_of` in `shading/coarse/block_light.wgsl`, without those that do not count: from the sample,
    /// and normals.
    fn rim(&self, (block, level): (UVec2, u32), n: u32, s: &Surface) -> [Vec<Vec3>; 2] {
        let place = |quarters: UVec2| {
            let within = (quarters * ((1 << level) - 1) + 2) / 4;
            let texel = ((block << level) + within).min(self.size - 1);
            let seen = self.surface(texel);
            let offset = seen.position - s.position;
            let off = s.vertex_normal.dot(offset).abs() / offset.length().max(1e-30);
            (self.depth(texel) > 0.0 && off <= MOST_OFF_PLANE).then_some((offset, seen.normal))
        };
        let places = [[n, 0], [4, n], [4 - n, 4], [0, 4 - n]].map(UVec2::from);
        let places = places.into_iter().filter(|_| level > 0);
        places.filter_map(place).unzip().into()
    }

    /// What of a light arrives at a sample, and at its block's rim.
    fn arriving(&self, number: usize, light: &LightUniform, s: &Surface, rim: &[Vec3]) -> Arriving {
        self.lookup.as_ref().map_or(ALL_ARRIVES, |lookup| {
            lookup.light_arriving(number, light, (s.position, s.vertex_normal), rim)
        })
    }

    /// Luminance that a surface with another normal would show of the lights that arrive at a sample.
    fn shown_on(&self, normal: Vec3, s: &Surface, v: Vec3) -> f32 {
        let lights = self.lights.iter().enumerate();
        let shown = lights.map(|(number, light)| {
            let (l, irradiance) = incident(light, s.position);
            let n_dot_l = normal.dot(l);
            if n_dot_l <= 0.0 || irradiance.cmple(Vec3::ZERO).all() {
                return 0.0;
            }
            let m5 = (1.0 - v.dot((v + l).normalize()).clamp(0.0, 1.0)).powi(5);
            let f0 = s.reflectance_at_normal();
            let fresnel = f0 + (s.reflectance_at_grazing() - f0) * m5;
            let lobe = ggx_lobe(normal, v, l, n_dot_l, squared_alpha(s));
            let each =
                s.left_for_scattering(m5) * luminance(scattered(s)) + luminance(fresnel) * lobe;
            let part = self.arriving(number, light, s, &[]).part;
            luminance(irradiance) * n_dot_l * each * part
        });
        shown.sum()
    }

    /// `light_block` in `shading/coarse/block_light.wgsl`, and the deviation by shadows alone.
    pub(super) fn light(&self, block: UVec2, level: u32) -> (SampleLight, f32) {
        let texel = self.sample(block, level, self.candidate(block, level));
        let mut s = self.surface(texel);
        let mut a2 = squared_alpha(&s);
        if level > 0 {
            let distance = self.distance(self.depth(texel));
            let (mut normal, mut count) = (s.normal, 1.0);
            for candidate in 1..5 {
                let at = self.sample(block, level, candidate);
                let other = self.surface(at);
                let away = (self.distance(self.depth(at).max(1e-20)) - distance).abs();
                if away < 0.1 * distance && other.normal.dot(s.normal) > 0.3 {
                    normal += other.normal;
                    a2 += squared_alpha(&other);
                    count += 1.0;
                }
            }
            a2 /= count;
            s.normal = normal.normalize();
            s.roughness = (a2 + 1.0 - normal.length() / count).min(1.0).powf(0.25);
        }
        let v = to_eye(self.camera, s.position);
        let model = self.settings.lighting.model;
        let [mut rim, normals] = self.rim((block, level), 1, &s);
        let [second, _] = self.rim((block, level), 3, &s);
        rim.extend(second);
        let lit = light_surface_with(self.scene, self.lights, model, (&s, v), &|(n, l), s| {
            self.arriving(n, l, s, &rim)
        });
        let direction = lit.direction.try_normalize().unwrap_or(s.normal);
        let specular_direction = lit.specular_direction.try_normalize().unwrap_or(s.normal);
        let together = lit.specular_direction.length() / luminance(lit.specular).max(1e-30);
        let root = ((1.0 - together.min(1.0)).sqrt() * 15.0).round() / 15.0;
        let spread = SPREAD * root * root;
        let lobe = highlight(s.normal, v, specular_direction, squared_alpha(&s) + spread);
        let scattered = scattered(&s) * lit.diffuse;
        let told_on = |n: Vec3| {
            let mirror = highlight(n, v, specular_direction, squared_alpha(&s) + spread);
            let cosines = [n, s.normal].map(|n| n.dot(direction).max(LEAST_COSINE));
            luminance(scattered) * cosines[0] / cosines[1]
                + luminance(lit.specular) / lobe.max(1e-6) * mirror
        };
        let most_apart = |normals: &[Vec3]| {
            let apart = |&n: &Vec3| (self.shown_on(n, &s, v) - told_on(n)).abs();
            normals.iter().map(apart).fold(0.0, f32::max)
        };
        let [at_rim, tilted] = [&normals, &tilted_from(s.normal, v, level)]
            .map(|normals| VARIANCE_OF_NORMALS * most_apart(normals).powi(2));
        let whole = luminance(scattered + lit.specular) + self.dark();
        s.roughness = a2.powf(0.25);
        let reflectance = environment_reflectance(&s, v).max(Vec3::splat(1e-3));
        let light = SampleLight {
            diffuse: lit.diffuse / s.normal.dot(direction).max(LEAST_COSINE),
            specular: lit.specular / (reflectance * lobe.max(1e-6)),
            direction,
            specular_direction,
            spread,
            normal: s.normal,
            deviation: (lit.variance + at_rim).sqrt() / whole,
            tilted_deviation: tilted.sqrt() / whole,
        };
        (light, lit.variance.sqrt() / whole)
    }

    fn dark(&self) -> f32 {
        DARK / self.settings.picture.exposure_stops.exp2()
    }

    fn slope(&self, texel: UVec2, axis: UVec2) -> f32 {
        let depth = self.depth(texel);
        let last = self.size - 1;
        let before = texel.saturating_sub(axis);
        let after = (texel + axis).min(last);
        let backwards = depth - self.depth(before);
        let forwards = self.depth(after) - depth;
        if before == texel || (after != texel && forwards.abs() < backwards.abs()) {
            forwards
        } else {
            backwards
        }
    }

    fn slopes(&self, texel: UVec2) -> Vec2 {
        Vec2::new(self.slope(texel, UVec2::X), self.slope(texel, UVec2::Y))
    }

    /// `light.wgsl`.
    pub(super) fn pixel(&self, texel: UVec2) -> Joined {
        let level = self.level(texel);
        let s = self.surface(texel);
        let v = to_eye(self.camera, s.position);
        let depth = self.depth(texel);
        let slope = self.slopes(texel);
        let side = (1u32 << level) as f32;
        let place = (texel.as_vec2() - (0.5 * side).floor()) / side;
        let along = place - place.floor();
        let last = ((self.size - 1) >> level).as_ivec2();
        let (mut diffuse, mut specular, mut sum) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        let (mut squares, mut between) = (0.0, 0.0);
        let dark = self.dark();
        let scattered = scattered(&s);
        let mirrored = environment_reflectance(&s, v);
        for step in [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE] {
            let block = (place.floor().as_ivec2() + step).clamp(IVec2::ZERO, last);
            let point = self.sample(block.as_uvec2(), level, 0);
            let tile_level = self.level(point);
            let tile = point >> tile_level;
            let light = unpack_light(self.light[tile_level as usize][self.index(tile, tile_level)]);
            let at = self.sample(tile, tile_level, self.candidate(tile, tile_level));
            let sample_depth = self.depth(at);
            if sample_depth == 0.0 {
                continue;
            }
            let offset = at.as_vec2() - texel.as_vec2();
            let there = self.distance(sample_depth);
            let pixel_side = self.pixel_width(there);
            let expected = (depth + slope.dot(offset)).max(1e-20);
            let apart = (there - self.distance(expected)).abs();
            let steep = apart / (offset.length() * pixel_side + 1e-6 * there);
            let t = ((steep - ON_PLANE) / (OFF_PLANE - ON_PLANE)).clamp(0.0, 1.0);
            let same_plane = 1.0 - t * t * (3.0 - 2.0 * t);
            let cosine = s.normal.dot(light.normal).clamp(0.0, 1.0);
            let alike = cosine.powi(4);
            let near = Vec2::select(step.as_vec2().cmpgt(Vec2::ZERO), along, 1.0 - along);
            let alike = LEAST_ALIKE + (1.0 - LEAST_ALIKE) * alike;
            let weight = near.x * near.y * same_plane * alike;
            let here = light.diffuse * s.normal.dot(light.direction).max(LEAST_COSINE);
            let a2 = squared_alpha(&s) + light.spread;
            let mirror = light.specular * highlight(s.normal, v, light.specular_direction, a2);
            let shown = luminance(scattered * here + mirrored * mirror);
            diffuse += weight * here;
            specular += weight * mirror;
            let turned = (1.0 - cosine - NORMAL_ROUNDING) / (WHOLLY_TILTED - NORMAL_ROUNDING);
            let turned = turned.clamp(0.0, 1.0);
            let uneven = light.deviation.powi(2) + (light.tilted_deviation * turned).powi(2);
            between += weight * shown * shown;
            squares += weight * (shown * shown + WITHIN_A_BLOCK * uneven * (shown + dark).powi(2));
            sum += weight;
        }
        let other = s.emissive + ambient(self.scene, &s, v);
        let lamps = (scattered * diffuse + mirrored * specular) / sum;
        let mean = luminance(lamps);
        let lit = mean + luminance(other) + dark;
        let most_apart = self.settings.most_disagreement();
        let apart_by = |squares: f32| (squares / sum - mean * mean).max(0.0).sqrt() / lit;
        let apart = apart_by(squares);
        Joined {
            radiance: (sum >= LEAST_WEIGHT && apart <= most_apart).then_some(other + lamps),
            is_close: (sum - LEAST_WEIGHT).abs() < 1e-3 || (apart - most_apart).abs() < 0.005,
            is_disputed: sum >= LEAST_WEIGHT,
            is_uneven: sum >= LEAST_WEIGHT && apart_by(between) < most_apart - 0.005,
        }
    }

    /// The pixel whose light one that no sample speaks for takes, `composite/led.wgsl`: `None` where it
    /// is shaded by itself. The flag: float by float may decide otherwise.
    pub(super) fn leader(&self, texel: UVec2) -> (Option<UVec2>, bool) {
        let group = texel / 2;
        let leader = 2 * group + group.yx() % 2;
        let outside = leader.cmpge(self.size).any();
        if self.level(texel) < LED_FROM || outside || leader == texel || self.depth(leader) == 0.0 {
            return (None, false);
        }
        let depth = self.depth(texel);
        let expected = depth + self.slopes(texel).dot(leader.as_vec2() - texel.as_vec2());
        let [here, away, expected] =
            [depth, self.depth(leader), expected.max(1e-20)].map(|depth| self.distance(depth));
        let [off_plane, apart] = [expected, here].map(|from| (away - from).abs() / here);
        let normal = self.surface(texel).normal;
        let cosine = normal.dot(self.surface(leader).normal);
        let is_led = cosine >= LED_NORMAL && off_plane <= LED_OFF_PLANE && apart <= LED_APART;
        let is_close = (cosine - LED_NORMAL).abs() < 1e-3
            || (off_plane - LED_OFF_PLANE).abs() < 1e-4
            || (apart - LED_APART).abs() < 1e-3;
        (is_led.then_some(leader), is_close)
    }

    /// What a pixel shows of its leader's light: `composite/follow.wgsl`.
    pub(super) fn led(&self, texel: UVec2, leader: UVec2) -> Vec3 {
        let light = unpack_light(self.light[0][self.index(leader, 0)]);
        let s = self.surface(texel);
        let v = to_eye(self.camera, s.position);
        let diffuse = light.diffuse * s.normal.dot(light.direction).max(LEAST_COSINE);
        let a2 = squared_alpha(&s) + light.spread;
        let mirror = light.specular * highlight(s.normal, v, light.specular_direction, a2);
        let lamps = scattered(&s) * diffuse + environment_reflectance(&s, v) * mirror;
        s.emissive + ambient(self.scene, &s, v) + lamps
    }
}
