//! Anti-aliasing over a visibility buffer: only triangles are drawn at every sub-sample.
//!
//! Pixels that show several triangles are listed (`candidates.wgsl`) and their sub-samples sorted into surfaces
//! (`sort.wgsl`); one triangle per surface is kept: the largest surface's in the ordinary G-buffer (`classify.wgsl`),
//! the others' in a target of their own, row by row in the order of the queue's entries. Materials are evaluated for
//! those alone, so a pixel within a surface costs what it costs without anti-aliasing, where the other way evaluates
//! and averages all sub-samples.

use crate::geometry::{
    DEPTH_FORMAT, GBuffer, IDENTITY_FORMAT, SURFACE_FORMAT, TRIANGLE_FORMAT, VisibilityTargets,
    geometry_layout,
};
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, storage_read, storage_write, target, uniform,
};
use crate::recorder::{Recorder, drawn_over, overwritten};
use crate::scene::SceneOnGpu;
use crate::shader::Screen;
use crate::shading::lighting_constants;
use crate::targets::Targets;
use crate::{Antialiasing, EdgeTest, Geometry, SamplePattern, Settings, Shading, shader};

use super::pattern::{Band, Pattern};
use super::targets::{ALL_GROUPS, SampleTargets, TALLY_FORMAT};

/// Whether the settings ask for this way.
pub(crate) fn by_triangles(settings: &Settings) -> bool {
    settings.antialiasing.mode == Antialiasing::Msaa
        && settings.geometry.path == Geometry::Visibility
        && settings.antialiasing.edge_test == EdgeTest::Surface
        && settings.antialiasing.pattern == SamplePattern::Grid
}

/// Side of what a pixel's textures are filtered over, in pixels, where its material is evaluated once for n x n
/// sub-samples: n x n trilinear samples of 1 / n each, 1 / n apart, blur as much as one of this size. In variances: one of
/// size s has s^2 / 4 (a mip level's box and the filter's tent), their places (1 - 1 / n^2) / 12.
pub(crate) fn footprint(settings: &Settings) -> Option<f64> {
    let samples = f64::from(Pattern::of(settings).count());
    by_triangles(settings).then(|| ((1.0 + 2.0 / samples) / 3.0).sqrt())
}

/// A word per texel: bits of an entry's depth, a candidate, a pixel's largest surface.
const WORD: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// A texture that stands where one is asked for and none is looked at.
const NONE: (u32, u32) = (1, 1);

/// What the further surfaces of all pixels are evaluated in.
#[derive(Debug)]
pub(crate) struct FurtherTargets {
    /// Of entry i, row by row; without depth.
    pub(super) gbuffer: GBuffer,
    depth_view: wgpu::TextureView,
    /// Of one band: how many pixels show several triangles, which they are, and each one's largest surface.
    candidates: wgpu::Buffer,
    no_candidates: wgpu::Buffer,
    candidate_list_view: wgpu::TextureView,
    largest_view: wgpu::TextureView,
}

/// An indirect dispatch of nothing, and the number of candidates.
const NO_CANDIDATES: [u32; 4] = [0, 1, 1, 0];

/// Bytes of an entry in [`FurtherTargets`], the list of its pixels included.
const FURTHER_BYTES: u64 = 16 + 8 + 4 + 4 + 4;

impl FurtherTargets {
    /// Room for one further surface in every fourth pixel, more for a small picture: one of a detailed scene has one in
    /// every fifth. Where the room ends, a pixel shows its largest surface alone, until there is more.
    pub(super) fn usual_room(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height.div_ceil(4).max((2 * height).min(128)))
    }

    /// For a picture of this size, with room for at least so many entries, as far as the device's textures go.
    pub(super) fn new(gpu: &Gpu, width: u32, height: u32, room: u64) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let rows = room.div_ceil(width.into()).clamp(1, most.into()) as u32;
        let size = (width, rows);
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let none = wgpu::TextureUsages::empty();
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size_of_val(&NO_CANDIDATES) as u64,
                usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let no_candidates = buffer("no candidates", wgpu::BufferUsages::empty());
        gpu.queue
            .write_buffer(&no_candidates, 0, bytemuck::cast_slice(&NO_CANDIDATES));
        let triangles = target(gpu, "further triangles", size, TRIANGLE_FORMAT, written);
        let visibility = VisibilityTargets::new(gpu, size, 1).with_triangles(triangles);
        Self {
            gbuffer: GBuffer::of(
                target(gpu, "further surfaces", size, SURFACE_FORMAT, written),
                target(gpu, "further identity", size, IDENTITY_FORMAT, written),
                target(gpu, "no depth", NONE, DEPTH_FORMAT, none),
                Some(visibility),
            ),
            depth_view: target(gpu, "further depth", size, WORD, written),
            candidates: buffer(
                "candidates",
                wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT,
            ),
            no_candidates,
            candidate_list_view: target(gpu, "candidates", (width, height), WORD, written),
            largest_view: target(gpu, "largest surfaces", (width, height), WORD, written),
        }
    }

    /// Number of entries that there is room for.
    pub(super) fn entries(&self) -> u64 {
        let size = self.depth_view.texture().size();
        u64::from(size.width) * u64::from(size.height)
    }

    pub(super) fn bytes(&self) -> u64 {
        let size = self.largest_view.texture().size();
        let pixels = u64::from(size.width) * u64::from(size.height);
        self.entries() * FURTHER_BYTES + pixels * 8
    }
}

/// A band's sub-samples without surfaces.
pub(super) fn band_of_triangles(gpu: &Gpu, texels: (u32, u32)) -> GBuffer {
    let none = wgpu::TextureUsages::empty();
    let triangles = target(gpu, "triangles", texels, TRIANGLE_FORMAT, none);
    let visibility = VisibilityTargets::new(gpu, NONE, 1).with_triangles(triangles);
    GBuffer::of(
        target(gpu, "no surfaces", NONE, SURFACE_FORMAT, none),
        target(gpu, "G-buffer identity", texels, IDENTITY_FORMAT, none),
        target(gpu, "G-buffer depth", texels, DEPTH_FORMAT, none),
        Some(visibility),
    )
}

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
        let layout =
            |label, stage, types: &[_]| bind_group_layout(&gpu.device, label, stage, types);
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
        let [model, brute] = lighting_constants(settings);
        let [count, side] = Pattern::of(settings).constants();
        let coarse = f64::from(u8::from(settings.shading.mode == Shading::Coarse));
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
                &[model, brute, count, ("COARSE", coarse)],
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

    /// Encodes the sorting of a band's sub-samples, whose triangles are known: each pixel's largest surface into the
    /// ordinary G-buffer, the others into that of further surfaces.
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
