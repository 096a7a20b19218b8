//! Casters that are left out: pictures are the same to the byte, and fewer casters are submitted.

use foveal_generate as generate;
use foveal_scene::{
    Aabb, AlphaMode, Camera, Instance, Light, LightKind, Material, Mesh, Object, Scene,
    Transmission, Vertex,
};
use glam::{Mat4, Vec3};

use super::stage::MOST_FRAMES;
use super::tests::{room, shadowed};
use crate::testing::{Film, picture, rendered};
use crate::{
    Antialiasing, Culling, CullingEyes, DebugView, Geometry, Settings, Shading, ShadowStats,
    Shadows, Stereo,
};

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

pub(super) fn market() -> Scene {
    let options = generate::DemoOptions {
        instances: 1_000,
        lights: 60,
        ..Default::default()
    };
    generate::demo(&options).unwrap()
}

pub(super) fn walked(scene: &Scene, step: usize) -> Camera {
    let mut camera = scene.cameras[0].clone();
    camera.world_from_view *= Mat4::from_rotation_y(0.35 * step as f32);
    camera.world_from_view.w_axis.x += 0.4 * step as f32;
    camera
}

#[test]
fn a_walk_shows_the_same_with_casters_left_out() {
    for shadows in [Shadows::Hard, Shadows::Soft, Shadows::Contact] {
        let settings = shadowed(shadows).with(|s| {
            s.lighting.light_radius_m = 0.4;
            s.lighting.sun_angle_deg = 5.0;
        });
        let stats = assert_same(&market(), &settings, 6, |i, scene| walked(scene, i));
        let sum = |of: fn(&ShadowStats) -> u64| stats.iter().map(of).sum::<u64>();
        let (casters, in_reach) = (sum(|s| s.casters), sum(|s| s.casters_in_reach));
        assert!(sum(|s| s.casters_hidden) > 0 && sum(|s| s.casters_unneeded) > 0);
        assert!(sum(|s| s.tiles_completed) > 0);
        assert!(casters * 10 <= in_reach * 9, "{casters} of {in_reach}");
    }
}

/// Moves some instances.
pub(super) fn shift(scene: &mut Scene, instances: impl Iterator<Item = usize>, by: Vec3) {
    let shift = Mat4::from_translation(by);
    for number in instances {
        let instance = &mut scene.instances[number];
        instance.world_from_object = shift * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(shift);
    }
    for object in &mut scene.objects {
        let instances = object.instances.start as usize..object.instances.end as usize;
        let boxes = scene.instances[instances].iter().map(|i| i.bounds);
        object.bounds = boxes.reduce(|a, b| a.union(b)).unwrap();
    }
}

#[test]
fn things_and_lights_that_move_show_the_same_with_casters_left_out() {
    let scene = market();
    let stats = assert_same(&scene, &shadowed(Shadows::Soft), 6, |i, scene| {
        let instances = scene.instances.len();
        shift(
            scene,
            (0..instances).step_by(17),
            Vec3::new(0.3, 0.05, -0.2),
        );
        scene.lights[i].position.x += 0.3;
        walked(scene, i / 2)
    });
    assert!(stats.iter().all(|s| s.casters_unneeded > 0));
}

#[test]
fn ways_of_drawing_show_the_same_with_casters_left_out() {
    let two_eyes: fn(&mut Settings) = |s| {
        s.stereo.mode = Stereo::TwoPass;
        s.stereo.output = crate::Output::SideBySide;
    };
    let ways: [fn(&mut Settings); 6] = [
        two_eyes,
        |s| {
            s.stereo.mode = Stereo::TwoPass;
            s.stereo.output = crate::Output::SideBySide;
            s.culling.eyes = CullingEyes::Shared;
        },
        |s| s.antialiasing.mode = Antialiasing::Msaa,
        |s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        },
        |s| {
            s.geometry.path = Geometry::Visibility;
            s.shading.mode = Shading::Variable;
        },
        |s| s.culling.radius_m = 0.5,
    ];
    for (number, way) in ways.into_iter().enumerate() {
        let settings = shadowed(Shadows::Soft).with(way);
        let stats = assert_same(&market(), &settings, 3, |i, scene| walked(scene, i));
        // What lights the mean of several places asks nothing.
        let means = settings.antialiasing.mode != Antialiasing::None
            || settings.shading.mode == Shading::Variable;
        assert_eq!(stats[0].casters_unneeded > 0, !means, "way {number}");
    }
}

fn glass() -> Transmission {
    Transmission {
        factor: 0.7,
        texture: None,
        thickness_m: 0.1,
        thickness_texture: None,
        attenuation_distance_m: f32::INFINITY,
        attenuation_color: Vec3::ONE,
    }
}

#[test]
fn surfaces_that_light_passes_show_the_same_with_casters_left_out() {
    let mut scene = market();
    for (number, material) in scene.materials.iter_mut().enumerate() {
        match number % 4 {
            0 => {
                material.alpha_mode = AlphaMode::Blend;
                material.base_color.w = 0.6;
            }
            1 => material.alpha_mode = AlphaMode::Mask { cutoff: 0.5 },
            2 => material.transmission = Some(glass()),
            _ => {}
        }
    }
    let stats = assert_same(&scene, &shadowed(Shadows::Soft), 3, |i, scene| {
        walked(scene, i)
    });
    assert!(stats[0].casters_unneeded > 0);
}

/// Tiles go out of sight and come back, having missed several frames.
#[test]
fn a_walk_there_and_back_shows_the_same_with_casters_left_out() {
    for moves in [false, true] {
        let way = [0, 2, 5, 8, 11, 8, 5, 2, 0, 0, 1];
        let scene = market();
        let stats = assert_same(&scene, &shadowed(Shadows::Soft), way.len(), |i, scene| {
            if moves {
                let instances = scene.instances.len();
                shift(
                    scene,
                    (i * 5..instances).step_by(97),
                    Vec3::new(0.4, 0.0, -0.3),
                );
            }
            walked(scene, way[i])
        });
        let later = stats[5..].iter();
        assert!(later.map(|s| s.tiles_completed).sum::<u64>() > 0);
        // Without moves each caster is submitted at most once for a tile.
        let last = stats.last().unwrap();
        assert!(moves || last.casters == 0 || last.tiles_completed > 0);
    }
}

/// What a tile was drawn for is forgotten after some frames, and seen anew.
#[test]
fn things_that_move_for_long_show_the_same_with_casters_left_out() {
    let options = generate::DemoOptions {
        instances: 1_000,
        lights: 3,
        ..Default::default()
    };
    let scene = generate::demo(&options).unwrap();
    let settings = shadowed(Shadows::Hard).with(|s| {
        s.picture.width = 64;
        s.picture.height = 40;
        s.lighting.shadow_atlas = 1024;
    });
    let frames = MOST_FRAMES as usize + 8;
    let stats = assert_same(&scene, &settings, frames, |i, scene| {
        let instances = scene.instances.len();
        let by = Vec3::new(if i % 2 == 0 { 0.05 } else { -0.05 }, 0.0, 0.01);
        shift(scene, (0..instances).step_by(53), by);
        walked(scene, i / 20)
    });
    assert!(
        stats.iter().all(|s| s.tiles_drawn > 0),
        "tiles are drawn in each frame"
    );
    assert!(stats.last().unwrap().casters_unneeded > 0);
}

/// A mesh of triangles around a convex outline.
pub(super) fn flat(corners: [Vec3; 4]) -> Mesh {
    let [a, b, c, _] = corners;
    let normal = (b - a).cross(c - a).normalize().to_array();
    Mesh {
        vertices: corners.map(|p| vertex(p, normal)).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        bounds: Aabb::of_points(corners),
        ..Mesh::default()
    }
}

fn vertex(position: Vec3, normal: [f32; 3]) -> Vertex {
    Vertex {
        position: position.to_array(),
        normal,
        color: [u16::MAX; 4],
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Lit points that look to a side.
fn points(places: impl IntoIterator<Item = Vec3>, normal: Vec3) -> Mesh {
    let vertices = places.into_iter().map(|p| vertex(p, normal.to_array()));
    let vertices: Vec<Vertex> = vertices.collect();
    Mesh {
        points: (0..vertices.len() as u32).collect(),
        bounds: Aabb::of_points(vertices.iter().map(|v| v.position.into())),
        vertices,
        ..Mesh::default()
    }
}

/// Adds an object that is made of these.
pub(super) fn add<const N: usize>(scene: &mut Scene, meshes: [Mesh; N]) {
    let first = scene.instances.len() as u32;
    let object = scene.objects.len() as u32;
    scene.objects.push(Object {
        name: "object".to_owned(),
        node: object,
        element: 0,
        visible: true,
        occluder: None,
        set: None,
        bounds: (meshes.iter()).fold(Aabb::EMPTY, |all, m| all.union(m.bounds)),
        instances: first..first + N as u32,
    });
    for mesh in meshes {
        scene.instances.push(Instance {
            mesh: scene.meshes.len() as u32,
            material: 0,
            object,
            world_from_object: Mat4::IDENTITY,
            bounds: mesh.bounds,
        });
        scene.meshes.push(mesh);
    }
}

pub(super) fn bare() -> Scene {
    let material = Material {
        double_sided: true,
        metallic: 0.0,
        ..Material::default()
    };
    Scene {
        materials: vec![material],
        ..Scene::default()
    }
}

pub(super) fn lamp(position: Vec3, range: f32) -> Light {
    Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity: 10.0,
        position,
        direction: -Vec3::Y,
        range_m: Some(range),
        node: None,
    }
}

/// Points whose centres lie beside the picture, or behind a wall, where much of their squares is
/// seen; what shades them is not seen.
fn clouds(has_casters: [bool; 2]) -> Scene {
    let mut scene = bare();
    let upright = |x: [f32; 2], y: f32, z: f32| {
        flat([
            Vec3::new(x[0], -y, z),
            Vec3::new(x[1], -y, z),
            Vec3::new(x[1], y, z),
            Vec3::new(x[0], y, z),
        ])
    };
    // The picture ends at x = -3.8, where z is 0.
    let beside = [-0.5, 0.0, 0.5].map(|y| Vec3::new(-4.25, y, 0.0));
    add(&mut scene, [points(beside, Vec3::Z)]);
    scene.lights.push(lamp(Vec3::new(-4.25, 0.0, 2.4), 40.0));
    // The wall's edge is seen before x = 0.6, where z is 0.
    add(&mut scene, [upright([0.5, 2.5], 1.5, 1.0)]);
    let behind = [-0.3, 0.3].map(|y| Vec3::new(1.0, y, 0.0));
    add(&mut scene, [points(behind, Vec3::Y)]);
    scene.lights.push(lamp(Vec3::new(1.0, 1.3, 0.0), 40.0));
    // Something that is seen anyway.
    add(&mut scene, [upright([-1.5, -0.5], 1.0, -0.5)]);
    if has_casters[0] {
        add(&mut scene, [upright([-4.9, -3.6], 0.8, 1.2)]);
    }
    if has_casters[1] {
        let roof = [(0.9, -0.1), (1.1, -0.1), (1.1, 0.1), (0.9, 0.1)];
        add(&mut scene, [flat(roof.map(|(x, z)| Vec3::new(x, 0.45, z)))]);
    }
    scene
}

#[test]
fn points_that_reach_beyond_their_boxes_keep_their_shadows() {
    let eye = Vec3::new(0.0, 0.0, 6.0);
    let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 0.8);
    let settings = shadowed(Shadows::Hard).with(|s| {
        s.geometry.point_size_px = 32.0;
    });
    let shows = |has_casters| picture(&rendered(&clouds(has_casters), &camera, &settings));
    let bright = shows([false; 2]);
    for has_casters in [[true, false], [false, true]] {
        assert_same(&clouds(has_casters), &settings, 2, |_, _| camera.clone());
        assert!(shows(has_casters) != bright, "the shadows are seen");
    }
}

/// A wall, and behind it, of the same object, what shades ground that only another camera sees.
fn yard() -> (Scene, [Camera; 2]) {
    let mut scene = bare();
    let level = |x: f32, y: f32, z: [f32; 2]| {
        flat([
            Vec3::new(-x, y, z[1]),
            Vec3::new(x, y, z[1]),
            Vec3::new(x, y, z[0]),
            Vec3::new(-x, y, z[0]),
        ])
    };
    add(&mut scene, [level(2.8, 0.0, [-6.0, 3.0])]);
    let wall = flat([
        Vec3::new(-3.0, 0.0, 0.0),
        Vec3::new(3.0, 0.0, 0.0),
        Vec3::new(3.0, 2.5, 0.0),
        Vec3::new(-3.0, 2.5, 0.0),
    ]);
    add(&mut scene, [wall, level(0.5, 1.0, [-2.5, -1.5])]);
    scene.lights.push(lamp(Vec3::new(0.0, 2.0, -2.0), 5.0));
    scene.lights.push(lamp(Vec3::new(0.0, 2.0, 2.0), 5.0));
    let look = |eye| Camera::look_at(eye, Vec3::new(0.0, 1.0, 0.0), Vec3::Y, 0.8);
    (
        scene,
        [Vec3::new(0.0, 1.2, 5.0), Vec3::new(4.0, 6.0, -5.0)].map(look),
    )
}

#[test]
fn frozen_culling_shows_all_shadows_of_what_it_draws() {
    let (scene, cameras) = yard();
    let draw = |mode, freezes| {
        let settings = shadowed(Shadows::Soft).with(|s| s.culling.mode = mode);
        let mut film = Film::new(&scene, &settings);
        let first = film.draw(&cameras[0]).shadows.unwrap();
        film.renderer.freeze_culling(freezes);
        film.draw(&cameras[1]);
        film.renderer.freeze_culling(false);
        let shown = picture(&film.renderer);
        film.draw(&cameras[1]);
        assert!(picture(&film.renderer) == shown, "all objects are seen");
        (shown, first)
    };
    let (frozen, first) = draw(Culling::Occlusion, true);
    let (thawed, _) = draw(Culling::Occlusion, false);
    let (all, first_of_all) = draw(Culling::Off, false);
    assert!(
        first.tiles < first_of_all.tiles,
        "some tiles are not needed"
    );
    assert!(frozen == all && thawed == all);
}

#[test]
fn cells_are_placed_and_tested_where_shadows_ask_for_them_alone() {
    let scene = room();
    let camera = &scene.cameras[0];
    let cells = |change: fn(&mut Settings)| {
        let settings = shadowed(Shadows::Hard).with(|s| {
            s.culling.mode = Culling::Occlusion;
            change(s);
        });
        rendered(&scene, camera, &settings).cells_placed_and_tested()
    };
    let (placed, tested) = cells(|_| {});
    assert!(placed > scene.instances.len() && tested == placed);
    assert_eq!(cells(|s| s.lighting.shadows = Shadows::Off), (0, 0));
    assert_eq!(cells(|s| s.culling.mode = Culling::Frustum), (0, 0));
    assert_eq!(cells(|s| s.picture.view = DebugView::Normals), (0, 0));
    // These light the mean of several places.
    assert_eq!(cells(|s| s.antialiasing.mode = Antialiasing::Msaa), (0, 0));
    assert_eq!(cells(|s| s.shading.mode = Shading::Variable), (0, 0));
    for scale in [1, 2, 8] {
        let settings = shadowed(Shadows::Hard).with(|s| s.culling.buffer_scale = scale);
        let of_auto = rendered(&scene, camera, &settings).cells_placed_and_tested();
        assert_eq!(of_auto, (placed, placed), "{scale}");
    }
}

#[test]
fn what_has_no_triangles_is_no_caster() {
    let (mut scene, cameras) = yard();
    let of = |scene: &Scene| {
        let settings = shadowed(Shadows::Hard).with(|s| s.culling.mode = Culling::Frustum);
        film(scene, &settings, 1, |_, _| cameras[0].clone())
    };
    let before = of(&scene)[0].1;
    add(
        &mut scene,
        [points([Vec3::new(0.1, 0.8, 1.0), Vec3::ONE], Vec3::Y)],
    );
    let after = of(&scene)[0].1;
    assert_eq!(before.casters, after.casters);
    assert_eq!(before.casters_in_reach, after.casters_in_reach);
    assert_eq!(after.casters, after.casters_in_reach);
}
