//! Short words for bind group layouts.

use wgpu::{BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages, TextureSampleType};

use super::Gpu;
use super::device::Device;

/// A layout whose bindings are `types` in order, each seen by `stages`.
pub(crate) fn bind_group_layout(
    gpu: &Gpu,
    label: &str,
    stages: ShaderStages,
    types: &[BindingType],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, &ty)| BindGroupLayoutEntry {
            binding,
            visibility: stages,
            ty,
            count: None,
        })
        .collect();
    gpu.bind_group_layout(label, &entries)
}

/// A bind group whose bindings are `resources` in order.
pub(crate) fn bind_group(
    device: &Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

const fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

pub(crate) const fn uniform() -> BindingType {
    buffer(BufferBindingType::Uniform)
}

pub(crate) const fn storage_read() -> BindingType {
    buffer(BufferBindingType::Storage { read_only: true })
}

pub(crate) const fn storage_write() -> BindingType {
    buffer(BufferBindingType::Storage { read_only: false })
}

/// A target that geometry is drawn into: `shared/layers.wgsl`.
pub(crate) const fn sampled_layers(sample_type: TextureSampleType) -> BindingType {
    BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    }
}

/// The same, written by a shader.
pub(crate) const fn written_layers(format: wgpu::TextureFormat) -> BindingType {
    BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    }
}

/// A texture that a shader writes.
pub(crate) const fn written(format: wgpu::TextureFormat) -> BindingType {
    BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    }
}

pub(crate) const fn sampled(sample_type: TextureSampleType) -> BindingType {
    BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}
