//! Decoders of EXT_meshopt_compression and KHR_meshopt_compression, from bytes to the bytes of a
//! plain buffer view.
//!
//! The formats are those of the extensions' specifications (Kapoulkine 2021 and 2025), which also
//! give the bounds that a stream must keep. All reads are checked: a broken stream is an error,
//! never more. Written here and not bound from the C++ library, because files from strangers are
//! decoded and because the page for browsers has no C++ compiler.

mod bytes;
mod filters;
mod indices;
mod vertices;

#[cfg(test)]
mod tests;

use crate::Code;
use crate::error::{Flaw, Parsed};
use crate::gltf::json::Obj;

/// How a compressed view's elements are coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Elements of any type, byte by byte.
    Attributes,
    /// Triangle lists.
    Triangles,
    /// Other sequences of indices.
    Indices,
}

/// What is done to decoded elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Filter {
    /// Nothing.
    None,
    /// Unit vectors from octahedra.
    Octahedral,
    /// Unit quaternions from three of their numbers.
    Quaternion,
    /// Floating-point numbers from exponent and mantissa.
    Exponential,
    /// RGBA from YCoCg and alpha.
    Color,
}

/// A compressed view as the file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Coded {
    pub(crate) buffer: u32,
    pub(crate) offset: u64,
    pub(crate) len: u64,
    /// Bytes per element.
    pub(crate) stride: usize,
    pub(crate) count: usize,
    mode: Mode,
    filter: Filter,
}

impl Coded {
    /// Reads the extension's object.
    pub(crate) fn parse(o: Obj<'_>, buffers: usize) -> Parsed<Self> {
        let mode = match o.need("mode", o.string("mode")?)? {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => {
                return Err(
                    Flaw::new(Code::ValueUnknown, format!("\"{other}\" is not a mode"))
                        .under("mode"),
                );
            }
        };
        let filter = match o.string("filter")? {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some("COLOR") => Filter::Color,
            Some(other) => {
                return Err(
                    Flaw::new(Code::ValueUnknown, format!("\"{other}\" is not a filter"))
                        .under("filter"),
                );
            }
        };
        let coded = Self {
            buffer: o.need("buffer", o.index("buffer", buffers)?)?,
            offset: o.uint("byteOffset")?.unwrap_or(0),
            len: o.need("byteLength", o.uint("byteLength")?)?,
            stride: o.need("byteStride", o.uint("byteStride")?)? as usize,
            count: o.need("count", o.uint("count")?)? as usize,
            mode,
            filter,
        };
        coded
            .check()
            .map(|()| coded)
            .map_err(|cause| Flaw::new(Code::ValueOutOfRange, cause))
    }

    fn check(&self) -> Result<(), String> {
        let (stride, count) = (self.stride, self.count);
        let fits = match self.mode {
            Mode::Attributes => (4..=256).contains(&stride) && stride.is_multiple_of(4),
            Mode::Triangles => matches!(stride, 2 | 4) && count.is_multiple_of(3),
            Mode::Indices => matches!(stride, 2 | 4),
        };
        let filterable = match self.filter {
            Filter::None => true,
            _ if self.mode != Mode::Attributes => false,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
            Filter::Exponential => true,
        };
        if !fits || !filterable || count > u32::MAX as usize {
            return Err(format!(
                "has {count} elements of {stride} bytes, which mode {:?} with filter {:?} does not allow",
                self.mode, self.filter
            ));
        }
        Ok(())
    }

    /// Bytes of the plain view.
    pub(crate) fn decoded_len(&self) -> u64 {
        self.stride as u64 * self.count as u64
    }

    /// The plain view's bytes.
    pub(crate) fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, String> {
        let (stride, count) = (self.stride, self.count);
        let decoded = match self.mode {
            Mode::Attributes => vertices::decode(bytes, count, stride),
            Mode::Triangles => indices::triangles(bytes, count, stride),
            Mode::Indices => indices::sequence(bytes, count, stride),
        };
        let mut decoded = decoded.ok_or("its meshopt data are broken")?;
        match (self.filter, stride) {
            (Filter::None, _) => {}
            (Filter::Octahedral, 4) => filters::octahedral8(&mut decoded),
            (Filter::Octahedral, _) => filters::octahedral16(&mut decoded),
            (Filter::Quaternion, _) => filters::quaternion(&mut decoded),
            (Filter::Exponential, _) => filters::exponential(&mut decoded),
            (Filter::Color, 4) => filters::color8(&mut decoded),
            (Filter::Color, _) => filters::color16(&mut decoded),
        }
        Ok(decoded)
    }
}
