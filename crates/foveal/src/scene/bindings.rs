//! Bind group 0: the frame's uniform block, the instances, and which of them are drawn.

use super::InstanceUniform;
use crate::Error;
use crate::frame::FrameUniform;
use crate::gpu::{Gpu, bind_group, bind_group_layout, storage_read, uniform};

/// Bind group 0 of every pass.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    instances: wgpu::Buffer,
    drawn: wgpu::Buffer,
}

impl FrameBindings {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = bind_group_layout(
            &gpu.device,
            "frame",
            wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
            &[uniform(), storage_read(), storage_read()],
        );
        let frame = buffer(
            gpu,
            "frame",
            size_of::<FrameUniform>(),
            wgpu::BufferUsages::UNIFORM,
        );
        let instances = buffer(
            gpu,
            "instances",
            size_of::<InstanceUniform>(),
            wgpu::BufferUsages::STORAGE,
        );
        let drawn = buffer(gpu, "drawn", 4, wgpu::BufferUsages::STORAGE);
        let group = group(gpu, &layout, &frame, &instances, &drawn);
        Self {
            layout,
            group,
            frame,
            instances,
            drawn,
        }
    }

    pub(crate) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    pub(crate) fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// Uploads the frame's uniform block.
    pub(crate) fn write_frame(&self, gpu: &Gpu, uniform: &FrameUniform) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(uniform));
    }

    /// Uploads all instances of a scene.
    ///
    /// # Errors
    /// [`Error::Limit`] where they exceed the device's largest storage buffer.
    pub(crate) fn write_instances(
        &mut self,
        gpu: &Gpu,
        uniforms: &[InstanceUniform],
    ) -> Result<(), Error> {
        let bytes: &[u8] = bytemuck::cast_slice(uniforms);
        let limit = gpu.device.limits().max_storage_buffer_binding_size;
        if bytes.len() as u64 > limit {
            return Err(Error::Limit {
                what: "the scene's number of instances".to_owned(),
                value: uniforms.len() as u64,
                limit: limit / size_of::<InstanceUniform>() as u64,
                hint: String::new(),
            });
        }
        if bytes.len() as u64 > self.instances.size() {
            self.instances = buffer(gpu, "instances", bytes.len(), wgpu::BufferUsages::STORAGE);
            self.group = group(gpu, &self.layout, &self.frame, &self.instances, &self.drawn);
        }
        gpu.queue.write_buffer(&self.instances, 0, bytes);
        Ok(())
    }

    /// Uploads the list of drawn instances.
    pub(crate) fn write_drawn(&mut self, gpu: &Gpu, drawn: &[u32]) {
        let bytes: &[u8] = bytemuck::cast_slice(drawn);
        if bytes.len() as u64 > self.drawn.size() {
            self.drawn = buffer(
                gpu,
                "drawn",
                bytes.len().next_power_of_two(),
                wgpu::BufferUsages::STORAGE,
            );
            self.group = group(gpu, &self.layout, &self.frame, &self.instances, &self.drawn);
        }
        gpu.queue.write_buffer(&self.drawn, 0, bytes);
    }
}

fn buffer(gpu: &Gpu, label: &str, bytes: usize, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    instances: &wgpu::Buffer,
    drawn: &wgpu::Buffer,
) -> wgpu::BindGroup {
    bind_group(
        &gpu.device,
        "frame",
        layout,
        &[
            frame.as_entire_binding(),
            instances.as_entire_binding(),
            drawn.as_entire_binding(),
        ],
    )
}
