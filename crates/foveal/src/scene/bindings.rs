//! Bind group 0: the frame's uniform block, the instances, and which of them are drawn.

use super::InstanceUniform;
use crate::Error;
use crate::frame::FrameUniform;
use crate::gpu::{Gpu, Table, bind_group, bind_group_layout, uniform};

/// Bind group 0 of every pass.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    instances: Table,
    drawn: Table,
}

impl FrameBindings {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let table = Table::binding_type(gpu);
        let layout = bind_group_layout(
            &gpu.device,
            "frame",
            wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
            &[uniform(), table, table],
        );
        let frame = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut instances = Table::new(gpu, "instances");
        // A binding must hold one instance, even where there is none.
        instances.write(gpu, &[0; size_of::<InstanceUniform>()]);
        let drawn = Table::new(gpu, "drawn");
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

    /// The same group with another list of drawn instances.
    pub(crate) fn group_of(&self, gpu: &Gpu, drawn: &Table) -> wgpu::BindGroup {
        group(gpu, &self.layout, &self.frame, &self.instances, drawn)
    }

    /// Uploads the frame's uniform block.
    pub(crate) fn write_frame(&self, gpu: &Gpu, uniform: &FrameUniform) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(uniform));
    }

    /// Uploads all instances of a scene.
    ///
    /// # Errors
    /// [`Error::Limit`] where they are more than the device can bind.
    pub(crate) fn write_instances(
        &mut self,
        gpu: &Gpu,
        uniforms: &[InstanceUniform],
    ) -> Result<(), Error> {
        let what = "the scene's number of instances";
        Table::check(gpu, what, uniforms.len(), size_of::<InstanceUniform>())?;
        if self.instances.write(gpu, bytemuck::cast_slice(uniforms)) {
            self.group = group(gpu, &self.layout, &self.frame, &self.instances, &self.drawn);
        }
        Ok(())
    }

    /// Uploads the list of drawn instances.
    pub(crate) fn write_drawn(&mut self, gpu: &Gpu, drawn: &[u32]) {
        if self.drawn.write(gpu, bytemuck::cast_slice(drawn)) {
            self.group = group(gpu, &self.layout, &self.frame, &self.instances, &self.drawn);
        }
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    instances: &Table,
    drawn: &Table,
) -> wgpu::BindGroup {
    bind_group(
        &gpu.device,
        "frame",
        layout,
        &[
            frame.as_entire_binding(),
            instances.resource(),
            drawn.resource(),
        ],
    )
}
