//! Anti-aliasing over a visibility buffer: only triangles are drawn at every sub-sample.
//!
//! Pixels that show several triangles are listed (`candidates.wgsl`) and their sub-samples sorted
//! into surfaces (`sort.wgsl`); one triangle per surface is kept: the largest surface's in the
//! ordinary G-buffer (`classify.wgsl`), the others' in a target of their own, row by row in the
//! order of the queue's entries. Materials are resolved for those alone, so a pixel within a
//! surface costs what it costs without anti-aliasing, where the other way evaluates and averages
//! all sub-samples.

use super::further::WORD;
use crate::geometry::{DEPTH_FORMAT, IDENTITY_FORMAT, TRIANGLE_FORMAT, geometry_layout};
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, storage_read, storage_write, uniform,
};

use crate::recorder::{Recorder, drawn_over, overwritten};
use crate::scene::SceneOnGpu;
use crate::shader::Screen;
use crate::shading::lighting_constants;
use crate::targets::Targets;
use crate::{Settings, shader};

use super::choice::averages_all;
use super::pattern::{Band, Pattern};
use super::targets::{ALL_GROUPS, SampleTargets, TALLY_FORMAT};

/// Sorts triangles into surfaces, and shades the further ones.
#[derive(Debug)]
pub(super) struct TriangleStage {
    candidates: wgpu::ComputePipeline,
    candidates_layout: wgpu::BindGroupLayout,
    sort: wgpu::ComputePipeline,
    sort_layout: wgpu::BindGroupLayout,
    classify: wgpu::RenderPipeline,
    classify_layout: wgpu::BindGroupLayout,
    samples_layout: wgpu::BindGroupLayout,
    shade: wgpu::ComputePipeline,
    shade_layout: wgpu::BindGroupLayout,
}

impl TriangleStage {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        shading_input: &wgpu::BindGroupLayout,
    ) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let depth = sampled(wgpu::TextureSampleType::Depth);
        let (read, write) = (storage_read(), storage_write());
        let stored = |format| wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = |label, stage, types: &[_]| bind_group_layout(gpu, label, stage, types);
        let (fragment, compute) = (wgpu::ShaderStages::FRAGMENT, wgpu::ShaderStages::COMPUTE);
        let samples_layout = layout(
            "sub-samples' triangles",
            fragment | compute,
            &[uniform(), uint, uint, depth],
        );
        let candidates_layout = layout("candidates", compute, &[write, stored(WORD)]);
        let sort_layout = layout(
            "sorting",
            compute,
            &[
                write,
                write,
                uint,
                stored(WORD),
                stored(IDENTITY_FORMAT),
                stored(TRIANGLE_FORMAT),
                stored(WORD),
            ],
        );
        let classify_layout = layout("classification", fragment, &[uint]);
        let shade_layout = layout(
            "further shading",
            compute,
            &[read, read, write, uint, uint, uint],
        );
        let lighting = lighting_constants(settings);
        let [count, side] = Pattern::of(settings).constants();
        let coarse = f64::from(u8::from(!averages_all(settings)));
        let geometry = geometry_layout(gpu);
        let sorting = |label, shader, entry, group: &wgpu::BindGroupLayout| {
            shader::compute(
                gpu,
                label,
                &shader::module(gpu, label, shader),
                entry,
                &[frame, &samples_layout, &geometry, group],
                &[count, side],
            )
        };
        let targets = [IDENTITY_FORMAT, TRIANGLE_FORMAT, TALLY_FORMAT].map(|f| Some(f.into()));
        let classification = shader::module(gpu, "classification", shader::ANTIALIAS_CLASSIFY);
        Self {
            candidates: sorting(
                "candidates",
                shader::ANTIALIAS_CANDIDATES,
                "list_candidates",
                &candidates_layout,
            ),
            sort: sorting(
                "sorting",
                shader::ANTIALIAS_SORT,
                "sort_pixels",
                &sort_layout,
            ),
            classify: shader::screen(
                gpu,
                &Screen {
                    groups: &[frame, &samples_layout, &geometry, &classify_layout],
                    targets: &targets,
                    depth_stencil: Some(wgpu::DepthStencilState {
                        format: DEPTH_FORMAT,
                        depth_write_enabled: Some(true),
                        depth_compare: Some(wgpu::CompareFunction::Always),
                        stencil: wgpu::StencilState::default(),
                        bias: wgpu::DepthBiasState::default(),
                    }),
                    constants: &[count, side],
                    ..Screen::of("classification", &classification, "classify")
                },
            ),
            shade: shader::compute(
                gpu,
                "further shading",
                &shader::module(gpu, "further shading", shader::ANTIALIAS_SHADE_FURTHER),
                "shade_further",
                &[frame, shading_input, &shade_layout],
                &[&lighting[..], &[count, ("COARSE", coarse)]].concat(),
            ),
            candidates_layout,
            sort_layout,
            classify_layout,
            samples_layout,
            shade_layout,
        }
    }

    /// Empties what entries that no pixel has show.
    pub(super) fn begin(recorder: &mut Recorder<'_>, t: &SampleTargets) {
        if let Some(further) = &t.further {
            let emptied = [overwritten(&further.gbuffer.identity_view)];
            drop(recorder.render_pass("classification", &emptied, None));
        }
    }

    /// Encodes the sorting of a band's sub-samples, whose triangles are known: each pixel's largest
    /// surface into the ordinary G-buffer, the others into that of further surfaces.
    pub(super) fn classify(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        t: &SampleTargets,
        targets: &Targets,
        (band, uniform): (Band, &wgpu::Buffer),
    ) {
        // The settings that lead here have them.
        let Some(further) = &t.further else { return };
        let (Some(samples), Some(ordinary), Some(rest)) = (
            &t.samples.visibility,
            &targets.gbuffer.visibility,
            &further.gbuffer.visibility,
        ) else {
            return;
        };
        let gpu = recorder.gpu;
        let view = wgpu::BindingResource::TextureView;
        let group =
            |label, layout, bindings: &[_]| bind_group(&gpu.device, label, layout, bindings);
        let read = group(
            "sub-samples' triangles",
            &self.samples_layout,
            &[
                uniform.as_entire_binding(),
                view(&t.samples.identity_view),
                view(&samples.triangle_view),
                view(&t.samples.depth_view),
            ],
        );
        let candidates = group(
            "candidates",
            &self.candidates_layout,
            &[
                further.candidates.as_entire_binding(),
                view(&further.candidate_list_view),
            ],
        );
        let sorting = group(
            "sorting",
            &self.sort_layout,
            &[
                t.queue.as_entire_binding(),
                t.entries.as_entire_binding(),
                view(&further.candidate_list_view),
                view(&further.largest_view),
                view(&further.gbuffer.identity_view),
                view(&rest.triangle_view),
                view(&further.depth_view),
            ],
        );
        let sorted = group(
            "classification",
            &self.classify_layout,
            &[view(&further.largest_view)],
        );
        let width = targets.picture_view.texture().width();
        let emptied = [&further.candidate_list_view, &further.largest_view].map(overwritten);
        drop(recorder.render_pass("classification", &emptied, None));
        recorder.encoder.copy_buffer_to_buffer(
            &further.no_candidates,
            0,
            &further.candidates,
            0,
            None,
        );
        {
            let mut pass = recorder.compute_pass("sorting");
            pass.set_bind_group(1, &read, &[]);
            pass.set_bind_group(2, scene.geometry.group(), &[]);
            pass.set_bind_group(3, &candidates, &[]);
            pass.set_pipeline(&self.candidates);
            pass.dispatch_workgroups(width.div_ceil(8), band.rows.div_ceil(8), 1);
            pass.set_bind_group(3, &sorting, &[]);
            pass.set_pipeline(&self.sort);
            pass.dispatch_workgroups_indirect(&further.candidates, 0);
        }
        let gbuffer = &targets.gbuffer;
        let colors = [
            &gbuffer.identity_view,
            &ordinary.triangle_view,
            &t.tally_view,
        ]
        .map(drawn_over);
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &gbuffer.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let mut pass = recorder.render_pass("classification", &colors, Some(depth));
        pass.set_pipeline(&self.classify);
        pass.set_bind_group(1, &read, &[]);
        pass.set_bind_group(2, scene.geometry.group(), &[]);
        pass.set_bind_group(3, &sorted, &[]);
        pass.set_scissor_rect(0, band.first_row, width, band.rows);
        pass.draw(0..3, 0..1);
    }

    /// Encodes the shading of the further surfaces, those in coarse pixels left out.
    pub(super) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        t: &SampleTargets,
        targets: &Targets,
    ) {
        let Some(further) = &t.further else { return };
        let owners = targets
            .coarse
            .as_ref()
            .map_or(&t.tally_view, |c| &c.rate.owner.whole);
        let view = wgpu::BindingResource::TextureView;
        let group = bind_group(
            &recorder.gpu.device,
            "further shading",
            &self.shade_layout,
            &[
                t.queue.as_entire_binding(),
                t.entries.as_entire_binding(),
                t.sums.as_entire_binding(),
                view(&further.gbuffer.identity_view),
                view(&further.depth_view),
                view(owners),
            ],
        );
        let mut pass = recorder.compute_pass("edge shading");
        pass.set_pipeline(&self.shade);
        pass.set_bind_group(1, input, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups_indirect(&t.queue, ALL_GROUPS);
    }
}
