//! The G-buffer.

use super::VisibilityTargets;
use crate::Geometry;
use crate::formats::{DEPTH_FORMAT, IDENTITY_FORMAT, SURFACE_FORMAT};
use crate::gpu::{self, Gpu};

/// What is seen at each pixel; 28 bytes a pixel. The eyes' pictures lie side by side in one layer,
/// or where geometry is drawn by multiview each in its own; passes draw into the views, and shaders
/// read the layers (`shared/layers.wgsl`).
#[derive(Debug)]
pub(crate) struct GBuffer {
    /// Base colour and occlusion, normal, emissive, metallic and roughness: `pack_surface` in
    /// `shared/surface.wgsl`.
    pub(crate) surface_view: wgpu::TextureView,
    /// Instance number + 1; motion in pixels as two halves, and whether the surface has moved in the
    /// world (`shared/identity.wgsl`).
    pub(crate) identity_view: wgpu::TextureView,
    /// Reversed depth.
    pub(crate) depth_view: wgpu::TextureView,
    pub(crate) surface_layers: wgpu::TextureView,
    pub(crate) identity_layers: wgpu::TextureView,
    pub(crate) depth_layers: wgpu::TextureView,
    /// Where surfaces are evaluated after the rasterizer.
    pub(crate) visibility: Option<VisibilityTargets>,
}

impl GBuffer {
    /// `layers` of this size each.
    pub(crate) fn new(gpu: &Gpu, geometry: Geometry, size: (u32, u32), layers: u32) -> Self {
        let by_triangles = geometry == Geometry::Visibility;
        let drawn = wgpu::TextureUsages::empty();
        let written = if by_triangles {
            wgpu::TextureUsages::STORAGE_BINDING
        } else {
            drawn
        };
        let target =
            |label, format, usage| gpu::layered_target(gpu, label, size, layers, format, usage);
        Self::of(
            target("G-buffer surface", SURFACE_FORMAT, written),
            target("G-buffer identity", IDENTITY_FORMAT, drawn),
            target("G-buffer depth", DEPTH_FORMAT, drawn),
            by_triangles.then(|| VisibilityTargets::new(gpu, size, layers)),
        )
    }

    /// One of these targets.
    pub(crate) fn of(
        surface_view: wgpu::TextureView,
        identity_view: wgpu::TextureView,
        depth_view: wgpu::TextureView,
        visibility: Option<VisibilityTargets>,
    ) -> Self {
        let [surface_layers, identity_layers, depth_layers] =
            [&surface_view, &identity_view, &depth_view].map(gpu::layers_of);
        Self {
            surface_view,
            identity_view,
            depth_view,
            surface_layers,
            identity_layers,
            depth_layers,
            visibility,
        }
    }
}
