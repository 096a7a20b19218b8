//! Where a scene is measured from: its own cameras (the overview where there are none), and eight around it.
//!
//! Camera k of the eight stands at k * 45° (0° is +x, 90° is +z) on an ellipse around the middle of the
//! bounds, 0.6 of the bounds' size away in x and in z, a quarter of their height above the middle, and looks
//! at the middle with 60° in height.

use std::path::Path;

use foveal_cull::{Eye, Projection};
use foveal_scene::Scene;
use glam::DVec3;

use crate::cull::camera_file;
use crate::cull::views::{NamedEye, defaults, named_eye, near_m, own_cameras};

/// The eyes for a picture of `aspect` = width / height; those of a file instead where one is given.
pub(super) fn choose(
    scene: &Scene,
    file: Option<&Path>,
    aspect: f64,
) -> anyhow::Result<Vec<NamedEye>> {
    if let Some(file) = file {
        return camera_file::read(file, defaults(scene, aspect));
    }
    let own = own_cameras(scene);
    Ok(own
        .iter()
        .map(|camera| named_eye(camera, aspect))
        .chain(around(scene, aspect))
        .collect())
}

fn around(scene: &Scene, aspect: f64) -> impl Iterator<Item = NamedEye> {
    let bounds = scene.bounds();
    let (center, size) = if bounds.is_empty() {
        (DVec3::ZERO, DVec3::ONE)
    } else {
        (bounds.center().as_dvec3(), bounds.size().as_dvec3())
    };
    let near = f64::from(near_m(scene));
    (0..8).map(move |k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
        let eye = center + size * DVec3::new(0.6 * cos, 0.25, 0.6 * sin);
        let projection = Projection::perspective(60_f64.to_radians(), aspect, near, f64::INFINITY);
        NamedEye {
            name: format!("around {k}"),
            eye: Eye::look_at(eye, center, DVec3::Y, projection),
        }
    })
}
