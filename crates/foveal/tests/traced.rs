//! Light and shadow held to a reference that traces rays.
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

mod trace;

use foveal::{
    AmbientOcclusion, Background, EnvironmentMap, EnvironmentSource, Frame, Gpu, Renderer,
    RendererOptions, Settings, Shadows, ToneMap,
};
use foveal_generate as generate;
use foveal_scene::{AlphaMode, Material, Scene};
use glam::Vec3;
use trace::{Around, Reference};

/// Width and height of the pictures; `FOVEAL_TRACED_HEIGHT` is another height, for measuring.
fn size() -> (u32, u32) {
    let asked = std::env::var("FOVEAL_TRACED_HEIGHT").ok();
    let height = asked.map_or(108, |height| height.parse().expect("a height in pixels"));
    (height * 16 / 9, height)
}

fn srgb(linear: f32) -> u8 {
    let v = linear.clamp(0.0, 1.0);
    let encoded = if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}

fn flip_image(radiance: impl Iterator<Item = Vec3>) -> nv_flip::FlipImageRgb8 {
    let rgb: Vec<u8> = radiance.flat_map(|p| p.to_array().map(srgb)).collect();
    let (width, height) = size();
    nv_flip::FlipImageRgb8::with_data(width, height, &rgb)
}

/// A court, no brighter than `most`.
fn surroundings(most: f32) -> (u32, u32, Vec<[f32; 3]>) {
    let (width, height, rgb) = generate::surroundings(1024);
    let capped = rgb.into_iter().map(|t| t.map(|v| v.min(most)));
    (width, height, capped.collect())
}

/// Mean FLIP error between the renderer's picture, with the court no brighter than `most`, and the
/// reference's.
fn flip(scene: &Scene, settings: Settings, most: f32, reference: &Reference<'_>) -> f32 {
    let (width, height) = size();
    let traced = reference.picture(&scene.cameras[0], width, height);
    flip_to(scene, settings, most, (reference.occludes, &traced))
}

/// The same, with the reference's picture.
fn flip_to(
    scene: &Scene,
    settings: Settings,
    most: f32,
    (occludes, traced): (bool, &[Vec3]),
) -> f32 {
    let camera = &scene.cameras[0];
    let (width, height) = size();
    let settings = settings.with(|s| {
        (s.picture.width, s.picture.height) = (width, height);
        s.picture.tone_map = ToneMap::Linear;
        s.lighting.background = Background::None;
        // The reference counts one bounce between microfacets.
        s.lighting.multiple_scattering = false;
    });
    let drawn = pollster::block_on(async {
        let gpu = Gpu::open(None)
            .await
            .expect("the tests need a graphics adapter");
        let mut renderer = Renderer::new(&gpu, &settings, RendererOptions::default())
            .await
            .expect("settings fit");
        if settings.lighting.environment == EnvironmentSource::Image {
            let (width, height, rgb) = surroundings(most);
            let map = EnvironmentMap::new(width, height, &rgb).expect("an environment");
            renderer.set_environment(map).await.expect("it fits");
        }
        renderer.set_scene(scene).await.expect("scene fits");
        renderer.render(&Frame::new(camera)).await.expect("drawn");
        renderer.read_radiance().await.expect("read back")
    });
    let drawn = drawn.rgb.into_iter().map(Vec3::from);
    if let Some(folder) = std::env::var_os("FOVEAL_TRACED") {
        let lighting = &settings.lighting;
        let what = (
            lighting.environment,
            lighting.shadows,
            occludes,
            lighting.ambient_occlusion,
            most,
        );
        let name = format!("{}-{what:?}.png", scene.name);
        let name = std::path::Path::new(&folder).join(name);
        let both = drawn.clone().chain(traced.iter().copied());
        let bytes: Vec<u8> = both.flat_map(|p| p.to_array().map(srgb)).collect();
        image::save_buffer(name, &bytes, width, 2 * height, image::ColorType::Rgb8)
            .expect("written");
    }
    let map = nv_flip::flip(
        flip_image(traced.iter().copied()),
        flip_image(drawn),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    );
    nv_flip::FlipPool::from_image(&map).mean()
}

/// Without textures.
fn plain(material: &Material) -> Material {
    Material {
        base_color: material.base_color,
        metallic: material.metallic,
        roughness: material.roughness,
        emissive: material.emissive,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        ..Material::default()
    }
}

#[test]
fn metals_in_an_environment_are_nearly_as_traced() {
    let mut scene = generate::materials_grid();
    scene.lights.clear();
    let settings = Settings::default().with(|s| s.lighting.environment = EnvironmentSource::Image);
    // Without a sun, and with one of a radiance of 5,000, which irradiance of order 2 blurs.
    for (brightest, most) in [(20.0, 0.025), (1e9, 0.1)] {
        let (width, height, rgb) = surroundings(brightest);
        let around = Around::new(width, height, rgb);
        let mut reference = Reference::new(&scene);
        reference.around = Some(&around);
        let error = flip(&scene, settings.clone(), brightest, &reference);
        // The test can tell environments apart.
        let sky = settings
            .clone()
            .with(|s| s.lighting.environment = EnvironmentSource::Sky);
        let other = flip(&scene, sky, brightest, &reference);
        println!(
            "materials-grid, radiance up to {brightest}: FLIP {error:.4}; {other:.4} in another environment"
        );
        assert!(error <= most, "{error}");
        assert!(other > 2.0 * error, "{other}");
        if brightest < 100.0 {
            reference.occludes = true;
            let occluded = flip(&scene, settings.clone(), brightest, &reference);
            println!("FLIP {occluded:.4} where spheres occlude each other");
        }
    }
}

#[test]
fn reflections_of_all_strengths_and_colours_are_nearly_as_traced() {
    let mut scene = generate::materials_grid();
    let plain = scene.clone();
    for (i, material) in (0..).zip(&mut scene.materials) {
        material.metallic *= 0.5;
        material.ior = [1.33, 1.8, 2.4][i % 3];
        material.specular = [1.0, 0.5, 0.0, 1.0][i % 4];
        material.specular_color = [Vec3::ONE, Vec3::new(3.0, 1.0, 0.5)][i / 2 % 2];
    }
    let (width, height, rgb) = surroundings(20.0);
    let around = Around::new(width, height, rgb);
    let mut reference = Reference::new(&scene);
    reference.around = Some(&around);
    let settings = Settings::default().with(|s| s.lighting.environment = EnvironmentSource::Image);
    let error = flip(&scene, settings.clone(), 20.0, &reference);
    let other = flip(&plain, settings, 20.0, &reference);
    println!("ior and specular: FLIP {error:.4}; {other:.4} without them");
    assert!(error <= 0.03, "{error}");
    assert!(other > 2.0 * error, "{other}");
}

#[test]
fn shadows_of_lights_are_nearly_as_traced() {
    for (name, most) in [("cornell", 0.04), ("demo:1000", 0.1)] {
        let mut scene = generate::by_name(name).expect("a generated scene");
        scene.materials = scene.materials.iter().map(plain).collect();
        let settings = Settings::default().with(|s| {
            s.lighting.environment = EnvironmentSource::None;
            s.lighting.shadows = Shadows::Soft;
        });
        let reference = Reference::new(&scene);
        let error = flip(&scene, settings.clone(), 0.0, &reference);
        let finer = (settings.clone()).with(|s| s.lighting.shadow_texel_px = 1.0);
        let finer = flip(&scene, finer, 0.0, &reference);
        let off = settings.with(|s| s.lighting.shadows = Shadows::Off);
        let off = flip(&scene, off, 0.0, &reference);
        println!("{name}: FLIP {error:.4}; {finer:.4} by finer texels; {off:.4} without shadows");
        assert!(error <= most, "{name}: {error}");
        assert!(finer < error, "{name}: {finer}, {error}");
        assert!(off > 2.0 * error, "{name}: {off}");
    }
}

#[test]
fn shadows_of_lamps_are_nearer_to_traced_ones_where_they_fade_by_contact() {
    let mut scene = generate::by_name("cornell").expect("a generated scene");
    scene.materials = scene.materials.iter().map(plain).collect();
    let (radius, angle) = (0.15, 6.0_f32);
    let settings = |shadows| {
        Settings::default().with(|s| {
            s.lighting.environment = EnvironmentSource::None;
            s.lighting.shadows = shadows;
            s.lighting.light_radius_m = radius;
            s.lighting.sun_angle_deg = angle;
        })
    };
    let mut reference = Reference::new(&scene);
    reference.lamps = [radius, (0.5 * angle).to_radians().tan()];
    let [soft, contact] = [Shadows::Soft, Shadows::Contact]
        .map(|shadows| flip(&scene, settings(shadows), 0.0, &reference));
    println!("lamps with a size: FLIP {contact:.4}; {soft:.4} with filters of one width");
    assert!(contact < 0.9 * soft, "{contact}, {soft}");
}

#[test]
fn ambient_occlusion_brings_the_environments_light_nearer_to_what_is_traced() {
    let (width, height, rgb) = surroundings(3.0);
    let around = Around::new(width, height, rgb);
    // Rooms stay too bright: what is beside the picture, and behind what is seen, is not found.
    for (name, most) in [("materials-grid", 0.92), ("demo:1000", 0.98)] {
        let mut scene = generate::by_name(name).expect("a generated scene");
        scene.materials = scene.materials.iter().map(plain).collect();
        for material in &mut scene.materials {
            material.emissive = Vec3::ZERO;
        }
        scene.lights.clear();
        let mut reference = Reference::new(&scene);
        reference.around = Some(&around);
        reference.occludes = true;
        let (wide, high) = size();
        let traced = reference.picture(&scene.cameras[0], wide, high);
        let error = |occlusion, radius| {
            let settings = Settings::default().with(|s| {
                s.lighting.environment = EnvironmentSource::Image;
                s.lighting.ambient_occlusion = occlusion;
                s.lighting.ambient_occlusion_radius_m = radius;
            });
            flip_to(&scene, settings, 3.0, (true, &traced))
        };
        let open = error(AmbientOcclusion::Off, 0.0);
        let found = error(AmbientOcclusion::Screen, 0.0);
        println!("{name}: FLIP {found:.4}; {open:.4} without ambient occlusion");
        for radius in [0.25, 1.0, 4.0] {
            let found = error(AmbientOcclusion::Screen, radius);
            println!("  radius {radius} m: {found:.4}");
        }
        assert!(found <= most * open, "{name}: {found}, {open}");
    }
}
