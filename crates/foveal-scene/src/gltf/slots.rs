//! Places of materials for textures: which texture, and where it is read.

use glam::{Mat3, Vec2};

use super::document::Counts;
use super::json::Obj;
use crate::TextureRef;
use crate::error::{Flaw, Parsed};
use crate::pose::UvTransform;

/// A texture as a material slot names it, with the file's own UV set number.
#[derive(Clone, Copy)]
pub(crate) struct SlotDef {
    pub(crate) texture: u32,
    pub(crate) set: u32,
    pub(crate) transform: Mat3,
}

/// A texture of an extension, with the file's numbers.
pub(super) fn texture(o: Obj<'_>, key: &str, counts: &Counts) -> Parsed<Option<TextureRef>> {
    let Some(info) = o.object(key)? else {
        return Ok(None);
    };
    let slot = parse_slot(info, counts).map_err(|e| e.under(key))?;
    Ok(Some(TextureRef {
        texture: slot.texture,
        uv_set: slot.set,
        uv_transform: slot.transform,
    }))
}

/// A texture, with the file's numbers.
pub(super) fn parse_slot(o: Obj<'_>, counts: &Counts) -> Parsed<SlotDef> {
    let mut slot = SlotDef {
        texture: o.need("index", o.index("index", counts.textures)?)?,
        set: parse_set(o)?.unwrap_or(0),
        transform: Mat3::IDENTITY,
    };
    if let Some(e) = o.extension("KHR_texture_transform")? {
        let within = |e: Flaw| e.under("extensions.KHR_texture_transform");
        slot.set = parse_set(e).map_err(within)?.unwrap_or(slot.set);
        slot.transform = parse_transform(e).map_err(within)?.matrix();
    }
    Ok(slot)
}

fn parse_set(o: Obj<'_>) -> Parsed<Option<u32>> {
    Ok(o.uint("texCoord")?
        .map(|s| s.min(u64::from(u32::MAX)) as u32))
}

/// KHR_texture_transform.
pub(super) fn parse_transform(o: Obj<'_>) -> Parsed<UvTransform> {
    Ok(UvTransform {
        offset: o.floats("offset")?.map_or(Vec2::ZERO, Vec2::from),
        rotation_rad: o.float("rotation")?.unwrap_or(0.0),
        scale: o.floats("scale")?.map_or(Vec2::ONE, Vec2::from),
    })
}
