//! Materials: factors, texture slots, and which of a mesh's UV sets they read.

use glam::{Mat3, Vec3, Vec4};

use super::budget::Budget;
use super::document::Counts;
use super::json::Obj;
use super::lobes::{self, KeptLobes};
use super::slots::{SlotDef, parse_slot, texture};
use crate::error::{Flaw, Parsed};
use crate::pose::{Factor, MaterialPart, TextureSlot, emission};
use crate::{AlphaMode, Code, Material, TextureRef};

/// A material whose texture slots are still numbers of the file.
pub(crate) struct MaterialDef {
    /// Everything but the textures below. Other textures are numbers of the file in it.
    pub(crate) material: Material,
    pub(crate) base_color: Option<SlotDef>,
    pub(crate) metallic_roughness: Option<SlotDef>,
    /// Of specular-glossiness: alpha of the texture above, times this factor, is the glossiness.
    pub(crate) glossiness: Option<f32>,
    pub(crate) normal: Option<SlotDef>,
    pub(crate) occlusion: Option<SlotDef>,
    pub(crate) emissive: Option<SlotDef>,
    /// The two factors of the material's emission.
    pub(crate) emissive_factor: Vec3,
    pub(crate) emissive_strength: f32,
    /// Lobes that stay although they show nothing at rest.
    kept: KeptLobes,
}

/// Memory of a material before and after its textures are known, in bytes.
const MATERIAL_BYTES: u64 = 2400;

/// Counts the memory of materials, which the file may write in three bytes each.
pub(crate) fn take_memory(materials: usize, budget: &Budget) -> Parsed<()> {
    let bytes = MATERIAL_BYTES.saturating_mul(materials as u64);
    let taken = budget.take(bytes, "materials");
    taken.map_err(|e| e.under("materials"))
}

/// The file's UV sets that a material reads, in the order of a vertex's two slots.
pub(crate) type UvSets = [Option<u32>; 2];

impl MaterialDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let slot = |of: Obj<'_>, key: &str| -> Parsed<Option<SlotDef>> {
            match of.object(key)? {
                Some(info) => parse_slot(info, counts).map(Some).map_err(|e| e.under(key)),
                None => Ok(None),
            }
        };
        let mut material = Material {
            name: o.string("name")?.unwrap_or_default().to_owned(),
            alpha_mode: parse_alpha(o)?,
            double_sided: o.boolean("doubleSided")?.unwrap_or(false),
            unlit: o.extension("KHR_materials_unlit")?.is_some(),
            ..Material::default()
        };
        let emissive_factor = o.floats("emissiveFactor")?.map_or(Vec3::ZERO, Vec3::from);
        let emissive_factor = emissive_factor.max(Vec3::ZERO);
        let mut emissive_strength = 1.0;
        if let Some(e) = o.extension("KHR_materials_emissive_strength")? {
            let strength = e
                .float("emissiveStrength")
                .map_err(|e| e.under("extensions.KHR_materials_emissive_strength"))?;
            emissive_strength = strength.unwrap_or(1.0).max(0.0);
        }
        material.emissive = emission(emissive_factor, emissive_strength);
        let (mut base_color, mut metallic_roughness, mut glossiness) = (None, None, None);
        let pbr = o.object("pbrMetallicRoughness")?;
        // Where a file has both this one counts, but its colour is not what is shown unlit.
        let old = o.extension("KHR_materials_pbrSpecularGlossiness")?;
        let old = old.filter(|_| !material.unlit || pbr.is_none());
        if let Some(old) = old {
            let within = |e: Flaw| e.under("extensions.KHR_materials_pbrSpecularGlossiness");
            let factor = read_glossiness(&mut material, old, counts).map_err(within)?;
            base_color = slot(old, "diffuseTexture").map_err(within)?;
            metallic_roughness = slot(old, "specularGlossinessTexture").map_err(within)?;
            glossiness = metallic_roughness.map(|_| factor);
            material.roughness = glossiness.map_or(1.0 - factor, |_| 1.0);
        } else if let Some(pbr) = pbr {
            let within = |e: Flaw| e.under("pbrMetallicRoughness");
            let factors = || -> Parsed<(Vec4, f32, f32)> {
                Ok((
                    pbr.floats("baseColorFactor")?.map_or(Vec4::ONE, Vec4::from),
                    pbr.float("metallicFactor")?.unwrap_or(1.0),
                    pbr.float("roughnessFactor")?.unwrap_or(1.0),
                ))
            };
            let (color, metallic, roughness) = factors().map_err(within)?;
            material.base_color = color.clamp(Vec4::ZERO, Vec4::ONE);
            material.metallic = metallic.clamp(0.0, 1.0);
            material.roughness = roughness.clamp(0.0, 1.0);
            base_color = slot(pbr, "baseColorTexture").map_err(within)?;
            metallic_roughness = slot(pbr, "metallicRoughnessTexture").map_err(within)?;
        }
        if let Some(normal) = o.object("normalTexture")? {
            let scale = normal.float("scale").map_err(|e| e.under("normalTexture"));
            material.normal_scale = scale?.unwrap_or(1.0);
        }
        if let Some(occlusion) = o.object("occlusionTexture")? {
            let strength = occlusion.float("strength");
            let strength = strength.map_err(|e| e.under("occlusionTexture"))?;
            material.occlusion_strength = strength.unwrap_or(1.0).clamp(0.0, 1.0);
        }
        if old.is_none() {
            read_specular(&mut material, o, counts)?;
        }
        if !material.unlit {
            lobes::read(&mut material, o, counts)?;
        }
        Ok(Self {
            material,
            base_color,
            metallic_roughness,
            glossiness,
            normal: slot(o, "normalTexture")?,
            occlusion: slot(o, "occlusionTexture")?,
            emissive: slot(o, "emissiveTexture")?,
            emissive_factor,
            emissive_strength,
            kept: KeptLobes::default(),
        })
    }

    /// Prepares for an animation that changes this part.
    pub(crate) fn animate(&mut self, part: MaterialPart) {
        let animated = &mut self.material.animated;
        match part {
            MaterialPart::Uv(..) => animated.uv_transforms = true,
            MaterialPart::Factor(Factor::Ior | Factor::Specular | Factor::SpecularColor) => {
                animated.specular = true;
            }
            MaterialPart::Factor(factor) => self.kept.add(factor),
        }
    }

    /// Leaves out lobes that never show anything. Follows the last [`Self::animate`].
    pub(crate) fn drop_unseen_lobes(&mut self) {
        lobes::drop_unseen(&mut self.material, self.kept);
    }

    /// The set of texture coordinates that tangents follow, and what becomes of them: of normals,
    /// else of the coat's normals, else of anisotropy; `None` where nothing needs tangents.
    pub(crate) fn tangent_uvs(&self) -> Option<(u32, Mat3)> {
        let normal = self.normal.map(|slot| (slot.set, slot.transform));
        let of = |slot: TextureRef| (slot.uv_set, slot.uv_transform);
        let coat = self.material.clearcoat.and_then(|coat| coat.normal_texture);
        let anisotropy = self.material.anisotropy.map(|found| {
            let first = (self.uv_sets().0[0].unwrap_or(0), Mat3::IDENTITY);
            found.texture.map_or(first, of)
        });
        normal.or(coat.map(of)).or(anisotropy)
    }

    /// The texture whose coordinates tangents follow, where it is one.
    pub(crate) fn tangent_slot(&self) -> Option<TextureSlot> {
        let coat = self.material.clearcoat.and_then(|coat| coat.normal_texture);
        let anisotropy = self.material.anisotropy.and_then(|found| found.texture);
        let normal = self.normal.map(|_| TextureSlot::Normal);
        normal
            .or(coat.map(|_| TextureSlot::ClearcoatNormal))
            .or(anisotropy.map(|_| TextureSlot::Anisotropy))
    }

    /// Whether it reads any texture, and so its coordinates.
    pub(crate) fn reads_uvs(&self) -> bool {
        self.texture_sets().next().is_some()
    }

    /// The set of texture coordinates of each texture, the most visible textures first.
    fn texture_sets(&self) -> impl Iterator<Item = u32> {
        let slots = [
            self.base_color,
            self.metallic_roughness,
            self.normal,
            self.occlusion,
            self.emissive,
        ];
        let further = further_textures(&self.material).into_iter().flatten();
        let slots = slots.into_iter().flatten().map(|slot| slot.set);
        slots.chain(further.map(|slot| slot.uv_set))
    }

    /// Maps the sets in use to the two slots, lowest set first; true when some did not fit.
    pub(crate) fn uv_sets(&self) -> (UvSets, bool) {
        // The most visible sets win where there are more than two.
        let mut kept: Vec<u32> = Vec::new();
        for set in self.texture_sets() {
            if !kept.contains(&set) {
                kept.push(set);
            }
        }
        if kept.is_empty() && self.material.anisotropy.is_some() {
            kept.push(0);
        }
        let overflow = kept.len() > 2;
        kept.truncate(2);
        kept.sort_unstable();
        ([kept.first().copied(), kept.get(1).copied()], overflow)
    }
}

/// The textures of extensions.
fn further_textures(material: &Material) -> Vec<Option<TextureRef>> {
    let specular = [material.specular_texture, material.specular_color_texture];
    specular
        .into_iter()
        .chain(material.lobe_textures())
        .collect()
}

/// KHR_materials_ior and KHR_materials_specular.
fn read_specular(material: &mut Material, o: Obj<'_>, counts: &Counts) -> Parsed<()> {
    if let Some(e) = o.extension("KHR_materials_ior")? {
        let within = |e: Flaw| e.under("extensions.KHR_materials_ior");
        let ior = e.float("ior").map_err(within)?.unwrap_or(material.ior);
        material.ior = Material::usable_ior(ior);
    }
    if let Some(e) = o.extension("KHR_materials_specular")? {
        let within = |e: Flaw| e.under("extensions.KHR_materials_specular");
        let strength = e.float("specularFactor").map_err(within)?;
        material.specular = strength.unwrap_or(1.0).clamp(0.0, 1.0);
        let color = e.floats("specularColorFactor").map_err(within)?;
        material.specular_color = color.map_or(Vec3::ONE, Vec3::from).max(Vec3::ZERO);
        material.specular_texture = texture(e, "specularTexture", counts).map_err(within)?;
        material.specular_color_texture =
            texture(e, "specularColorTexture", counts).map_err(within)?;
    }
    Ok(())
}

/// KHR_materials_pbrSpecularGlossiness, as a dielectric whose reflectance at right angles is the
/// specular colour: its index of refraction reflects everything. Gives the factor of glossiness.
fn read_glossiness(material: &mut Material, o: Obj<'_>, counts: &Counts) -> Parsed<f32> {
    let diffuse = o.floats("diffuseFactor")?.map_or(Vec4::ONE, Vec4::from);
    material.base_color = diffuse.clamp(Vec4::ZERO, Vec4::ONE);
    material.metallic = 0.0;
    material.ior = 0.0;
    let color = o.floats("specularFactor")?.map_or(Vec3::ONE, Vec3::from);
    material.specular_color = color.clamp(Vec3::ZERO, Vec3::ONE);
    material.specular_color_texture = texture(o, "specularGlossinessTexture", counts)?;
    Ok(o.float("glossinessFactor")?.unwrap_or(1.0).clamp(0.0, 1.0))
}

/// The sets that a primitive without a material carries along.
pub(crate) const DEFAULT_UV_SETS: UvSets = [Some(0), None];

fn parse_alpha(o: Obj<'_>) -> Parsed<AlphaMode> {
    Ok(match o.string("alphaMode")? {
        None | Some("OPAQUE") => AlphaMode::Opaque,
        Some("BLEND") => AlphaMode::Blend,
        Some("MASK") => AlphaMode::Mask {
            cutoff: o.float("alphaCutoff")?.unwrap_or(0.5),
        },
        Some(other) => {
            return Err(Flaw::new(
                Code::ValueUnknown,
                format!("\"{other}\" is not an alpha mode"),
            )
            .under("alphaMode"));
        }
    })
}
