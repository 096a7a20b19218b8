//! Materials as bind group 1: a uniform block, five textures, five samplers.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{AlphaMode, ColorSpace, Material, Sampler, Scene, Texture, TextureRef};

use super::textures::{Samplers, upload};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, uniform};
use crate::{Error, Settings};

/// Mirrors `Material` in `shared/material.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaterialUniform {
    pub(crate) base_color: [f32; 4],
    pub(crate) emissive: [f32; 3],
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
    pub(crate) normal_scale: f32,
    pub(crate) occlusion_strength: f32,
    pub(crate) alpha_cutoff: f32,
    pub(crate) uv: [[[f32; 4]; 2]; 5],
    pub(crate) number: u32,
    pub(crate) procedural_seed: u32,
    pub(crate) procedural_frequency: f32,
    pub(crate) reserved_0: u32,
}

/// A material's texture slots in the order of the shader's bindings; their positions are the flags' bits.
fn slots(material: &Material) -> [Option<TextureRef>; 5] {
    [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
    ]
}

const IS_UNLIT: u32 = 32;
const IS_PROCEDURAL: u32 = 64;

/// What the shader is specialized to: one bit per texture slot in use, one for unlit, one for procedural.
pub(crate) fn material_class(material: &Material) -> u32 {
    let slots = slots(material);
    let textures = slots
        .iter()
        .enumerate()
        .map(|(i, slot)| u32::from(slot.is_some()) << i);
    let flags = [
        (material.unlit, IS_UNLIT),
        (material.procedural.is_some(), IS_PROCEDURAL),
    ];
    let flags = flags.iter().map(|&(is, bit)| if is { bit } else { 0 });
    textures.sum::<u32>() | flags.sum::<u32>()
}

impl MaterialUniform {
    pub(crate) fn new(material: &Material, number: u32) -> Self {
        let slots = slots(material);
        Self {
            base_color: material.base_color.to_array(),
            emissive: material.emissive.to_array(),
            metallic: material.metallic,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            occlusion_strength: material.occlusion_strength,
            alpha_cutoff: match material.alpha_mode {
                AlphaMode::Mask { cutoff } => cutoff,
                AlphaMode::Opaque | AlphaMode::Blend => 0.0,
            },
            uv: slots.map(|slot| slot.map_or([[0.0; 4]; 2], uv_rows)),
            number,
            procedural_seed: material.procedural.map_or(0, |p| p.seed),
            procedural_frequency: material.procedural.map_or(0.0, |p| p.frequency),
            reserved_0: 0,
        }
    }
}

fn uv_rows(slot: TextureRef) -> [[f32; 4]; 2] {
    let m = slot.uv_transform;
    [
        [m.x_axis.x, m.y_axis.x, m.z_axis.x, slot.uv_set as f32],
        [m.x_axis.y, m.y_axis.y, m.z_axis.y, 0.0],
    ]
}

/// The layout of bind group 1.
pub(crate) fn material_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let mut types = vec![uniform()];
    for _ in 0..5 {
        types.push(sampled(wgpu::TextureSampleType::Float { filterable: true }));
        types.push(wgpu::BindingType::Sampler(
            wgpu::SamplerBindingType::Filtering,
        ));
    }
    bind_group_layout(
        &gpu.device,
        "material",
        wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE,
        &types,
    )
}

/// The bind groups of a scene's materials.
#[derive(Debug)]
pub(crate) struct SceneMaterials {
    groups: Vec<wgpu::BindGroup>,
}

impl SceneMaterials {
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<Self, Error> {
        let views = scene
            .textures
            .iter()
            .map(|t| upload(gpu, t))
            .collect::<Result<Vec<_>, _>>()?;
        let white = upload(gpu, &white())?;
        let mut samplers = Samplers::new(gpu, settings.anisotropy);
        let stride = (size_of::<MaterialUniform>() as u64).next_multiple_of(u64::from(
            gpu.device.limits().min_uniform_buffer_offset_alignment,
        ));
        let uniforms = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("materials"),
            size: stride * scene.materials.len().max(1) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut groups = Vec::with_capacity(scene.materials.len());
        for (number, material) in (0..).zip(&scene.materials) {
            let offset = u64::from(number) * stride;
            gpu.queue.write_buffer(
                &uniforms,
                offset,
                bytemuck::bytes_of(&MaterialUniform::new(material, number)),
            );
            let pairs = slots(material).map(|slot| match slot {
                Some(slot) => {
                    let texture = slot.texture as usize;
                    (
                        &views[texture],
                        samplers.get(scene.textures[texture].sampler),
                    )
                }
                None => (&white, samplers.get(Sampler::default())),
            });
            let mut resources = vec![wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &uniforms,
                offset,
                size: wgpu::BufferSize::new(size_of::<MaterialUniform>() as u64),
            })];
            for (view, sampler) in &pairs {
                resources.push(wgpu::BindingResource::TextureView(view));
                resources.push(wgpu::BindingResource::Sampler(sampler));
            }
            groups.push(bind_group(&gpu.device, &material.name, layout, &resources));
        }
        Ok(Self { groups })
    }

    pub(crate) fn group(&self, material: u32) -> &wgpu::BindGroup {
        &self.groups[material as usize]
    }
}

/// What is bound where a material has no texture; the shader does not read it.
fn white() -> Texture {
    Texture {
        name: "white".to_owned(),
        width: 1,
        height: 1,
        color_space: ColorSpace::Linear,
        sampler: Sampler::default(),
        levels: vec![vec![255; 4]],
    }
}
