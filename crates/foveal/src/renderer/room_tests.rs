//! Room for the surfaces of edges, which grows after a frame that lacked it.

use foveal_generate as generate;
use pollster::block_on;

use crate::gpu::faults::Fault;
use crate::testing::{gpu, gpu_with, small};
use crate::{Antialiasing, Frame, Geometry, Renderer, RendererOptions, Shading, Stereo};

#[test]
fn without_memory_for_more_room_frames_go_on_with_the_room_there_is() {
    let scene = generate::cornell();
    let gpu = gpu_with(gpu().device.features(), gpu().device.limits());
    let frame = Frame::new(&scene.cameras[0]);
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = small(200, 120).with(|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.geometry.path = geometry;
        });
        let renderer = Renderer::new(&gpu, &settings, RendererOptions::default());
        let mut renderer = block_on(renderer).unwrap();
        block_on(renderer.set_scene(&scene)).unwrap();
        block_on(renderer.render(&frame)).unwrap();
        let faults = gpu.device.faults.clone();
        faults.disarm();
        renderer.cut_room_for_edges();
        let before = faults.calls();
        block_on(renderer.render(&frame)).unwrap();
        let calls = faults.calls() - before;

        renderer.cut_room_for_edges();
        // The last call makes room.
        faults.arm(calls - 1, Fault::OutOfMemory);
        let stats = block_on(renderer.render(&frame)).unwrap();
        assert!(stats.surfaces_left_out > 0);
        assert!(faults.disarm(), "memory ran out");
        let left_out = stats.surfaces_left_out;
        for _ in 0..2 {
            let stats = block_on(renderer.render(&frame)).unwrap();
            assert_eq!(stats.surfaces_left_out, left_out);
        }
        // Other settings are another try.
        let larger = settings.with(|s| s.picture.width += 1);
        block_on(renderer.set_settings(&larger)).unwrap();
        renderer.cut_room_for_edges();
        block_on(renderer.render(&frame)).unwrap();
        let stats = block_on(renderer.render(&frame)).unwrap();
        assert_eq!(stats.surfaces_left_out, 0);
    }
}

#[test]
fn columns_between_the_eyes_are_no_edges() {
    let scene = generate::cornell();
    for shading in [Shading::Full, Shading::Coarse] {
        // Coarse blocks begin anew in the right eye's picture.
        let settings = small(157, 101).with(|s| {
            s.antialiasing.mode = Antialiasing::Ssaa;
            s.stereo.mode = Stereo::Instanced;
            s.shading.mode = shading;
        });
        let renderer = Renderer::new(gpu(), &settings, RendererOptions::default());
        let mut renderer = block_on(renderer).unwrap();
        block_on(renderer.set_scene(&scene)).unwrap();
        let stats = block_on(renderer.render(&Frame::new(&scene.cameras[0]))).unwrap();
        assert_eq!(stats.edge_fraction, 1.0);
        let coarse = stats.coarse.map_or(0, |coarse| coarse.shaded_samples());
        assert_eq!(stats.shaded_samples - coarse, 2 * 157 * 101 * 4);
    }
}
