//! Textures in blocks: read as their twins on the CPU, decoded for devices that do not read them,
//! and normal maps of two channels.

use foveal_scene::{
    AlphaMode, Clearcoat, ColorSpace, Encoding, Filter, Material, Sampler, Scene, Texture,
    TextureCompression,
};
use glam::{Vec2, Vec3, Vec4};

use super::ArrayLimits;
use crate::forward::twin::{front, quads};
use crate::shading::twin::{position_at, unpack_surface};
use crate::testing::{gpu, picture, rendered, rounds_alike, slot, small, texels};
use crate::{Frame, Geometry, MaterialDispatch, Renderer, RendererOptions, Settings};

/// A texture of 8 x 8 texels without filtering, in blocks as `read` says.
fn texture(texel: impl Fn(i32, i32) -> [u8; 4]) -> Texture {
    let nearest = Filter::Nearest;
    Texture {
        name: "blocks".to_owned(),
        width: 8,
        height: 8,
        color_space: ColorSpace::Linear,
        sampler: Sampler {
            mag: nearest,
            min: nearest,
            mip: None,
            ..Sampler::default()
        },
        encoding: Encoding::Rgba8,
        levels: vec![(0..64).flat_map(|i| texel(i % 8, i / 8)).collect()],
    }
}

fn normals() -> Texture {
    texture(|x, y| {
        let n = Vec3::new(0.1 * x as f32 - 0.4, 0.3 - 0.08 * y as f32, 1.0).normalize();
        let [x, y, z] = n.to_array().map(|v| (v * 127.5 + 128.0) as u8);
        [x, y, z, 255]
    })
}

/// A quad with textures of all kinds, a cut-out among them.
fn scene() -> Scene {
    let material = Material {
        base_color_texture: slot(0),
        metallic_roughness_texture: slot(1),
        normal_texture: slot(2),
        occlusion_texture: slot(3),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.textures = vec![
        texture(|x, y| [40 + 20 * x as u8, 200 - 9 * y as u8, 90, 35 * y as u8]),
        texture(|x, y| [0, 60 + 20 * y as u8, 9 * x as u8, 255]),
        normals(),
        texture(|x, y| [120 + 9 * (x + y) as u8, 0, 0, 255]),
    ];
    scene.light_by_default();
    scene
}

fn ways(width: u32, height: u32) -> [Settings; 3] {
    let plain = small(width, height);
    let by = |dispatch| {
        plain.clone().with(|s| {
            s.geometry.path = Geometry::Visibility;
            s.geometry.material_dispatch = dispatch;
        })
    };
    [
        plain.clone(),
        by(MaterialDispatch::Family),
        by(MaterialDispatch::Material),
    ]
}

/// The renderer after a frame, on a device that reads blocks or not.
fn drawn(scene: &Scene, settings: &Settings, blocks: bool) -> Renderer {
    let limits = ArrayLimits {
        blocks,
        ..ArrayLimits::of(gpu())
    };
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, RendererOptions::default())
            .await
            .expect("settings fit");
        (renderer.set_scene_within(scene, limits).await).expect("scene fits");
        let camera = scene.cameras.first().cloned().unwrap_or_else(front);
        renderer.render(&Frame::new(&camera)).await.expect("drawn");
        renderer
    })
}

#[test]
fn what_is_read_of_blocks_equals_the_twin() {
    let scene = scene();
    for compression in [TextureCompression::Fine, TextureCompression::Small] {
        let mut scene = scene.clone();
        scene.compress_textures(compression, false);
        assert_equals_twin(&scene);
    }
}

fn assert_equals_twin(scene: &Scene) {
    let [color, rough, normal, open] =
        [0, 1, 2, 3].map(|i: usize| scene.textures[i].decoded_level(0));
    let (width, height) = (64, 64);
    let size = Vec2::new(width as f32, height as f32);
    for (way, settings) in ways(width, height).iter().enumerate() {
        for blocks in [true, false] {
            let renderer = drawn(scene, settings, blocks && gpu().reads_blocks());
            let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
            let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
            let mut compared = 0;
            for i in 0..depth.len() {
                let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
                let at = position_at(&front(), size, pixel, 0.05 / 4.0).truncate();
                let uv = Vec2::new(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) * 8.0;
                if at.abs().max_element() > 0.99 || (uv - uv.round()).abs().min_element() < 0.1 {
                    continue;
                }
                let texel = 4 * (uv.x as usize + 8 * uv.y as usize);
                let alpha = color[texel + 3];
                if alpha.abs_diff(128) < 2 {
                    continue;
                }
                assert_eq!(depth[i] == 0.0, alpha < 128, "{way} {blocks} at {pixel}");
                if depth[i] == 0.0 {
                    continue;
                }
                let of = |texels: &[u8], c| f32::from(texels[texel + c]) / 255.0;
                let surface = unpack_surface(words[i], Vec3::ZERO);
                let [x, y] = [0, 1].map(|c| of(&normal, c) * 2.0 - 1.0);
                let twin = Vec3::new(x, y, (1.0 - x * x - y * y).max(1e-6).sqrt());
                assert!((surface.normal.length() - 1.0).abs() < 1e-3);
                assert!(
                    surface.normal.dot(twin) > 0.9998,
                    "{way} {blocks} at {pixel}: {} not {twin}",
                    surface.normal
                );
                let base = Vec3::new(of(&color, 0), of(&color, 1), of(&color, 2));
                let off = (surface.base_color - base).abs().max_element();
                assert!(off < 0.01, "{way} {blocks}: {off}");
                let off = [
                    surface.roughness - of(&rough, 1),
                    surface.metallic - of(&rough, 2),
                    surface.occlusion - of(&open, 0),
                ];
                // Between a block's two colours hardware may round by a code value more.
                let most = if rounds_alike() { 0.006 } else { 0.01 };
                assert!(
                    off.iter().all(|off| off.abs() < most),
                    "{way} {blocks}: {off:?}"
                );
                compared += 1;
            }
            assert!(compared > 300, "{compared}");
        }
    }
}

#[test]
fn normals_of_two_channels_in_the_plane_keep_a_direction_without_scale() {
    let material = Material {
        normal_texture: slot(0),
        normal_scale: 0.0,
        clearcoat: Some(Clearcoat {
            factor: 1.0,
            texture: None,
            roughness: 0.3,
            roughness_texture: None,
            normal_texture: slot(0),
            normal_scale: 0.0,
        }),
        ..Material::default()
    };
    let mut bent = quads(vec![material], &[0.0]);
    bent.light_by_default();
    let mut flat = bent.clone();
    bent.textures = vec![texture(|_, _| [255, 255, 128, 255])];
    flat.textures = vec![texture(|_, _| [128, 128, 255, 255])];
    bent.compress_textures(TextureCompression::Fine, false);
    assert_eq!(bent.textures[0].encoding, Encoding::Bc5);
    for settings in ways(48, 48) {
        let [bent, flat] = [&bent, &flat].map(|s| picture(&rendered(s, &front(), &settings)));
        let (_, most) = difference(&bent, &flat);
        assert!(most <= 2, "{most}");
        assert!(flat.iter().any(|&c| c > 60 && c < 255));
    }
}

/// Mean and largest difference of two pictures' channels.
fn difference(a: &[u8], b: &[u8]) -> (f64, u8) {
    let off = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let sum: f64 = off.clone().map(f64::from).sum();
    (sum / a.len() as f64, off.max().unwrap_or(0))
}

#[test]
fn a_device_without_blocks_draws_what_is_decoded() {
    let plain = foveal_generate::by_name("alpha").expect("it is generated");
    let mut blocks = plain.clone();
    blocks.compress_textures(TextureCompression::Fine, true);
    for settings in ways(160, 120) {
        let [plain, there, decoded] = [(&plain, true), (&blocks, true), (&blocks, false)]
            .map(|(scene, reads)| drawn(scene, &settings, reads && gpu().reads_blocks()));
        let bytes = [&plain, &there, &decoded].map(|r| r.scene_stats().texture_bytes);
        if gpu().reads_blocks() {
            assert!(bytes[1] * 7 < bytes[0] * 2, "{bytes:?}");
        }
        assert_eq!(bytes[2], bytes[0]);
        let [plain, there, decoded] = [&plain, &there, &decoded].map(picture);
        // Blocks of one channel or two have more than 8 bits.
        let (mean, _) = difference(&there, &decoded);
        assert!(mean < 0.05, "{mean}");
        let (mean, _) = difference(&plain, &there);
        assert!(mean > 0.0 && mean < 1.0, "{mean}");
    }
}

#[test]
fn a_coats_normals_of_two_channels_are_those_of_three() {
    let coated = |normal_texture| {
        let material = Material {
            base_color: Vec4::new(0.3, 0.1, 0.1, 1.0),
            metallic: 0.0,
            clearcoat: Some(Clearcoat {
                factor: 1.0,
                texture: None,
                roughness: 0.3,
                roughness_texture: None,
                normal_texture,
                normal_scale: 1.0,
            }),
            ..Material::default()
        };
        let mut scene = quads(vec![material], &[0.0]);
        scene.textures = vec![texture(|_, _| [178, 100, 243, 255])];
        scene.light_by_default();
        scene
    };
    let three = coated(slot(0));
    let mut two = three.clone();
    two.compress_textures(TextureCompression::Fine, false);
    assert_eq!(two.textures[0].encoding, Encoding::Bc5);
    let [three, two, none] =
        [&three, &two, &coated(None)].map(|s| picture(&rendered(s, &front(), &small(48, 48))));
    let (_, most) = difference(&three, &two);
    assert!(most <= 3, "{most}");
    assert!(difference(&three, &none).1 > 10);
}
