//! Materials as bind group 1: a uniform block, textures, samplers.

use super::material_uniform::{MaterialUniform, SLOTS, material_class, slots};
use foveal_scene::{ColorSpace, Material, Sampler, Scene, Texture};

use super::families::{Families, FamilyBindings, Slot};
use super::samplers::Samplers;
use super::textures::{ArrayLimits, Textures};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, uniform};
use crate::{Error, Settings};

/// The layout of bind group 1.
pub(crate) fn material_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let mut types = vec![uniform()];
    for _ in 0..SLOTS {
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
    families: Families,
    /// `None` on devices without storage buffers.
    family_bindings: Option<FamilyBindings>,
}

impl SceneMaterials {
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        layout: &wgpu::BindGroupLayout,
        limits: ArrayLimits,
    ) -> Result<Self, Error> {
        let white = white();
        // Bound where a material has no texture.
        let missing = scene.textures.len() as u32;
        let textures: Vec<_> = scene.textures.iter().chain([&white]).collect();
        let textures = Textures::new(gpu, &textures, limits)?;
        let mut samplers = Samplers::new(gpu, settings.lighting.anisotropy);
        let slots_of = |material: &Material| {
            slots(material).map(|slot| {
                slot.map(|slot| Slot {
                    place: textures.place(slot.texture),
                    sampler: scene.textures[slot.texture as usize].sampler,
                })
            })
        };
        let uniforms: Vec<_> = (0..)
            .zip(&scene.materials)
            .map(|(number, material)| {
                let layers = slots_of(material).map(|slot| slot.map_or(0, |s| s.place.layer));
                MaterialUniform::new(material, number, layers)
            })
            .collect();
        let families =
            Families::new((scene.materials.iter()).map(|m| (material_class(m), slots_of(m))));
        let family_bindings = (!gpu.is_reduced()).then(|| {
            let white = textures.place(missing);
            FamilyBindings::new(gpu, &families, &uniforms, &textures, white, &mut samplers)
        });
        let stride = (size_of::<MaterialUniform>() as u64).next_multiple_of(u64::from(
            gpu.device.limits().min_uniform_buffer_offset_alignment,
        ));
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("materials"),
            size: stride * scene.materials.len().max(1) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut groups = Vec::with_capacity(scene.materials.len());
        for ((number, material), uniform) in (0..).zip(&scene.materials).zip(&uniforms) {
            let offset = number * stride;
            (gpu.queue).write_buffer(&buffer, offset, bytemuck::bytes_of(uniform));
            let pairs = slots(material).map(|slot| {
                let texture = slot.map_or(missing, |slot| slot.texture);
                let sampler = (scene.textures.get(texture as usize))
                    .map_or_else(Sampler::default, |texture| texture.sampler);
                (textures.alone(texture), samplers.get(sampler))
            });
            let mut resources = vec![wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &buffer,
                offset,
                size: wgpu::BufferSize::new(size_of::<MaterialUniform>() as u64),
            })];
            for (view, sampler) in &pairs {
                resources.push(wgpu::BindingResource::TextureView(view));
                resources.push(wgpu::BindingResource::Sampler(sampler));
            }
            groups.push(bind_group(&gpu.device, &material.name, layout, &resources));
        }
        Ok(Self {
            groups,
            families,
            family_bindings,
        })
    }

    pub(crate) fn group(&self, material: u32) -> &wgpu::BindGroup {
        &self.groups[material as usize]
    }

    /// What materials share dispatches.
    pub(crate) fn families(&self) -> &Families {
        &self.families
    }

    /// `None` where the device could not evaluate materials so.
    pub(crate) fn family_bindings(&self) -> Option<&FamilyBindings> {
        self.family_bindings.as_ref()
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
