//! The picture that an environment may come from: Radiance RGBE or OpenEXR.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::SystemTime;

use anyhow::{Context, anyhow, bail, ensure};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use foveal::{EnvironmentMap, EnvironmentSource, Settings};
use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::{DynamicImage, ImageDecoder, Rgb32FImage};

/// Most texels of a file: 8192 x 4096.
const MOST_TEXELS: u64 = 1 << 25;

/// Most bytes of a part that is decoded in one piece.
const MOST_BLOCK_BYTES: u64 = 1 << 30;

/// What Radiance pictures begin with.
const RADIANCE: &[u8] = b"#?RADIANCE";
/// What other programs have them begin with.
const RGBE: &[u8] = b"#?RGBE";
/// What OpenEXR begins with.
const OPEN_EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// Name, time and length of a file.
type Version = (PathBuf, Option<SystemTime>, u64);

/// The last file that was decoded, or why it could not be: both sides of a comparison show the same
/// one, and a file that is wrong is not decoded for every frame.
static LAST: Mutex<Option<(Version, Result<EnvironmentMap, String>)>> = Mutex::new(None);

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
    let (file, metadata) = open(path)?;
    let version = (path.to_owned(), metadata.modified().ok(), metadata.len());
    let mut last = LAST.lock().unwrap_or_else(|broken| broken.into_inner());
    let known = last.take().filter(|(then, _)| *then == version);
    let (_, found) = last.insert(known.unwrap_or_else(|| {
        let read = decode(BufReader::new(file)).with_context(|| cannot_read(path));
        (version, read.map_err(|cause| format!("{cause:#}")))
    }));
    match found {
        Ok(map) => Ok(Some(map.clone())),
        Err(cause) => Err(anyhow!(cause.clone())),
    }
}

/// Reads and filters an equirectangular picture of linear radiance.
///
/// # Errors
/// As [`environment`].
pub fn read(path: &Path) -> anyhow::Result<EnvironmentMap> {
    let (file, _) = open(path)?;
    decode(BufReader::new(file)).with_context(|| cannot_read(path))
}

/// The same from a file's bytes.
///
/// # Errors
/// Names the cause.
pub fn from_bytes(bytes: &[u8]) -> anyhow::Result<EnvironmentMap> {
    decode(Cursor::new(bytes))
}

fn cannot_read(path: &Path) -> String {
    format!("cannot read the environment '{}'", path.display())
}

/// Opens a file; anything else, as a pipe, is not even opened.
fn open(path: &Path) -> anyhow::Result<(File, std::fs::Metadata)> {
    let what = || cannot_read(path);
    let metadata = path.metadata().with_context(what)?;
    ensure!(metadata.is_file(), "{}: it is no file", what());
    Ok((File::open(path).with_context(what)?, metadata))
}

fn decode(reader: impl BufRead + Seek) -> anyhow::Result<EnvironmentMap> {
    let picture = picture(reader)?;
    let texels = picture.as_raw().as_chunks::<3>().0;
    let (width, height) = picture.dimensions();
    Ok(EnvironmentMap::new(width, height, texels)?)
}

/// The radiance in a file of either format, not filtered.
///
/// # Errors
/// Names the cause.
pub fn picture(mut reader: impl BufRead + Seek) -> anyhow::Result<Rgb32FImage> {
    let mut start = Vec::new();
    reader
        .by_ref()
        .take(RADIANCE.len() as u64)
        .read_to_end(&mut start)?;
    if start.starts_with(OPEN_EXR) {
        reader.rewind()?;
        return open_exr(reader);
    }
    if start.starts_with(RADIANCE) {
        reader.rewind()?;
        return radiance(reader);
    }
    if start.starts_with(RGBE) {
        reader.seek(std::io::SeekFrom::Start(RGBE.len() as u64))?;
        return radiance(RADIANCE.chain(reader));
    }
    bail!("it is neither a Radiance picture (.hdr) nor OpenEXR (.exr)")
}

/// A Radiance picture; its texels were multiplied by what its header says.
fn radiance(reader: impl Read) -> anyhow::Result<Rgb32FImage> {
    let decoder = HdrDecoder::new(reader)?;
    let header = decoder.metadata();
    check_size(header.width, header.height)?;
    let (r, g, b) = header.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let exposure = header.exposure.unwrap_or(1.0);
    let factors = [r, g, b].map(|correction| correction * exposure);
    ensure!(
        factors.iter().all(|f| f.is_normal() && *f > 0.0),
        "its header says EXPOSURE={exposure} and COLORCORR={r} {g} {b}, and they must be above 0"
    );
    let mut picture = DynamicImage::from_decoder(decoder)?.into_rgb32f();
    if factors != [1.0; 3] {
        for texel in picture.pixels_mut() {
            for (value, factor) in texel.0.iter_mut().zip(factors) {
                *value /= factor;
            }
        }
    }
    Ok(picture)
}

fn open_exr(mut reader: impl BufRead + Seek) -> anyhow::Result<Rgb32FImage> {
    let headers = MetaData::read_from_buffered(&mut reader, false)?.headers;
    let has = |header: &Header, name: &str| header.channels.list.iter().any(|c| c.name.eq(name));
    let has_colours = |header: &Header| ["R", "G", "B"].iter().all(|name| has(header, name));
    if !headers
        .iter()
        .any(|header| !header.deep && has_colours(header))
    {
        let channels = headers.iter().flat_map(|header| &header.channels.list);
        let names: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
        bail!(
            "its channels are {}, and R, G and B are wanted, not deep",
            names.join(", ")
        );
    }
    for header in headers {
        let shown = header.shared_attributes.display_window.size;
        let shown = [shown.width(), shown.height()];
        let [width, height] = shown.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        check_size(width, height)?;
        // Memory follows what the file holds, not what it shows.
        let held = [header.layer_size.width(), header.layer_size.height()];
        ensure!(
            held[0] <= shown[0] && held[1] <= shown[1],
            "its data window of {} x {} texels is larger than its display window of {width} x {height}",
            held[0],
            held[1]
        );
        if let BlockDescription::Tiles(tiles) = header.blocks {
            let [across, down] = [tiles.tile_size.width(), tiles.tile_size.height()];
            let bytes = (across as u64)
                .checked_mul(down as u64)
                .and_then(|texels| texels.checked_mul(header.channels.bytes_per_pixel as u64));
            ensure!(
                bytes.is_some_and(|bytes| bytes <= MOST_BLOCK_BYTES),
                "its tiles have {across} x {down} texels, more than the limit of 1 GiB each"
            );
        }
    }
    reader.rewind()?;
    let decoder = OpenExrDecoder::with_alpha_preference(reader, Some(false))?;
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    Ok(DynamicImage::from_decoder(decoder)?.into_rgb32f())
}

/// Whether a picture of this size is worth decoding.
fn check_size(width: u32, height: u32) -> anyhow::Result<()> {
    ensure!(
        u64::from(width) * u64::from(height) <= MOST_TEXELS,
        "it has {width} x {height} texels, and the limit is 8192 x 4096"
    );
    ensure!(
        height > 0 && u64::from(width) == 2 * u64::from(height),
        "it is {width} x {height} texels, and an equirectangular picture is twice as wide as high"
    );
    Ok(())
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

    fn exr(width: u32, height: u32) -> Vec<u8> {
        let mut exr = Vec::new();
        let texels = vec![[2.0f32, 1.0, 0.0]; (width * height) as usize];
        let texels = bytemuck::cast_slice(&texels);
        OpenExrEncoder::new(Cursor::new(&mut exr))
            .write_image(texels, width, height, ExtendedColorType::Rgb32F)
            .unwrap();
        exr
    }

    #[test]
    fn both_formats_are_read() {
        from_bytes(&hdr(16, 8)).unwrap();
        from_bytes(&exr(16, 8)).unwrap();
    }

    #[test]
    fn memory_is_not_asked_for_what_a_file_does_not_show() {
        let mut bytes = exr(16, 8);
        let name = b"dataWindow\0box2i\0\x10\0\0\0";
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap();
        let most = &mut bytes[at + name.len() + 8..][..8];
        assert_eq!(most, [15, 0, 0, 0, 7, 0, 0, 0], "its last texel");
        most[..4].copy_from_slice(&((1 << 29) - 1i32).to_le_bytes());
        let text = cause(&bytes);
        assert!(text.contains("data window of 536870912 x 8"), "{text}");
    }

    #[test]
    fn the_wrong_shape_is_refused_before_anything_is_decoded() {
        // Nothing follows the header.
        let text = cause(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n");
        assert!(text.contains("twice as wide as high"), "{text}");
        let whole = exr(16, 16);
        let text = cause(&whole[..whole.len() / 2]);
        assert!(text.contains("twice as wide as high"), "{text}");
    }

    #[test]
    fn exposure_and_colour_correction_are_taken_back() {
        let plain = hdr(16, 8);
        let lines = plain.iter().position(|&byte| byte == b'\n').unwrap() + 1;
        let with = |start: &str| [start.as_bytes(), &plain[lines..]].concat();
        let seen = |bytes: &[u8]| picture(Cursor::new(bytes)).unwrap().get_pixel(3, 5).0;
        assert_eq!(seen(&plain), [1.0, 0.5, 0.25]);
        let corrected = with("#?RADIANCE\nEXPOSURE=4\nEXPOSURE=0.5\nCOLORCORR=1 1 0.5\n");
        assert_eq!(seen(&corrected), [0.5, 0.25, 0.25]);
        assert_eq!(seen(&with("#?RGBE\n")), seen(&plain), "another signature");
        for wrong in [
            "EXPOSURE=0",
            "EXPOSURE=-1",
            "EXPOSURE=inf",
            "COLORCORR=1 0 1",
        ] {
            let text = cause(&with(&format!("#?RADIANCE\n{wrong}\n")));
            assert!(text.contains("must be above 0"), "{wrong}: {text}");
        }
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
    fn an_exr_picture_without_colours_is_refused_with_its_channels() {
        let mut bytes = exr(16, 8);
        // The channels are in the order of their names.
        let name = b"\0B\0";
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap();
        bytes[at + 1] = b'A';
        let text = cause(&bytes);
        assert!(text.contains("its channels are A, G, R"), "{text}");
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
        let error = environment(&settings).unwrap_err().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
        // The cause is kept with the file's version.
        assert_eq!(environment(&settings).unwrap_err().to_string(), error);
        std::fs::write(&path, hdr(16, 8)).unwrap();
        environment(&settings).unwrap().unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_refused_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe.hdr");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        if !made.is_ok_and(|status| status.success()) {
            eprintln!("skipped: mkfifo is missing");
            return;
        }
        let text = format!("{:#}", read(&path).unwrap_err());
        assert!(text.contains("it is no file"), "{text}");
    }
}
