//! Textures: decoding, mip levels, and placeholders.

use std::borrow::Cow;
use std::collections::HashMap;

use super::Resolver;
use super::basis;
use super::budget::Budget;
use super::document::Document;
use super::images::ImageDef;
use super::pictures::{self, Picture, Promise};
use super::reader::Reader;
use super::wanted::{Key, Role, Wanted};
use crate::compress::{self, Channels};
use crate::error::{Flaw, Limit, Parsed, amount};
use crate::mip;
use crate::{
    Code, ColorSpace, Encoding, LoadOptions, Material, Texture, TextureCompression, Warning,
    threads,
};

/// All uses of one picture.
struct Source<'a> {
    image: Option<u32>,
    /// Its file, and what the header promises; or why it cannot be had.
    encoded: Result<(Cow<'a, [u8]>, Promise), Flaw>,
    uses: Vec<Use>,
}

/// A texture made from a picture.
#[derive(Clone, Copy)]
struct Use {
    number: usize,
    color_space: ColorSpace,
    kept: Option<Kept>,
}

/// What is read of a texture that is to be in blocks, and by what choice they are.
#[derive(Clone, Copy)]
struct Kept {
    read: Channels,
    by: TextureCompression,
}

impl Use {
    fn encoding(self, width: u32, height: u32) -> Encoding {
        self.kept.map_or(Encoding::Rgba8, |kept| {
            (kept.read).encoding(kept.by, self.color_space, (width, height))
        })
    }
}

/// Decodes every wanted texture of these materials. A picture that cannot be had is a warning and a
/// placeholder; one that is beyond a limit is an error before anything is decoded.
pub(crate) fn decode(
    wanted: &Wanted,
    materials: &[Material],
    reader: Reader<'_>,
    resolver: &Resolver<'_>,
    options: &LoadOptions,
    warn: &mut Vec<Warning>,
) -> Parsed<Vec<Texture>> {
    let document = reader.document;
    let by = options.texture_compression;
    let keeps = by != TextureCompression::Off && cfg!(not(target_arch = "wasm32"));
    let kept = keeps.then(|| {
        let read = compress::channels(materials, wanted.keys.len()).into_iter();
        read.map(|read| Kept { read, by }).collect::<Vec<_>>()
    });
    let sources = sources(wanted, kept.as_deref(), reader, resolver);
    // Buffers were counted as they were read.
    let files = sources.iter().filter(|source| source.is_file(document));
    let files = files.filter_map(|source| source.encoded.as_ref().ok());
    let bytes = files.map(|(bytes, _)| bytes.len() as u64).sum();
    reader.buffers.budget.add_files(bytes);
    let plan = plan(&sources, document, options, &reader.buffers.budget, warn)?;
    let decoded = threads::map_few(options.parallel, plan.at_once, &sources, |source| {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(finished) = transcoded(source, wanted, document, plan.largest) {
            return finished;
        }
        let picture = match &source.encoded {
            Ok((bytes, promise)) => pictures::decode(bytes, *promise).map_err(unreadable),
            Err(flaw) => Err(flaw.clone()),
        };
        finish(picture, &source.uses, wanted, document, plan.largest)
    });
    let mut textures: Vec<(usize, Texture)> = Vec::new();
    for (one, source) in decoded.into_iter().zip(&sources) {
        let place = source.place(document);
        warn.extend(one.notes.into_iter().map(|note| note.at(&place)));
        textures.extend(one.textures);
    }
    textures.sort_unstable_by_key(|(i, _)| *i);
    Ok(textures.into_iter().map(|(_, t)| t).collect())
}

/// The wanted pictures, each once. Files are read here, one after the other: a resolver need not be
/// quick or parallel.
fn sources<'a>(
    wanted: &Wanted,
    kept: Option<&[Kept]>,
    reader: Reader<'a>,
    resolver: &Resolver<'_>,
) -> Vec<Source<'a>> {
    let mut sources: Vec<Source<'a>> = Vec::new();
    let mut number: HashMap<Option<u32>, usize> = HashMap::new();
    for (i, key) in wanted.keys.iter().enumerate() {
        let at = *number.entry(key.image).or_insert_with(|| {
            let encoded = pictures::fetch(key.image, reader, resolver).and_then(|bytes| {
                let promise = pictures::promise(&bytes).map_err(unreadable)?;
                Ok((bytes, promise))
            });
            sources.push(Source {
                image: key.image,
                encoded,
                uses: Vec::new(),
            });
            sources.len() - 1
        });
        sources[at].uses.push(Use {
            number: i,
            color_space: key.role.color_space(),
            kept: kept.map(|kept| kept[i]),
        });
    }
    sources
}

impl Source<'_> {
    /// Whether the picture is a file of its own.
    fn is_file(&self, document: &Document) -> bool {
        let image = self.image.map(|image| &document.images[image as usize]);
        image.is_some_and(ImageDef::is_file)
    }

    fn place(&self, document: &Document) -> String {
        match self.image {
            Some(image) => {
                let label = document.images[image as usize].label(image as usize);
                format!("images[{image}] ({label})")
            }
            None => "textures".to_owned(),
        }
    }

    fn promise(&self) -> Option<Promise> {
        self.encoded.as_ref().ok().map(|(_, promise)| *promise)
    }

    /// Memory of the textures made from it, with their mip levels, where none is larger than
    /// `largest`.
    fn kept_bytes(&self, largest: u32) -> u64 {
        self.reduced_size(largest).map_or(0, |size| {
            self.uses.iter().map(|one| self.bytes_of(*one, size)).sum()
        })
    }

    /// Width and height of its textures in texels.
    fn reduced_size(&self, largest: u32) -> Option<(u32, u32)> {
        let promise = self.promise()?;
        let drop = levels_to_drop(promise.width, promise.height, largest);
        let side = |size: u32| (size >> drop).max(1);
        Some((side(promise.width), side(promise.height)))
    }

    /// Memory of a texture made from it, of this size and with its mip levels.
    fn bytes_of(&self, one: Use, (width, height): (u32, u32)) -> u64 {
        let encoding = match one.encoding(width, height) {
            Encoding::Rgba8 => return rgba_chain_bytes(width, height),
            // KTX2 pictures are BC7 whatever is read of them.
            _ if self.is_ktx2() => Encoding::Bc7,
            encoding => encoding,
        };
        let side = |size: u32, level: u32| (size >> level).max(1);
        let level = |l| encoding.level_bytes(side(width, l), side(height, l));
        (0..mip::level_count(width, height)).map(level).sum()
    }

    fn is_ktx2(&self) -> bool {
        (self.encoded.as_ref()).is_ok_and(|(bytes, _)| basis::is_ktx2(bytes))
    }

    /// Memory while it is decoded, beside what is kept. What is reduced is not kept as it was
    /// decoded, and of several uses one after the other has a copy.
    fn decoding_bytes(&self, largest: u32) -> u64 {
        let (Some(promise), Some(size)) = (self.promise(), self.reduced_size(largest)) else {
            return 0;
        };
        let reduced = size != (promise.width, promise.height);
        let copies = u64::from(reduced) + u64::from(self.uses.len() > 1);
        // The levels as texels are there before they are in blocks. The decoder's share is free again
        // when these are made, and larger than they are: so compression never asks for more.
        let texels = rgba_chain_bytes(size.0, size.1);
        let before_blocks = |one: &Use| texels.saturating_sub(self.bytes_of(*one, size));
        let texels = self.uses.iter().map(before_blocks).max().unwrap_or(0);
        promise.decoding_bytes() + copies * promise.rgba_bytes() + texels
    }
}

/// Memory of a picture as RGBA8 with its mip levels.
fn rgba_chain_bytes(width: u32, height: u32) -> u64 {
    u64::from(width) * u64::from(height) * 16 / 3 + 4
}

/// How to decode within the limits.
struct Plan {
    /// The largest side of a texture in texels.
    largest: u32,
    /// How many pictures may be decoded at a time.
    at_once: usize,
}

/// Adds up what all pictures take by what their headers promise, before anything is decoded.
fn plan(
    sources: &[Source<'_>],
    document: &Document,
    options: &LoadOptions,
    budget: &Budget,
    warn: &mut Vec<Warning>,
) -> Parsed<Plan> {
    let limit = options.max_texture_bytes;
    let requested = options.max_texture_size.max(1);
    for source in sources {
        let bytes = source
            .decoding_bytes(1)
            .saturating_add(source.kept_bytes(1));
        if bytes > limit {
            let (width, height) = source.promise().map_or((0, 0), |p| (p.width, p.height));
            let cause = format!(
                "wants {} to decode {width} x {height} texels; the limit for textures is {}",
                amount(bytes),
                amount(limit)
            );
            return Err(Flaw::beyond(Limit::TextureBytes, cause).under(source.place(document)));
        }
    }
    let kept = |largest: u32| -> u64 { sources.iter().map(|s| s.kept_bytes(largest)).sum() };
    let decoding = |largest: u32| {
        let mut each: Vec<u64> = sources.iter().map(|s| s.decoding_bytes(largest)).collect();
        each.sort_unstable_by(|a, b| b.cmp(a));
        each
    };
    let most = |largest: u32| decoding(largest).first().copied().unwrap_or(0);
    let total = |largest: u32| kept(largest).saturating_add(most(largest));
    let mut largest = requested;
    while largest > 1 && total(largest) > limit {
        largest /= 2;
    }
    if largest < requested {
        warn.push(Warning::new(Code::TexturesReduced, format!(
            "images: want {} for textures; the limit is {}, and they are reduced to {largest} texels",
            amount(total(requested)),
            amount(limit)
        )));
    }
    let (total, decoding) = (total(largest), decoding(largest));
    let kept = kept(largest);
    // What decoding needs is given back at once.
    let needed = if total > budget.left() { total } else { kept };
    budget
        .take(needed, "textures")
        .map_err(|e| e.under("images"))?;
    let room = limit.saturating_sub(kept).min(budget.left());
    let mut sum = 0u64;
    let fitting = decoding.iter().take_while(|&&bytes| {
        sum = sum.saturating_add(bytes);
        sum <= room
    });
    Ok(Plan {
        largest,
        at_once: fitting.count().max(1),
    })
}

/// How often a picture is halved to fit.
fn levels_to_drop(width: u32, height: u32, largest: u32) -> usize {
    let mut drop = 0;
    while width.max(height) >> drop > largest {
        drop += 1;
    }
    drop
}

/// A picture's bytes are no picture.
fn unreadable(cause: String) -> Flaw {
    Flaw::new(Code::ImageUnreadable, cause)
}

/// What came of one picture.
struct Finished {
    textures: Vec<(usize, Texture)>,
    notes: Vec<Warning>,
}

/// The textures of a KTX2 file whose own blocks and levels are those that are wanted; else `None`. Mip
/// levels of an alpha mask are made anew: the file's own need not keep its coverage. Glossiness becomes
/// roughness first.
#[cfg(not(target_arch = "wasm32"))]
fn transcoded(
    source: &Source<'_>,
    wanted: &Wanted,
    document: &Document,
    largest: u32,
) -> Option<Finished> {
    let Ok((bytes, promise)) = &source.encoded else {
        return None;
    };
    let size = (promise.width, promise.height);
    let in_blocks = source.uses.iter().all(|one| one.kept.is_some());
    if !in_blocks || levels_to_drop(size.0, size.1, largest) > 0 {
        return None;
    }
    let has_levels = |one: &Use| wanted.keys[one.number].sampler.mip.is_some();
    let all = source.uses.iter().any(has_levels);
    let is_mask = |one: &Use| matches!(wanted.keys[one.number].role, Role::Cutout(Some(_)));
    let is_gloss = |one: &Use| matches!(wanted.keys[one.number].role, Role::Glossiness(_));
    if (source.uses.iter()).any(|one| is_gloss(one) || is_mask(one) && has_levels(one)) {
        return None;
    }
    // What cannot be transcoded is decoded, or says why not.
    let mut levels = pictures::blocks(bytes, *promise, all)?.ok()?;
    let mut textures = Vec::with_capacity(source.uses.len());
    for (nth, one) in source.uses.iter().enumerate() {
        let levels = if nth + 1 == source.uses.len() {
            std::mem::take(&mut levels)
        } else {
            levels.clone()
        };
        let key = &wanted.keys[one.number];
        let mut texture = texture(key, document, size, levels);
        texture.encoding = Encoding::Bc7;
        if key.sampler.mip.is_none() {
            texture.levels.truncate(1);
        }
        textures.push((one.number, texture));
    }
    let notes = Vec::new();
    Some(Finished { textures, notes })
}

fn finish(
    picture: Parsed<Picture>,
    uses: &[Use],
    wanted: &Wanted,
    document: &Document,
    largest: u32,
) -> Finished {
    let mut notes = Vec::new();
    let mut textures = Vec::with_capacity(uses.len());
    match picture {
        Ok(Picture {
            width,
            height,
            mut pixels,
        }) => {
            for (nth, one) in uses.iter().enumerate() {
                let last = nth + 1 == uses.len();
                let pixels = if last {
                    std::mem::take(&mut pixels)
                } else {
                    pixels.clone()
                };
                let key = &wanted.keys[one.number];
                let texture = build(key, one.kept, document, pixels, (width, height), largest);
                if last && texture.width < width {
                    notes.push(Warning::new(
                        Code::TexturesReduced,
                        format!(
                            "is {width} x {height} texels large and reduced to {} x {}",
                            texture.width, texture.height
                        ),
                    ));
                }
                textures.push((one.number, texture));
            }
        }
        Err(flaw) => {
            let text = format!("{}; a placeholder is shown", flaw.cause);
            notes.push(Warning::new(flaw.code, text));
            for one in uses {
                let key = &wanted.keys[one.number];
                let (pixels, side) = placeholder(key.role, wanted.only_emissive[one.number]);
                let texture = build(key, None, document, pixels, (side, side), largest);
                textures.push((one.number, texture));
            }
        }
    }
    Finished { textures, notes }
}

fn build(
    key: &Key,
    kept: Option<Kept>,
    document: &Document,
    pixels: Vec<u8>,
    (width, height): (u32, u32),
    largest: u32,
) -> Texture {
    let drop = levels_to_drop(width, height, largest);
    let pixels = key.role.texels(pixels);
    let mut levels = if key.sampler.mip.is_some() || drop > 0 {
        mip::chain(pixels, width, height, key.role.content())
    } else {
        vec![pixels]
    };
    levels.drain(..drop);
    if key.sampler.mip.is_none() {
        levels.truncate(1);
    }
    let size = ((width >> drop).max(1), (height >> drop).max(1));
    let mut texture = texture(key, document, size, levels);
    if let Some(kept) = kept {
        compress::compress(&mut texture, kept.read, kept.by);
    }
    texture
}

fn texture(
    key: &Key,
    document: &Document,
    (width, height): (u32, u32),
    levels: Vec<Vec<u8>>,
) -> Texture {
    let name = key.image.map_or_else(
        || "no picture".to_owned(),
        |i| document.images[i as usize].label(i as usize),
    );
    Texture {
        name,
        width,
        height,
        color_space: key.role.color_space(),
        sampler: key.sampler,
        encoding: Encoding::Rgba8,
        levels,
    }
}

/// Visible as a colour, neutral as anything else; square, with its side in texels.
fn placeholder(role: Role, only_emissive: bool) -> (Vec<u8>, u32) {
    let plain = |texel: [u8; 4]| (texel.to_vec(), 1);
    match role {
        // What glows must not outshine the rest.
        Role::Color if only_emissive => plain([0, 0, 0, 255]),
        Role::Color | Role::Cutout(_) => {
            let texel = |i: usize| {
                if (i % 8 + i / 8).is_multiple_of(2) {
                    [255, 0, 255, 255]
                } else {
                    [255, 255, 255, 255]
                }
            };
            ((0..64).flat_map(texel).collect(), 8)
        }
        Role::Data | Role::Glossiness(_) => plain([255; 4]),
        Role::Normal => plain([128, 128, 255, 255]),
    }
}
