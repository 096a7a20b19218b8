//! Targets of passes.

use super::Gpu;

/// A view of a new texture without mips that passes draw into, that others read, and that can be
/// read back; `usage` is what it is used for besides.
pub(crate) fn target(
    gpu: &Gpu,
    label: &str,
    size: (u32, u32),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    layered_target(gpu, label, size, 1, format, usage)
}

/// As [`target`], with so many layers: the view is of all of them.
pub(crate) fn layered_target(
    gpu: &Gpu,
    label: &str,
    (width, height): (u32, u32),
    layers: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage
            | wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

/// A view of the same texture as shaders read layers, however many there are.
pub(crate) fn layers_of(view: &wgpu::TextureView) -> wgpu::TextureView {
    view.texture().create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// A view of one layer of the same texture.
pub(crate) fn layer_of(view: &wgpu::TextureView, layer: u32) -> wgpu::TextureView {
    view.texture().create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..Default::default()
    })
}
