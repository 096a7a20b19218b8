//! The CPU twin of deferred shading: `surface.wgsl`, `lighting.wgsl` and `shading.wgsl` in plain
//! Rust.

use foveal_scene::{Camera, Projection, Scene};
use glam::{IVec2, UVec2, Vec2, Vec2Swizzles, Vec3, Vec4};

use super::dielectric::{dielectric_of, glow_of, normal_of, vertex_normal_of};
use crate::lights::LightUniform;
use crate::testing::{radiance, rendered, texels};
use crate::{LightingModel, Settings};

#[derive(Clone, Copy)]
pub(crate) struct Surface {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) vertex_normal: Vec3,
    pub(crate) base_color: Vec3,
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
    pub(crate) occlusion: f32,
    pub(crate) emissive: Vec3,
    /// Reflectance of what is not metal: at right angles, and in w at grazing angles.
    pub(crate) dielectric: Vec4,
}

fn unpack_unorm4(word: u32) -> Vec4 {
    Vec4::from_array(word.to_le_bytes().map(|b| f32::from(b) / 255.0))
}

pub(crate) fn unit_from_octahedral(word: u32) -> Vec3 {
    let snorm = |bits: u32| (f32::from(bits as u16 as i16) / 32767.0).max(-1.0);
    unit_from_square(Vec2::new(snorm(word), snorm(word >> 16)))
}

/// From the octahedral map's square, -1 to 1.
pub(crate) fn unit_from_square(e: Vec2) -> Vec3 {
    let z = 1.0 - e.x.abs() - e.y.abs();
    let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
    let xy = if z >= 0.0 {
        e
    } else {
        (1.0 - e.yx().abs()) * Vec2::new(sign(e.x), sign(e.y))
    };
    xy.extend(z).normalize()
}

pub(crate) fn unpack_shared_exponent(word: u32) -> Vec3 {
    let scale = 2f32.powi((word >> 27) as i32 - 24);
    Vec3::new(
        (word & 511) as f32,
        (word >> 9 & 511) as f32,
        (word >> 18 & 511) as f32,
    ) * scale
}

pub(crate) fn unpack_surface(words: [u32; 4], position: Vec3) -> Surface {
    let color = unpack_unorm4(words[0]);
    let material = unpack_unorm4(words[3]);
    Surface {
        position,
        normal: normal_of(words),
        vertex_normal: vertex_normal_of(words).unwrap_or_else(|| normal_of(words)),
        base_color: color.truncate() * color.truncate(),
        metallic: material.x,
        roughness: material.y,
        occlusion: color.w,
        emissive: glow_of(words),
        dielectric: dielectric_of(words),
    }
}

/// Where the world is at a pixel position with a reversed depth.
pub(crate) fn position_at(camera: &Camera, size: Vec2, pixel: Vec2, depth: f32) -> Vec3 {
    let clip_from_view = camera.clip_from_view(size.x / size.y);
    let ndc = Vec2::new(2.0, -2.0) * pixel / size + Vec2::new(-1.0, 1.0);
    let scale = Vec2::new(clip_from_view.x_axis.x, clip_from_view.y_axis.y);
    let view = match camera.projection {
        Projection::Perspective { near_m, .. } => {
            let distance = near_m / depth;
            (ndc / scale * distance).extend(-distance)
        }
        Projection::Orthographic { near_m, far_m, .. } => {
            (ndc / scale).extend(-(near_m + (1.0 - depth) * (far_m - near_m)))
        }
    };
    camera.world_from_view.transform_point3(view)
}

/// The normal seen at a texel, world space, from reversed depth alone:
/// `shared/normal_of_depth.wgsl`.
pub(crate) fn normal_of_depth(camera: &Camera, size: UVec2, depths: &[f32], at: UVec2) -> Vec3 {
    let depth = |at: UVec2| depths[(at.y * size.x + at.x) as usize];
    let here = depth(at);
    let step = |axis: IVec2| {
        let depth_at = |away: i32| {
            let texel = at.as_ivec2() + away * axis;
            depth(texel.clamp(IVec2::ZERO, size.as_ivec2() - 1).as_uvec2())
        };
        let [before_2, before, after, after_2] = [-2, -1, 1, 2].map(depth_at);
        let bend_before = (before_2 - 2.0 * before + here).abs();
        let bend_after = (after_2 - 2.0 * after + here).abs();
        let along = at.as_ivec2().dot(axis);
        let is_last = along == size.as_ivec2().dot(axis) - 1;
        if along == 0 || (!is_last && bend_after <= bend_before) {
            after - here
        } else {
            here - before
        }
    };
    let steps = Vec2::new(step(IVec2::X), step(IVec2::Y));
    let size = size.as_vec2();
    let clip_from_view = camera.clip_from_view(size.x / size.y);
    let scale = Vec2::new(clip_from_view.x_axis.x, clip_from_view.y_axis.y);
    let pixel = at.as_vec2() + 0.5;
    let place = (Vec2::new(2.0, -2.0) * pixel / size + Vec2::new(-1.0, 1.0)) / scale;
    let slope = steps / (Vec2::new(2.0, -2.0) / size / scale);
    let in_view = match camera.projection {
        Projection::Perspective { .. } => (-slope).extend(here - place.dot(slope)),
        Projection::Orthographic { near_m, far_m, .. } => (-slope * (far_m - near_m)).extend(1.0),
    };
    camera
        .world_from_view
        .transform_vector3(in_view.normalize())
}

pub(crate) fn environment(scene: &Scene, direction: Vec3) -> Vec3 {
    let e = &scene.environment;
    if direction.y >= 0.0 {
        e.horizon.lerp(e.zenith, direction.y.sqrt())
    } else {
        e.horizon.lerp(e.nadir, (-4.0 * direction.y).min(1.0))
    }
}

/// What is left for diffuse reflection, and the specular part.
pub(super) fn reflect(
    model: LightingModel,
    s: &Surface,
    v: Vec3,
    l: Vec3,
    n_dot_l: f32,
) -> [Vec3; 2] {
    use std::f32::consts::PI;
    let h = (v + l).normalize();
    let n_dot_h = s.normal.dot(h);
    let f0 = s.reflectance_at_normal();
    match model {
        LightingModel::Ggx => {
            let v_dot_h = v.dot(h).clamp(0.0, 1.0);
            let m5 = (1.0 - v_dot_h).powi(5);
            let fresnel = f0 + (s.reflectance_at_grazing() - f0) * m5;
            let left = s.left_for_scattering(m5);
            let lobe = ggx_lobe(s.normal, v, l, n_dot_l, squared_alpha(s));
            [Vec3::splat(left), fresnel * lobe]
        }
        LightingModel::BlinnPhong => {
            let alpha = (s.roughness * s.roughness).max(0.03);
            let exponent = 2.0 / (alpha * alpha) - 2.0;
            let highlight = (exponent + 8.0) / (8.0 * PI) * n_dot_h.max(1e-6).powf(exponent);
            [Vec3::ONE, f0 * highlight]
        }
    }
}

/// `squared_alpha` in `shared/environment.wgsl`.
pub(crate) fn squared_alpha(s: &Surface) -> f32 {
    (s.roughness * s.roughness).max(0.002).powi(2)
}

/// `ggx_lobe` in `shared/environment.wgsl`.
pub(crate) fn ggx_lobe(n: Vec3, v: Vec3, l: Vec3, n_dot_l: f32, a2: f32) -> f32 {
    let n_dot_v = n.dot(v).max(1e-4);
    let n_dot_h = n.dot((v + l).normalize()).clamp(0.0, 1.0);
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let distribution = a2 / (std::f32::consts::PI * d * d);
    let visibility = 0.5
        / (n_dot_l * (n_dot_v * n_dot_v * (1.0 - a2) + a2).sqrt()
            + n_dot_v * (n_dot_l * n_dot_l * (1.0 - a2) + a2).sqrt());
    distribution * visibility
}

/// A surface's radiance, and what the lights alone send to it: `Lit` in `shared/lighting.wgsl`.
#[derive(Clone, Copy, Default)]
pub(crate) struct Lit {
    pub(crate) radiance: Vec3,
    pub(crate) diffuse: Vec3,
    pub(crate) specular: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) specular_direction: Vec3,
    pub(crate) variance: f32,
}

/// What of a light's rays arrives: `Arriving` in `shared/light.wgsl`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arriving {
    pub(crate) part: f32,
    pub(crate) variance: f32,
}

pub(crate) const ALL_ARRIVES: Arriving = Arriving {
    part: 1.0,
    variance: 0.0,
};

pub(crate) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// What of a light arrives at a surface: of the light with its number, and the surface.
pub(crate) type Passing<'a> = &'a dyn Fn((usize, &LightUniform), &Surface) -> Arriving;

/// Unit direction to a light, and irradiance on a surface at a position that faces it.
pub(crate) fn incident(light: &LightUniform, position: Vec3) -> (Vec3, Vec3) {
    let radiant = Vec3::from(light.radiant);
    if light.is_directional() {
        (-Vec3::from(light.direction), radiant)
    } else {
        let to_light = Vec3::from(light.position) - position;
        let squared = to_light.length_squared().max(1e-8);
        let direction = to_light / to_light.length_squared().max(1e-20).sqrt();
        let ratio = squared / (light.range * light.range);
        let mut attenuation = (1.0 - ratio * ratio).clamp(0.0, 1.0) / squared;
        if light.kind == 2 {
            let cone =
                -Vec3::from(light.direction).dot(direction) * light.spot_scale + light.spot_offset;
            attenuation *= cone.clamp(0.0, 1.0).powi(2);
        }
        (direction, radiant * attenuation)
    }
}

/// A light's part.
fn from_light(
    model: LightingModel,
    s: &Surface,
    v: Vec3,
    (number, light): (usize, &LightUniform),
    passing: Passing<'_>,
) -> Lit {
    let (direction, irradiance) = incident(light, s.position);
    let n_dot_l = s.normal.dot(direction);
    if n_dot_l <= 0.0 || irradiance.cmple(Vec3::ZERO).all() {
        return Lit::default();
    }
    let arriving = passing((number, light), s);
    let whole = irradiance * n_dot_l;
    let irradiance = irradiance * arriving.part;
    let [diffuse_weight, specular] = reflect(model, s, v, direction, n_dot_l);
    let incident = irradiance * n_dot_l;
    let diffuse = diffuse_weight * (1.0 - s.metallic) * s.base_color / std::f32::consts::PI;
    let unshadowed = luminance((diffuse + specular) * whole);
    Lit {
        radiance: (diffuse + specular) * incident,
        diffuse: diffuse_weight * incident,
        specular: specular * incident,
        direction: direction * luminance(irradiance),
        specular_direction: direction * luminance(specular * incident),
        variance: arriving.variance * unshadowed * unshadowed,
    }
}

/// What all lights send to a surface; the radiance holds what it emits and reflects of its
/// environment too.
pub(crate) fn light_surface(
    scene: &Scene,
    lights: &[LightUniform],
    model: LightingModel,
    s: &Surface,
    v: Vec3,
) -> Lit {
    light_surface_with(scene, lights, model, (s, v), &|_, _| ALL_ARRIVES)
}

/// The same where not all light arrives.
pub(crate) fn light_surface_with(
    scene: &Scene,
    lights: &[LightUniform],
    model: LightingModel,
    (s, v): (&Surface, Vec3),
    passing: Passing<'_>,
) -> Lit {
    let mut sum = Lit {
        radiance: s.emissive + ambient(scene, s, v),
        ..Lit::default()
    };
    for light in lights.iter().enumerate() {
        let part = from_light(model, s, v, light, passing);
        sum.radiance += part.radiance;
        sum.diffuse += part.diffuse;
        sum.specular += part.specular;
        sum.direction += part.direction;
        sum.specular_direction += part.specular_direction;
        sum.variance += part.variance;
    }
    sum
}

/// Unit vector from a position to the camera.
pub(crate) fn to_eye(camera: &Camera, position: Vec3) -> Vec3 {
    match camera.projection {
        Projection::Orthographic { .. } => camera.world_from_view.z_axis.truncate(),
        Projection::Perspective { .. } => (camera.eye() - position).normalize(),
    }
}

/// `environment_reflectance` in `shared/environment.wgsl`.
pub(crate) fn environment_reflectance(s: &Surface, v: Vec3) -> Vec3 {
    let n_dot_v = s.normal.dot(v).clamp(0.0, 1.0);
    let f0 = s.reflectance_at_normal();
    let r =
        s.roughness * Vec4::new(-1.0, -0.0275, -0.572, 0.022) + Vec4::new(1.0, 0.0425, 1.04, -0.04);
    let a004 = (r.x * r.x).min((-9.28 * n_dot_v).exp2()) * r.x + r.y;
    f0 * (-1.04 * a004 + r.z) + (1.04 * a004 + r.w) * s.reflectance_at_grazing()
}

/// What the gradient sends to a normal.
pub(crate) fn gradient_around(scene: &Scene, normal: Vec3) -> Vec3 {
    let e = &scene.environment;
    let around = e.nadir.lerp(e.zenith, 0.5 + 0.5 * normal.y);
    around.lerp(e.horizon, 0.4)
}

pub(crate) fn ambient(scene: &Scene, s: &Surface, v: Vec3) -> Vec3 {
    let mirror = (2.0 * s.normal.dot(v) * s.normal - v).lerp(s.normal, s.roughness * s.roughness);
    let diffuse = s.base_color * (1.0 - s.metallic) * gradient_around(scene, s.normal);
    (diffuse + environment_reflectance(s, v) * environment(scene, mirror.normalize())) * s.occlusion
}

/// Radiance at a G-buffer texel, by every light.
#[expect(
    clippy::too_many_arguments,
    reason = "all that the shader reads, by name"
)]
pub(crate) fn shade(
    scene: &Scene,
    camera: &Camera,
    lights: &[LightUniform],
    model: LightingModel,
    size: Vec2,
    pixel: Vec2,
    words: [u32; 4],
    depth: f32,
) -> Vec3 {
    if depth == 0.0 {
        let near = match camera.projection {
            Projection::Perspective { near_m, .. } | Projection::Orthographic { near_m, .. } => {
                near_m
            }
        };
        return environment(
            scene,
            -to_eye(camera, position_at(camera, size, pixel, near.min(1.0))),
        );
    }
    let s = unpack_surface(words, position_at(camera, size, pixel, depth));
    let v = to_eye(camera, s.position);
    light_surface(scene, lights, model, &s, v).radiance
}

pub(super) const WIDTH: u32 = 65;
pub(super) const HEIGHT: u32 = 43;

/// Asserts that full shading draws what the twin makes of the same G-buffer.
pub(super) fn assert_equals_twin(scene: &Scene, camera: &Camera, settings: &Settings) {
    let renderer = rendered(scene, camera, settings);
    let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let lights = renderer.lights().1;
    let size = Vec2::new(
        settings.picture.width as f32,
        settings.picture.height as f32,
    );
    let mut lit = 0;
    for (i, gpu) in radiance(&renderer).into_iter().enumerate() {
        let pixel = Vec2::new(
            (i as u32 % settings.picture.width) as f32,
            (i as u32 / settings.picture.width) as f32,
        ) + 0.5;
        let cpu = shade(
            scene,
            camera,
            lights,
            settings.lighting.model,
            size,
            pixel,
            words[i],
            depth[i],
        );
        let tolerance = 0.01 * cpu.max_element().max(0.02);
        assert!(
            (gpu - cpu).abs().max_element() <= tolerance,
            "at {pixel}: device {gpu}, twin {cpu}"
        );
        lit += u32::from(depth[i] > 0.0);
    }
    assert!(lit > 200, "the test must see a surface");
}
