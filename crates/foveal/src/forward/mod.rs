//! Forward pass over the deferred picture: opaque surfaces with lobes, shaded at each pixel where the
//! G-buffer shows them, then blended surfaces, back to front.

#[cfg(test)]
mod lobes_twin;
#[cfg(test)]
pub(crate) mod twin;

use crate::geometry::{
    DrawList, Draws, PipelineKey, PipelineRecipe, Pipelines, VertexSource, Window,
};

use crate::gpu::{Gpu, bind_group, bind_group_layout};
use crate::lights::SceneLights;
use crate::recorder::{Recorder, drawn_over, overwritten};
use crate::scene::{LobeClass, lobes_layout};
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::stereo::{EyeLayout, Submission};
use crate::targets::Targets;
use crate::{Antialiasing, Settings, shader};

/// Which way radiance is copied.
#[derive(Clone, Copy)]
enum Copied {
    ToLayers,
    Back,
}

/// What blended surfaces are drawn to, and tested against.
struct ForwardTarget<'a> {
    color: Option<wgpu::RenderPassColorAttachment<'a>>,
    depth: &'a wgpu::TextureView,
}

/// Draws surfaces with lobes, and blended ones.
#[derive(Debug)]
pub(crate) struct ForwardPass {
    blended: Pipelines,
    /// Opaque and blended surfaces with lobes; `None` on devices that do not shade these.
    lobed: Option<[Pipelines; 2]>,
    submission: Submission,
    layout: EyeLayout,
    lights_layout: wgpu::BindGroupLayout,
}

impl ForwardPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        submission: Submission,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let lights_layout = bind_group_layout(
            &gpu.device,
            "forward lights",
            wgpu::ShaderStages::FRAGMENT,
            &SceneLights::binding_types(gpu),
        );
        let mut constants = lighting_constants(gpu, settings);
        constants.extend(submission.constants());
        let layered = submission == Submission::Multiview;
        constants.push(("LAYERED", f64::from(u8::from(layered))));
        let sampled = settings.antialiasing.mode != Antialiasing::None;
        constants.push(("SAMPLED", f64::from(u8::from(sampled))));
        let recipe = |lobes: bool, opaque: bool| {
            let shader = match (submission, lobes) {
                (_, true) if submission.clips() => {
                    shader::FORWARD_FORWARD.variant(&["LOBES", "CLIPPED"])
                }
                (Submission::Multiview, true) => {
                    shader::FORWARD_FORWARD.variant(&["LOBES", "LAYERED"])
                }
                (_, true) => shader::FORWARD_FORWARD.variant(&["LOBES"]),
                _ if submission.clips() => shader::FORWARD_FORWARD.variant(&["CLIPPED"]),
                (Submission::Multiview, _) => shader::FORWARD_FORWARD.variant(&["LAYERED"]),
                _ if gpu.is_reduced() => shader::FORWARD_FORWARD.variant(&["REDUCED"]),
                _ => shader::FORWARD_FORWARD,
            };
            let own_layout = lobes.then(|| lobes_layout(gpu));
            let material_layout = own_layout.as_ref().unwrap_or(material_layout);
            let mut constants = constants.clone();
            if lobes {
                constants.push(("OPAQUE", f64::from(u8::from(opaque))));
            }
            Pipelines::new(PipelineRecipe {
                label: "forward",
                module: shader::module(gpu, "forward", shader),
                layout: shader::pipeline_layout(
                    gpu,
                    "forward",
                    &[frame_layout, material_layout, &lights_layout],
                ),
                vertex: VertexSource::Buffers(submission.vertex_entry()),
                fragment: "fragment",
                targets: vec![Some(wgpu::ColorTargetState {
                    format: RADIANCE_FORMAT,
                    blend: (!opaque).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
                writes_depth: false,
                depth_compare: if opaque {
                    wgpu::CompareFunction::Equal
                } else {
                    wgpu::CompareFunction::Greater
                },
                constants,
                has_mask: false,
                multiview_mask: submission.multiview_mask(),
            })
        };
        let blended = recipe(false, false);
        let lobed = (!gpu.is_reduced()).then(|| [recipe(true, true), recipe(true, false)]);
        Self {
            blended,
            lobed,
            submission,
            layout: EyeLayout::of(settings),
            lights_layout,
        }
    }

    /// Takes over another size of the picture.
    pub(crate) fn resize(&mut self, settings: &Settings) {
        self.layout = EyeLayout::of(settings);
    }

    /// Makes the pipelines that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, list: &DrawList) {
        let prepare = |pipelines: &mut Pipelines, keys: &mut dyn Iterator<Item = PipelineKey>| {
            for key in keys.collect::<std::collections::BTreeSet<_>>() {
                pipelines.prepare(gpu, key);
            }
        };
        let has_lobes = |key: &PipelineKey| key.lobes != LobeClass::default();
        let keys = || list.blended.iter().map(|b| b.key);
        prepare(&mut self.blended, &mut keys().filter(|key| !has_lobes(key)));
        if let Some([opaque, blended]) = &mut self.lobed {
            prepare(opaque, &mut list.lobed.iter().map(|b| b.key));
            prepare(blended, &mut keys().filter(has_lobes));
        }
    }

    fn pipeline(&self, key: PipelineKey, opaque: bool) -> &wgpu::RenderPipeline {
        match &self.lobed {
            Some([lobed, _]) if opaque => lobed.get(key),
            Some([_, blended]) if key.lobes != LobeClass::default() => blended.get(key),
            _ => self.blended.get(key),
        }
    }

    /// Encodes the pass, unless it has nothing to draw.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        lights: SceneLights<'_>,
        targets: &Targets,
    ) {
        if !draws.list.has_forward() {
            return;
        }
        let radiance = targets.radiance_layers.as_ref();
        let target = ForwardTarget {
            color: drawn_over(radiance.unwrap_or(&targets.radiance_view)),
            depth: &targets.gbuffer.depth_view,
        };
        let (width, height) = self.layout.target_size();
        let whole = [Window::sized(width, height)];
        self.copy_radiance(recorder.encoder, targets, Copied::ToLayers);
        self.draw_windows(recorder, draws, lights, target, &whole);
        self.copy_radiance(recorder.encoder, targets, Copied::Back);
    }

    /// Encodes the pass over nothing, for the frame drawn once into each of `windows`: sub-samples,
    /// whose depth is known.
    pub(crate) fn draw_alone(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        lights: SceneLights<'_>,
        (color, depth): (&wgpu::TextureView, &wgpu::TextureView),
        windows: &[Window],
    ) {
        let color = overwritten(color);
        let target = ForwardTarget { color, depth };
        self.draw_windows(recorder, draws, lights, target, windows);
    }

    fn draw_windows(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        lights: SceneLights<'_>,
        ForwardTarget { color, depth }: ForwardTarget<'_>,
        windows: &[Window],
    ) {
        let Draws { scene, list } = draws;
        let lights = bind_group(
            &recorder.gpu.device,
            "forward lights",
            &self.lights_layout,
            &lights.resources(),
        );
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            // Read-only: it is sampled by other passes of the frame.
            depth_ops: None,
            stencil_ops: None,
        };
        let mask = self.submission.multiview_mask();
        let mut pass = recorder.layered_pass("forward", &[color], Some(depth), mask);
        pass.set_bind_group(2, &lights, &[]);
        scene.geometry.bind(&mut pass);
        for &Window { frame, part } in windows {
            for &drawn in self.submission.drawn() {
                let window = self.layout.window_of(drawn, Window { frame, part });
                window.set(&mut pass);
                let lobed = |key| self.pipeline(key, true);
                DrawList::issue_with(&list.lobed, &mut pass, scene, lobed, false, drawn);
                let blended = |key| self.pipeline(key, false);
                DrawList::issue_with(&list.blended, &mut pass, scene, blended, false, drawn);
            }
        }
    }

    /// Copies the eyes' radiance to their layers or back, where each eye is drawn to its own: every
    /// other stage has them side by side, and depth, which the pass tests against, in layers. Only
    /// frames with blended surfaces come here.
    fn copy_radiance(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, copied: Copied) {
        let Some(layers) = &targets.radiance_layers else {
            return;
        };
        for eye in 0..self.layout.eyes {
            let wide = place(&targets.radiance_view, [eye * self.layout.stride, 0]);
            let layer = place(layers, [0, eye]);
            let (from, to) = match copied {
                Copied::ToLayers => (wide, layer),
                Copied::Back => (layer, wide),
            };
            let size = wgpu::Extent3d {
                width: self.layout.width,
                height: self.layout.height,
                depth_or_array_layers: 1,
            };
            encoder.copy_texture_to_texture(from, to, size);
        }
    }
}

/// From a column and a layer on.
fn place(view: &wgpu::TextureView, [x, layer]: [u32; 2]) -> wgpu::TexelCopyTextureInfo<'_> {
    wgpu::TexelCopyTextureInfo {
        origin: wgpu::Origin3d { x, y: 0, z: layer },
        ..view.texture().as_image_copy()
    }
}
