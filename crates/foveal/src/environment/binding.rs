//! The environment on the device: a cube map, a table of reflectances, and their sampler.

use half::f16;

use super::EnvironmentMap;
use super::ToBind;
use super::reflectance;
use crate::gpu::{Gpu, sampled};

/// What shaders look the environment up with.
#[derive(Debug)]
pub(crate) struct EnvironmentBinding {
    map: wgpu::TextureView,
    reflectances: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl EnvironmentBinding {
    /// What a layout says of [`EnvironmentBinding::resources`].
    pub(crate) const TYPES: [wgpu::BindingType; 3] = [
        wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::Cube,
            multisampled: false,
        },
        sampled(wgpu::TextureSampleType::Float { filterable: true }),
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
    ];

    /// Uploads a map; without one a single black texel a side stands for it.
    pub(crate) fn new(
        gpu: &Gpu,
        ToBind {
            map,
            reflectances: is_used,
        }: ToBind<'_>,
    ) -> Self {
        Self {
            map: cube_map(gpu, map),
            reflectances: reflectances(gpu, is_used),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("environment"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
        }
    }

    /// The map, the table and the sampler.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 3] {
        [
            wgpu::BindingResource::TextureView(&self.map),
            wgpu::BindingResource::TextureView(&self.reflectances),
            wgpu::BindingResource::Sampler(&self.sampler),
        ]
    }
}

fn cube_map(gpu: &Gpu, map: Option<&EnvironmentMap>) -> wgpu::TextureView {
    let side = map.map_or(1, EnvironmentMap::side);
    let levels = map.map_or(0, |map| map.levels().last as u32) + 1;
    let size = |level: u32| wgpu::Extent3d {
        width: side >> level,
        height: side >> level,
        depth_or_array_layers: 6,
    };
    let format = wgpu::TextureFormat::Rgba16Float;
    let texture = texture(gpu, "environment", size(0), levels, format);
    for (level, map) in (0..levels).zip(map.into_iter().cycle()) {
        let to = wgpu::TexelCopyTextureInfo {
            mip_level: level,
            ..texture.as_image_copy()
        };
        write(gpu, to, size(level), map.texels(level));
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    })
}

/// The table; a single texel where nothing looks it up.
fn reflectances(gpu: &Gpu, is_used: bool) -> wgpu::TextureView {
    let side = if is_used { reflectance::SIDE as u32 } else { 1 };
    let size = wgpu::Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 1,
    };
    let format = wgpu::TextureFormat::Rgba16Float;
    let texture = texture(gpu, "reflectances", size, 1, format);
    if is_used {
        let halves = |&[a, b, c]: &[f32; 3]| [a, b, c, 0.0].map(|v| f16::from_f32(v).to_bits());
        let texels: Vec<[u16; 4]> = reflectance::table().iter().map(halves).collect();
        write(gpu, texture.as_image_copy(), size, &texels);
    }
    texture.create_view(&Default::default())
}

fn texture(
    gpu: &Gpu,
    label: &str,
    size: wgpu::Extent3d,
    mip_level_count: u32,
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn write<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    to: wgpu::TexelCopyTextureInfo<'_>,
    size: wgpu::Extent3d,
    texels: &[T],
) {
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(size.width * size_of::<T>() as u32),
        rows_per_image: Some(size.height),
    };
    gpu.queue
        .write_texture(to, bytemuck::cast_slice(texels), layout, size);
}
