//! The passes that carry light from frame to frame.

use bytemuck::{Pod, Zeroable};

use super::lit::{Lit, ROUND};
use super::targets::{HistoryTargets, LIST_STEP, List, SEEN_FORMAT};
use crate::composite::LIGHT_FORMAT;
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write,
    written,
};

use crate::rate::RateTargets;
use crate::recorder::Recorder;
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::targets::Targets;
use crate::{Settings, shader};

/// Pixels a side that one workgroup looks at.
const TILE: u32 = 8;

/// Mirrors `History` in `layout.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct HistoryParameters {
    pub(crate) rounding: [f32; 2],
    pub(crate) phase: u32,
    pub(crate) reset: u32,
    pub(crate) renewal: f32,
    pub(crate) tolerance: f32,
    pub(crate) change: f32,
    pub(crate) changed_count: u32,
    pub(crate) changed: [[f32; 4]; 16],
}

/// A pipeline and the layout of its own bind group.
#[derive(Debug)]
struct Pass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// All passes.
#[derive(Debug)]
pub(super) struct HistoryPasses {
    keep: Pass,
    spread: Pass,
    reproject: Pass,
    size: Pass,
    shade: Pass,
    gather: Pass,
    scatter: Pass,
    rest: Pass,
    /// What the passes are told: read from storage, as branches hang on it (ARCHITECTURE.md).
    parameters: wgpu::Buffer,
}

impl HistoryPasses {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        input: &wgpu::BindGroupLayout,
    ) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let depth = sampled_layers(wgpu::TextureSampleType::Depth);
        let (read, write) = (storage_read(), storage_write());
        let light = written(LIGHT_FORMAT);
        let radiance = written(RADIANCE_FORMAT);
        let pass = |label, shader, entry, more: Option<&_>, types: &[_], constants: &[_]| {
            let layout = bind_group_layout(&gpu.device, label, wgpu::ShaderStages::COMPUTE, types);
            let mut groups = vec![frame];
            groups.extend(more);
            groups.push(&layout);
            Pass {
                pipeline: shader::compute(
                    gpu,
                    label,
                    &shader::module(gpu, label, shader),
                    entry,
                    &groups,
                    constants,
                ),
                layout,
            }
        };
        let tiles = [read, write, write, write];
        Self {
            keep: pass(
                "kept tiles",
                shader::SHADING_HISTORY_TILES,
                "keep",
                None,
                &tiles,
                &[],
            ),
            spread: pass(
                "tiles",
                shader::SHADING_HISTORY_TILES,
                "spread",
                None,
                &tiles,
                &[],
            ),
            reproject: pass(
                "reprojection of light",
                shader::SHADING_HISTORY_REPROJECT,
                "reproject",
                None,
                &[
                    uint,
                    words,
                    depth,
                    words,
                    read,
                    uint,
                    uint,
                    read,
                    light,
                    written(SEEN_FORMAT),
                    radiance,
                    write,
                    write,
                    write,
                    write,
                ],
                &[],
            ),
            size: pass(
                "list dispatches",
                shader::SHADING_HISTORY_SIZE,
                "size_lists",
                None,
                &[write, write],
                &[],
            ),
            shade: pass(
                "shading of samples",
                shader::SHADING_HISTORY_SHADE,
                "shade_samples",
                Some(input),
                &[read, read, light, radiance, write],
                &lighting_constants(gpu, settings),
            ),
            gather: pass(
                "gathering light",
                shader::SHADING_HISTORY_GATHER,
                "gather_light",
                None,
                &[
                    uint, words, depth, uint, radiance, write, read, write, light, read,
                ],
                &[],
            ),
            scatter: pass(
                "gathered light",
                shader::SHADING_HISTORY_SCATTER,
                "scatter",
                None,
                &[read, read, uint, light],
                &[],
            ),
            rest: pass(
                "pixels in turn",
                shader::SHADING_HISTORY_REST,
                "list_turn",
                None,
                &[read, depth, write, write],
                &[("ROUND", f64::from(ROUND))],
            ),
            parameters: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("history"),
                size: size_of::<HistoryParameters>() as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    /// Tells the passes of the frame at hand.
    pub(super) fn write(&self, gpu: &Gpu, parameters: &HistoryParameters) {
        gpu.queue
            .write_buffer(&self.parameters, 0, bytemuck::bytes_of(parameters));
    }
}

impl HistoryPasses {
    /// Encodes the frame's passes: lights `h.radiance`, and keeps what the next frame needs.
    pub(super) fn light(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        targets: &Targets,
        rate: &RateTargets,
        h: &HistoryTargets,
        lit: Lit,
    ) {
        recorder.encoder.clear_buffer(&h.listed, 0, None);
        if lit.turn.is_some_and(|turn| turn >= ROUND) {
            show(recorder, targets, h);
            return;
        }
        let gpu = recorder.gpu;
        let gbuffer = &targets.gbuffer;
        let view = wgpu::BindingResource::TextureView;
        let group = |pass: &Pass, label, resources: &[wgpu::BindingResource<'_>]| {
            bind_group(&gpu.device, label, &pass.layout, resources)
        };
        let [now, before] = match lit.even {
            true => [0, 1],
            false => [1, 0],
        };
        let size = h.radiance.texture().size();
        let (across, down) = (size.width.div_ceil(TILE), size.height.div_ceil(TILE));
        let listed = h.listed.as_entire_binding();
        let samples = h.samples.as_entire_binding();
        let bare = h.bare.as_entire_binding();
        let parameters = self.parameters.as_entire_binding();
        let tiles = [
            parameters.clone(),
            h.measured.as_entire_binding(),
            h.kept.as_entire_binding(),
            h.tiles.as_entire_binding(),
        ];
        let tiles = group(&self.keep, "tiles", &tiles);
        let reproject = group(
            &self.reproject,
            "reprojection of light",
            &[
                view(&rate.owner.whole),
                view(&gbuffer.surface_layers),
                view(&gbuffer.depth_layers),
                view(&gbuffer.identity_layers),
                parameters.clone(),
                view(&h.light[before]),
                view(&h.seen[before]),
                h.tiles.as_entire_binding(),
                view(&h.light[now]),
                view(&h.seen[now]),
                view(&h.radiance),
                listed.clone(),
                samples.clone(),
                bare.clone(),
                h.wanted.as_entire_binding(),
            ],
        );
        let sizing = group(
            &self.size,
            "list dispatches",
            &[listed.clone(), h.dispatches.as_entire_binding()],
        );
        let shade = [List::Samples, List::Unlit].map(|list| {
            group(
                &self.shade,
                "shading of samples",
                &[
                    h.dispatch(list),
                    samples.clone(),
                    view(&h.light[now]),
                    view(&h.radiance),
                    h.measured.as_entire_binding(),
                ],
            )
        });
        let gather = group(
            &self.gather,
            "gathering light",
            &[
                view(&rate.owner.whole),
                view(&gbuffer.surface_layers),
                view(&gbuffer.depth_layers),
                view(&h.light[now]),
                view(&h.radiance),
                listed.clone(),
                bare.clone(),
                samples.clone(),
                view(&h.light[before]),
                h.dispatch(List::Bare),
            ],
        );
        let scatter = group(
            &self.scatter,
            "gathered light",
            &[
                h.dispatch(List::Bare),
                bare,
                view(&h.light[before]),
                view(&h.light[now]),
            ],
        );
        let rest = group(
            &self.rest,
            "pixels in turn",
            &[parameters, view(&gbuffer.depth_layers), listed, samples],
        );
        let at = |list: List| list as u64 * LIST_STEP;
        if lit.turn.is_none() {
            recorder.encoder.clear_buffer(&h.wanted, 0, None);
            let mut pass = recorder.compute_pass("reprojection of light");
            let of_tiles = (across * down).div_ceil(64);
            pass.set_bind_group(1, &tiles, &[]);
            pass.set_pipeline(&self.keep.pipeline);
            pass.dispatch_workgroups(of_tiles, 1, 1);
            pass.set_pipeline(&self.spread.pipeline);
            pass.dispatch_workgroups(of_tiles, 1, 1);
            pass.set_pipeline(&self.reproject.pipeline);
            pass.set_bind_group(1, &reproject, &[]);
            pass.dispatch_workgroups(across, down, 1);
        } else {
            let mut pass = recorder.compute_pass("reprojection of light");
            pass.set_pipeline(&self.rest.pipeline);
            pass.set_bind_group(1, &rest, &[]);
            pass.dispatch_workgroups(across, down, 1);
        }
        recorder.encoder.clear_buffer(&h.measured, 0, None);
        {
            let mut pass = recorder.compute_pass("shading");
            pass.set_pipeline(&self.size.pipeline);
            pass.set_bind_group(1, &sizing, &[]);
            pass.dispatch_workgroups(1, 1, 1);
            pass.set_pipeline(&self.shade.pipeline);
            pass.set_bind_group(1, input, &[]);
            pass.set_bind_group(2, &shade[0], &[]);
            pass.dispatch_workgroups_indirect(&h.dispatches, at(List::Samples));
        }
        if lit.turn.is_none() {
            {
                let mut pass = recorder.compute_pass("composite");
                pass.set_pipeline(&self.gather.pipeline);
                pass.set_bind_group(1, &gather, &[]);
                pass.dispatch_workgroups_indirect(&h.dispatches, at(List::Bare));
                pass.set_pipeline(&self.scatter.pipeline);
                pass.set_bind_group(1, &scatter, &[]);
                pass.dispatch_workgroups_indirect(&h.dispatches, at(List::Bare));
                pass.set_pipeline(&self.size.pipeline);
                pass.set_bind_group(1, &sizing, &[]);
                pass.dispatch_workgroups(1, 1, 1);
            }
            let mut pass = recorder.compute_pass("shading");
            pass.set_pipeline(&self.shade.pipeline);
            pass.set_bind_group(1, input, &[]);
            pass.set_bind_group(2, &shade[1], &[]);
            pass.dispatch_workgroups_indirect(&h.dispatches, at(List::Unlit));
        }
        show(recorder, targets, h);
    }
}

/// Copies the radiance of solid surfaces to where blended ones are drawn over it.
fn show(recorder: &mut Recorder<'_>, targets: &Targets, h: &HistoryTargets) {
    let radiance = h.radiance.texture();
    recorder.encoder.copy_texture_to_texture(
        radiance.as_image_copy(),
        targets.radiance_view.texture().as_image_copy(),
        radiance.size(),
    );
}
