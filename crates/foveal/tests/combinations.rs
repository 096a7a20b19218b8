//! Every way of shading with every anti-aliasing, over both geometries, for one eye and for two: what is not refused draws
//! what full shading of the same kind draws, nearly.
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

use foveal::{
    Antialiasing, Frame, Geometry, Gpu, Output, RateSource, Renderer, Settings, Shading, Stereo,
};
use foveal_scene::{Scene, generate};

/// Until rates that follow the picture have settled.
const FRAMES: u32 = 4;

/// A picture and its size; `None` where the settings are refused.
fn picture(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Option<nv_flip::FlipImageRgb8> {
    settings.validate(&gpu.device.limits()).ok()?;
    let camera = &scene.cameras[0];
    let rgba = pollster::block_on(async {
        let mut renderer = Renderer::new(gpu, settings, None)
            .await
            .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        for _ in 0..FRAMES {
            let frame = Frame {
                camera,
                previous_camera: Some(camera),
            };
            renderer.render(&frame).await.expect("drawn");
        }
        renderer.read_picture().await.expect("read back")
    });
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    let (width, height) = settings.picture_size();
    Some(nv_flip::FlipImageRgb8::with_data(width, height, &rgb))
}

fn flip(a: &nv_flip::FlipImageRgb8, b: &nv_flip::FlipImageRgb8) -> f32 {
    let map = nv_flip::flip(a.clone(), b.clone(), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&map).mean()
}

/// All shadings and geometries for one anti-aliasing.
fn compare(aa: Antialiasing, stereo: Stereo) {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 8, 3);
    let plain = Settings {
        width: 160,
        height: 90,
        aa,
        stereo,
        show: match stereo {
            Stereo::Off => Output::Flat,
            _ => Output::SideBySide,
        },
        ..Settings::default()
    };
    let reference = picture(&gpu, &scene, &plain).expect("full shading is never refused");
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        for shading in [Shading::Full, Shading::Coarse, Shading::Variable] {
            let settings = Settings {
                geometry,
                shading,
                rate: match shading {
                    Shading::Variable => RateSource::Content,
                    _ => RateSource::Foveated,
                },
                force_rate: true,
                // Blocks as large as 4 x 4: the picture is small.
                coarsest_level: 2,
                ..plain.clone()
            };
            let Some(drawn) = picture(&gpu, &scene, &settings) else {
                panic!("{geometry:?}, {shading:?}, {aa:?}, {stereo:?} is refused");
            };
            let error = flip(&reference, &drawn);
            println!("{geometry:?}, {shading:?}, {aa:?}, {stereo:?}: {error:.4}");
            // Over a visibility buffer a pixel's materials are averaged by surface, not by sub-sample.
            let most = match shading {
                Shading::Full => 0.003,
                Shading::Coarse => 0.045,
                Shading::Variable => 0.02,
            };
            assert!(
                error <= most,
                "{geometry:?}, {shading:?}, {aa:?}, {stereo:?}: {error}"
            );
        }
    }
}

#[test]
fn all_shadings_without_antialiasing() {
    compare(Antialiasing::None, Stereo::Off);
}

#[test]
fn all_shadings_with_msaa() {
    compare(Antialiasing::Msaa, Stereo::Off);
}

#[test]
fn all_shadings_with_ssaa() {
    compare(Antialiasing::Ssaa, Stereo::Off);
}

#[test]
fn all_shadings_for_two_eyes() {
    compare(Antialiasing::None, Stereo::Instanced);
}

#[test]
fn all_shadings_for_two_eyes_with_msaa() {
    compare(Antialiasing::Msaa, Stereo::Instanced);
}
