//! KTX2 files that hold Basis Universal textures (KHR_texture_basisu) as RGBA8 texels, or as blocks
//! that devices read.
//!
//! The transcoder trusts lengths that the file states, so all that it allocates by is checked here
//! first, and Zstandard is undone here, within bounds: Khronos, 'KTX File Format Specification 2.0',
//! sections 3 (header, level index) and 5 (data format descriptor). Of the file's mip levels the
//! first is read; as blocks, all of them.

#[cfg(not(target_arch = "wasm32"))]
use crate::mip;

/// `KHR_DF_MODEL_ETC1S` and `KHR_DF_MODEL_UASTC`.
const ETC1S: u32 = 163;
const UASTC: u32 = 166;
/// Schemes of supercompression.
const NONE: u32 = 0;
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;

/// Whether a file is a KTX2 file, whatever it holds.
pub(crate) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xABKTX 20\xBB\r\n\x1A\n")
}

/// Width and height of the picture in a KTX2 file. An error where the file holds another thing
/// than one Basis Universal picture, or is too short for what it states.
pub(crate) fn size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let word = |at: usize| -> Result<u32, String> {
        let word = bytes.get(at..).and_then(<[u8]>::first_chunk);
        word.map(|w| u32::from_le_bytes(*w)).ok_or_else(cut_off)
    };
    let long = |at: usize| Ok::<_, String>(u64::from(word(at)?) | u64::from(word(at + 4)?) << 32);
    let [format, width, height, depth, layers, faces] = {
        let mut words = [0; 6];
        for (field, at) in words.iter_mut().zip([12, 20, 24, 28, 32, 36]) {
            *field = word(at)?;
        }
        words
    };
    if depth > 0 || layers > 1 || faces != 1 {
        return Err("is a KTX2 texture of several pictures, not of one".to_owned());
    }
    if width == 0 || height == 0 || width.max(height) > 1 << 16 {
        return Err(format!("is a KTX2 texture of {width} x {height} texels"));
    }
    let (levels, scheme) = (word(40)?, word(44)?);
    let descriptor = word(48)? as usize;
    let model = word(descriptor.saturating_add(12))? & 0xFF;
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    let (offset, length, unpacked) = (long(80)?, long(88)?, long(96)?);
    // The first level's entry lies before everything else.
    if levels == 0 || offset.saturating_add(length) > bytes.len() as u64 {
        return Err(cut_off());
    }
    let stated = match (format, model, scheme) {
        (0, ETC1S, BASIS_LZ) => 0,
        (0, UASTC, NONE | ZSTANDARD) => 16 * blocks,
        _ => {
            return Err(format!(
                "is a KTX2 texture of format {format}, colour model {model}, scheme {scheme}, \
                 not of Basis Universal's (ETC1S or UASTC)"
            ));
        }
    };
    let packed = if scheme == NONE { length } else { unpacked };
    if packed != stated {
        return Err(format!(
            "is a KTX2 texture whose first level has {packed} bytes, not {stated}"
        ));
    }
    Ok((width, height))
}

/// How many mip levels a file of this [`size`] has, where each is what its size needs; else 1, which
/// [`size`] has checked.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn level_count(bytes: &[u8], (width, height): (u32, u32)) -> u32 {
    let word = |at: usize| {
        let word = bytes.get(at..).and_then(<[u8]>::first_chunk);
        word.map_or(0, |w| u32::from_le_bytes(*w))
    };
    let long = |at: usize| u64::from(word(at)) | u64::from(word(at + 4)) << 32;
    let (stated, scheme) = (word(40), word(44));
    let is_whole = |level: u32| {
        let at = 80 + 24 * level as usize;
        let (offset, length, unpacked) = (long(at), long(at + 8), long(at + 16));
        let blocks = |size: u32| u64::from((size >> level).max(1).div_ceil(4));
        let needed = 16 * blocks(width) * blocks(height);
        let fits = match scheme {
            BASIS_LZ => unpacked == 0,
            ZSTANDARD => unpacked == needed,
            _ => length == needed,
        };
        fits && offset.saturating_add(length) <= bytes.len() as u64
    };
    if stated <= mip::level_count(width, height) && (0..stated).all(is_whole) {
        stated.max(1)
    } else {
        1
    }
}

fn cut_off() -> String {
    "is a KTX2 texture that is cut off".to_owned()
}

/// The texels of a file whose [`size`] is known.
#[cfg(target_arch = "wasm32")]
pub(crate) fn decode(_: &[u8]) -> Result<Vec<u8>, String> {
    Err(
        "is a KTX2 texture, which is not read in browsers; `gltf-transform ktxdecompress` turns it \
         into PNG"
            .to_owned(),
    )
}

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use native::{blocks, decode};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::borrow::Cow;
    use std::io::Read;

    use basisu::{DecodeFlags, TargetFormat, Transcoder};
    use ruzstd::decoding::StreamingDecoder;

    use super::{NONE, ZSTANDARD};
    use crate::blocks::make_opaque;

    /// The texels of a file whose [`size`](super::size) is known.
    pub(crate) fn decode(bytes: &[u8]) -> Result<Vec<u8>, String> {
        let levels = transcode(bytes, 1, TargetFormat::Rgba32, DecodeFlags::NONE);
        levels
            .and_then(|levels| levels.into_iter().next())
            .ok_or_else(broken)
    }

    /// The first `count` mip levels as blocks of BC7, of a file that has so many by
    /// [`level_count`](super::level_count).
    pub(crate) fn blocks(bytes: &[u8], count: u32) -> Result<Vec<Vec<u8>>, String> {
        let to = TargetFormat::Bc7Rgba;
        // As the texels are, which are not smoothed either.
        let flags = DecodeFlags::NO_ETC1S_CHROMA_FILTERING;
        let mut levels = transcode(bytes, count, to, flags).ok_or_else(broken)?;
        for level in &mut levels {
            make_opaque(level);
        }
        Ok(levels)
    }

    fn broken() -> String {
        "is a KTX2 texture that cannot be decoded".to_owned()
    }

    fn transcode(
        bytes: &[u8],
        count: u32,
        to: TargetFormat,
        flags: DecodeFlags,
    ) -> Option<Vec<Vec<u8>>> {
        let plain = match bytes.get(44) {
            Some(&scheme) if u32::from(scheme) == ZSTANDARD => Cow::Owned(unpacked(bytes, count)?),
            _ => Cow::Borrowed(bytes),
        };
        let transcoder = Transcoder::new(&plain).ok()?;
        let levels = (0..count).map(|level| transcoder.transcode(level, to, flags));
        levels.collect::<Result<_, _>>().ok()
    }

    /// The largest window that decoders ought to support (RFC 8878, section 3.1.1.1.2).
    const MOST_WINDOW: u64 = 8 << 20;

    /// The same file without Zstandard in its first `count` levels; `None` where one is not what it
    /// states. What is decoded at a time is bounded by the window, and the whole by what
    /// [`size`](super::size) and [`level_count`](super::level_count) have checked.
    fn unpacked(bytes: &[u8], count: u32) -> Option<Vec<u8>> {
        let long = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
        let entries = (80..).step_by(24).take(count as usize);
        let mut wants = entries.clone().map(|entry| long(entry + 16));
        let wanted = wants.try_fold(0, |sum: usize, want| sum.checked_add(want?))?;
        let mut file = Vec::new();
        // All at once and no more: a vector that grows takes up to twice as much.
        (file.try_reserve_exact(bytes.len().checked_add(wanted)?)).ok()?;
        file.extend_from_slice(bytes);
        file[44..48].copy_from_slice(&NONE.to_le_bytes());
        for entry in entries {
            let (offset, length, want) = (long(entry)?, long(entry + 8)?, long(entry + 16)?);
            let packed = bytes.get(offset..offset.checked_add(length)?)?;
            let window = (want as u64).max(MOST_WINDOW);
            let mut decoder = StreamingDecoder::new_with_max_window_size(packed, window).ok()?;
            let at = file.len();
            file[entry..entry + 8].copy_from_slice(&(at as u64).to_le_bytes());
            file[entry + 8..entry + 16].copy_from_slice(&(want as u64).to_le_bytes());
            file.resize(at.checked_add(want)?, 0);
            decoder.read_exact(&mut file[at..]).ok()?;
            if decoder.read(&mut [0]).ok()? != 0 {
                return None;
            }
        }
        Some(file)
    }
}
