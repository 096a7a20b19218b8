//! The plugin: resources, systems and their order.

use crate::stats::CpuOcclusionStats;
use crate::{cameras, materials, occluders, ready, stats};
use bevy_app::{App, Plugin, PostUpdate};
use bevy_asset::AssetEventSystems;
use bevy_camera::visibility::VisibilitySystems;
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy_transform::TransformSystems;

/// Occlusion culling on the CPU for cameras and lights that ask for it by
/// [`CpuOcclusionCulling`](crate::CpuOcclusionCulling).
///
/// Works beside `DefaultPlugins` in any order, with pipelined rendering and without. It needs of Bevy
/// the plugins of transforms, assets, meshes, cameras and, for lights, `LightPlugin`.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuOcclusionPlugin;

/// The steps of a frame, in `PostUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CpuOcclusionSystems {
    /// Occluders follow their entities, meshes and materials.
    UpdateOccluders,
    /// Hidden meshes leave `VisibleEntities` of cameras: after `VisibilitySystems::CheckVisibility`,
    /// before anything of lights.
    CullCameras,
    /// Hidden casters leave the lists of lights: after
    /// `SimulationLightSystems::CheckLightVisibility`.
    CullLights,
}

/// Steps before [`CpuOcclusionSystems::UpdateOccluders`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MaterialSteps {
    Clear,
    Judge,
}

impl Plugin for CpuOcclusionPlugin {
    fn build(&self, app: &mut App) {
        use CpuOcclusionSystems::{CullCameras, CullLights, UpdateOccluders};
        app.init_resource::<occluders::Occluders>()
            .init_resource::<materials::MaterialVerdicts>()
            .init_resource::<ready::Pipelines>()
            .init_resource::<cameras::CameraCullers>()
            .init_resource::<CpuOcclusionStats>()
            .configure_sets(
                PostUpdate,
                (
                    MaterialSteps::Clear,
                    MaterialSteps::Judge,
                    UpdateOccluders,
                    CullCameras,
                    CullLights,
                )
                    .chain(),
            )
            .configure_sets(
                PostUpdate,
                UpdateOccluders
                    .after(TransformSystems::Propagate)
                    .after(AssetEventSystems)
                    .after(VisibilitySystems::CalculateBounds)
                    .after(VisibilitySystems::VisibilityPropagate),
            )
            .configure_sets(
                PostUpdate,
                CullCameras
                    .after(VisibilitySystems::CheckVisibility)
                    .before(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
            )
            .add_systems(
                PostUpdate,
                (
                    materials::clear.in_set(MaterialSteps::Clear),
                    occluders::update.in_set(UpdateOccluders),
                    cameras::cull.in_set(CullCameras),
                    stats::measure.after(CullLights),
                ),
            );
        stats::register(app);
        #[cfg(feature = "bevy_light")]
        {
            use bevy_light::SimulationLightSystems as Lights;
            app.configure_sets(
                PostUpdate,
                CullCameras
                    .before(Lights::AssignLightsToClusters)
                    .before(Lights::UpdateLightFrusta)
                    .before(Lights::CheckLightVisibility),
            )
            .configure_sets(PostUpdate, CullLights.after(Lights::CheckLightVisibility))
            .init_resource::<crate::receivers::Receivers>()
            .add_systems(
                PostUpdate,
                (crate::receivers::gather, crate::lights::cull)
                    .chain()
                    .in_set(CullLights),
            );
        }
        #[cfg(feature = "bevy_pbr")]
        app.add_systems(
            PostUpdate,
            (
                materials::judge_standard.in_set(MaterialSteps::Judge),
                crate::automatic::choose
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::CalculateBounds)
                    .after(AssetEventSystems)
                    .before(MaterialSteps::Clear),
            ),
        );
    }

    // Bevy's renderer is there by now, wherever its plugin stands.
    #[cfg(feature = "bevy_pbr")]
    fn finish(&self, app: &mut App) {
        ready::watch_pipelines(app);
        #[cfg(feature = "overlay")]
        crate::overlay::add(app);
    }
}
