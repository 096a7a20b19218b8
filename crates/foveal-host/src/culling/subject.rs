//! What is culled: occluders, the boxes that are asked about, and the eyes.

use foveal_scene::Scene;

use super::eye::NamedEye;
use super::occludees::Occludees;
use super::occluders::{Choice, Occluders};

/// A scene, or a stretch of a recording.
#[derive(Debug)]
pub struct Subject {
    /// The scene's name, or the recording's file.
    pub name: String,
    /// What hides.
    pub occluders: Occluders,
    /// What is asked about.
    pub occludees: Occludees,
    /// Where it is seen from.
    pub eyes: Vec<NamedEye>,
    /// What could not be represented, for a human.
    pub notes: Vec<String>,
}

impl Subject {
    /// A scene, seen by `eyes`.
    ///
    /// # Errors
    /// Where its occluders cannot be baked.
    pub fn of_scene(scene: &Scene, choice: &Choice, eyes: Vec<NamedEye>) -> anyhow::Result<Self> {
        Ok(Self {
            name: scene.name.clone(),
            occluders: Occluders::of_scene(scene, choice)?,
            occludees: Occludees::of_scene(scene),
            eyes,
            notes: Vec::new(),
        })
    }
}
