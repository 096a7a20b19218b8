//! Places of materials for textures: which texture, and where it is read.

use glam::{Mat3, Vec3};

use super::document::Counts;
use super::json::Obj;
use crate::TextureRef;
use crate::error::{Flaw, Parsed};

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
        slot.transform = parse_transform(e).map_err(within)?;
    }
    Ok(slot)
}

fn parse_set(o: Obj<'_>) -> Parsed<Option<u32>> {
    Ok(o.uint("texCoord")?
        .map(|s| s.min(u64::from(u32::MAX)) as u32))
}

/// KHR_texture_transform: offset · rotation · scale.
///
/// The rotation is counter-clockwise as seen with v upwards. glTF's v points down, so the angle
/// is negated; so do the reference viewer and the other engines, against the letter of the
/// extension's GLSL.
fn parse_transform(o: Obj<'_>) -> Parsed<Mat3> {
    let [x, y] = o.floats("offset")?.unwrap_or([0.0, 0.0]);
    let [sx, sy] = o.floats("scale")?.unwrap_or([1.0, 1.0]);
    let (sin, cos) = o.float("rotation")?.unwrap_or(0.0).sin_cos();
    Ok(Mat3::from_cols(
        Vec3::new(cos * sx, -sin * sx, 0.0),
        Vec3::new(sin * sy, cos * sy, 0.0),
        Vec3::new(x, y, 1.0),
    ))
}
