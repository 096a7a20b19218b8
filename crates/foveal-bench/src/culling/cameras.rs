//! Where a scene is measured from: its own cameras (the overview where there are none), eight
//! around it, and where that is asked for, some inside.
//!
//! Camera k of the eight stands at k * 45° (0° is +x, 90° is +z) on an ellipse around the centre of
//! the bounds, 0.6 of the bounds' size away in x and in z, a quarter of their height above the
//! centre, and looks at the centre with 60° in height.

use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::bail;
use foveal_cull::{Eye, Projection};
use foveal_scene::Scene;
use glam::{DVec3, Vec3};

use super::inside;
use foveal_host::camera::near_m;
use foveal_host::culling::Occluders;
use foveal_host::culling::camera_file;
use foveal_host::culling::{NamedEye, defaults, named_eye, own_cameras};

/// Cameras other than the scene's own and those around it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Choice {
    /// These as well: where people stand.
    Inside,
    /// Those of a file in place of all.
    File(PathBuf),
}

impl FromStr for Choice {
    type Err = Infallible;

    /// `./inside` means a file.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "inside" => Self::Inside,
            file => Self::File(file.into()),
        })
    }
}

/// The cameras of a scene, for pictures of any shape.
pub(super) struct Cameras<'a> {
    scene: &'a Scene,
    choice: Option<&'a Choice>,
    places: Vec<Vec3>,
}

impl<'a> Cameras<'a> {
    /// Looks for places inside where these are asked for.
    pub(super) fn new(
        scene: &'a Scene,
        occluders: &Occluders,
        choice: Option<&'a Choice>,
    ) -> anyhow::Result<Self> {
        let mut places = Vec::new();
        if choice == Some(&Choice::Inside) {
            places = inside::places(occluders);
            if places.is_empty() {
                bail!(
                    "the scene '{}' has no floor with free space around to stand on: leave out --cameras inside",
                    scene.name
                );
            }
        }
        Ok(Self {
            scene,
            choice,
            places,
        })
    }

    /// The eyes for a picture of `aspect` = width / height.
    pub(super) fn eyes(&self, aspect: f64) -> anyhow::Result<Vec<NamedEye>> {
        if let Some(Choice::File(file)) = self.choice {
            return camera_file::read(file, defaults(self.scene, aspect));
        }
        let own = own_cameras(self.scene);
        Ok(own
            .iter()
            .map(|camera| named_eye(camera, aspect))
            .chain(around(self.scene, aspect))
            .chain(inside::eyes(self.scene, &self.places, aspect))
            .collect())
    }
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
