//! The picture that an environment may come from: Radiance RGBE or OpenEXR.

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::SystemTime;

use anyhow::{Context, bail, ensure};
use foveal::{EnvironmentMap, EnvironmentSource, Settings};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

/// Most texels of a file: 8192 x 4096.
const MOST_TEXELS: u64 = 1 << 25;

/// A file that was read, as it was then.
type Known = (PathBuf, Option<SystemTime>, EnvironmentMap);

/// The last file: both sides of a comparison show the same one.
static LAST: Mutex<Option<Known>> = Mutex::new(None);

/// The environment that the settings name, filtered; `None` where they name none.
///
/// # Errors
/// Names the file and the cause: it is missing, of another format, too large, or not
/// equirectangular.
pub fn environment(settings: &Settings) -> anyhow::Result<Option<EnvironmentMap>> {
    let lighting = &settings.lighting;
    if lighting.environment != EnvironmentSource::Image {
        return Ok(None);
    }
    if lighting.environment_image.is_empty() {
        bail!(
            "the environment shall come from a picture, but none is named: add --environment-image FILE.hdr"
        );
    }
    let path = Path::new(&lighting.environment_image);
    let changed = path.metadata().and_then(|m| m.modified()).ok();
    let mut last = LAST.lock().unwrap_or_else(|broken| broken.into_inner());
    if let Some((known, then, map)) = &*last
        && known == path
        && *then == changed
    {
        return Ok(Some(map.clone()));
    }
    let map = read(path)?;
    *last = Some((path.to_owned(), changed, map.clone()));
    Ok(Some(map))
}

/// Reads and filters an equirectangular picture of linear radiance.
///
/// # Errors
/// As [`environment`].
pub fn read(path: &Path) -> anyhow::Result<EnvironmentMap> {
    let what = || format!("cannot read the environment '{}'", path.display());
    let file = File::open(path).with_context(what)?;
    ensure!(
        file.metadata().with_context(what)?.is_file(),
        "{}: it is no file",
        what()
    );
    decode(ImageReader::new(BufReader::new(file))).with_context(what)
}

/// The same from a file's bytes.
///
/// # Errors
/// Names the cause.
pub fn from_bytes(bytes: &[u8]) -> anyhow::Result<EnvironmentMap> {
    decode(ImageReader::new(Cursor::new(bytes)))
}

fn decode<R: std::io::BufRead + std::io::Seek>(
    reader: ImageReader<R>,
) -> anyhow::Result<EnvironmentMap> {
    let mut reader = reader.with_guessed_format()?;
    ensure!(
        matches!(
            reader.format(),
            Some(ImageFormat::Hdr | ImageFormat::OpenExr)
        ),
        "it is neither a Radiance picture (.hdr) nor OpenEXR (.exr)"
    );
    let mut limits = Limits::default();
    limits.max_alloc = Some(1 << 30);
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    ensure!(
        u64::from(width) * u64::from(height) <= MOST_TEXELS,
        "it has {width} x {height} texels, and the limit is 8192 x 4096"
    );
    let picture = DynamicImage::from_decoder(decoder)?.into_rgb32f();
    let texels = picture.as_raw().as_chunks::<3>().0;
    Ok(EnvironmentMap::new(width, height, texels)?)
}

#[cfg(test)]
mod tests {
    use image::codecs::hdr::HdrEncoder;
    use image::codecs::openexr::OpenExrEncoder;
    use image::{ExtendedColorType, ImageEncoder, Rgb};

    use super::*;

    fn hdr(width: usize, height: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        let pixels = vec![Rgb([1.0, 0.5, 0.25]); width * height];
        HdrEncoder::new(&mut bytes)
            .encode(&pixels, width, height)
            .unwrap();
        bytes
    }

    fn cause(bytes: &[u8]) -> String {
        format!("{:#}", from_bytes(bytes).unwrap_err())
    }

    #[test]
    fn both_formats_are_read() {
        from_bytes(&hdr(16, 8)).unwrap();
        let mut exr = Vec::new();
        let texels = vec![[2.0f32, 1.0, 0.0]; 16 * 8];
        OpenExrEncoder::new(Cursor::new(&mut exr))
            .write_image(
                bytemuck::cast_slice(&texels),
                16,
                8,
                ExtendedColorType::Rgb32F,
            )
            .unwrap();
        from_bytes(&exr).unwrap();
    }

    #[test]
    fn other_files_are_refused_with_their_cause() {
        let text = cause(b"not a picture at all");
        assert!(text.contains("neither a Radiance picture"), "{text}");
        let text = cause(&hdr(16, 16));
        assert!(text.contains("twice as wide as high"), "{text}");
        let whole = hdr(64, 32);
        let text = cause(&whole[..whole.len() / 2]);
        assert!(!text.is_empty());
        let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 120000\n";
        let text = cause(huge);
        assert!(text.contains("limit") || text.contains("large"), "{text}");
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let settings = |path: &Path| {
            Settings::default().with(|s| {
                s.lighting.environment = EnvironmentSource::Image;
                s.lighting.environment_image = path.display().to_string();
            })
        };
        let missing = folder.path().join("missing.hdr");
        for path in [&missing, folder.path()] {
            let error = environment(&settings(path)).unwrap_err();
            let text = format!("{error:#}");
            assert!(text.contains(&path.display().to_string()), "{text}");
        }
        let error = environment(&settings(Path::new(""))).unwrap_err();
        assert!(error.to_string().contains("--environment-image"), "{error}");
        assert!(environment(&Settings::default()).unwrap().is_none());
    }

    #[test]
    fn a_file_that_has_changed_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        let settings = Settings::default().with(|s| {
            s.lighting.environment = EnvironmentSource::Image;
            s.lighting.environment_image = path.display().to_string();
        });
        std::fs::write(&path, hdr(16, 8)).unwrap();
        environment(&settings).unwrap().unwrap();
        std::fs::write(&path, b"no picture").unwrap();
        let later = SystemTime::now() + std::time::Duration::from_secs(5);
        File::options()
            .write(true)
            .open(&path)
            .unwrap()
            .set_modified(later)
            .unwrap();
        assert!(environment(&settings).is_err());
    }
}
