//! Casters that are left out: pictures are the same to the byte, and fewer casters are submitted.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::{Mat4, Vec3};

use super::tests::{room, shadowed};
use crate::testing::{Film, picture};
use crate::{Antialiasing, Culling, Settings, Shading, ShadowStats, Shadows, Stereo};

/// A film of the scene, frame after frame, and what the shadows of each did.
fn film(
    scene: &Scene,
    settings: &Settings,
    frames: usize,
    mut pose: impl FnMut(usize, &mut Scene) -> Camera,
) -> Vec<(Vec<u8>, ShadowStats)> {
    let mut scene = scene.clone();
    let mut film = Film::new(&scene, settings);
    let draw = |i| {
        let camera = pose(i, &mut scene);
        pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
        let stats = film.draw(&camera).shadows.unwrap();
        (picture(&film.renderer), stats)
    };
    (0..frames).map(draw).collect()
}

/// Whether culling leaves every picture of a film as it is; what shadows did with it.
fn assert_same(
    scene: &Scene,
    settings: &Settings,
    frames: usize,
    pose: impl Fn(usize, &mut Scene) -> Camera,
) -> Vec<ShadowStats> {
    let of = |mode| {
        let settings = settings.clone().with(|s| s.culling.mode = mode);
        film(scene, &settings, frames, &pose)
    };
    let (with, without) = (of(Culling::Occlusion), of(Culling::Off));
    for (i, (a, b)) in with.iter().zip(&without).enumerate() {
        assert!(a.0 == b.0, "frame {i} differs");
    }
    let sum = |f: &[(Vec<u8>, ShadowStats)]| f.iter().map(|(_, s)| s.casters).sum::<u64>();
    assert!(sum(&with) <= sum(&without));
    with.into_iter().map(|(_, stats)| stats).collect()
}

fn market() -> Scene {
    let options = generate::DemoOptions {
        instances: 1_000,
        lights: 60,
        ..Default::default()
    };
    generate::demo(&options).unwrap()
}

fn walked(scene: &Scene, step: usize) -> Camera {
    let mut camera = scene.cameras[0].clone();
    camera.world_from_view *= Mat4::from_rotation_y(0.35 * step as f32);
    camera.world_from_view.w_axis.x += 0.4 * step as f32;
    camera
}

#[test]
fn a_walk_shows_the_same_with_casters_left_out() {
    for shadows in [Shadows::Hard, Shadows::Soft] {
        let stats = assert_same(&market(), &shadowed(shadows), 6, |i, scene| {
            walked(scene, i)
        });
        let sum = |of: fn(&ShadowStats) -> u64| stats.iter().map(of).sum::<u64>();
        let (casters, in_reach) = (sum(|s| s.casters), sum(|s| s.casters_in_reach));
        assert!(sum(|s| s.casters_hidden) > 0 && sum(|s| s.casters_unneeded) > 0);
        assert!(sum(|s| s.tiles_completed) > 0);
        assert!(casters * 10 <= in_reach * 9, "{casters} of {in_reach}");
    }
}

#[test]
fn things_and_lights_that_move_show_the_same_with_casters_left_out() {
    let scene = market();
    let stats = assert_same(&scene, &shadowed(Shadows::Soft), 6, |i, scene| {
        let shift = Mat4::from_translation(Vec3::new(0.3, 0.05, -0.2));
        for instance in scene.instances.iter_mut().step_by(17) {
            instance.world_from_object = shift * instance.world_from_object;
            instance.bounds = instance.bounds.transformed(shift);
        }
        for object in &mut scene.objects {
            let instances = object.instances.start as usize..object.instances.end as usize;
            let boxes = scene.instances[instances].iter().map(|i| i.bounds);
            object.bounds = boxes.reduce(|a, b| a.union(b)).unwrap();
        }
        scene.lights[i].position.x += 0.3;
        walked(scene, i / 2)
    });
    assert!(stats.iter().all(|s| s.casters_unneeded > 0));
}

#[test]
fn two_eyes_and_edges_show_the_same_with_casters_left_out() {
    let mut room = room();
    generate::add_point_lights(&mut room, 20, 3);
    let two_eyes: fn(&mut Settings) = |s| {
        s.stereo.mode = Stereo::TwoPass;
        s.stereo.output = crate::Output::SideBySide;
    };
    let ways: [fn(&mut Settings); 3] = [
        two_eyes,
        |s| s.antialiasing.mode = Antialiasing::Msaa,
        |s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        },
    ];
    for way in ways {
        let settings = shadowed(Shadows::Soft).with(way);
        assert_same(&room, &settings, 4, |i, scene| walked(scene, i));
    }
    let settings = shadowed(Shadows::Soft).with(two_eyes);
    assert_same(&market(), &settings, 3, |i, scene| walked(scene, i));
}
