//! Casters that others hide from the light: `foveal-cull` with the tile's own texel centres as its
//! samples, so that what is left out could not have changed a texel, but through cracks that rounding
//! opens between surfaces that meet.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use foveal_cull::{Culler, Eye, FrameOptions, Projection, SingleThread, View, Visibility};
use glam::{Mat4, Vec3, Vec4};

use super::volume::{Volume, widening};
use crate::culling::affine;
use crate::scene::SceneOnGpu;

/// Coverage samples of the culler's buffer along each side of a pixel.
const SAMPLES: u32 = 4;
/// Tiles with fewer triangles are drawn sooner than their casters are tested.
const LEAST_TRIANGLES: u64 = 2_000;

/// Finds casters that others hide from the light.
#[derive(Debug, Default)]
pub(super) struct HiddenCasters {
    /// By the tile's side in texels.
    cullers: BTreeMap<u32, Culler>,
    boxes: Vec<foveal_cull::Aabb>,
    results: Vec<Visibility>,
}

impl HiddenCasters {
    /// Takes the hidden ones out of all casters of a tile of `side` texels.
    pub(super) fn take_out(
        &mut self,
        scene: &SceneOnGpu,
        volume: &Volume,
        side: u32,
        casters: &mut Vec<u32>,
    ) {
        let instances = casters.iter().map(|&i| &scene.instances[i as usize]);
        let meshes = instances.clone().map(|i| scene.geometry.mesh(i.mesh));
        if meshes.map(|m| u64::from(m.index_count / 3)).sum::<u64>() < LEAST_TRIANGLES {
            return;
        }
        let occluders = scene.culling.occluders_of(casters);
        if occluders.is_empty() {
            return;
        }
        let pixels = (side / SAMPLES).max(1);
        let culler = match self.cullers.entry(pixels) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => match Culler::new(pixels, pixels) {
                Ok(culler) => place.insert(culler),
                Err(_) => return,
            },
        };
        let view = View::mono(eye(volume, side as f32));
        let options = FrameOptions::default();
        if (culler.rasterize(&view, &occluders, &options, &SingleThread)).is_err() {
            return;
        }
        self.boxes.clear();
        let boxes = instances.map(|i| foveal_cull::Aabb::new(i.bounds.min, i.bounds.max));
        self.boxes.extend(boxes);
        self.results.clear();
        self.results.resize(self.boxes.len(), Visibility::Visible);
        let origin = [0.0; 3];
        if culler.query(&self.boxes, origin, &mut self.results).is_ok() {
            let mut results = self.results.iter();
            casters.retain(|_| results.next().is_none_or(|r| r.is_visible()));
        }
    }
}

/// The light as the culler's eye, which sees the tile with its border.
fn eye(volume: &Volume, side: f32) -> Eye {
    let pose = |[x, y, z]: [Vec3; 3], at: Vec3| {
        // Right-handed, with the axis along the rays to the back: a mirrored picture has the same
        // samples.
        let right = if x.cross(y).dot(z) > 0.0 { -x } else { x };
        affine(Mat4::from_cols(
            right.extend(0.0),
            y.extend(0.0),
            (-z).extend(0.0),
            Vec4::from((at, 1.0)),
        ))
    };
    match *volume {
        Volume::Pyramid {
            apex,
            axes,
            tangent,
            near,
            ..
        } => {
            let reach = f64::from(tangent * widening(side));
            Eye::new(
                pose(axes, apex),
                Projection::Perspective {
                    left: -reach,
                    right: reach,
                    bottom: -reach,
                    top: reach,
                    near_m: near.into(),
                    far_m: f64::INFINITY,
                },
            )
        }
        Volume::Column {
            axes,
            center: [u, v],
            radius,
            span: [begin, end],
        } => {
            let reach = f64::from(radius);
            let [x, y, z] = axes;
            Eye::new(
                pose(axes, x * u + y * v + z * begin),
                Projection::Orthographic {
                    left: -reach,
                    right: reach,
                    bottom: -reach,
                    top: reach,
                    near_m: 0.0,
                    far_m: f64::from(end) - f64::from(begin),
                },
            )
        }
    }
}
