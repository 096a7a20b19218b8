//! The pass that draws triangles.

use super::VisibilityTargets;
use crate::formats::TRIANGLE_FORMAT;
use crate::geometry::{
    DrawList, Draws, GBuffer, IDENTITY_FORMAT, Motion, PipelineKey, PipelineRecipe, Pipelines,
    VertexSource, Window,
};

use crate::gpu::Gpu;
use crate::recorder::{Recorder, overwritten};
use crate::shader;
use crate::stereo::{EyeLayout, Submission};

/// Draws instance and motion, the triangle's number, and depth.
#[derive(Debug)]
pub(super) struct VisiblePass {
    pipelines: Pipelines,
    /// Vertices are fetched by the shader, by indices that tell it the triangle.
    pulled: bool,
    eyes: (Submission, EyeLayout),
}

impl VisiblePass {
    pub(super) fn new(
        gpu: &Gpu,
        layouts: [&wgpu::BindGroupLayout; 3],
        eyes: (Submission, EyeLayout),
        motion: Motion,
    ) -> Self {
        let numbered = gpu.numbers_triangles();
        let layered = eyes.0 == Submission::Multiview;
        let (shader, vertex) = match (numbered, layered) {
            (true, false) => (shader::GEOMETRY_VISIBILITY_INDEXED, "vertex_indexed"),
            (true, true) => (
                shader::GEOMETRY_VISIBILITY_INDEXED.variant(&["LAYERED"]),
                "vertex_indexed_layered",
            ),
            (false, false) => (shader::GEOMETRY_VISIBILITY_PULLED, "vertex_pulled"),
            (false, true) => (
                shader::GEOMETRY_VISIBILITY_PULLED.variant(&["LAYERED"]),
                "vertex_pulled_layered",
            ),
        };
        let (layouts, vertex, fragment) = if numbered {
            let vertex = VertexSource::Buffers(vertex);
            (&layouts[..2], vertex, "visible_indexed")
        } else {
            let vertex = VertexSource::Shader(vertex);
            (&layouts[..], vertex, "visible_pulled")
        };
        let mut constants = eyes.0.constants().to_vec();
        constants.push(motion.constant());
        let pipelines = Pipelines::new(PipelineRecipe {
            label: "visibility",
            module: shader::module(gpu, "visibility", shader),
            layout: gpu.pipeline_layout("visibility", layouts),
            vertex,
            fragment,
            targets: vec![Some(IDENTITY_FORMAT.into()), Some(TRIANGLE_FORMAT.into())],
            writes_depth: true,
            depth_compare: wgpu::CompareFunction::Greater,
            constants,
            has_mask: true,
            multiview_mask: eyes.0.multiview_mask(),
        });
        Self {
            pipelines,
            pulled: !numbered,
            eyes,
        }
    }

    /// Of a material only what cuts holes matters here.
    fn key(key: PipelineKey) -> PipelineKey {
        const HAS_BASE_COLOR: u32 = 1;
        const HAS_UV_MAP: u32 = 128;
        PipelineKey {
            class: if key.masked {
                key.class & (HAS_BASE_COLOR | HAS_UV_MAP)
            } else {
                0
            },
            ..key
        }
    }

    pub(super) fn resize(&mut self, layout: EyeLayout) {
        self.eyes.1 = layout;
    }

    pub(super) fn prepare(&mut self, gpu: &Gpu, list: &DrawList) {
        for batch in &list.solid {
            self.pipelines.prepare(gpu, Self::key(batch.key));
        }
    }

    pub(super) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        visibility: &VisibilityTargets,
        windows: &[Window],
    ) {
        let Draws { scene, list } = draws;
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let colors = [
            overwritten(&target.identity_view),
            overwritten(&visibility.triangle_view),
        ];
        let (submission, layout) = &self.eyes;
        let mask = submission.multiview_mask();
        let mut pass = recorder.layered_pass("geometry", &colors, Some(depth), mask);
        if self.pulled {
            pass.set_bind_group(2, scene.geometry.group(), &[]);
            scene.geometry.bind_provoking(&mut pass);
        } else {
            scene.geometry.bind(&mut pass);
        }
        for &Window { frame, part } in windows {
            for &drawn in submission.drawn() {
                let window = layout.window_of(drawn, Window { frame, part });
                window.set(&mut pass);
                let pipeline = |key| self.pipelines.get(Self::key(key));
                DrawList::issue_with(&list.solid, &mut pass, scene, pipeline, self.pulled, drawn);
            }
        }
    }
}
