//! Occluders that nobody marks: when they are found, and when they are none any more.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::{NoCpuCulling, VisibilityRange};
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

/// A wall that is found after two frames, and a ball behind it.
fn wall_and_ball() -> (TestWorld, Entity, Entity) {
    let mut t = TestWorld::new();
    t.app.insert_resource(AutomaticOccluders {
        still_frames: 2,
        ..default()
    });
    let wall = t.wall(Occluder::default());
    t.app.world_mut().entity_mut(wall).remove::<Occluder>();
    let ball = t.ball(-9.0);
    (t, wall, ball)
}

fn is_chosen(t: &TestWorld, wall: Entity) -> bool {
    t.app.world().get::<AutomaticOccluder>(wall).is_some()
}

#[test]
fn what_loses_what_kept_it_from_being_chosen_is_chosen_without_a_move() {
    fn check<C: Component>(mark: C) {
        let (mut t, wall, ball) = wall_and_ball();
        t.app.world_mut().entity_mut(wall).insert(mark);
        for _ in 0..6 {
            t.update();
        }
        assert!(t.sees(ball) && !is_chosen(&t, wall));
        t.app.world_mut().entity_mut(wall).remove::<C>();
        for _ in 0..6 {
            t.update();
        }
        assert!(!t.sees(ball) && is_chosen(&t, wall));
    }
    check(NoOcclusionCulling);
    check(NoCpuCulling);
    check(VisibilityRange::abrupt(0.0, 50.0));
    check(Occluder::from_box(Vec3::splat(-0.05), Vec3::splat(0.05)));
}

#[test]
fn what_was_chosen_is_so_no_more_where_bevy_does_not_cull_it_on_the_processor() {
    let (mut t, wall, ball) = wall_and_ball();
    for _ in 0..6 {
        t.update();
    }
    assert!(!t.sees(ball) && is_chosen(&t, wall));
    t.app.world_mut().entity_mut(wall).insert(NoCpuCulling);
    t.app.update();
    assert!(t.sees(ball) && !is_chosen(&t, wall));
}

#[test]
fn an_occluder_of_the_users_on_what_was_chosen_stays_theirs() {
    let half = Vec3::new(3.5, 3.5, 0.05);
    for theirs in [Occluder::from_box(-half, half), Occluder::two_sided()] {
        let (mut t, wall, ball) = wall_and_ball();
        for _ in 0..6 {
            t.update();
        }
        assert!(is_chosen(&t, wall));
        t.app.world_mut().entity_mut(wall).insert(theirs.clone());
        t.app.update();
        assert!(!is_chosen(&t, wall));
        for _ in 0..6 {
            t.get_mut::<Transform>(wall).translation.y += 0.1;
            t.app.update();
            assert_eq!(t.app.world().get::<Occluder>(wall), Some(&theirs));
        }
        assert!(!t.sees(ball));

        // Without it the wall is found again, and moves with what was found.
        t.app.world_mut().entity_mut(wall).remove::<Occluder>();
        for _ in 0..6 {
            t.update();
        }
        assert!(!t.sees(ball) && is_chosen(&t, wall));
        t.get_mut::<Transform>(wall).translation.y += 0.1;
        t.app.update();
        assert!(t.app.world().get::<Occluder>(wall).is_none());
    }
}

#[test]
fn an_occluder_of_the_users_that_comes_with_a_move_stays_theirs() {
    let half = Vec3::new(3.5, 3.5, 0.05);
    let theirs = Occluder::from_box(-half, half);
    let (mut t, wall, _) = wall_and_ball();
    for _ in 0..6 {
        t.update();
    }
    assert!(is_chosen(&t, wall));
    t.app.world_mut().entity_mut(wall).insert(theirs.clone());
    t.get_mut::<Transform>(wall).translation.y += 0.1;
    t.app.update();
    assert!(!is_chosen(&t, wall));
    assert_eq!(t.app.world().get::<Occluder>(wall), Some(&theirs));
}

#[test]
fn what_need_not_stand_still_is_chosen_again_after_each_move() {
    let (mut t, wall, ball) = wall_and_ball();
    t.app
        .world_mut()
        .resource_mut::<AutomaticOccluders>()
        .still_frames = 0;
    t.update();
    assert!(is_chosen(&t, wall));
    t.get_mut::<Transform>(wall).translation.y += 0.1;
    t.update();
    t.update();
    assert!(!t.sees(ball) && is_chosen(&t, wall));
}
