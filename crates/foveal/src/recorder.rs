//! What a stage records its passes with.

use std::num::NonZeroU32;

use crate::gpu::{Gpu, GpuTimer};
use crate::scene::FrameBindings;

/// A frame's command encoder with what every pass needs: the timers and bind group 0.
pub(crate) struct Recorder<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) encoder: &'a mut wgpu::CommandEncoder,
    pub(crate) timer: &'a mut GpuTimer,
    pub(crate) frame: &'a FrameBindings,
}

impl Recorder<'_> {
    /// Begins a render pass that is timed under `label`; bind group 0 is set.
    pub(crate) fn render_pass(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) -> wgpu::RenderPass<'_> {
        self.layered_pass(label, colors, depth_stencil, None)
    }

    /// As [`Recorder::render_pass`], drawing to the layers of a mask at once.
    pub(crate) fn layered_pass(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        multiview_mask: Option<NonZeroU32>,
    ) -> wgpu::RenderPass<'_> {
        let mut pass =
            self.timer
                .render_pass(self.encoder, label, colors, depth_stencil, multiview_mask);
        pass.set_bind_group(0, self.frame.group(), &[]);
        pass
    }

    /// As [`Recorder::render_pass`], with `frame` as bind group 0: one that leaves out what the pass
    /// draws to.
    pub(crate) fn open_pass(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        frame: &wgpu::BindGroup,
    ) -> wgpu::RenderPass<'_> {
        let timer = &mut self.timer;
        let mut pass = timer.render_pass(self.encoder, label, colors, None, None);
        pass.set_bind_group(0, frame, &[]);
        pass
    }

    /// Begins a compute pass that is timed under `label`; bind group 0 is set.
    pub(crate) fn compute_pass(&mut self, label: &str) -> wgpu::ComputePass<'_> {
        let mut pass = self.timer.compute_pass(self.encoder, label);
        pass.set_bind_group(0, self.frame.group(), &[]);
        pass
    }
}

/// A colour attachment that is written whole.
pub(crate) fn overwritten(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    attached(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))
}

/// A colour attachment that is drawn over.
pub(crate) fn drawn_over(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    attached(view, wgpu::LoadOp::Load)
}

fn attached(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        },
    })
}
