//! Casters whose shadow nobody sees, and lights that light nothing that is seen, without a renderer.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, NoCpuCulling, NoFrustumCulling,
    ViewVisibility, VisibleMeshEntities,
};
use bevy::light::cluster::GlobalClusterSettings;
use bevy::light::{NotShadowReceiver, TransmittedShadowReceiver, VolumetricLight};
use bevy::pbr::decal::{ForwardDecal, ForwardDecalPlugin};
use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionCulling, NoOcclusionCulling, Occluder};
use world::TestWorld;

fn point_light(range: f32) -> PointLight {
    PointLight {
        shadow_maps_enabled: true,
        range,
        ..default()
    }
}

impl TestWorld {
    fn light(&mut self, light: impl Bundle, at: Transform) -> Entity {
        let culling = CpuOcclusionCulling::default();
        self.app.world_mut().spawn((light, at, culling)).id()
    }

    /// Whether a face of a point light's cube map lists the entity.
    fn casts(&self, light: Entity, entity: Entity) -> bool {
        let lists = self.app.world().get::<CubemapVisibleEntities>(light);
        lists.unwrap().iter().any(|l| l.entities.contains(&entity))
    }

    fn is_drawn(&self, light: Entity) -> bool {
        let visibility = self.app.world().get::<ViewVisibility>(light);
        visibility.unwrap().get()
    }
}

/// Before the wall, where the camera sees it.
const SEEN: Vec3 = Vec3::new(0.0, 0.0, -4.0);

#[test]
fn casters_whose_shadow_falls_on_nothing_that_is_seen_are_left_out() {
    let mut t = TestWorld::new();
    let seen = t.spawn_ball(SEEN, ());
    let before = t.spawn_ball(SEEN + Vec3::Y * 3.0, ());
    let beyond = t.spawn_ball(SEEN - Vec3::Y * 6.0, ());
    let beside = t.spawn_ball(SEEN + Vec3::new(20.0, 4.0, 0.0), ());
    let light = t.light(point_light(40.0), Transform::from_xyz(0.0, 5.0, -4.0));
    t.update();
    assert!(!t.sees(before) && !t.sees(beyond) && !t.sees(beside));
    assert!(t.casts(light, seen), "on itself");
    assert!(t.casts(light, before));
    assert!(!t.casts(light, beyond));
    assert!(!t.casts(light, beside));
    assert!(t.is_drawn(light));
    let stats = t.stats();
    assert_eq!((stats.casters_hidden, stats.lights_unseen), (0, 0));
    assert!(stats.casters_unseen >= 2, "{stats:?}");

    t.get_mut::<CpuOcclusionCulling>(light).keep_unseen_shadows = true;
    t.update();
    assert!(t.casts(light, beyond) && t.casts(light, beside));
    t.get_mut::<CpuOcclusionCulling>(light).keep_unseen_shadows = false;

    // A second camera without culling sees the ball beyond.
    let mut place = Transform::from_xyz(0.0, -10.0, 3.0);
    place.look_at(SEEN - Vec3::Y * 6.0, Vec3::Y);
    let camera = t.add_camera(place);
    let world = t.app.world_mut();
    world.entity_mut(camera).remove::<CpuOcclusionCulling>();
    t.update();
    assert!(t.casts(light, beyond));
}

#[test]
fn lights_that_light_nothing_that_is_seen_are_not_drawn() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let hidden = t.ball(-12.0);
    let light = t.light(point_light(3.0), Transform::from_xyz(0.0, 0.0, -11.0));
    t.update();
    assert!(!t.sees(hidden));
    assert!(!t.casts(light, hidden) && !t.is_drawn(light));
    assert_eq!(t.stats().lights_unseen, 1);

    // What is new is drawn for some frames, and the light with it.
    let newer = t.ball(-11.0);
    for frame in 1..world::FRAMES {
        t.app.update();
        assert!(t.casts(light, newer) && t.is_drawn(light), "frame {frame}");
    }
    t.app.update();
    assert!(!t.casts(light, newer) && !t.is_drawn(light));

    *t.get_mut::<Transform>(wall) = Transform::from_xyz(0.0, 20.0, -5.0);
    t.app.update();
    assert!(
        t.casts(light, hidden) && t.is_drawn(light),
        "the wall is gone"
    );
    *t.get_mut::<Transform>(wall) = Transform::from_xyz(0.0, 0.0, -5.0);
    t.app.update();
    assert!(!t.is_drawn(light), "it is back");
}

#[test]
fn lights_that_bevy_does_not_cull_on_the_processor_stay() {
    let mut t = TestWorld::new();
    t.spawn_ball(SEEN, ());
    let behind = Transform::from_xyz(0.0, 0.0, 20.0);
    let spot = SpotLight {
        shadow_maps_enabled: true,
        range: 3.0,
        ..default()
    };
    for light in [t.light(point_light(3.0), behind), t.light(spot, behind)] {
        t.update();
        assert!(!t.is_drawn(light));
        // Bevy shows it now, and would not show it again.
        t.app.world_mut().entity_mut(light).insert(NoCpuCulling);
        t.update();
        assert!(t.is_drawn(light));
    }
}

#[test]
fn lights_whose_light_ends_at_occluders_are_not_drawn_and_those_beyond_are() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let seen = t.spawn_ball(Vec3::new(0.0, 0.0, -2.0), ());
    t.paint(seen, StandardMaterial::default());
    let light = t.light(point_light(30.0), Transform::from_xyz(0.0, 0.0, -8.0));
    t.update();
    // The wall's far side is a part of what the camera sees.
    assert!(t.is_drawn(light) && t.casts(light, wall));
    assert!(!t.casts(light, seen), "it is in the wall's shadow");

    // A thick wall: its cells before the camera are far from its other side.
    t.app.world_mut().despawn(wall);
    let thick = t.wall(Occluder::default());
    *t.get_mut::<Transform>(thick) =
        Transform::from_xyz(0.0, 0.0, -25.0).with_scale(Vec3::new(20.0, 20.0, 100.0));
    *t.get_mut::<Transform>(light) = Transform::from_xyz(0.0, 0.0, -40.0);
    t.update();
    assert!(!t.is_drawn(light));
    // Nor where some faces have more casters than others.
    let many = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|x| t.spawn_ball(Vec3::new(x, 0.0, -37.0), ()));
    t.update();
    assert!(!t.is_drawn(light));
    for ball in many {
        t.app.world_mut().despawn(ball);
    }
    // Without shadows it would be lit.
    t.app.world_mut().entity_mut(seen).insert(NotShadowReceiver);
    t.get_mut::<PointLight>(light).range = 60.0;
    t.update();
    assert!(t.is_drawn(light));
    assert!(!t.casts(light, seen));
}

#[test]
fn what_may_be_anywhere_keeps_all_shadows() {
    let kept = |what: &dyn Fn(&mut TestWorld, Entity, Entity)| {
        let mut t = TestWorld::new();
        let seen = t.spawn_ball(SEEN, ());
        let beyond = t.spawn_ball(SEEN - Vec3::Y * 6.0, ());
        let light = t.light(point_light(40.0), Transform::from_xyz(0.0, 5.0, -4.0));
        what(&mut t, seen, light);
        t.update();
        t.casts(light, beyond)
    };
    assert!(!kept(&|_, _, _| ()));
    let with = |bundle: fn(&mut EntityWorldMut)| {
        kept(&move |t, seen, _| bundle(&mut t.app.world_mut().entity_mut(seen)))
    };
    assert!(with(|e| {
        e.insert(NoFrustumCulling);
    }));
    assert!(with(|e| {
        e.insert(NoOcclusionCulling);
    }));
    assert!(with(|e| {
        e.insert(TransmittedShadowReceiver);
    }));
    assert!(kept(&|t, _, light| {
        t.app.world_mut().entity_mut(light).insert(VolumetricLight);
    }));
}

#[test]
fn spot_lights_and_the_sun_leave_casters_out_too() {
    let mut t = TestWorld::new();
    let seen = t.spawn_ball(SEEN, ());
    t.paint(seen, StandardMaterial::default());
    let before = t.spawn_ball(SEEN + Vec3::Y * 3.0, ());
    let beyond = t.spawn_ball(SEEN - Vec3::Y * 6.0, ());
    let down = Transform::from_xyz(0.0, 6.0, -4.0).looking_at(SEEN, Vec3::Z);
    let spot = SpotLight {
        shadow_maps_enabled: true,
        range: 30.0,
        ..default()
    };
    let spot = t.light(spot, down);
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let sun = t.light(sun, down);
    t.update();
    let list = t.app.world().get::<VisibleMeshEntities>(spot).unwrap();
    assert_eq!(list.entities, world::sorted([seen, before]));
    let casters = t.app.world().get::<CascadesVisibleEntities>(sun).unwrap();
    let lists = &casters.entities[&t.camera];
    let listed = |entity| lists.iter().any(|list| list.entities.contains(&entity));
    assert!(listed(seen) && listed(before) && !listed(beyond));

    // A spot light on what is seen of nothing.
    *t.get_mut::<Transform>(spot) = down.looking_at(Vec3::new(30.0, 6.0, -4.0), Vec3::Z);
    t.update();
    assert!(!t.is_drawn(spot));
    let housing = Mesh3d(t.add_mesh(Cuboid::new(0.4, 0.4, 0.4)));
    t.app.world_mut().entity_mut(spot).insert(housing);
    t.update();
    assert!(t.is_drawn(spot));
}

/// A light behind a wall before which a ball is seen, all within its range. Returns whether it is drawn.
fn is_drawn_behind_a_wall(
    change: impl FnOnce(&mut TestWorld, Entity, Entity),
) -> (TestWorld, Entity, bool) {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    *t.get_mut::<Transform>(wall) =
        Transform::from_xyz(0.0, 0.0, -25.0).with_scale(Vec3::new(20.0, 20.0, 100.0));
    let seen = t.spawn_ball(Vec3::new(0.0, 0.0, -2.0), ());
    t.paint(seen, StandardMaterial::default());
    let light = t.light(point_light(60.0), Transform::from_xyz(0.0, 0.0, -40.0));
    change(&mut t, seen, light);
    t.update();
    let drawn = t.is_drawn(light);
    (t, light, drawn)
}

#[test]
fn lights_with_a_mesh_or_a_decal_on_their_entity_stay() {
    let drawn = |what: fn(&mut EntityWorldMut)| {
        is_drawn_behind_a_wall(|t, _, light| what(&mut t.app.world_mut().entity_mut(light))).2
    };
    assert!(!drawn(|_| ()));
    assert!(drawn(|light| {
        light.insert(bevy::light::ClusteredDecal::default());
    }));
    let (mut t, light, drawn) = is_drawn_behind_a_wall(|t, _, light| {
        let housing = Mesh3d(t.add_mesh(Cuboid::new(0.4, 0.4, 0.4)));
        t.app.world_mut().entity_mut(light).insert(housing);
    });
    assert!(drawn);
    // The housing is seen of another camera, and casts shadows of another light.
    let camera = t.add_camera(Transform::from_xyz(0.0, 0.0, -38.0));
    let other = t.light(point_light(60.0), Transform::from_xyz(0.0, 2.0, -40.0));
    t.update();
    let list = t
        .app
        .world()
        .get::<bevy::camera::visibility::VisibleEntities>(camera);
    assert!(
        list.unwrap()
            .get(core::any::TypeId::of::<Mesh3d>())
            .contains(&light)
    );
    assert!(t.is_drawn(light) && t.casts(other, light));
}

#[test]
fn lights_stay_where_something_seen_is_lit_without_shadows() {
    let drawn = |what: &dyn Fn(&mut TestWorld, Entity)| {
        is_drawn_behind_a_wall(|t, seen, _| what(t, seen)).2
    };
    let with = |bundle: fn(&mut EntityWorldMut)| {
        drawn(&move |t, seen| bundle(&mut t.app.world_mut().entity_mut(seen)))
    };
    assert!(!drawn(&|_, _| ()));
    assert!(drawn(&|t, seen| {
        let leaf = StandardMaterial {
            diffuse_transmission: 0.5,
            ..default()
        };
        t.paint(seen, leaf);
    }));
    assert!(
        with(|e| {
            e.remove::<MeshMaterial3d<StandardMaterial>>();
        }),
        "another material"
    );
    assert!(with(|e| {
        e.insert(NotShadowReceiver);
    }));
    assert!(with(|e| {
        e.insert((NotShadowReceiver, NoFrustumCulling));
    }));
    assert!(with(|e| {
        e.insert((NotShadowReceiver, NoCpuCulling));
    }));
    assert!(with(|e| {
        e.insert(NoCpuCulling);
    }));
}

#[test]
fn lights_stay_where_the_processor_fills_clusters_and_beyond_bevys_limit() {
    let drawn = |change: fn(&mut TestWorld)| is_drawn_behind_a_wall(|t, _, _| change(t)).2;
    assert!(drawn(|t| {
        let mut settings = t.app.world_mut().resource_mut::<GlobalClusterSettings>();
        settings.gpu_clustering = None;
    }));
    // Without a device four point lights are taken to have shadow maps.
    let others = |t: &mut TestWorld, count| {
        for _ in 0..count {
            t.app.world_mut().spawn(point_light(1.0));
        }
    };
    assert!(!is_drawn_behind_a_wall(|t, _, _| others(t, 3)).2);
    assert!(is_drawn_behind_a_wall(|t, _, _| others(t, 4)).2);
}

#[test]
fn what_is_drawn_in_front_of_walls_is_lit_and_casts_shadows_there() {
    let shadowed = |depth_bias: f32| {
        let mut t = TestWorld::new();
        t.wall(Occluder::default());
        // Drawn through the wall.
        let ball = t.ball(-9.0);
        let material = StandardMaterial {
            depth_bias,
            ..default()
        };
        t.paint(ball, material);
        let above = t.spawn_ball(Vec3::new(0.0, 3.0, -9.0), ());
        let light = t.light(point_light(20.0), Transform::from_xyz(0.0, 6.0, -9.0));
        t.update();
        assert_eq!(t.sees(ball), depth_bias > 0.0);
        t.casts(light, above)
    };
    assert!(shadowed(100.0));
    assert!(!shadowed(0.0));
}

#[test]
fn decals_that_receive_shadows_keep_all_of_them() {
    let mut t = TestWorld::with(|app| {
        app.init_asset::<Shader>().add_plugins(ForwardDecalPlugin);
    });
    t.spawn_ball(SEEN, NotShadowReceiver);
    let beyond = t.spawn_ball(SEEN - Vec3::Y * 6.0, ());
    let light = t.light(point_light(40.0), Transform::from_xyz(0.0, 5.0, -4.0));
    t.update();
    assert!(!t.casts(light, beyond));
    let decal = t.spawn_ball(SEEN, ForwardDecal);
    t.update();
    assert!(t.sees(decal) && t.casts(light, beyond));
}
