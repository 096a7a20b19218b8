//! Textures and samplers on the device.

use std::collections::HashMap;

use foveal_scene::{ColorSpace, Filter, Sampler, Texture, Wrap};

use crate::Error;
use crate::gpu::Gpu;

/// Uploads a texture; levels larger than the device's limit are left out.
pub(crate) fn upload(gpu: &Gpu, texture: &Texture) -> Result<wgpu::TextureView, Error> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let extent = |level: usize| {
        (
            (texture.width >> level).max(1),
            (texture.height >> level).max(1),
        )
    };
    let fitting = (0..texture.levels.len()).find(|&l| extent(l).0.max(extent(l).1) <= limit);
    let Some(first) = fitting else {
        return Err(Error::Limit {
            what: format!("the larger side of the texture '{}'", texture.name),
            value: u64::from(texture.width.max(texture.height)),
            limit: u64::from(limit),
            hint: String::new(),
        });
    };
    let (width, height) = extent(first);
    let on_gpu = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(&texture.name),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: (texture.levels.len() - first) as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match texture.color_space {
            ColorSpace::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            ColorSpace::Linear => wgpu::TextureFormat::Rgba8Unorm,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip, level) in (first..texture.levels.len()).enumerate() {
        let (width, height) = extent(level);
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                mip_level: mip as u32,
                ..on_gpu.as_image_copy()
            },
            &texture.levels[level],
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * 4),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
        );
    }
    Ok(on_gpu.create_view(&Default::default()))
}

/// The samplers that a scene uses, each made once.
pub(crate) struct Samplers<'a> {
    gpu: &'a Gpu,
    anisotropy: u16,
    made: HashMap<Sampler, wgpu::Sampler>,
}

impl<'a> Samplers<'a> {
    pub(crate) fn new(gpu: &'a Gpu, anisotropy: u16) -> Self {
        // Lavapipe's anisotropic filter (Mesa 22.3) visits every texel of a footprint that has no bound, and
        // finds it from neighbouring coordinates even where the shader gives gradients: a triangle seen edge-on
        // keeps it busy for minutes. Without it its geometry pass takes a quarter of the time besides.
        let broken = gpu.adapter_stats().driver.starts_with("llvmpipe");
        let anisotropy = if broken { 1 } else { anisotropy };
        Self {
            gpu,
            anisotropy,
            made: HashMap::new(),
        }
    }

    pub(crate) fn get(&mut self, sampler: Sampler) -> wgpu::Sampler {
        let (gpu, anisotropy) = (self.gpu, self.anisotropy);
        self.made
            .entry(sampler)
            .or_insert_with(|| gpu.device.create_sampler(&descriptor(sampler, anisotropy)))
            .clone()
    }
}

fn descriptor(sampler: Sampler, anisotropy: u16) -> wgpu::SamplerDescriptor<'static> {
    let all_linear = sampler.mag == Filter::Linear
        && sampler.min == Filter::Linear
        && sampler.mip == Some(Filter::Linear);
    wgpu::SamplerDescriptor {
        address_mode_u: wrap(sampler.wrap_u),
        address_mode_v: wrap(sampler.wrap_v),
        mag_filter: filter(sampler.mag),
        min_filter: filter(sampler.min),
        mipmap_filter: match sampler.mip {
            Some(Filter::Linear) => wgpu::MipmapFilterMode::Linear,
            Some(Filter::Nearest) | None => wgpu::MipmapFilterMode::Nearest,
        },
        // The graphics API allows anisotropy for linear filters alone.
        anisotropy_clamp: if all_linear { anisotropy } else { 1 },
        ..Default::default()
    }
}

fn wrap(wrap: Wrap) -> wgpu::AddressMode {
    match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
    }
}

fn filter(filter: Filter) -> wgpu::FilterMode {
    match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    }
}
