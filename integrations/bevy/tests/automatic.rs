//! Occluders that nobody marks: when they are found, and when they are none any more.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::prelude::*;
use bevy_foveal_cull::{AutomaticOccluder, AutomaticOccluders, NoOcclusionCulling, Occluder};
use world::TestWorld;

#[test]
fn large_opaque_things_that_stand_still_are_found() {
    let mut t = TestWorld::new();
    t.app.insert_resource(AutomaticOccluders {
        still_frames: 2,
        ..default()
    });
    let gray = MeshMaterial3d(t.add_material(StandardMaterial::default()));
    let glass = MeshMaterial3d(t.add_material(StandardMaterial {
        alpha_mode: AlphaMode::Blend,
        ..default()
    }));
    let wall = t.wall(Occluder::default());
    t.app.world_mut().entity_mut(wall).remove::<Occluder>();
    t.app.world_mut().entity_mut(wall).insert(glass.clone());
    let ball = t.ball(-9.0);
    let chosen = |t: &TestWorld| t.app.world().get::<AutomaticOccluder>(wall).is_some();
    for _ in 0..6 {
        t.update();
    }
    assert!(t.sees(ball) && !chosen(&t), "glass");
    t.app.world_mut().entity_mut(wall).insert(gray.clone());
    for _ in 0..6 {
        t.update();
    }
    assert!(!t.sees(ball) && chosen(&t));
    assert!(t.app.world().get::<Occluder>(ball).is_none(), "too small");

    t.get_mut::<Transform>(wall).translation.y = 0.1;
    t.app.update();
    assert!(!chosen(&t), "it moves");
    for _ in 0..6 {
        t.update();
    }
    assert!(!t.sees(ball) && chosen(&t), "it stands again");

    // Another material, none, or a mark: from the same frame on it occludes no more.
    let found = |t: &mut TestWorld| {
        for _ in 0..6 {
            t.update();
        }
        assert!(!t.sees(ball) && chosen(t));
    };
    t.app.world_mut().entity_mut(wall).insert(glass.clone());
    t.app.update();
    assert!(t.sees(ball) && !chosen(&t), "glass");
    t.app.world_mut().entity_mut(wall).insert(gray.clone());
    found(&mut t);
    t.app
        .world_mut()
        .entity_mut(wall)
        .remove::<MeshMaterial3d<StandardMaterial>>();
    t.app.update();
    assert!(t.sees(ball) && !chosen(&t), "no material");
    t.app.world_mut().entity_mut(wall).insert(gray);
    found(&mut t);
    t.app.world_mut().remove_resource::<AutomaticOccluders>();
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(NoOcclusionCulling);
    t.app.update();
    assert!(t.sees(ball) && !chosen(&t), "a mark, without the resource");
}

#[test]
fn what_was_found_hides_by_the_sides_that_its_material_draws_now() {
    let mut t = TestWorld::new();
    t.app.insert_resource(AutomaticOccluders {
        still_frames: 2,
        ..default()
    });
    let wall = t.wall(Occluder::default());
    t.app.world_mut().entity_mut(wall).remove::<Occluder>();
    let plane = t.add_mesh(Rectangle::new(8.0, 8.0));
    t.get_mut::<Mesh3d>(wall).0 = plane;
    t.get_mut::<Transform>(wall).rotate_y(core::f32::consts::PI);
    let material = t.add_material(StandardMaterial {
        cull_mode: None,
        ..default()
    });
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(MeshMaterial3d(material.clone()));
    let ball = t.ball(-9.0);
    for _ in 0..6 {
        t.update();
    }
    assert!(!t.sees(ball), "its back");
    t.app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .get_mut(&material)
        .unwrap()
        .cull_mode = Some(bevy::render::render_resource::Face::Back);
    for _ in 0..6 {
        t.app.update();
        assert!(t.sees(ball), "its back is not drawn any more");
    }
}
