//! The bytes behind the buffers, decompressed where they are compressed, and the budgets that keep
//! short files from becoming long vectors.

use std::collections::{HashMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

use super::Resolver;
use super::budget::Budget;
use super::document::{BufferDef, Document};
use super::draco::DracoDef;
use super::meshopt::Coded;
use super::uri::{self, Uri};
use crate::error::{Flaw, Limit, Parsed};
use crate::{Code, LoadOptions, threads};

/// Numbers that all accessors together may yield, beside one for each [`NUMBER_BYTES`] of memory
/// that the files may ask for by their size: overlapping accessors can make many out of few bytes.
const FREE_NUMBERS: u64 = 64 << 20;
const NUMBER_BYTES: u64 = 4;

/// Of the memory that the files may ask for, so much allows an element without stored values: what
/// is made of it takes more than itself.
const UNBACKED_BYTES: u64 = 80;

/// Where a buffer's bytes are.
enum Source {
    /// The container's binary chunk.
    Bin,
    /// Number of a file in the store.
    Stored(usize),
}

/// All buffers of a document. One that cannot be had fails only when something reads it.
pub(crate) struct Buffers<'a> {
    bin: &'a [u8],
    stored: Vec<Vec<u8>>,
    sources: Vec<Result<Source, Flaw>>,
    /// Buffers that may be missing.
    fallback: Vec<bool>,
    unbacked: Count,
    numbers: Count,
    /// Memory that the scene may still ask for.
    pub(crate) budget: Budget,
    /// Compressed views as they would be without compression, by view.
    plain: HashMap<u32, Parsed<Vec<u8>>>,
    /// Elements out of Draco streams, by accessor.
    dense: HashMap<u32, Parsed<Vec<u8>>>,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer. `json` is the number of bytes of the document itself.
    pub(crate) fn fetch(
        defs: &[BufferDef],
        json: usize,
        bin: Option<&'a [u8]>,
        options: &LoadOptions,
        resolver: &Resolver<'_>,
    ) -> Self {
        let mut store = Store {
            stored: Vec::new(),
            read: Vec::new(),
            by_uri: HashMap::new(),
            resolver,
        };
        let sources = defs
            .iter()
            .enumerate()
            .map(|(i, def)| {
                store.source(def, bin.filter(|_| i == 0)).map_err(|cause| {
                    Flaw::new(Code::BufferUnreadable, cause).under(format_args!("buffers[{i}]"))
                })
            })
            .collect();
        let files = bin
            .iter()
            .map(|b| b.len())
            .chain(store.read.iter().copied());
        let input: u64 = files.chain([json]).map(|len| len as u64).sum();
        let numbers = input.saturating_mul(options.max_expansion) / NUMBER_BYTES;
        let budget = Budget::new(input, options);
        Self {
            bin: bin.unwrap_or_default(),
            stored: store.stored,
            sources,
            fallback: defs.iter().map(|def| def.fallback).collect(),
            unbacked: Count::new(budget.allowed() / UNBACKED_BYTES),
            numbers: Count::new(FREE_NUMBERS.saturating_add(numbers)),
            budget,
            plain: HashMap::new(),
            dense: HashMap::new(),
        }
    }

    /// Decodes what is compressed. What is broken fails only when something reads it; what is too
    /// large is an error.
    pub(crate) fn decompress(&mut self, document: &Document, parallel: bool) -> Parsed<()> {
        let views = 0..document.views.len() as u32;
        let coded: Vec<(u32, &Coded)> = views
            .filter_map(|i| Some((i, document.views[i as usize].coded.as_ref()?)))
            .collect();
        for (i, coded) in &coded {
            self.budget
                .take(coded.decoded_len(), "decompressed data")
                .map_err(|e| e.under(format_args!("bufferViews[{i}]")))?;
        }
        let plain = threads::map(parallel, &coded, |(_, coded)| {
            let bytes = self.bytes(coded.buffer)?;
            let end = coded.offset.saturating_add(coded.len);
            let place = usize::try_from(coded.offset)
                .ok()
                .zip(usize::try_from(end).ok());
            let slice = place.and_then(|(start, end)| bytes.get(start..end));
            slice
                .ok_or_else(|| "its compressed data end beyond their buffer".to_owned())
                .and_then(|bytes| coded.decode(bytes))
                .map_err(|cause| Flaw::new(Code::CompressedData, cause))
        });
        self.plain = coded.iter().map(|(i, _)| *i).zip(plain).collect();

        let primitives = document.meshes.iter().flat_map(|m| &m.primitives);
        let mut seen = HashSet::new();
        let streams: Vec<&DracoDef> = primitives
            .filter_map(|p| p.draco.as_ref())
            .filter(|def| {
                def.accessors()
                    .any(|a| document.accessors[a as usize].draco)
            })
            .filter(|def| seen.insert(*def))
            .collect();
        for def in &streams {
            let bytes = def.decoding_bytes(&document.accessors);
            self.budget
                .take(bytes, "Draco meshes")
                .map_err(|e| e.under(format_args!("bufferViews[{}]", def.view)))?;
        }
        let decoded = threads::map(parallel, &streams, |def| {
            let bytes = self.view(document, def.view)?;
            // The decoder promises not to panic; should it, this mesh is broken and nothing else.
            catch_unwind(AssertUnwindSafe(|| def.decode(bytes, &document.accessors)))
                .unwrap_or_else(|_| {
                    Err(Flaw::new(
                        Code::CompressedData,
                        "is broken: the decoder failed",
                    ))
                })
                .map_err(|e| e.under(format_args!("its Draco data in bufferViews[{}]", def.view)))
        });
        for (def, decoded) in streams.iter().zip(decoded) {
            match decoded {
                Ok(all) => {
                    let all = all.into_iter().map(|d| (d.accessor, Ok(d.bytes)));
                    self.dense.extend(all);
                }
                Err(flaw) => {
                    let flaw = Flaw::new(flaw.code, flaw.sentence());
                    let all = def.accessors().map(|a| (a, Err(flaw.clone())));
                    self.dense.extend(all);
                }
            }
        }
        Ok(())
    }

    /// The elements of an accessor that nothing but a Draco stream stores.
    pub(crate) fn dense(&self, accessor: u32) -> Parsed<&[u8]> {
        match self.dense.get(&accessor) {
            Some(Ok(bytes)) => Ok(bytes),
            Some(Err(flaw)) => Err(flaw.clone()),
            None => Err(Flaw::new(Code::CompressedData, "has no Draco data")),
        }
    }

    /// The faults of all buffers that could not be had.
    pub(crate) fn faults(&self) -> impl Iterator<Item = &Flaw> {
        let missing = self.sources.iter().zip(&self.fallback);
        let missing = missing.filter(|(_, fallback)| !**fallback);
        missing.filter_map(|(b, _)| b.as_ref().err())
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, document: &Document, view: u32) -> Parsed<&[u8]> {
        let def = &document.views[view as usize];
        if let Some(plain) = self.plain.get(&view) {
            return match plain {
                Ok(bytes) => bytes.get(..def.len as usize).ok_or_else(|| {
                    Flaw::new(
                        Code::BufferTooShort,
                        format!("bufferViews[{view}] ends beyond its data"),
                    )
                }),
                Err(flaw) => Err(Flaw::new(
                    flaw.code,
                    format!("bufferViews[{view}]: {}", flaw.cause),
                )),
            };
        }
        let bytes = self.bytes(def.buffer)?;
        let (start, end) = (def.offset as usize, (def.offset + def.len) as usize);
        bytes.get(start..end).ok_or_else(|| {
            Flaw::new(
                Code::BufferTooShort,
                format!("bufferViews[{view}] ends beyond its buffer"),
            )
        })
    }

    /// All bytes of a buffer.
    fn bytes(&self, buffer: u32) -> Parsed<&[u8]> {
        match &self.sources[buffer as usize] {
            Ok(Source::Bin) => Ok(self.bin),
            Ok(Source::Stored(i)) => Ok(self.stored[*i].as_slice()),
            Err(flaw) => Err(Flaw::new(flaw.code, flaw.sentence())),
        }
    }

    /// Counts elements that exist only by declaration: a short file must not fill the memory with
    /// zeros.
    pub(crate) fn take_unbacked(&self, elements: u64) -> Parsed<()> {
        self.unbacked
            .take(elements, "elements without stored values")
    }

    /// Counts all numbers that are read.
    pub(crate) fn take_numbers(&self, numbers: u64) -> Parsed<()> {
        self.numbers.take(numbers, "numbers in accessors")
    }
}

/// Something that runs out, of which `--max-expansion` gives more.
struct Count {
    limit: u64,
    left: AtomicU64,
}

impl Count {
    fn new(limit: u64) -> Self {
        Self {
            limit,
            left: AtomicU64::new(limit),
        }
    }

    fn take(&self, amount: u64, what: &str) -> Parsed<()> {
        let rest = |left: u64| left.checked_sub(amount);
        self.left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, rest)
            .map(|_| ())
            .map_err(|_| {
                Flaw::beyond(
                    Limit::Expansion,
                    format!(
                        "has {amount} {what}, more than the limit of {} in all leaves",
                        self.limit
                    ),
                )
            })
    }
}

/// Files by URI, each fetched once.
struct Store<'r> {
    stored: Vec<Vec<u8>>,
    /// Sizes of external files; data URIs are part of the document.
    read: Vec<usize>,
    by_uri: HashMap<String, usize>,
    resolver: &'r Resolver<'r>,
}

impl Store<'_> {
    fn source(&mut self, def: &BufferDef, bin: Option<&[u8]>) -> Result<Source, String> {
        let (source, available) = match (&def.uri, bin) {
            (None, Some(bin)) => (Source::Bin, bin.len()),
            (None, None) => return Err("has neither a URI nor a binary chunk".to_owned()),
            (Some(text), _) => {
                let number = self.fetch(text)?;
                (Source::Stored(number), self.stored[number].len())
            }
        };
        if (available as u64) < def.len {
            return Err(format!("has {available} bytes instead of {}", def.len));
        }
        Ok(source)
    }

    fn fetch(&mut self, text: &str) -> Result<usize, String> {
        if let Some(&number) = self.by_uri.get(text) {
            return Ok(number);
        }
        let bytes = match uri::parse(text).map_err(|e| format!("its URI {e}"))? {
            Uri::Data(bytes) => bytes,
            Uri::File(path) => {
                let bytes = (self.resolver)(&path)?;
                self.read.push(bytes.len());
                bytes
            }
        };
        self.stored.push(bytes);
        let number = self.stored.len() - 1;
        self.by_uri.insert(text.to_owned(), number);
        Ok(number)
    }
}
