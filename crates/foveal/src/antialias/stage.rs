//! One frame of anti-aliasing, band by band.

use crate::geometry::DrawList;
use crate::gpu::{Gpu, bind_group};
use crate::output::PICTURE_FORMAT;
use crate::recorder::{Recorder, drawn_over, overwritten};
use crate::scene::SceneOnGpu;
use crate::shading::ShadingPass;
use crate::targets::Targets;
use crate::{Antialiasing, DebugView, Settings, shader};

use super::blended::{BlendedStage, BlendedTargets};
use super::choice::by_triangles;
use super::pattern::{Band, Pattern};
use super::pipelines::{AntialiasPipelines, Edges};
use super::targets::{ALL_GROUPS, QueueUniform, SampleTargets};
use super::triangles::TriangleStage;

/// Where the queue holds the workgroups of a band.
const BAND_GROUPS: u64 = std::mem::offset_of!(QueueUniform, band_groups) as u64;

/// Lighting evaluations of a frame, and where they went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct EdgeStats {
    /// Pixels that were shaded more than once.
    pub(crate) edge_pixels: u64,
    /// Evaluations besides the ordinary path's.
    pub(crate) evaluations: u64,
    /// Entries that were wanted, whether there was room for them or not.
    pub(crate) entries: u64,
}

/// How a band's entries are shaded.
#[derive(Clone, Copy)]
pub(crate) struct Shadings<'a> {
    /// What shading reads of the sub-samples' G-buffer, where that holds surfaces.
    pub(crate) input: Option<&'a wgpu::BindGroup>,
    /// Whether the frame shades them: not where a debug view shows no light.
    pub(crate) shade: bool,
}

/// Fills the G-buffer from sub-samples, and shades what one evaluation per pixel leaves out.
#[derive(Debug)]
pub(crate) struct AntialiasStage {
    edges: Edges,
    pipelines: AntialiasPipelines,
    /// Over a visibility buffer.
    triangles: Option<TriangleStage>,
    blended: BlendedStage,
    /// Draws [`DebugView::Edges`] or [`DebugView::Samples`].
    view: Option<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>,
}

impl AntialiasStage {
    /// `None` where the settings ask for no anti-aliasing.
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        shading: &ShadingPass,
    ) -> Option<Self> {
        if settings.antialiasing.mode == Antialiasing::None {
            return None;
        }
        let number = match settings.picture.view {
            DebugView::Edges => Some(0.0),
            DebugView::Samples => Some(1.0),
            _ => None,
        };
        Some(Self {
            edges: Edges::of(settings),
            pipelines: AntialiasPipelines::new(gpu, settings, frame, shading.input_layout()),
            triangles: by_triangles(settings)
                .then(|| TriangleStage::new(gpu, settings, frame, shading.input_layout())),
            blended: BlendedStage::new(gpu, settings, frame),
            view: number.map(|number| view_pipeline(gpu, settings, frame, number)),
        })
    }

    /// Whether sub-samples' materials are resolved only once their triangles were sorted into
    /// surfaces.
    pub(crate) fn sorts_triangles(&self) -> bool {
        self.triangles.is_some()
    }

    /// Begins a frame, before its bands.
    pub(crate) fn begin(&self, recorder: &mut Recorder<'_>, t: &SampleTargets) {
        t.begin_frame(recorder.encoder);
        if self.triangles.is_some() {
            TriangleStage::begin(recorder, t);
        }
    }

    /// Encodes what averages a band's blended surfaces, drawn at the sub-samples.
    pub(crate) fn average(
        &self,
        recorder: &mut Recorder<'_>,
        blended: &BlendedTargets,
        (band, uniform): &(Band, wgpu::Buffer),
    ) {
        self.blended.average(recorder, blended, *band, uniform);
    }

    /// Encodes what becomes of a band's sub-samples once they are drawn: each pixel's largest
    /// surface goes to the ordinary G-buffer, the others to the queue; entries are shaded at once
    /// where their surfaces are known.
    pub(crate) fn merge(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        targets: &Targets,
        (band, uniform): &(Band, wgpu::Buffer),
        shading: Shadings<'_>,
    ) {
        let Some(t) = &targets.samples else { return };
        if let Some(triangles) = &self.triangles {
            return triangles.classify(recorder, scene, t, targets, (*band, uniform));
        }
        let Shadings { input, shade } = shading;
        let Some(input) = input else { return };
        t.begin_band(recorder.encoder);
        self.merge_surfaces(recorder, input, t, targets, (*band, uniform));
        if shade && self.edges != Edges::None {
            self.shade_entries(recorder, input, t, uniform);
        }
    }

    fn merge_surfaces(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        t: &SampleTargets,
        targets: &Targets,
        (band, uniform): (Band, &wgpu::Buffer),
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "merge",
            &self.pipelines.merge_layout,
            &[
                uniform.as_entire_binding(),
                wgpu::BindingResource::TextureView(&t.samples.identity_view),
                t.queue.as_entire_binding(),
                t.entries.as_entire_binding(),
            ],
        );
        let gbuffer = &targets.gbuffer;
        let colors = [&gbuffer.surface_view, &gbuffer.identity_view, &t.tally_view].map(drawn_over);
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &gbuffer.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let width = targets.picture_view.texture().width();
        let mut pass = recorder.render_pass("merge", &colors, Some(depth));
        pass.set_pipeline(&self.pipelines.merge);
        pass.set_bind_group(1, input, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.set_scissor_rect(0, band.first_row, width, band.rows);
        pass.draw(0..3, 0..1);
    }

    fn shade_entries(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        t: &SampleTargets,
        uniform: &wgpu::Buffer,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "edge shading",
            &self.pipelines.shade_layout,
            &[
                uniform.as_entire_binding(),
                wgpu::BindingResource::TextureView(&t.samples.identity_view),
                t.queue.as_entire_binding(),
                t.entries.as_entire_binding(),
                t.sums.as_entire_binding(),
            ],
        );
        let mut pass = recorder.compute_pass("edge shading");
        pass.set_pipeline(&self.pipelines.shade);
        pass.set_bind_group(1, input, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups_indirect(&t.queue, BAND_GROUPS);
    }

    /// Whether the ordinary path's radiance is seen anywhere: not where every sub-sample is shaded.
    pub(crate) fn needs_ordinary(&self) -> bool {
        self.edges != Edges::All
    }

    /// Joins the entries with the ordinary path's radiance, in the radiance target; `further` is
    /// what shading reads of the further surfaces' G-buffer.
    pub(crate) fn combine(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        further: Option<&wgpu::BindGroup>,
    ) {
        let Some(t) = &targets.samples else { return };
        if self.edges == Edges::None {
            return;
        }
        if let (Some(triangles), Some(further)) = (&self.triangles, further) {
            triangles.shade(recorder, further, t, targets);
        }
        let p = &self.pipelines;
        // Without a rate map it is not looked at.
        let owners = targets
            .coarse
            .as_ref()
            .map_or(&t.tally_view, |c| &c.rate.owner.whole);
        let bindings = [
            t.queue.as_entire_binding(),
            t.entries.as_entire_binding(),
            t.sums.as_entire_binding(),
            wgpu::BindingResource::TextureView(&targets.radiance_view),
            wgpu::BindingResource::TextureView(owners),
            t.number.as_entire_binding(),
        ];
        recorder.encoder.clear_buffer(&t.number, 0, None);
        let steps = [
            (&p.combine, &p.combine_layout, &bindings[..]),
            (&p.store, &p.store_layout, &bindings[..4]),
        ];
        for (pipeline, layout, bindings) in steps {
            let group = bind_group(&recorder.gpu.device, "combination", layout, bindings);
            let mut pass = recorder.compute_pass("combination");
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups_indirect(&t.queue, ALL_GROUPS);
        }
        if self.triangles.is_some() {
            // Surfaces in coarse pixels were not shaded.
            t.take_evaluations(recorder.encoder);
        }
    }

    /// Lays the blended surfaces that were drawn at the sub-samples over the picture's radiance.
    pub(crate) fn blend(&self, recorder: &mut Recorder<'_>, list: &DrawList, targets: &Targets) {
        let Some(t) = &targets.samples else { return };
        if let (Some(blended), Some((_, band)), false) =
            (&t.blended, t.bands.first(), !list.has_forward())
        {
            let radiance = &targets.radiance_view;
            self.blended.lay_over(recorder, blended, band, radiance);
        }
    }

    /// Draws the view of the tally that the settings ask for.
    pub(crate) fn show(&self, recorder: &mut Recorder<'_>, targets: &Targets) {
        let (Some((pipeline, layout)), Some(t)) = (&self.view, &targets.samples) else {
            return;
        };
        let tally = [wgpu::BindingResource::TextureView(&t.tally_view)];
        let group = bind_group(&recorder.gpu.device, "tally", layout, &tally);
        let target = [overwritten(&targets.picture_view)];
        let mut pass = recorder.render_pass("view", &target, None);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// What the frame of so many pixels shaded after which the targets' queue held these bytes.
    pub(crate) fn stats(&self, bytes: &[u8], targets: &Targets, pixels: u64) -> EdgeStats {
        let (Some(t), Ok(queue)) = (
            &targets.samples,
            bytemuck::try_pod_read_unaligned::<QueueUniform>(bytes),
        ) else {
            return EdgeStats::default();
        };
        EdgeStats {
            // Columns between the eyes' pictures may be listed, too.
            edge_pixels: u64::from(queue.edge_pixels).min(pixels),
            entries: u64::from(queue.total),
            // The device's own sum may have wrapped around.
            evaluations: match self.edges {
                Edges::All => pixels * u64::from(t.pattern.count()),
                _ => u64::from(queue.evaluations),
            },
        }
    }
}

fn view_pipeline(
    gpu: &Gpu,
    settings: &Settings,
    frame: &wgpu::BindGroupLayout,
    number: f64,
) -> (wgpu::RenderPipeline, wgpu::BindGroupLayout) {
    let uint = crate::gpu::sampled(wgpu::TextureSampleType::Uint);
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let layout = crate::gpu::bind_group_layout(gpu, "tally", fragment, &[uint]);
    let count = f64::from(Pattern::of(settings).count());
    let pipeline = shader::full_screen(
        gpu,
        "tally",
        &shader::module(gpu, "tally", shader::ANTIALIAS_VIEW),
        "view",
        &[frame, &layout],
        PICTURE_FORMAT,
        &[("VIEW", number), ("COUNT", count)],
    );
    (pipeline, layout)
}
