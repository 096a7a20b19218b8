//! Forward pass over the deferred picture: points and lines, opaque surfaces with lobes, shaded at each
//! pixel where the G-buffer shows them, then what is blended, back to front.

#[cfg(test)]
mod film_tests;
#[cfg(test)]
mod film_twin;
#[cfg(test)]
mod lobes_tests;
#[cfg(test)]
mod lobes_twin;
mod recipes;
#[cfg(test)]
mod strokes_among_others_tests;
#[cfg(test)]
pub(crate) mod strokes_tests;
mod targets;
mod transmission;
#[cfg(test)]
pub(crate) mod twin;

use std::collections::{BTreeMap, BTreeSet};

use recipes::{Kind, Recipes};
pub(crate) use targets::TransmissionTargets;
use transmission::BehindPass;

use crate::Settings;
use crate::geometry::{Batch, DrawList, Draws, PipelineKey, Pipelines, Window};
use crate::gpu::{Gpu, bind_group};
use crate::lights::SceneLights;
use crate::recorder::{Recorder, drawn_over, overwritten};
use crate::stereo::{EyeLayout, Submission};
use crate::targets::Targets;

/// Which way radiance is copied.
#[derive(Clone, Copy)]
enum Copied {
    ToLayers,
    Back,
}

/// What a pass draws.
#[derive(Clone, Copy)]
enum Content<'a> {
    /// Points, lines, opaque surfaces with lobes, and what is blended.
    Surfaces,
    /// The depth of opaque points and lines.
    StrokesDepth,
    /// What light passes, with the group of the picture behind.
    Transmissive(&'a wgpu::BindGroup),
}

/// What a pass draws to, and tests against.
struct ForwardTarget<'a> {
    color: Option<wgpu::RenderPassColorAttachment<'a>>,
    depth: &'a wgpu::TextureView,
    content: Content<'a>,
}

/// Draws points, lines, surfaces with lobes, blended ones, and what light passes.
#[derive(Debug)]
pub(crate) struct ForwardPass {
    recipes: Recipes,
    /// Made when first needed, as few scenes need all.
    pipelines: BTreeMap<Kind, Pipelines>,
    behind: Option<BehindPass>,
    submission: Submission,
    layout: EyeLayout,
}

impl ForwardPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        submission: Submission,
        frame_layouts: (&wgpu::BindGroupLayout, &wgpu::BindGroupLayout),
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        Self {
            recipes: Recipes::new(gpu, settings, submission, frame_layouts, material_layout),
            pipelines: BTreeMap::new(),
            behind: None,
            submission,
            layout: EyeLayout::of(settings),
        }
    }

    /// Takes over another size of the picture.
    pub(crate) fn resize(&mut self, settings: &Settings) {
        self.layout = EyeLayout::of(settings);
    }

    /// Makes the pipelines that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, list: &DrawList) {
        if !list.transmissive.is_empty() {
            let make = || BehindPass::new(gpu, &self.recipes.frame);
            self.behind.get_or_insert_with(make);
        }
        let blended = list
            .blended
            .iter()
            .map(|b| (Kind::of_blended(b.key), b.key));
        let lobed = list.lobed.iter().map(|b| (Kind::LobedOpaque, b.key));
        let strokes = list.strokes.iter().map(|b| (Kind::Strokes, b.key));
        let transmissive = list.transmissive.iter();
        let transmissive = transmissive.map(|b| (Kind::Transmissive, b.key));
        let before_glass = list.strokes.iter().filter(|_| self.draws_depth_of(list));
        let before_glass = before_glass.map(|b| (Kind::StrokesDepth, b.key));
        let needed: BTreeSet<_> = blended
            .chain(lobed)
            .chain(strokes)
            .chain(before_glass)
            .chain(transmissive)
            .collect();
        for (kind, key) in needed {
            let behind = self.behind.as_ref().map(|behind| &behind.layout);
            let make = || self.recipes.pipelines(gpu, kind, behind);
            let pipelines = self.pipelines.entry(kind).or_insert_with(make);
            pipelines.prepare(gpu, key);
        }
    }

    /// Whether points and lines are drawn to the depth against which glass is tested: with
    /// anti-aliasing only the sub-samples' depth has them.
    fn draws_depth_of(&self, list: &DrawList) -> bool {
        self.recipes.is_sampled && !list.strokes.is_empty() && !list.transmissive.is_empty()
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
            content: Content::Surfaces,
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
        let (Some(behind), Some(own)) = (&self.behind, &targets.transmission) else {
            return;
        };
        if draws.list.transmissive.is_empty() {
            return;
        }
        let behind = behind.draw(recorder, self.layout, targets, own);
        let (width, height) = self.layout.target_size();
        let whole = [Window::sized(width, height)];
        let depth = own.depth_view.as_ref();
        let depth = depth.unwrap_or(&targets.gbuffer.depth_view);
        if self.draws_depth_of(draws.list) {
            let target = ForwardTarget {
                color: None,
                depth,
                content: Content::StrokesDepth,
            };
            self.draw_windows(recorder, draws, lights, target, &whole);
        }
        let radiance = targets.radiance_layers.as_ref();
        let target = ForwardTarget {
            color: drawn_over(radiance.unwrap_or(&targets.radiance_view)),
            depth,
            content: Content::Transmissive(&behind),
        };
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
            content: Content::Surfaces,
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
            content,
        }: ForwardTarget<'_>,
        windows: &[Window],
    ) {
        let Draws { scene, list } = draws;
        let lights = bind_group(
            &recorder.gpu.device,
            "forward lights",
            &self.recipes.lights,
            &lights.resources(),
        );
        let writes_depth = !matches!(content, Content::Surfaces) || !list.strokes.is_empty();
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            // Read-only where nothing writes it. No later pass lights by it.
            depth_ops: writes_depth.then_some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let mask = self.submission.multiview_mask();
        let open = matches!(content, Content::Transmissive(_))
            .then(|| recorder.frame.open_group(recorder.gpu));
        let mut pass = recorder.layered_pass("forward", &[color], Some(depth), mask);
        pass.set_bind_group(2, &lights, &[]);
        if let Content::Transmissive(behind) = content {
            pass.set_bind_group(0, open.as_ref(), &[]);
            pass.set_bind_group(3, behind, &[]);
        }
        scene.geometry.bind(&mut pass);
        for &Window { frame, part } in windows {
            for &drawn in self.submission.drawn() {
                let window = self.layout.window_of(drawn, Window { frame, part });
                window.set(&mut pass);
                let mut issue = |batches: &[Batch], kind: fn(PipelineKey) -> Kind| {
                    let pipeline = |key| self.pipelines[&kind(key)].get(key);
                    DrawList::issue_with(batches, &mut pass, scene, pipeline, false, drawn);
                };
                match content {
                    Content::Surfaces => {
                        issue(&list.strokes, |_| Kind::Strokes);
                        issue(&list.lobed, |_| Kind::LobedOpaque);
                        issue(&list.blended, Kind::of_blended);
                    }
                    Content::StrokesDepth => issue(&list.strokes, |_| Kind::StrokesDepth),
                    Content::Transmissive(_) => issue(&list.transmissive, |_| Kind::Transmissive),
                }
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
