//! A device that fails anywhere: at the nth creation, upload or submission memory is out, the call
//! is refused, or the device is gone.
//!
//! Each failure must be an error with a sentence, never a panic or a wait without end; and after it
//! the same renderer, or where the device is gone a new one, draws what one draws that never failed.
//! `FOVEAL_FAULTS=all` strikes at every call, not at some of each.

mod growing;

use std::sync::LazyLock;

use foveal_generate as generate;
use foveal_scene::Scene;
use pollster::block_on;

use crate::gpu::faults::Fault;
use crate::testing::{picture, small};
use crate::{
    Antialiasing, CoarseBackend, Culling, DebugView, EnvironmentMap, EnvironmentSource, Error,
    Frame, Geometry, Gpu, RateImage, RateSource, Renderer, RendererOptions, Settings, Shading,
    Shadows, Stereo,
};

/// A device of the host's: what no error scope catches is a panic there.
fn host_gpu() -> Gpu {
    host_gpu_with(Gpu::wanted_limits)
}

/// The same with limits that are chosen from the adapter's.
fn host_gpu_with(limits: impl Fn(&wgpu::Limits) -> wgpu::Limits) -> Gpu {
    block_on(async {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions::default())
            .await
            .expect("the tests need a graphics adapter");
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                required_features: Gpu::wanted_features() & adapter.features(),
                required_limits: limits(&adapter.limits()),
                ..Default::default()
            })
            .await
            .expect("it can be opened");
        let gpu = Gpu::from_device(device, queue);
        let told = gpu.clone();
        let told = std::sync::Mutex::new(Some(told));
        gpu.device.set_device_lost_callback(move |reason, _| {
            if let Some(gpu) = told.lock().expect("no test panicked").take() {
                gpu.note_loss(format!("{reason:?}"));
            }
        });
        gpu
    })
}

fn scene() -> Scene {
    static SCENE: LazyLock<Scene> = LazyLock::new(|| {
        let mut scene = generate::by_name("alpha").expect("it is generated");
        scene.light_by_default();
        generate::add_point_lights(&mut scene, 5, 1);
        scene
    });
    SCENE.clone()
}

fn map() -> EnvironmentMap {
    static MAP: LazyLock<EnvironmentMap> = LazyLock::new(|| {
        let (width, height, rgb) = generate::surroundings(16);
        EnvironmentMap::new(width, height, &rgb).expect("it is a map")
    });
    MAP.clone()
}

/// Settings that between them run every stage.
fn cases() -> Vec<(&'static str, Settings)> {
    let plain = small(48, 32);
    let of = |change: &dyn Fn(&mut Settings)| plain.clone().with(|s| change(s));
    vec![
        ("full", of(&|s| s.culling.mode = Culling::Occlusion)),
        (
            "visibility buffer, shadows",
            of(&|s| {
                s.geometry.path = Geometry::Visibility;
                s.lighting.shadows = Shadows::Soft;
                s.lighting.shadow_atlas = 512;
            }),
        ),
        (
            "coarse by compute",
            of(&|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.backend = CoarseBackend::Compute;
            }),
        ),
        (
            "coarse by stencil, rates of an image",
            of(&|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.backend = CoarseBackend::Stencil;
                s.coarse.source = RateSource::Image;
            }),
        ),
        (
            "light history",
            of(&|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.backend = CoarseBackend::Compute;
                s.coarse.history = true;
                s.lighting.shadows = Shadows::Hard;
                s.lighting.shadow_atlas = 256;
            }),
        ),
        (
            "variable",
            of(&|s| {
                s.shading.mode = Shading::Variable;
                s.rate.force = true;
            }),
        ),
        ("msaa", of(&|s| s.antialiasing.mode = Antialiasing::Msaa)),
        (
            "ssaa of a visibility buffer",
            of(&|s| {
                s.antialiasing.mode = Antialiasing::Ssaa;
                s.geometry.path = Geometry::Visibility;
            }),
        ),
        (
            "two eyes, stretched",
            of(&|s| {
                s.stereo.mode = Stereo::Instanced;
                s.picture.render_scale = 0.5;
            }),
        ),
        (
            "environment",
            of(&|s| s.lighting.environment = EnvironmentSource::Image),
        ),
        ("debug view", of(&|s| s.picture.view = DebugView::Normals)),
    ]
}

/// A renderer that has been given everything and has drawn nothing.
async fn ready(gpu: &Gpu, settings: &Settings) -> Result<Renderer, Error> {
    let mut renderer = Renderer::new(gpu, settings, RendererOptions::default()).await?;
    renderer
        .set_rate_image(RateImage::new(2, 1, vec![0, 128]).expect("two pixels"))
        .unwrap();
    renderer.set_environment(map()).await?;
    renderer.set_scene(&scene()).await?;
    Ok(renderer)
}

/// Draws a frame that follows none.
async fn draw(renderer: &mut Renderer) -> Result<(), Error> {
    let camera = &scene().cameras[0];
    let other = foveal_scene::Camera {
        name: "elsewhere".to_owned(),
        ..camera.clone()
    };
    let frame = Frame::new(camera).with_previous(&other);
    renderer.render(&frame).await.map(drop)
}

/// What a renderer draws that never failed.
fn expected(gpu: &Gpu, settings: &Settings) -> Vec<u8> {
    let mut renderer = block_on(ready(gpu, settings)).expect("nothing fails");
    block_on(draw(&mut renderer)).expect("nothing fails");
    picture(&renderer)
}

fn strikes_everywhere() -> bool {
    std::env::var("FOVEAL_FAULTS").is_ok_and(|text| text == "all")
}

/// Where to strike among `calls`, and how: everywhere by both, or at some places by either.
fn strikes(calls: u64, some: u64) -> Vec<(u64, Fault)> {
    const FAULTS: [Fault; 2] = [Fault::OutOfMemory, Fault::Invalid];
    if strikes_everywhere() {
        return (0..calls)
            .flat_map(|place| FAULTS.map(|fault| (place, fault)))
            .collect();
    }
    let places = (0..some).map(|i| calls * (2 * i + 1) / (2 * some));
    places.zip(FAULTS.into_iter().cycle()).collect()
}

fn assert_told(what: &str, fault: Fault, failed: Result<(), Error>) {
    let told = matches!(
        (&failed, fault),
        (Err(Error::OutOfMemory { .. }), Fault::OutOfMemory)
            | (Err(Error::Validation { .. }), Fault::Invalid)
            | (
                Err(Error::DeviceLost { .. }),
                Fault::Lost | Fault::LostByDriver
            )
    );
    assert!(told, "{what}, {fault:?}: {failed:?}");
    let sentence = failed.expect_err("it failed").to_string();
    assert!(sentence.len() > 30, "{what}: {sentence}");
}

/// Calls of `work` on this device.
fn calls(gpu: &Gpu, work: impl FnOnce()) -> u64 {
    gpu.device.faults.disarm();
    work();
    gpu.device.faults.calls()
}

#[test]
fn a_frame_that_fails_anywhere_is_an_error_and_the_next_one_is_right() {
    let gpu = host_gpu();
    for (name, settings) in cases() {
        let expected = expected(&gpu, &settings);
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        // A first frame makes what is only made when it is needed, and so does one after this.
        let anew = |renderer: &mut Renderer| {
            renderer.is_torn = true;
            block_on(renderer.mend()).expect("nothing fails");
        };
        anew(&mut renderer);
        let calls = calls(&gpu, || block_on(draw(&mut renderer)).expect("drawn"));
        assert!(calls > 5, "{name}: {calls}");
        for (place, fault) in strikes(calls, 2) {
            let what = format!("{name}, call {place} of {calls}");
            anew(&mut renderer);
            gpu.device.faults.arm(place, fault);
            let failed = block_on(draw(&mut renderer));
            assert!(gpu.device.faults.disarm(), "{what}: no call failed");
            assert_told(&what, fault, failed);
            block_on(draw(&mut renderer)).expect("memory is there again");
            assert!(picture(&renderer) == expected, "{what}: another picture");
        }
    }
}

#[test]
fn settings_that_fail_anywhere_leave_the_old_ones_in_force() {
    let gpu = host_gpu();
    let cases = cases();
    let pairs = cases.iter().zip(cases.iter().cycle().skip(3));
    for (number, ((name, settings), (_, before))) in pairs.enumerate() {
        // Some with nothing compiled, so that a pipeline, too, may be what fails.
        let trim = || {
            if number % 3 == 0 {
                gpu.trim();
            }
        };
        let (old, new) = (expected(&gpu, before), expected(&gpu, settings));
        let mut renderer = block_on(ready(&gpu, before)).expect("nothing fails");
        trim();
        let calls = calls(&gpu, || {
            block_on(renderer.set_settings(settings)).expect("nothing fails");
        });
        for (place, fault) in strikes(calls, 2) {
            let what = format!("{name}, call {place} of {calls}");
            block_on(renderer.set_settings(before)).expect("nothing fails");
            trim();
            gpu.device.faults.arm(place, fault);
            let failed = block_on(renderer.set_settings(settings));
            assert!(gpu.device.faults.disarm(), "{what}");
            assert_told(&what, fault, failed);
            assert!(renderer.settings() == before, "{what}");
            block_on(draw(&mut renderer)).expect("the old settings");
            assert!(picture(&renderer) == old, "{what}: before");
            block_on(renderer.set_settings(settings)).expect("memory is there again");
            block_on(draw(&mut renderer)).expect("the new settings");
            assert!(picture(&renderer) == new, "{what}: after");
        }
    }
}

#[test]
fn an_environment_that_fails_anywhere_leaves_the_old_one_in_place() {
    let gpu = host_gpu();
    let settings = small(48, 32).with(|s| s.lighting.environment = EnvironmentSource::Image);
    let black = EnvironmentMap::new(4, 2, &[[0.0; 3]; 8]).expect("it is a map");
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    block_on(draw(&mut renderer)).expect("drawn");
    let old = picture(&renderer);
    let calls = calls(&gpu, || {
        block_on(renderer.set_environment(black.clone())).expect("nothing fails");
    });
    block_on(draw(&mut renderer)).expect("drawn");
    let new = picture(&renderer);
    // Lights and materials.
    assert!(old != new && calls >= 2, "{calls}");
    for (place, fault) in strikes(calls, calls) {
        let what = format!("call {place} of {calls}");
        block_on(renderer.set_environment(map())).expect("nothing fails");
        gpu.device.faults.arm(place, fault);
        let failed = block_on(renderer.set_environment(black.clone()));
        assert!(gpu.device.faults.disarm(), "{what}");
        assert_told(&what, fault, failed);
        block_on(draw(&mut renderer)).expect("the old environment");
        assert!(picture(&renderer) == old, "{what}: before");
        block_on(renderer.set_environment(black.clone())).expect("memory is there again");
        block_on(draw(&mut renderer)).expect("the new environment");
        assert!(picture(&renderer) == new, "{what}: after");
    }
}

#[test]
fn a_scene_that_fails_anywhere_leaves_the_old_one_in_place() {
    let gpu = host_gpu();
    // The new scene's sky is filtered and uploaded with it.
    let settings = small(48, 32).with(|s| s.lighting.environment = EnvironmentSource::Sky);
    let mut new_scene = generate::by_name("materials-grid").expect("it is generated");
    new_scene.environment.zenith *= 2.0;
    let old = expected(&gpu, &settings);
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    let calls = calls(&gpu, || {
        block_on(renderer.set_scene(&new_scene)).expect("nothing fails");
    });
    block_on(draw(&mut renderer)).expect("drawn");
    let new = picture(&renderer);
    assert!(old != new && calls > 10, "{calls}");
    for (place, fault) in strikes(calls, 4) {
        let what = format!("call {place} of {calls}");
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        gpu.device.faults.arm(place, fault);
        let failed = block_on(renderer.set_scene(&new_scene));
        assert!(gpu.device.faults.disarm(), "{what}");
        assert_told(&what, fault, failed);
        block_on(draw(&mut renderer)).expect("the old scene");
        assert!(picture(&renderer) == old, "{what}: before");
        block_on(renderer.set_scene(&new_scene)).expect("memory is there again");
        block_on(draw(&mut renderer)).expect("the new scene");
        assert!(picture(&renderer) == new, "{what}: after");
    }
}

/// As [`scene`], with an object and a light elsewhere.
fn moved() -> Scene {
    let mut scene = scene();
    scene.instances[0].world_from_object.w_axis.x += 0.3;
    scene.lights[1].position.x += 0.5;
    scene
}

#[test]
fn a_pose_that_fails_anywhere_is_an_error_and_objects_and_lights_have_it() {
    survives_pose(&moved());
}

/// Sets a pose that fails at each call, and draws.
fn survives_pose(pose: &Scene) {
    let gpu = host_gpu();
    let settings = small(48, 32);
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    let calls = calls(&gpu, || {
        block_on(renderer.update_pose(pose)).expect("nothing fails");
    });
    block_on(draw(&mut renderer)).expect("drawn");
    let (old, new) = (expected(&gpu, &settings), picture(&renderer));
    // Lights and materials.
    assert!(old != new && calls >= 2, "{calls}");
    for (place, fault) in strikes(calls, calls) {
        let what = format!("call {place} of {calls}");
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        gpu.device.faults.arm(place, fault);
        let failed = block_on(renderer.update_pose(pose));
        assert!(gpu.device.faults.disarm(), "{what}");
        assert_told(&what, fault, failed);
        block_on(draw(&mut renderer)).expect("memory is there again");
        assert!(picture(&renderer) == new, "{what}: another picture");
    }
}

/// A smaller scene helps where there is no memory to mend with the old one.
#[test]
fn another_scene_can_be_set_where_memory_for_mending_is_out() {
    let gpu = host_gpu();
    let settings = small(48, 32);
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    for _ in 0..2 {
        gpu.device.faults.arm(0, Fault::OutOfMemory);
        block_on(draw(&mut renderer)).expect_err("memory is out");
        assert!(gpu.device.faults.disarm() && renderer.is_torn);
    }
    let other = moved();
    gpu.device.faults.arm(0, Fault::OutOfMemory);
    block_on(renderer.set_scene(&other)).expect("another scene");
    assert!(gpu.device.faults.disarm() && renderer.is_torn);
    block_on(draw(&mut renderer)).expect("memory is there again");
    let found = picture(&renderer);
    let mut fresh = block_on(ready(&gpu, &settings)).expect("nothing fails");
    block_on(fresh.set_scene(&other)).expect("another scene");
    block_on(draw(&mut fresh)).expect("drawn");
    assert!(found == picture(&fresh));
}

/// Instances beyond the device's limit are noticed before anything of the old scene is gone.
#[test]
fn a_scene_beyond_a_limit_costs_the_renderer_nothing() {
    let gpu = host_gpu_with(|_| Gpu::required_limits());
    let settings = small(48, 32);
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    block_on(draw(&mut renderer)).expect("drawn");
    let old = picture(&renderer);
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    let many = limit as usize / size_of::<crate::scene::InstanceUniform>() + 1;
    let mut scene = scene();
    let one = scene.instances[0];
    scene.instances.resize(many, one);
    let refused = block_on(renderer.set_scene(&scene));
    assert!(matches!(refused, Err(Error::Limit { .. })), "{refused:?}");
    let mut scene = self::scene();
    let one = scene.materials[0].clone();
    let many = limit as usize / size_of::<crate::scene::MaterialUniform>() + 1;
    scene.materials.resize(many, one);
    let refused = block_on(renderer.set_scene(&scene)).unwrap_err();
    assert!(
        refused.to_string().contains("number of materials"),
        "{refused}"
    );
    assert!(!renderer.is_torn);
    block_on(draw(&mut renderer)).expect("the old scene");
    assert!(picture(&renderer) == old);
}

#[test]
fn a_renderer_whose_making_fails_anywhere_is_an_error() {
    let gpu = host_gpu();
    let (name, settings) = cases().swap_remove(4);
    let expected = expected(&gpu, &settings);
    let make = || block_on(ready(&gpu, &settings));
    // With nothing compiled, so that a pipeline, too, may be what fails.
    gpu.trim();
    let calls = calls(&gpu, || drop(make().expect("nothing fails")));
    for (place, fault) in strikes(calls, 6) {
        let what = format!("{name}, call {place} of {calls}");
        gpu.trim();
        gpu.device.faults.arm(place, fault);
        let failed = make().map(drop);
        assert!(gpu.device.faults.disarm(), "{what}");
        assert_told(&what, fault, failed);
        // What could not be compiled has been forgotten.
        drop(make().expect("memory is there again"));
    }
    let mut renderer = make().expect("memory is there again");
    block_on(draw(&mut renderer)).expect("drawn");
    assert!(picture(&renderer) == expected);
}

#[test]
fn a_device_that_is_lost_anywhere_is_an_error_and_a_new_one_draws_the_same() {
    // Each device compiles anew.
    let step = if strikes_everywhere() { 1 } else { 4 };
    for (name, settings) in cases().into_iter().step_by(step) {
        let gpu = host_gpu();
        let (mut in_making, mut in_frame) = (0, 0);
        let expected = {
            let mut renderer = None;
            in_making += calls(&gpu, || {
                renderer = Some(block_on(ready(&gpu, &settings)).expect("nothing fails"));
            });
            let mut renderer = renderer.expect("it was made");
            in_frame += calls(&gpu, || block_on(draw(&mut renderer)).expect("drawn"));
            picture(&renderer)
        };
        for (place, _) in strikes(in_making + in_frame, 2) {
            let what = format!("{name}, call {place} of {in_making} and {in_frame}");
            let gpu = host_gpu();
            gpu.device.faults.arm(place, Fault::Lost);
            let mut renderer = match block_on(ready(&gpu, &settings)) {
                Ok(renderer) => renderer,
                Err(lost) => {
                    assert_told(&what, Fault::Lost, Err(lost));
                    continue;
                }
            };
            assert_told(&what, Fault::Lost, block_on(draw(&mut renderer)));
            // And again: it stays lost, whatever is asked for.
            assert_told(&what, Fault::Lost, block_on(draw(&mut renderer)));
            let other = settings.clone().with(|s| s.picture.width = 64);
            assert_told(&what, Fault::Lost, block_on(renderer.set_settings(&other)));
            assert_told(&what, Fault::Lost, block_on(renderer.set_scene(&scene())));
            assert_told(
                &what,
                Fault::Lost,
                block_on(renderer.read_picture()).map(drop),
            );
        }
        let gpu = host_gpu();
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        block_on(draw(&mut renderer)).expect("drawn");
        assert!(picture(&renderer) == expected, "{name}");
    }
}

#[test]
fn a_device_that_the_driver_loses_is_an_error() {
    let settings = small(48, 32);
    let gpu = host_gpu();
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    block_on(draw(&mut renderer)).expect("drawn");
    let in_frame = calls(&gpu, || block_on(draw(&mut renderer)).expect("drawn"));
    for place in [0, in_frame - 1] {
        let gpu = host_gpu();
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        block_on(draw(&mut renderer)).expect("drawn");
        gpu.device.faults.arm(place, Fault::LostByDriver);
        let lost = |failed| assert_told("frame", Fault::LostByDriver, failed);
        lost(block_on(draw(&mut renderer)));
        lost(block_on(draw(&mut renderer)));
        lost(block_on(renderer.set_scene(&scene())));
        lost(block_on(renderer.read_picture()).map(drop));
    }
}

#[test]
fn an_error_that_no_scope_catches_is_told_by_the_next_call() {
    let gpu = block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let settings = small(48, 32);
    let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
    gpu.device.faults.arm(0, Fault::Invalid);
    drop(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("stray"),
        size: 4,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }));
    assert_told("stray", Fault::Invalid, block_on(draw(&mut renderer)));
    block_on(draw(&mut renderer)).expect("and then it is forgotten");
}
