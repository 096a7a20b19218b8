//! What is relied on is what Bevy draws: no sooner, no longer, and not what is drawn on top.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::{DynamicSkinnedMeshBounds, VisibilitySystems, VisibleEntities};
use bevy::mesh::skinning::{
    JointAabb, JointIndex, SkinnedMesh, SkinnedMeshBounds, SkinnedMeshInverseBindposes,
};
use bevy::pbr::decal::{ForwardDecal, ForwardDecalPlugin};
use bevy::pbr::wireframe::{Wireframe, WireframeConfig};
use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, Face};
use bevy_foveal_cull::{CpuOcclusionSystems, Occluder, OccluderMaterialPlugin};
use core::any::TypeId;
use world::{FRAMES, TestWorld};

/// Until the last of the frames that a change takes, the ball is seen.
fn seen_until_settled(t: &mut TestWorld, ball: Entity) {
    for frame in 1..FRAMES {
        t.app.update();
        assert!(t.sees(ball), "frame {frame}");
    }
    t.app.update();
    assert!(!t.sees(ball));
}

#[test]
fn new_walls_new_balls_and_changed_walls_are_relied_on_after_some_frames() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    seen_until_settled(&mut t, ball);
    let newer = t.ball(-8.0);
    seen_until_settled(&mut t, newer);
    t.paint(wall, StandardMaterial::default());
    seen_until_settled(&mut t, ball);
    let mesh = t.add_mesh(Cuboid::new(8.0, 8.0, 0.1));
    t.app.world_mut().entity_mut(wall).insert(Mesh3d(mesh));
    seen_until_settled(&mut t, ball);
    // What moves is drawn where it is.
    t.get_mut::<Transform>(wall).translation.x = 0.5;
    t.app.update();
    assert!(!t.sees(ball));
}

#[test]
fn walls_hide_nothing_until_their_textures_are_loaded() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let bricks = t.app.world().resource::<Assets<Image>>().reserve_handle();
    let material = StandardMaterial {
        normal_map_texture: Some(bricks.clone()),
        ..default()
    };
    t.paint(wall, material);
    for _ in 0..20 {
        t.app.update();
        assert!(t.sees(ball), "Bevy does not draw the wall");
    }
    let mut images = t.app.world_mut().resource_mut::<Assets<Image>>();
    images.insert(&bricks, Image::default()).unwrap();
    seen_until_settled(&mut t, ball);

    // A new texture at run time.
    let moss = t.app.world().resource::<Assets<Image>>().reserve_handle();
    let material = t.app.world().get::<MeshMaterial3d<StandardMaterial>>(wall);
    let material = material.unwrap().0.clone();
    let mut materials = t.app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    materials.get_mut(&material).unwrap().base_color_texture = Some(moss);
    for _ in 0..20 {
        t.app.update();
        assert!(t.sees(ball));
    }
}

#[test]
fn meshes_without_a_material_hide_nothing() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.update();
    assert!(!t.sees(ball));
    t.app
        .world_mut()
        .entity_mut(wall)
        .remove::<MeshMaterial3d<StandardMaterial>>();
    t.app.update();
    assert!(t.sees(ball));
    let half = Vec3::new(3.0, 3.0, 0.1);
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(Occluder::from_box(-half, half));
    t.update();
    assert!(t.sees(ball));
}

#[test]
fn skinned_and_morphing_meshes_do_not_occlude() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let half = Vec3::new(4.0, 4.0, 0.1);
    let bounds = SkinnedMeshBounds {
        aabbs: vec![JointAabb {
            center: Vec3::ZERO,
            half_size: half,
        }],
        aabb_index_to_joint_index: vec![JointIndex(0)],
    };
    let bounded = Mesh::from(Cuboid::from_size(2.0 * half)).with_skinned_mesh_bounds(Some(bounds));
    let bounded = t.add_mesh(bounded);
    t.get_mut::<Mesh3d>(wall).0 = bounded;
    let place = *t.get_mut::<Transform>(wall);
    let world = t.app.world_mut();
    let inverse_bindposes = world
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .add(vec![Mat4::IDENTITY]);
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: vec![world.spawn(place).id()],
    };
    world.entity_mut(wall).insert(skin);
    t.update();
    assert!(t.sees(ball));
    let occluder = Occluder::from_box(-half, half);
    t.app.world_mut().entity_mut(wall).insert(occluder);
    t.update();
    assert!(t.sees(ball), "where the mesh is around the box is unknown");
    let world = t.app.world_mut();
    world.entity_mut(wall).insert(DynamicSkinnedMeshBounds);
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn what_a_view_does_not_list_hides_nothing_from_it() {
    #[derive(Resource)]
    struct Unlisted(Entity);
    let mut t = TestWorld::new();
    t.app.add_systems(
        PostUpdate,
        (|mut views: Query<&mut VisibleEntities>, unlisted: Option<Res<Unlisted>>| {
            let Some(unlisted) = unlisted else { return };
            for mut view in &mut views {
                view.get_mut(TypeId::of::<Mesh3d>())
                    .retain(|entity| *entity != unlisted.0);
            }
        })
        .after(VisibilitySystems::CheckVisibility)
        .before(CpuOcclusionSystems::CullCameras),
    );
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.update();
    assert!(!t.sees(ball));
    t.app.insert_resource(Unlisted(wall));
    t.app.update();
    assert!(t.sees(ball), "another system has taken the wall away");
    t.app.world_mut().remove_resource::<Unlisted>();
    t.app.update();
    assert!(!t.sees(ball));
}

#[test]
fn what_is_drawn_on_top_of_what_is_nearer_stays() {
    let mut t = TestWorld::with(|app| {
        app.init_asset::<Shader>().add_plugins(ForwardDecalPlugin);
    });
    t.wall(Occluder::default());
    let at = Vec3::new(0.0, 0.0, -9.0);
    let ball = t.spawn_ball(at, ());
    let decal = t.spawn_ball(at, ForwardDecal);
    let wire = t.spawn_ball(at, Wireframe);
    let biased = t.spawn_ball(at, ());
    t.paint(
        biased,
        StandardMaterial {
            depth_bias: 20.0,
            ..default()
        },
    );
    let pushed_back = t.spawn_ball(at, ());
    t.paint(
        pushed_back,
        StandardMaterial {
            depth_bias: -20.0,
            ..default()
        },
    );
    t.update();
    assert!(t.sees(decal) && t.sees(wire) && t.sees(biased));
    assert!(!t.sees(ball) && !t.sees(pushed_back));
    t.app.insert_resource(WireframeConfig {
        global: true,
        ..default()
    });
    t.app.update();
    assert!(t.sees(ball), "lines of all meshes");
}

#[derive(Asset, AsBindGroup, TypePath, Clone, Debug, Default)]
struct Moss {}

impl MaterialExtension for Moss {}

type Mossy = ExtendedMaterial<StandardMaterial, Moss>;

/// A wall of a material of one's own, and a ball behind it.
fn mossy(
    base: StandardMaterial,
    plugin: Option<OccluderMaterialPlugin<Mossy>>,
) -> (TestWorld, Entity, Entity) {
    let mut t = TestWorld::with(|app| {
        app.init_asset::<Mossy>();
        if let Some(plugin) = plugin {
            app.add_plugins(plugin);
        }
    });
    let wall = t.wall(Occluder::default());
    let material = Mossy {
        base,
        extension: Moss {},
    };
    let material = t
        .app
        .world_mut()
        .resource_mut::<Assets<Mossy>>()
        .add(material);
    t.app
        .world_mut()
        .entity_mut(wall)
        .remove::<MeshMaterial3d<StandardMaterial>>()
        .insert(MeshMaterial3d(material));
    let ball = t.ball(-9.0);
    (t, wall, ball)
}

#[test]
fn materials_of_ones_own_occlude_as_their_plugin_says() {
    let default = || Some(OccluderMaterialPlugin::default());
    let (mut t, _, ball) = mossy(StandardMaterial::default(), None);
    t.update();
    assert!(t.sees(ball), "nothing is known of the material");

    let (mut t, wall, ball) = mossy(StandardMaterial::default(), default());
    t.update();
    assert!(!t.sees(ball));
    // A plane from behind: nobody says that its back is drawn.
    let plane = t.add_mesh(Rectangle::new(8.0, 8.0));
    t.get_mut::<Mesh3d>(wall).0 = plane;
    t.get_mut::<Transform>(wall).rotate_y(core::f32::consts::PI);
    t.app
        .world_mut()
        .entity_mut(wall)
        .insert(Occluder::two_sided());
    t.update();
    assert!(t.sees(ball));

    // Such materials draw the other side in a mirror.
    let (mut t, _, ball) = mossy(StandardMaterial::default(), default());
    t.get_mut::<Transform>(t.camera).scale.x = -1.0;
    t.get_mut::<Camera>(t.camera).invert_culling = true;
    t.update();
    assert!(t.sees(ball) && t.stats().refused_views == 0);
}

#[test]
fn extended_materials_occlude_as_the_standard_material_in_them() {
    let based = || {
        Some(OccluderMaterialPlugin::based_on(|material: &Mossy| {
            Some(&material.base)
        }))
    };
    for (cull_mode, hides) in [
        (None, true),
        (Some(Face::Back), true),
        (Some(Face::Front), false),
    ] {
        let base = StandardMaterial {
            cull_mode,
            ..default()
        };
        let (mut t, _, ball) = mossy(base, based());
        t.update();
        assert_eq!(!t.sees(ball), hides, "{cull_mode:?}");
    }
    let not_loaded = Handle::Uuid(
        bevy::asset::uuid::Uuid::from_u128(7),
        core::marker::PhantomData,
    );
    let base = StandardMaterial {
        base_color_texture: Some(not_loaded),
        ..default()
    };
    let (mut t, _, ball) = mossy(base, based());
    t.update();
    assert!(t.sees(ball), "its texture is not loaded");

    // As what is tested, too.
    let base = StandardMaterial {
        depth_bias: 20.0,
        ..default()
    };
    let (mut t, wall, ball) = mossy(base, based());
    let nearer = t.wall(Occluder::default());
    t.get_mut::<Transform>(nearer).translation.z = -3.0;
    t.update();
    assert!(t.sees(wall), "it is drawn in front");
    assert!(!t.sees(ball));
}
