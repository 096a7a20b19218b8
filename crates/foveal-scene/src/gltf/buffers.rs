//! The bytes behind the buffers, and the budget for elements that no bytes stand for.

use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

use super::Resolver;
use super::document::{BufferDef, Document};
use super::uri::{self, Uri};
use crate::error::{Flaw, Parsed};

/// All buffers of a document. One that cannot be had fails only when something reads it.
pub(crate) struct Buffers<'a> {
    bytes: Vec<Result<Cow<'a, [u8]>, Flaw>>,
    unbacked_left: AtomicU64,
    unbacked_limit: u64,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer. `unbacked_limit` bounds the elements of accessors without a buffer view.
    pub(crate) fn fetch(
        defs: &[BufferDef],
        bin: Option<&'a [u8]>,
        resolver: &Resolver<'_>,
        unbacked_limit: u64,
    ) -> Self {
        let bytes = defs
            .iter()
            .enumerate()
            .map(|(i, def)| {
                fetch_one(def, bin.filter(|_| i == 0), resolver)
                    .map_err(|cause| Flaw::new(cause).under(format_args!("buffers[{i}]")))
            })
            .collect();
        Self {
            bytes,
            unbacked_left: AtomicU64::new(unbacked_limit),
            unbacked_limit,
        }
    }

    /// The faults of all buffers that could not be had.
    pub(crate) fn faults(&self) -> impl Iterator<Item = &Flaw> {
        self.bytes.iter().filter_map(|b| b.as_ref().err())
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, document: &Document, view: u32) -> Parsed<&[u8]> {
        let def = &document.views[view as usize];
        let bytes = self.bytes[def.buffer as usize]
            .as_ref()
            .map_err(Clone::clone)?;
        let (start, end) = (def.offset as usize, (def.offset + def.len) as usize);
        bytes
            .get(start..end)
            .ok_or_else(|| Flaw::new(format!("bufferViews[{view}] ends beyond its buffer")))
    }

    /// Counts elements that exist only by declaration: a short file must not fill the memory with zeros.
    pub(crate) fn take_unbacked(&self, elements: u64) -> Parsed<()> {
        let taken = self
            .unbacked_left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                left.checked_sub(elements)
            });
        taken.map(|_| ()).map_err(|_| {
            Flaw::too_large(format!(
                "{elements} elements without stored values exceed the limit of {} in all",
                self.unbacked_limit
            ))
        })
    }
}

fn fetch_one<'a>(
    def: &BufferDef,
    bin: Option<&'a [u8]>,
    resolver: &Resolver<'_>,
) -> Result<Cow<'a, [u8]>, String> {
    let bytes: Cow<'a, [u8]> = match (&def.uri, bin) {
        (None, Some(bin)) => Cow::Borrowed(bin),
        (None, None) => return Err("has neither a URI nor a binary chunk".to_owned()),
        (Some(text), _) => match uri::parse(text).map_err(|e| format!("its URI {e}"))? {
            Uri::Data(bytes) => Cow::Owned(bytes),
            Uri::File(path) => Cow::Owned(resolver(&path)?),
        },
    };
    if (bytes.len() as u64) < def.len {
        return Err(format!("has {} bytes instead of {}", bytes.len(), def.len));
    }
    Ok(bytes)
}
