//! What every pass knows of the frame: the uniform block of `shared/frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Camera, Environment, Projection};
use glam::{Mat4, Vec3};

use crate::Settings;
use crate::lights::ClusterGrid;

/// First column of a right eye that there is not: beyond every target.
const NO_STRIDE: u32 = 1 << 30;

/// Mirrors `View` in `shared/frame.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ViewUniform {
    pub(crate) clip_from_world: [[f32; 4]; 4],
    pub(crate) previous_clip_from_world: [[f32; 4]; 4],
    pub(crate) world_from_view: [[f32; 4]; 4],
    pub(crate) view_from_ndc: [f32; 4],
    pub(crate) eye: [f32; 3],
    pub(crate) cluster_shift_x: f32,
    pub(crate) forward: [f32; 3],
    pub(crate) cluster_shift_y: f32,
}

impl ViewUniform {
    fn new(camera: &Camera, previous: &Camera, aspect: f32) -> Self {
        let clip_from_view = camera.clip_from_view(aspect);
        let (x, y) = (clip_from_view.x_axis.x, clip_from_view.y_axis.y);
        let shift = match camera.projection {
            Projection::Perspective { .. } => clip_from_view.z_axis,
            Projection::Orthographic { .. } => -clip_from_view.w_axis,
        };
        Self {
            clip_from_world: camera.clip_from_world(aspect).to_cols_array_2d(),
            previous_clip_from_world: previous.clip_from_world(aspect).to_cols_array_2d(),
            world_from_view: camera.world_from_view.to_cols_array_2d(),
            view_from_ndc: [1.0 / x, 1.0 / y, shift.x / x, shift.y / y],
            eye: camera.eye().to_array(),
            cluster_shift_x: 0.0,
            forward: forward(&camera.world_from_view).to_array(),
            cluster_shift_y: 0.0,
        }
    }
}

/// Mirrors `Frame` in `shared/frame.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    pub(crate) views: [ViewUniform; 2],
    pub(crate) zenith: [f32; 3],
    pub(crate) near: f32,
    pub(crate) horizon: [f32; 3],
    pub(crate) depth_range: f32,
    pub(crate) nadir: [f32; 3],
    pub(crate) cluster_near: f32,
    pub(crate) cluster_counts: [u32; 3],
    pub(crate) cluster_scale: f32,
    pub(crate) size: [f32; 2],
    pub(crate) target_size: [f32; 2],
    pub(crate) cluster_tile: f32,
    pub(crate) eye_stride: u32,
    pub(crate) exposure: f32,
    pub(crate) orthographic: u32,
}

impl FrameUniform {
    pub(crate) fn new(
        settings: &Settings,
        camera: &Camera,
        previous: &Camera,
        environment: &Environment,
        clusters: &ClusterGrid,
    ) -> Self {
        let aspect = settings.width as f32 / settings.height as f32;
        let size = [settings.width as f32, settings.height as f32];
        let (orthographic, near, depth_range) = match camera.projection {
            Projection::Perspective { near_m, .. } => (0, near_m, 0.0),
            Projection::Orthographic { near_m, far_m, .. } => (1, near_m, far_m - near_m),
        };
        Self {
            views: [ViewUniform::new(camera, previous, aspect); 2],
            zenith: environment.zenith.to_array(),
            near,
            horizon: environment.horizon.to_array(),
            depth_range,
            nadir: environment.nadir.to_array(),
            cluster_near: clusters.near_m,
            cluster_counts: clusters.counts,
            cluster_scale: clusters.slices_per_doubling,
            size,
            target_size: size,
            cluster_tile: clusters.tile_px as f32,
            eye_stride: NO_STRIDE,
            exposure: settings.exposure.exp2(),
            orthographic,
        }
    }
}

fn forward(world_from_view: &Mat4) -> Vec3 {
    (-world_from_view.z_axis.truncate()).normalize_or(Vec3::NEG_Z)
}
