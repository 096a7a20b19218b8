//! The visibility buffer's pictures against the rasterizer's, by FLIP, on generated scenes and on
//! those of others where they are at hand.
#![allow(
    clippy::print_stdout,
    reason = "a test says what it skipped and what it measured"
)]

use std::path::Path;

use foveal::{Frame, Geometry, Gpu, Renderer, Settings};
use foveal_generate as generate;
use foveal_scene::{LoadOptions, Scene};

/// Mean FLIP that rounding and derivatives at silhouettes may cost.
const MAX_FLIP: f32 = 0.005;
/// The same where hardware filters textures.
const MAX_FLIP_ON_HARDWARE: f32 = 0.006;
const WIDTH: u32 = 240;
const HEIGHT: u32 = 135;

fn picture(renderer: &mut Renderer, scene: &Scene) -> nv_flip::FlipImageRgb8 {
    let camera = scene
        .cameras
        .first()
        .cloned()
        .unwrap_or_else(|| scene.overview_camera());
    let rgba = pollster::block_on(async {
        renderer.set_scene(scene).await.expect("the scene fits");
        let frame = Frame::new(&camera);
        renderer.render(&frame).await.expect("drawn");
        renderer.read_picture().await.expect("read back")
    });
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    nv_flip::FlipImageRgb8::with_data(WIDTH, HEIGHT, &rgb)
}

/// A renderer by each geometry, and the most mean FLIP between them.
fn renderers() -> ([Renderer; 2], f32) {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let most = match gpu.adapter_stats().kind.as_str() {
        "cpu" => MAX_FLIP,
        _ => MAX_FLIP_ON_HARDWARE,
    };
    let renderers = [Geometry::Gbuffer, Geometry::Visibility].map(|geometry| {
        let settings = Settings::default().with(|s| {
            s.picture.width = WIDTH;
            s.picture.height = HEIGHT;
            s.geometry.path = geometry;
            // Anisotropic filters differ by the derivatives that they are told.
            s.lighting.anisotropy = 1;
        });
        pollster::block_on(Renderer::new(
            &gpu,
            &settings,
            foveal::RendererOptions::default(),
        ))
        .expect("settings fit")
    });
    (renderers, most)
}

fn assert_alike((renderers, most): &mut ([Renderer; 2], f32), name: &str, scene: &Scene) {
    let [raster, triangles] = renderers.each_mut().map(|r| picture(r, scene));
    let map = nv_flip::flip(raster, triangles, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    let mean = nv_flip::FlipPool::from_image(&map).mean();
    println!("{name}: mean FLIP {mean:.5}");
    assert!(mean < *most, "{name}: mean FLIP {mean}");
}

#[test]
fn generated_scenes_look_the_same_on_both_geometries() {
    let mut renderers = renderers();
    for name in ["cornell", "materials-grid", "alpha", "demo:1000"] {
        let scene = generate::by_name(name).expect("a generated scene");
        assert_alike(&mut renderers, name, &scene);
    }
}

#[test]
fn shared_scenes_look_the_same_on_both_geometries() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let mut renderers = renderers();
    for folder in ["samples", "scenes"] {
        let Ok(files) = std::fs::read_dir(shared.join(folder)) else {
            println!("skipped: {} is not there", shared.join(folder).display());
            continue;
        };
        for path in files.flatten().map(|f| f.path()) {
            if path.extension().is_none_or(|e| e != "glb") {
                continue;
            }
            let mut scene =
                foveal_scene::load(&path, &LoadOptions::default()).expect("the file loads");
            scene.light_by_default();
            assert_alike(&mut renderers, &path.display().to_string(), &scene);
        }
    }
}
