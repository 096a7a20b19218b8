//! Bind group 0: the frame's uniform block, the instances, which of them are drawn, and the
//! environment with what is known of its occlusion.

use super::InstanceUniform;
use crate::Error;
use crate::ambient::visibility_format;
use crate::environment::{EnvironmentBinding, ToBind};
use crate::frame::FrameUniform;
use crate::gpu::{Gpu, Table, bind_group, bind_group_layout, sampled, target, uniform};

/// Bind group 0 of every pass.
#[derive(Debug)]
pub(crate) struct FrameBindings {
    layout: wgpu::BindGroupLayout,
    /// The same without what occludes the environment.
    open_layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    instances: Table,
    drawn: Table,
    environment: EnvironmentBinding,
    ambient: AmbientBinding,
}

/// What occludes the environment.
#[derive(Debug)]
struct AmbientBinding {
    /// Stands for it where nothing does.
    none: wgpu::TextureView,
    found: Option<wgpu::TextureView>,
}

impl AmbientBinding {
    fn new(gpu: &Gpu) -> Self {
        let usage = wgpu::TextureUsages::empty();
        let label = "no ambient occlusion";
        Self {
            none: target(gpu, label, (1, 1), visibility_format(gpu), usage),
            found: None,
        }
    }

    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(self.found.as_ref().unwrap_or(&self.none))
    }
}

/// An environment that is uploaded and not bound yet.
#[derive(Debug)]
pub(crate) struct BoundEnvironment {
    binding: EnvironmentBinding,
    group: wgpu::BindGroup,
}

impl FrameBindings {
    /// Bindings without instances; without a map, the environment is black.
    pub(crate) fn new(gpu: &Gpu, around: ToBind<'_>) -> Self {
        let table = Table::binding_type(gpu);
        let [cube, reflectances, sampler] = EnvironmentBinding::TYPES;
        let mut types = vec![uniform(), table, table, cube, reflectances, sampler];
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let open_layout = bind_group_layout(gpu, "open frame", stages, &types);
        types.push(sampled(if gpu.is_reduced() {
            wgpu::TextureSampleType::Uint
        } else {
            wgpu::TextureSampleType::Float { filterable: false }
        }));
        let layout = bind_group_layout(gpu, "frame", stages, &types);
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
        let environment = EnvironmentBinding::new(gpu, around);
        let ambient = AmbientBinding::new(gpu);
        let tables = (&instances, &drawn);
        let around = (&environment, Some(ambient.resource()));
        let group = group(gpu, &layout, &frame, tables, around);
        Self {
            layout,
            open_layout,
            group,
            frame,
            instances,
            drawn,
            environment,
            ambient,
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
        let tables = (&self.instances, drawn);
        let around = (&self.environment, Some(self.ambient.resource()));
        group(gpu, &self.layout, &self.frame, tables, around)
    }

    /// Of [`FrameBindings::open_group`].
    pub(crate) fn open_layout(&self) -> &wgpu::BindGroupLayout {
        &self.open_layout
    }

    /// The same group without what occludes the environment: for passes that find it, and for those
    /// that have no place for another texture.
    pub(crate) fn open_group(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let tables = (&self.instances, &self.drawn);
        let around = (&self.environment, None);
        group(gpu, &self.open_layout, &self.frame, tables, around)
    }

    /// Binds what occludes the environment; `None`: nothing does.
    pub(crate) fn bind_ambient(&mut self, gpu: &Gpu, found: Option<&wgpu::TextureView>) {
        if self.ambient.found.as_ref() != found {
            self.ambient.found = found.cloned();
            self.group = self.group_of(gpu, &self.drawn);
        }
    }

    /// Another environment with the group that binds it; without a map, one that is black.
    pub(crate) fn with_environment(&self, gpu: &Gpu, around: ToBind<'_>) -> BoundEnvironment {
        let binding = EnvironmentBinding::new(gpu, around);
        let tables = (&self.instances, &self.drawn);
        let around = (&binding, Some(self.ambient.resource()));
        let group = group(gpu, &self.layout, &self.frame, tables, around);
        BoundEnvironment { binding, group }
    }

    /// Binds another environment.
    pub(crate) fn set_environment(&mut self, bound: BoundEnvironment) {
        self.environment = bound.binding;
        self.group = bound.group;
    }

    /// Uploads the frame's uniform block.
    pub(crate) fn write_frame(&self, gpu: &Gpu, uniform: &FrameUniform) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(uniform));
    }

    /// Checks that so many instances can be uploaded.
    ///
    /// # Errors
    /// [`Error::Limit`] where they are more than the device can bind.
    pub(crate) fn check_instances(gpu: &Gpu, count: usize) -> Result<(), Error> {
        let what = "the scene's number of instances";
        Table::check(gpu, what, count, size_of::<InstanceUniform>())
    }

    /// Uploads all instances of a scene that has passed [`FrameBindings::check_instances`].
    pub(crate) fn write_instances(&mut self, gpu: &Gpu, uniforms: &[InstanceUniform]) {
        if self.instances.write(gpu, bytemuck::cast_slice(uniforms)) {
            self.group = self.group_of(gpu, &self.drawn);
        }
    }

    /// Uploads the list of drawn instances.
    pub(crate) fn write_drawn(&mut self, gpu: &Gpu, drawn: &[u32]) {
        if self.drawn.write(gpu, bytemuck::cast_slice(drawn)) {
            self.group = self.group_of(gpu, &self.drawn);
        }
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    (instances, drawn): (&Table, &Table),
    (environment, ambient): (&EnvironmentBinding, Option<wgpu::BindingResource<'_>>),
) -> wgpu::BindGroup {
    let [map, reflectances, sampler] = environment.resources();
    let mut resources = vec![
        frame.as_entire_binding(),
        instances.resource(),
        drawn.resource(),
        map,
        reflectances,
        sampler,
    ];
    resources.extend(ambient);
    bind_group(&gpu.device, "frame", layout, &resources)
}
