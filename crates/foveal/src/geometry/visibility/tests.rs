//! The visibility buffer against the rasterizer's own surfaces, and its bins against their twin.

use foveal_generate as generate;
use foveal_scene::{
    AlphaMode, Camera, ColorSpace, Filter, Material, Mesh, Projection, Sampler, Scene, Texture,
    TextureRef,
};

use glam::{Mat3, Mat4, Vec2, Vec3};

use crate::forward::twin::quads;
use crate::gpu::read_texture;
use crate::shading::twin::unpack_surface;
use crate::testing::{
    gpu, gpu_with, gpu_with_buffers, picture, rendered, rendered_on, small, texels,
};
use crate::{
    Antialiasing, DebugView, EdgeTest, Frame, Geometry, Gpu, SamplePattern, Settings, Stereo,
};

fn by_triangles(settings: &Settings) -> Settings {
    settings
        .clone()
        .with(|s| s.geometry.path = Geometry::Visibility)
}

/// Draws both ways: identity and depth must be equal to the bit but for `moved` motions that round
/// differently, surfaces to interpolation error but for `off` of the pixels.
fn assert_same_gbuffer(scene: &Scene, camera: &Camera, off: f64) {
    // Anisotropic filters differ by the derivatives that they are told.
    let settings = small(157, 101).with(|s| s.lighting.anisotropy = 1);
    let [raster, triangles] = [settings.clone(), by_triangles(&settings)]
        .map(|settings| rendered(scene, camera, &settings));
    let [a, b] = [&raster, &triangles].map(|r| &r.targets().gbuffer);
    assert_eq!(
        texels::<u32>(&a.depth_view),
        texels::<u32>(&b.depth_view),
        "depth"
    );
    let [ids_a, ids_b] = [a, b].map(|g| texels::<[u32; 2]>(&g.identity_view));
    assert!(
        ids_a.iter().zip(&ids_b).all(|(a, b)| a[0] == b[0]),
        "instances"
    );
    let [words_a, words_b] = [a, b].map(|g| texels::<[u32; 4]>(&g.surface_view));
    let (mut seen, mut wrong) = (0, 0);
    for (i, (a, b)) in words_a.iter().zip(&words_b).enumerate() {
        if ids_a[i][0] == 0 {
            assert_eq!(*b, [0; 4], "nothing at pixel {i}");
            continue;
        }
        seen += 1;
        let [a, b] = [a, b].map(|w| unpack_surface(*w, Vec3::ZERO));
        let color = (a.base_color - b.base_color).abs().max_element();
        let rest = [
            a.metallic - b.metallic,
            a.roughness - b.roughness,
            a.occlusion - b.occlusion,
        ];
        let emissive = (a.emissive - b.emissive).abs().max_element();
        let same = color < 0.02
            && a.normal.dot(b.normal) > 0.999
            && rest.iter().all(|d| d.abs() < 0.01)
            && emissive <= 0.02 * a.emissive.max_element().max(0.5);
        wrong += u32::from(!same);
    }
    assert!(seen > 500, "only {seen} pixels see a surface");
    assert!(
        f64::from(wrong) <= off * f64::from(seen),
        "{wrong} of {seen} surfaces differ"
    );
}

#[test]
fn attributes_equal_the_rasterizers_in_every_kind_of_scene() {
    // Where a surface ends within 2 x 2 pixels, the rasterizer's derivatives reach beyond it.
    for (name, off) in [
        ("cornell", 0.0),
        ("materials-grid", 0.002),
        ("demo:1000", 0.01),
        ("alpha", 0.02),
    ] {
        let scene = generate::by_name(name).unwrap();
        assert_same_gbuffer(&scene, &scene.cameras[0], off);
    }
    let scene = generate::cornell();
    let mut camera = scene.cameras[0].clone();
    camera.projection = Projection::Orthographic {
        height_m: 4.0,
        near_m: 0.05,
        far_m: 30.0,
    };
    assert_same_gbuffer(&scene, &camera, 0.0);
}

#[test]
fn mirrored_and_two_sided_instances_face_as_the_rasterizer_says() {
    let mut scene = generate::cornell();
    let flip = Mat4::from_scale(Vec3::new(-1.0, 0.7, 1.0));
    for instance in &mut scene.instances {
        instance.world_from_object = flip * instance.world_from_object;
    }
    for material in &mut scene.materials {
        material.double_sided = true;
    }
    assert_same_gbuffer(&scene, &scene.cameras[0].clone(), 0.0);
    let mut behind = scene.cameras[0].clone();
    behind.world_from_view = behind.world_from_view
        * Mat4::from_translation(Vec3::new(0.0, 0.0, -12.0))
        * Mat4::from_rotation_y(3.0);
    assert_same_gbuffer(&scene, &behind, 0.0);
}

/// A texture of `side` texels a side whose levels differ in colour, the levels' first doubling in
/// steps of grey.
fn level_texture(side: u32) -> Texture {
    let levels = (0..=side.ilog2()).map(|level| {
        let texel = [(level * 25) as u8, 255 - (level * 25) as u8, 128, 255];
        texel.repeat(((side >> level) * (side >> level)) as usize)
    });
    Texture {
        name: "levels".to_owned(),
        width: side,
        height: side,
        color_space: ColorSpace::Linear,
        sampler: Sampler {
            mag: Filter::Linear,
            min: Filter::Linear,
            mip: Some(Filter::Linear),
            ..Sampler::default()
        },
        encoding: foveal_scene::Encoding::Rgba8,
        levels: levels.collect(),
    }
}

/// A floor of 2 km whose corners lie behind the eye and far away, seen from a hand's breadth above
/// it with a field of view of 150 degrees.
fn floor(texture: Texture) -> (Scene, Camera) {
    let slot = |uv_transform| {
        Some(TextureRef {
            texture: 0,
            uv_set: 0,
            uv_transform,
        })
    };
    let material = Material {
        base_color_texture: slot(Mat3::from_scale(Vec2::new(2000.0, 3000.0))),
        double_sided: true,
        ..Material::default()
    };
    let mut scene = quads(vec![material], &[0.0]);
    scene.textures = vec![texture];
    scene.instances[0].world_from_object =
        Mat4::from_rotation_x(-1.57) * Mat4::from_scale(Vec3::splat(1000.0));
    scene.instances[0].bounds = scene.meshes[0]
        .bounds
        .transformed(scene.instances[0].world_from_object);
    let eye = Vec3::new(3.0, 1.0, 5.0);
    let mut camera = Camera::look_at(
        eye,
        eye + Vec3::new(0.3, -0.2, -1.0),
        Vec3::Y,
        150f32.to_radians(),
    );
    camera.projection = Projection::Perspective {
        fov_y_rad: 150f32.to_radians(),
        near_m: 0.001,
    };
    (scene, camera)
}

/// A floor on which the red that is seen tells the level of detail.
pub(crate) fn level_scene() -> (Scene, Camera) {
    floor(level_texture(256))
}

#[test]
fn extreme_perspective_has_the_rasterizers_levels_of_detail() {
    let (scene, camera) = level_scene();
    let settings = small(157, 101);
    let [raster, triangles] = [settings.clone(), by_triangles(&settings)]
        .map(|settings| rendered(&scene, &camera, &settings));
    let [a, b] =
        [&raster, &triangles].map(|r| texels::<[u32; 4]>(&r.targets().gbuffer.surface_view));
    let ids = texels::<[u32; 2]>(&raster.targets().gbuffer.identity_view);
    let (mut seen, mut sum, mut levels) = (0, 0.0, std::collections::BTreeSet::new());
    for ((a, b), id) in a.iter().zip(&b).zip(&ids) {
        if id[0] == 0 {
            continue;
        }
        // Red is the level times 25 of 255.
        let [a, b] = [a, b].map(|w| unpack_surface(*w, Vec3::ZERO).base_color.x * 10.2);
        levels.insert(a.round() as u32);
        seen += 1;
        sum += f64::from((a - b).abs());
        // The rasterizer takes one level for 2 x 2 pixels, from differences between them.
        assert!((a - b).abs() < 0.8, "level {a} and {b}");
    }
    assert!(
        levels.len() >= 6 && seen > 5000,
        "{seen} pixels, {levels:?}"
    );
    assert!(
        sum / f64::from(seen) < 0.1,
        "off by {} of a level",
        sum / f64::from(seen)
    );
}

#[test]
fn extreme_perspective_keeps_every_attribute() {
    let checker = Texture {
        name: "checker".to_owned(),
        width: 2,
        height: 2,
        color_space: ColorSpace::Linear,
        sampler: Sampler {
            mag: Filter::Nearest,
            min: Filter::Nearest,
            mip: None,
            ..Sampler::default()
        },
        encoding: foveal_scene::Encoding::Rgba8,
        levels: vec![[[10; 4], [250; 4], [130; 4], [70; 4]].concat()],
    };
    let (mut scene, camera) = floor(checker);
    // Texels of 50 m: far ones are thinner than a pixel.
    let slot = scene.materials[0].base_color_texture.as_mut().unwrap();
    slot.uv_transform = Mat3::from_scale(Vec2::splat(20.0));
    for (i, vertex) in scene.meshes[0].vertices.iter_mut().enumerate() {
        vertex.normal = Vec3::new(i as f32 - 1.5, (i % 2) as f32, 1.0)
            .normalize()
            .to_array();
        let color: [u16; 4] = [
            [255, 0, 90, 255],
            [0, 200, 40, 255],
            [90, 90, 255, 255],
            [10, 70, 0, 255],
        ][i];
        vertex.color = color.map(|c| 257 * c);
    }
    assert_same_gbuffer(&scene, &camera, 0.01);
}

#[test]
fn motion_is_the_rasterizers() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let mut before = camera.clone();
    before.world_from_view.w_axis.x += 0.05;
    let motions = [Geometry::Gbuffer, Geometry::Visibility].map(|geometry| {
        let settings = small(61, 40).with(|s| {
            s.geometry.path = geometry;
            s.picture.view = DebugView::Motion;
        });
        let mut renderer = rendered(&scene, camera, &settings);
        let frame = Frame::new(camera).with_previous(&before);
        pollster::block_on(renderer.render(&frame)).unwrap();
        texels::<[u32; 2]>(&renderer.targets().gbuffer.identity_view)
    });
    assert_eq!(motions[0], motions[1]);
    assert!(motions[0].iter().any(|m| m[1] != 0));

    // Full shading asks for none.
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = small(61, 40).with(|s| s.geometry.path = geometry);
        let mut renderer = rendered(&scene, camera, &settings);
        let frame = Frame::new(camera).with_previous(&before);
        pollster::block_on(renderer.render(&frame)).unwrap();
        let identity = texels::<[u32; 2]>(&renderer.targets().gbuffer.identity_view);
        let numbers = |all: &[[u32; 2]]| all.iter().map(|i| [i[0], 0]).collect::<Vec<_>>();
        assert_eq!(identity, numbers(&motions[0]));
    }
}

#[test]
fn pulled_vertices_give_the_same_gbuffer_as_numbered_triangles() {
    let plain = gpu_with(wgpu::Features::empty(), Gpu::required_limits());
    let numbering = gpu_with_buffers();
    assert!(!plain.numbers_triangles());
    if !numbering.numbers_triangles() {
        eprintln!("skipped: the device does not number triangles");
        return;
    }
    // Meshes that begin after a point's quad, and at another vertex.
    let mut after_point = generate::by_name("alpha").unwrap();
    let point = Mesh {
        vertices: after_point.meshes[0].vertices[..1].to_vec(),
        points: vec![0],
        ..Mesh::default()
    };
    after_point.meshes.insert(0, point);
    for instance in &mut after_point.instances {
        instance.mesh += 1;
    }
    let demo = generate::by_name("demo:1000").unwrap();
    for scene in [demo, after_point] {
        let settings = by_triangles(&small(157, 101));
        let [numbered, by_textures, by_buffers] = [&numbering, gpu(), &plain].map(|gpu| {
            pollster::block_on(async {
                let renderer = rendered_on(gpu, &scene, &scene.cameras[0], &settings);
                let g = &renderer.targets().gbuffer;
                let triangles = &g.visibility.as_ref().unwrap().triangle_view;
                let mut bytes = Vec::new();
                for view in [&g.surface_view, &g.identity_view, &g.depth_view, triangles] {
                    bytes.push(read_texture(gpu, view.texture()).await.unwrap());
                }
                bytes
            })
        });
        assert!(numbered == by_textures, "{}: textures", scene.name);
        assert!(numbered == by_buffers, "{}: buffers", scene.name);
        assert!(numbered[3].iter().any(|&byte| byte != 0));
    }
}

#[test]
fn both_eyes_look_the_same_whoever_numbers_triangles() {
    let numbering = gpu_with_buffers();
    if !numbering.numbers_triangles() {
        eprintln!("skipped: the device does not number triangles");
        return;
    }
    let scene = generate::by_name("demo:1000").unwrap();
    // Multiview, which lavapipe draws wrong: stereo/tests/multiview.rs.
    for stereo in [Stereo::Instanced, Stereo::TwoPass] {
        let settings = by_triangles(&small(61, 48)).with(|s| s.stereo.mode = stereo);
        let [numbered, pulled] = [&numbering, gpu()]
            .map(|gpu| picture(&rendered_on(gpu, &scene, &scene.cameras[0], &settings)));
        assert!(numbered == pulled, "{stereo:?}");
    }
}

#[test]
fn anti_aliasing_looks_the_same_on_both_geometries() {
    let mut scene = generate::cornell();
    scene.materials[0].alpha_mode = AlphaMode::Opaque;
    for (aa, pattern, samples) in [
        (Antialiasing::Msaa, SamplePattern::Grid, 4),
        (Antialiasing::Msaa, SamplePattern::Rotated, 8),
        (Antialiasing::Ssaa, SamplePattern::Rotated, 4),
    ] {
        let settings = small(97, 61).with(|s| {
            s.antialiasing.mode = aa;
            s.antialiasing.pattern = pattern;
            s.antialiasing.samples = samples;
            // On a grid the surface test goes another way over triangles: antialias/triangles.rs
            // and its tests.
            s.antialiasing.edge_test = match pattern {
                SamplePattern::Grid => EdgeTest::Paper,
                SamplePattern::Rotated => EdgeTest::Surface,
            };
        });
        let [raster, triangles] = [settings.clone(), by_triangles(&settings)]
            .map(|s| picture(&rendered(&scene, &scene.cameras[0], &s)));
        let off = raster.iter().zip(&triangles);
        let off = off.filter(|(a, b)| a.abs_diff(**b) > 3).count();
        assert!(off * 500 < raster.len(), "{aa:?} {pattern:?}: {off} differ");
    }
}
