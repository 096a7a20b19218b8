//! The G-buffer and the pass that fills it.

use super::{
    DrawList, Draws, PipelineKey, PipelineRecipe, Pipelines, Rates, ResolveAt, VertexSource,
    VisibilityPass,
};
use super::{FaceNormals, Motion};

use super::{GBuffer, Window};
use crate::formats::{IDENTITY_FORMAT, SURFACE_FORMAT};
use crate::gpu::Gpu;
use crate::recorder::{Recorder, overwritten};
use crate::scene::{MaterialDispatch, SceneOnGpu};
use crate::stereo::{EyeLayout, Submission};
use crate::{Antialiasing, Geometry, SamplePattern, Settings, shader};

/// Fills the G-buffer with opaque and masked surfaces.
#[derive(Debug)]
pub(crate) struct GeometryPass {
    means: Means,
    submission: Submission,
    layout: EyeLayout,
}

/// What the rasterizer's fragments are.
#[derive(Debug)]
enum Means {
    /// Surfaces.
    Surfaces(Pipelines),
    /// Triangles, evaluated afterwards.
    Triangles(Box<VisibilityPass>),
}

impl GeometryPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        submission: Submission,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let means = match settings.geometry.path {
            Geometry::Visibility => {
                // A rotated pattern draws the frame once per sample; there are at most 8.
                let rotated = settings.antialiasing.mode != Antialiasing::None
                    && settings.antialiasing.pattern == SamplePattern::Rotated;
                let windows = if rotated {
                    settings.antialiasing.samples
                } else {
                    1
                };
                let further = crate::antialias::footprint(settings);
                Means::Triangles(Box::new(VisibilityPass::new(
                    gpu,
                    frame_layout,
                    (MaterialDispatch::of(gpu, settings), material_layout),
                    (
                        FaceNormals::wanted_by(settings),
                        Motion::wanted_by(settings),
                    ),
                    (windows, crate::antialias::adds_lobes(settings)),
                    (further, Rates::wanted_by(settings)),
                    (submission, EyeLayout::of(settings)),
                )))
            }
            Geometry::Gbuffer => Means::Surfaces(Self::surfaces(
                gpu,
                settings,
                submission,
                frame_layout,
                material_layout,
            )),
        };
        Self {
            means,
            submission,
            layout: EyeLayout::of(settings),
        }
    }

    fn surfaces(
        gpu: &Gpu,
        settings: &Settings,
        submission: Submission,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Pipelines {
        let face_normals = FaceNormals::wanted_by(settings) == FaceNormals::Written;
        let mut constants = submission.constants().to_vec();
        let motion = if gpu.is_reduced() {
            Motion::Omitted
        } else {
            Motion::wanted_by(settings)
        };
        constants.push(motion.constant());
        if !gpu.is_reduced() {
            constants.push(("FACE_NORMAL", f64::from(u8::from(face_normals))));
            let black = crate::antialias::adds_lobes(settings);
            constants.push(("BLACK_BELOW_LOBES", f64::from(u8::from(black))));
        }
        let shader = match submission {
            _ if submission.clips() => shader::GEOMETRY_GBUFFER.variant(&["CLIPPED"]),
            Submission::Multiview => shader::GEOMETRY_GBUFFER.variant(&["LAYERED"]),
            _ if gpu.is_reduced() => shader::REDUCED_GBUFFER.variant(&["REDUCED"]),
            _ => shader::GEOMETRY_GBUFFER,
        };
        Pipelines::new(PipelineRecipe {
            label: "geometry",
            module: shader::module(gpu, "geometry", shader),
            layout: gpu.pipeline_layout("geometry", &[frame_layout, material_layout]),
            vertex: VertexSource::Buffers(submission.vertex_entry()),
            fragment: "fragment",
            targets: vec![Some(SURFACE_FORMAT.into()), Some(IDENTITY_FORMAT.into())],
            writes_depth: true,
            depth_compare: wgpu::CompareFunction::Greater,
            constants,
            has_mask: true,
            multiview_mask: submission.multiview_mask(),
        })
    }

    /// Takes over another size of the picture.
    pub(crate) fn resize(&mut self, settings: &Settings) {
        self.layout = EyeLayout::of(settings);
        if let Means::Triangles(pass) = &mut self.means {
            pass.resize(self.layout);
        }
    }

    /// The frame fills the target.
    fn whole(&self) -> Window {
        let (width, height) = self.layout.target_size();
        Window::sized(width, height)
    }

    /// The visibility buffer's passes, where they are used.
    #[cfg(test)]
    pub(crate) fn triangles(&self) -> Option<&VisibilityPass> {
        match &self.means {
            Means::Triangles(pass) => Some(pass),
            Means::Surfaces(_) => None,
        }
    }

    /// Makes the pipelines that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, scene: &SceneOnGpu, list: &DrawList) {
        match &mut self.means {
            Means::Surfaces(pipelines) => {
                let mut keys: Vec<PipelineKey> = list.solid.iter().map(|b| b.key).collect();
                keys.dedup();
                for key in keys {
                    pipelines.prepare(gpu, key);
                }
            }
            Means::Triangles(pass) => pass.prepare(gpu, scene, list),
        }
    }

    /// Encodes the pass.
    pub(crate) fn draw(&self, recorder: &mut Recorder<'_>, draws: Draws<'_>, target: &GBuffer) {
        self.draw_windows(recorder, draws, target, &[self.whole()]);
    }

    /// Encodes what of [`GeometryPass::draw`] does not depend on materials, where surfaces are
    /// evaluated after the rasterizer.
    pub(crate) fn draw_triangles(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
    ) {
        self.draw_triangle_windows(recorder, draws, target, &[self.whole()]);
    }

    /// The same, drawing the frame once into each of `windows`.
    pub(crate) fn draw_triangle_windows(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
    ) {
        if let Means::Triangles(pass) = &self.means {
            pass.draw_triangles(recorder, draws, target, windows);
        }
    }

    /// Encodes the rest of it, at the pixels of `at`.
    pub(crate) fn resolve(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        at: &ResolveAt<'_>,
    ) {
        if let Means::Triangles(pass) = &self.means {
            pass.resolve(recorder, draws, target, &[self.whole()], at);
        }
    }

    /// Encodes the evaluation of further surfaces of pixels at edges into texels that lie anywhere
    /// in the picture.
    pub(crate) fn resolve_further(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
    ) {
        if let Means::Triangles(pass) = &self.means {
            pass.resolve_further(recorder, draws, target, self.whole());
        }
    }

    /// Encodes the pass, drawing the frame once into each of `windows`.
    pub(crate) fn draw_windows(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
    ) {
        let pipelines = match &self.means {
            Means::Surfaces(pipelines) => pipelines,
            Means::Triangles(pass) => {
                pass.draw_triangles(recorder, draws, target, windows);
                return pass.resolve(recorder, draws, target, windows, &ResolveAt::FULL);
            }
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let colors = [
            overwritten(&target.surface_view),
            overwritten(&target.identity_view),
        ];
        let mask = self.submission.multiview_mask();
        let mut pass = recorder.layered_pass("geometry", &colors, Some(depth), mask);
        draws.scene.geometry.bind(&mut pass);
        for &Window { frame, part } in windows {
            for &drawn in self.submission.drawn() {
                self.layout
                    .window_of(drawn, Window { frame, part })
                    .set(&mut pass);
                DrawList::issue(&draws.list.solid, &mut pass, draws.scene, pipelines, drawn);
            }
        }
    }
}
