//! Samplers on the device.

use std::collections::HashMap;

use foveal_scene::{Filter, Sampler, Wrap};

use crate::gpu::Gpu;

/// The samplers that a scene uses, each made once.
pub(crate) struct Samplers<'a> {
    gpu: &'a Gpu,
    anisotropy: u16,
    made: HashMap<Sampler, wgpu::Sampler>,
}

impl<'a> Samplers<'a> {
    pub(crate) fn new(gpu: &'a Gpu, anisotropy: u16) -> Self {
        // Lavapipe's anisotropic filter (Mesa 22.3) visits every texel of a footprint that has no
        // bound, and finds it from neighbouring coordinates even where the shader gives gradients:
        // a triangle seen edge-on keeps it busy for minutes. Without it its geometry pass takes a
        // quarter of the time besides.
        let broken = gpu.is_lavapipe();
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
