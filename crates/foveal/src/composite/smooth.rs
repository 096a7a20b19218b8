//! The smooth composite: patches fitted to the samples, then one look-up per pixel.

use crate::gpu::{Gpu, MipChain, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shading::{CoarseTargets, RADIANCE_FORMAT};
use crate::targets::Targets;
use crate::{Settings, shader};

/// Corner radiances of a tile's patch: four colours in three texels.
const PATCH_PARTS: usize = 3;

/// The patches of all tiles of one frame size.
#[derive(Debug)]
pub(crate) struct PatchTargets {
    /// Levels 1 and up: a pixel needs no patch.
    parts: [MipChain; PATCH_PARTS],
    /// For each level from 1 on, the parts' levels above it; empty for the coarsest.
    above: Vec<Vec<wgpu::TextureView>>,
}

impl PatchTargets {
    /// `None` where all tiles are pixels.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let coarsest = u32::from(settings.coarsest_level);
        if coarsest == 0 {
            return None;
        }
        let size = (settings.width, settings.height);
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let parts = ["patches 0", "patches 1", "patches 2"]
            .map(|label| MipChain::new(gpu, label, size, 1..=coarsest, RADIANCE_FORMAT, usage));
        let above = (1..=coarsest)
            .map(|level| match level == coarsest {
                true => Vec::new(),
                false => parts.iter().map(|p| p.above(level)).collect(),
            })
            .collect();
        Some(Self { parts, above })
    }
}

/// Fits patches and reads them.
#[derive(Debug)]
pub(crate) struct SmoothComposite {
    fit: wgpu::RenderPipeline,
    read: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl SmoothComposite {
    pub(crate) fn new(gpu: &Gpu, frame_layout: &wgpu::BindGroupLayout) -> Self {
        let cells = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let depth = sampled(wgpu::TextureSampleType::Depth);
        let layout = bind_group_layout(
            &gpu.device,
            "smooth composite",
            wgpu::ShaderStages::FRAGMENT,
            &[cells, float, cells, cells, depth, float, float, float],
        );
        let target = Some(wgpu::ColorTargetState::from(RADIANCE_FORMAT));
        let pipeline = |label, parts, entry, targets: &[_]| {
            shader::level_screen(
                gpu,
                label,
                &shader::module(gpu, label, parts),
                entry,
                &[frame_layout, &layout],
                targets,
                None,
                &[],
            )
        };
        Self {
            fit: pipeline(
                "patches",
                shader::COMPOSITE_PATCH,
                "fit_corners",
                &[target.clone(), target.clone(), target.clone()],
            ),
            read: pipeline(
                "smooth composite",
                shader::COMPOSITE_SMOOTH,
                "smooth_composite",
                &[target],
            ),
            layout,
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
        let group = |parts: [&wgpu::TextureView; PATCH_PARTS]| {
            let [a, b, c] = parts;
            bind_group(
                &gpu.device,
                "smooth composite",
                &self.layout,
                &[
                    &from.rate.owner.whole,
                    &from.samples.whole,
                    &targets.gbuffer.surface_view,
                    &targets.gbuffer.identity_view,
                    &targets.gbuffer.depth_view,
                    a,
                    b,
                    c,
                ]
                .map(wgpu::BindingResource::TextureView),
            )
        };
        for level in patches.parts[0].range().rev() {
            let above = match patches.above[level as usize - 1].as_slice() {
                [a, b, c] => group([a, b, c]),
                // Nothing is coarser than the coarsest: any texture will do, none is read.
                _ => group([&from.samples.whole; PATCH_PARTS]),
            };
            let into = patches
                .parts
                .each_ref()
                .map(|p| overwritten(p.level(level)));
            let mut pass = recorder.render_pass("patches", &into, None);
            pass.set_pipeline(&self.fit);
            pass.set_bind_group(1, &above, &[]);
            patches.parts[0].draw(&mut pass, level);
        }
        let whole = group(patches.parts.each_ref().map(|p| &p.whole));
        let into = [overwritten(&targets.radiance_view)];
        let mut pass = recorder.render_pass("composite", &into, None);
        pass.set_pipeline(&self.read);
        pass.set_bind_group(1, &whole, &[]);
        pass.draw(0..3, 0..1);
    }
}
