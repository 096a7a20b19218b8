//! Definitions of accessors (glTF 2.0 specification, section 3.6.2); [`reader`](super::reader)
//! gives their elements.

use std::collections::HashMap;

use super::document::Counts;
use super::json::Obj;
use crate::Code;
use crate::error::{Flaw, Parsed};

/// Type of one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn parse(o: Obj<'_>) -> Parsed<Self> {
        let code = o.need("componentType", o.uint("componentType")?)?;
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                return Err(Flaw::new(
                    Code::ValueUnknown,
                    format!("is {code}, not a component type"),
                )
                .under("componentType"));
            }
        })
    }

    /// Whether its numbers are whole and not signed.
    pub(crate) fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// For each accessor the first one that reads the same: meshes that differ by nothing else are
/// built once.
pub(crate) fn first_of_equal(accessors: &[Accessor]) -> Vec<u32> {
    let mut first = HashMap::new();
    let number = |(i, accessor): (usize, &'_ Accessor)| {
        // What nothing stores may come from elsewhere.
        if accessor.view.is_none() {
            return i as u32;
        }
        *first.entry(accessor.clone()).or_insert(i as u32)
    };
    accessors.iter().enumerate().map(number).collect()
}

/// Replacement of single elements.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct Sparse {
    pub(crate) count: usize,
    pub(crate) indices_view: u32,
    pub(crate) indices_offset: u64,
    pub(crate) indices: Component,
    pub(crate) values_view: u32,
    pub(crate) values_offset: u64,
}

/// An accessor whose own properties are in order; its extent is checked when it is read.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct Accessor {
    pub(crate) view: Option<u32>,
    pub(crate) offset: u64,
    pub(crate) count: usize,
    pub(crate) component: Component,
    /// Components per element.
    pub(crate) width: usize,
    pub(crate) normalized: bool,
    pub(crate) sparse: Option<Sparse>,
    /// Its elements come out of a Draco stream.
    pub(crate) draco: bool,
}

impl Accessor {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let count = o.need("count", o.uint("count")?)?;
        if count > u64::from(u32::MAX) {
            return Err(Flaw::new(
                Code::ValueOutOfRange,
                format!("is {count}, more than can be indexed"),
            )
            .under("count"));
        }
        let kind = o.need("type", o.string("type")?)?;
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => {
                return Err(
                    Flaw::new(Code::ValueUnknown, format!("\"{kind}\" is not a type"))
                        .under("type"),
                );
            }
        };
        let sparse = match o.object("sparse")? {
            Some(s) => {
                Some(Sparse::parse(s, counts, count as usize).map_err(|e| e.under("sparse"))?)
            }
            None => None,
        };
        Ok(Self {
            view: o.index("bufferView", counts.views)?,
            offset: o.uint("byteOffset")?.unwrap_or(0),
            count: count as usize,
            component: Component::parse(o)?,
            width,
            normalized: o.boolean("normalized")?.unwrap_or(false),
            sparse,
            draco: false,
        })
    }

    /// Elements that take memory here without taking any in the file.
    pub(crate) fn unbacked(&self) -> u64 {
        if self.view.is_none() && !self.draco {
            self.count as u64
        } else {
            0
        }
    }

    /// The same, but an eighth of it for sparse accessors: morph targets have good reason to be so.
    pub(crate) fn unbacked_cost(&self) -> u64 {
        let share = if self.sparse.is_some() { 8 } else { 1 };
        self.unbacked() / share
    }
}

impl Sparse {
    fn parse(o: Obj<'_>, counts: &Counts, elements: usize) -> Parsed<Self> {
        let count = o.need("count", o.uint("count")?)?;
        if count > elements as u64 {
            return Err(Flaw::new(
                Code::ValueOutOfRange,
                format!("is {count}, the accessor has {elements} elements"),
            )
            .under("count"));
        }
        let indices = o.need("indices", o.object("indices")?)?;
        let values = o.need("values", o.object("values")?)?;
        let part = |o: Obj<'_>| -> Parsed<(u32, u64)> {
            let view = o.need("bufferView", o.index("bufferView", counts.views)?)?;
            Ok((view, o.uint("byteOffset")?.unwrap_or(0)))
        };
        let (indices_view, indices_offset) = part(indices).map_err(|e| e.under("indices"))?;
        let (values_view, values_offset) = part(values).map_err(|e| e.under("values"))?;
        let component = Component::parse(indices).map_err(|e| e.under("indices"))?;
        if !component.is_unsigned() {
            let cause = "is not a type of unsigned integers: 5121, 5123 or 5125";
            return Err(Flaw::new(Code::ValueUnknown, cause).under("indices.componentType"));
        }
        Ok(Self {
            count: count as usize,
            indices_view,
            indices_offset,
            indices: component,
            values_view,
            values_offset,
        })
    }
}
