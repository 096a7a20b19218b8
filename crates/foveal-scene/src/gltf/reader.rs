//! The elements of accessors as numbers: integer and normalized components, strides, sparse
//! substitution.

use super::accessor::{Accessor, Component};
use super::buffers::Buffers;
use super::document::Document;
use crate::Code;
use crate::error::{Flaw, Parsed};

/// Reads accessors of one document.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'a> {
    pub(crate) document: &'a Document,
    pub(crate) buffers: &'a Buffers<'a>,
}

/// Bytes with a stride: element i begins at i * stride.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn accessor(&self, index: u32) -> &'a Accessor {
        &self.document.accessors[index as usize]
    }

    /// `count` elements of `size` bytes in a view, checked against its end.
    fn strided(&self, view: u32, offset: u64, count: usize, size: usize) -> Parsed<Strided<'a>> {
        let bytes = self.buffers.view(self.document, view)?;
        let stride = self.document.views[view as usize]
            .stride
            .map_or(size, |s| s as usize);
        if stride < size {
            return Err(Flaw::new(
                Code::AccessorStride,
                format!("has elements of {size} bytes, bufferViews[{view}] a stride of {stride}"),
            ));
        }
        let len = match count {
            0 => 0,
            n => (n as u64 - 1) * stride as u64 + size as u64,
        };
        let end = offset.checked_add(len);
        if end.is_none_or(|end| end > bytes.len() as u64) {
            return Err(Flaw::new(
                Code::BufferTooShort,
                format!(
                    "needs {len} bytes from byte {offset} of bufferViews[{view}], which has {}",
                    bytes.len()
                ),
            ));
        }
        Ok(Strided {
            bytes: &bytes[offset as usize..(offset + len) as usize],
            stride,
        })
    }

    /// Elements of `N` numbers; integers become numbers, normalized ones within [-1, 1].
    pub(crate) fn floats<const N: usize>(&self, index: u32) -> Parsed<Vec<[f32; N]>> {
        let accessor = self.accessor(index);
        if accessor.width != N {
            return Err(Flaw::new(
                Code::AccessorType,
                format!(
                    "names accessors[{index}], whose elements have {} components instead of {N}",
                    accessor.width
                ),
            ));
        }
        let read = |source: Strided<'_>, count| {
            decode::<N>(&source, accessor.component, accessor.normalized, count)
        };
        self.dense(index, read, [0.0; N])
            .map_err(|e| within_accessor(e, index))
    }

    /// Elements of `N` whole numbers.
    pub(crate) fn uints<const N: usize>(&self, index: u32) -> Parsed<Vec<[u32; N]>> {
        let accessor = self.accessor(index);
        if accessor.width != N || !accessor.component.is_unsigned() {
            return Err(Flaw::new(
                Code::AccessorType,
                format!("names accessors[{index}], whose elements are not {N} unsigned integers"),
            ));
        }
        let read =
            |source: Strided<'_>, count| decode_uints::<N>(&source, accessor.component, count);
        self.dense(index, read, [0; N])
            .map_err(|e| within_accessor(e, index))
    }

    /// The base elements with sparse substitution applied.
    fn dense<T: Copy>(
        &self,
        index: u32,
        read: impl Fn(Strided<'a>, usize) -> Vec<T>,
        zero: T,
    ) -> Parsed<Vec<T>> {
        let accessor = self.accessor(index);
        let size = accessor.component.size() * accessor.width;
        self.buffers
            .take_numbers(accessor.count as u64 * accessor.width as u64)?;
        let mut elements = match accessor.view {
            Some(view) => {
                let source = self.strided(view, accessor.offset, accessor.count, size)?;
                read(source, accessor.count)
            }
            None if accessor.draco => {
                let bytes = self.buffers.dense(index)?;
                if bytes.len() < accessor.count * size {
                    return Err(Flaw::new(Code::CompressedData, "has too few Draco data"));
                }
                read(
                    Strided {
                        bytes,
                        stride: size,
                    },
                    accessor.count,
                )
            }
            None => {
                self.buffers.take_unbacked(accessor.unbacked_cost())?;
                vec![zero; accessor.count]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let at = self
                .strided(
                    sparse.indices_view,
                    sparse.indices_offset,
                    sparse.count,
                    sparse.indices.size(),
                )
                .map_err(|e| e.under("sparse.indices"))?;
            let at = decode_uints::<1>(&at, sparse.indices, sparse.count);
            let values = self
                .strided(sparse.values_view, sparse.values_offset, sparse.count, size)
                .map_err(|e| e.under("sparse.values"))?;
            for ([at], value) in at.into_iter().zip(read(values, sparse.count)) {
                let Some(element) = elements.get_mut(at as usize) else {
                    return Err(Flaw::new(
                        Code::IndexOutOfRange,
                        format!("names element {at}, there are {}", accessor.count),
                    )
                    .under("sparse.indices"));
                };
                *element = value;
            }
        }
        Ok(elements)
    }
}

/// The fault of an accessor, told at the place that refers to it.
fn within_accessor(mut flaw: Flaw, index: u32) -> Flaw {
    let inner = std::mem::take(&mut flaw.place);
    let dot = if inner.is_empty() { "" } else { "." };
    flaw.cause = format!("accessors[{index}]{dot}{inner} {}", flaw.cause);
    flaw
}

/// Little-endian numbers as the file stores them.
macro_rules! gather {
    ($source:expr, $count:expr, $type:ty, $n:ident, $convert:expr) => {{
        const SIZE: usize = size_of::<$type>();
        let convert = $convert;
        (0..$count)
            .map(|i| {
                let element = &$source.bytes[i * $source.stride..][..SIZE * $n];
                std::array::from_fn(|k| {
                    let mut bytes = [0; SIZE];
                    bytes.copy_from_slice(&element[k * SIZE..][..SIZE]);
                    convert(<$type>::from_le_bytes(bytes))
                })
            })
            .collect()
    }};
}

fn decode<const N: usize>(
    source: &Strided<'_>,
    component: Component,
    normalized: bool,
    count: usize,
) -> Vec<[f32; N]> {
    match (component, normalized) {
        (Component::F32, _) => gather!(source, count, f32, N, |x| x),
        (Component::U8, true) => gather!(source, count, u8, N, |x| f32::from(x) / 255.0),
        (Component::U8, false) => gather!(source, count, u8, N, f32::from),
        (Component::I8, true) => {
            gather!(source, count, i8, N, |x| (f32::from(x) / 127.0).max(-1.0))
        }
        (Component::I8, false) => gather!(source, count, i8, N, f32::from),
        (Component::U16, true) => gather!(source, count, u16, N, |x| f32::from(x) / 65535.0),
        (Component::U16, false) => gather!(source, count, u16, N, f32::from),
        (Component::I16, true) => {
            gather!(source, count, i16, N, |x| (f32::from(x) / 32767.0)
                .max(-1.0))
        }
        (Component::I16, false) => gather!(source, count, i16, N, f32::from),
        (Component::U32, true) => {
            gather!(source, count, u32, N, |x| (f64::from(x) / 4_294_967_295.0)
                as f32)
        }
        (Component::U32, false) => gather!(source, count, u32, N, |x| x as f32),
    }
}

/// Signed and floating-point components give zeros: the callers have refused them.
fn decode_uints<const N: usize>(
    source: &Strided<'_>,
    component: Component,
    count: usize,
) -> Vec<[u32; N]> {
    match component {
        Component::U8 => gather!(source, count, u8, N, u32::from),
        Component::U16 => gather!(source, count, u16, N, u32::from),
        Component::U32 => gather!(source, count, u32, N, |x| x),
        _ => vec![[0; N]; count],
    }
}
