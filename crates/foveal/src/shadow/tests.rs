//! Shadows in pictures: against the twin, with every way of shading, and from frame to frame.

use foveal_generate as generate;
use foveal_scene::{Camera, Light, LightKind, Scene};
use glam::{Mat4, Vec2, Vec3};

use super::records::LookupSettings;
use super::twin::Lookup;
use crate::shading::twin::{ALL_ARRIVES, light_surface_with, position_at, to_eye, unpack_surface};
use crate::testing::{Film, f32_of_half, picture, rendered, small, texels};
use crate::{
    Antialiasing, Geometry, LightAssignment, RateSource, Renderer, Settings, Shading, Shadows,
    Stereo,
};

const WIDTH: u32 = 97;
const HEIGHT: u32 = 65;

pub(super) fn shadowed(shadows: Shadows) -> Settings {
    small(WIDTH, HEIGHT).with(|s| {
        s.lighting.shadows = shadows;
        s.lighting.shadow_atlas = 2048;
    })
}

/// Cornell's room with all kinds of lights, of which one shines upwards.
pub(super) fn room() -> Scene {
    let mut scene = generate::cornell();
    scene.lights.push(Light {
        kind: LightKind::Spot {
            inner_rad: 1.1,
            outer_rad: 1.4,
        },
        color: Vec3::new(1.0, 0.4, 0.3),
        intensity: 3.0,
        position: Vec3::new(1.2, 0.4, 0.9),
        direction: Vec3::new(-0.3, 0.9, -0.5).normalize(),
        range_m: Some(5.0),
        node: None,
    });
    scene
}

pub(crate) fn lookup(renderer: &Renderer) -> Lookup {
    let stage = renderer.shadows();
    Lookup {
        rows: stage.rows().to_vec(),
        atlas: texels(stage.atlas()),
        side: stage.atlas().texture().width(),
        settings: LookupSettings::new(&renderer.settings().lighting),
    }
}

/// What a pixel shows.
pub(super) struct Seen {
    /// Column and row.
    at: [u32; 2],
    pub(super) radiance: Vec3,
    pub(super) surface: crate::shading::twin::Surface,
}

/// Every pixel that shows a surface.
pub(super) fn seen(renderer: &Renderer, camera: &Camera) -> Vec<Seen> {
    let (width, height) = renderer.settings().picture_size();
    let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let radiance: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
    let size = Vec2::new(width as f32, height as f32);
    (0..width * height)
        .filter(|&i| depth[i as usize] > 0.0)
        .map(|pixel| {
            let i = pixel as usize;
            let at = Vec2::new((pixel % width) as f32, (pixel / width) as f32) + 0.5;
            let [r, g, b, _] = radiance[i].map(f32_of_half);
            let surface = unpack_surface(words[i], position_at(camera, size, at, depth[i]));
            Seen {
                at: [pixel % width, pixel / width],
                radiance: Vec3::new(r, g, b),
                surface,
            }
        })
        .collect()
}

/// How many of a frame's pixels the twin lights otherwise, and how many of those that are compared
/// lie in shadow.
pub(super) fn compared_with_twin(
    scene: &Scene,
    settings: &Settings,
    is_compared: impl Fn([u32; 2]) -> bool,
) -> (Renderer, [usize; 3]) {
    let camera = &scene.cameras[0];
    let renderer = rendered(scene, camera, settings);
    let lookup = lookup(&renderer);
    let lights = renderer.lights().1.to_vec();
    let pixels = seen(&renderer, camera);
    let (mut compared, mut off, mut dark) = (0, 0, 0);
    for pixel in pixels.iter().filter(|pixel| is_compared(pixel.at)) {
        let (radiance, surface) = (pixel.radiance, &pixel.surface);
        let v = to_eye(camera, surface.position);
        let lit = |passing: crate::shading::twin::Passing<'_>| {
            let model = settings.lighting.model;
            light_surface_with(scene, &lights, model, (surface, v), passing).radiance
        };
        let cpu = lit(&|(number, light), s| {
            lookup.light_arriving(number, light, (s.position, s.vertex_normal), &[])
        });
        let bright = lit(&|_, _| ALL_ARRIVES);
        compared += 1;
        dark += usize::from(cpu.max_element() < 0.8 * bright.max_element());
        let tolerance = 0.01 * cpu.max_element().max(0.02);
        off += usize::from((radiance - cpu).abs().max_element() > tolerance);
    }
    (renderer, [compared, off, dark])
}

#[test]
fn shading_with_shadows_equals_its_twin() {
    for shadows in [Shadows::Hard, Shadows::Soft, Shadows::Contact] {
        let (_, [compared, off, dark]) = compared_with_twin(&room(), &shadowed(shadows), |_| true);
        assert!(compared > 3_000);
        // Where a comparison is a matter of the last bit, device and twin may differ.
        assert!(
            off * 200 < compared,
            "{shadows:?}: {off} of {compared} differ"
        );
        assert!(dark > 300, "{shadows:?}: only {dark} pixels lie in shadow");
    }
}

#[test]
fn the_last_cascade_holds_the_scene_however_small_its_tile() {
    let mut scene = room();
    scene
        .lights
        .retain(|l| matches!(l.kind, LightKind::Directional));
    let settings = shadowed(Shadows::Hard).with(|s| s.lighting.shadow_atlas = 256);
    let sun = scene.lights[0].direction;
    let mut camera = scene.cameras[0].clone();
    for _ in 0..6 {
        // Cascades move in steps: the scene lies elsewhere in them each time.
        camera.world_from_view.w_axis.z += 0.31;
        let lookup = lookup(&rendered(&scene, &camera, &settings));
        for corner in scene.bounds().corners() {
            assert!(lookup.cascade_at(0, sun, corner).is_some(), "{corner}");
        }
    }
}

#[test]
fn with_shadows_clustered_and_brute_lighting_give_the_same_bytes() {
    let mut scene = room();
    generate::add_point_lights(&mut scene, 60, 7);
    let camera = &scene.cameras[0];
    let settings = shadowed(Shadows::Soft);
    let clustered = rendered(&scene, camera, &settings);
    let brute = settings.with(|s| s.lighting.assignment = LightAssignment::Brute);
    assert_eq!(
        picture(&clustered),
        picture(&rendered(&scene, camera, &brute))
    );
}

#[test]
fn coarse_and_variable_shading_at_every_pixel_give_the_bytes_of_full_shading() {
    let scene = room();
    let camera = &scene.cameras[0];
    for shadows in [Shadows::Soft, Shadows::Contact] {
        for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
            let full = shadowed(shadows).with(|s| s.geometry.path = geometry);
            let reference = picture(&rendered(&scene, camera, &full));
            for shading in [Shading::Coarse, Shading::Variable] {
                let settings = full.clone().with(|s| {
                    s.shading.mode = shading;
                    s.coarse.source = match shading {
                        Shading::Variable => RateSource::Content,
                        _ => RateSource::Constant,
                    };
                    s.coarse.constant_level = 0;
                    s.rate.force = true;
                    s.variable.threshold = 0.0;
                });
                let drawn = picture(&rendered(&scene, camera, &settings));
                assert_eq!(drawn, reference, "{shadows:?}, {shading:?}, {geometry:?}");
            }
        }
    }
}

#[test]
fn at_rest_no_tile_is_drawn_and_the_picture_stays() {
    let scene = room();
    let camera = &scene.cameras[0];
    let mut film = Film::new(&scene, &shadowed(Shadows::Soft));
    let first = film.draw(camera).shadows.unwrap();
    assert!(first.tiles_drawn > 0 && first.tiles_drawn == first.tiles);
    let before = picture(&film.renderer);
    for _ in 0..3 {
        let next = film.draw(camera).shadows.unwrap();
        assert_eq!((next.tiles_drawn, next.casters), (0, 0));
        assert_eq!(next.tiles, first.tiles);
        assert_eq!(picture(&film.renderer), before);
    }
}

/// Tiles may lie elsewhere, and the rasterizer's last bit depends on where: a texel at an edge may
/// turn.
fn assert_nearly_same(a: &Renderer, b: &Renderer) {
    let (a, b) = (picture(a), picture(b));
    let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    assert!(
        differ * 500 <= a.len(),
        "{differ} of {} bytes differ",
        a.len()
    );
}

/// A camera that has turned to the side and back.
fn turned(camera: &Camera, angle: f32) -> Camera {
    let mut camera = camera.clone();
    camera.world_from_view *= Mat4::from_rotation_y(angle);
    camera
}

#[test]
fn tiles_that_are_kept_show_what_a_new_renderer_draws() {
    let scene = room();
    let camera = scene.cameras[0].clone();
    let settings = shadowed(Shadows::Soft);
    let mut film = Film::new(&scene, &settings);
    for step in 0..12 {
        let mut camera = turned(&camera, 0.1 * (step as f32).sin());
        camera.world_from_view.w_axis.z -= 0.2 * step as f32;
        film.draw(&camera);
        if step % 4 == 3 {
            let fresh = rendered(&scene, &camera, &settings);
            assert_nearly_same(&film.renderer, &fresh);
        }
    }
}

#[test]
fn a_thing_that_moves_takes_its_shadow_along() {
    let mut scene = room();
    let camera = scene.cameras[0].clone();
    let settings = shadowed(Shadows::Soft);
    let mut film = Film::new(&scene, &settings);
    let all = film.draw(&camera).shadows.unwrap();
    let block = scene.instances.len() - 1;
    for step in 1..4 {
        let shift = Mat4::from_translation(Vec3::new(-0.05 * step as f32, 0.1, 0.0));
        let instance = &mut scene.instances[block];
        instance.world_from_object = shift * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(shift);
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        let stats = film.draw(&camera).shadows.unwrap();
        assert!(stats.tiles_drawn > 0 && stats.tiles_drawn < all.tiles);
        let fresh = rendered(&scene, &camera, &settings);
        assert_nearly_same(&film.renderer, &fresh);
    }
}

#[test]
fn a_light_that_moves_has_its_own_tiles_drawn_again() {
    let mut scene = room();
    let camera = scene.cameras[0].clone();
    let settings = shadowed(Shadows::Soft);
    let mut film = Film::new(&scene, &settings);
    film.draw(&camera);
    scene.lights[0].position += Vec3::new(0.2, -0.3, 0.1);
    pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
    let stats = film.draw(&camera).shadows.unwrap();
    assert!(
        (1..=6).contains(&stats.tiles_drawn),
        "{}",
        stats.tiles_drawn
    );
    let fresh = rendered(&scene, &camera, &settings);
    assert_nearly_same(&film.renderer, &fresh);
    // Another colour moves no shadow.
    scene.lights[1].color = Vec3::X;
    pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
    assert_eq!(film.draw(&camera).shadows.unwrap().tiles_drawn, 0);
}

#[test]
fn light_that_is_kept_is_told_where_shadows_have_moved() {
    for shadows in [Shadows::Off, Shadows::Soft] {
        let mut scene = room();
        scene
            .lights
            .retain(|light| light.kind != LightKind::Directional);
        let camera = scene.cameras[0].clone();
        let settings = shadowed(shadows).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        });
        let mut film = Film::new(&scene, &settings);
        film.draw(&camera);
        film.draw(&camera);
        let shift = Mat4::from_translation(Vec3::new(-0.1, 0.1, 0.1));
        let block = scene.instances.last_mut().unwrap();
        block.world_from_object = shift * block.world_from_object;
        block.bounds = block.bounds.transformed(shift);
        let bounds = block.bounds;
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        film.draw(&camera);
        let history = film.renderer.history();
        let places = &history.changed_places;
        assert_eq!(
            (history.parameters.reset, places.is_empty()),
            (0, shadows == Shadows::Off)
        );
        let holds = |&[x, y, z, r]: &[f32; 4]| {
            let center = Vec3::new(x, y, z);
            bounds
                .corners()
                .iter()
                .all(|c| c.distance(center) <= r * 1.001)
        };
        assert!(shadows == Shadows::Off || places.iter().any(holds));
    }
}

#[test]
fn culling_changes_no_shadow() {
    use crate::Culling;
    let mut scene = room();
    generate::add_point_lights(&mut scene, 20, 3);
    let camera = &scene.cameras[0];
    let drawn = |mode| {
        let settings = shadowed(Shadows::Soft).with(|s| s.culling.mode = mode);
        picture(&rendered(&scene, camera, &settings))
    };
    let all = drawn(Culling::Off);
    assert_eq!(drawn(Culling::Frustum), all);
    assert_eq!(drawn(Culling::Occlusion), all);
    assert_eq!(drawn(Culling::Auto), all);
}

#[test]
fn a_full_atlas_makes_shadows_coarser_and_leaves_no_light_out_before_it_must() {
    let mut scene = room();
    generate::add_point_lights(&mut scene, 300, 3);
    let camera = scene.cameras[0].clone();
    let settings = shadowed(Shadows::Soft).with(|s| s.lighting.shadow_atlas = 512);
    let mut film = Film::new(&scene, &settings);
    let stats = film.draw(&camera).shadows.unwrap();
    assert!(stats.shrunk_by > 0.0 && stats.texels <= 512 * 512);
    scene.lights.clear();
    generate::add_point_lights(&mut scene, 2_000, 3);
    let mut film = Film::new(&scene, &settings);
    let stats = film.draw(&camera).shadows.unwrap();
    assert!(stats.lights_left_out > 0 && stats.texels <= 512 * 512);
}

#[test]
fn both_eyes_see_the_same_shadows_from_one_atlas() {
    let scene = room();
    let camera = &scene.cameras[0];
    let of = |mode, shadows| {
        let settings = shadowed(shadows).with(|s| {
            s.stereo.mode = mode;
            s.stereo.output = crate::Output::SideBySide;
        });
        let mut film = Film::new(&scene, &settings);
        let stats = film.draw(camera).shadows.unwrap();
        (stats.tiles, picture(&film.renderer))
    };
    for shadows in [Shadows::Soft, Shadows::Contact] {
        let (tiles, two) = of(Stereo::TwoPass, shadows);
        assert!(tiles > 0);
        let (_, instanced) = of(Stereo::Instanced, shadows);
        let differ = two.iter().zip(&instanced).filter(|(a, b)| a != b).count();
        assert!(differ * 500 < two.len(), "{differ} of {}", two.len());
    }
}

#[test]
fn antialiasing_lights_sub_samples_with_shadows() {
    let scene = room();
    let camera = &scene.cameras[0];
    let dark = |mode, shadows| {
        let settings = shadowed(shadows).with(|s| s.antialiasing.mode = mode);
        let bytes = picture(&rendered(&scene, camera, &settings));
        bytes.iter().map(|&b| u64::from(b)).sum::<u64>() as f64
    };
    let full = dark(Antialiasing::None, Shadows::Soft);
    for mode in [Antialiasing::Ssaa, Antialiasing::Msaa] {
        let ratio = dark(mode, Shadows::Soft) / full;
        assert!((ratio - 1.0).abs() < 0.02, "{mode:?}: {ratio}");
        assert!(dark(mode, Shadows::Soft) < 0.98 * dark(mode, Shadows::Off));
    }
}

#[test]
fn holes_of_masked_materials_let_light_through_and_blended_things_cast_nothing() {
    let scene = generate::alpha();
    let camera = &scene.cameras[0];
    let bytes = |scene: &Scene| picture(&rendered(scene, camera, &shadowed(Shadows::Hard)));
    let drawn = bytes(&scene);
    // The same without holes: more shadow.
    let mut solid = scene.clone();
    for material in &mut solid.materials {
        if matches!(material.alpha_mode, foveal_scene::AlphaMode::Mask { .. }) {
            material.alpha_mode = foveal_scene::AlphaMode::Opaque;
        }
    }
    assert_ne!(drawn, bytes(&solid));
    let mut without = scene.clone();
    let materials = &scene.materials;
    without
        .instances
        .retain(|i| materials[i.material as usize].alpha_mode != foveal_scene::AlphaMode::Blend);
    let tiles = |scene: &Scene| {
        let renderer = rendered(scene, camera, &shadowed(Shadows::Hard));
        renderer.shadows().stats().unwrap().casters
    };
    assert_eq!(tiles(&scene), tiles(&without));
}

#[test]
fn a_lamp_lets_its_own_light_out_and_a_wall_that_glows_does_not() {
    let mut scene = room();
    let camera = scene.cameras[0].clone();
    let is_block = |i: &foveal_scene::Instance| {
        let size = i.bounds.size();
        scene.materials[i.material as usize].emissive == Vec3::ZERO
            && size.min_element() > 0.3
            && size.max_element() < 2.5
    };
    let number = scene.instances.iter().position(is_block).unwrap();
    let block = scene.instances[number].bounds;
    let material = scene.instances[number].material as usize;
    scene.lights.truncate(1);
    scene.lights[0].position = block.center();
    let brightness = |scene: &Scene| {
        let bytes = picture(&rendered(scene, &camera, &shadowed(Shadows::Hard)));
        bytes.iter().map(|&b| u64::from(b)).sum::<u64>()
    };
    scene.materials.push(scene.materials[material].clone());
    let glowing = scene.materials.len() - 1;
    scene.materials[glowing].emissive = Vec3::splat(1e-6);
    // Of a block around the light, in parts of the light's range.
    let mut with_block = |size: f32, material: usize| {
        scene.lights[0].range_m = Some(block.size().length() / size);
        scene.instances[number].material = material as u32;
        brightness(&scene)
    };
    let [dark, lamp] = [material, glowing].map(|m| with_block(0.3, m));
    assert!(lamp > dark + dark / 50, "{lamp}, {dark}");
    let [dark, wall] = [material, glowing].map(|m| with_block(0.6, m));
    assert_eq!(wall, dark);
}
