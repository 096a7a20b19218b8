//! Lobes of materials: KHR_materials_clearcoat, KHR_materials_sheen, KHR_materials_anisotropy,
//! KHR_materials_iridescence, KHR_materials_transmission with KHR_materials_volume.

use glam::Vec3;

use super::document::Counts;
use super::json::Obj;
use super::slots::texture;
use crate::error::{Flaw, Parsed};
use crate::pose::Factor;
use crate::{Anisotropy, Clearcoat, Iridescence, Material, Sheen, Transmission};

/// Lobes that stay although they show nothing at rest: animations change how much of them there is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct KeptLobes {
    clearcoat: bool,
    sheen: bool,
    anisotropy: bool,
    iridescence: bool,
    transmission: bool,
}

impl KeptLobes {
    /// Keeps what a factor that is animated may show.
    pub(super) fn add(&mut self, factor: Factor) {
        match factor {
            Factor::Clearcoat => self.clearcoat = true,
            Factor::SheenColor => self.sheen = true,
            Factor::Anisotropy => self.anisotropy = true,
            Factor::Iridescence => self.iridescence = true,
            Factor::Transmission => self.transmission = true,
            _ => {}
        }
    }
}

/// Leaves out lobes that show nothing, and that are not kept.
pub(super) fn drop_unseen(material: &mut Material, kept: KeptLobes) {
    let coat = material.clearcoat;
    material.clearcoat = coat.filter(|coat| coat.factor > 0.0 || kept.clearcoat);
    let sheen = material.sheen;
    material.sheen = sheen.filter(|sheen| sheen.color != Vec3::ZERO || kept.sheen);
    let anisotropy = material.anisotropy;
    material.anisotropy = anisotropy.filter(|found| found.strength > 0.0 || kept.anisotropy);
    let film = material.iridescence;
    material.iridescence = film.filter(|film| film.factor > 0.0 || kept.iridescence);
    let transmission = material.transmission;
    material.transmission = transmission.filter(|found| found.factor > 0.0 || kept.transmission);
}

/// Reads a material's lobes, with the file's numbers of textures.
pub(crate) fn read(material: &mut Material, o: Obj<'_>, counts: &Counts) -> Parsed<()> {
    let within = |name: &'static str| move |e: Flaw| e.under(format_args!("extensions.{name}"));
    if let Some(e) = o.extension("KHR_materials_clearcoat")? {
        let coat = clearcoat(e, counts).map_err(within("KHR_materials_clearcoat"))?;
        material.clearcoat = Some(coat);
    }
    if let Some(e) = o.extension("KHR_materials_sheen")? {
        let sheen = sheen(e, counts).map_err(within("KHR_materials_sheen"))?;
        material.sheen = Some(sheen);
    }
    if let Some(e) = o.extension("KHR_materials_anisotropy")? {
        let found = anisotropy(e, counts).map_err(within("KHR_materials_anisotropy"))?;
        material.anisotropy = Some(found);
    }
    if let Some(e) = o.extension("KHR_materials_iridescence")? {
        let film = iridescence(e, counts).map_err(within("KHR_materials_iridescence"))?;
        material.iridescence = Some(film);
    }
    if let Some(e) = o.extension("KHR_materials_transmission")? {
        let found = transmission(e, counts).map_err(within("KHR_materials_transmission"))?;
        material.transmission = Some(found);
    }
    // Without transmission nothing is seen of the volume.
    if let (Some(e), Some(found)) = (
        o.extension("KHR_materials_volume")?,
        &mut material.transmission,
    ) {
        volume(found, e, counts).map_err(within("KHR_materials_volume"))?;
    }
    Ok(())
}

fn part(o: Obj<'_>, key: &str) -> Parsed<f32> {
    Ok(o.float(key)?.unwrap_or(0.0).clamp(0.0, 1.0))
}

fn clearcoat(o: Obj<'_>, counts: &Counts) -> Parsed<Clearcoat> {
    let normal = o.object("clearcoatNormalTexture")?;
    let scale = normal.map(|normal| normal.float("scale")).transpose();
    let scale = scale.map_err(|e| e.under("clearcoatNormalTexture"))?;
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

fn iridescence(o: Obj<'_>, counts: &Counts) -> Parsed<Iridescence> {
    let thickness =
        |key: &str, default: f32| -> Parsed<f32> { Ok(o.float(key)?.unwrap_or(default).max(0.0)) };
    Ok(Iridescence {
        factor: part(o, "iridescenceFactor")?,
        texture: texture(o, "iridescenceTexture", counts)?,
        ior: o.float("iridescenceIor")?.unwrap_or(1.3).max(1.0),
        thickness_min_nm: thickness("iridescenceThicknessMinimum", 100.0)?,
        thickness_max_nm: thickness("iridescenceThicknessMaximum", 400.0)?,
        thickness_texture: texture(o, "iridescenceThicknessTexture", counts)?,
    })
}

fn transmission(o: Obj<'_>, counts: &Counts) -> Parsed<Transmission> {
    Ok(Transmission {
        factor: part(o, "transmissionFactor")?,
        texture: texture(o, "transmissionTexture", counts)?,
        thickness_m: 0.0,
        thickness_texture: None,
        attenuation_distance_m: f32::INFINITY,
        attenuation_color: Vec3::ONE,
    })
}

fn volume(found: &mut Transmission, o: Obj<'_>, counts: &Counts) -> Parsed<()> {
    found.thickness_m = o.float("thicknessFactor")?.unwrap_or(0.0).max(0.0);
    found.thickness_texture = texture(o, "thicknessTexture", counts)?;
    let distance = o.float("attenuationDistance")?.filter(|&d| d > 0.0);
    found.attenuation_distance_m = distance.unwrap_or(f32::INFINITY);
    let color = o.floats("attenuationColor")?.map_or(Vec3::ONE, Vec3::from);
    found.attenuation_color = color.clamp(Vec3::ZERO, Vec3::ONE);
    Ok(())
}
