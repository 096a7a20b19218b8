//! Pictures with and without culling are equal byte for byte, along walks through a house.
//!
//! Needs a Vulkan driver; Mesa's lavapipe, which draws on the processor, will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

#[path = "../examples/shared/mod.rs"]
mod shared;

use bevy::asset::RenderAssetUsages;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::pbr::decal::{ForwardDecal, ForwardDecalMaterial, ForwardDecalMaterialExt};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_foveal_cull::{AutomaticOccluders, CpuOcclusionStats, Occluder};
use shared::headless::Headless;
use shared::house::{Door, House};
use shared::modes::Mode;
use shared::twice::pixels_that_differ;

/// A house drawn twice, and what was hidden on the way.
fn walk(house: House, size: UVec2, msaa: Msaa, frames: usize) -> CpuOcclusionStats {
    let [mut plain, mut culled] = [Mode::Frustum, Mode::All].map(|mode| {
        Headless::new(size, msaa, |world| {
            house.spawn(world);
            mode.set(world);
        })
    });
    let mut sum = CpuOcclusionStats::default();
    for frame in 0..frames {
        let rooms = frame as f32 * (house.side * house.side - 1) as f32 / frames as f32;
        for app in [&mut plain, &mut culled] {
            let camera = app.camera;
            let world = app.world();
            *world.get_mut::<Transform>(camera).unwrap() = house.walker(rooms);
            let mut doors = world.query::<(&Door, &mut Transform)>();
            for (door, mut leaf) in doors.iter_mut(world) {
                *leaf = door.at(frame as f32 * 0.7);
            }
            // The first frame uploads meshes and finds their bounds.
            for _ in 0..if frame == 0 { 3 } else { 1 } {
                app.frame();
            }
        }
        let (a, b) = (plain.picture(), culled.picture());
        assert!(a.iter().any(|&byte| byte != a[0]), "there is a picture");
        assert_eq!(pixels_that_differ(&a, &b), 0, "frame {frame}, {msaa:?}");
        let stats = culled.world().resource::<CpuOcclusionStats>();
        sum.meshes += stats.meshes;
        sum.meshes_hidden += stats.meshes_hidden;
        sum.casters += stats.casters;
        sum.casters_hidden += stats.casters_hidden;
        sum.casters_unseen += stats.casters_unseen;
        sum.refused_views += stats.refused_views;
    }
    sum
}

#[test]
fn pictures_of_a_walk_are_the_same_with_and_without_culling() {
    let house = House {
        side: 5,
        furniture: 20,
        doors: true,
        lights: 0,
        range: 15.0,
    };
    // A size that is no multiple of the buffer's, and a sample per pixel.
    let odd = walk(house, UVec2::new(317, 179), Msaa::Off, 60);
    let sampled = walk(house, UVec2::new(200, 120), Msaa::Sample4, 24);
    for sum in [odd, sampled] {
        assert_eq!(sum.refused_views, 0);
        assert!(sum.meshes_hidden * 2 > sum.meshes, "{sum:?}");
    }
    let lit = House {
        lights: 2,
        side: 4,
        ..house
    };
    let sum = walk(lit, UVec2::new(200, 120), Msaa::Off, 16);
    let left_out = sum.casters_hidden + sum.casters_unseen;
    assert!(left_out * 2 > sum.casters, "{sum:?}");
}

/// Things of a room whose drawing changes on the way.
#[derive(Resource)]
struct Things {
    /// A wall between the camera and most of the room, with a texture that comes later.
    wall: Entity,
    texture: Handle<Image>,
    /// Another wall, which is found to occlude.
    found: Entity,
}

fn room(world: &mut World) {
    world.insert_resource(AutomaticOccluders {
        still_frames: 3,
        ..default()
    });
    let texture = world.resource::<Assets<Image>>().reserve_handle();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let wall = meshes.add(Cuboid::new(6.0, 6.0, 0.2));
    let ball = meshes.add(Sphere::new(0.5).mesh().uv(16, 10));
    let floor = meshes.add(Cuboid::new(40.0, 0.2, 40.0));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let plain = materials.add(Color::srgb(0.7, 0.6, 0.4));
    let bricks = materials.add(StandardMaterial {
        base_color_texture: Some(texture.clone()),
        ..default()
    });
    let decal = world
        .resource_mut::<Assets<ForwardDecalMaterial<StandardMaterial>>>()
        .add(ForwardDecalMaterial {
            base: Color::srgb(0.9, 0.1, 0.1).into(),
            extension: ForwardDecalMaterialExt::default(),
        });
    let at = Transform::from_xyz;
    world.spawn((
        Mesh3d(floor),
        MeshMaterial3d(plain.clone()),
        at(0.0, -2.0, 0.0),
        Occluder::default(),
    ));
    let of_bricks = world
        .spawn((
            Mesh3d(wall.clone()),
            MeshMaterial3d(bricks),
            at(-4.0, 0.0, -6.0),
            Occluder::default(),
        ))
        .id();
    // The inside of its far side is drawn alone.
    world.spawn((
        Mesh3d(wall.clone()),
        MeshMaterial3d(plain.clone()),
        at(4.0, 0.0, -6.0).with_scale(Vec3::new(-1.0, 1.0, 20.0)),
        Occluder::default(),
    ));
    let found = world
        .spawn((
            Mesh3d(wall),
            MeshMaterial3d(plain.clone()),
            at(0.0, 0.0, -12.0),
        ))
        .id();
    for i in 0..40 {
        let (column, row) = ((i % 10) as f32, (i / 10) as f32);
        world.spawn((
            Mesh3d(ball.clone()),
            MeshMaterial3d(plain.clone()),
            at(column * 1.3 - 6.0, -1.0, -4.5 - row * 3.0),
        ));
    }
    for x in [-4.0, 4.0] {
        world.spawn((
            ForwardDecal,
            MeshMaterial3d(decal.clone()),
            at(x, -1.89, -8.0).with_scale(Vec3::splat(3.0)),
        ));
    }
    world.spawn((
        SpotLight {
            shadow_maps_enabled: true,
            intensity: 3e6,
            range: 40.0,
            ..default()
        },
        at(2.0, 3.0, 2.0).looking_at(Vec3::new(-2.0, 0.0, -8.0), Vec3::Y),
    ));
    world.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            illuminance: 3000.0,
            ..default()
        },
        at(3.0, 4.0, 6.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    world.insert_resource(Things {
        wall: of_bricks,
        texture,
        found,
    });
}

#[test]
fn pictures_are_the_same_from_the_first_frame_on_whatever_changes() {
    let size = UVec2::new(200, 120);
    let [mut plain, mut culled] = [Mode::Frustum, Mode::All].map(|mode| {
        let mut app = Headless::new(size, Msaa::Off, |world| {
            room(world);
            mode.set(world);
        });
        let camera = app.camera;
        app.world().entity_mut(camera).insert(DepthPrepass);
        app
    });
    let mut hidden = [0; 2];
    let mut decals = 0;
    for frame in 0..40_usize {
        for app in [&mut plain, &mut culled] {
            let world = app.world();
            let Things {
                wall,
                texture,
                found,
            } = world.resource::<Things>();
            let (wall, texture, found) = (*wall, texture.clone(), *found);
            match frame {
                6 => {
                    let extent = Extent3d {
                        width: 1,
                        height: 1,
                        depth_or_array_layers: 1,
                    };
                    let image = Image::new_fill(
                        extent,
                        TextureDimension::D2,
                        &[200, 90, 60, 255],
                        TextureFormat::Rgba8UnormSrgb,
                        RenderAssetUsages::default(),
                    );
                    let mut images = world.resource_mut::<Assets<Image>>();
                    images.insert(&texture, image).unwrap();
                }
                22 => {
                    let material = world.get::<MeshMaterial3d<StandardMaterial>>(found);
                    let material = material.unwrap().clone();
                    world
                        .entity_mut(found)
                        .remove::<MeshMaterial3d<StandardMaterial>>();
                    world.entity_mut(wall).insert(material);
                }
                30 => {
                    world.despawn(wall);
                }
                _ => {}
            }
            app.frame();
        }
        let (a, b) = (plain.picture(), culled.picture());
        assert_eq!(pixels_that_differ(&a, &b), 0, "frame {frame}");
        let red = |p: &[u8; 4]| p[0] > 60 && p[1] < p[0] / 3 && p[2] < p[0] / 3;
        decals += a.as_chunks::<4>().0.iter().filter(|p| red(p)).count();
        let stats = culled.world().resource::<CpuOcclusionStats>();
        assert_eq!(stats.refused_views, 0);
        hidden[0] += stats.meshes_hidden;
        hidden[1] += stats.casters_hidden;
    }
    assert!(decals > 0, "the decals are in the picture");
    assert!(hidden.iter().all(|&sum| sum > 0), "{hidden:?}");
}

/// A sheet before a thick wall, and a light behind the wall.
fn sheet(world: &mut World, diffuse_transmission: f32) {
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let wall = meshes.add(Cuboid::new(30.0, 30.0, 6.0));
    let sheet = meshes.add(Cuboid::new(1.0, 1.0, 0.02));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let plain = materials.add(Color::srgb(0.7, 0.6, 0.4));
    let leaf = materials.add(StandardMaterial {
        diffuse_transmission,
        ..Color::srgb(0.2, 0.8, 0.2).into()
    });
    let at = Transform::from_xyz;
    world.spawn((
        Mesh3d(wall),
        MeshMaterial3d(plain),
        at(0.0, 0.0, -8.0),
        Occluder::default(),
    ));
    world.spawn((Mesh3d(sheet), MeshMaterial3d(leaf), at(0.0, 0.0, -3.0)));
    world.spawn((
        PointLight {
            shadow_maps_enabled: true,
            intensity: 3e7,
            range: 60.0,
            ..default()
        },
        at(0.0, 0.0, -16.0),
    ));
}

#[test]
fn lights_behind_walls_are_left_out_unless_they_shine_through_what_is_seen() {
    let size = UVec2::new(120, 80);
    let mut brightest = [0; 2];
    for (case, transmission) in [0.0, 0.9].into_iter().enumerate() {
        let [mut plain, mut culled] = [Mode::Frustum, Mode::All].map(|mode| {
            Headless::new(size, Msaa::Off, |world| {
                sheet(world, transmission);
                mode.set(world);
            })
        });
        for frame in 0..8 {
            plain.frame();
            culled.frame();
            let (a, b) = (plain.picture(), culled.picture());
            assert_eq!(pixels_that_differ(&a, &b), 0, "{transmission}: {frame}");
            let green = a.as_chunks::<4>().0.iter().map(|pixel| pixel[1]);
            brightest[case] = brightest[case].max(green.max().unwrap());
        }
        let stats = culled.world().resource::<CpuOcclusionStats>();
        assert_eq!(stats.lights_unseen, 1 - case, "{stats:?}");
    }
    assert!(brightest[1] > brightest[0] + 20, "{brightest:?}");
}

#[test]
fn nothing_is_hidden_while_pipelines_are_compiled() {
    let mut app = Headless::with_pipelines(false, UVec2::new(64, 40), Msaa::Off, |world| {
        room(world);
        Mode::All.set(world);
    });
    let mut waited = 0;
    // At the end of the frame before last.
    let mut waiting = [false; 2];
    for _ in 0..10_000 {
        app.frame();
        let stats = *app.world().resource::<CpuOcclusionStats>();
        if waiting[0] {
            waited += 1;
            let hidden = stats.meshes_hidden + stats.casters_hidden;
            assert!(hidden == 0 && stats.waiting_views > 0, "{stats:?}");
        } else if stats.meshes_hidden > 0 {
            assert!(waited > 0, "no pipeline was compiled beside");
            return;
        }
        waiting = [waiting[1], app.pipelines_wait()];
    }
    panic!("all pipelines are compiled at some time");
}
