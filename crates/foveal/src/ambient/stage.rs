//! The passes of ambient occlusion.

use bytemuck::{Pod, Zeroable};

use super::drawn::DrawnPasses;
use super::targets::{AmbientTargets, FOUND_FORMAT, Listed, VISIBILITY_FORMAT};
use crate::geometry::GBuffer;
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write,
    uniform, written,
};
use crate::recorder::Recorder;
use crate::{AmbientOcclusion, EnvironmentSource, Settings, Shading, shader};

/// Pixels a side of a workgroup.
const TILE: u32 = 8;
/// Of the scene's diagonal: the radius where settings name none.
const PART_OF_SCENE: f32 = 0.1;
/// Of the height of an eye's picture: the largest radius on the screen.
const PART_OF_PICTURE: f32 = 0.25;

impl Settings {
    /// Whether ambient occlusion is asked for, and there is light that it can dim.
    pub(crate) fn occludes_ambient(&self) -> bool {
        let lighting = &self.lighting;
        lighting.ambient_occlusion == AmbientOcclusion::Screen
            && lighting.environment != EnvironmentSource::None
    }
}

/// How far occluders are looked for. Mirrors `AmbientOcclusion` in `horizons.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct OcclusionUniform {
    pub(crate) radius: f32,
    pub(crate) most_pixels: f32,
    pub(crate) padding: [f32; 2],
}

impl OcclusionUniform {
    /// In a scene whose diagonal has so many metres.
    pub(crate) fn new(settings: &Settings, diagonal_m: f32) -> Self {
        let asked = settings.lighting.ambient_occlusion_radius_m;
        let of_scene = PART_OF_SCENE * diagonal_m;
        let radius = if asked > 0.0 { asked } else { of_scene };
        Self {
            // A scene without extent, or without end, has none that makes sense.
            radius: if radius.is_finite() { radius } else { 0.0 }.max(1e-6),
            most_pixels: PART_OF_PICTURE * settings.picture.height as f32,
            padding: [0.0; 2],
        }
    }
}

/// Where a frame looks from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Reach<'a> {
    /// Every pixel.
    Every,
    /// Every pixel, of a view that does not change as long as this is asked for.
    EveryAtRest,
    /// The blocks of a rate map: owner levels of 2 x 2 pixels each.
    Blocks(&'a wgpu::TextureView),
}

#[derive(Debug)]
struct Pass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl Pass {
    fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        (label, shader, entry): (&str, shader::Shader, &str),
        types: &[wgpu::BindingType],
    ) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = bind_group_layout(gpu, label, compute, types);
        let module = shader::module(gpu, label, shader);
        let pipeline = shader::compute(gpu, label, &module, entry, &[frame, &layout], &[]);
        Self { pipeline, layout }
    }
}

/// Finds which part of the environment's light reaches what is seen.
#[derive(Debug)]
pub(crate) struct AmbientStage {
    uniform: wgpu::Buffer,
    means: Means,
}

#[derive(Debug)]
enum Means {
    Dispatched {
        every: Pass,
        resolve: Pass,
        coarse: Option<CoarsePasses>,
    },
    /// Of the reduced renderer.
    Drawn(DrawnPasses),
}

/// With coarse shading.
#[derive(Debug)]
struct CoarsePasses {
    mark: Pass,
    listed: Pass,
    resolve: Pass,
    size: wgpu::ComputePipeline,
    size_layout: wgpu::BindGroupLayout,
}

impl AmbientStage {
    /// The passes, where settings ask for them.
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        if !settings.occludes_ambient() {
            return None;
        }
        Some(Self {
            uniform: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("ambient occlusion"),
                size: size_of::<OcclusionUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            means: if gpu.is_reduced() {
                Means::Drawn(DrawnPasses::new(gpu, frame))
            } else {
                Means::dispatched(gpu, settings, frame)
            },
        })
    }

    /// Uploads how far occluders are looked for.
    pub(crate) fn write(&self, gpu: &Gpu, uniform: &OcclusionUniform) {
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniform));
    }

    /// Encodes the passes: finds the visibility of what the G-buffer's depth shows.
    pub(crate) fn find(
        &self,
        recorder: &mut Recorder<'_>,
        gbuffer: &GBuffer,
        to: &mut AmbientTargets,
        reach: Reach<'_>,
    ) {
        let rests = matches!(reach, Reach::EveryAtRest);
        if rests && to.rests {
            return;
        }
        to.rests = rests;
        // What is written may not be bound.
        let frame = recorder.frame.open_group(recorder.gpu);
        let (every, resolve, coarse) = match &self.means {
            Means::Dispatched {
                every,
                resolve,
                coarse,
            } => (every, resolve, coarse),
            Means::Drawn(passes) => {
                return passes.find(recorder, (&self.uniform, gbuffer), to, &frame);
            }
        };
        let by_blocks = match (reach, coarse, &to.listed) {
            (Reach::Blocks(owner), Some(coarse), Some(listed)) => Some((owner, coarse, listed)),
            _ => None,
        };
        let size = to.found.texture().size();
        let tiles = (size.width.div_ceil(TILE), size.height.div_ceil(TILE));
        let device = &recorder.gpu.device;
        let view = wgpu::BindingResource::TextureView;
        let inputs = [
            view(&gbuffer.depth_layers),
            self.uniform.as_entire_binding(),
        ];
        let group = |label, layout, rest: &[wgpu::BindingResource<'_>]| {
            let all = [&inputs[..], rest].concat();
            bind_group(device, label, layout, &all)
        };
        if let Some((owner, coarse, listed)) = by_blocks {
            coarse.find(
                recorder,
                (&self.uniform, gbuffer),
                to,
                (owner, listed),
                &frame,
                tiles,
            );
            let rest = [view(&to.found), view(&to.resolved), view(owner)];
            let resolving = group("ambient resolve", &coarse.resolve.layout, &rest);
            let mut pass = recorder.compute_pass("ambient resolve");
            pass.set_pipeline(&coarse.resolve.pipeline);
            pass.set_bind_group(0, &frame, &[]);
            pass.set_bind_group(1, &resolving, &[]);
            pass.dispatch_workgroups(tiles.0, tiles.1, 1);
            return;
        }
        let finding = group("ambient occlusion", &every.layout, &[view(&to.found)]);
        let rest = [view(&to.found), view(&to.resolved)];
        let resolving = group("ambient resolve", &resolve.layout, &rest);
        for (label, from, group) in [
            ("ambient occlusion", every, &finding),
            ("ambient resolve", resolve, &resolving),
        ] {
            let mut pass = recorder.compute_pass(label);
            pass.set_pipeline(&from.pipeline);
            pass.set_bind_group(0, &frame, &[]);
            pass.set_bind_group(1, group, &[]);
            pass.dispatch_workgroups(tiles.0, tiles.1, 1);
        }
    }
}

impl Means {
    fn dispatched(gpu: &Gpu, settings: &Settings, frame: &wgpu::BindGroupLayout) -> Self {
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let resolved = written(VISIBILITY_FORMAT);
        let every = ("ambient occlusion", shader::AMBIENT_EVERY, "find_every");
        let resolve = ("ambient resolve", shader::AMBIENT_RESOLVE, "resolve");
        let is_coarse = settings.shading.mode == Shading::Coarse;
        Self::Dispatched {
            every: Pass::new(
                gpu,
                frame,
                every,
                &[depth, uniform(), written(FOUND_FORMAT)],
            ),
            resolve: Pass::new(gpu, frame, resolve, &[depth, uniform(), float, resolved]),
            coarse: is_coarse.then(|| CoarsePasses::new(gpu, frame)),
        }
    }
}

impl CoarsePasses {
    fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout) -> Self {
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let levels = sampled(wgpu::TextureSampleType::Uint);
        let pass = |label: &'static str, shader, entry: &'static str, types: &[_]| {
            Pass::new(gpu, frame, (label, shader, entry), types)
        };
        let compute = wgpu::ShaderStages::COMPUTE;
        let sizes = [storage_read(), storage_write()];
        let size_layout = bind_group_layout(gpu, "ambient dispatch", compute, &sizes);
        let sizing = shader::SHADING_COARSE_DISPATCH;
        Self {
            mark: pass(
                "ambient places",
                shader::AMBIENT_MARK,
                "mark",
                &[depth, levels, storage_write(), storage_write()],
            ),
            listed: pass(
                "ambient occlusion",
                shader::AMBIENT_LISTED,
                "find_listed",
                &[
                    depth,
                    uniform(),
                    written(FOUND_FORMAT),
                    storage_read(),
                    storage_read(),
                ],
            ),
            resolve: pass(
                "ambient resolve",
                shader::AMBIENT_RESOLVE.variant(&["RATES"]),
                "resolve",
                &[depth, uniform(), float, written(VISIBILITY_FORMAT), levels],
            ),
            size: shader::compute(
                gpu,
                "ambient dispatch",
                &shader::module(gpu, "ambient dispatch", sizing),
                "size_dispatches",
                &[&size_layout],
                &[],
            ),
            size_layout,
        }
    }

    /// Encodes what looks around, once per block.
    fn find(
        &self,
        recorder: &mut Recorder<'_>,
        (uniform, gbuffer): (&wgpu::Buffer, &GBuffer),
        to: &AmbientTargets,
        (owner, listed): (&wgpu::TextureView, &Listed),
        frame: &wgpu::BindGroup,
        tiles: (u32, u32),
    ) {
        let device = &recorder.gpu.device;
        let view = wgpu::BindingResource::TextureView;
        let depth = view(&gbuffer.depth_layers);
        let (texels, counts) = (&listed.texels, &listed.counts);
        let dispatch = listed.dispatch.as_entire_binding();
        let marking = bind_group(
            device,
            "ambient places",
            &self.mark.layout,
            &[
                depth.clone(),
                view(owner),
                texels.as_entire_binding(),
                counts.as_entire_binding(),
            ],
        );
        let sizing = bind_group(
            device,
            "ambient dispatch",
            &self.size_layout,
            &[counts.as_entire_binding(), dispatch.clone()],
        );
        let finding = bind_group(
            device,
            "ambient occlusion",
            &self.listed.layout,
            &[
                depth,
                uniform.as_entire_binding(),
                view(&to.found),
                texels.as_entire_binding(),
                dispatch,
            ],
        );
        recorder.encoder.clear_buffer(counts, 0, None);
        let mut pass = recorder.compute_pass("ambient places");
        pass.set_pipeline(&self.mark.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &marking, &[]);
        pass.dispatch_workgroups(tiles.0, tiles.1, 1);
        pass.set_pipeline(&self.size);
        pass.set_bind_group(0, &sizing, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        drop(pass);
        let mut pass = recorder.compute_pass("ambient occlusion");
        pass.set_pipeline(&self.listed.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &finding, &[]);
        pass.dispatch_workgroups_indirect(&listed.dispatch, 0);
    }
}
