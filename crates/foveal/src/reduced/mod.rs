//! The renderer on devices that have neither storage buffers nor compute shaders, held to the full
//! one.
//!
//! Such a device (WebGL 2) gets tables in textures for storage buffers (`gpu/table.rs`), lights
//! assigned on the CPU (`lights/on_cpu.rs`) and a G-buffer that holds depth as an integer; all else
//! is the same code. In shaders, `#ifdef REDUCED` has what differs.

use std::sync::OnceLock;

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};

use crate::forward::strokes_tests::strokes;
use crate::gpu::read_buffer;
use crate::lights::cluster_bits;
use crate::shader::{self, Shader};
use crate::testing::{gpu, picture, rendered, rendered_on, small};
use crate::{
    AmbientOcclusion, Culling, EnvironmentSource, Gpu, Output, Renderer, Settings, Shadows, Stereo,
};

/// A device that was asked for no more than WebGL 2 has.
fn reduced_gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        pollster::block_on(async {
            let instance =
                wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
            let adapter = instance
                .request_adapter(&wgpu::RequestAdapterOptions::default())
                .await
                .expect("the tests need a graphics adapter");
            let (device, queue) = adapter
                .request_device(&wgpu::DeviceDescriptor {
                    required_limits: Gpu::reduced_limits(),
                    ..Default::default()
                })
                .await
                .expect("every device has this little");
            Gpu::from_device(device, queue)
        })
    })
}

fn reduced(scene: &Scene, camera: &Camera, settings: &Settings) -> Renderer {
    rendered_on(reduced_gpu(), scene, camera, settings)
}

/// Channels of the pictures that differ by more than `tolerance`, of all.
fn differing(a: &[u8], b: &[u8], tolerance: u8) -> f64 {
    assert_eq!(a.len(), b.len());
    let count = a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > tolerance);
    count.count() as f64 / a.len() as f64
}

#[test]
fn the_reduced_renderer_gives_the_full_ones_picture() {
    assert!(reduced_gpu().is_reduced() && !gpu().is_reduced());
    let stereo = small(160, 100).with(|s| {
        s.stereo.mode = Stereo::Auto;
        s.stereo.output = Output::AnaglyphDubois;
        s.culling.mode = Culling::Occlusion;
    });
    for name in ["cornell", "alpha", "materials-grid", "lobes", "demo:1000"] {
        let scene = generate::by_name(name).expect("it is generated");
        let sky = small(161, 99).with(|s| s.lighting.environment = EnvironmentSource::Sky);
        let bounces = sky.clone().with(|s| s.lighting.multiple_scattering = true);
        for settings in [small(161, 99), stereo.clone(), sky, bounces] {
            let camera = &scene.cameras[0];
            let full = picture(&rendered(&scene, camera, &settings));
            let ours = pollster::block_on(reduced(&scene, camera, &settings).read_picture());
            let ours = ours.expect("read-back works");
            // Depth is found again from the distance: a rounding moves a light's edge now and then.
            let share = differing(&full, &ours, 2);
            assert!(share < 1e-3, "{name}: {share} of the channels");
            assert!(differing(&full, &vec![0; full.len()], 20) > 0.2, "{name}");
        }
    }
}

#[test]
fn ambient_occlusion_is_that_of_the_full_renderer() {
    let open = small(161, 99).with(|s| s.lighting.environment = EnvironmentSource::Sky);
    let occluded = open
        .clone()
        .with(|s| s.lighting.ambient_occlusion = AmbientOcclusion::Screen);
    let of_two = occluded.clone().with(|s| s.stereo.mode = Stereo::Auto);
    for name in ["cornell", "alpha", "lobes", "demo:1000"] {
        let scene = generate::by_name(name).expect("it is generated");
        let camera = &scene.cameras[0];
        let unoccluded = picture(&rendered(&scene, camera, &open));
        for settings in [&occluded, &of_two] {
            let full = picture(&rendered(&scene, camera, settings));
            let ours = pollster::block_on(reduced(&scene, camera, settings).read_picture());
            let ours = ours.expect("read-back works");
            let share = differing(&full, &ours, 2);
            assert!(share < 1e-3, "{name}: {share} of the channels");
            if settings.is_stereo() {
                continue;
            }
            let dimmed = differing(&unoccluded, &ours, 4);
            assert!(dimmed > 5e-3, "{name}: {dimmed}");
        }
    }
}

#[test]
fn shadows_are_those_of_the_full_renderer() {
    for name in ["cornell", "alpha", "demo:1000"] {
        let mut scene = generate::by_name(name).expect("it is generated");
        scene.light_by_default();
        generate::add_point_lights(&mut scene, 6, 3);
        let spot = scene.lights.last_mut().expect("a light");
        spot.direction = glam::Vec3::NEG_Y;
        spot.kind = foveal_scene::LightKind::Spot {
            inner_rad: 0.3,
            outer_rad: 0.8,
        };
        let camera = &scene.cameras[0];
        let of = |shadows| {
            small(161, 99).with(|s| {
                s.lighting.shadows = shadows;
                s.lighting.shadow_atlas = 2048;
                s.culling.mode = Culling::Occlusion;
            })
        };
        let unshadowed = picture(&rendered(&scene, camera, &of(Shadows::Off)));
        for shadows in [Shadows::Hard, Shadows::Soft] {
            let full = picture(&rendered(&scene, camera, &of(shadows)));
            let ours = reduced(&scene, camera, &of(shadows));
            let ours = pollster::block_on(ours.read_picture()).expect("read-back works");
            // The sampler blends by fewer bits.
            let share = differing(&full, &ours, 2);
            assert!(share < 1e-3, "{name}, {shadows:?}: {share} of the channels");
            let shadowed = differing(&unshadowed, &ours, 12);
            assert!(shadowed > 0.03, "{name}, {shadows:?}: {shadowed}");
        }
    }
}

#[test]
fn textures_in_blocks_are_those_of_the_full_renderer() {
    let mut scene = generate::by_name("alpha").expect("it is generated");
    let (camera, settings) = (scene.cameras[0].clone(), small(161, 99));
    let plain = picture(&rendered(&scene, &camera, &settings));
    scene.compress_textures(foveal_scene::TextureCompression::Small, true);
    let full = picture(&rendered(&scene, &camera, &settings));
    let ours = reduced(&scene, &camera, &settings);
    let texels = scene.textures.iter().map(foveal_scene::Texture::bytes);
    assert!(ours.scene_stats().texture_bytes > 3 * texels.sum::<u64>());
    let ours = pollster::block_on(ours.read_picture()).expect("read-back works");
    // Blocks of one channel or two have more than 8 bits.
    let share = differing(&full, &ours, 2);
    assert!(share < 5e-3, "{share} of the channels");
    assert!(differing(&plain, &ours, 2) > 2.0 * share);
}

#[test]
fn points_and_lines_are_those_of_the_full_renderer() {
    let (scene, camera) = strokes();
    for width in [1.0, 5.0] {
        let settings = small(120, 80).with(|s| {
            s.geometry.line_width_px = width;
            s.geometry.point_size_px = width;
        });
        let full = picture(&rendered(&scene, &camera, &settings));
        let ours = pollster::block_on(reduced(&scene, &camera, &settings).read_picture());
        assert!(differing(&full, &ours.expect("read-back works"), 2) < 1e-3);
        let shown = full.chunks_exact(4).filter(|p| p[0] > 100).count();
        assert!(shown > 100, "{shown}");
    }
}

#[test]
fn two_eyes_in_one_submission_are_those_of_two_passes() {
    let scene = generate::by_name("demo:1000").expect("it is generated");
    let of = |stereo| {
        let settings = small(96, 64).with(|s| {
            s.stereo.mode = stereo;
            s.stereo.output = Output::SideBySide;
        });
        let renderer = reduced(&scene, &scene.cameras[0], &settings);
        pollster::block_on(renderer.read_picture()).expect("read-back works")
    };
    assert!(differing(&of(Stereo::Instanced), &of(Stereo::TwoPass), 0) < 1e-3);
}

#[test]
fn the_cpu_assigns_lights_to_the_clusters_that_the_device_finds() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 70, 3);
    for light in scene.lights.iter_mut().skip(10) {
        light.range_m = Some(0.6);
    }
    for stereo in [Stereo::Off, Stereo::Auto] {
        let settings = small(320, 200).with(|s| s.stereo.mode = stereo);
        let camera = &scene.cameras[0];
        let renderer = rendered(&scene, camera, &settings);
        let (assigner, lights) = renderer.lights();
        let bytes =
            pollster::block_on(read_buffer(gpu(), assigner.bits())).expect("read-back works");
        let device: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let frame = renderer.frame_uniform(camera);
        let eyes = if stereo == Stereo::Off { 1 } else { 2 };
        let cpu = cluster_bits(&frame, eyes, lights);
        assert!(cpu.len() <= device.len());
        let set: u32 = cpu.iter().map(|w| w.count_ones()).sum();
        let differing: u32 = (cpu.iter().zip(&device))
            .map(|(a, b)| (a ^ b).count_ones())
            .sum();
        assert!(set > 1000);
        // Logarithms round differently: a slice more or less, at the very edge of a light's reach.
        assert!(differing * 200 < set, "{differing} of {set}");
    }
}

/// What naga writes for GLSL ES 3.00 all the same: functions and qualifiers of ES 3.10 and later
/// (The OpenGL ES Shading Language 3.10, sections 4 and 8).
const SINCE_ES_3_10: [&str; 19] = [
    "bitfieldExtract",
    "bitfieldInsert",
    "bitfieldReverse",
    "bitCount",
    "findLSB",
    "findMSB",
    "frexp(",
    "ldexp(",
    "fma(",
    "packUnorm4x8",
    "packSnorm4x8",
    "unpackUnorm4x8",
    "unpackSnorm4x8",
    "textureGather",
    "uaddCarry",
    "mulExtended",
    " buffer ",
    "imageLoad",
    "imageStore",
];

/// WebGL 2 takes GLSL ES 3.00 alone.
#[test]
fn the_reduced_shaders_can_be_said_in_the_language_of_webgl_2() {
    let all: [(Shader, [&str; 2]); 13] = [
        (
            shader::REDUCED_GBUFFER.variant(&["REDUCED"]),
            ["vertex", "fragment"],
        ),
        (
            shader::SHADING_EVERY_PIXEL.variant(&["REDUCED"]),
            ["full_screen", "shade_pixel"],
        ),
        (
            shader::FORWARD_FORWARD.variant(&["REDUCED"]),
            ["vertex", "fragment"],
        ),
        (
            shader::FORWARD_FORWARD.variant(&["STROKES", "REDUCED"]),
            ["vertex", "fragment"],
        ),
        (
            shader::FORWARD_FORWARD.variant(&["LOBES", "REDUCED"]),
            ["vertex", "fragment"],
        ),
        (
            shader::FORWARD_FORWARD.variant(&["LOBES", "TRANSMISSION", "REDUCED"]),
            ["vertex", "fragment"],
        ),
        (shader::FORWARD_HALVE, ["level_screen", "halve"]),
        (
            shader::AMBIENT_EVERY.variant(&["REDUCED"]),
            ["full_screen", "find_every"],
        ),
        (
            shader::AMBIENT_RESOLVE.variant(&["REDUCED"]),
            ["full_screen", "resolve"],
        ),
        (shader::SHADOW_CASTER, ["vertex_of_caster", "cast_shadow"]),
        (shader::SHADOW_CLEAR, ["full_screen", "clear"]),
        (shader::OUTPUT_TONE_MAP, ["full_screen", "tone_map"]),
        (shader::OUTPUT_EYES, ["full_screen", "show_eyes"]),
    ];
    for (shader, entry_points) in all {
        let module = naga::front::wgsl::parse_str(&shader.source(true)).expect("it parses");
        for (_, variable) in module.global_variables.iter() {
            let size = module.types[variable.ty].inner.size(module.to_ctx());
            let fits = variable.space != naga::AddressSpace::Uniform || size.is_multiple_of(16);
            assert!(
                fits,
                "{entry_points:?}: {:?} has {size} bytes",
                variable.name
            );
        }
        // All that both stages bind: wgpu gives each its own unit of the 16 that WebGL 2 has.
        let images = module.global_variables.iter().filter(|(_, variable)| {
            let inner = &module.types[variable.ty].inner;
            matches!(inner, naga::TypeInner::Image { .. })
        });
        let images = images.count();
        assert!(images <= 16, "{entry_points:?}: {images} textures");
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        );
        let types = validator.validate(&module).expect("it is valid");
        let stages = [naga::ShaderStage::Vertex, naga::ShaderStage::Fragment];
        for (stage, entry_point) in stages.into_iter().zip(entry_points) {
            let constants = naga::back::PipelineConstants::default();
            let (module, types) = naga::back::pipeline_constants::process_overrides(
                &module,
                &types,
                Some((stage, entry_point)),
                &constants,
            )
            .expect("the overrides have defaults");
            let options = naga::back::glsl::Options {
                version: naga::back::glsl::Version::new_gles(300),
                ..Default::default()
            };
            let pipeline = naga::back::glsl::PipelineOptions {
                shader_stage: stage,
                entry_point: entry_point.to_owned(),
                multiview: None,
            };
            let mut text = String::new();
            naga::back::glsl::Writer::new(
                &mut text,
                &module,
                &types,
                &options,
                &pipeline,
                naga::proc::BoundsCheckPolicies::default(),
            )
            .and_then(|mut writer| writer.write())
            .unwrap_or_else(|cause| panic!("{entry_point}: {cause}"));
            for missing in SINCE_ES_3_10 {
                assert!(!text.contains(missing), "{entry_point} says {missing}");
            }
        }
    }
}
