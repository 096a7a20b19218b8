//! The smooth composite: patches fitted to the samples, then one look-up per pixel.
//!
//! Passes per level, coarsest first: corners (`patch.wgsl`) and edge raises (`raise.wgsl`) of its tiles. Then
//! one pass per pixel (`smooth.wgsl`), and again for pixels whose tile holds several surfaces. What is
//! costly runs behind a stencil, since not all devices skip the branch that no pixel takes.

use crate::gpu::{Gpu, MipChain, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shading::{CoarseTargets, RADIANCE_FORMAT, STENCIL_FORMAT, stencil_state};
use crate::targets::Targets;
use crate::{Settings, shader};

/// Corner radiances of a tile's patch: four colours in three texels.
const CORNERS: usize = 3;
/// Raises of its left and its upper edge.
const RAISES: usize = 2;

/// The patches of all tiles of one frame size.
#[derive(Debug)]
pub(crate) struct PatchTargets {
    /// Levels 1 and up: a pixel needs no patch.
    corners: [MipChain; CORNERS],
    raises: [MipChain; RAISES],
    /// Marks tiles.
    stencil: MipChain,
    /// Marks the pixels of tiles with several surfaces: a single level, 0.
    pixel_stencil: MipChain,
    /// For each level from 1 on, the corners' levels above it; empty for the coarsest.
    above: Vec<Vec<wgpu::TextureView>>,
}

impl PatchTargets {
    /// Bytes of all chains.
    pub(crate) fn bytes(&self) -> u64 {
        let chains = self.corners.iter().chain(&self.raises);
        chains
            .chain([&self.stencil, &self.pixel_stencil])
            .map(MipChain::bytes)
            .sum()
    }

    /// `None` where all tiles are pixels.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let coarsest = u32::from(settings.coarsest_level);
        if coarsest == 0 {
            return None;
        }
        let size = (settings.width, settings.height);
        let sampled = wgpu::TextureUsages::TEXTURE_BINDING;
        let chain = |label| MipChain::new(gpu, label, size, 1..=coarsest, RADIANCE_FORMAT, sampled);
        let corners = ["corners 0", "corners 1", "corners 2"].map(chain);
        let above = (1..=coarsest)
            .map(|level| match level == coarsest {
                true => Vec::new(),
                false => corners.iter().map(|p| p.above(level)).collect(),
            })
            .collect();
        let none = wgpu::TextureUsages::empty();
        Some(Self {
            corners,
            raises: ["raises left", "raises upper"].map(chain),
            stencil: MipChain::new(
                gpu,
                "patch stencil",
                size,
                1..=coarsest,
                STENCIL_FORMAT,
                none,
            ),
            pixel_stencil: MipChain::new(gpu, "edge stencil", size, 0..=0, STENCIL_FORMAT, none),
            above,
        })
    }
}

fn marks(
    stencil: &wgpu::TextureView,
    load: wgpu::LoadOp<u32>,
) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    Some(wgpu::RenderPassDepthStencilAttachment {
        view: stencil,
        depth_ops: None,
        stencil_ops: Some(wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        }),
    })
}

/// Fits patches and reads them.
#[derive(Debug)]
pub(crate) struct SmoothComposite {
    mark: wgpu::RenderPipeline,
    fit: wgpu::RenderPipeline,
    raise: wgpu::RenderPipeline,
    read: wgpu::RenderPipeline,
    mark_edges: wgpu::RenderPipeline,
    read_edges: wgpu::RenderPipeline,
    cells_layout: wgpu::BindGroupLayout,
    fit_layout: wgpu::BindGroupLayout,
    read_layout: wgpu::BindGroupLayout,
}

impl SmoothComposite {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let cells = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let depth = sampled(wgpu::TextureSampleType::Depth);
        let layout = |label, types: &[_]| {
            bind_group_layout(&gpu.device, label, wgpu::ShaderStages::FRAGMENT, types)
        };
        let cells_layout = layout("patch marks", &[cells]);
        let fit_layout = layout(
            "patches",
            &[cells, float, cells, cells, depth, float, float, float],
        );
        let read_layout = layout(
            "smooth composite",
            &[
                cells, float, cells, cells, depth, float, float, float, float, float,
            ],
        );
        let color = |write_mask| {
            Some(wgpu::ColorTargetState {
                format: RADIANCE_FORMAT,
                blend: None,
                write_mask,
            })
        };
        let (written, kept) = (
            color(wgpu::ColorWrites::ALL),
            color(wgpu::ColorWrites::empty()),
        );
        let [always, marked] = [
            stencil_state(
                wgpu::CompareFunction::Always,
                wgpu::StencilOperation::Replace,
            ),
            stencil_state(wgpu::CompareFunction::Equal, wgpu::StencilOperation::Keep),
        ];
        let untouched = stencil_state(wgpu::CompareFunction::Always, wgpu::StencilOperation::Keep);
        let level = [("COARSEST", f64::from(settings.coarsest_level))];
        let pipeline = |module: &wgpu::ShaderModule,
                        entry,
                        group,
                        targets: &[_],
                        stencil: &wgpu::DepthStencilState,
                        constants: &[_]| {
            shader::level_screen(
                gpu,
                entry,
                module,
                entry,
                &[frame_layout, group],
                targets,
                Some(stencil.clone()),
                constants,
            )
        };
        let mark = shader::module(gpu, "patch marks", shader::COARSE_MARK);
        let fit = shader::module(gpu, "corners", shader::COMPOSITE_PATCH);
        let raise = shader::module(gpu, "raises", shader::COMPOSITE_RAISE);
        let smooth = shader::module(gpu, "smooth composite", shader::COMPOSITE_SMOOTH);
        let (three, two, one) = (
            [written.clone(), written.clone(), written.clone()],
            [written.clone(), written.clone()],
            [written],
        );
        Self {
            mark: pipeline(
                &mark,
                "mark",
                &cells_layout,
                &[kept.clone(), kept.clone(), kept.clone()],
                &always,
                &level,
            ),
            fit: pipeline(&fit, "fit_corners", &fit_layout, &three, &marked, &[]),
            raise: pipeline(&raise, "raise_edges", &fit_layout, &two, &marked, &[]),
            read: pipeline(
                &smooth,
                "smooth_composite",
                &read_layout,
                &one,
                &untouched,
                &[],
            ),
            mark_edges: pipeline(&smooth, "mark_edges", &read_layout, &[kept], &always, &[]),
            read_edges: pipeline(&smooth, "smooth_edges", &read_layout, &one, &marked, &[]),
            cells_layout,
            fit_layout,
            read_layout,
        }
    }

    /// Encodes the passes.
    pub(super) fn join(
        &self,
        recorder: &mut Recorder<'_>,
        targets: &Targets,
        from: &CoarseTargets,
        patches: &PatchTargets,
    ) {
        let gpu = recorder.gpu;
        let group = |layout: &wgpu::BindGroupLayout, rest: &[&wgpu::TextureView]| {
            let views: Vec<_> = [
                &from.rate.owner.whole,
                &from.samples.whole,
                &targets.gbuffer.surface_view,
                &targets.gbuffer.identity_view,
                &targets.gbuffer.depth_view,
            ]
            .iter()
            .chain(rest)
            .map(|view| wgpu::BindingResource::TextureView(view))
            .collect();
            bind_group(&gpu.device, "smooth composite", layout, &views)
        };
        let cells = bind_group(
            &gpu.device,
            "patch marks",
            &self.cells_layout,
            &[wgpu::BindingResource::TextureView(&from.rate.pyramid.whole)],
        );
        let [c0, c1, c2] = patches.corners.each_ref().map(|c| &c.whole);
        let corners = group(&self.fit_layout, &[c0, c1, c2]);
        let levels = patches.corners[0].range();
        for level in levels.clone().rev() {
            let above = match patches.above[level as usize - 1].as_slice() {
                [a, b, c] => group(&self.fit_layout, &[a, b, c]),
                // Nothing is coarser than the coarsest: any texture will do, none is read.
                _ => group(&self.fit_layout, &[&from.samples.whole; CORNERS]),
            };
            let into = patches
                .corners
                .each_ref()
                .map(|p| overwritten(p.level(level)));
            let marks = marks(patches.stencil.level(level), wgpu::LoadOp::Clear(0));
            let mut pass = recorder.render_pass("patches", &into, marks);
            pass.set_stencil_reference(1);
            pass.set_pipeline(&self.mark);
            pass.set_bind_group(1, &cells, &[]);
            patches.stencil.draw(&mut pass, level);
            pass.set_pipeline(&self.fit);
            pass.set_bind_group(1, &above, &[]);
            patches.stencil.draw(&mut pass, level);
        }
        for level in levels {
            let into = patches
                .raises
                .each_ref()
                .map(|p| overwritten(p.level(level)));
            let marks = marks(patches.stencil.level(level), wgpu::LoadOp::Load);
            let mut pass = recorder.render_pass("patches", &into, marks);
            pass.set_stencil_reference(1);
            pass.set_pipeline(&self.raise);
            pass.set_bind_group(1, &corners, &[]);
            patches.stencil.draw(&mut pass, level);
        }
        let [r0, r1] = patches.raises.each_ref().map(|r| &r.whole);
        let whole = group(&self.read_layout, &[c0, c1, c2, r0, r1]);
        let marks = marks(patches.pixel_stencil.level(0), wgpu::LoadOp::Clear(0));
        let into = [overwritten(&targets.radiance_view)];
        let mut pass = recorder.render_pass("composite", &into, marks);
        pass.set_stencil_reference(1);
        pass.set_bind_group(1, &whole, &[]);
        for pipeline in [&self.read, &self.mark_edges, &self.read_edges] {
            pass.set_pipeline(pipeline);
            patches.pixel_stencil.draw(&mut pass, 0);
        }
    }
}
