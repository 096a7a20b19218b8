//! Each composite of coarse shading against full shading, by perceptual difference: mean FLIP (Andersson et al. 2020).
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

use foveal::{Composite, Frame, Gpu, Renderer, Settings, Shading};
use foveal_scene::{Scene, generate};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 180;

fn picture(gpu: &Gpu, scene: &Scene, settings: &Settings) -> nv_flip::FlipImageRgb8 {
    let rgba = pollster::block_on(async {
        let mut renderer = Renderer::new(gpu, settings, None)
            .await
            .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        let frame = Frame {
            camera: &scene.cameras[0],
            previous_camera: None,
        };
        renderer.render(&frame).await.expect("drawn");
        renderer.read_picture().await.expect("read back")
    });
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    nv_flip::FlipImageRgb8::with_data(WIDTH, HEIGHT, &rgb)
}

#[test]
fn smooth_is_nearer_to_full_shading_than_paper_in_every_generated_scene() {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    for name in [
        "demo:1000",
        "cornell",
        "materials",
        "materials-grid",
        "alpha",
    ] {
        let mut scene = generate::by_name(name).expect("a generated scene");
        generate::add_point_lights(&mut scene, 20, 3);
        let full = Settings {
            width: WIDTH,
            height: HEIGHT,
            ..Settings::default()
        };
        let reference = picture(&gpu, &scene, &full);
        let [paper, smooth] = [Composite::Paper, Composite::Smooth].map(|composite| {
            let settings = Settings {
                shading: Shading::Coarse,
                composite,
                ..full.clone()
            };
            let coarse = picture(&gpu, &scene, &settings);
            let degrees = nv_flip::DEFAULT_PIXELS_PER_DEGREE;
            let map = nv_flip::flip(reference.clone(), coarse, degrees);
            nv_flip::FlipPool::from_image(&map).mean()
        });
        println!("{name}: paper {paper:.4}, smooth {smooth:.4}");
        assert!(smooth < paper, "{name}: smooth {smooth}, paper {paper}");
    }
}
