//! Culling: which objects are seen at all, decided on the CPU before anything is drawn.
//!
//! The occlusion buffer has a quarter of the picture's size per axis, and its frustum is the picture's,
//! widened to whole buffer pixels: the 4x4 coverage samples in each of its pixels then lie on the picture's
//! own pixel centres, so that what is culled could not have changed a single pixel.

use std::sync::Arc;

use foveal_cull::{
    BakeOptions, Culler, Eye, FrameOptions, OccluderId, OccluderMesh, OccluderSet, Projection,
    View, Visibility,
};
use foveal_scene::{Camera, Scene};
use glam::{DAffine3, DVec3, Mat4, Vec3};

use crate::{Culling, Error};

/// Samples per buffer pixel and axis.
const SAMPLES: u32 = 4;

/// What culling found in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CullingCounts {
    pub(crate) visible: u64,
    pub(crate) outside: u64,
    pub(crate) occluded: u64,
    pub(crate) occluder_triangles: u64,
}

/// A scene's occluders and boxes.
#[derive(Debug, Default)]
pub(crate) struct CullingScene {
    occluders: OccluderSet,
    /// Which instance each occluder is.
    placed: Vec<(OccluderId, u32)>,
    boxes: Vec<foveal_cull::Aabb>,
}

impl CullingScene {
    /// A scene's boxes and, for occlusion culling, its occluders: the opaque instances of the objects that are
    /// marked as occluders, or of all objects where none is marked.
    pub(crate) fn new(scene: &Scene, mode: Culling) -> Self {
        let mut this = Self::default();
        if mode == Culling::Occlusion {
            this.bake(scene);
        }
        this.take_boxes(scene);
        this
    }

    fn bake(&mut self, scene: &Scene) {
        let marked = scene.marks_occluders();
        let mut baked: std::collections::HashMap<(u32, bool), Option<Arc<OccluderMesh>>> =
            Default::default();
        for (index, instance) in (0..).zip(&scene.instances) {
            let material = &scene.materials[instance.material as usize];
            let mesh = &scene.meshes[instance.mesh as usize];
            let wanted = !marked || scene.objects[instance.object as usize].occluder == Some(true);
            if !wanted || !scene.can_occlude(instance) {
                continue;
            }
            let two_sided = material.double_sided;
            let occluder = baked.entry((instance.mesh, two_sided)).or_insert_with(|| {
                let positions: Vec<Vec3> =
                    mesh.vertices.iter().map(|v| v.position.into()).collect();
                // A mesh that cannot be baked only hides nothing.
                OccluderMesh::bake(&positions, &mesh.indices, BakeOptions { two_sided })
                    .ok()
                    .map(Arc::new)
            });
            if let Some(occluder) = occluder
                && let Ok(id) = self
                    .occluders
                    .add(Arc::clone(occluder), affine(instance.world_from_object))
            {
                self.placed.push((id, index));
            }
        }
    }

    /// Takes over a new pose of the same scene.
    pub(crate) fn update_pose(&mut self, scene: &Scene) {
        for &(id, instance) in &self.placed {
            let place = affine(scene.instances[instance as usize].world_from_object);
            if self.occluders.set_transform(id, place).is_err() {
                // A transform that is no transform: better no occluder than a wrong one.
                let _ = self.occluders.set_enabled(id, false);
            }
        }
        self.take_boxes(scene);
    }

    fn take_boxes(&mut self, scene: &Scene) {
        self.boxes.clear();
        let boxes = scene
            .objects
            .iter()
            .map(|o| foveal_cull::Aabb::new(o.bounds.min, o.bounds.max));
        self.boxes.extend(boxes);
    }
}

fn affine(m: Mat4) -> DAffine3 {
    DAffine3::from_mat4(m.as_dmat4())
}

/// Decides what is seen.
#[derive(Debug)]
pub(crate) struct CullingStage {
    occlusion: bool,
    culler: Culler,
    results: Vec<Visibility>,
}

impl CullingStage {
    /// `None` where nothing is culled.
    ///
    /// # Errors
    /// [`Error::Limit`] where the picture is too large for the occlusion buffer.
    pub(crate) fn new(mode: Culling, width: u32, height: u32) -> Result<Option<Self>, Error> {
        let occlusion = match mode {
            Culling::Off => return Ok(None),
            Culling::Frustum => false,
            Culling::Occlusion => true,
        };
        let culler =
            Culler::new(width.div_ceil(SAMPLES), height.div_ceil(SAMPLES)).map_err(|_| {
                Error::Limit {
                    what: "the larger side of a picture with occlusion culling".to_owned(),
                    value: u64::from(width.max(height)),
                    limit: 4096 * u64::from(SAMPLES),
                    hint: String::new(),
                }
            })?;
        Ok(Some(Self {
            occlusion,
            culler,
            results: Vec::new(),
        }))
    }

    /// Tests all objects for a picture of `width` x `height` pixels. A view that makes no sense culls nothing.
    pub(crate) fn cull(
        &mut self,
        scene: &CullingScene,
        camera: &Camera,
        width: u32,
        height: u32,
    ) -> CullingCounts {
        let view = View::mono(Eye {
            world_from_eye: affine(camera.world_from_view),
            projection: projection(camera, width, height),
        });
        let options = FrameOptions {
            occlusion: self.occlusion,
            ..FrameOptions::default()
        };
        self.results.clear();
        self.results.resize(scene.boxes.len(), Visibility::Visible);
        if self
            .culler
            .rasterize(&view, &scene.occluders, &options, &THREADS)
            .is_ok()
            && self
                .culler
                .query(&scene.boxes, DVec3::ZERO, &mut self.results)
                .is_err()
        {
            self.results.fill(Visibility::Visible);
        }
        let count = |v| self.results.iter().filter(|&&r| r == v).count() as u64;
        CullingCounts {
            visible: count(Visibility::Visible),
            outside: count(Visibility::Outside),
            occluded: count(Visibility::Occluded),
            occluder_triangles: self.culler.stats().occluder_triangles_rasterized,
        }
    }

    /// Whether the last frame's object is to be drawn.
    pub(crate) fn is_visible(&self, object: u32) -> bool {
        self.results
            .get(object as usize)
            .is_none_or(|r| r.is_visible())
    }
}

#[cfg(not(target_arch = "wasm32"))]
const THREADS: foveal_cull::Rayon = foveal_cull::Rayon;
#[cfg(target_arch = "wasm32")]
const THREADS: foveal_cull::SingleThread = foveal_cull::SingleThread;

/// The camera's frustum, widened to the right and downwards to whole buffer pixels.
fn projection(camera: &Camera, width: u32, height: u32) -> Projection {
    let aspect = f64::from(width) / f64::from(height);
    let widened = |pixels: u32| f64::from(pixels.next_multiple_of(SAMPLES)) / f64::from(pixels);
    let (right_over_width, down_over_height) = (widened(width), widened(height));
    let extents = |half_height: f64| {
        let half_width = half_height * aspect;
        let right = -half_width + 2.0 * half_width * right_over_width;
        let bottom = half_height - 2.0 * half_height * down_over_height;
        (-half_width, right, bottom, half_height)
    };
    match camera.projection {
        foveal_scene::Projection::Perspective { fov_y_rad, near_m } => {
            let (left, right, bottom, top) = extents((0.5 * f64::from(fov_y_rad)).tan());
            Projection::Perspective {
                left,
                right,
                bottom,
                top,
                near: near_m.into(),
                far: f64::INFINITY,
            }
        }
        foveal_scene::Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => {
            let (left, right, bottom, top) = extents(0.5 * f64::from(height_m));
            Projection::Orthographic {
                left,
                right,
                bottom,
                top,
                near: near_m.into(),
                far: far_m.into(),
            }
        }
    }
}
