//! What every pass knows of the frame: the uniform block of `shared/frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Camera, Environment, Projection};
use glam::{Mat4, Vec3};

use crate::Settings;
use crate::lights::ClusterGrid;

/// Mirrors `Frame` in `shared/frame.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    pub(crate) clip_from_world: [[f32; 4]; 4],
    pub(crate) previous_clip_from_world: [[f32; 4]; 4],
    pub(crate) world_from_view: [[f32; 4]; 4],
    pub(crate) view_from_ndc: [f32; 4],
    pub(crate) eye: [f32; 3],
    pub(crate) orthographic: u32,
    pub(crate) forward: [f32; 3],
    pub(crate) exposure: f32,
    pub(crate) zenith: [f32; 3],
    pub(crate) near: f32,
    pub(crate) horizon: [f32; 3],
    pub(crate) depth_range: f32,
    pub(crate) nadir: [f32; 3],
    pub(crate) cluster_near: f32,
    pub(crate) cluster_counts: [u32; 3],
    pub(crate) cluster_scale: f32,
    pub(crate) size: [f32; 2],
    pub(crate) cluster_tile: f32,
    pub(crate) reserved: f32,
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
        let clip_from_view = camera.clip_from_view(aspect);
        let (x, y) = (clip_from_view.x_axis.x, clip_from_view.y_axis.y);
        let (orthographic, near, depth_range, shift) = match camera.projection {
            Projection::Perspective { near_m, .. } => (0, near_m, 0.0, clip_from_view.z_axis),
            Projection::Orthographic { near_m, far_m, .. } => {
                (1, near_m, far_m - near_m, -clip_from_view.w_axis)
            }
        };
        Self {
            clip_from_world: camera.clip_from_world(aspect).to_cols_array_2d(),
            previous_clip_from_world: previous.clip_from_world(aspect).to_cols_array_2d(),
            world_from_view: camera.world_from_view.to_cols_array_2d(),
            view_from_ndc: [1.0 / x, 1.0 / y, shift.x / x, shift.y / y],
            eye: camera.eye().to_array(),
            orthographic,
            forward: forward(&camera.world_from_view).to_array(),
            exposure: settings.exposure.exp2(),
            zenith: environment.zenith.to_array(),
            near,
            horizon: environment.horizon.to_array(),
            depth_range,
            nadir: environment.nadir.to_array(),
            cluster_near: clusters.near_m,
            cluster_counts: clusters.counts,
            cluster_scale: clusters.slices_per_doubling,
            size: [settings.width as f32, settings.height as f32],
            cluster_tile: clusters.tile_px as f32,
            reserved: 0.0,
        }
    }
}

fn forward(world_from_view: &Mat4) -> Vec3 {
    (-world_from_view.z_axis.truncate()).normalize_or(Vec3::NEG_Z)
}
