//! Families of materials against materials one by one, and the dispatches' counts against the
//! pixels that are seen.

use foveal_scene::{
    AlphaMode, ColorSpace, Filter, Material, ProceduralLayers, Sampler, Scene, Texture, TextureRef,
    Wrap,
};

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};

use crate::forward::twin::{front, quads};
use crate::gpu::read_buffer;
use crate::scene::{ArrayLimits, FamilyUniform, MaterialDispatch};
use crate::testing::{gpu, picture, small, texels};
use crate::{
    Antialiasing, Frame, Geometry, RateSource, RateStage, Renderer, SamplePattern, Settings,
    Shading, Stereo,
};

/// Numbers that follow from `seed` alone.
struct Numbers(u32);

impl Numbers {
    fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = (self.0 >> ((self.0 >> 28) + 4) ^ self.0).wrapping_mul(277_803_737);
        (word >> 22 ^ word) % end
    }

    fn unit(&mut self) -> f32 {
        self.below(1001) as f32 / 1000.0
    }
}

/// Each size has a sampler of its own: shaders are compiled again for each that they meet.
fn texture(n: &mut Numbers, number: u32) -> Texture {
    let (width, height, filter, mip) = [
        (16, 16, Filter::Linear, true),
        (3, 5, Filter::Linear, false),
        (33, 20, Filter::Nearest, true),
    ][number as usize % 3];
    let count = if mip { u32::ilog2(width) } else { 0 };
    let levels = (0..=count).map(|level| {
        let texels = (width >> level).max(1) * (height >> level).max(1);
        (0..texels * 4).map(|_| n.below(256) as u8).collect()
    });
    let levels = levels.collect();
    Texture {
        name: format!("{width} x {height}"),
        width,
        height,
        color_space: [ColorSpace::Linear, ColorSpace::Srgb][usize::from(number > 8)],
        sampler: Sampler {
            wrap_u: if mip { Wrap::Repeat } else { Wrap::ClampToEdge },
            mag: filter,
            min: filter,
            mip: mip.then_some(filter),
            ..Sampler::default()
        },
        encoding: foveal_scene::Encoding::Rgba8,
        levels,
    }
}

/// Which slots have a texture, and how it is read: as it is, all by one map, each by its own.
const KINDS: [([u32; 5], u32); 6] = [
    ([0, 0, 0, 0, 0], 0),
    ([1, 0, 0, 0, 0], 0),
    ([1, 0, 0, 0, 0], 0),
    ([1, 1, 1, 0, 0], 1),
    ([1, 0, 1, 1, 1], 2),
    ([0, 0, 0, 0, 1], 0),
];

fn material(n: &mut Numbers, number: u32, textures: u32) -> Material {
    let (has, how) = KINDS[number as usize % KINDS.len()];
    let shared = Mat3::from_scale(Vec2::new(2.0, 5.0 * n.unit()));
    let mut slot = |has: u32| {
        let own = Mat3::from_scale_angle_translation(Vec2::splat(3.0), n.unit(), Vec2::splat(0.1));
        (has > 0).then_some(TextureRef {
            texture: (n.below(textures / 3) * 3 + number / 12) % textures,
            uv_set: if how == 2 { n.below(2) } else { 0 },
            uv_transform: [Mat3::IDENTITY, shared, own][how as usize],
        })
    };
    let [a, b, c, d, e] = has.map(&mut slot);
    Material {
        base_color: Vec4::new(n.unit(), n.unit(), n.unit(), 1.0),
        roughness: n.unit(),
        metallic: n.unit(),
        emissive: Vec3::splat(n.unit() * 0.3),
        base_color_texture: a,
        metallic_roughness_texture: b,
        normal_texture: c,
        occlusion_texture: d,
        emissive_texture: e,
        alpha_mode: match number % 18 {
            1 => AlphaMode::Mask { cutoff: 0.4 },
            7 => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        unlit: number % 6 == 5,
        procedural: number.is_multiple_of(6).then_some(ProceduralLayers {
            seed: n.below(100),
            frequency: 2.0,
        }),
        ..Material::default()
    }
}

/// 36 tilted quads, each with a material of its own, out of 15 textures.
fn patchwork() -> Scene {
    let mut n = Numbers(7);
    let textures: Vec<_> = (0..15).map(|i| texture(&mut n, i)).collect();
    let materials: Vec<_> = (0..36).map(|i| material(&mut n, i, 15)).collect();
    let mut scene = quads(materials, &[0.0; 36]);
    // Both UV sets, and no coordinate of the second: as where a mesh has but one.
    for vertex in &mut scene.meshes[0].vertices {
        vertex.uv[1] = [0.0; 2];
    }
    for (i, instance) in (0..).zip(&mut scene.instances) {
        let at = Vec3::new((i % 9) as f32 - 4.0, (i / 9) as f32 - 1.5, 0.0) * 0.4;
        instance.world_from_object = Mat4::from_translation(at)
            * Mat4::from_rotation_y(0.4)
            * Mat4::from_scale(Vec3::splat(0.24));
        instance.bounds = scene.meshes[0]
            .bounds
            .transformed(instance.world_from_object);
    }
    for (object, instance) in scene.objects.iter_mut().zip(&scene.instances) {
        object.bounds = instance.bounds;
    }
    scene.textures = textures;
    scene.light_by_default();
    scene
}

fn limits(layers: u32, bytes: u64) -> ArrayLimits {
    ArrayLimits {
        layers,
        bytes,
        blocks: true,
    }
}

/// Two frames of the scene, its arrays of textures within `limits`.
fn drawn(scene: &Scene, settings: &Settings, limits: ArrayLimits) -> Renderer {
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu(), settings, crate::RendererOptions::default())
            .await
            .unwrap();
        renderer.set_scene_within(scene, limits).await.unwrap();
        let camera = front();
        for previous_camera in [None, Some(&camera)] {
            let frame = Frame::new(&camera).with_previous(previous_camera);
            renderer.render(&frame).await.unwrap();
        }
        renderer
    })
}

fn by(dispatch: crate::MaterialDispatch, settings: &Settings) -> Settings {
    settings.clone().with(|s| {
        s.geometry.path = Geometry::Visibility;
        s.geometry.material_dispatch = dispatch;
    })
}

#[test]
fn a_picture_by_families_is_the_one_by_materials_to_the_byte() {
    let scene = patchwork();
    let plain = small(157, 101);
    let rated = |shading, rate| {
        plain.clone().with(|s| {
            s.shading.mode = shading;
            s.coarse.source = rate;
            s.rate.stage = RateStage::Both;
            // That of light needs materials at every pixel.
            s.coarse.composite = crate::Composite::Smooth;
            s.rate.force = true;
        })
    };
    let smoothed = plain.clone().with(|s| {
        s.antialiasing.mode = Antialiasing::Msaa;
        s.antialiasing.pattern = SamplePattern::Grid;
    });
    let eyes = plain.clone().with(|s| s.stereo.mode = Stereo::Instanced);
    let device = ArrayLimits::of(gpu());
    let cases = [
        ("full", plain.clone(), device),
        (
            "variable",
            rated(Shading::Variable, RateSource::Content),
            limits(2, 1 << 20),
        ),
        (
            "coarse",
            rated(Shading::Coarse, RateSource::Radii),
            limits(256, 2048),
        ),
        ("smoothed", smoothed, device),
        ("eyes", eyes, device),
    ];
    for (name, settings, limits) in cases {
        let [family, material] = [
            crate::MaterialDispatch::Family,
            crate::MaterialDispatch::Material,
        ]
        .map(|dispatch| drawn(&scene, &by(dispatch, &settings), limits));
        let families = family.scene().materials.families().count();
        assert!((6..30).contains(&families), "{families} families");
        assert!(picture(&family) == picture(&material), "{name}");
        let surfaces =
            [&family, &material].map(|r| texels::<[u32; 4]>(&r.targets().gbuffer.surface_view));
        assert!(surfaces[0] == surfaces[1], "{name}");
        let mut seen = surfaces[0].iter().filter(|s| **s != [0; 4]);
        assert!(seen.nth(1000).is_some(), "{name}: little is seen");
    }
}

#[test]
fn a_texture_alone_in_its_array_looks_the_same_as_one_among_many() {
    let scene = patchwork();
    let settings = by(crate::MaterialDispatch::Family, &small(157, 101));
    let shared = drawn(&scene, &settings, ArrayLimits::of(gpu()));
    let alone = drawn(&scene, &settings, limits(1, 1 << 20));
    let [a, b] = [&shared, &alone].map(|r| r.scene().materials.families().count());
    assert!(a < b, "{a} families with arrays, {b} without");
    assert!(picture(&shared) == picture(&alone));
}

#[test]
fn each_dispatch_covers_its_own_pixels_and_no_others() {
    let scene = patchwork();
    for (dispatch, own) in [
        (crate::MaterialDispatch::Family, MaterialDispatch::Family),
        (
            crate::MaterialDispatch::Material,
            MaterialDispatch::Material,
        ),
    ] {
        let settings = by(dispatch, &small(131, 77));
        let renderer = drawn(&scene, &settings, ArrayLimits::of(gpu()));
        let materials = &renderer.scene().materials;
        let families = materials.families();
        let number = |material: u32| match own {
            MaterialDispatch::Family => families.of(material),
            MaterialDispatch::Material => material,
        };
        let gbuffer = &renderer.targets().gbuffer;
        let words = |buffer| pollster::block_on(read_buffer(gpu(), buffer)).unwrap();
        let pixels: Vec<u32> =
            bytemuck::pod_collect_to_vec(&words(&gbuffer.visibility.as_ref().unwrap().pixels));
        let dispatches = words(materials.family_bindings().unwrap().dispatches(own));
        let dispatches: Vec<FamilyUniform> = bytemuck::pod_collect_to_vec(&dispatches);
        let ids = texels::<[u32; 2]>(&gbuffer.identity_view);
        let mut expected = vec![Vec::new(); dispatches.len()];
        for (i, id) in (0..).zip(&ids).filter(|(_, id)| id[0] > 0) {
            let material = scene.instances[id[0] as usize - 1].material;
            let pixel = (i % settings.picture.width) | (i / settings.picture.width) << 16;
            expected[number(material) as usize].push(pixel);
        }
        for (found, expected) in dispatches.iter().zip(&mut expected) {
            let groups = expected.len().div_ceil(64) as u32;
            assert_eq!(
                (found.groups_x, found.groups_y, found.groups_z),
                (groups, u32::from(groups > 0), 1)
            );
            let range = found.first as usize..(found.first + found.count) as usize;
            let mut listed = pixels[range].to_vec();
            listed.sort_unstable();
            expected.sort_unstable();
            assert_eq!(listed, *expected);
        }
    }
}
