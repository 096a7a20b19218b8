//! What a Foveal frame is made from: meshes, materials, instances, lights, cameras.
//!
//! A [`Scene`] is plain data without any graphics API in it. It comes from a glTF 2.0, OBJ or
//! PLY file ([`load`]) or from a program's own code (as the scenes of `foveal-generate` do), and is posed at
//! a point in time by [`Scene::pose`]. Conventions are glTF's: right-handed, y up, metres,
//! counter-clockwise front faces, column vectors; matrices are named *to_from*
//! (`world_from_object`).
//!
//! ```no_run
//! use foveal_scene::{LoadOptions, load};
//!
//! let mut scene = load("castle.glb".as_ref(), &LoadOptions::default())?;
//! scene.pose(1.5);
//! println!("{} objects within {:?}", scene.objects.len(), scene.bounds());
//! # Ok::<(), foveal_scene::SceneError>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may stop at once"))]

mod blocks;
mod camera;
mod cloud;
mod code;
mod compress;
mod error;
mod gltf;
mod image_light;
mod light;
mod load;
mod lobes;
mod material;
mod mesh;
pub mod mip;
#[cfg(not(target_arch = "wasm32"))]
mod other;
mod pose;
mod printable;
mod scene;
mod srgb;
mod texture;
mod threads;
mod timings;

pub use camera::{Camera, Projection};
pub use code::Code;
pub use error::{Limit, SceneError};
pub use foveal_bounds::Aabb;
pub use image_light::{ImageLight, harmonics};
pub use light::{Environment, Light, LightKind};
pub use load::{ENDINGS, LoadOptions, MissingNormals, load, load_bytes};
pub use lobes::{Anisotropy, Clearcoat, Iridescence, Sheen, Transmission};
pub use material::{AlphaMode, AnimatedParts, Material, ProceduralLayers};
pub use mesh::{Mesh, Vertex};
pub use pose::{Clip, Rig};
pub use printable::printable;
pub use scene::{Instance, Object, Scene, Warning};
pub use texture::{
    ColorSpace, Encoding, Filter, Sampler, Texture, TextureCompression, TextureRef, Wrap,
};
pub use timings::LoadTimings;
