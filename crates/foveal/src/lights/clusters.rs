//! The cluster grid and the pass that fills it.

use super::ClusterGrid;

use super::{LightUniform, cluster_bits};
use crate::frame::FrameUniform;
use crate::gpu::{Gpu, Table, bind_group, bind_group_layout, sampled, storage_read, storage_write};

use crate::recorder::Recorder;
use crate::shader;
use crate::shadow::ShadowStage;

/// Fills the clusters' bits.
#[derive(Debug)]
pub(crate) struct LightAssigner {
    means: Means,
    eyes: u32,
    /// One bit per cluster and light that shines from a point; grows when it must.
    bits: wgpu::Buffer,
}

/// By what it fills them.
#[derive(Debug)]
enum Means {
    /// A pass on the device.
    Pass(wgpu::ComputePipeline, wgpu::BindGroupLayout),
    /// The CPU.
    Cpu(Table),
}

/// A scene's lights, and which of them reach which cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneLights<'a> {
    /// The lights.
    pub(crate) table: &'a Table,
    pub(crate) assigner: &'a LightAssigner,
    pub(crate) shadows: &'a ShadowStage,
}

impl<'a> SceneLights<'a> {
    /// What lighting binds: the lights, the clusters' bits and what it looks up of shadows.
    pub(crate) fn resources(self) -> [wgpu::BindingResource<'a>; 5] {
        let bits = match &self.assigner.means {
            Means::Pass(..) => self.assigner.bits.as_entire_binding(),
            Means::Cpu(clusters) => clusters.resource(),
        };
        let [rows, atlas, sampler] = self.shadows.resources();
        [self.table.resource(), bits, rows, atlas, sampler]
    }

    /// What a layout says of [`SceneLights::resources`].
    pub(crate) fn binding_types(gpu: &Gpu) -> [wgpu::BindingType; 5] {
        let table = Table::binding_type(gpu);
        let bits = if gpu.is_reduced() {
            table
        } else {
            storage_read()
        };
        [
            table,
            bits,
            table,
            sampled(wgpu::TextureSampleType::Depth),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
        ]
    }
}

impl LightAssigner {
    /// For a frame of one or two `eyes`.
    pub(crate) fn new(gpu: &Gpu, eyes: u32, frame_layout: &wgpu::BindGroupLayout) -> Self {
        if gpu.is_reduced() {
            return Self {
                means: Means::Cpu(Table::new(gpu, "cluster lights")),
                eyes,
                bits: bits_buffer(gpu, 1),
            };
        }
        let layout = bind_group_layout(
            gpu,
            "light assignment",
            wgpu::ShaderStages::COMPUTE,
            &[Table::binding_type(gpu), storage_write()],
        );
        let module = shader::module(gpu, "clusters", shader::LIGHTS_CLUSTERS);
        let pipeline = shader::compute(
            gpu,
            "light assignment",
            &module,
            "assign",
            &[frame_layout, &layout],
            &[("VIEWS", f64::from(eyes))],
        );
        Self {
            means: Means::Pass(pipeline, layout),
            eyes,
            bits: bits_buffer(gpu, 1),
        }
    }

    /// Where the CPU fills the bits, it does so now.
    pub(crate) fn assign_on_cpu(
        &mut self,
        gpu: &Gpu,
        frame: &FrameUniform,
        lights: &[LightUniform],
    ) {
        if let Means::Cpu(clusters) = &mut self.means {
            let bits = cluster_bits(frame, self.eyes as usize, lights);
            clusters.write(gpu, bytemuck::cast_slice(&bits));
        }
    }

    /// The clusters' bits.
    #[cfg(test)]
    pub(crate) fn bits(&self) -> &wgpu::Buffer {
        &self.bits
    }

    /// Makes room for a grid; true when the buffer is a new one.
    pub(crate) fn reserve(&mut self, gpu: &Gpu, grid: &ClusterGrid) -> bool {
        let words = grid.total_words().max(1);
        let grows = self.bits.size() < words * 4;
        if grows {
            self.bits = bits_buffer(gpu, words);
        }
        grows
    }

    /// Encodes the pass, where there is one. `lights` holds `grid.light_count` lights.
    pub(crate) fn assign(&self, recorder: &mut Recorder<'_>, lights: &Table, grid: &ClusterGrid) {
        let Means::Pass(pipeline, layout) = &self.means else {
            return;
        };
        recorder
            .encoder
            .clear_buffer(&self.bits, 0, Some(grid.total_words().max(1) * 4));
        if grid.light_count == 0 {
            return;
        }
        let group = bind_group(
            &recorder.gpu.device,
            "light assignment",
            layout,
            &[lights.resource(), self.bits.as_entire_binding()],
        );
        let mut pass = recorder.compute_pass("light assignment");
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(grid.light_count, 1, 1);
    }
}

fn bits_buffer(gpu: &Gpu, words: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("cluster lights"),
        size: words * 4,
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}
