//! Materials as bind group 1: a uniform block, textures, samplers.

use std::borrow::Cow;

use super::material_uniform::{MaterialUniform, SLOTS, material_class, slots};
use foveal_scene::{ColorSpace, Material, Sampler, Scene, Texture};

use super::families::{Families, FamilyBindings, Slot};
use super::lobes::{BOUND, Binding, LobeClass, LobesUniform};
use super::samplers::Samplers;
use super::textures::{ArrayLimits, Textures};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, uniform};
use crate::{Error, Settings};

/// A uniform block and so many textures with their samplers.
fn types(textures: usize) -> Vec<wgpu::BindingType> {
    let filterable = sampled(wgpu::TextureSampleType::Float { filterable: true });
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let pairs = (0..textures).flat_map(|_| [filterable, sampler]);
    std::iter::once(uniform()).chain(pairs).collect()
}

/// The layout of bind group 1.
pub(crate) fn material_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let stages = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
    bind_group_layout(gpu, "material", stages, &types(SLOTS))
}

/// The layout of bind group 1 where lobes are shaded: the same, and theirs.
pub(crate) fn lobes_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let own = types(own_bindings(gpu));
    let all: Vec<_> = types(SLOTS).into_iter().chain(own).collect();
    let stages = wgpu::ShaderStages::FRAGMENT;
    bind_group_layout(gpu, "lobes", stages, &all)
}

/// Bindings for textures of lobes alone.
fn own_bindings(gpu: &Gpu) -> usize {
    if gpu.is_reduced() { 0 } else { BOUND }
}

/// Textures and samplers, each texture before its own.
fn push_pairs<'a>(
    resources: &mut Vec<wgpu::BindingResource<'a>>,
    pairs: &'a [(&wgpu::TextureView, wgpu::Sampler)],
) {
    resources.extend(pairs.iter().flat_map(|(view, sampler)| {
        let view = wgpu::BindingResource::TextureView(view);
        [view, wgpu::BindingResource::Sampler(sampler)]
    }));
}

/// A material's lobes.
#[derive(Debug)]
struct Lobes {
    class: LobeClass,
    group: wgpu::BindGroup,
    uniform: LobesUniform,
    /// The same on the device.
    block: wgpu::Buffer,
}

/// How a pose has changed a material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MaterialChange {
    /// Shaders are told something else.
    pub(crate) is_other: bool,
    /// What light does at it may be something else: more than its colour or emission.
    pub(crate) is_lit_otherwise: bool,
    /// Its holes may be elsewhere.
    pub(crate) holes: bool,
}

/// The bind groups of a scene's materials.
#[derive(Debug)]
pub(crate) struct SceneMaterials {
    groups: Vec<wgpu::BindGroup>,
    /// Of each material that has lobes.
    lobes: Vec<Option<Lobes>>,
    /// What shaders are told of each material.
    uniforms: Vec<MaterialUniform>,
    /// The same on the device, each at a multiple of `stride`.
    buffer: wgpu::Buffer,
    stride: u64,
    /// [`material_class`] of each, for all poses.
    classes: Vec<u32>,
    families: Families,
    /// `None` on devices without storage buffers.
    family_bindings: Option<FamilyBindings>,
    texture_bytes: u64,
}

impl SceneMaterials {
    /// Whether the device can bind so many materials.
    ///
    /// # Errors
    /// [`Error::Limit`] where it cannot.
    pub(crate) fn check(gpu: &Gpu, count: usize) -> Result<(), Error> {
        if gpu.is_reduced() {
            return Ok(());
        }
        let bytes = size_of::<MaterialUniform>() as u64;
        let limit = gpu.device.limits().max_storage_buffer_binding_size / bytes;
        Error::if_above(limit, "the scene's number of materials", count)
    }

    /// `textures`: the scene's, whose own may have lost their texels.
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        textures: Vec<Cow<'_, Texture>>,
        settings: &Settings,
        layout: &wgpu::BindGroupLayout,
        limits: ArrayLimits,
    ) -> Result<Self, Error> {
        let white = white();
        // Bound where a material has no texture.
        let missing = scene.textures.len() as u32;
        let textures = textures.into_iter().chain([Cow::Owned(white)]).collect();
        let textures = Textures::new(gpu, textures, limits)?;
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
        let classes: Vec<u32> = (scene.materials.iter())
            .map(|material| material_class(material, &scene.textures))
            .collect();
        let materials = classes.iter().zip(&scene.materials);
        let families = Families::new(materials.map(|(class, m)| (*class, slots_of(m))));
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
        let mut lobes = Vec::with_capacity(scene.materials.len());
        let lobes_layout = lobes_layout(gpu);
        for ((number, material), uniform) in (0..).zip(&scene.materials).zip(&uniforms) {
            let offset = number * stride;
            (gpu.queue).write_buffer(&buffer, offset, bytemuck::bytes_of(uniform));
            let mut pairs = |textures_at: &[u32]| -> Vec<_> {
                let sampler_of = |texture| {
                    (scene.textures.get(texture as usize))
                        .map_or_else(Sampler::default, |texture| texture.sampler)
                };
                (textures_at.iter())
                    .map(|&at| (textures.alone(at), samplers.get(sampler_of(at))))
                    .collect()
            };
            let block_of_material = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &buffer,
                offset,
                size: wgpu::BufferSize::new(size_of::<MaterialUniform>() as u64),
            });
            let mut at_slots = slots(material).map(|slot| slot.map_or(missing, |s| s.texture));
            let own = pairs(&at_slots);
            let mut resources = vec![block_of_material.clone()];
            push_pairs(&mut resources, &own);
            groups.push(bind_group(&gpu.device, &material.name, layout, &resources));
            if !material.has_lobes() || material.unlit {
                lobes.push(None);
                continue;
            }
            let (class, bound) = LobeClass::of(material, &scene.textures, gpu.is_reduced());
            let mut at_own = [missing; BOUND];
            for (binding, texture) in bound {
                match binding {
                    Binding::Own(place) => at_own[place] = texture,
                    Binding::Slot(place) => at_slots[place] = texture,
                }
            }
            let uniform = LobesUniform::new(material);
            let block = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lobes"),
                size: size_of::<LobesUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            (gpu.queue).write_buffer(&block, 0, bytemuck::bytes_of(&uniform));
            let (with_lobes, of_lobes) = (pairs(&at_slots), pairs(&at_own[..own_bindings(gpu)]));
            let mut resources = vec![block_of_material];
            push_pairs(&mut resources, &with_lobes);
            resources.push(block.as_entire_binding());
            push_pairs(&mut resources, &of_lobes);
            let group = bind_group(&gpu.device, &material.name, &lobes_layout, &resources);
            lobes.push(Some(Lobes {
                class,
                group,
                uniform,
                block,
            }));
        }
        Ok(Self {
            groups,
            lobes,
            uniforms,
            buffer,
            stride,
            classes,
            families,
            family_bindings,
            texture_bytes: textures.bytes(),
        })
    }

    /// Takes over the numbers of the same materials in another pose, of all of them; their textures,
    /// and the class and lobes for which their shaders are made, stay.
    pub(crate) fn update(&mut self, gpu: &Gpu, materials: &[Material]) -> Vec<MaterialChange> {
        let mut changes = vec![MaterialChange::default(); self.uniforms.len()];
        let pairs = changes.iter_mut().zip(materials);
        for (number, (change, material)) in pairs.enumerate() {
            let before = self.uniforms[number];
            let now = before.with_numbers_of(material);
            if let Some(lobes) = &mut self.lobes[number] {
                let uniform = LobesUniform::new(material);
                if bytemuck::bytes_of(&uniform) != bytemuck::bytes_of(&lobes.uniform) {
                    lobes.uniform = uniform;
                    change.is_other = true;
                    change.is_lit_otherwise = true;
                }
            }
            if bytemuck::bytes_of(&now) != bytemuck::bytes_of(&before) {
                self.uniforms[number] = now;
                change.is_other = true;
                change.is_lit_otherwise |= !now.differs_in_color_alone(&before);
                change.holes = now.has_other_holes(&before);
            }
            if change.is_other {
                self.write(gpu, number);
            }
        }
        changes
    }

    /// Uploads all materials once more: where a call failed, theirs may have been refused.
    pub(crate) fn write_all(&self, gpu: &Gpu) {
        (0..self.uniforms.len()).for_each(|number| self.write(gpu, number));
    }

    fn write(&self, gpu: &Gpu, number: usize) {
        let uniform = &self.uniforms[number];
        let offset = number as u64 * self.stride;
        (gpu.queue).write_buffer(&self.buffer, offset, bytemuck::bytes_of(uniform));
        if let Some(families) = &self.family_bindings {
            families.write(gpu, number, uniform);
        }
        if let Some(lobes) = &self.lobes[number] {
            (gpu.queue).write_buffer(&lobes.block, 0, bytemuck::bytes_of(&lobes.uniform));
        }
    }

    /// What a material's shaders are specialized to.
    pub(crate) fn class(&self, material: u32) -> u32 {
        self.classes[material as usize]
    }

    /// Bytes of all textures on the device.
    pub(crate) fn texture_bytes(&self) -> u64 {
        self.texture_bytes
    }

    pub(crate) fn group(&self, material: u32) -> &wgpu::BindGroup {
        &self.groups[material as usize]
    }

    /// A material's lobes, where it has some and this device shades them.
    pub(crate) fn lobes(&self, material: u32) -> Option<LobeClass> {
        let lobes = self.lobes[material as usize].as_ref();
        lobes.map(|lobes| lobes.class)
    }

    /// The group of a material with its lobes, where it has some; else as [`Self::group`].
    pub(crate) fn group_with_lobes(&self, material: u32) -> &wgpu::BindGroup {
        let lobes = self.lobes[material as usize].as_ref();
        lobes.map_or(self.group(material), |lobes| &lobes.group)
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
        encoding: foveal_scene::Encoding::Rgba8,
        levels: vec![vec![255; 4]],
    }
}
