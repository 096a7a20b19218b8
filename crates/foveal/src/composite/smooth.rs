//! The smooth composite: patches fitted to the samples (`patches.rs`), then each pixel from its
//! tile's patch.
//!
//! Large tiles are drawn as quads whose vertices bring the patch along, so that a pixel looks
//! nothing up; the pixels of small tiles look up theirs. What only some pixels need runs behind a
//! stencil, since not all devices skip the branch that no pixel takes.

use super::patch_targets::{DRAW_BYTES, PatchTargets};
use super::patches::PatchPass;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read};
use crate::recorder::{Recorder, overwritten};
use crate::shader::Screen;
use crate::shading::{CoarseTargets, RADIANCE_FORMAT, stencil_state};
use crate::targets::Targets;
use crate::{Settings, shader};

/// What a pixel's stencil says: a quad covered it, or another surface than its tile's sample is
/// seen there.
const COVERED: u32 = 1;
const EDGE: u32 = 2;

/// Fits patches and reads them.
#[derive(Debug)]
pub(crate) struct SmoothComposite {
    patches: PatchPass,
    tiles: wgpu::RenderPipeline,
    others: wgpu::RenderPipeline,
    mark_edges: wgpu::RenderPipeline,
    edges: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl SmoothComposite {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let layout = bind_group_layout(
            gpu,
            "smooth composite",
            wgpu::ShaderStages::VERTEX_FRAGMENT,
            &[
                uint,
                float,
                words,
                words,
                depth,
                storage_read(),
                storage_read(),
                storage_read(),
            ],
        );
        let shader = if settings.sees_by_depth() {
            shader::COMPOSITE_SMOOTH.variant(&["BY_DEPTH"])
        } else {
            shader::COMPOSITE_SMOOTH
        };
        let module = shader::module(gpu, "smooth composite", shader);
        let target = |write_mask| wgpu::ColorTargetState {
            format: RADIANCE_FORMAT,
            blend: None,
            write_mask,
        };
        let pipeline = |label, vertex, fragment, topology, stencil, write_mask| {
            shader::screen(
                gpu,
                &Screen {
                    vertex,
                    topology,
                    groups: &[frame_layout, &layout],
                    targets: &[Some(target(write_mask))],
                    depth_stencil: Some(stencil),
                    ..Screen::of(label, &module, fragment)
                },
            )
        };
        use wgpu::{ColorWrites, CompareFunction as Compare, StencilOperation as Op};
        let (strip, list) = (
            wgpu::PrimitiveTopology::TriangleStrip,
            wgpu::PrimitiveTopology::TriangleList,
        );
        let marking = stencil_state(Compare::Always, Op::Replace);
        Self {
            patches: PatchPass::new(gpu, frame_layout),
            tiles: pipeline(
                "smooth tiles",
                "tile_vertex",
                "tile_pixel",
                strip,
                marking.clone(),
                ColorWrites::ALL,
            ),
            others: pipeline(
                "smooth pixels",
                "level_screen",
                "other_pixel",
                list,
                stencil_state(Compare::NotEqual, Op::Keep),
                ColorWrites::ALL,
            ),
            mark_edges: pipeline(
                "smooth edge marks",
                "edge_vertex",
                "mark_edge_pixel",
                strip,
                marking,
                ColorWrites::empty(),
            ),
            edges: pipeline(
                "smooth edges",
                "edge_vertex",
                "edge_pixel",
                strip,
                stencil_state(Compare::Equal, Op::Keep),
                ColorWrites::ALL,
            ),
            layout,
        }
    }

    /// Encodes the passes.
    pub(super) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
        patches: &PatchTargets,
    ) {
        self.patches.fit(recorder, targets, from, patches);
        let views = [
            &from.rate.owner.whole,
            &from.samples.whole,
            &targets.gbuffer.surface_layers,
            &targets.gbuffer.identity_layers,
            &targets.gbuffer.depth_layers,
        ];
        let [corners, raises] = &patches.parts;
        let buffers = [corners, raises, &patches.quad_tiles];
        let bindings: Vec<_> = views
            .map(wgpu::BindingResource::TextureView)
            .into_iter()
            .chain(buffers.map(wgpu::Buffer::as_entire_binding))
            .collect();
        let group = bind_group(
            &recorder.gpu.device,
            "smooth composite",
            &self.layout,
            &bindings,
        );
        let stencil = wgpu::RenderPassDepthStencilAttachment {
            view: patches.stencil.level(0),
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0),
                store: wgpu::StoreOp::Discard,
            }),
        };
        let into = [overwritten(&targets.radiance_view)];
        let mut pass = recorder.render_pass("composite", &into, Some(stencil));
        pass.set_bind_group(1, &group, &[]);
        pass.set_stencil_reference(COVERED);
        pass.set_pipeline(&self.tiles);
        pass.draw_indirect(&patches.quads, 0);
        pass.set_pipeline(&self.others);
        patches.stencil.draw(&mut pass, 0);
        pass.set_stencil_reference(EDGE);
        for pipeline in [&self.mark_edges, &self.edges] {
            pass.set_pipeline(pipeline);
            pass.draw_indirect(&patches.quads, DRAW_BYTES);
        }
    }
}
