//! Families of materials: those that one dispatch evaluates at all of their pixels.
//!
//! Materials are of one family where the same shader variant reads them out of the same arrays of
//! textures by the same samplers: what is left to tell them apart are factors and layers, which
//! shaders look up by the pixel's material.

use std::collections::HashMap;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use foveal_scene::Sampler;

use super::MaterialUniform;
use super::material_uniform::SLOTS;
use super::samplers::Samplers;
use super::textures::{Place, Textures};
use crate::Settings;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled_layers, storage_read, uniform};

/// What a material reads in one of its places for textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) place: Place,
    pub(crate) sampler: Sampler,
}

/// What the materials of a family have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Common {
    /// [`super::materials::material_class`].
    class: u32,
    /// Array and sampler of each slot in use.
    slots: [Option<(u32, Sampler)>; SLOTS],
}

/// A scene's materials by families.
#[derive(Debug)]
pub(crate) struct Families {
    common: Vec<Common>,
    /// Of each material.
    family_of: Vec<u32>,
    /// Each material's place in an order in which those of a family follow one another.
    ranks: Vec<u32>,
    /// Of each family's materials in this order.
    ranges: Vec<Range<u32>>,
}

impl Families {
    /// Of materials with these classes and slots; families are numbered as they first come up.
    pub(crate) fn new(materials: impl Iterator<Item = (u32, [Option<Slot>; SLOTS])>) -> Self {
        let mut numbers = HashMap::new();
        let mut common = Vec::new();
        let family_of: Vec<u32> = materials
            .map(|(class, slots)| {
                let slots = slots.map(|slot| slot.map(|s| (s.place.array, s.sampler)));
                let key = Common { class, slots };
                *numbers.entry(key.clone()).or_insert_with(|| {
                    common.push(key);
                    common.len() as u32 - 1
                })
            })
            .collect();
        let mut order: Vec<u32> = (0..family_of.len() as u32).collect();
        order.sort_by_key(|&material| family_of[material as usize]);
        let mut ranks = vec![0; order.len()];
        let mut ranges = vec![0..0; common.len()];
        for (rank, &material) in (0..).zip(&order) {
            ranks[material as usize] = rank;
            let range = &mut ranges[family_of[material as usize] as usize];
            if range.end == 0 {
                range.start = rank;
            }
            range.end = rank + 1;
        }
        Self {
            common,
            family_of,
            ranks,
            ranges,
        }
    }

    /// Number of families.
    pub(crate) fn count(&self) -> usize {
        self.common.len()
    }

    /// The family of a material.
    pub(crate) fn of(&self, material: u32) -> u32 {
        self.family_of[material as usize]
    }

    /// Of each material, where its bin comes: those of a family follow one another.
    pub(crate) fn ranks(&self) -> &[u32] {
        &self.ranks
    }
}

/// What one dispatch evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MaterialDispatch {
    /// All materials of a family.
    Family,
    /// One material.
    Material,
}

impl MaterialDispatch {
    /// What these settings ask for, or what is the faster on this device.
    pub(crate) fn of(gpu: &Gpu, settings: &Settings) -> Self {
        match settings.geometry.material_dispatch {
            crate::MaterialDispatch::Family => Self::Family,
            crate::MaterialDispatch::Material => Self::Material,
            // Lavapipe gathers what differs from pixel to pixel lane by lane:
            // docs/decisions/0213-families-of-materials.md.
            crate::MaterialDispatch::Auto => {
                if gpu.is_lavapipe() {
                    Self::Material
                } else {
                    Self::Family
                }
            }
        }
    }
}

/// Bytes of [`FamilyUniform`], which begins with the arguments of an indirect dispatch.
pub(crate) const FAMILY_BYTES: u64 = size_of::<FamilyUniform>() as u64;

/// Mirrors `Family` in `geometry/visibility/family.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct FamilyUniform {
    pub(crate) groups_x: u32,
    pub(crate) groups_y: u32,
    pub(crate) groups_z: u32,
    pub(crate) count: u32,
    pub(crate) first: u32,
    pub(crate) begin: u32,
    pub(crate) end: u32,
    pub(crate) reserved: u32,
}

/// The layout of [`FamilyBindings::group`]: bind group 1 of `geometry/visibility/by_family.wgsl`.
pub(crate) fn family_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let mut types = vec![storage_read(), uniform()];
    for _ in 0..SLOTS {
        types.push(sampled_layers(wgpu::TextureSampleType::Float {
            filterable: true,
        }));
        types.push(wgpu::BindingType::Sampler(
            wgpu::SamplerBindingType::Filtering,
        ));
    }
    let compute = wgpu::ShaderStages::COMPUTE;
    bind_group_layout(gpu, "material family", compute, &types)
}

/// Families as passes bind them.
#[derive(Debug)]
pub(crate) struct FamilyBindings {
    /// All materials, by number.
    materials: wgpu::Buffer,
    by_family: wgpu::Buffer,
    by_material: wgpu::Buffer,
    groups: Vec<wgpu::BindGroup>,
}

impl FamilyBindings {
    /// `materials`: all of the scene; `white`: bound where a family has no texture.
    pub(crate) fn new(
        gpu: &Gpu,
        families: &Families,
        materials: &[MaterialUniform],
        textures: &Textures,
        white: Place,
        samplers: &mut Samplers<'_>,
    ) -> Self {
        let layout = family_layout(gpu);
        let buffer = |label, bytes: &[u8], least: u64, usage| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                // An empty buffer cannot be bound.
                size: (bytes.len() as u64).max(least),
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let (storage, uniform) = (wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::UNIFORM);
        let dispatches = |bins: &mut dyn Iterator<Item = Range<u32>>| {
            let uniforms: Vec<_> = bins
                .map(|range| FamilyUniform {
                    begin: range.start,
                    end: range.end,
                    ..FamilyUniform::default()
                })
                .collect();
            let usage = storage | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC;
            let bytes = bytemuck::cast_slice(&uniforms);
            buffer("material dispatches", bytes, FAMILY_BYTES, usage)
        };
        let least = size_of::<MaterialUniform>() as u64;
        let materials = bytemuck::cast_slice(materials);
        let materials = buffer("materials by number", materials, least, storage);
        let stride = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let stride = u64::from(stride).max(4);
        let numbers: Vec<u8> = (0..families.count() as u32)
            .flat_map(|number| {
                let mut bytes = number.to_le_bytes().to_vec();
                bytes.resize(stride as usize, 0);
                bytes
            })
            .collect();
        let numbers = buffer("numbers of families", &numbers, stride, uniform);
        let groups = (0..).zip(&families.common).map(|(number, common)| {
            let pairs = common.slots.map(|slot| {
                let (array, sampler) = slot.unwrap_or((white.array, Sampler::default()));
                (textures.array(array), samplers.get(sampler))
            });
            let number = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &numbers,
                offset: number * stride,
                size: wgpu::BufferSize::new(4),
            });
            let mut resources = vec![materials.as_entire_binding(), number];
            for (view, sampler) in &pairs {
                resources.push(wgpu::BindingResource::TextureView(view));
                resources.push(wgpu::BindingResource::Sampler(sampler));
            }
            bind_group(&gpu.device, "material family", &layout, &resources)
        });
        let groups = groups.collect();
        Self {
            materials,
            groups,
            by_family: dispatches(&mut families.ranges.iter().cloned()),
            by_material: dispatches(&mut families.ranks.iter().map(|&rank| rank..rank + 1)),
        }
    }

    /// Replaces a material.
    pub(super) fn write(&self, gpu: &Gpu, number: usize, material: &MaterialUniform) {
        let offset = (number * size_of::<MaterialUniform>()) as u64;
        (gpu.queue).write_buffer(&self.materials, offset, bytemuck::bytes_of(material));
    }

    /// The layout is [`family_layout`].
    pub(crate) fn group(&self, family: u32) -> &wgpu::BindGroup {
        &self.groups[family as usize]
    }

    /// A [`FamilyUniform`] for each family, or for each material, whose counts are for binning to
    /// fill in.
    pub(crate) fn dispatches(&self, by: MaterialDispatch) -> &wgpu::Buffer {
        match by {
            MaterialDispatch::Family => &self.by_family,
            MaterialDispatch::Material => &self.by_material,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_of_a_family_follow_one_another_and_have_all_in_common_but_layers() {
        let slot = |array, layer, wrap| {
            let sampler = Sampler {
                wrap_u: wrap,
                ..Sampler::default()
            };
            let place = Place { array, layer };
            Some(Slot { place, sampler })
        };
        let (repeat, clamp) = (foveal_scene::Wrap::Repeat, foveal_scene::Wrap::ClampToEdge);
        let kinds = [
            (1, slot(0, 0, repeat)),
            (1, slot(0, 1, repeat)),
            (1, slot(1, 0, repeat)),
            (1, slot(0, 0, clamp)),
            (33, slot(0, 0, repeat)),
            (0, None),
        ];
        let same_family = [0, 0, 1, 2, 3, 4];
        let order: Vec<usize> = (0..60)
            .map(|i| i * 7 % 6 + i / 30 % 2)
            .map(|i| i % 6)
            .collect();
        let materials = order.iter().map(|&i| {
            (
                kinds[i].0,
                std::array::from_fn(|at| kinds[i].1.filter(|_| at == 0)),
            )
        });
        let families = Families::new(materials);
        assert_eq!(families.count(), 5);
        for (a, &i) in (0..).zip(&order) {
            for (b, &j) in (0..).zip(&order) {
                let same = families.of(a) == families.of(b);
                assert_eq!(same, same_family[i] == same_family[j]);
            }
        }
        let mut ranks = families.ranks().to_vec();
        for (material, &rank) in (0..).zip(&ranks) {
            assert!(families.ranges[families.of(material) as usize].contains(&rank));
        }
        ranks.sort_unstable();
        assert!(ranks.iter().copied().eq(0..60), "each has its own place");
        let mut end = 0;
        for range in &families.ranges {
            assert_eq!(range.start, end);
            end = range.end;
        }
        assert_eq!(end, 60);
    }
}
