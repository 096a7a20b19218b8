//! Things that can be placed: named sets of mesh and material.

use crate::build::{MeshBuilder, SceneBuilder};
use foveal_scene::Mesh;

/// A kind of thing; each placing of it becomes one object.
#[derive(Clone, Debug)]
pub(super) struct Thing {
    /// The objects' name, to which a number is added.
    pub(super) name: &'static str,
    /// The part of the scene that it belongs to.
    pub(super) set: &'static str,
    /// Whether it hides much with few triangles.
    pub(super) occluder: bool,
    /// Its (mesh, material) pairs.
    pub(super) parts: Vec<(u32, u32)>,
}

impl Thing {
    /// Something that is culled but does not occlude.
    pub(super) fn new(name: &'static str, set: &'static str, parts: &[(u32, u32)]) -> Self {
        Self {
            name,
            set,
            occluder: false,
            parts: parts.to_vec(),
        }
    }

    /// The same as an occluder.
    pub(super) fn occluding(mut self) -> Self {
        self.occluder = true;
        self
    }
}

/// Makes a mesh from shapes and adds it to the scene.
pub(super) fn model(
    scene: &mut SceneBuilder,
    name: &str,
    shape: impl FnOnce(&mut MeshBuilder),
) -> u32 {
    let mut builder = MeshBuilder::new();
    shape(&mut builder);
    let mesh: Mesh = builder.finish(name);
    scene.mesh(mesh)
}
