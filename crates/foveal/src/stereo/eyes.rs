//! Where the eyes stand and what they see.

use foveal_scene::{Camera, Projection};
use glam::{Mat3, Mat4, Vec3, Vec4};

use super::EyeLayout;
use crate::EyeFrusta;
use crate::{Error, Settings};

/// One eye: a pose and a frustum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    /// View space is x right, y up, looking down -z.
    pub(crate) world_from_view: Mat4,
    /// Reversed depth; the frustum may be asymmetric.
    pub(crate) clip_from_view: Mat4,
    pub(crate) orthographic: bool,
}

impl Eye {
    pub(crate) fn clip_from_world(&self) -> Mat4 {
        self.clip_from_view * self.world_from_view.inverse()
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.world_from_view.w_axis.truncate()
    }

    /// View-space xy from normalized device coordinates: scale in xy, offset in zw; at distance 1
    /// for a perspective.
    pub(crate) fn view_from_ndc(&self) -> [f32; 4] {
        let m = &self.clip_from_view;
        let (x, y) = (m.x_axis.x, m.y_axis.y);
        let shift = if self.orthographic {
            -m.w_axis
        } else {
            m.z_axis
        };
        [1.0 / x, 1.0 / y, shift.x / x, shift.y / y]
    }

    /// Left, right, bottom and top border: tangents, or metres where rays are parallel.
    pub(crate) fn borders(&self) -> [f32; 4] {
        let [x, y, z, w] = self.view_from_ndc();
        [z - x, z + x, w - y, w + y]
    }
}

/// The eyes of a camera: the left and the right one, or the same twice where there is one.
///
/// # Errors
/// [`Error::Setting`] where the camera makes no sense, and where two eyes should see in parallel
/// projection.
pub(crate) fn eyes(settings: &Settings, camera: &Camera) -> Result<[Eye; 2], Error> {
    check(settings, camera)?;
    let aspect = settings.picture.width as f32 / settings.picture.height as f32;
    let clip_from_view = camera.clip_from_view(aspect);
    let center = Eye {
        world_from_view: camera.world_from_view,
        clip_from_view,
        orthographic: matches!(camera.projection, Projection::Orthographic { .. }),
    };
    if !settings.is_stereo() {
        return Ok([center; 2]);
    }
    Ok([-0.5f32, 0.5].map(|side| {
        let x = side * settings.stereo.ipd_m;
        let mut eye = center;
        let right = camera.world_from_view.x_axis;
        eye.world_from_view.w_axis += right * x;
        match settings.stereo.frusta {
            EyeFrusta::Tangents(tangents) => {
                let [left, right, bottom, top] = tangents[usize::from(side > 0.0)];
                let m = &mut eye.clip_from_view;
                m.x_axis.x = 2.0 / (right - left);
                m.y_axis.y = 2.0 / (top - bottom);
                m.z_axis.x = (right + left) / (right - left);
                m.z_axis.y = (top + bottom) / (top - bottom);
            }
            // Points straight ahead at the convergence distance keep the centre's place in the
            // picture.
            EyeFrusta::Camera => {
                eye.clip_from_view.z_axis.x -=
                    clip_from_view.x_axis.x * x / settings.stereo.convergence_m
            }
        }
        eye
    }))
}

/// A camera that a picture can be taken with.
fn check(settings: &Settings, camera: &Camera) -> Result<(), Error> {
    let wrong = |name, value, expected| {
        Err(Error::Setting {
            name,
            value,
            expected,
        })
    };
    let place = camera.world_from_view;
    if !is_rigid(&place) {
        let value = format!("placed by {place}");
        return wrong(
            "camera",
            value,
            "placed by a rotation and a translation alone, all numbers finite",
        );
    }
    match camera.projection {
        Projection::Perspective { fov_y_rad, near_m } => {
            let value = format!("a field of view of {fov_y_rad} and a near plane at {near_m} m");
            if !(near_m > 0.0
                && near_m.is_finite()
                && fov_y_rad > 0.0
                && fov_y_rad < std::f32::consts::PI)
            {
                return wrong("camera", value, "between 0 and pi radians, and above 0 m");
            }
        }
        Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => {
            if !(height_m > 0.0 && height_m.is_finite()) {
                let value = format!("a view of {height_m} m in height");
                return wrong("camera", value, "above 0 m");
            }
            if !(near_m < far_m && (far_m - near_m).is_finite()) {
                let value = format!("near plane at {near_m} m, far plane at {far_m} m");
                return wrong("camera", value, "near before far, a finite way apart");
            }
            if settings.is_stereo() {
                let value = "on with an orthographic camera".to_owned();
                return wrong("stereo", value, "off: two eyes need a perspective");
            }
        }
    }
    let aspect = settings.picture.width as f32 / settings.picture.height as f32;
    if !camera.clip_from_world(aspect).is_finite() {
        let value = format!("{:?}, placed by {place}", camera.projection);
        return wrong("camera", value, "one whose matrix to clip space is finite");
    }
    Ok(())
}

/// By how much a rotation that was multiplied or inverted often may be off.
const ROUNDED: f32 = 1e-3;

/// Whether a matrix is a rotation and a translation: lights are assigned to parts of the view, and
/// objects are culled, by distances that are the same in view space and in the world.
fn is_rigid(place: &Mat4) -> bool {
    let turn = Mat3::from_mat4(*place);
    let off = turn.transpose() * turn - Mat3::IDENTITY;
    let is_turn = off.to_cols_array().iter().all(|v| v.abs() < ROUNDED) && turn.determinant() > 0.0;
    let is_affine = (place.row(3) - Vec4::W).abs().max_element() < ROUNDED;
    place.is_finite() && is_turn && is_affine
}

/// Whole pixels by which each eye's picture is moved in the grid of clusters, so that what is far
/// away falls into the same tiles for both. Any shift is right; this one keeps the lists of lights
/// short.
pub(crate) fn cluster_shifts(eyes: &[Eye; 2], layout: &EyeLayout) -> [[u32; 2]; 2] {
    let [a, b] = eyes.map(|eye| eye.borders());
    let size = [layout.width, layout.height];
    let shift = |tangents: f32, per_picture: f32, size: u32| {
        ((tangents / per_picture * size as f32).round() as u32).min(size)
    };
    [a, b].map(|[left, right, bottom, top]| {
        [
            shift(left - a[0].min(b[0]), right - left, size[0]),
            shift(a[3].max(b[3]) - top, top - bottom, size[1]),
        ]
    })
}
