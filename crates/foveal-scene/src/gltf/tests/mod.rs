//! Tests of the importer on small files made on the spot.

mod basis;
mod clips;
mod codes;
mod compressed;
mod geometry;
mod glossiness;
mod hostile;
mod image_lights;
mod lobes;
mod materials;
mod motion;
mod nodes;
mod numbers;
mod pointers;
mod unneeded;

pub(super) use foveal_seeds::File;

use crate::{LoadOptions, Scene, SceneError, load_bytes};

/// Loads files in the making.
pub(super) trait Loads {
    fn load_with(&self, options: &LoadOptions) -> Result<Scene, SceneError>;
    fn load(&self) -> Scene;
    /// The error of a file that must not load.
    fn refusal(&self) -> String;
}

impl Loads for File {
    fn load_with(&self, options: &LoadOptions) -> Result<Scene, SceneError> {
        load_bytes(
            &self.glb(),
            "test.glb",
            options,
            &|_| Err("no files".into()),
        )
    }

    fn load(&self) -> Scene {
        self.load_with(&LoadOptions::default()).unwrap()
    }

    fn refusal(&self) -> String {
        self.load_with(&LoadOptions::default())
            .unwrap_err()
            .to_string()
    }
}

/// All warnings in one text.
pub(super) fn warnings(scene: &Scene) -> String {
    let texts: Vec<&str> = scene.warnings.iter().map(|w| w.text.as_str()).collect();
    texts.join("\n")
}

pub(super) fn near(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
}
