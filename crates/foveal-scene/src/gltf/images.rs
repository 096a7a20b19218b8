//! Definitions of images, samplers and textures.

use std::collections::HashMap;

use super::document::{Counts, View};
use super::json::{Obj, cut_name};
use super::uri::is_data;
use crate::error::{Flaw, Parsed};
use crate::{Code, Filter, Sampler, Wrap};

/// Where a picture's bytes are.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) enum ImageSource {
    View(u32),
    Uri(String),
    Nowhere,
}

/// A picture as the file names it.
pub(crate) struct ImageDef {
    pub(crate) name: Option<String>,
    pub(crate) source: ImageSource,
}

impl ImageDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let view = o.index("bufferView", counts.views)?;
        let uri = o.string("uri")?;
        let source = match (view, uri) {
            (Some(view), _) => ImageSource::View(view),
            (None, Some(uri)) => ImageSource::Uri(uri.to_owned()),
            (None, None) => ImageSource::Nowhere,
        };
        let file_name = uri.filter(|u| !is_data(u));
        Ok(Self {
            name: o.name("name")?.or_else(|| file_name.map(cut_name)),
            source,
        })
    }

    /// Whether it is a file of its own.
    pub(crate) fn is_file(&self) -> bool {
        matches!(&self.source, ImageSource::Uri(uri) if !is_data(uri))
    }

    /// The name that users see.
    pub(crate) fn label(&self, index: usize) -> String {
        self.name
            .clone()
            .filter(|n| !n.is_empty())
            .unwrap_or_else(|| format!("image {index}"))
    }
}

/// For each image the first one with the same source: what is named twice is decoded once. Views of
/// the same bytes hold the same picture; compressed ones are their own.
pub(crate) fn first_of_equal(images: &[ImageDef], views: &[View]) -> Vec<u32> {
    let mut by_uri = HashMap::new();
    let mut by_place = HashMap::new();
    let number = |(i, image): (usize, &ImageDef)| {
        let i = i as u32;
        match &image.source {
            ImageSource::Nowhere => i,
            ImageSource::Uri(uri) => *by_uri.entry(uri.clone()).or_insert(i),
            ImageSource::View(view) => {
                let view = &views[*view as usize];
                if view.coded.is_some() {
                    return i;
                }
                let place = (view.buffer, view.offset, view.len);
                *by_place.entry(place).or_insert(i)
            }
        }
    };
    images.iter().enumerate().map(number).collect()
}

/// A picture with a sampler.
pub(crate) struct TextureDef {
    pub(crate) image: Option<u32>,
    pub(crate) sampler: Option<u32>,
}

impl TextureDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let from = |extension: &str| -> Parsed<Option<u32>> {
            let Some(e) = o.extension(extension)? else {
                return Ok(None);
            };
            e.index("source", counts.images)
                .map_err(|e| e.under(format!("extensions.{extension}")))
        };
        let webp = from("EXT_texture_webp")?;
        let basis = from("KHR_texture_basisu")?;
        let plain = o.index("source", counts.images)?;
        // A plain picture has lost less than one for the graphics card's formats.
        Ok(Self {
            image: webp.or(plain).or(basis),
            sampler: o.index("sampler", counts.samplers)?,
        })
    }
}

/// glTF's OpenGL constants as a [`Sampler`].
pub(crate) fn parse_sampler(o: Obj<'_>) -> Parsed<Sampler> {
    let wrap = |key| -> Parsed<Wrap> {
        Ok(match o.uint(key)? {
            None | Some(10497) => Wrap::Repeat,
            Some(33648) => Wrap::MirroredRepeat,
            Some(33071) => Wrap::ClampToEdge,
            Some(other) => {
                return Err(
                    Flaw::new(Code::ValueUnknown, format!("is {other}, not a wrap mode"))
                        .under(key),
                );
            }
        })
    };
    let mag = match o.uint("magFilter")? {
        None | Some(9729) => Filter::Linear,
        Some(9728) => Filter::Nearest,
        Some(other) => {
            return Err(
                Flaw::new(Code::ValueUnknown, format!("is {other}, not a filter"))
                    .under("magFilter"),
            );
        }
    };
    let (min, mip) = match o.uint("minFilter")? {
        Some(9728) => (Filter::Nearest, None),
        Some(9729) => (Filter::Linear, None),
        Some(9984) => (Filter::Nearest, Some(Filter::Nearest)),
        Some(9985) => (Filter::Linear, Some(Filter::Nearest)),
        Some(9986) => (Filter::Nearest, Some(Filter::Linear)),
        None | Some(9987) => (Filter::Linear, Some(Filter::Linear)),
        Some(other) => {
            return Err(
                Flaw::new(Code::ValueUnknown, format!("is {other}, not a filter"))
                    .under("minFilter"),
            );
        }
    };
    Ok(Sampler {
        wrap_u: wrap("wrapS")?,
        wrap_v: wrap("wrapT")?,
        mag,
        min,
        mip,
    })
}
