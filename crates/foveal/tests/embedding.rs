//! The renderer as a guest on the host's device.

#[path = "common/host.rs"]
mod host;

use foveal::glam::{Mat4, Vec3, Vec4};
use foveal::{
    Antialiasing, Error, Frame, Gpu, Renderer, RendererOptions, Settings, Shading, Stereo, Target,
};
use foveal_generate as generate;

fn clock() -> u64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    let start = START.get_or_init(std::time::Instant::now);
    start.elapsed().as_nanos() as u64
}

fn host(limits: wgpu::Limits) -> (wgpu::Device, wgpu::Queue) {
    host::device(Gpu::wanted_features(), limits)
}

fn texture(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: 64,
            height: 40,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn bytes(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<u8> {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64 * 40 * 4,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(256),
        rows_per_image: None,
    };
    let into = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout,
    };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| ());
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("done");
    buffer.get_mapped_range(..).expect("mapped").to_vec()
}

/// Renders into textures of the host's, and gives its frames' figures with those of a frame that
/// waited.
#[test]
fn the_hosts_texture_gets_the_picture_and_the_figures_follow() {
    let (device, queue) = host(Gpu::required_limits());
    let gpu = Gpu::from_device(device.clone(), queue.clone());
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    for (shading, aa) in [
        (Shading::Full, Antialiasing::None),
        (Shading::Coarse, Antialiasing::None),
        (Shading::Full, Antialiasing::Msaa),
    ] {
        let settings = Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 40;
            s.shading.mode = shading;
            s.antialiasing.mode = aa;
            s.coarse.backend = foveal::CoarseBackend::Compute;
            // Each frame is the first one's equal.
            s.coarse.history = false;
            s.rate.force = true;
            s.culling.mode = foveal::Culling::Frustum;
        });
        pollster::block_on(async {
            let mut renderer = Renderer::new(
                &gpu,
                &settings,
                RendererOptions::default().with_clock(clock),
            )
            .await
            .expect("fits");
            renderer.set_scene(&scene).await.expect("fits");
            let waited = renderer.render(&frame).await.expect("drawn");
            let expected = renderer.read_picture().await.expect("read");
            for format in [
                wgpu::TextureFormat::Rgba8Unorm,
                wgpu::TextureFormat::Rgba8UnormSrgb,
            ] {
                let texture = texture(&device, format);
                let view = texture.create_view(&Default::default());
                let target = Target {
                    view: &view,
                    format,
                };
                let mut figures = None;
                for _ in 0..1000 {
                    figures = renderer.render_to(&frame, target).await.expect("drawn");
                    if figures.is_some() {
                        break;
                    }
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
                let figures = figures.expect("a frame is finished within two seconds");
                assert_eq!(figures.shaded_samples, waited.shaded_samples);
                assert_eq!(figures.edge_fraction, waited.edge_fraction);
                assert_eq!(figures.draws, waited.draws);
                assert_eq!(figures.gpu_ms.is_empty(), waited.gpu_ms.is_empty());
                assert!(figures.frame_ms > 0.0);
                let shown = bytes(&device, &queue, &texture);
                let difference = shown
                    .iter()
                    .zip(&expected)
                    .map(|(a, b)| a.abs_diff(*b))
                    .max();
                let most = u8::from(format.is_srgb());
                assert!(difference <= Some(most), "{format:?}: {difference:?}");
            }
        });
    }
}

#[test]
fn a_host_with_too_little_is_told_what_is_missing() {
    let (device, queue) = host(wgpu::Limits {
        max_storage_buffers_per_shader_stage: 4,
        ..wgpu::Limits::default()
    });
    let gpu = Gpu::from_device(device, queue);
    let error = pollster::block_on(Renderer::new(
        &gpu,
        &Settings::default(),
        RendererOptions::default(),
    ));
    let error = error.expect_err("four storage buffers are too few");
    assert!(matches!(error, Error::Limit { .. }), "{error}");
    assert!(
        error
            .to_string()
            .contains("max_storage_buffers_per_shader_stage"),
        "{error}"
    );
}

#[test]
fn the_hosts_own_handlers_stay_in_place() {
    let (device, queue) = host(Gpu::required_limits());
    let (sender, lost) = std::sync::mpsc::channel();
    device.set_device_lost_callback(move |_, _| {
        let _ = sender.send(());
    });
    let gpu = Gpu::from_device(device.clone(), queue);
    let settings = Settings::default().with(|s| {
        s.picture.width = 32;
        s.picture.height = 32;
    });
    let mut renderer =
        pollster::block_on(Renderer::new(&gpu, &settings, RendererOptions::default()))
            .expect("fits");
    device.destroy();
    let _ = device.poll(wgpu::PollType::wait_indefinitely());
    lost.recv().expect("the host's callback was called");
    gpu.note_loss("the host said so");
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    let error = pollster::block_on(renderer.render(&frame)).expect_err("the device is gone");
    assert!(error.to_string().contains("the host said so"), "{error}");
}

/// Whatever a future waits for, it holds nothing meanwhile that belongs to a thread: a host may poll
/// it anywhere, and other futures of the same device in between.
#[test]
fn futures_of_the_renderer_run_on_any_thread() {
    fn elsewhere<T: Send>(future: impl Future<Output = T> + Send) -> T {
        let run = || pollster::block_on(future);
        std::thread::scope(|scope| scope.spawn(run).join()).expect("no panic")
    }
    let gpu = elsewhere(Gpu::open(None)).expect("the tests need a graphics adapter");
    let settings = Settings::default().with(|s| {
        s.picture.width = 64;
        s.picture.height = 40;
        s.shading.mode = Shading::Coarse;
        s.rate.force = true;
    });
    let new = Renderer::new(&gpu, &settings, RendererOptions::default());
    let mut renderer = elsewhere(new).expect("made");
    let scene = generate::cornell();
    elsewhere(renderer.set_scene(&scene)).expect("uploaded");
    elsewhere(renderer.update_pose(&scene)).expect("uploaded");
    let (width, height, rgb) = generate::surroundings(8);
    let map = foveal::EnvironmentMap::new(width, height, &rgb).expect("it is a map");
    elsewhere(renderer.set_environment(map)).expect("uploaded");
    let frame = Frame::new(&scene.cameras[0]);
    elsewhere(renderer.render(&frame)).expect("drawn");
    let picture = elsewhere(renderer.read_picture()).expect("read");
    elsewhere(renderer.read_radiance()).expect("read");
    let texture = texture(&gpu.device, wgpu::TextureFormat::Rgba8Unorm);
    let view = texture.create_view(&Default::default());
    let target = Target {
        view: &view,
        format: texture.format(),
    };
    elsewhere(renderer.render_to(&frame, target)).expect("drawn");
    // Two eyes are tried out first.
    let stereo = settings.clone().with(|s| s.stereo.mode = Stereo::Instanced);
    elsewhere(renderer.set_settings(&stereo)).expect("made");
    elsewhere(renderer.set_settings(&settings)).expect("made");
    elsewhere(renderer.render(&frame)).expect("drawn");
    assert!(elsewhere(renderer.read_picture()).expect("read") == picture);
}

#[test]
fn a_waited_frame_s_times_are_its_own_after_frames_that_were_not_waited_for() {
    let (device, queue) = host(Gpu::required_limits());
    let gpu = Gpu::from_device(device.clone(), queue.clone());
    let [unlit, lit] = [foveal::DebugView::Depth, foveal::DebugView::Final].map(|view| {
        Settings::default().with(|s| {
            (s.picture.width, s.picture.height) = (64, 40);
            s.picture.view = view;
        })
    });
    let scene = generate::cornell();
    let frame = Frame::new(&scene.cameras[0]);
    let texture = texture(&device, wgpu::TextureFormat::Rgba8Unorm);
    let view = texture.create_view(&Default::default());
    let target = Target {
        view: &view,
        format: texture.format(),
    };
    let passes = |renderer: &mut Renderer| {
        let stats = pollster::block_on(renderer.render(&frame)).expect("drawn");
        stats.gpu_ms.into_iter().map(|t| t.name).collect::<Vec<_>>()
    };
    pollster::block_on(async {
        let new = Renderer::new(&gpu, &lit, RendererOptions::default());
        let mut renderer = new.await.expect("made");
        renderer.set_scene(&scene).await.expect("uploaded");
        let expected = passes(&mut renderer);
        renderer.set_settings(&unlit).await.expect("made");
        assert_ne!(passes(&mut renderer), expected);
        for _ in 0..3 {
            renderer.render_to(&frame, target).await.expect("drawn");
        }
        renderer.set_settings(&lit).await.expect("made");
        assert_eq!(passes(&mut renderer), expected);
    });
}

#[test]
fn cameras_that_make_no_sense_are_refused() {
    let (device, queue) = host(Gpu::required_limits());
    let gpu = Gpu::from_device(device.clone(), queue.clone());
    let scene = generate::cornell();
    let camera = |height_m: f32, x: f32| {
        let mut camera = scene.cameras[0].clone();
        camera.projection = foveal_scene::Projection::Orthographic {
            height_m,
            near_m: 0.0,
            far_m: 10.0,
        };
        camera.world_from_view.w_axis.x = x;
        camera
    };
    let settings = Settings::default().with(|s| (s.picture.width, s.picture.height) = (64, 40));
    pollster::block_on(async {
        let new = Renderer::new(&gpu, &settings, RendererOptions::default());
        let mut renderer = new.await.expect("made");
        renderer.set_scene(&scene).await.expect("uploaded");
        let sound = camera(4.0, 0.0);
        renderer.render(&Frame::new(&sound)).await.expect("drawn");
        let mut rounded = sound.clone();
        rounded.world_from_view = sound.world_from_view.inverse().inverse();
        renderer.render(&Frame::new(&rounded)).await.expect("drawn");
        let wrong = [0.0, -1.0, f32::NAN, f32::INFINITY].map(|height_m| camera(height_m, 0.0));
        // Lights and culling measure in view space: a scaled one is not the world's.
        let shear = Mat4::from_cols(Vec4::X, Vec4::new(0.1, 1.0, 0.0, 0.0), Vec4::Z, Vec4::W);
        let placed = [
            Mat4::from_scale(Vec3::splat(2.0)),
            Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)),
            shear,
            shear.transpose(),
            Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, 1.0, 0.1), Vec4::W),
            Mat4::ZERO,
        ]
        .map(|by| {
            let mut camera = camera(4.0, 0.0);
            camera.world_from_view *= by;
            camera
        });
        // Each number is sound by itself.
        let seen = |projection, x| {
            let mut camera = camera(4.0, x);
            camera.projection = projection;
            camera
        };
        let (fov_y_rad, near_m) = (1e-40, 0.1);
        let endless = foveal_scene::Projection::Orthographic {
            height_m: 4.0,
            near_m: f32::MIN,
            far_m: f32::MAX,
        };
        let narrow = |fov_y_rad| foveal_scene::Projection::Perspective { fov_y_rad, near_m };
        let beyond = [
            seen(narrow(fov_y_rad), 0.0),
            seen(narrow(0.5), f32::MAX),
            seen(endless, 0.0),
            camera(1e-40, 0.0),
        ];
        for camera in [&wrong[..], &placed, &beyond, &[camera(4.0, f32::NAN)]].concat() {
            let error = renderer.render(&Frame::new(&camera)).await.unwrap_err();
            assert!(
                matches!(error, Error::Setting { name: "camera", .. }),
                "{error}"
            );
        }
        renderer.render(&Frame::new(&sound)).await.expect("drawn");
    });
}
