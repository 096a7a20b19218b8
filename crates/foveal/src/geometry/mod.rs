//! Geometry: what is seen at each pixel, into a compact G-buffer.

mod draw_list;
mod face_normals;
mod gbuffer;
mod motion;
mod pipelines;
#[cfg(test)]
mod procedural;
mod sorted;
mod target;
#[cfg(test)]
mod twin;
mod visibility;
mod window;

pub(crate) use crate::formats::{DEPTH_FORMAT, IDENTITY_FORMAT, SURFACE_FORMAT, TRIANGLE_FORMAT};
pub(crate) use crate::scene::geometry_layout;
pub(crate) use draw_list::{Batch, DrawList, Draws};
pub(crate) use face_normals::FaceNormals;
pub(crate) use gbuffer::GeometryPass;
pub(crate) use motion::Motion;
pub(crate) use pipelines::{Faces, PipelineKey, PipelineRecipe, Pipelines, Shape, VertexSource};
pub(crate) use target::GBuffer;
pub(crate) use visibility::{Rates, ResolveAt, VisibilityPass, VisibilityTargets};
#[cfg(test)]
pub(crate) use visibility::{WindowsUniform, level_scene};
pub(crate) use window::Window;
