//! Unlit materials: no light changes them, in any way of shading.

use foveal_generate as generate;
use foveal_scene::{AlphaMode, Scene};
use glam::Vec3;

use crate::testing::{Film, picture, rendered, small};
use crate::{Antialiasing, EnvironmentSource, Geometry, LightingModel, Settings, Shading, ToneMap};

/// A room without lit materials, and the same with lights a hundred thousand times as bright.
fn rooms() -> [Scene; 2] {
    let mut room = generate::cornell();
    for (i, material) in room.materials.iter_mut().enumerate() {
        material.unlit = true;
        // One is black, one is looked through.
        if i == 1 {
            material.base_color *= glam::Vec4::new(0.0, 0.0, 0.0, 1.0);
        } else if i == 2 {
            material.alpha_mode = AlphaMode::Blend;
            material.base_color.w = 0.5;
        }
    }
    let mut bright = room.clone();
    for light in &mut bright.lights {
        light.intensity *= 1e5;
        light.range_m = None;
    }
    [room, bright]
}

fn settings() -> Settings {
    small(97, 65).with(|s| {
        s.picture.tone_map = ToneMap::Linear;
        s.lighting.environment = EnvironmentSource::None;
    })
}

fn ways() -> Vec<Settings> {
    let way = |change: &dyn Fn(&mut Settings)| settings().with(|s| change(s));
    vec![
        way(&|_| ()),
        way(&|s| s.geometry.path = Geometry::Visibility),
        way(&|s| s.lighting.model = LightingModel::BlinnPhong),
        way(&|s| s.lighting.multiple_scattering = true),
        way(&|s| s.shading.mode = Shading::Coarse),
        way(&|s| s.shading.mode = Shading::Variable),
        way(&|s| s.antialiasing.mode = Antialiasing::Msaa),
        way(&|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.geometry.path = Geometry::Visibility;
        }),
        way(&|s| s.antialiasing.mode = Antialiasing::Ssaa),
    ]
}

#[test]
fn no_light_changes_unlit_surfaces() {
    let [room, bright] = rooms();
    let mut lit = bright.clone();
    lit.materials.iter_mut().for_each(|m| m.unlit = false);
    let drawn = |scene: &Scene, way: &Settings| picture(&rendered(scene, &scene.cameras[0], way));
    for way in ways() {
        let [a, b] = [&room, &bright].map(|scene| drawn(scene, &way));
        assert!(a == b, "{way:?}");
        assert!(a != drawn(&lit, &way), "the lights shine");
    }
}

#[test]
fn no_light_that_is_kept_changes_unlit_surfaces() {
    let drawn = rooms().map(|scene| {
        let settings = settings().with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        });
        let mut film = Film::new(&scene, &settings);
        let mut camera = scene.cameras[0].clone();
        for _ in 0..4 {
            film.draw(&camera);
            camera.world_from_view.w_axis += Vec3::new(0.01, 0.0, 0.01).extend(0.0);
        }
        picture(&film.renderer)
    });
    assert!(drawn[0] == drawn[1]);
}
