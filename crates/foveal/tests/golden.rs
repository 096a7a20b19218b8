//! Whole frames of the generated scenes against small committed pictures.
//!
//! `UPDATE_GOLDEN=1 cargo test -p foveal --test golden` writes them again; look at them before you
//! commit. Adapters round differently, so the comparison is perceptual: mean FLIP (Andersson et al.
//! 2020).

use std::path::PathBuf;

use foveal::{
    DebugView, EnvironmentMap, EnvironmentSource, Frame, Gpu, LightingModel, Renderer, Settings,
    Shadows,
};
use foveal_generate as generate;

/// Two adapters that draw the same picture differ by less, a missing light or texture by far more: of
/// a plain floor each code value counts 0.015.
const MAX_FLIP: f32 = 0.01;
const MAX_FLIP_ON_HARDWARE: f32 = 0.02;
const WIDTH: u32 = 192;
const HEIGHT: u32 = 108;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// The picture, and how far it may be from the golden one.
fn draw(scene: &str, settings: &Settings) -> (Vec<u8>, f32) {
    pollster::block_on(async {
        let scene = generate::by_name(scene).expect("a generated scene");
        let gpu = Gpu::open(None)
            .await
            .expect("the tests need a graphics adapter");
        let mut renderer = Renderer::new(&gpu, settings, foveal::RendererOptions::default())
            .await
            .expect("settings fit");
        if settings.lighting.environment == EnvironmentSource::Image {
            let (width, height, rgb) = generate::surroundings(512);
            let map = EnvironmentMap::new(width, height, &rgb).expect("an environment");
            renderer.set_environment(map).await.expect("it fits");
        }
        renderer.set_scene(&scene).await.expect("scene fits");
        let frame = Frame::new(&scene.cameras[0]);
        renderer.render(&frame).await.expect("drawn");
        let most = match gpu.adapter_stats().kind.as_str() {
            "cpu" => MAX_FLIP,
            _ => MAX_FLIP_ON_HARDWARE,
        };
        let picture = renderer.read_picture().await.expect("read back");
        (picture, most)
    })
}

fn flip_image(rgba: &[u8]) -> nv_flip::FlipImageRgb8 {
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    nv_flip::FlipImageRgb8::with_data(WIDTH, HEIGHT, &rgb)
}

fn flip(a: &[u8], b: &[u8]) -> f32 {
    let map = nv_flip::flip(
        flip_image(a),
        flip_image(b),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    );
    nv_flip::FlipPool::from_image(&map).mean()
}

fn assert_golden(name: &str, scene: &str, settings: Settings) {
    let settings = settings.with(|s| {
        s.picture.width = WIDTH;
        s.picture.height = HEIGHT;
    });
    let (drawn, most) = draw(scene, &settings);
    let golden = folder().join(format!("{name}.png"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        image::save_buffer(&golden, &drawn, WIDTH, HEIGHT, image::ColorType::Rgba8)
            .expect("written");
        return;
    }
    let expected = image::open(&golden)
        .expect("the golden picture is there")
        .into_rgba8();
    let difference = flip(&expected, &drawn);
    if difference > most {
        let actual = std::env::temp_dir().join(format!("foveal-golden-{name}.png"));
        image::save_buffer(&actual, &drawn, WIDTH, HEIGHT, image::ColorType::Rgba8)
            .expect("written");
        panic!(
            "{name}: mean FLIP {difference} is above {most}; the picture drawn is {}",
            actual.display()
        );
    }
}

#[test]
fn cornell_looks_as_it_should() {
    assert_golden("cornell", "cornell", Settings::default());
}

#[test]
fn blinn_phong_looks_as_it_should() {
    let settings = Settings::default().with(|s| s.lighting.model = LightingModel::BlinnPhong);
    assert_golden("cornell-blinn-phong", "cornell", settings);
}

#[test]
fn metals_and_roughness_look_as_they_should() {
    assert_golden("materials-grid", "materials-grid", Settings::default());
}

#[test]
fn surroundings_light_metals_as_they_should() {
    let settings = Settings::default().with(|s| s.lighting.environment = EnvironmentSource::Image);
    assert_golden("materials-grid-surroundings", "materials-grid", settings);
}

#[test]
fn a_filtered_sky_has_no_horizon_in_rough_metal() {
    let settings = Settings::default().with(|s| s.lighting.environment = EnvironmentSource::Sky);
    assert_golden("materials-grid-sky", "materials-grid", settings);
}

#[test]
fn masks_blending_and_mirroring_look_as_they_should() {
    assert_golden("alpha", "alpha", Settings::default());
}

#[test]
fn shadows_look_as_they_should() {
    let settings = Settings::default().with(|s| s.lighting.shadows = Shadows::Soft);
    assert_golden("cornell-shadows", "cornell", settings.clone());
    assert_golden("alpha-shadows", "alpha", settings);
}

#[test]
fn normals_look_as_they_should() {
    assert_golden(
        "alpha-normals",
        "alpha",
        Settings::default().with(|s| s.picture.view = DebugView::Normals),
    );
}

#[test]
fn different_pictures_are_told_apart() {
    let settings = Settings::default().with(|s| {
        s.picture.width = WIDTH;
        s.picture.height = HEIGHT;
    });
    let (cornell, _) = draw("cornell", &settings);
    let (brighter, _) = draw(
        "cornell",
        &settings.with(|s| s.picture.exposure_stops = 0.3),
    );
    assert!(flip(&cornell, &brighter) > MAX_FLIP);
}
