//! The CPU twin of procedural materials, held to what both kinds of geometry write.

use foveal_generate as generate;
use foveal_scene::ProceduralLayers;
use glam::{IVec3, UVec3, Vec2, Vec3, Vec4};

use crate::Geometry;
use crate::shading::twin::{position_at, unpack_surface};
use crate::testing::{rendered, small, texels};

fn lattice_hash(cell: UVec3, seed: u32) -> u32 {
    let mixed = cell.x.wrapping_mul(0x8da6_b343)
        ^ cell.y.wrapping_mul(0xd816_3841)
        ^ cell.z.wrapping_mul(0xcb1a_b31f)
        ^ seed.wrapping_mul(0x9e37_79b1);
    let state = mixed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
    word >> 22 ^ word
}

/// Value noise by eight weights, and its gradient by their derivatives: not the shader's nested
/// means.
fn value_noise(p: Vec3, seed: u32) -> (f32, Vec3) {
    let low = p.floor();
    let t = p - low;
    let s = t * t * (3.0 - 2.0 * t);
    let slope = 6.0 * t * (1.0 - t);
    let cell: IVec3 = low.as_ivec3();
    let (mut value, mut gradient) = (0.0, Vec3::ZERO);
    for corner in 0..8 {
        let bit = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        let v = (lattice_hash((cell + bit).as_uvec3(), seed) >> 8) as f32 / 16_777_216.0;
        let upper = bit.cmpeq(IVec3::ONE);
        let weight = Vec3::select(upper, s, 1.0 - s);
        let change = Vec3::select(upper, slope, -slope);
        value += v * weight.element_product();
        gradient += v * Vec3::new(
            change.x * weight.y * weight.z,
            weight.x * change.y * weight.z,
            weight.x * weight.y * change.z,
        );
    }
    (value, gradient)
}

struct Procedural {
    tint: Vec3,
    roughness: f32,
    slope: Vec3,
}

fn procedural_at(position: Vec3, layers: ProceduralLayers, pixel_m: f32) -> Procedural {
    let mut found = Procedural {
        tint: Vec3::ONE,
        roughness: 0.7,
        slope: Vec3::ZERO,
    };
    let mut f = layers.frequency;
    for i in 0..8 {
        let own = lattice_hash(UVec3::splat(i), layers.seed);
        let tone = Vec4::from_array(own.to_le_bytes().map(|b| f32::from(b) / 255.0));
        let (noise, gradient) = value_noise(position * f, own);
        let shown = (2.0 - 4.0 * f * pixel_m).clamp(0.0, 1.0);
        let height = 0.5 + (noise - 0.5) * shown;
        let t = ((height - 0.4) / 0.3).clamp(0.0, 1.0);
        let cover = if i == 0 { 1.0 } else { t * t * (3.0 - 2.0 * t) };
        let tint = (0.4 + 0.6 * tone.truncate()) * (0.4 + 0.6 * height);
        found.tint = found.tint.lerp(tint, cover);
        found.roughness += (0.3 + 0.6 * tone.w - found.roughness) * cover;
        found.slope = found.slope.lerp(gradient * (0.3 * shown), cover);
        f *= 1.7;
    }
    found
}

#[test]
fn procedural_materials_equal_their_twin() {
    let plain = generate::cornell();
    let mut scene = plain.clone();
    for (seed, material) in (0..).zip(&mut scene.materials) {
        material.procedural = Some(ProceduralLayers {
            seed,
            frequency: 0.5,
        });
    }
    let camera = &scene.cameras[0];
    let (width, height) = (61, 47);
    let size = Vec2::new(width as f32, height as f32);
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = small(width, height).with(|s| s.geometry.path = geometry);
        let read = |scene| {
            let renderer = rendered(scene, camera, &settings);
            let g = &renderer.targets().gbuffer;
            let words: Vec<[u32; 4]> = texels(&g.surface_view);
            let identity: Vec<[u32; 2]> = texels(&g.identity_view);
            let depth: Vec<f32> = texels(&g.depth_view);
            (words, identity, depth)
        };
        let (words, identity, depth) = read(&scene);
        let (smooth, ..) = read(&plain);
        let (mut compared, mut off, mut bumped) = (0, 0, 0);
        for i in 0..depth.len() {
            if identity[i][0] == 0 {
                continue;
            }
            let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
            let position = position_at(camera, size, pixel, depth[i]);
            let instance = &scene.instances[identity[i][0] as usize - 1];
            let material = &scene.materials[instance.material as usize];
            let layers = material.procedural.expect("each has them");
            let view = camera.world_from_view.inverse();
            let distance = -view.transform_point3(position).z;
            let y = camera.clip_from_view(size.x / size.y).y_axis.y;
            let twin = procedural_at(position, layers, distance * 2.0 / (y * size.y));
            let found = unpack_surface(words[i], position);
            let normal = unpack_surface(smooth[i], position).normal;
            let slope = twin.slope - twin.slope.dot(normal) * normal;
            let expected = (normal - slope).normalize();
            let color = material.base_color.truncate() * twin.tint;
            let alike = (found.base_color - color).abs().max_element() < 0.02
                && (found.roughness - twin.roughness).abs() < 0.01
                && found.normal.dot(expected) > 0.9995;
            compared += 1;
            off += u32::from(!alike);
            bumped += u32::from(expected.dot(normal) < 0.998);
        }
        assert!(compared > 2000, "{compared} pixels");
        assert!(bumped > compared / 20, "{bumped} of {compared} are raised");
        assert!(off <= compared / 100, "{off} of {compared}, {geometry:?}");
    }
}
