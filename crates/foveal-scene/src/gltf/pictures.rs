//! Pictures: from a file's bytes to RGBA8 texels.
//!
//! Every decoder runs behind checks of what the header promises and behind a net for panics: a broken
//! picture must cost neither the scene nor the machine.

use std::borrow::Cow;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::Resolver;
use super::images::ImageSource;
use super::reader::Reader;
use super::uri::{self, Uri};
use crate::error::{Flaw, Parsed};

/// RGBA8 texels.
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<u8>,
}

/// The bytes of a picture's file.
pub(crate) fn fetch<'a>(
    image: Option<u32>,
    reader: Reader<'a>,
    resolver: &Resolver<'_>,
) -> Parsed<Cow<'a, [u8]>> {
    let Some(image) = image else {
        return Err(Flaw::new("a texture names no PNG or JPEG picture"));
    };
    match &reader.document.images[image as usize].source {
        ImageSource::View(view) => reader
            .buffers
            .view(reader.document, *view)
            .map(Cow::Borrowed),
        ImageSource::Uri(text) => {
            match uri::parse(text).map_err(|e| Flaw::new(format!("its URI {e}")))? {
                Uri::Data(bytes) => Ok(Cow::Owned(bytes)),
                Uri::File(path) => resolver(&path).map(Cow::Owned).map_err(Flaw::new),
            }
        }
        ImageSource::Nowhere => Err(Flaw::new("has neither a URI nor a buffer view")),
    }
}

fn open(bytes: &[u8]) -> Result<image::ImageReader<Cursor<&[u8]>>, String> {
    let mut reader = image::ImageReader::new(Cursor::new(bytes));
    // By content: declared MIME types are often wrong.
    let format = match bytes {
        [0x89, b'P', b'N', b'G', ..] => image::ImageFormat::Png,
        [0xFF, 0xD8, ..] => image::ImageFormat::Jpeg,
        _ => return Err("is neither PNG nor JPEG".to_owned()),
    };
    reader.set_format(format);
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(1 << 15);
    limits.max_image_height = Some(1 << 15);
    limits.max_alloc = Some(2 << 30);
    reader.limits(limits);
    Ok(reader)
}

/// Most texels that a byte of a file can stand for: one-bit PNG at deflate's best ratio.
const MAX_TEXELS_PER_BYTE: u64 = 8 * 1032;

/// The size that a picture's header promises, if its file is long enough to keep the promise.
pub(crate) fn promised_size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let read = || {
        open(bytes)?
            .into_dimensions()
            .map_err(|e| format!("cannot be decoded: {e}"))
    };
    let (width, height) = catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err("cannot be decoded: the decoder failed".to_owned()))?;
    if u64::from(width) * u64::from(height) > bytes.len() as u64 * MAX_TEXELS_PER_BYTE {
        return Err(format!(
            "promises {width} x {height} texels in {} bytes",
            bytes.len()
        ));
    }
    Ok((width, height))
}

/// Decodes a PNG or JPEG file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Picture, String> {
    promised_size(bytes)?;
    let decode = || -> Result<Picture, String> {
        let decoded = open(bytes)?
            .decode()
            .map_err(|e| format!("cannot be decoded: {e}"))?;
        let rgba = decoded.into_rgba8();
        Ok(Picture {
            width: rgba.width(),
            height: rgba.height(),
            pixels: rgba.into_raw(),
        })
    };
    // A last net: a decoder's panic on a broken picture must not take the scene with it.
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err("cannot be decoded: the decoder failed".to_owned()))
        .and_then(|p| {
            if p.width > 0 && p.height > 0 {
                Ok(p)
            } else {
                Err("has no texels".to_owned())
            }
        })
}
