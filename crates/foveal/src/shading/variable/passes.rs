//! The passes that find rates and samples, and the one that lights samples.

use super::targets::looks_around;
use bytemuck::{Pod, Zeroable};

use super::VariableTargets;
use super::probes::Probe;
use super::targets::{KNOWN_FORMAT, MASK_FORMAT};
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write,
    uniform,
};

use crate::rate::RequestUniform;
use crate::recorder::Recorder;
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::stereo::Eye;
use crate::targets::Targets;
use crate::{Contrast, RateCombine, RateSource, Settings, shader};

/// Quads a side that one workgroup looks at.
const TILE: u32 = 8;

/// Mirrors `Rates` in `passes.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct RatesUniform {
    pub(crate) threshold: f32,
    pub(crate) velocity_gain: f32,
    pub(crate) probe_mask: u32,
    pub(crate) probe_x: u32,
    pub(crate) probe_y: u32,
    pub(crate) reset: u32,
    pub(crate) reserved_0: u32,
    pub(crate) reserved_1: u32,
}

/// Finds rates and samples, and lights samples.
#[derive(Debug)]
pub(crate) struct RatePasses {
    /// A pass of its own where contrast is looked for beyond the quad; else the mask's reprojects
    /// too.
    reproject: Option<wgpu::ComputePipeline>,
    find: wgpu::ComputePipeline,
    find_layout: wgpu::BindGroupLayout,
    size: wgpu::ComputePipeline,
    size_layout: wgpu::BindGroupLayout,
    shade: wgpu::ComputePipeline,
    shade_layout: wgpu::BindGroupLayout,
    rates: wgpu::Buffer,
    request: wgpu::Buffer,
}

const fn written(format: wgpu::TextureFormat) -> wgpu::BindingType {
    wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    }
}

/// What differs from frame to frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct RateFrame {
    /// Which of the targets are this frame's.
    pub(super) even: bool,
    /// Nothing is known of the frame before.
    pub(super) reset: bool,
    pub(super) probe: Probe,
}

impl RatePasses {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        input: &wgpu::BindGroupLayout,
    ) -> Self {
        let layout =
            |label, types: &[_]| bind_group_layout(gpu, label, wgpu::ShaderStages::COMPUTE, types);
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let (read, write) = (storage_read(), storage_write());
        let known = written(KNOWN_FORMAT);
        let mask = written(MASK_FORMAT);
        let radiance = written(RADIANCE_FORMAT);
        let find_layout = layout(
            "rate mask",
            &[
                uniform(),
                uniform(),
                words,
                depth,
                uint,
                float,
                uint,
                known,
                mask,
                write,
                write,
            ],
        );
        let size_layout = layout("rate dispatch", &[write]);
        let shade_layout = layout("rate samples", &[read, read, radiance]);
        let pipeline =
            |label, shader, entry, groups: &[&wgpu::BindGroupLayout], constants: &[_]| {
                let module = shader::module(gpu, label, shader);
                shader::compute(gpu, label, &module, entry, groups, constants)
            };
        let buffer = |label, size: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let lighting = lighting_constants(settings);
        let one_surface = f64::from(u8::from(settings.stage().has_material()));
        Self {
            reproject: looks_around(settings).then(|| {
                pipeline(
                    "reprojection",
                    shader::SHADING_VARIABLE_MASK,
                    "reproject",
                    &[frame, &find_layout],
                    &[],
                )
            }),
            find: pipeline(
                "rate mask",
                shader::SHADING_VARIABLE_MASK,
                "find_rates",
                &[frame, &find_layout],
                &find_constants(settings),
            ),
            size: pipeline(
                "rate dispatch",
                shader::SHADING_VARIABLE_SIZE,
                "size_list",
                &[&size_layout],
                &[],
            ),
            shade: pipeline(
                "rate samples",
                shader::SHADING_VARIABLE_SHADE,
                "shade_samples",
                &[frame, input, &shade_layout],
                &[&lighting[..], &[("ONE_SURFACE", one_surface)]].concat(),
            ),
            find_layout,
            size_layout,
            shade_layout,
            rates: buffer("rates", size_of::<RatesUniform>()),
            request: buffer("requested levels", size_of::<RequestUniform>()),
        }
    }

    /// Encodes reprojection from the frame before, into what is known in `even` or odd frames, and
    /// from it the rates and samples; one pass does it all unless contrast is looked for beyond the
    /// quad.
    pub(super) fn find_rates(
        &self,
        recorder: &mut Recorder<'_>,
        settings: &Settings,
        targets: &Targets,
        (t, eyes): (&VariableTargets, &[Eye; 2]),
        turn: RateFrame,
    ) {
        let RateFrame { even, reset, probe } = turn;
        let gpu = recorder.gpu;
        let rates = RatesUniform {
            threshold: settings.variable.threshold,
            velocity_gain: settings.variable.velocity_gain,
            probe_mask: probe.mask,
            probe_x: probe.class[0],
            probe_y: probe.class[1],
            reset: u32::from(reset),
            reserved_0: 0,
            reserved_1: 0,
        };
        gpu.queue
            .write_buffer(&self.rates, 0, bytemuck::bytes_of(&rates));
        let request = RequestUniform::new(settings, eyes, None);
        gpu.queue
            .write_buffer(&self.request, 0, bytemuck::bytes_of(&request));
        let [now, before] = [usize::from(!even), usize::from(even)].map(|i| &t.known[i]);
        let gbuffer = &targets.gbuffer;
        let finished = t.finished.as_ref().unwrap_or(&targets.picture_view);
        let view = wgpu::BindingResource::TextureView;
        let group = |label, reprojected, written| {
            let resources = [
                self.request.as_entire_binding(),
                self.rates.as_entire_binding(),
                view(&gbuffer.identity_layers),
                view(&gbuffer.depth_layers),
                view(before),
                view(finished),
                view(reprojected),
                view(written),
                view(&t.mask),
                t.listed.as_entire_binding(),
                t.samples.as_entire_binding(),
            ];
            bind_group(&gpu.device, label, &self.find_layout, &resources)
        };
        let quads = t.mask.texture().size();
        let tiles = [quads.width.div_ceil(TILE), quads.height.div_ceil(TILE)];
        recorder.encoder.clear_buffer(&t.listed, 0, None);
        if let (Some(reproject), Some(reprojected)) = (&self.reproject, &t.reprojected) {
            let group = group("reprojection", before, reprojected);
            let mut pass = recorder.compute_pass("reprojection");
            pass.set_pipeline(reproject);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups(tiles[0], tiles[1], 1);
        }
        let find = group("rate mask", t.reprojected.as_ref().unwrap_or(before), now);
        let listed = [t.listed.as_entire_binding()];
        let size = bind_group(&gpu.device, "rate dispatch", &self.size_layout, &listed);
        let mut pass = recorder.compute_pass("rate mask");
        pass.set_pipeline(&self.find);
        pass.set_bind_group(1, &find, &[]);
        pass.dispatch_workgroups(tiles[0], tiles[1], 1);
        pass.set_pipeline(&self.size);
        pass.set_bind_group(0, &size, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Encodes lighting of the samples into `radiance`.
    pub(super) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        t: &VariableTargets,
        radiance: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "rate samples",
            &self.shade_layout,
            &[
                t.samples.as_entire_binding(),
                t.listed.as_entire_binding(),
                wgpu::BindingResource::TextureView(radiance),
            ],
        );
        let mut pass = recorder.compute_pass("shading");
        pass.set_pipeline(&self.shade);
        pass.set_bind_group(1, input, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups_indirect(&t.listed, 0);
    }
}

fn find_constants(s: &Settings) -> [(&'static str, f64); 6] {
    let source = |source| match source {
        RateSource::Foveated => 0.0,
        RateSource::Constant => 1.0,
        // Image and lens are refused by the settings' check.
        RateSource::Image | RateSource::Lens | RateSource::Content => 3.0,
        RateSource::Radii => 4.0,
    };
    let combine = match s.coarse.combine {
        RateCombine::First => 0.0,
        RateCombine::Coarser => 1.0,
        RateCombine::Finer => 2.0,
    };
    let contrast = match s.variable.contrast {
        Contrast::Quad => 0.0,
        Contrast::Neighbors => 1.0,
        Contrast::Sobel => 2.0,
    };
    [
        ("SOURCE", source(s.coarse.source)),
        ("OTHER", source(s.coarse.other_source)),
        ("COMBINE", combine),
        ("CONTRAST", contrast),
        ("BLOCKS", f64::from(u8::from(s.variable.blocks_4x4))),
        ("LOOKS_AROUND", f64::from(u8::from(looks_around(s)))),
    ]
}
