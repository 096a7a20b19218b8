//! Geometry by a visibility buffer: the rasterizer says which triangle is seen at each pixel, and materials are
//! evaluated afterwards, once per pixel, whatever the overdraw.
//!
//! After Burns and Hunt 2013, 'The visibility buffer'. Passes: [`VisiblePass`] draws instance, motion, triangle and
//! depth; [`BinPass`] sorts the seen pixels by material; [`ResolvePass`] evaluates each material at its pixels, with
//! analytic barycentric coordinates and derivatives (`shared/attributes.wgsl`), and writes the surfaces of the
//! ordinary G-buffer, so that every later stage sees an ordinary G-buffer. Materials are bound one by one, so there
//! is one indirect dispatch per material, with the pipeline of its class.

mod bins;
mod raster;
mod resolve;
#[cfg(test)]
mod tests;

use super::{DrawList, FaceNormals, GBuffer, Window};
use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::scene::SceneOnGpu;
use crate::shader;
use bins::{BinPass, Bins};
use raster::VisiblePass;
use resolve::ResolvePass;
#[cfg(test)]
pub(crate) use resolve::WindowsUniform;

pub(crate) const TRIANGLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// What a visibility buffer holds besides the G-buffer's identity and depth; 8 bytes a pixel.
#[derive(Debug)]
pub(crate) struct VisibilityTargets {
    /// The triangle's number within its mesh.
    pub(crate) triangle_view: wgpu::TextureView,
    /// The seen pixels, `x | y << 16`, material by material.
    pub(crate) pixels: wgpu::Buffer,
}

impl VisibilityTargets {
    /// Bytes of both.
    pub(crate) fn bytes(&self) -> u64 {
        2 * self.pixels.size()
    }

    pub(crate) fn new(gpu: &Gpu, width: u32, height: u32) -> Self {
        let none = wgpu::TextureUsages::empty();
        let size = (width, height);
        Self {
            triangle_view: crate::gpu::target(gpu, "triangles", size, TRIANGLE_FORMAT, none),
            pixels: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("binned pixels"),
                size: u64::from(width) * u64::from(height) * 4,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        }
    }
}

/// Draws triangles, and evaluates their materials afterwards.
#[derive(Debug)]
pub(crate) struct VisibilityPass {
    raster: VisiblePass,
    bin: BinPass,
    resolve: ResolvePass,
    /// For the further surfaces of pixels at edges.
    further: Option<ResolvePass>,
    bins: Bins,
}

impl VisibilityPass {
    /// `windows`: as many as a frame is drawn into at once, 1 to 8. `further`: [`VisibilityPass::evaluate_further`]
    /// will be called.
    pub(crate) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
        face_normals: FaceNormals,
        windows: u32,
        further: bool,
    ) -> Self {
        let geometry_layout = crate::scene::geometry_layout(gpu);
        let raster = VisiblePass::new(gpu, frame_layout, material_layout, &geometry_layout);
        let layouts = [frame_layout, material_layout, &geometry_layout];
        let resolve = |parts, face_normals, windows| {
            ResolvePass::new(gpu, parts, layouts, face_normals, windows)
        };
        Self {
            raster,
            bin: BinPass::new(gpu),
            resolve: resolve(shader::RESOLVE, face_normals, windows),
            further: further.then(|| resolve(shader::RESOLVE_FURTHER, FaceNormals::Omitted, 1)),
            bins: Bins::new(gpu, 1),
        }
    }

    /// Makes the pipelines and the bins that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, scene: &SceneOnGpu, list: &DrawList) {
        self.raster.prepare(gpu, list);
        for batch in &list.solid {
            self.resolve.prepare(gpu, batch.key.class);
            if let Some(further) = &mut self.further {
                further.prepare(gpu, batch.key.class);
            }
        }
        let materials = scene.stats.materials as u32;
        if materials > self.bins.count() {
            self.bins = Bins::new(gpu, materials);
        }
    }

    /// Encodes all passes, for the frame drawn once into each of `windows`.
    pub(crate) fn draw_windows(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        windows: &[Window],
    ) {
        self.draw_triangles(recorder, scene, list, target, windows);
        self.evaluate(recorder, scene, list, target, windows);
    }

    /// Encodes the first pass alone: identity, triangle and depth.
    pub(crate) fn draw_triangles(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        windows: &[Window],
    ) {
        // Targets and passes are made for the same settings.
        if let Some(visibility) = &target.visibility {
            self.raster
                .draw(recorder, scene, list, target, visibility, windows);
        }
    }

    /// Encodes the passes after that: from identity and triangle to surfaces.
    pub(crate) fn evaluate(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        windows: &[Window],
    ) {
        self.evaluate_by(&self.resolve, recorder, scene, list, target, windows);
    }

    /// The same for a target whose texels lie anywhere in the picture: identity's second word tells, as
    /// `antialias/quarters.wgsl` has it.
    pub(crate) fn evaluate_further(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        whole: Window,
    ) {
        if let Some(further) = &self.further {
            self.evaluate_by(further, recorder, scene, list, target, &[whole]);
        }
    }

    fn evaluate_by(
        &self,
        resolve: &ResolvePass,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        windows: &[Window],
    ) {
        let Some(visibility) = &target.visibility else {
            return;
        };
        self.bin
            .sort(recorder, scene, target, visibility, &self.bins);
        resolve.draw(
            recorder, scene, list, target, visibility, &self.bins, windows,
        );
    }
}
