//! EXT_lights_image_based: an environment of the scene's own.
//!
//! The first of each light's levels is read: renderers filter it themselves. What the extension
//! leaves open is taken as the file's own data agree best: which of the first two pictures faces +x,
//! whether pictures have their top above or below, and the signs and the scale of the irradiance.

use std::sync::Arc;

use glam::Quat;

use super::Resolver;
use super::document::Counts;
use super::json::Obj;
use super::pictures::{self, Promise};
use super::reader::Reader;
use crate::error::{Flaw, Limit, Parsed, amount};
use crate::image_light::{COSINE, ImageLight, halved, irradiance_of};
use crate::{Code, LoadOptions, Scene, Warning, srgb};

const NAME: &str = "EXT_lights_image_based";

/// Texels a side of the cube that is kept; larger pictures are halved.
const MOST_SIDE: u32 = 1024;
/// Texels a side of a picture that is read.
const MOST_PICTURE_SIDE: u32 = 8192;

/// A light as the file has it.
pub(crate) struct ImageLightDef {
    name: String,
    rotation: Quat,
    intensity: f32,
    irradiance: [[f32; 3]; 9],
    /// Of level 0: +x, -x, +y, -y, +z, -z.
    images: [u32; 6],
    side: u32,
}

/// The light of the scene to show, or why it cannot be used.
pub(crate) type Chosen = Option<Result<ImageLightDef, Flaw>>;

/// Reads the light that the scene to show names.
pub(crate) fn parse(root: Obj<'_>, counts: &Counts) -> Parsed<Chosen> {
    // What is wrong within the extension leaves the rest of the file as good as it is.
    Ok(find(root, counts).unwrap_or_else(|flaw| Some(Err(flaw))))
}

fn find(root: Obj<'_>, counts: &Counts) -> Parsed<Chosen> {
    let scene = root.index("scene", counts.scenes)?.unwrap_or(0);
    let Some(scene_json) = root.get("scenes").and_then(|all| all.get(scene as usize)) else {
        return Ok(None);
    };
    let within = |flaw: Flaw| flaw.under(format_args!("scenes[{scene}]"));
    let Some(reference) = Obj::of(scene_json)
        .and_then(|o| o.extension(NAME))
        .map_err(within)?
    else {
        return Ok(None);
    };
    let all = root.extension(NAME)?;
    let count = all.map_or(0, |all| all.len_of("lights"));
    let found = reference
        .index("light", count)
        .and_then(|n| reference.need("light", n));
    let found = found.map_err(|e| within(e.under(format_args!("extensions.{NAME}"))));
    let number = match found {
        Ok(number) => number,
        Err(flaw) => return Ok(Some(Err(flaw))),
    };
    let mut numbers = 0..;
    let mut light = None;
    // Only the one that is shown: others may be as broken as they like.
    if let Some(all) = all {
        all.each("lights", |value| {
            if numbers.next() == Some(number) {
                let place = format!("extensions.{NAME}.lights[{number}]");
                light = Some(
                    Obj::of(value)
                        .and_then(|o| parse_light(o, counts))
                        .map_err(|e| e.under(place)),
                );
            }
            Ok(())
        })?;
    }
    Ok(light)
}

fn parse_light(o: Obj<'_>, counts: &Counts) -> Parsed<ImageLightDef> {
    let rotation = o
        .floats::<4>("rotation")?
        .map_or(Quat::IDENTITY, Quat::from_array);
    let length = rotation.length();
    if !(1e-3..1e3).contains(&length) {
        return Err(Flaw::new(Code::ValueOutOfRange, "is no rotation").under("rotation"));
    }
    let coefficients = o.float_rows::<3>("irradianceCoefficients")?;
    let coefficients = o.need("irradianceCoefficients", coefficients)?;
    let count = coefficients.len();
    let irradiance = <[[f32; 3]; 9]>::try_from(coefficients).map_err(|_| {
        let text = format!("has {count} coefficients instead of 9");
        Flaw::new(Code::ValueType, text).under("irradianceCoefficients")
    })?;
    let levels = o.index_rows::<6>("specularImages", counts.images)?;
    let levels = o.need("specularImages", levels)?;
    let Some(&images) = levels.first() else {
        return Err(Flaw::new(Code::ValueType, "has no level").under("specularImages"));
    };
    let side = o.need("specularImageSize", o.uint("specularImageSize")?)?;
    let fits = side.is_power_of_two() && side <= u64::from(MOST_PICTURE_SIDE);
    if !fits {
        let text = format!("is {side}, not a power of two up to {MOST_PICTURE_SIDE}");
        return Err(Flaw::new(Code::ValueOutOfRange, text).under("specularImageSize"));
    }
    Ok(ImageLightDef {
        name: o.name("name")?.unwrap_or_default(),
        rotation: rotation.normalize(),
        intensity: o.float("intensity")?.unwrap_or(1.0).max(0.0),
        irradiance,
        images,
        side: side as u32,
    })
}

impl ImageLightDef {
    /// Its pictures.
    pub(crate) fn images(&self) -> [u32; 6] {
        self.images
    }
}

/// Reads the pictures of the scene's light, where it has one. One that cannot be had is a warning,
/// one beyond a limit an error before anything is decoded.
pub(crate) fn decode(
    scene: &mut Scene,
    reader: Reader<'_>,
    resolver: &Resolver<'_>,
    options: &LoadOptions,
    warn: &mut Vec<Warning>,
) -> Parsed<()> {
    let def = match &reader.document.image_light {
        None => return Ok(()),
        Some(Ok(def)) => def,
        Some(Err(flaw)) => {
            warn.push(flaw.warning().and(LEFT_OUT));
            return Ok(());
        }
    };
    let mut encoded = Vec::with_capacity(6);
    for image in def.images {
        match header(def, image, reader, resolver) {
            Ok(found) => encoded.push(found),
            Err(flaw) => {
                warn.push(at(flaw, image, reader).and(LEFT_OUT));
                return Ok(());
            }
        }
    }
    let kept = u64::from(def.side.min(MOST_SIDE)).pow(2) * 12 * 6;
    // The sides, all of them together, and a copy that is shared.
    let kept = 3 * kept;
    let decoding = encoded
        .iter()
        .map(|(_, p)| p.decoding_bytes() + 5 * p.rgba_bytes());
    // One after the other.
    let needed = kept + decoding.max().unwrap_or(0);
    if needed > options.max_texture_bytes {
        let cause = format!(
            "wants {} for the pictures of an environment, the limit is {}",
            amount(needed),
            amount(options.max_texture_bytes)
        );
        return Err(
            Flaw::beyond(Limit::TextureBytes, cause).under(format_args!("extensions.{NAME}"))
        );
    }
    reader
        .buffers
        .budget
        .take(needed, "the pictures of an environment")?;
    let mut sides = Vec::with_capacity(6);
    for (image, (bytes, promise)) in def.images.into_iter().zip(&encoded) {
        match pictures::decode(bytes, *promise) {
            Ok(picture) => sides.push(radiance(&picture)),
            Err(cause) => {
                let flaw = Flaw::new(Code::ImageUnreadable, cause);
                warn.push(at(flaw, image, reader).and(LEFT_OUT));
                return Ok(());
            }
        }
    }
    scene.image_light = Some(finish(def, sides));
    Ok(())
}

const LEFT_OUT: &str = "the environment is left out";

fn at(flaw: Flaw, image: u32, reader: Reader<'_>) -> Warning {
    let label = reader.document.images[image as usize].label(image as usize);
    flaw.warning().at(format!("images[{image}] ({label})"))
}

type Encoded<'a> = (std::borrow::Cow<'a, [u8]>, Promise);

/// A picture's file, whose header says what the light does.
fn header<'a>(
    def: &ImageLightDef,
    image: u32,
    reader: Reader<'a>,
    resolver: &Resolver<'_>,
) -> Parsed<Encoded<'a>> {
    let bytes = pictures::fetch(Some(image), reader, resolver)?;
    let promise = pictures::promise(&bytes).map_err(|e| Flaw::new(Code::ImageUnreadable, e))?;
    if [promise.width, promise.height] != [def.side; 2] {
        let text = format!(
            "has {} x {} texels, the environment's specularImageSize is {}",
            promise.width, promise.height, def.side
        );
        return Err(Flaw::new(Code::ValueOutOfRange, text));
    }
    Ok((bytes, promise))
}

/// Linear radiance of a picture that is seen from within, with at most [`MOST_SIDE`] texels a side:
/// the colours over alpha (RGBD; alpha is 1 where the picture has none).
fn radiance(picture: &pictures::Picture) -> Vec<[f32; 3]> {
    let texels = picture.pixels.as_chunks::<4>().0;
    let mut texels: Vec<[f32; 3]> = texels
        .iter()
        .map(|&[r, g, b, a]| [r, g, b].map(|v| srgb::to_linear(v) * 255.0 / f32::from(a.max(1))))
        .collect();
    let mut side = picture.width as usize;
    while side > MOST_SIDE as usize {
        texels = halved(&texels, side);
        side /= 2;
    }
    texels
}

fn finish(def: &ImageLightDef, mut sides: Vec<Vec<[f32; 3]>>) -> ImageLight {
    let side = sides[0].len().isqrt();
    if seam(&sides, [1, 4, 0, 5], side) < seam(&sides, [0, 4, 1, 5], side) {
        sides.swap(0, 1);
    }
    let upside_down = lids(&sides, side, true) < lids(&sides, side, false);
    // Seen from within they are mirrored: graphics APIs see them from without.
    for texels in &mut sides {
        if upside_down {
            texels.reverse();
        } else {
            texels.chunks_mut(side).for_each(<[_]>::reverse);
        }
    }
    let radiance = sides.concat();
    drop(sides);
    let irradiance = agreeing(def.irradiance, &irradiance_of(side, &radiance));
    ImageLight {
        name: def.name.clone(),
        rotation: def.rotation,
        intensity: def.intensity,
        side: side as u32,
        radiance: Arc::from(radiance),
        irradiance,
    }
}

/// How much pictures differ where each one's right edge meets the next one's left one.
fn seam(sides: &[Vec<[f32; 3]>], ring: [usize; 4], side: usize) -> f32 {
    let edges = (0..4).flat_map(|i| (0..side).map(move |y| (i, y)));
    let apart = |(i, y): (usize, usize)| -> f32 {
        let right = sides[ring[i]][y * side + side - 1];
        let left = sides[ring[(i + 1) % 4]][y * side];
        apart(right, left)
    };
    edges.map(apart).sum()
}

/// How much the pictures above and below differ from those of +z and -z where they meet, with the
/// rows of all from the top or, upside down, from the bottom.
fn lids(sides: &[Vec<[f32; 3]>], side: usize, upside_down: bool) -> f32 {
    let row = |picture: usize, y: usize| {
        let y = if upside_down { side - 1 - y } else { y };
        &sides[picture][y * side..][..side]
    };
    let last = side - 1;
    let (above, below) = (2, 3);
    let forth = [(row(above, last), row(4, 0)), (row(below, 0), row(4, last))];
    let back = [(row(above, 0), row(5, 0)), (row(below, last), row(5, last))];
    let forth = forth.into_iter().flat_map(|(lid, of)| lid.iter().zip(of));
    let back = back.into_iter();
    let back = back.flat_map(|(lid, of)| lid.iter().rev().zip(of));
    forth.chain(back).map(|(&a, &b)| apart(a, b)).sum()
}

/// How much two texels differ. Suns must not outweigh all else.
fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squeezed = |v: f32| v / (1.0 + v);
    let channels = a.into_iter().zip(b);
    channels
        .map(|(a, b)| (squeezed(a) - squeezed(b)).abs())
        .sum()
}

/// Signs that harmonics are defined with: none; the Condon-Shortley phase; both of directions whose
/// x is mirrored, as Khronos's EnvironmentTest and Babylon.js have them.
const SIGNS: [[f32; 9]; 4] = [
    [1.0; 9],
    [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0],
];

/// The file's coefficients in the convention under which they come nearest to those of its pictures:
/// with one of the signs, and of irradiance, or of radiance, from which irradiance follows.
fn agreeing(given: [[f32; 3]; 9], found: &[[f32; 3]; 9]) -> [[f32; 3]; 9] {
    let scales = [[1.0; 9], COSINE];
    let readings = scales
        .iter()
        .flat_map(|scale| SIGNS.iter().map(move |signs| (scale, signs)));
    let read = |(scale, signs): (&[f32; 9], &[f32; 9])| -> [[f32; 3]; 9] {
        std::array::from_fn(|k| given[k].map(|v| v * scale[k] * signs[k]))
    };
    let apart = |read: &[[f32; 3]; 9]| -> f32 {
        let pairs = read.iter().flatten().zip(found.iter().flatten());
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let all = readings.map(read);
    all.min_by(|a, b| apart(a).total_cmp(&apart(b)))
        .unwrap_or(given)
}
