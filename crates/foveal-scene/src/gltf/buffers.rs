//! The bytes behind the buffers, and the budgets that keep short files from becoming long vectors.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use super::Resolver;
use super::document::{BufferDef, Document};
use super::uri::{self, Uri};
use crate::error::{Flaw, Parsed};

/// Numbers that all accessors together may yield: overlapping accessors can make many out of few bytes.
const MAX_NUMBERS: u64 = 1 << 30;

/// Elements without stored values that all accessors together may have.
pub(crate) const MAX_UNBACKED: u64 = 2 << 20;

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
    unbacked: Budget,
    numbers: Budget,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer.
    pub(crate) fn fetch(
        defs: &[BufferDef],
        bin: Option<&'a [u8]>,
        resolver: &Resolver<'_>,
    ) -> Self {
        let mut store = Store {
            stored: Vec::new(),
            by_uri: HashMap::new(),
            resolver,
        };
        let sources = defs
            .iter()
            .enumerate()
            .map(|(i, def)| {
                store
                    .source(def, bin.filter(|_| i == 0))
                    .map_err(|cause| Flaw::new(cause).under(format_args!("buffers[{i}]")))
            })
            .collect();
        Self {
            bin: bin.unwrap_or_default(),
            stored: store.stored,
            sources,
            unbacked: Budget::new(MAX_UNBACKED),
            numbers: Budget::new(MAX_NUMBERS),
        }
    }

    /// The faults of all buffers that could not be had.
    pub(crate) fn faults(&self) -> impl Iterator<Item = &Flaw> {
        self.sources.iter().filter_map(|b| b.as_ref().err())
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, document: &Document, view: u32) -> Parsed<&[u8]> {
        let def = &document.views[view as usize];
        let bytes = match &self.sources[def.buffer as usize] {
            Ok(Source::Bin) => self.bin,
            Ok(Source::Stored(i)) => self.stored[*i].as_slice(),
            Err(flaw) => return Err(Flaw::new(flaw.sentence())),
        };
        let (start, end) = (def.offset as usize, (def.offset + def.len) as usize);
        bytes
            .get(start..end)
            .ok_or_else(|| Flaw::new(format!("bufferViews[{view}] ends beyond its buffer")))
    }

    /// Counts elements that exist only by declaration: a short file must not fill the memory with zeros.
    pub(crate) fn take_unbacked(&self, elements: u64) -> Parsed<()> {
        self.unbacked
            .take(elements, "elements without stored values")
    }

    /// Counts all numbers that are read.
    pub(crate) fn take_numbers(&self, numbers: u64) -> Parsed<()> {
        self.numbers.take(numbers, "numbers in accessors")
    }
}

/// Something that runs out.
struct Budget {
    limit: u64,
    left: AtomicU64,
}

impl Budget {
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
                Flaw::too_large(format!(
                    "has {amount} {what}, more than the limit of {} in all leaves",
                    self.limit
                ))
            })
    }
}

/// Files by URI, each fetched once.
struct Store<'r> {
    stored: Vec<Vec<u8>>,
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
            Uri::File(path) => (self.resolver)(&path)?,
        };
        self.stored.push(bytes);
        let number = self.stored.len() - 1;
        self.by_uri.insert(text.to_owned(), number);
        Ok(number)
    }
}
