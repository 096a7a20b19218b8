//! What a Foveal frame is made from: meshes, materials, instances, lights, cameras.
//!
//! A [`Scene`] is plain data without any graphics API in it. It comes from a glTF 2.0 file
//! ([`load`]) or from the project's own code ([`generate`]), and is posed at a point in time by
//! [`Scene::pose`]. Conventions are glTF's: right-handed, y up, metres, counter-clockwise front
//! faces, column vectors; matrices are named *to_from* (`world_from_object`).
#![forbid(unsafe_code)]

pub mod generate;

mod bounds;
mod camera;
mod light;
mod material;
mod mesh;
mod scene;
mod texture;

pub use bounds::Aabb;
pub use camera::{Camera, Projection};
pub use light::{Environment, Light, LightKind};
pub use material::{AlphaMode, Material, TextureRef};
pub use mesh::{Mesh, Vertex};
pub use scene::{Instance, Object, Scene, Warning};
pub use texture::{ColorSpace, Filter, Sampler, Texture, Wrap};
