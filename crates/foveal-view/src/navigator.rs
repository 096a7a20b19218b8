//! Moving the camera: flying through the scene, or orbiting around a point of it.

use std::f32::consts::{FRAC_PI_2, PI};

use foveal_scene::{Aabb, Camera, Projection};
use glam::{Mat4, Vec2, Vec3};

/// Radians that a drag over one point of the window turns.
const TURN_RAD: f32 = 0.005;
/// Steepest look up or down.
const STEEPEST_RAD: f32 = 1.55;
/// Cosine of the pitch below which a heading is that of the axis to the right.
const STEEP: f32 = 1e-3;
/// Radians a second that an arrow key turns.
const KEY_TURN_RAD_S: f32 = 1.2;

/// How the camera is moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    #[default]
    Fly,
    Orbit,
}

/// A side of the scene, by the direction that it faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Seen from +z: where the front of a glTF model is.
    Front,
    /// Seen from +x.
    Right,
    /// Seen from +y, with +x on the right.
    Top,
}

impl Side {
    /// Yaw and pitch of the view, and of the one from the opposite side.
    fn angles(self) -> [[f32; 2]; 2] {
        match self {
            Self::Front => [[0.0, 0.0], [PI, 0.0]],
            Self::Right => [[FRAC_PI_2, 0.0], [-FRAC_PI_2, 0.0]],
            Self::Top => [[0.0, -FRAC_PI_2], [0.0, FRAC_PI_2]],
        }
    }
}

/// What the hands do in a moment.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hands {
    /// Right, up, forward; each -1 to 1.
    pub(crate) push: Vec3,
    /// Pointer movement with the turning button down, in points.
    pub(crate) turn: Vec2,
    /// Arrow keys: right and up; each -1 to 1.
    pub(crate) keys_turn: Vec2,
    /// Pointer movement that turns around the point ahead, in either mode.
    pub(crate) orbit: Vec2,
    /// Pointer movement that shifts the point ahead, in either mode.
    pub(crate) pan: Vec2,
    /// Pointer movement with the shifting button down, in points.
    pub(crate) shift: Vec2,
    /// Notches of the wheel.
    pub(crate) scroll: f32,
    pub(crate) hurry: bool,
    pub(crate) elapsed_s: f32,
}

impl Hands {
    /// How far keys push in this moment at a speed of 1.
    fn way(&self) -> Vec3 {
        let hurry = if self.hurry { 4.0 } else { 1.0 };
        self.push.clamp_length_max(1.0) * (hurry * self.elapsed_s)
    }
}

/// A camera that is moved.
#[derive(Clone, Debug)]
pub(crate) struct Navigator {
    pub(crate) mode: Mode,
    /// Metres per second.
    pub(crate) speed_m_s: f32,
    camera: Camera,
    /// Extent of the scene.
    bounds: Aabb,
    yaw_rad: f32,
    pitch_rad: f32,
    /// Distance of the point that is orbited.
    radius_m: f32,
}

impl Navigator {
    /// At `camera` in a scene of this extent.
    pub(crate) fn new(camera: Camera, bounds: Aabb) -> Self {
        let extent_m = if bounds.is_empty() {
            1.0
        } else {
            bounds.size().length().max(1e-3)
        };
        let mut this = Self {
            mode: Mode::Fly,
            speed_m_s: (extent_m * 0.08).clamp(1e-3, 50.0),
            yaw_rad: 0.0,
            pitch_rad: 0.0,
            radius_m: extent_m,
            camera: camera.clone(),
            bounds,
        };
        this.go_to(camera);
        this
    }

    /// Jumps to a camera; what is orbited then is as far ahead as the centre of the scene is away.
    pub(crate) fn go_to(&mut self, camera: Camera) {
        if !self.bounds.is_empty() {
            let towards = camera.eye().distance(self.bounds.center());
            self.radius_m = towards.max(1e-3 * self.bounds.size().length().max(1e-3));
        }
        let forward = (-camera.world_from_view.z_axis.truncate()).normalize_or(Vec3::NEG_Z);
        let is_steep = forward.x.hypot(forward.z) < STEEP;
        self.yaw_rad = if is_steep {
            let right = camera.world_from_view.x_axis;
            f32::atan2(-right.z, right.x)
        } else {
            f32::atan2(-forward.x, -forward.z)
        };
        self.pitch_rad = forward.y.clamp(-1.0, 1.0).asin();
        self.camera = camera;
    }

    /// Where it is. Bit for bit the camera it was told to go to until it is moved.
    pub(crate) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Moves, in the direction that it looks, to where all of `bounds` is in a picture of this
    /// aspect; that is what is orbited then.
    pub(crate) fn frame(&mut self, bounds: Aabb, aspect: f32) {
        if bounds.is_empty() {
            return;
        }
        let radius = (0.5 * bounds.size().length()).max(1e-4);
        match &mut self.camera.projection {
            Projection::Perspective { fov_y_rad, near_m } => {
                let half = 0.5 * *fov_y_rad;
                let half = half.min((half.tan() * aspect).atan());
                self.radius_m = radius / half.sin();
                *near_m = near_m.min(0.5 * (self.radius_m - radius));
            }
            Projection::Orthographic {
                height_m,
                near_m,
                far_m,
            } => {
                *height_m = 2.0 * radius / aspect.min(1.0);
                *far_m = far_m.max(*near_m + 2.0 * radius);
                self.radius_m = 0.5 * (*near_m + *far_m);
            }
        }
        self.place(bounds.center() + self.turned().z_axis.truncate() * self.radius_m);
    }

    /// Looks at `bounds` from a side; from the opposite one if it looks from that side already.
    pub(crate) fn look_from(&mut self, side: Side, bounds: Aabb, aspect: f32) {
        let [this, opposite] = side.angles();
        let is_there = [self.yaw_rad, self.pitch_rad] == this;
        [self.yaw_rad, self.pitch_rad] = if is_there { opposite } else { this };
        self.place(self.camera.eye());
        self.frame(bounds, aspect);
    }

    fn turned(&self) -> Mat4 {
        Mat4::from_rotation_y(self.yaw_rad) * Mat4::from_rotation_x(self.pitch_rad)
    }

    /// Moves; true if anything changed.
    pub(crate) fn step(&mut self, hands: &Hands) -> bool {
        // A drag over a point turns as far as a key that is held for this long.
        let keys = hands.keys_turn * (KEY_TURN_RAD_S * hands.elapsed_s / TURN_RAD);
        let keys = Vec2::new(keys.x, -keys.y);
        match self.mode {
            Mode::Fly => {
                let around = Hands {
                    turn: hands.orbit,
                    shift: hands.pan,
                    ..Hands::default()
                };
                let is_turned = self.orbit(&around);
                let turn = hands.turn + keys;
                self.fly(&Hands { turn, ..*hands }) || is_turned
            }
            Mode::Orbit => self.orbit(&Hands {
                turn: hands.turn + hands.orbit + keys,
                shift: hands.shift + hands.pan,
                ..*hands
            }),
        }
    }

    fn turn(&mut self, by: Vec2) {
        if by == Vec2::ZERO {
            return;
        }
        self.yaw_rad -= by.x * TURN_RAD;
        let pitch = self.pitch_rad - by.y * TURN_RAD;
        self.pitch_rad = pitch.clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    fn place(&mut self, eye: Vec3) {
        self.camera.world_from_view = Mat4::from_translation(eye) * self.turned();
        self.camera.name = "free".to_owned();
    }

    fn fly(&mut self, hands: &Hands) -> bool {
        if hands.scroll != 0.0 {
            self.speed_m_s = (self.speed_m_s * 1.2f32.powf(hands.scroll)).clamp(1e-4, 1e4);
        }
        let drag = hands.turn + hands.shift;
        if drag == Vec2::ZERO && hands.push == Vec3::ZERO {
            return false;
        }
        self.turn(drag);
        let way = hands.way() * self.speed_m_s;
        let eye = self.camera.eye();
        let turned = self.turned();
        let step =
            turned.x_axis.truncate() * way.x + Vec3::Y * way.y - turned.z_axis.truncate() * way.z;
        self.place(eye + step);
        true
    }

    fn orbit(&mut self, hands: &Hands) -> bool {
        if hands.turn == Vec2::ZERO
            && hands.shift == Vec2::ZERO
            && hands.scroll == 0.0
            && hands.push == Vec3::ZERO
        {
            return false;
        }
        let before = self.turned();
        let mut pivot = self.camera.eye() - before.z_axis.truncate() * self.radius_m;
        self.turn(hands.turn);
        let turned = self.turned();
        let (right, up) = (turned.x_axis.truncate(), turned.y_axis.truncate());
        let by = hands.shift * (self.radius_m * 0.0015);
        let push = hands.way() * self.radius_m;
        pivot += up * (by.y + push.y) - right * by.x + right * push.x;
        self.radius_m *= 0.9f32.powf(hands.scroll) * (1.0 - push.z / self.radius_m).max(0.5);
        self.radius_m = self.radius_m.max(1e-4);
        self.place(pivot + turned.z_axis.truncate() * self.radius_m);
        true
    }
}

#[cfg(test)]
mod tests {
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
}
