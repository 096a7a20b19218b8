//! How long passes take on the device, by timestamps.

use std::num::NonZeroU32;

use wgpu_profiler::{GpuProfiler, GpuProfilerQuery, GpuProfilerSettings};

use super::Gpu;
use crate::{Error, Timing};

/// Times passes by timestamps at their boundaries; silent on devices without timestamps.
pub(crate) struct GpuTimer {
    profiler: GpuProfiler,
    queries: Vec<GpuProfilerQuery>,
}

impl std::fmt::Debug for GpuTimer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("GpuTimer")
    }
}

impl GpuTimer {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let timestamps = gpu
            .device
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY);
        let settings = GpuProfilerSettings {
            enable_timer_queries: timestamps,
            enable_debug_groups: false,
            ..Default::default()
        };
        let profiler =
            GpuProfiler::new(&gpu.device, settings).map_err(|cause| Error::Validation {
                doing: "making timers".to_owned(),
                cause: cause.to_string(),
            })?;
        Ok(Self {
            profiler,
            queries: Vec::new(),
        })
    }

    /// Opens a render pass that is timed under `label`, to several layers at once where there is a
    /// mask.
    pub(crate) fn render_pass<'e>(
        &mut self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        multiview_mask: Option<NonZeroU32>,
    ) -> wgpu::RenderPass<'e> {
        let query = self.profiler.begin_pass_query(label, encoder);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments,
            depth_stencil_attachment,
            timestamp_writes: query.render_pass_timestamp_writes(),
            multiview_mask,
            ..Default::default()
        });
        self.queries.push(query);
        pass
    }

    /// Opens a compute pass that is timed under `label`.
    pub(crate) fn compute_pass<'e>(
        &mut self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
    ) -> wgpu::ComputePass<'e> {
        let query = self.profiler.begin_pass_query(label, encoder);
        let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: query.compute_pass_timestamp_writes(),
        });
        self.queries.push(query);
        pass
    }

    /// Call after the frame's last pass, before the encoder is finished.
    pub(crate) fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        for query in self.queries.drain(..) {
            self.profiler.end_query(encoder, query);
        }
        self.profiler.resolve_queries(encoder);
    }

    /// Call after the submission. Without it, and [`GpuTimer::collect`], timings pile up.
    pub(crate) fn end_frame(&mut self) {
        // The only error is an open query, and `resolve` closed them all.
        let _ = self.profiler.end_frame();
    }

    /// The oldest finished frame's passes in order, those of one name added up; empty while none is
    /// finished.
    pub(crate) fn collect(&mut self, gpu: &Gpu) -> Vec<Timing> {
        let Some(results) = self
            .profiler
            .process_finished_frame(gpu.queue.get_timestamp_period())
        else {
            return Vec::new();
        };
        let mut timings: Vec<Timing> = Vec::new();
        for result in results {
            let Some(time) = result.time else { continue };
            let ms = (time.end - time.start) * 1000.0;
            match timings.iter_mut().find(|t| t.name == result.label) {
                Some(timing) => timing.ms += ms,
                None => timings.push(Timing {
                    name: result.label,
                    ms,
                }),
            }
        }
        timings
    }
}
