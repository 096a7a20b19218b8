//! Cameras of all kinds: what leaves their lists and what stays, without a renderer.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod world;

use bevy::camera::visibility::VisibleEntities;
use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionCulling, CpuOcclusionStats, Occluder, OcclusionBufferSize};
use world::{TestWorld, sorted};

#[test]
fn orthographic_cameras_cull() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.look_through(Projection::Orthographic(OrthographicProjection {
        scale: 0.02,
        ..OrthographicProjection::default_3d()
    }));
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn oblique_near_planes_leave_occluders_that_lie_wholly_beyond_them() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let behind = |z: f32| {
        // Turned to the right, and so far from the camera.
        let normal = Vec3::new(0.2, 0.0, -1.0).normalize();
        Projection::Perspective(PerspectiveProjection {
            near_clip_plane: normal.extend(z * normal.z),
            ..default()
        })
    };
    t.look_through(behind(2.0));
    t.update();
    assert!(!t.sees(ball));
    assert_eq!(t.stats().refused_views, 0);
    t.look_through(behind(5.0));
    t.update();
    assert!(t.sees(ball), "the plane cuts the wall");
    t.look_through(behind(7.0));
    t.update();
    assert!(t.sees(ball), "the wall is not drawn");

    // A box in the wall is hidden from view where the wall is cut.
    t.look_through(behind(5.0));
    let occluder = Occluder::from_box(Vec3::new(-4.0, -4.0, -3.0), Vec3::new(4.0, 4.0, -2.0));
    *t.get_mut::<Occluder>(wall) = occluder;
    t.get_mut::<Transform>(ball).translation.z = -20.0;
    t.update();
    assert!(t.sees(ball));
    t.look_through(behind(2.0));
    t.update();
    assert!(!t.sees(ball));
}

#[test]
fn poses_that_mirror_are_culled_only_with_inverted_faces() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.get_mut::<Transform>(t.camera).scale.x = -1.0;
    t.update();
    assert!(t.sees(ball));
    t.get_mut::<Camera>(t.camera).invert_culling = true;
    t.update();
    assert!(!t.sees(ball));

    // A projection that mirrors does the same.
    let mirror = |t: &mut TestWorld| {
        let mut camera = t.get_mut::<Camera>(t.camera);
        let clip_from_view = camera.computed.clip_from_view;
        camera.computed.clip_from_view =
            Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)) * clip_from_view;
    };
    mirror(&mut t);
    t.update();
    assert!(
        t.sees(ball),
        "mirrored twice, and the faces of the inside are drawn"
    );
    t.get_mut::<Transform>(t.camera).scale.x = 1.0;
    t.update();
    assert!(!t.sees(ball));
    t.get_mut::<Camera>(t.camera).invert_culling = false;
    t.update();
    assert!(t.sees(ball));
    assert_eq!(t.stats().refused_views, 1);
}

#[test]
fn every_buffer_size_finds_what_is_wholly_hidden() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    for buffer_size in [
        OcclusionBufferSize::Exact,
        OcclusionBufferSize::Quarter,
        OcclusionBufferSize::Fixed(UVec2::new(64, 40)),
    ] {
        for msaa in [Msaa::Off, Msaa::Sample2, Msaa::Sample4, Msaa::Sample8] {
            t.app.world_mut().entity_mut(t.camera).insert((
                CpuOcclusionCulling {
                    buffer_size,
                    ..default()
                },
                msaa,
            ));
            t.update();
            assert!(!t.sees(ball), "{buffer_size:?} {msaa:?}");
        }
    }
}

#[test]
fn inactive_cameras_and_cameras_without_a_target_are_left_alone() {
    let mut t = TestWorld::new();
    t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    t.get_mut::<Camera>(t.camera).computed.target_info = None;
    t.update();
    assert!(t.sees(ball));
    assert_eq!(t.app.world().resource::<CpuOcclusionStats>().cameras, 0);
}

#[test]
fn each_camera_has_its_own_list() {
    let mut t = TestWorld::new();
    let wall = t.wall(Occluder::default());
    let ball = t.ball(-9.0);
    let other = t.add_camera(Transform::from_xyz(0.0, 0.0, -20.0).looking_at(Vec3::ZERO, Vec3::Y));
    let before = t.ball(-3.0);
    t.update();
    assert_eq!(t.visible(), sorted([wall, before]));
    let list = t.app.world().get::<VisibleEntities>(other).unwrap();
    let list = list.get(core::any::TypeId::of::<Mesh3d>());
    assert_eq!(list, sorted([wall, ball]), "from behind");
}
