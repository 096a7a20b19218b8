//! The renderer in a host that has its own device, its own textures and its own passes:
//! `cargo run -p foveal --example embed -- [SCENE] [OUT.png]`.
//!
//! The host opens the device, and draws a frame of its own around what the renderer draws into its
//! texture. Nothing waits for the device until the host reads its texture back to write the
//! picture.

#![allow(clippy::print_stdout, reason = "an example says what it made")]

use foveal::{Frame, Gpu, Renderer, Settings, Target};
use foveal_generate as generate;

/// The host's texture: larger than the rendered picture, and sRGB, as a window's often is.
const SIZE: (u32, u32) = (640, 360);
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "cornell".to_owned());
    let pixels = embed(&scene)?;
    if let Some(path) = arguments.next() {
        image::save_buffer(&path, &pixels, SIZE.0, SIZE.1, image::ColorType::Rgba8)?;
        println!("{path}");
    }
    Ok(())
}

/// The host's texture after a few frames: rows of RGBA.
fn embed(scene: &str) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let scene = generate::by_name(scene)?;
    pollster::block_on(async {
        // The host's business: instance, adapter, device, texture.
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance.request_adapter(&Default::default()).await?;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                required_features: Gpu::wanted_features() & adapter.features(),
                required_limits: Gpu::required_limits(),
                ..Default::default()
            })
            .await?;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("the host's"),
            size: wgpu::Extent3d {
                width: SIZE.0,
                height: SIZE.1,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());

        // The renderer on the host's device.
        let gpu = Gpu::from_device(device.clone(), queue.clone());
        let settings = Settings::default().with(|s| {
            s.picture.width = 320;
            s.picture.height = 180;
        });
        let mut renderer =
            Renderer::new(&gpu, &settings, foveal::RendererOptions::default()).await?;
        renderer.set_scene(&scene).await?;
        let camera = scene
            .cameras
            .first()
            .cloned()
            .unwrap_or_else(|| scene.overview_camera());
        let frame = Frame::new(&camera);
        let target = Target {
            view: &view,
            format: FORMAT,
        };
        // A few frames, as a host's loop draws them; figures come when the device is done with a
        // frame.
        let mut figures = None;
        for _ in 0..100 {
            if let Some(stats) = renderer.render_to(&frame, target).await? {
                figures = Some(stats);
                break;
            }
        }
        match figures {
            Some(stats) => println!(
                "{} draws, {} lighting evaluations",
                stats.draws, stats.shaded_samples
            ),
            None => println!("no frame was finished while a hundred were submitted"),
        }

        read_back(&device, &queue, &texture)
    })
}

/// The host's own way to its texture's bytes; 640 pixels make rows of whole 256 bytes.
fn read_back(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIZE.0 * SIZE.1 * 4),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(SIZE.0 * 4),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| ());
    device.poll(wgpu::PollType::wait_indefinitely())?;
    Ok(buffer.get_mapped_range(..)?.to_vec())
}

#[test]
fn the_host_gets_the_picture_over_its_whole_texture() {
    let pixels = embed("cornell").expect("the example runs");
    let pixels = pixels.as_chunks::<4>().0;
    assert_eq!(pixels.len() as u32, SIZE.0 * SIZE.1);
    let lit = pixels.iter().filter(|p| p[..3] != [0; 3]).count();
    assert!(lit > pixels.len() * 9 / 10, "{lit} are lit");
    // The red wall stands on the left, the green one on the right.
    let at = |x: u32, y: u32| pixels[(y * SIZE.0 + x) as usize];
    let (left, right) = (at(SIZE.0 / 4, SIZE.1 / 2), at(SIZE.0 * 5 / 6, SIZE.1 / 2));
    assert!(
        left[0] > left[1] && right[1] > right[0],
        "{left:?} {right:?}"
    );
}
