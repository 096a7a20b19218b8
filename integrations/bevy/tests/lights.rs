//! What leaves the lists of shadow maps and what stays, without a renderer.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, RenderLayers, VisibleMeshEntities,
};
use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy_foveal_cull::{
    CpuOcclusionCulling, CpuOcclusionStats, NoOcclusionCulling, Occluder, OcclusionBufferSize,
};
use world::TestWorld;

/// Faces of a point light's cube map that list the entity.
fn faces(t: &TestWorld, light: Entity, entity: Entity) -> Vec<usize> {
    let lists = t.app.world().get::<CubemapVisibleEntities>(light).unwrap();
    lists
        .iter()
        .enumerate()
        .filter(|(_, list)| list.entities.contains(&entity))
        .map(|(face, _)| face)
        .collect()
}

/// Towards -z, by Bevy's order of cube map faces.
const FORWARD: usize = 4;
const BACKWARD: usize = 5;

const NOWHERE: [usize; 0] = [];

/// Without regard to what the camera sees.
const CULL: CpuOcclusionCulling = CpuOcclusionCulling {
    buffer_size: OcclusionBufferSize::Exact,
    keep_unseen_shadows: true,
};

fn point_light() -> PointLight {
    PointLight {
        shadow_maps_enabled: true,
        range: 30.0,
        ..default()
    }
}

#[test]
fn casters_behind_casters_leave_the_faces_of_a_point_light() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let hidden = t.ball(-9.0);
    let before = t.ball(-3.0);
    let other_side = t.ball(9.0);
    let light = t.app.world_mut().spawn((point_light(), CULL)).id();
    t.update();
    assert!(faces(&t, light, wall).contains(&FORWARD));
    assert_eq!(faces(&t, light, hidden), NOWHERE);
    assert_eq!(faces(&t, light, before), [FORWARD]);
    assert_eq!(faces(&t, light, other_side), [BACKWARD]);
    let stats = *t.app.world().resource::<CpuOcclusionStats>();
    assert_eq!((stats.light_views, stats.casters_hidden), (6, 1));
    for list in t
        .app
        .world()
        .get::<CubemapVisibleEntities>(light)
        .unwrap()
        .iter()
    {
        assert!(list.entities.is_sorted());
    }

    // A wall that casts no shadow hides nothing from lights, and still hides from cameras.
    t.app.world_mut().entity_mut(wall).insert(NotShadowCaster);
    t.update();
    assert_eq!(faces(&t, light, hidden), [FORWARD]);
    assert!(!t.sees(hidden));
    t.app
        .world_mut()
        .entity_mut(wall)
        .remove::<NotShadowCaster>();
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(RenderLayers::layer(1));
    t.update();
    assert_eq!(faces(&t, light, hidden), [FORWARD], "on another layer");
    t.app.world_mut().entity_mut(wall).remove::<RenderLayers>();
    t.update();
    assert_eq!(faces(&t, light, hidden), NOWHERE);

    // The light moves to the other side of the wall.
    t.app
        .world_mut()
        .entity_mut(light)
        .insert(Transform::from_xyz(0.0, 0.0, -15.0));
    t.update();
    assert_eq!(faces(&t, light, hidden), [BACKWARD]);
    assert_eq!(faces(&t, light, before), NOWHERE);

    t.app
        .world_mut()
        .entity_mut(light)
        .remove::<CpuOcclusionCulling>();
    t.update();
    assert_eq!(faces(&t, light, before), [BACKWARD], "Bevy's list");
}

#[test]
fn a_face_of_few_casters_is_tested_only_where_no_other_tells_that_light_falls() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let wall = t.wall(Occluder::default());
    t.get_mut::<Transform>(wall).translation.z *= -1.0;
    let hidden = [-9.0, 9.0].map(|z| t.ball(z));
    let light = t.app.world_mut().spawn((point_light(), CULL)).id();
    t.update();
    assert_eq!(hidden.map(|ball| faces(&t, light, ball).len()), [0, 0]);

    // With the wall five casters are before the light, and two behind it.
    let others = [(); 3].map(|()| t.ball(-3.0));
    t.update();
    assert_eq!(faces(&t, light, hidden[0]), NOWHERE);
    assert_eq!(faces(&t, light, hidden[1]), [BACKWARD], "drawn untested");
    for ball in others {
        assert_eq!(faces(&t, light, ball), [FORWARD]);
        t.app.world_mut().entity_mut(ball).despawn();
    }
    for _ in 0..3 {
        t.ball(3.0);
    }
    t.update();
    assert_eq!(faces(&t, light, hidden[0]), [FORWARD], "drawn untested");
    assert_eq!(faces(&t, light, hidden[1]), NOWHERE);
}

#[test]
fn boxes_hide_nothing_from_lights_whose_near_plane_may_cut_the_mesh_around_them() {
    let mut t = TestWorld::new();
    let half = Vec3::new(3.9, 3.9, 1.0);
    let block = t.wall(Occluder::from_box(-half, half));
    let mesh = t.add_mesh(Cuboid::new(8.0, 8.0, 4.0));
    t.get_mut::<Mesh3d>(block).0 = mesh;
    let ball = t.ball(-20.0);
    let point = t.app.world_mut().spawn((point_light(), CULL)).id();
    let spot = SpotLight {
        shadow_maps_enabled: true,
        range: 30.0,
        ..default()
    };
    let spot = t.app.world_mut().spawn((spot, CULL)).id();
    // The block begins at -3, and near planes lie 0.1 before the lights.
    for (z, hides) in [(0.0, true), (-2.95, false), (-3.5, false), (-2.8, true)] {
        for light in [point, spot] {
            t.get_mut::<Transform>(light).translation.z = z;
        }
        t.update();
        let of_spot = t.app.world().get::<VisibleMeshEntities>(spot).unwrap();
        let seen_by_spot = of_spot.entities.contains(&ball);
        let seen = (faces(&t, point, ball) == [FORWARD], seen_by_spot);
        assert_eq!(seen, (!hides, !hides), "from {z}");
    }
}

#[test]
fn boxes_hide_from_the_sun_wherever_its_near_plane_lies() {
    let mut t = TestWorld::new();
    let half = Vec3::new(3.9, 3.9, 1.0);
    let block = t.wall(Occluder::from_box(-half, half));
    let mesh = t.add_mesh(Cuboid::new(8.0, 8.0, 4.0));
    t.get_mut::<Mesh3d>(block).0 = mesh;
    // Casters before the near plane are drawn onto it.
    t.get_mut::<Transform>(block).translation.z = 40.0;
    let ball = t.ball(30.0);
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let sun = t.app.world_mut().spawn((sun, CULL)).id();
    t.update();
    let casters = t.app.world().get::<CascadesVisibleEntities>(sun).unwrap();
    let mut lists = casters.entities[&t.camera].iter();
    assert!(!lists.any(|list| list.entities.contains(&ball)));
}

#[test]
fn casters_are_relied_on_after_some_frames() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    t.update();
    let light = t.app.world_mut().spawn((point_light(), CULL)).id();
    let hidden = t.ball(-9.0);
    let seen_until_settled = |t: &mut TestWorld, entity| {
        for frame in 1..world::FRAMES {
            t.app.update();
            assert_eq!(faces(t, light, entity), [FORWARD], "frame {frame}");
        }
        t.app.update();
        assert_eq!(faces(t, light, entity), NOWHERE);
    };
    seen_until_settled(&mut t, hidden);
    let newer = t.ball(-8.0);
    seen_until_settled(&mut t, newer);
    t.paint(wall, StandardMaterial::default());
    seen_until_settled(&mut t, newer);
}

#[test]
fn marked_casters_stay() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let kept = t.spawn_ball(Vec3::new(0.0, 0.0, -9.0), NoOcclusionCulling);
    let light = t.app.world_mut().spawn((point_light(), CULL)).id();
    t.update();
    assert_eq!(faces(&t, light, kept), [FORWARD]);
}

#[test]
fn casters_behind_casters_leave_a_spot_light() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let hidden = t.ball(-9.0);
    let before = t.ball(-3.0);
    let light = SpotLight {
        shadow_maps_enabled: true,
        range: 30.0,
        ..default()
    };
    let light = t.app.world_mut().spawn((light, CULL)).id();
    let listed = |t: &TestWorld| {
        let list = t.app.world().get::<VisibleMeshEntities>(light).unwrap();
        list.entities.clone()
    };
    t.update();
    assert_eq!(listed(&t), world::sorted([wall, before]));
    *t.get_mut::<Transform>(wall) = Transform::from_xyz(0.0, 20.0, -5.0);
    t.update();
    assert!(listed(&t).contains(&hidden), "the wall has moved away");
}

#[test]
fn casters_behind_casters_leave_the_cascades_of_the_sun() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let hidden = t.ball(-9.0);
    let before = t.ball(-3.0);
    // Behind the camera, where cascades have no near plane: another wall, and what it hides.
    let far_wall = t.wall(Occluder::default());
    *t.get_mut::<Transform>(far_wall) = Transform::from_xyz(0.0, 0.0, 40.0);
    let behind_far_wall = t.ball(30.0);
    let before_far_wall = t.ball(50.0);
    let sun = t
        .app
        .world_mut()
        .spawn((
            DirectionalLight {
                shadow_maps_enabled: true,
                ..default()
            },
            CULL,
        ))
        .id();
    let cascades_with = |t: &TestWorld, entity: Entity| {
        let casters = t.app.world().get::<CascadesVisibleEntities>(sun).unwrap();
        let lists = &casters.entities[&t.camera];
        assert_eq!(lists.len(), 4);
        lists
            .iter()
            .filter(|list| list.entities.contains(&entity))
            .count()
    };
    t.update();
    assert!(cascades_with(&t, far_wall) > 0);
    assert!(cascades_with(&t, before_far_wall) > 0);
    for entity in [hidden, before, behind_far_wall] {
        assert_eq!(cascades_with(&t, entity), 0, "all behind the far wall");
    }
    t.app.world_mut().despawn(far_wall);
    t.update();
    assert!(cascades_with(&t, behind_far_wall) > 0);
    assert!(cascades_with(&t, wall) > 0 && cascades_with(&t, before) > 0);
    assert_eq!(cascades_with(&t, hidden), 0);
    assert_eq!(t.app.world().resource::<CpuOcclusionStats>().light_views, 4);
}

#[test]
fn lights_without_shadows_are_left_alone() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    t.app.world_mut().spawn((PointLight::default(), CULL));
    t.update();
    assert_eq!(t.app.world().resource::<CpuOcclusionStats>().light_views, 0);
}
