//! What leaves a camera's list and what stays, without a renderer.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::{
    DynamicSkinnedMeshBounds, NoAutoAabb, NoCpuCulling, NoFrustumCulling, RenderLayers,
    VisibilityRange,
};
use bevy::diagnostic::DiagnosticsStore;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{
    JointAabb, JointIndex, SkinnedMesh, SkinnedMeshBounds, SkinnedMeshInverseBindposes,
};
use bevy::prelude::*;
use bevy_foveal_cull::{
    CpuOcclusionCulling, CpuOcclusionPlugin, CpuOcclusionStats, NoOcclusionCulling, Occluder,
};
use world::{TestWorld, sorted};

#[test]
fn the_hidden_leave_and_the_visible_stay() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let behind = t.ball(-9.0);
    let before = t.ball(-3.0);
    *t.get_mut::<Transform>(wall) = Transform::from_xyz(-2.0, 0.0, -5.0);
    let beside = t.spawn_ball(Vec3::new(4.0, 0.0, -9.0), ());
    t.update();
    assert_eq!(t.visible(), sorted([wall, before, beside]));
    let stats = *t.app.world().resource::<CpuOcclusionStats>();
    assert_eq!((stats.occluders, stats.cameras), (1, 1));
    assert_eq!(
        (stats.meshes, stats.meshes_hidden, stats.refused_views),
        (4, 1, 0)
    );

    // Bevy's list again without the component.
    t.app
        .world_mut()
        .entity_mut(t.camera)
        .remove::<CpuOcclusionCulling>();
    t.update();
    assert_eq!(t.visible(), sorted([wall, behind, before, beside]));
}

#[test]
fn doors_open_and_walls_come_and_go() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.update();
    assert!(!t.sees(ball));

    *t.get_mut::<Transform>(wall) = Transform::from_xyz(20.0, 0.0, -5.0);
    t.update();
    assert!(t.sees(ball), "the wall has moved away");
    *t.get_mut::<Transform>(wall) = Transform::from_xyz(0.0, 0.0, -5.0);
    t.update();
    assert!(!t.sees(ball));

    *t.get_mut::<Visibility>(wall) = Visibility::Hidden;
    t.update();
    assert!(t.sees(ball), "the wall is not drawn");
    *t.get_mut::<Visibility>(wall) = Visibility::Inherited;
    t.update();
    assert!(!t.sees(ball));

    t.app.world_mut().entity_mut(wall).remove::<Occluder>();
    t.update();
    assert!(t.sees(ball), "the wall is no occluder");
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(Occluder::default());
    t.update();
    assert!(!t.sees(ball));

    t.app.world_mut().despawn(wall);
    t.update();
    assert!(t.sees(ball), "the wall is gone");
}

#[test]
fn children_of_hidden_and_moved_parents_occlude_as_they_are_drawn() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let parent = t
        .app
        .world_mut()
        .spawn((Transform::default(), Visibility::default()))
        .add_child(wall)
        .id();
    t.update();
    assert!(!t.sees(ball));
    *t.get_mut::<Visibility>(parent) = Visibility::Hidden;
    t.update();
    assert!(t.sees(ball));
    *t.get_mut::<Visibility>(parent) = Visibility::Inherited;
    *t.get_mut::<Transform>(parent) = Transform::from_xyz(30.0, 0.0, 0.0);
    t.update();
    assert!(t.sees(ball));
}

#[test]
fn boxes_without_a_mesh_follow_the_visibility_of_their_parents() {
    let mut t = TestWorld::new();
    let ball = t.ball(-9.0);
    let half = Vec3::new(4.0, 4.0, 0.1);
    let world = t.app.world_mut();
    let child = world.spawn((Transform::default(), Occluder::from_box(-half, half)));
    let child = child.id();
    let place = Transform::from_xyz(0.0, 0.0, -5.0);
    let parent = world.spawn((place, Visibility::default()));
    let parent = parent.id();
    world.entity_mut(parent).add_child(child);
    t.update();
    assert!(!t.sees(ball));
    *t.get_mut::<Visibility>(parent) = Visibility::Hidden;
    t.update();
    assert!(t.sees(ball));
    *t.get_mut::<Visibility>(parent) = Visibility::Inherited;
    t.update();
    assert!(!t.sees(ball));
    // A box is the same box where a scale mirrors it.
    t.get_mut::<Transform>(parent).scale.x = -1.0;
    t.update();
    assert!(!t.sees(ball));
    *t.get_mut::<Visibility>(child) = Visibility::Hidden;
    t.update();
    assert!(t.sees(ball));
}

#[test]
fn boxes_that_are_inside_out_hide_nothing() {
    let mut t = TestWorld::new();
    let ball = t.ball(-9.0);
    // Around the camera: the faces of such a box would look at it.
    let corner = Vec3::splat(2.0);
    t.app
        .world_mut()
        .spawn((Transform::default(), Occluder::from_box(corner, -corner)));
    t.update();
    assert!(t.sees(ball));
}

#[test]
fn changed_meshes_occlude_as_they_are_now() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.update();
    assert!(!t.sees(ball));

    let handle = t.get_mut::<Mesh3d>(wall).0.clone();
    let scale = |t: &mut TestWorld, by: f32| {
        let mut meshes = t.app.world_mut().resource_mut::<Assets<Mesh>>();
        let mut mesh = meshes.get_mut(&handle).unwrap();
        let positions = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION).unwrap();
        let VertexAttributeValues::Float32x3(positions) = positions else {
            panic!("positions");
        };
        for p in positions {
            *p = p.map(|v| v * by);
        }
    };
    scale(&mut t, 0.01);
    t.update();
    assert!(t.sees(ball), "the asset has shrunk");
    scale(&mut t, 100.0);
    t.update();
    assert!(!t.sees(ball));

    let small = t.add_mesh(Cuboid::new(0.1, 0.1, 0.1));
    t.get_mut::<Mesh3d>(wall).0 = small;
    t.update();
    assert!(t.sees(ball), "the entity has another mesh");
}

#[test]
fn a_mesh_that_is_loaded_later_occludes_from_then_on() {
    let mut t = TestWorld::new();
    let handle = t.app.world().resource::<Assets<Mesh>>().reserve_handle();
    let wall = t.wall(Occluder::default());
    t.get_mut::<Mesh3d>(wall).0 = handle.clone();
    let ball = t.ball(-9.0);
    t.update();
    assert!(t.sees(ball));
    let mesh = Mesh::from(Cuboid::new(8.0, 8.0, 0.2));
    t.app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .insert(&handle, mesh)
        .unwrap();
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn occluders_on_other_layers_hide_nothing() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.spawn_ball(
        Vec3::new(0.0, 0.0, -9.0),
        RenderLayers::from_layers(&[0, 1]),
    );
    let layer = |n: usize| RenderLayers::layer(n);
    t.app.world_mut().entity_mut(wall).insert(layer(1));
    t.update();
    assert!(t.sees(ball), "the camera does not draw the wall");
    t.app.world_mut().entity_mut(t.camera).insert(layer(1));
    t.update();
    assert!(!t.sees(ball));
    t.app.world_mut().entity_mut(wall).remove::<RenderLayers>();
    t.update();
    assert!(t.sees(ball), "the wall is back on layer 0");
}

#[test]
fn what_must_stay_stays() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let at = Vec3::new(0.0, 0.0, -9.0);
    let kept = [
        t.spawn_ball(at, NoOcclusionCulling),
        t.spawn_ball(at, NoFrustumCulling),
        t.spawn_ball(at, SkinnedMesh::default()),
        t.spawn_ball(at, MeshMorphWeights::Value { weights: vec![] }),
    ];
    let culled = t.ball(-9.0);
    // Its box follows its joints.
    let bounds = SkinnedMeshBounds {
        aabbs: vec![JointAabb {
            center: Vec3::ZERO,
            half_size: Vec3::splat(0.5),
        }],
        aabb_index_to_joint_index: vec![JointIndex(0)],
    };
    let bounded = Mesh::from(Sphere::new(0.5)).with_skinned_mesh_bounds(Some(bounds));
    let bounded = t.add_mesh(bounded);
    let joint = t
        .app
        .world_mut()
        .spawn(Transform::from_translation(at))
        .id();
    let poses = t
        .app
        .world()
        .resource::<Assets<SkinnedMeshInverseBindposes>>();
    let skin = SkinnedMesh {
        inverse_bindposes: poses.reserve_handle(),
        joints: vec![joint],
    };
    let follows = t.spawn_ball(at, (skin.clone(), DynamicSkinnedMeshBounds));
    let unbounded = t.spawn_ball(at, (skin.clone(), DynamicSkinnedMeshBounds));
    t.get_mut::<Mesh3d>(follows).0 = bounded;
    t.update();
    for entity in kept {
        assert!(t.sees(entity));
    }
    assert!(!t.sees(culled));
    assert!(t.sees(unbounded), "the mesh has no bounds of joints");
    assert!(t.sees(follows), "the bind poses are not loaded");
    t.app
        .world_mut()
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .insert(&skin.inverse_bindposes, vec![Mat4::IDENTITY].into())
        .unwrap();
    t.update();
    assert!(!t.sees(follows));
    t.app.world_mut().despawn(joint);
    t.update();
    assert!(t.sees(follows), "a joint is gone, and its bounds are old");
}

#[test]
fn transparent_materials_do_not_occlude() {
    let mut t = TestWorld::new();
    let glass = t.add_material(StandardMaterial {
        alpha_mode: AlphaMode::Blend,
        ..default()
    });
    let wall = t.wall(Occluder::default());
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(MeshMaterial3d(glass.clone()));
    let ball = t.ball(-9.0);
    t.update();
    assert!(t.sees(ball), "through glass");
    t.app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .get_mut(&glass)
        .unwrap()
        .alpha_mode = AlphaMode::Opaque;
    t.update();
    assert!(!t.sees(ball), "the material has become opaque");
    t.app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .remove(&glass);
    t.update();
    assert!(t.sees(ball), "without a material it is not drawn");
}

#[test]
fn occluders_that_fade_or_are_out_of_range_hide_nothing() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    for (range, hides) in [
        (VisibilityRange::abrupt(0.0, 50.0), true),
        (VisibilityRange::abrupt(20.0, 50.0), false),
        (
            VisibilityRange {
                start_margin: 0.0..0.0,
                end_margin: 3.0..50.0,
                use_aabb: false,
            },
            false,
        ),
    ] {
        t.app.world_mut().entity_mut(wall).insert(range);
        t.update();
        assert_eq!(!t.sees(ball), hides);
    }
}

#[test]
fn planes_hide_from_behind_only_if_two_sided() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let plane = t.add_mesh(Rectangle::new(8.0, 8.0));
    t.get_mut::<Mesh3d>(wall).0 = plane;
    let of_both_sides = || StandardMaterial {
        cull_mode: None,
        ..default()
    };
    t.paint(wall, of_both_sides());
    let ball = t.ball(-9.0);
    t.update();
    assert!(!t.sees(ball), "its front");
    t.get_mut::<Transform>(wall).rotate_y(core::f32::consts::PI);
    t.update();
    assert!(t.sees(ball), "its back, by which it does not occlude");
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(Occluder::two_sided());
    t.update();
    assert!(!t.sees(ball));
    // A material that culls back faces has the last word.
    t.paint(wall, StandardMaterial::default());
    t.update();
    assert!(t.sees(ball));
}

#[test]
fn what_a_scale_mirrors_hides_only_with_the_faces_that_are_drawn() {
    use bevy::render::render_resource::Face;
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let proxy = t.add_mesh(Cuboid::new(7.0, 7.0, 0.1));
    let half = Vec3::new(3.5, 3.5, 0.05);
    for occluder in [
        Occluder::default(),
        Occluder::from_box(-half, half),
        Occluder::from_proxy(proxy),
    ] {
        t.app.world_mut().entity_mut(wall).insert(occluder.clone());
        for (cull_mode, scale, hides) in [
            (Some(Face::Back), 1.0, true),
            (Some(Face::Back), -1.0, false),
            (Some(Face::Front), 1.0, false),
            (Some(Face::Front), -1.0, true),
        ] {
            t.paint(
                wall,
                StandardMaterial {
                    cull_mode,
                    ..default()
                },
            );
            t.get_mut::<Transform>(wall).scale.x = scale;
            t.update();
            assert_eq!(!t.sees(ball), hides, "{occluder:?} {cull_mode:?} {scale}");
        }
    }
}

#[test]
fn boxes_and_proxies_stand_for_meshes() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::from_box(Vec3::splat(-0.05), Vec3::splat(0.05)));
    let ball = t.ball(-9.0);
    t.update();
    assert!(t.sees(ball), "the box is smaller than the mesh");
    let proxy = t.add_mesh(Cuboid::new(7.0, 7.0, 0.1));
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(Occluder::from_proxy(proxy));
    t.update();
    assert!(!t.sees(ball));
    // A box needs no mesh at all.
    t.app.world_mut().despawn(wall);
    t.app.world_mut().spawn((
        Transform::from_xyz(0.0, 0.0, -5.0),
        Occluder::from_box(Vec3::new(-4.0, -4.0, -0.1), Vec3::new(4.0, 4.0, 0.1)),
    ));
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn boxes_and_proxies_hide_nothing_where_the_near_plane_may_cut_the_mesh_around_them() {
    let mut t = TestWorld::new();
    let half = Vec3::new(3.9, 3.9, 1.0);
    let block = t.wall(Occluder::default());
    let mesh = t.add_mesh(Cuboid::new(8.0, 8.0, 4.0));
    t.get_mut::<Mesh3d>(block).0 = mesh;
    let proxy = t.add_mesh(Cuboid::from_size(2.0 * half));
    let ball = t.ball(-20.0);
    for occluder in [Occluder::from_box(-half, half), Occluder::from_proxy(proxy)] {
        t.app.world_mut().entity_mut(block).insert(occluder);
        // The block begins at -3, what is in it at -4, and the near plane lies 0.1 before the eye.
        for (z, hides) in [(0.0, true), (-2.95, false), (-3.5, false), (-2.8, true)] {
            t.get_mut::<Transform>(t.camera).translation.z = z;
            t.update();
            assert_eq!(!t.sees(ball), hides, "from {z}");
        }
    }
    // The own mesh is cut as it is drawn.
    t.app
        .world_mut()
        .entity_mut(block)
        .insert(Occluder::default());
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn boxes_in_meshes_whose_bounds_are_unknown_hide_nothing() {
    let half = Vec3::new(3.9, 3.9, 0.05);
    let hides = |change: fn(&mut EntityWorldMut)| {
        let mut t = TestWorld::new();
        let wall = t.wall(Occluder::from_box(-half, half));
        let ball = t.ball(-9.0);
        change(&mut t.app.world_mut().entity_mut(wall));
        t.update();
        !t.sees(ball)
    };
    assert!(hides(|_| ()));
    assert!(!hides(|wall| {
        wall.insert(NoFrustumCulling);
    }));
    assert!(!hides(|wall| {
        wall.insert(NoAutoAabb);
    }));
    assert!(!hides(|wall| {
        wall.insert(SkinnedMesh::default());
    }));
    assert!(!hides(|wall| {
        wall.insert(MeshMorphWeights::Value { weights: vec![] });
    }));
}

#[test]
fn what_bevy_does_not_cull_on_the_processor_hides_nothing() {
    let mut t = TestWorld::new();
    let half = Vec3::new(3.9, 3.9, 0.05);
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    for occluder in [Occluder::default(), Occluder::from_box(-half, half)] {
        t.app.world_mut().entity_mut(wall).insert(occluder);
        t.update();
        assert!(!t.sees(ball));
        t.app.world_mut().entity_mut(wall).insert(NoCpuCulling);
        t.update();
        assert!(t.sees(ball));
        t.app.world_mut().entity_mut(wall).remove::<NoCpuCulling>();
    }
}

#[test]
fn the_stats_are_diagnostics_too() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    t.ball(-9.0);
    t.update();
    t.update();
    let store = t.app.world().resource::<DiagnosticsStore>();
    let of = |path| store.get(&path).and_then(|d| d.value());
    assert_eq!(of(CpuOcclusionPlugin::MESHES), Some(2.0));
    assert_eq!(of(CpuOcclusionPlugin::MESHES_HIDDEN), Some(1.0));
    assert!(of(CpuOcclusionPlugin::TIME).is_some_and(|ms| ms > 0.0));
}
