//! PNG files in and out, 8 bits per channel.

use std::path::Path;

use anyhow::{Context, bail};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageReader};

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
    pub fn from_rgba(width: u32, height: u32, bytes: &[u8]) -> anyhow::Result<Self> {
        let (pixels, rest) = bytes.as_chunks::<4>();
        if pixels.len() as u64 != u64::from(width) * u64::from(height) || !rest.is_empty() {
            bail!(
                "a picture of {width}x{height} pixels came back with {} bytes",
                bytes.len()
            );
        }
        Ok(Self {
            width,
            height,
            pixels: pixels.to_vec(),
        })
    }

    /// Reads a PNG file; 16-bit channels are rounded to 8 bits, grey becomes RGB, a missing alpha
    /// is 255.
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
            let decoded = ImageReader::open(path)?
                .with_guessed_format()?
                .decode()?
                .into_rgba8();
            Self::from_rgba(decoded.width(), decoded.height(), decoded.as_raw())
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
        Ok(encode(self.width, self.height, &self.rgb_bytes())?)
    }

    /// Writes the picture without its alpha as an RGB PNG, whole or not at all.
    pub fn write_rgb(&self, path: &Path) -> anyhow::Result<()> {
        write_rgb(path, self.width, self.height, &self.rgb_bytes())
    }
}

/// Writes RGB8 rows as a PNG, whole or not at all.
pub fn write_rgb(path: &Path, width: u32, height: u32, rgb: &[u8]) -> anyhow::Result<()> {
    let png = encode(width, height, rgb)
        .with_context(|| format!("cannot encode '{}'", path.display()))?;
    crate::atomic_file::write(path, &png)
}

fn encode(width: u32, height: u32, rgb: &[u8]) -> image::ImageResult<Vec<u8>> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png).write_image(rgb, width, height, ExtendedColorType::Rgb8)?;
    Ok(png)
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
