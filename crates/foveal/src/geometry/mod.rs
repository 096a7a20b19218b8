//! Geometry: what is seen at each pixel, into a compact G-buffer.

mod draw_list;
mod gbuffer;
mod pipelines;
#[cfg(test)]
mod procedural;
#[cfg(test)]
mod twin;
mod visibility;

pub(crate) use crate::scene::geometry_layout;
pub(crate) use draw_list::{DrawList, Draws};
pub(crate) use gbuffer::{
    DEPTH_FORMAT, FaceNormals, GBuffer, GeometryPass, IDENTITY_FORMAT, SURFACE_FORMAT, Window,
};
pub(crate) use pipelines::{Faces, PipelineKey, PipelineRecipe, Pipelines, VertexSource};
pub(crate) use visibility::{
    Evaluation, Rates, TRIANGLE_FORMAT, VisibilityPass, VisibilityTargets,
};
#[cfg(test)]
pub(crate) use visibility::{WindowsUniform, level_scene};
