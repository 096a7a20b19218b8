//! Forward pass over the deferred picture: opaque surfaces with lobes, shaded at each pixel where the
//! G-buffer shows them, then blended surfaces, back to front.

#[cfg(test)]
mod lobes_tests;
#[cfg(test)]
mod lobes_twin;
mod transmission;
#[cfg(test)]
pub(crate) mod twin;

use transmission::BehindPass;
pub(crate) use transmission::TransmissionTargets;

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
    /// With what light passes, which writes depth, the group of the picture behind; else opaque
    /// surfaces with lobes are drawn, and blended ones.
    behind: Option<&'a wgpu::BindGroup>,
}

/// What a pipeline of the pass draws.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Blended,
    LobedOpaque,
    LobedBlended,
    Transmissive,
}

impl Kind {
    fn variant(self, gpu: &Gpu, submission: Submission) -> &'static [&'static str] {
        match (self, submission) {
            (Self::Blended, _) if submission.clips() => &["CLIPPED"],
            (Self::Blended, Submission::Multiview) => &["LAYERED"],
            (Self::Blended, _) if gpu.is_reduced() => &["REDUCED"],
            (Self::Blended, _) => &[],
            (Self::Transmissive, _) if submission.clips() => &["LOBES", "TRANSMISSION", "CLIPPED"],
            (Self::Transmissive, Submission::Multiview) => &["LOBES", "TRANSMISSION", "LAYERED"],
            (Self::Transmissive, _) => &["LOBES", "TRANSMISSION"],
            _ if submission.clips() => &["LOBES", "CLIPPED"],
            (_, Submission::Multiview) => &["LOBES", "LAYERED"],
            _ => &["LOBES"],
        }
    }
}

/// Draws surfaces with lobes, and blended ones.
#[derive(Debug)]
pub(crate) struct ForwardPass {
    blended: Pipelines,
    /// Opaque and blended surfaces with lobes; `None` on devices that do not shade these.
    lobed: Option<[Pipelines; 2]>,
    /// Surfaces that light passes.
    transmissive: Option<(Pipelines, BehindPass)>,
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
        let behind = (!gpu.is_reduced()).then(|| BehindPass::new(gpu, frame_layout));
        let recipe = |kind: Kind| {
            let shader = shader::FORWARD_FORWARD.variant(kind.variant(gpu, submission));
            let own_layout = (kind != Kind::Blended).then(|| lobes_layout(gpu));
            let material_layout = own_layout.as_ref().unwrap_or(material_layout);
            let mut layouts = vec![frame_layout, material_layout, &lights_layout];
            let mut constants = constants.clone();
            let opaque = matches!(kind, Kind::LobedOpaque | Kind::Transmissive);
            if kind != Kind::Blended {
                constants.push(("OPAQUE", f64::from(u8::from(opaque))));
            }
            let transmissive = kind == Kind::Transmissive;
            if transmissive {
                layouts.extend(behind.as_ref().map(|behind| &behind.layout));
                // Drawn to the picture's own texels.
                constants.retain(|(name, _)| *name != "SAMPLED");
            }
            Pipelines::new(PipelineRecipe {
                label: "forward",
                module: shader::module(gpu, "forward", shader),
                layout: shader::pipeline_layout(gpu, "forward", &layouts),
                vertex: VertexSource::Buffers(submission.vertex_entry()),
                fragment: "fragment",
                targets: vec![Some(wgpu::ColorTargetState {
                    format: RADIANCE_FORMAT,
                    blend: (!opaque).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
                writes_depth: transmissive,
                depth_compare: if kind == Kind::LobedOpaque {
                    wgpu::CompareFunction::Equal
                } else {
                    wgpu::CompareFunction::Greater
                },
                constants,
                has_mask: transmissive,
                multiview_mask: submission.multiview_mask(),
            })
        };
        let blended = recipe(Kind::Blended);
        let lobed =
            (!gpu.is_reduced()).then(|| [recipe(Kind::LobedOpaque), recipe(Kind::LobedBlended)]);
        let transmissive = (!gpu.is_reduced()).then(|| recipe(Kind::Transmissive));
        let transmissive = transmissive.zip(behind);
        Self {
            blended,
            lobed,
            transmissive,
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
        if let Some((pipelines, _)) = &mut self.transmissive {
            prepare(pipelines, &mut list.transmissive.iter().map(|b| b.key));
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
            behind: None,
        };
        let (width, height) = self.layout.target_size();
        let whole = [Window::sized(width, height)];
        self.copy_radiance(recorder.encoder, targets, Copied::ToLayers);
        self.draw_windows(recorder, draws, lights, target, &whole);
        self.copy_radiance(recorder.encoder, targets, Copied::Back);
    }

    /// Encodes the pass of what light passes, over everything else, unless nothing is such.
    pub(crate) fn draw_transmissive(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        lights: SceneLights<'_>,
        targets: &Targets,
    ) {
        let (Some((_, behind)), Some(own)) = (&self.transmissive, &targets.transmission) else {
            return;
        };
        if draws.list.transmissive.is_empty() {
            return;
        }
        let behind = behind.draw(recorder, targets, own);
        let radiance = targets.radiance_layers.as_ref();
        let target = ForwardTarget {
            color: drawn_over(radiance.unwrap_or(&targets.radiance_view)),
            depth: &own.depth_view,
            behind: Some(&behind),
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
        let target = ForwardTarget {
            color,
            depth,
            behind: None,
        };
        self.draw_windows(recorder, draws, lights, target, windows);
    }

    fn draw_windows(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        lights: SceneLights<'_>,
        ForwardTarget {
            color,
            depth,
            behind,
        }: ForwardTarget<'_>,
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
            // The G-buffer's is read-only: it is sampled by other passes of the frame.
            depth_ops: behind.map(|_| wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let mask = self.submission.multiview_mask();
        let mut pass = recorder.layered_pass("forward", &[color], Some(depth), mask);
        pass.set_bind_group(2, &lights, &[]);
        if let Some(behind) = behind {
            pass.set_bind_group(3, behind, &[]);
        }
        scene.geometry.bind(&mut pass);
        for &Window { frame, part } in windows {
            for &drawn in self.submission.drawn() {
                let window = self.layout.window_of(drawn, Window { frame, part });
                window.set(&mut pass);
                if let (Some(_), Some((pipelines, _))) = (behind, &self.transmissive) {
                    DrawList::issue(&list.transmissive, &mut pass, scene, pipelines, drawn);
                    continue;
                }
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
