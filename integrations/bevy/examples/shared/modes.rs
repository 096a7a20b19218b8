//! Ways of culling, switched on a camera and its lights.

use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::prelude::*;
use bevy::render::occlusion_culling::OcclusionCulling;
use bevy_foveal_cull::{CpuOcclusionCulling, CpuOcclusionOverlayCamera};

/// A way of culling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Bevy's frustum culling alone.
    Frustum,
    /// The same with the depth prepass that the next one needs.
    Prepass,
    /// Bevy's occlusion culling on the GPU, with the depth prepass that it needs.
    Gpu,
    /// This crate's, on cameras.
    Camera,
    /// The same with a depth prepass.
    CameraPrepass,
    /// This crate's, on cameras and lights.
    All,
}

impl Mode {
    /// What the tables of cameras compare.
    pub const OF_CAMERAS: [Self; 5] = [
        Self::Frustum,
        Self::Prepass,
        Self::Gpu,
        Self::Camera,
        Self::CameraPrepass,
    ];

    /// The same with lights.
    pub const OF_LIGHTS: [Self; 5] = [
        Self::Frustum,
        Self::Prepass,
        Self::Gpu,
        Self::Camera,
        Self::All,
    ];

    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frustum => "frustum alone",
            Self::Prepass => "frustum, depth prepass",
            Self::Gpu => "Bevy's GPU culling",
            Self::Camera => "this crate, camera",
            Self::CameraPrepass => "this crate, camera, depth prepass",
            Self::All => "this crate, camera and lights",
        }
    }

    /// Switches a world's cameras and lights to it.
    pub fn set(self, world: &mut World) {
        let cameras: Vec<Entity> = world
            .query_filtered::<Entity, (With<Camera3d>, Without<CpuOcclusionOverlayCamera>)>()
            .iter(world)
            .collect();
        for camera in cameras {
            let mut camera = world.entity_mut(camera);
            camera.remove::<(OcclusionCulling, DepthPrepass, CpuOcclusionCulling)>();
            match self {
                Self::Frustum => {}
                Self::Prepass => {
                    camera.insert(DepthPrepass);
                }
                Self::Gpu => {
                    camera.insert((OcclusionCulling, DepthPrepass));
                }
                Self::CameraPrepass => {
                    camera.insert((CpuOcclusionCulling::default(), DepthPrepass));
                }
                Self::Camera | Self::All => {
                    camera.insert(CpuOcclusionCulling::default());
                }
            }
        }
        type Light = Or<(With<PointLight>, With<SpotLight>, With<DirectionalLight>)>;
        let lights: Vec<Entity> = world
            .query_filtered::<Entity, Light>()
            .iter(world)
            .collect();
        for light in lights {
            let mut light = world.entity_mut(light);
            light.remove::<(OcclusionCulling, CpuOcclusionCulling)>();
            match self {
                Self::Gpu => {
                    light.insert(OcclusionCulling);
                }
                Self::All => {
                    light.insert(CpuOcclusionCulling::default());
                }
                Self::Frustum | Self::Prepass | Self::Camera | Self::CameraPrepass => {}
            }
        }
    }
}
