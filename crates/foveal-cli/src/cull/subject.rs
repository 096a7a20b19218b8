//! What is culled: occluders, the boxes that are asked about, and the eyes.

use foveal_scene::Scene;

use super::occludees::Occludees;
use foveal_host::culling::NamedEye;
use foveal_host::culling::{Choice, Occluders};

/// A scene, or a stretch of a recording.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) occluders: Occluders,
    pub(crate) occludees: Occludees,
    pub(crate) eyes: Vec<NamedEye>,
    /// What could not be represented, for a human.
    pub(crate) notes: Vec<String>,
}

impl Subject {
    /// A scene, seen by `eyes`.
    pub(crate) fn of_scene(
        scene: &Scene,
        choice: &Choice,
        eyes: Vec<NamedEye>,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            name: scene.name.clone(),
            occluders: Occluders::of_scene(scene, choice)?,
            occludees: Occludees::of_scene(scene),
            eyes,
            notes: Vec::new(),
        })
    }
}
