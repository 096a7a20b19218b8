//! Moving the camera: flying through the scene, or orbiting around a point of it.

#[cfg(test)]
mod tests;

use std::f32::consts::{FRAC_PI_2, PI};

use foveal_scene::{Aabb, Camera, Projection};
use glam::{Mat4, Vec2, Vec3};

/// Radians that a drag over one point of the window turns.
const TURN_RAD: f32 = 0.005;
/// Steepest look up or down.
const STEEPEST_RAD: f32 = 1.55;
/// Cosine of the pitch below which a heading is that of the axis to the right.
const STEEP: f32 = 1e-3;
/// Radians that are no lean: what numbers of 32 bits are rounded by.
const LEAST_ROLL_RAD: f32 = 1e-4;
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
    /// How far the picture's right side is turned upwards.
    roll_rad: f32,
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
            roll_rad: 0.0,
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
        self.roll_rad = 0.0;
        let (level, right) = (self.turned(), camera.world_from_view.x_axis);
        let roll_rad = f32::atan2(right.dot(level.y_axis), right.dot(level.x_axis));
        if roll_rad.abs() > LEAST_ROLL_RAD {
            self.roll_rad = roll_rad;
        }
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
        self.roll_rad = 0.0;
        self.place(self.camera.eye());
        self.frame(bounds, aspect);
    }

    fn turned(&self) -> Mat4 {
        Mat4::from_rotation_y(self.yaw_rad)
            * Mat4::from_rotation_x(self.pitch_rad)
            * Mat4::from_rotation_z(self.roll_rad)
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
        // Right and down in the picture, which may lean.
        let by = Vec2::from_angle(-self.roll_rad).rotate(by);
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
