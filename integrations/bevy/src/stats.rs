//! The stats of the last frame, and Bevy's diagnostics of them.

use crate::plugin::CpuOcclusionPlugin;
use bevy_app::App;
use bevy_diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::Res;
use core::time::Duration;

/// What the culler did in the last frame, over all cameras and lights.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CpuOcclusionStats {
    /// Occluders that are visible, whose material may occlude, and that have been drawn for long
    /// enough.
    pub occluders: usize,
    /// Views of cameras that were culled.
    pub cameras: usize,
    /// Meshes in the frusta of these, as Bevy found them.
    pub meshes: usize,
    /// Of these, hidden.
    pub meshes_hidden: usize,
    /// Views of lights that were culled: six of a point light, one of a spot light, one for each
    /// cascade of a directional light.
    pub light_views: usize,
    /// Shadow casters in the frusta of these, as Bevy found them.
    pub casters: usize,
    /// Of these, left out because occluders hide them from the light.
    pub casters_hidden: usize,
    /// Of these, left out because their shadow falls on nothing that a camera sees.
    pub casters_unseen: usize,
    /// Point and spot lights that are not drawn, because nothing that they light is seen.
    pub lights_unseen: usize,
    /// Views that occluders cannot be drawn for: they kept everything but casters whose shadow falls on
    /// nothing that a camera sees.
    pub refused_views: usize,
    /// Views that kept everything because Bevy is compiling pipelines: not all is drawn that will be.
    pub waiting_views: usize,
    /// Views with [`OcclusionBufferSize::Exact`](crate::OcclusionBufferSize::Exact) whose exact buffer
    /// would have more than 4,096 pixels on a side. They get half of that or less, and may lose what
    /// shows only through narrow slits.
    pub coarse_views: usize,
    /// Time for keeping occluders up to date, baking included.
    pub update_time: Duration,
    /// Time for all cameras.
    pub camera_time: Duration,
    /// Time for all lights.
    pub light_time: Duration,
}

impl CpuOcclusionPlugin {
    /// Meshes in the frusta of culled cameras.
    pub const MESHES: DiagnosticPath = DiagnosticPath::const_new("cpu_occlusion/meshes");
    /// Of these, hidden.
    pub const MESHES_HIDDEN: DiagnosticPath =
        DiagnosticPath::const_new("cpu_occlusion/meshes_hidden");
    /// Shadow casters in the frusta of culled lights.
    pub const CASTERS: DiagnosticPath = DiagnosticPath::const_new("cpu_occlusion/casters");
    /// Of these, left out because occluders hide them from the light.
    pub const CASTERS_HIDDEN: DiagnosticPath =
        DiagnosticPath::const_new("cpu_occlusion/casters_hidden");
    /// Of these, left out because their shadow falls on nothing that a camera sees.
    pub const CASTERS_UNSEEN: DiagnosticPath =
        DiagnosticPath::const_new("cpu_occlusion/casters_unseen");
    /// Time of all of it together.
    pub const TIME: DiagnosticPath = DiagnosticPath::const_new("cpu_occlusion/time");
}

pub(crate) fn register(app: &mut App) {
    for path in [
        CpuOcclusionPlugin::MESHES,
        CpuOcclusionPlugin::MESHES_HIDDEN,
        CpuOcclusionPlugin::CASTERS,
        CpuOcclusionPlugin::CASTERS_HIDDEN,
        CpuOcclusionPlugin::CASTERS_UNSEEN,
    ] {
        app.register_diagnostic(Diagnostic::new(path));
    }
    app.register_diagnostic(Diagnostic::new(CpuOcclusionPlugin::TIME).with_suffix(" ms"));
}

pub(crate) fn measure(stats: Res<CpuOcclusionStats>, mut diagnostics: Diagnostics) {
    let mut add = |path, value: f64| diagnostics.add_measurement(&path, || value);
    add(CpuOcclusionPlugin::MESHES, stats.meshes as f64);
    add(
        CpuOcclusionPlugin::MESHES_HIDDEN,
        stats.meshes_hidden as f64,
    );
    add(CpuOcclusionPlugin::CASTERS, stats.casters as f64);
    add(
        CpuOcclusionPlugin::CASTERS_HIDDEN,
        stats.casters_hidden as f64,
    );
    add(
        CpuOcclusionPlugin::CASTERS_UNSEEN,
        stats.casters_unseen as f64,
    );
    let time = stats.update_time + stats.camera_time + stats.light_time;
    add(CpuOcclusionPlugin::TIME, time.as_secs_f64() * 1e3);
}
