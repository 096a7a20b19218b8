//! What frames leave behind in the driver. Mesa's lavapipe compiles a shader anew, and keeps the old
//! one, whenever a uniform that alone decides a branch changes (seen with 22.3.6); a branch that
//! `shader/tests/branches.rs` does not see is found here.
#![cfg(all(target_os = "linux", target_env = "gnu"))]
#![allow(
    clippy::print_stdout,
    unsafe_code,
    reason = "a test says what it measured, and asks the C library"
)]

use foveal::{
    Antialiasing, CoarseBackend, Composite, Frame, Geometry, Gpu, Output, Renderer,
    RendererOptions, SamplePattern, Settings, Shading, Shadows, Stereo,
};
use foveal_generate as generate;
use foveal_scene::Scene;
use glam::{Mat4, Vec3};
use pollster::block_on;

/// Bytes that the C library has handed out: the driver's, and the program's own.
fn handed_out() -> usize {
    // SAFETY: it reads the C library's own counters.
    let info = unsafe { libc::mallinfo2() };
    info.uordblks + info.hblkhd
}

/// A name, and what it changes of the defaults.
type Way = (&'static str, fn(&mut Settings));

/// Ways to draw, each different from the defaults in what runs on the device.
fn ways() -> Vec<(&'static str, Settings)> {
    let small = Settings::default().with(|s| {
        s.picture.width = 64;
        s.picture.height = 36;
        s.rate.force = true;
    });
    let ways: [Way; 12] = [
        ("plain", |_| {}),
        ("visibility buffer", |s| {
            s.geometry.path = Geometry::Visibility;
        }),
        ("msaa", |s| s.antialiasing.mode = Antialiasing::Msaa),
        ("msaa over a visibility buffer", |s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.geometry.path = Geometry::Visibility;
        }),
        ("msaa of two eyes", |s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.stereo.mode = Stereo::TwoPass;
            s.stereo.output = Output::SideBySide;
        }),
        ("coarse, composite paper", |s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.composite = Composite::Paper;
        }),
        ("ssaa, rotated", |s| {
            s.antialiasing.mode = Antialiasing::Ssaa;
            s.antialiasing.pattern = SamplePattern::Rotated;
        }),
        ("coarse by stencil", |s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.backend = CoarseBackend::Stencil;
        }),
        ("coarse by compute", |s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.backend = CoarseBackend::Compute;
        }),
        ("variable", |s| s.shading.mode = Shading::Variable),
        ("shadows", |s| s.lighting.shadows = Shadows::Soft),
        ("two eyes", |s| {
            s.stereo.mode = Stereo::Instanced;
            s.stereo.output = Output::Anaglyph;
        }),
    ];
    let of = |(name, change): Way| (name, small.clone().with(change));
    ways.into_iter().map(of).collect()
}

/// Bytes per frame that so many frames of a moving camera leave.
fn left_by(renderer: &mut Renderer, gpu: &Gpu, scene: &Scene, frames: u16) -> usize {
    let mut camera = scene.cameras[0].clone();
    let home = camera.world_from_view;
    let before = handed_out();
    for frame in 0..frames {
        let step = Vec3::new(0.002 * f32::from(frame + 1), 0.0, 0.0);
        camera.world_from_view = Mat4::from_translation(step) * home;
        block_on(renderer.render(&Frame::new(&camera))).expect("it is drawn");
    }
    block_on(renderer.read_picture()).expect("read-back works");
    let wait = wgpu::PollType::wait_indefinitely();
    gpu.device.poll(wait).expect("the device goes on");
    handed_out().saturating_sub(before) / usize::from(frames)
}

#[test]
fn frames_leave_nothing_in_the_driver() {
    let gpu = block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    for name in ["materials-grid", "alpha"] {
        let scene = generate::by_name(name).expect("it is generated");
        for (way, settings) in ways() {
            let renderer = Renderer::new(&gpu, &settings, RendererOptions::default());
            let mut renderer = block_on(renderer).expect("settings fit");
            block_on(renderer.set_scene(&scene)).expect("it fits");
            left_by(&mut renderer, &gpu, &scene, 6);
            // What is allocated once, late, is not left by the next frames.
            let left = (0..3)
                .map(|_| left_by(&mut renderer, &gpu, &scene, 6))
                .min();
            println!("{name}, {way}: {left:?} bytes a frame");
            assert!(left < Some(20_000), "{name}, {way}: {left:?} bytes a frame");
        }
    }
}
