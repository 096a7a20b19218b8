//! Lobes of materials: KHR_materials_clearcoat, KHR_materials_sheen, KHR_materials_anisotropy.

use glam::Vec3;

use super::document::Counts;
use super::json::Obj;
use super::materials::texture;
use crate::error::{Flaw, Parsed};
use crate::{Anisotropy, Clearcoat, Material, Sheen};

/// Reads a material's lobes, with the file's numbers of textures. Lobes that show nothing are left
/// out.
pub(crate) fn read(material: &mut Material, o: Obj<'_>, counts: &Counts) -> Parsed<()> {
    let within = |name: &'static str| move |e: Flaw| e.under(format_args!("extensions.{name}"));
    if let Some(e) = o.extension("KHR_materials_clearcoat")? {
        let coat = clearcoat(e, counts).map_err(within("KHR_materials_clearcoat"))?;
        material.clearcoat = Some(coat).filter(|coat| coat.factor > 0.0);
    }
    if let Some(e) = o.extension("KHR_materials_sheen")? {
        let sheen = sheen(e, counts).map_err(within("KHR_materials_sheen"))?;
        material.sheen = Some(sheen).filter(|sheen| sheen.color != Vec3::ZERO);
    }
    if let Some(e) = o.extension("KHR_materials_anisotropy")? {
        let found = anisotropy(e, counts).map_err(within("KHR_materials_anisotropy"))?;
        material.anisotropy = Some(found).filter(|found| found.strength > 0.0);
    }
    Ok(())
}

fn part(o: Obj<'_>, key: &str) -> Parsed<f32> {
    Ok(o.float(key)?.unwrap_or(0.0).clamp(0.0, 1.0))
}

fn clearcoat(o: Obj<'_>, counts: &Counts) -> Parsed<Clearcoat> {
    let normal = o.object("clearcoatNormalTexture")?;
    let scale = normal.map(|normal| normal.float("scale")).transpose()?;
    Ok(Clearcoat {
        factor: part(o, "clearcoatFactor")?,
        texture: texture(o, "clearcoatTexture", counts)?,
        roughness: part(o, "clearcoatRoughnessFactor")?,
        roughness_texture: texture(o, "clearcoatRoughnessTexture", counts)?,
        normal_texture: texture(o, "clearcoatNormalTexture", counts)?,
        normal_scale: scale.flatten().unwrap_or(1.0),
    })
}

fn sheen(o: Obj<'_>, counts: &Counts) -> Parsed<Sheen> {
    let color = o.floats("sheenColorFactor")?.map_or(Vec3::ZERO, Vec3::from);
    Ok(Sheen {
        color: color.clamp(Vec3::ZERO, Vec3::ONE),
        color_texture: texture(o, "sheenColorTexture", counts)?,
        roughness: part(o, "sheenRoughnessFactor")?,
        roughness_texture: texture(o, "sheenRoughnessTexture", counts)?,
    })
}

fn anisotropy(o: Obj<'_>, counts: &Counts) -> Parsed<Anisotropy> {
    Ok(Anisotropy {
        strength: part(o, "anisotropyStrength")?,
        rotation_rad: o.float("anisotropyRotation")?.unwrap_or(0.0),
        texture: texture(o, "anisotropyTexture", counts)?,
    })
}
