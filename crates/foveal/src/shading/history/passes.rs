//! The passes that carry light from frame to frame.

use bytemuck::{Pod, Zeroable};

use super::lit::{Lit, ROUND};
use super::targets::{HistoryTargets, List, SEEN_FORMAT, TILE_FORMAT};
use crate::composite::LIGHT_FORMAT;
use crate::environment::environment_constants;
use crate::gpu::{
    Gpu, Table, bind_group, bind_group_layout, sampled, sampled_layers, storage_read,
    storage_write, uniform, written,
};

use crate::every_pixel::{EveryPixel, Recipe};
use crate::rate::RateTargets;
use crate::recorder::Recorder;
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::shadow::Place;
use crate::targets::Targets;
use crate::{Settings, shader};

/// Pixels a side that one workgroup looks at.
const TILE: u32 = 8;

/// Mirrors `HistoryParameters` in `parameters.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct HistoryParameters {
    pub(crate) rounding: [f32; 2],
    pub(crate) phase: u32,
    pub(crate) reset: u32,
    pub(crate) renewal: f32,
    pub(crate) tolerance: f32,
    pub(crate) change: f32,
    pub(crate) whole_round: u32,
}

/// A pipeline and the layout of its own bind group.
#[derive(Debug)]
pub(super) struct Pass<P = wgpu::ComputePipeline> {
    pub(super) pipeline: P,
    layout: wgpu::BindGroupLayout,
}

/// The pass that writes what each pixel keeps.
fn reprojection(gpu: &Gpu, settings: &Settings, frame: &wgpu::BindGroupLayout) -> Pass<EveryPixel> {
    let label = "reprojection of light";
    let uint = sampled(wgpu::TextureSampleType::Uint);
    let words = sampled_layers(wgpu::TextureSampleType::Uint);
    let number = sampled(wgpu::TextureSampleType::Float { filterable: false });
    let layout = bind_group_layout(
        gpu,
        label,
        wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE,
        &[
            uint,
            words,
            sampled_layers(wgpu::TextureSampleType::Depth),
            words,
            uniform(),
            uint,
            uint,
            number,
            storage_write(),
            storage_write(),
            Table::binding_type(gpu),
        ],
    );
    let shader = shader::SHADING_HISTORY_REPROJECT;
    let pipeline = EveryPixel::new(
        gpu,
        settings,
        &Recipe {
            label,
            drawn: (shader, "reproject"),
            dispatched: (shader.variant(&["DISPATCHED"]), "reproject_all"),
            groups: &[frame, &layout],
            targets: &[LIGHT_FORMAT, SEEN_FORMAT, RADIANCE_FORMAT],
            constants: &environment_constants(settings),
        },
    );
    Pass { pipeline, layout }
}

/// All passes.
#[derive(Debug)]
pub(super) struct HistoryPasses {
    keep: Pass,
    spread: Pass,
    reproject: Pass<EveryPixel>,
    list: Pass,
    size: Pass,
    /// Of blocks, and of single pixels.
    shade: [Pass; 2],
    pub(super) gather: Pass,
    pub(super) follow: Pass,
    /// Of pixels that were gathered for, and of those that are led.
    pub(super) scatter: [Pass; 2],
    rest: Pass,
    /// A [`HistoryParameters`].
    parameters: wgpu::Buffer,
    /// Where changed lights reach, up to one of a negative radius.
    changed: Table,
    /// What `changed` holds.
    places: Vec<Place>,
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
        let number = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let light = written(LIGHT_FORMAT);
        let radiance = written(RADIANCE_FORMAT);
        let pass = |label, shader, entry, more: Option<&_>, types: &[_], constants: &[_]| {
            let layout = bind_group_layout(gpu, label, wgpu::ShaderStages::COMPUTE, types);
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
        let parameters = uniform();
        let tiles = [parameters, write, write, written(TILE_FORMAT)];
        let environment = environment_constants(settings);
        // Most samples are single pixels, and the others' pixels are shaded in turn: eight places cost
        // more than they show.
        let mut of_samples = lighting_constants(settings);
        of_samples.push(("BOTH_RIMS", 0.0));
        let shade = [false, true].map(|single| {
            let mut constants = of_samples.clone();
            constants.push(("SINGLE_PIXELS", f64::from(u8::from(single))));
            pass(
                "shading of samples",
                shader::SHADING_HISTORY_SHADE.variant(&["LIGHT"]),
                "shade_samples",
                Some(input),
                &[read, read, light, radiance, write],
                &constants,
            )
        });
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
            reproject: reprojection(gpu, settings, frame),
            list: pass(
                "lists of samples",
                shader::SHADING_HISTORY_LIST,
                "list_samples",
                None,
                &[read, read, number, write, write, write, write],
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
            shade,
            gather: pass(
                "gathering light",
                shader::SHADING_HISTORY_GATHER,
                "gather_light",
                None,
                &[
                    uint, words, depth, uint, radiance, write, read, write, light, read, write,
                    write,
                ],
                &environment,
            ),
            follow: pass(
                "led pixels",
                shader::COMPOSITE_FOLLOW.variant(&["KEPT"]),
                "follow",
                None,
                &[words, depth, uint, radiance, read, read, light],
                &[&environment[..], &[("LIST", List::Led.row())]].concat(),
            ),
            scatter: [false, true].map(|led| {
                pass(
                    "gathered light",
                    shader::SHADING_HISTORY_SCATTER,
                    "scatter",
                    None,
                    &[read, read, uint, light],
                    &[("FROM_LED", f64::from(u8::from(led)))],
                )
            }),
            rest: pass(
                "pixels in turn",
                shader::SHADING_HISTORY_REST,
                "list_turn",
                None,
                &[parameters, depth, write, write],
                &[("ROUND", f64::from(ROUND))],
            ),
            parameters: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("history"),
                size: size_of::<HistoryParameters>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            changed: Table::new(gpu, "changed lights"),
            places: Vec::new(),
        }
    }

    /// Uploads the frame's parameters and the places where light has changed.
    pub(super) fn write(&mut self, gpu: &Gpu, parameters: &HistoryParameters, changed: &[Place]) {
        gpu.queue
            .write_buffer(&self.parameters, 0, bytemuck::bytes_of(parameters));
        let end = [0.0, 0.0, 0.0, -1.0];
        self.places.clear();
        self.places.extend_from_slice(changed);
        self.places.push(end);
        self.changed.write(gpu, bytemuck::cast_slice(&self.places));
    }
}

/// What the passes of one frame read and write.
pub(super) struct Frame<'a> {
    gpu: &'a Gpu,
    /// The bind group of lights, materials and G-buffer that shading reads.
    input: &'a wgpu::BindGroup,
    pub(super) targets: &'a Targets,
    pub(super) rate: &'a RateTargets,
    pub(super) history: &'a HistoryTargets,
    /// The bind group of `size_lists`.
    sizes: wgpu::BindGroup,
    /// Which of the two textures of light, and of what is seen, this frame writes.
    pub(super) now: usize,
    /// Which holds the last frame's.
    pub(super) before: usize,
}

impl Frame<'_> {
    /// Tiles across and down.
    fn tiles(&self) -> (u32, u32) {
        let size = self.history.radiance.texture().size();
        (size.width.div_ceil(TILE), size.height.div_ceil(TILE))
    }

    pub(super) fn light(&self, which: usize) -> wgpu::BindingResource<'_> {
        view(&self.history.light[which])
    }

    pub(super) fn group<P>(
        &self,
        pass: &Pass<P>,
        label: &str,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        bind_group(&self.gpu.device, label, &pass.layout, resources)
    }
}

pub(super) fn view(view: &wgpu::TextureView) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(view)
}

impl HistoryPasses {
    /// Encodes the frame's passes: lights `history.radiance`, and keeps what the next frame needs.
    pub(super) fn light(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        targets: &Targets,
        (rate, history): (&RateTargets, &HistoryTargets),
        lit: Lit,
    ) {
        recorder.encoder.clear_buffer(&history.listed, 0, None);
        // Later turns find all at rest, and every pixel shaded.
        if lit.turn.is_none_or(|turn| turn < ROUND) {
            let (now, before) = if lit.even { (0, 1) } else { (1, 0) };
            let frame = Frame {
                gpu: recorder.gpu,
                input,
                targets,
                rate,
                history,
                sizes: self.sizes(recorder.gpu, history),
                now,
                before,
            };
            if lit.turn.is_some() {
                self.list_turn(recorder, &frame);
                self.shade_samples(recorder, &frame);
            } else {
                self.reproject(recorder, &frame);
                self.shade_samples(recorder, &frame);
                self.gather(recorder, &frame);
                self.shade_unlit(recorder, &frame);
                self.follow(recorder, &frame);
            }
        }
        history.show(recorder, &targets.radiance_view);
    }

    fn sizes(&self, gpu: &Gpu, history: &HistoryTargets) -> wgpu::BindGroup {
        let lists = [&history.listed, &history.dispatches];
        let resources = lists.map(wgpu::Buffer::as_entire_binding);
        bind_group(
            &gpu.device,
            "list dispatches",
            &self.size.layout,
            &resources,
        )
    }

    /// At rest: lists the pixels whose turn it is.
    fn list_turn(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let h = frame.history;
        let rest = frame.group(
            &self.rest,
            "pixels in turn",
            &[
                self.parameters.as_entire_binding(),
                view(&frame.targets.gbuffer.depth_layers),
                h.listed.as_entire_binding(),
                h.samples.as_entire_binding(),
            ],
        );
        let (across, down) = frame.tiles();
        let mut pass = recorder.compute_pass("reprojection of light");
        pass.set_pipeline(&self.rest.pipeline);
        pass.set_bind_group(1, &rest, &[]);
        pass.dispatch_workgroups(across, down, 1);
    }

    /// Takes over last frame's light where the same surface is seen, and lists the samples to
    /// shade and the pixels that hold no light.
    fn reproject(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (h, gbuffer) = (frame.history, &frame.targets.gbuffer);
        recorder.encoder.clear_buffer(&h.wanted, 0, None);
        let tiles = frame.group(
            &self.keep,
            "tiles",
            &[
                self.parameters.as_entire_binding(),
                h.measured.as_entire_binding(),
                h.kept.as_entire_binding(),
                view(&h.tiles),
            ],
        );
        let reproject = frame.group(
            &self.reproject,
            "reprojection of light",
            &[
                view(&frame.rate.owner.whole),
                view(&gbuffer.surface_layers),
                view(&gbuffer.depth_layers),
                view(&gbuffer.identity_layers),
                self.parameters.as_entire_binding(),
                frame.light(frame.before),
                view(&h.seen[frame.before]),
                view(&h.tiles),
                h.listed.as_entire_binding(),
                h.chosen.as_entire_binding(),
                self.changed.resource(),
            ],
        );
        let list = frame.group(
            &self.list,
            "lists of samples",
            &[
                h.dispatch(List::Chosen),
                h.chosen.as_entire_binding(),
                view(&h.radiance),
                h.listed.as_entire_binding(),
                h.samples.as_entire_binding(),
                h.bare.as_entire_binding(),
                h.wanted.as_entire_binding(),
            ],
        );
        let (across, down) = frame.tiles();
        let of_tiles = (across * down).div_ceil(64);
        let mut pass = recorder.compute_pass("reprojection of light");
        pass.set_bind_group(1, &tiles, &[]);
        pass.set_pipeline(&self.keep.pipeline);
        pass.dispatch_workgroups(of_tiles, 1, 1);
        pass.set_pipeline(&self.spread.pipeline);
        pass.dispatch_workgroups(of_tiles, 1, 1);
        drop(pass);
        let written = [&h.light[frame.now], &h.seen[frame.now], &h.radiance];
        let pass = &self.reproject.pipeline;
        pass.run(recorder, "reprojection of light", &[&reproject], &written);
        let mut pass = recorder.compute_pass("reprojection of light");
        self.size_lists(&mut pass, frame);
        pass.set_pipeline(&self.list.pipeline);
        pass.set_bind_group(1, &list, &[]);
        pass.dispatch_workgroups_indirect(&h.dispatches, List::Chosen.offset());
    }

    /// Shades the listed samples, and measures how much their light changed.
    fn shade_samples(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        recorder
            .encoder
            .clear_buffer(&frame.history.measured, 0, None);
        let mut pass = recorder.compute_pass("shading");
        self.size_lists(&mut pass, frame);
        self.shade(&mut pass, frame, List::Single);
        self.shade(&mut pass, frame, List::Samples);
    }

    /// Shades the pixels of a list.
    pub(super) fn shade(&self, pass: &mut wgpu::ComputePass<'_>, frame: &Frame<'_>, list: List) {
        let h = frame.history;
        let [blocks, single] = &self.shade;
        let by = match list {
            List::Samples => blocks,
            _ => single,
        };
        let shade = frame.group(
            by,
            "shading of samples",
            &[
                h.dispatch(list),
                h.samples.as_entire_binding(),
                frame.light(frame.now),
                view(&h.radiance),
                h.measured.as_entire_binding(),
            ],
        );
        pass.set_pipeline(&by.pipeline);
        pass.set_bind_group(1, frame.input, &[]);
        pass.set_bind_group(2, &shade, &[]);
        pass.dispatch_workgroups_indirect(&h.dispatches, list.offset());
    }

    /// Turns the lengths of lists into sizes of dispatches.
    pub(super) fn size_lists(&self, pass: &mut wgpu::ComputePass<'_>, frame: &Frame<'_>) {
        pass.set_pipeline(&self.size.pipeline);
        pass.set_bind_group(1, &frame.sizes, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
}
