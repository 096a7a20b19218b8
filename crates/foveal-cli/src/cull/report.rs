//! The JSON of `foveal cull`; docs/cull-schema.md describes it.

use foveal_cull::{Eye, Visibility};
use glam::DVec3;
use serde::Serialize;

use super::measure::{Figures, Outcome};
use foveal_host::culling::mocrec::{Agreement, Verdict};
use foveal_host::culling::{Check, NamedEye, Subject};

/// Grows by one whenever a field changes its meaning or goes away.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// The whole run.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) schema: &'static str,
    pub(super) schema_version: u32,
    pub(super) program_version: &'static str,
    pub(super) scene: String,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) threads: u32,
    pub(super) frames: u32,
    /// Between two eyes; 0 for one.
    pub(super) eyes_apart_m: f32,
    pub(super) validity_radius_m: f32,
    /// `null` without one.
    pub(super) budget_ms: Option<f32>,
    pub(super) instruction_set: String,
    pub(super) warnings: Vec<String>,
    pub(super) cameras: Vec<CameraReport>,
}

/// One eye.
#[derive(Debug, Serialize)]
pub(super) struct CameraReport {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) view: ViewReport,
    #[serde(flatten)]
    pub(super) figures: Figures,
    /// `null` without `--check`.
    pub(super) check: Option<Check>,
    /// `null` for scenes.
    pub(super) recorded: Option<Agreement>,
    pub(super) objects: Vec<ObjectReport>,
}

/// Where the eye is and what it sees.
#[derive(Debug, Serialize)]
pub(super) struct ViewReport {
    eye: [f64; 3],
    forward: [f64; 3],
    up: [f64; 3],
    orthographic: bool,
    /// Left, right, bottom, top: tangents, or metres for orthographic views.
    extents: [f64; 4],
    near: f64,
    /// `null` when infinite.
    far: Option<f64>,
}

/// What became of one object.
#[derive(Debug, Serialize)]
pub(super) struct ObjectReport {
    pub(super) node: u32,
    pub(super) element: u32,
    pub(super) result: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) recorded: Option<Verdict>,
}

impl CameraReport {
    pub(super) fn new(
        subject: &Subject,
        eye: &NamedEye,
        outcome: &Outcome,
        check: Option<Check>,
    ) -> Self {
        let occludees = &subject.occludees;
        let objects = occludees
            .ids
            .iter()
            .zip(&outcome.results)
            .enumerate()
            .map(|(i, (&(node, element), &result))| ObjectReport {
                node,
                element,
                result: word(result),
                recorded: occludees.recorded.get(i).map(|r| r.verdict),
            })
            .collect();
        Self {
            name: eye.name.clone(),
            view: ViewReport::new(&eye.eye),
            figures: outcome.figures.clone(),
            check,
            recorded: Agreement::of(&occludees.recorded, &outcome.results),
            objects,
        }
    }
}

impl ViewReport {
    fn new(eye: &Eye) -> Self {
        let pose = eye.world_from_eye;
        let [near, far] = eye.projection.near_far_m();
        // No "-0.0" in the file.
        let point = |p: DVec3| (p + DVec3::ZERO).to_array();
        Self {
            eye: point(eye.position().into()),
            forward: point(-DVec3::from(pose.z_axis)),
            up: point(pose.y_axis.into()),
            orthographic: eye.projection.is_orthographic(),
            extents: eye.projection.extents(),
            near,
            far: far.is_finite().then_some(far),
        }
    }
}

/// As the schema spells it.
pub(super) fn word(visibility: Visibility) -> &'static str {
    match visibility {
        Visibility::Visible => "visible",
        Visibility::Outside => "frustum",
        Visibility::Small => "size",
        Visibility::Occluded => "occluded",
    }
}
