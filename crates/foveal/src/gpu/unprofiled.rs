//! Passes without times, where the feature `profiler` is off.

use std::num::NonZeroU32;

use super::Gpu;
use crate::{Error, Timing};

/// Opens passes, and tells no times.
#[derive(Debug)]
pub(crate) struct GpuTimer;

#[expect(clippy::unused_self, reason = "as the timer that measures")]
impl GpuTimer {
    #[expect(clippy::unnecessary_wraps, reason = "as the timer that measures")]
    pub(crate) fn new(_: &Gpu) -> Result<Self, Error> {
        Ok(Self)
    }

    pub(crate) fn render_pass<'e>(
        &mut self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        multiview_mask: Option<NonZeroU32>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments,
            depth_stencil_attachment,
            multiview_mask,
            ..Default::default()
        })
    }

    pub(crate) fn compute_pass<'e>(
        &mut self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
    ) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        })
    }

    pub(crate) fn resolve(&mut self, _: &mut wgpu::CommandEncoder) {}

    pub(crate) fn end_frame(&mut self) {}

    pub(crate) fn collect(&mut self, _: &Gpu) -> Vec<Timing> {
        Vec::new()
    }
}
