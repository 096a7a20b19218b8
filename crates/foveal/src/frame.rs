//! What every pass knows of the frame: the uniform block of `shared/frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Camera, Projection};
use glam::{Mat4, Vec3};

use crate::Settings;
use crate::environment::EnvironmentTerms;
use crate::lights::ClusterGrid;
use crate::shadow::LookupSettings;
use crate::stereo::{Eye, EyeLayout};

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
    pub(crate) previous_eye: [f32; 3],
    pub(crate) previous_half_width: f32,
}

impl ViewUniform {
    fn new(eye: &Eye, previous: &Eye, cluster_shift: [u32; 2]) -> Self {
        Self {
            clip_from_world: eye.clip_from_world().to_cols_array_2d(),
            previous_clip_from_world: previous.clip_from_world().to_cols_array_2d(),
            world_from_view: eye.world_from_view.to_cols_array_2d(),
            view_from_ndc: eye.view_from_ndc(),
            eye: eye.position().to_array(),
            cluster_shift_x: cluster_shift[0] as f32,
            forward: forward(&eye.world_from_view).to_array(),
            cluster_shift_y: cluster_shift[1] as f32,
            previous_eye: if previous.orthographic {
                (-forward(&previous.world_from_view)).to_array()
            } else {
                previous.position().to_array()
            },
            previous_half_width: previous.view_from_ndc()[0],
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
    pub(crate) irradiance: [[f32; 4]; 9],
    pub(crate) environment_turn: [f32; 2],
    pub(crate) environment_intensity: f32,
    pub(crate) point_size: f32,
    pub(crate) environment_levels: [f32; 3],
    pub(crate) line_width: f32,
    pub(crate) shadow_bias: f32,
    pub(crate) light_radius: f32,
    pub(crate) sun_tangent: f32,
    pub(crate) resting_views: u32,
    pub(crate) most_disagreement: f32,
    pub(crate) reserved: [u32; 3],
}

impl FrameUniform {
    pub(crate) fn new(
        settings: &Settings,
        camera: &Camera,
        eyes: &[Eye; 2],
        previous: &[Eye; 2],
        environment: EnvironmentTerms<'_>,
        clusters: &ClusterGrid,
    ) -> Self {
        let layout = EyeLayout::of(settings);
        let (target_width, target_height) = layout.target_size();
        let views = [0, 1].map(|i| ViewUniform::new(&eyes[i], &previous[i], clusters.shifts[i]));
        let rests = views.map(|v| u32::from(v.clip_from_world == v.previous_clip_from_world));
        let EnvironmentTerms { sky, map } = environment;
        let intensity = settings.lighting.environment_intensity;
        let shadows = LookupSettings::new(&settings.lighting);
        let turn = settings.lighting.environment_rotation_deg.to_radians();
        let irradiance = map.map_or([Vec3::ZERO; 9], |map| *map.irradiance());
        let (orthographic, near, depth_range) = match camera.projection {
            Projection::Perspective { near_m, .. } => (0, near_m, 0.0),
            Projection::Orthographic { near_m, far_m, .. } => (1, near_m, far_m - near_m),
        };
        Self {
            views,
            zenith: (intensity * sky.zenith).to_array(),
            near,
            horizon: (intensity * sky.horizon).to_array(),
            depth_range,
            nadir: (intensity * sky.nadir).to_array(),
            cluster_near: clusters.near_m,
            cluster_counts: clusters.counts,
            cluster_scale: clusters.slices_per_doubling,
            size: [layout.width as f32, layout.height as f32],
            target_size: [target_width as f32, target_height as f32],
            cluster_tile: clusters.tile_px as f32,
            eye_stride: if layout.eyes == 1 {
                NO_STRIDE
            } else {
                layout.stride
            },
            exposure: settings.picture.exposure_stops.exp2(),
            orthographic,
            irradiance: irradiance.map(|c| (intensity * c).extend(0.0).to_array()),
            environment_turn: [turn.cos(), turn.sin()],
            environment_intensity: intensity,
            point_size: settings.geometry.point_size_px,
            environment_levels: map.map_or([0.0; 3], |map| {
                let levels = map.levels();
                [levels.last, levels.per_doubling, levels.sharpness]
            }),
            line_width: settings.geometry.line_width_px,
            shadow_bias: shadows.texels_moved,
            light_radius: shadows.light_radius_m,
            sun_tangent: shadows.sun_tangent,
            resting_views: rests[0] | rests[1] << 1,
            most_disagreement: settings.most_disagreement(),
            reserved: [0; 3],
        }
    }
}

fn forward(world_from_view: &Mat4) -> Vec3 {
    (-world_from_view.z_axis.truncate()).normalize_or(Vec3::NEG_Z)
}
