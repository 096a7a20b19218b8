//! Radiance as files of linear light: OpenEXR and Radiance RGBE.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, bail};
use foveal::RadianceImage;
use image::codecs::hdr::HdrEncoder;
use image::codecs::openexr::OpenExrEncoder;
use image::{ExtendedColorType, ImageEncoder, Rgb};

/// What a picture's file holds, by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Display values, 8 bits a channel, sRGB.
    Png,
    /// Linear radiance, 32-bit float.
    Exr,
    /// Linear radiance, 8 bits a channel and a common exponent (Ward 1991).
    Hdr,
}

impl PictureFormat {
    /// The format that a file's name asks for; `None` where no format ends so.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            "hdr" => Some(Self::Hdr),
            _ => None,
        }
    }

    /// Whether it holds radiance.
    pub fn is_linear(self) -> bool {
        self != Self::Png
    }
}

/// Writes radiance as the file's name asks, whole or not at all.
///
/// # Errors
/// Names the file and the cause: a name of another format, a disk that is full.
pub fn write(path: &Path, radiance: &RadianceImage) -> anyhow::Result<()> {
    let bytes =
        encode(path, radiance).with_context(|| format!("cannot encode '{}'", path.display()))?;
    crate::atomic_file::write(path, &bytes)
}

/// The bytes of such a file.
///
/// # Errors
/// Where the name is of another format.
pub fn encode(path: &Path, radiance: &RadianceImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let (width, height) = (radiance.width, radiance.height);
    match PictureFormat::of(path) {
        Some(PictureFormat::Exr) => OpenExrEncoder::new(Cursor::new(&mut bytes)).write_image(
            bytemuck::cast_slice(&radiance.rgb),
            width,
            height,
            ExtendedColorType::Rgb32F,
        )?,
        Some(PictureFormat::Hdr) => {
            let pixels: Vec<Rgb<f32>> = radiance.rgb.iter().map(|&rgb| Rgb(rgb)).collect();
            HdrEncoder::new(&mut bytes).encode(&pixels, width as usize, height as usize)?;
        }
        _ => bail!("radiance is written as .exr or .hdr"),
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radiance() -> RadianceImage {
        let mut image = RadianceImage::default();
        (image.width, image.height) = (3, 2);
        image.rgb = (0..6).map(|i| [i as f32 * 0.25, 1.0, 40.0]).collect();
        image
    }

    #[test]
    fn a_written_file_holds_the_radiance() {
        let folder = tempfile::tempdir().unwrap();
        for (name, tolerance) in [("a.exr", 0.0), ("A.HDR", 0.2)] {
            let path = folder.path().join(name);
            write(&path, &radiance()).unwrap();
            let read = image::open(&path).unwrap().into_rgb32f();
            assert_eq!(read.dimensions(), (3, 2));
            for (pixel, expected) in read.pixels().zip(&radiance().rgb) {
                for (a, b) in pixel.0.iter().zip(expected) {
                    assert!((a - b).abs() <= tolerance, "{name}: {a}, {b}");
                }
            }
        }
    }

    #[test]
    fn names_tell_the_format() {
        let of = |name: &str| PictureFormat::of(Path::new(name));
        assert_eq!(of("a.PNG"), Some(PictureFormat::Png));
        assert_eq!(of("b/a.exr"), Some(PictureFormat::Exr));
        assert_eq!(of("a.hdr"), Some(PictureFormat::Hdr));
        assert_eq!([of("a.jpg"), of("exr"), of("-")], [None; 3]);
    }
}
