//! Pictures: from a file's bytes to RGBA8 texels.
//!
//! Every decoder runs behind checks of what the header promises and behind a net for panics: a
//! broken picture must cost neither the scene nor the machine.

use std::borrow::Cow;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use image::{DynamicImage, ImageDecoder, ImageFormat};

use super::Resolver;
use super::basis;
use super::images::ImageSource;
use super::reader::Reader;
use super::uri::{self, Uri};
use crate::Code;
use crate::error::{Flaw, Parsed};
#[cfg(not(target_arch = "wasm32"))]
use crate::{Encoding, mip};

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
        return Err(Flaw::new(
            Code::TextureWithoutImage,
            "a texture names no PNG, JPEG, WebP or KTX2 picture",
        ));
    };
    match &reader.document.images[image as usize].source {
        ImageSource::View(view) => reader
            .buffers
            .view(reader.document, *view)
            .map(Cow::Borrowed),
        ImageSource::Uri(text) => {
            match uri::parse(text)
                .map_err(|e| Flaw::new(Code::ImageUnreadable, format!("its URI {e}")))?
            {
                Uri::Data(bytes) => Ok(Cow::Owned(bytes)),
                Uri::File(path) => resolver(&path)
                    .map(Cow::Owned)
                    .map_err(|e| Flaw::new(Code::ImageUnreadable, e)),
            }
        }
        ImageSource::Nowhere => Err(Flaw::new(
            Code::ImageUnreadable,
            "has neither a URI nor a buffer view",
        )),
    }
}

/// Which decoder a file needs, by its content: declared MIME types are often wrong.
fn format_of(bytes: &[u8]) -> Result<ImageFormat, String> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Ok(ImageFormat::Png),
        [0xFF, 0xD8, ..] => Ok(ImageFormat::Jpeg),
        [
            b'R',
            b'I',
            b'F',
            b'F',
            _,
            _,
            _,
            _,
            b'W',
            b'E',
            b'B',
            b'P',
            ..,
        ] => Ok(ImageFormat::WebP),
        [0xAB, b'K', b'T', b'X', ..] => {
            Err("is a KTX texture of version 1, which glTF does not have".to_owned())
        }
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', ..] => Err(
            "is an AVIF picture, which is not read; `gltf-transform png` turns it into PNG"
                .to_owned(),
        ),
        _ => Err("is neither PNG nor JPEG nor WebP nor KTX2".to_owned()),
    }
}

/// A decoder that has read the header, and may take `max_alloc` bytes beside its output.
fn open(bytes: &[u8], max_alloc: u64) -> Result<impl ImageDecoder + '_, String> {
    let mut reader = image::ImageReader::new(Cursor::new(bytes));
    reader.set_format(format_of(bytes)?);
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(1 << 16);
    limits.max_image_height = Some(1 << 16);
    limits.max_alloc = Some(max_alloc);
    reader.limits(limits);
    reader.into_decoder().map_err(|e| undecodable(&e))
}

fn undecodable(cause: &image::ImageError) -> String {
    format!("cannot be decoded: {cause}")
}

/// A decoder's panic on a broken picture must not take the scene with it.
fn netted<T>(f: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(f))
        .unwrap_or_else(|_| Err("cannot be decoded: the decoder failed".to_owned()))
}

/// Most texels that a byte of a PNG file can stand for: one bit each at deflate's best ratio.
const MAX_TEXELS_PER_BYTE: u64 = 8 * 1032;

/// What a decoder may allocate to read a header.
const HEADER_BYTES: u64 = 16 << 20;

/// What a picture's header says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Promise {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Of the decoder's own output, per texel.
    bytes_per_texel: u8,
}

impl Promise {
    pub(crate) fn texels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Memory at the peak of decoding and of making mip levels, beside the picture as RGBA8.
    pub(crate) fn decoding_bytes(self) -> u64 {
        // The decoder's own output; later two levels with 16 bits a channel.
        self.texels() * u64::from(self.bytes_per_texel.max(3))
    }

    /// Memory of the whole picture as RGBA8.
    pub(crate) fn rgba_bytes(self) -> u64 {
        self.texels() * 4
    }
}

/// Reads a picture's header. An error if the file is too short to keep its promise.
pub(crate) fn promise(bytes: &[u8]) -> Result<Promise, String> {
    netted(|| {
        if basis::is_ktx2(bytes) {
            let (width, height) = basis::size(bytes)?;
            // Blocks take a byte a texel.
            let bytes_per_texel = 1;
            return Ok(Promise {
                width,
                height,
                bytes_per_texel,
            });
        }
        let decoder = open(bytes, HEADER_BYTES)?;
        let (width, height) = decoder.dimensions();
        let promise = Promise {
            width,
            height,
            bytes_per_texel: decoder.color_type().bytes_per_pixel(),
        };
        // Other formats say a plain picture in fewer bytes; what they take is counted like all
        // else.
        let is_png = format_of(bytes) == Ok(ImageFormat::Png);
        if is_png && promise.texels() > bytes.len() as u64 * MAX_TEXELS_PER_BYTE {
            return Err(format!(
                "promises {width} x {height} texels in {} bytes",
                bytes.len()
            ));
        }
        if promise.texels() == 0 {
            return Err("has no texels".to_owned());
        }
        Ok(promise)
    })
}

/// The mip levels of a KTX2 file whose header is known, as blocks of BC7 and without going through
/// texels. `None` for other files, where the picture's size is not one of whole blocks, and where the
/// file lacks levels that are wanted: `all`, or else the first.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn blocks(
    bytes: &[u8],
    promise: Promise,
    all: bool,
) -> Option<Result<Vec<Vec<u8>>, String>> {
    let size = (promise.width, promise.height);
    if !basis::is_ktx2(bytes) || !Encoding::Bc7.fits(size.0, size.1) {
        return None;
    }
    let count = if all {
        mip::level_count(size.0, size.1)
    } else {
        1
    };
    if basis::level_count(bytes, size) < count {
        return None;
    }
    Some(netted(|| {
        let levels = basis::blocks(bytes, count)?;
        let needed = |level: u32| {
            let side = |size: u32| (size >> level).max(1);
            Encoding::Bc7.level_bytes(side(size.0), side(size.1))
        };
        if (0..)
            .zip(&levels)
            .any(|(k, level)| level.len() as u64 != needed(k))
        {
            return Err("has another size than its header says".to_owned());
        }
        Ok(levels)
    }))
}

/// Decodes a file whose header is known.
pub(crate) fn decode(bytes: &[u8], promise: Promise) -> Result<Picture, String> {
    netted(|| {
        let Promise { width, height, .. } = promise;
        if basis::is_ktx2(bytes) {
            let pixels = basis::decode(bytes)?;
            if pixels.len() as u64 != promise.rgba_bytes() {
                return Err("has another size than its header says".to_owned());
            }
            return Ok(Picture {
                width,
                height,
                pixels,
            });
        }
        let room = promise.decoding_bytes() + promise.rgba_bytes() + HEADER_BYTES;
        let decoded =
            DynamicImage::from_decoder(open(bytes, room)?).map_err(|e| undecodable(&e))?;
        let rgba = decoded.into_rgba8();
        if rgba.dimensions() != (width, height) {
            return Err("has another size than its header says".to_owned());
        }
        Ok(Picture {
            width,
            height,
            pixels: rgba.into_raw(),
        })
    })
}
