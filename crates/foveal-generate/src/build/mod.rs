//! Building blocks: meshes from shapes, scenes from meshes.

mod mesh;
mod scene;
mod shapes;

pub(crate) use mesh::MeshBuilder;
pub(crate) use scene::{SceneBuilder, named};
