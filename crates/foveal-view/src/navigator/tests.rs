//! Where the camera goes by hands, views and cameras of scenes.

use super::*;

fn navigator() -> Navigator {
    let camera = Camera::look_at(Vec3::new(3.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y, 1.0);
    let bounds = Aabb {
        min: Vec3::splat(-1.0),
        max: Vec3::splat(1.0),
    };
    Navigator::new(camera, bounds)
}

fn forward(navigator: &Navigator) -> Vec3 {
    -navigator.camera().world_from_view.z_axis.truncate()
}

#[test]
fn a_camera_that_is_not_moved_stays_to_the_bit() {
    let mut navigator = navigator();
    let before = navigator.camera().clone();
    assert!(!navigator.step(&Hands::default()));
    assert_eq!(*navigator.camera(), before);
}

#[test]
fn flying_forward_goes_where_the_camera_looks() {
    let mut navigator = navigator();
    let (eye, looks) = (navigator.camera().eye(), forward(&navigator));
    let hands = Hands {
        push: Vec3::Z,
        elapsed_s: 0.5,
        ..Hands::default()
    };
    assert!(navigator.step(&hands));
    let way = navigator.camera().eye() - eye;
    assert!((way.normalize() - looks).length() < 1e-4, "{way}, {looks}");
    assert!((way.length() - 0.5 * navigator.speed_m_s).abs() < 1e-4);
}

#[test]
fn shift_moves_four_times_as_far_in_either_mode() {
    for mode in [Mode::Fly, Mode::Orbit] {
        let way = |hurry| {
            let mut navigator = navigator();
            navigator.mode = mode;
            let before = navigator.camera().eye();
            navigator.step(&Hands {
                push: Vec3::new(1.0, 1.0, 0.0),
                hurry,
                elapsed_s: 0.1,
                ..Hands::default()
            });
            navigator.camera().eye() - before
        };
        assert!((way(true) - 4.0 * way(false)).length() < 1e-3, "{mode:?}");
    }
}

#[test]
fn orbiting_keeps_the_distance_and_looks_at_the_pivot() {
    let mut navigator = navigator();
    navigator.mode = Mode::Orbit;
    let distance = navigator.camera().eye().length();
    for turn in [Vec2::new(100.0, 0.0), Vec2::new(-30.0, 70.0)] {
        let hands = Hands {
            turn,
            ..Hands::default()
        };
        assert!(navigator.step(&hands));
        let eye = navigator.camera().eye();
        assert!((eye.length() - distance).abs() < 1e-2, "{eye}");
        assert!((forward(&navigator) + eye.normalize()).length() < 1e-2);
    }
}

#[test]
fn the_middle_button_orbits_while_flying() {
    let mut flying = navigator();
    let distance = flying.camera().eye().length();
    let hands = Hands {
        orbit: Vec2::new(80.0, 30.0),
        ..Hands::default()
    };
    assert!(flying.step(&hands));
    assert_eq!(flying.mode, Mode::Fly);
    let eye = flying.camera().eye();
    assert!((eye.length() - distance).abs() < 1e-2, "{eye}");
    assert!((forward(&flying) + eye.normalize()).length() < 1e-2);
}

#[test]
fn arrow_keys_turn_and_do_not_move() {
    let mut navigator = navigator();
    let (eye, before) = (navigator.camera().eye(), forward(&navigator));
    let hands = Hands {
        keys_turn: Vec2::new(1.0, 1.0),
        elapsed_s: 0.1,
        ..Hands::default()
    };
    assert!(navigator.step(&hands));
    assert_eq!(navigator.camera().eye(), eye);
    let after = forward(&navigator);
    let right = before.cross(Vec3::Y);
    assert!(
        after.y > before.y && after.dot(right) > 0.0,
        "{before} {after}"
    );
}

#[test]
fn what_is_framed_fills_the_picture_and_is_all_in_it() {
    let bounds = Aabb {
        min: Vec3::new(4.0, 0.0, -3.0),
        max: Vec3::new(6.0, 1.0, -2.0),
    };
    for aspect in [0.5, 1.0, 2.0] {
        let mut navigator = navigator();
        let looks = forward(&navigator);
        navigator.frame(bounds, aspect);
        assert!((forward(&navigator) - looks).length() < 1e-4);
        let clip = navigator.camera().clip_from_world(aspect);
        let mut largest = 0.0f32;
        for i in 0..8 {
            let pick = |bit: usize| [bounds.min, bounds.max][i >> bit & 1][bit];
            let at = clip * Vec3::new(pick(0), pick(1), pick(2)).extend(1.0);
            largest = largest.max((at.x / at.w).abs()).max((at.y / at.w).abs());
        }
        assert!((0.4..=1.0).contains(&largest), "{aspect}: {largest}");
    }
}

#[test]
fn sides_are_seen_straight_and_again_from_the_back() {
    let bounds = Aabb {
        min: Vec3::splat(-1.0),
        max: Vec3::splat(1.0),
    };
    let mut navigator = navigator();
    for (side, looks, right) in [
        (Side::Front, Vec3::NEG_Z, Vec3::X),
        (Side::Right, Vec3::NEG_X, Vec3::NEG_Z),
        (Side::Top, Vec3::NEG_Y, Vec3::X),
    ] {
        navigator.look_from(side, bounds, 1.5);
        let x = navigator.camera().world_from_view.x_axis.truncate();
        assert!((forward(&navigator) - looks).length() < 1e-5, "{side:?}");
        assert!((x - right).length() < 1e-5, "{side:?}");
        assert!(navigator.camera().eye().dot(looks) < -1.0);
        navigator.look_from(side, bounds, 1.5);
        assert!((forward(&navigator) + looks).length() < 1e-5, "{side:?}");
    }
}

#[test]
fn a_camera_that_looks_straight_down_keeps_its_heading() {
    let bounds = Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut navigator = navigator();
    for turn in [0.0, 1.0, 2.0, 3.0_f32] {
        for (pitch, up) in [(-FRAC_PI_2, Vec3::NEG_Z), (FRAC_PI_2, Vec3::Z)] {
            let turned = Mat4::from_rotation_y(turn);
            let mut camera = navigator.camera().clone();
            camera.world_from_view = turned * Mat4::from_rotation_x(pitch);
            navigator.go_to(camera);
            navigator.frame(bounds, 1.5);
            let axes = navigator.camera().world_from_view;
            let [right, up] = [Vec3::X, up].map(|axis| turned.transform_vector3(axis));
            assert!(axes.x_axis.truncate().distance(right) < 1e-5, "{turn}");
            assert!(axes.y_axis.truncate().distance(up) < 1e-5, "{turn}");
        }
    }
}

#[test]
fn from_the_start_the_scene_is_orbited_again() {
    let mut navigator = navigator();
    let start = navigator.camera().clone();
    navigator.mode = Mode::Orbit;
    let scroll = Hands {
        scroll: 30.0,
        ..Hands::default()
    };
    navigator.step(&scroll);
    navigator.go_to(start.clone());
    let turn = Hands {
        turn: Vec2::new(200.0, 0.0),
        ..Hands::default()
    };
    navigator.step(&turn);
    let [distance, before] = [navigator.camera(), &start].map(|c| c.eye().length());
    assert!((distance - before).abs() < 1e-2, "{distance}, {before}");
}

#[test]
fn what_is_small_is_framed_behind_the_near_plane() {
    let mut navigator = navigator();
    let bounds = Aabb {
        min: Vec3::splat(1.0),
        max: Vec3::splat(1.02),
    };
    navigator.frame(bounds, 1.5);
    let Projection::Perspective { near_m, .. } = navigator.camera().projection else {
        panic!("the projection is perspective");
    };
    let ahead = forward(&navigator);
    for i in 0..8 {
        let pick = |bit: usize| [bounds.min, bounds.max][i >> bit & 1][bit];
        let corner = Vec3::new(pick(0), pick(1), pick(2));
        let depth = (corner - navigator.camera().eye()).dot(ahead);
        assert!(depth > near_m, "{depth}, {near_m}");
    }
}

#[test]
fn one_cannot_tumble_over() {
    let mut navigator = navigator();
    let hands = Hands {
        turn: Vec2::new(0.0, -1e4),
        ..Hands::default()
    };
    navigator.step(&hands);
    let up = navigator.camera().world_from_view.y_axis.truncate();
    assert!(up.y > 0.0, "{up}");
}

#[test]
fn a_camera_that_leans_goes_on_leaning_and_turns_as_the_picture_shows_it() {
    let bounds = Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    for (pitch, roll) in [(-0.3, 0.5), (0.4, -2.0), (0.0, PI)] {
        let mut leaning = navigator().camera().clone();
        leaning.world_from_view =
            Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(pitch) * Mat4::from_rotation_z(roll);
        let axes = leaning.world_from_view;
        let mut navigator = Navigator::new(leaning, bounds);
        navigator.step(&Hands {
            push: Vec3::Z,
            elapsed_s: 0.1,
            ..Hands::default()
        });
        let moved = navigator.camera().world_from_view;
        for (a, b) in [(moved.x_axis, axes.x_axis), (moved.y_axis, axes.y_axis)] {
            assert!(a.distance(b) < 1e-5, "{pitch} {roll}: {moved}");
        }
        navigator.step(&Hands {
            turn: Vec2::new(2.0, 0.0),
            ..Hands::default()
        });
        let ahead = forward(&navigator);
        let [right, up] = [axes.x_axis, axes.y_axis].map(|axis| ahead.dot(axis.truncate()));
        assert!(
            right > 0.005 && up.abs() < 1e-3,
            "{pitch} {roll}: {right} {up}"
        );
        navigator.look_from(Side::Front, bounds, 1.5);
        let upright = navigator.camera().world_from_view.y_axis;
        assert!(upright.distance(Vec3::Y.extend(0.0)) < 1e-5, "{upright}");
    }
}
