//! PNG files in and out, 8 bits per channel.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use anyhow::{Context, bail};
use image::{ColorType, DynamicImage, ImageDecoder, ImageReader, Limits, RgbaImage};

use crate::failure::usage;
use crate::linear_picture::PictureFormat;

/// Most bytes of a decoded picture: twice those of 16384 x 16384 pixels of 16-bit RGBA.
const MAX_DECODED: u64 = 4 << 30;

/// A picture: sRGB RGBA8 rows, top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// `width * height` pixels.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// From bytes as the renderer gives them.
    pub fn from_rgba(width: u32, height: u32, bytes: Vec<u8>) -> anyhow::Result<Self> {
        if bytes.len() as u64 != 4 * u64::from(width) * u64::from(height) {
            bail!(
                "a picture of {width}x{height} pixels came back with {} bytes",
                bytes.len()
            );
        }
        // The same memory, unless room is left over at its end.
        let pixels = bytemuck::allocation::try_cast_vec(bytes)
            .unwrap_or_else(|(_, bytes)| bytes.as_chunks::<4>().0.to_vec());
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Reads a PNG file; 16-bit channels are rounded to 8 bits, grey becomes RGB, a missing alpha
    /// is 255.
    ///
    /// # Errors
    /// Where it cannot be read, holds linear values, or takes more than 4 GiB.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let read = || -> anyhow::Result<Self> {
            let found = path.metadata()?;
            if found.is_dir() {
                bail!("it is a folder");
            }
            // A pipe or a device could keep us waiting.
            if !found.is_file() {
                bail!("it is not a regular file");
            }
            let decoded = decode(path)?;
            let (width, height) = decoded.dimensions();
            Self::from_rgba(width, height, decoded.into_raw())
        };
        read().with_context(|| format!("cannot read the picture '{}'", path.display()))
    }

    /// Red, green, blue of each pixel.
    pub fn rgb_bytes(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|&[r, g, b, _]| [r, g, b])
            .collect()
    }

    /// The picture without its alpha as an RGB PNG.
    pub fn png(&self) -> anyhow::Result<Vec<u8>> {
        let mut png = Vec::new();
        self.encode(&mut png)?;
        Ok(png)
    }

    /// Writes the picture without its alpha as an RGB PNG, whole or not at all.
    pub fn write_rgb(&self, path: &Path) -> anyhow::Result<()> {
        crate::atomic_file::write_with(path, |to| self.encode(to))
    }

    fn encode(&self, to: impl Write) -> io::Result<()> {
        let row_of = |row: &mut Vec<u8>, y: usize| {
            let width = self.width as usize;
            let pixels = &self.pixels[y * width..(y + 1) * width];
            row.extend(pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]));
        };
        encode(to, self.width, self.height, row_of)
    }
}

fn decode(path: &Path) -> anyhow::Result<RgbaImage> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED);
    let mut reader = ImageReader::open(path)?.with_guessed_format()?;
    reader.limits(limits);
    let format = reader.format();
    let decoder = reader.into_decoder()?;
    if matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F) {
        let name = format.and_then(|format| format.extensions_str().first());
        let name = name.map_or_else(String::new, |name| name.to_uppercase());
        bail!("it is an {name} file of linear values; a PNG file of display values is wanted");
    }
    let bytes = decoder.total_bytes();
    if bytes > MAX_DECODED {
        let [has, most] = [bytes, MAX_DECODED].map(|bytes| bytes >> 20);
        bail!("it takes {has} MiB decoded; the limit is {most} MiB");
    }
    Ok(DynamicImage::from_decoder(decoder)?.into_rgba8())
}

/// Refuses a name that promises another format than PNG.
///
/// # Errors
/// Names the file.
pub fn check_name(path: &Path) -> anyhow::Result<()> {
    match PictureFormat::of(path) {
        Some(PictureFormat::Png) => Ok(()),
        _ => usage(format!(
            "'{}' must end in .png: pictures are written as PNG",
            path.display()
        )),
    }
}

/// Writes RGB8 rows as a PNG, whole or not at all.
pub fn write_rgb(path: &Path, width: u32, height: u32, rgb: &[u8]) -> anyhow::Result<()> {
    let row_of = |row: &mut Vec<u8>, y: usize| {
        let length = 3 * width as usize;
        row.extend_from_slice(&rgb[y * length..(y + 1) * length]);
    };
    crate::atomic_file::write_with(path, |to| encode(to, width, height, row_of))
}

/// Encodes row by row: nothing of the size of the picture is held besides it.
fn encode(
    to: impl Write,
    width: u32,
    height: u32,
    row_of: impl Fn(&mut Vec<u8>, usize),
) -> io::Result<()> {
    const BUFFER: usize = 1 << 16;
    let mut encoder = png::Encoder::new(BufWriter::with_capacity(BUFFER, to), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    let mut rows = writer.stream_writer_with_size(BUFFER)?;
    let mut row = Vec::with_capacity(3 * width as usize);
    for y in 0..height as usize {
        row.clear();
        row_of(&mut row, y);
        rows.write_all(&row)?;
    }
    rows.finish()?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_picture_reads_back_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let pixels = (0..6).map(|i| [i, 2 * i, 255 - i, 255]).collect();
        let picture = Picture {
            width: 3,
            height: 2,
            pixels,
        };
        picture.write_rgb(&path).unwrap();
        assert_eq!(Picture::read(&path).unwrap(), picture);
    }

    /// Their values taken as display values would make other pictures of them.
    #[test]
    fn linear_pictures_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["exr", "hdr"] {
            let path = folder.path().join("a").with_extension(name);
            image::Rgb32FImage::new(4, 4).save(&path).unwrap();
            let error = format!("{:#}", Picture::read(&path).unwrap_err());
            let format = format!("an {} file of linear values", name.to_uppercase());
            assert!(error.contains(&format), "{error}");
        }
    }

    #[test]
    fn what_is_no_picture_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "no picture").unwrap();
        for path in [
            path.as_path(),
            folder.path(),
            &folder.path().join("missing.png"),
        ] {
            let error = format!("{:#}", Picture::read(path).unwrap_err());
            assert!(error.contains(&path.display().to_string()), "{error}");
        }
    }
}
