//! Reading JSON objects with checked types; every fault names its place.
//!
//! glTF is read from untyped JSON rather than through a derived deserializer because the latter
//! reports line numbers where users need `nodes[3].children[0]`.

use serde_json::{Map, Value};

use crate::Code;
use crate::error::{Flaw, Parsed};

/// A JSON object.
#[derive(Clone, Copy)]
pub(crate) struct Obj<'a>(&'a Map<String, Value>);

/// The JSON type's name for messages.
fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

fn wrong(value: &Value, expected: &str) -> Flaw {
    Flaw::new(
        Code::ValueType,
        format!("is {} instead of {expected}", type_name(value)),
    )
}

fn to_float(value: &Value) -> Parsed<f32> {
    let number = value.as_f64().ok_or_else(|| wrong(value, "a number"))? as f32;
    if number.is_finite() {
        Ok(number)
    } else {
        Err(Flaw::new(
            Code::ValueOutOfRange,
            "is beyond the range of 32-bit numbers",
        ))
    }
}

fn to_uint(value: &Value) -> Parsed<u64> {
    // Some exporters write integers as 3.0.
    let whole = |x: f64| ((0.0..1e15).contains(&x) && x.fract() == 0.0).then_some(x as u64);
    value
        .as_u64()
        .or_else(|| value.as_f64().and_then(whole))
        .ok_or_else(|| {
            if value.is_number() {
                Flaw::new(
                    Code::ValueOutOfRange,
                    format!("is {value} instead of a whole number from 0 on"),
                )
            } else {
                wrong(value, "a whole number")
            }
        })
}

fn to_index(value: &Value, len: usize) -> Parsed<u32> {
    let index = to_uint(value)?;
    if index < len as u64 && index < u64::from(u32::MAX) {
        Ok(index as u32)
    } else {
        Err(Flaw::new(
            Code::IndexOutOfRange,
            format!("names number {index}, there are {len}"),
        ))
    }
}

/// A name, cut where it is longer than any name: it may be copied for each of a million instances.
pub(crate) fn cut_name(name: &str) -> String {
    const MOST_BYTES: usize = 1024;
    name[..name.floor_char_boundary(MOST_BYTES)].to_owned()
}

impl<'a> Obj<'a> {
    pub(crate) fn of(value: &'a Value) -> Parsed<Self> {
        value
            .as_object()
            .map(Self)
            .ok_or_else(|| wrong(value, "an object"))
    }

    pub(crate) fn get(self, key: &str) -> Option<&'a Value> {
        self.0.get(key)
    }

    pub(crate) fn has(self, key: &str) -> bool {
        self.0.contains_key(key)
    }

    pub(crate) fn entries(self) -> impl Iterator<Item = (&'a String, &'a Value)> {
        self.0.iter()
    }

    /// Applies `f` to the value of `key`, when there is one.
    pub(crate) fn read<T>(
        self,
        key: &str,
        f: impl FnOnce(&'a Value) -> Parsed<T>,
    ) -> Parsed<Option<T>> {
        self.get(key)
            .map(|v| f(v).map_err(|e| e.under(key)))
            .transpose()
    }

    pub(crate) fn need<T>(self, key: &str, found: Option<T>) -> Parsed<T> {
        found.ok_or_else(|| Flaw::new(Code::ValueMissing, "is missing").under(key))
    }

    pub(crate) fn uint(self, key: &str) -> Parsed<Option<u64>> {
        self.read(key, to_uint)
    }

    /// An index below `len`.
    pub(crate) fn index(self, key: &str, len: usize) -> Parsed<Option<u32>> {
        self.read(key, |v| to_index(v, len))
    }

    pub(crate) fn indices(self, key: &str, len: usize) -> Parsed<Vec<u32>> {
        self.each(key, |v| to_index(v, len))
    }

    pub(crate) fn float(self, key: &str) -> Parsed<Option<f32>> {
        self.read(key, to_float)
    }

    pub(crate) fn floats<const N: usize>(self, key: &str) -> Parsed<Option<[f32; N]>> {
        if !self.has(key) {
            return Ok(None);
        }
        let other = |len: usize| {
            let text = format!("has {len} numbers instead of {N}");
            Flaw::new(Code::ValueType, text).under(key)
        };
        // Before the numbers are read: a file may come back to a long list very often.
        if let Some(list) = self
            .get(key)
            .and_then(Value::as_array)
            .filter(|l| l.len() != N)
        {
            return Err(other(list.len()));
        }
        let list = self.each(key, to_float)?;
        let len = list.len();
        <[f32; N]>::try_from(list).map(Some).map_err(|_| other(len))
    }

    pub(crate) fn float_list(self, key: &str) -> Parsed<Vec<f32>> {
        self.each(key, to_float)
    }

    /// Rows of `N` numbers each.
    pub(crate) fn float_rows<const N: usize>(self, key: &str) -> Parsed<Option<Vec<[f32; N]>>> {
        self.rows(key, to_float)
    }

    /// Rows of `N` indices below `len` each.
    pub(crate) fn index_rows<const N: usize>(
        self,
        key: &str,
        len: usize,
    ) -> Parsed<Option<Vec<[u32; N]>>> {
        self.rows(key, |v| to_index(v, len))
    }

    fn rows<T: Copy + Default, const N: usize>(
        self,
        key: &str,
        read: impl Fn(&Value) -> Parsed<T>,
    ) -> Parsed<Option<Vec<[T; N]>>> {
        if !self.has(key) {
            return Ok(None);
        }
        let row = |value: &Value| {
            let list = value.as_array().ok_or_else(|| wrong(value, "an array"))?;
            if list.len() != N {
                let text = format!("has {} numbers instead of {N}", list.len());
                return Err(Flaw::new(Code::ValueType, text));
            }
            let mut numbers = [T::default(); N];
            for (i, (number, value)) in numbers.iter_mut().zip(list).enumerate() {
                *number = read(value).map_err(|e| e.under(format_args!("[{i}]")))?;
            }
            Ok(numbers)
        };
        self.each(key, row).map(Some)
    }

    pub(crate) fn string(self, key: &str) -> Parsed<Option<&'a str>> {
        self.read(key, |v| v.as_str().ok_or_else(|| wrong(v, "a string")))
    }

    /// A name for people, cut.
    pub(crate) fn name(self, key: &str) -> Parsed<Option<String>> {
        Ok(self.string(key)?.map(cut_name))
    }

    pub(crate) fn strings(self, key: &str) -> Parsed<Vec<&'a str>> {
        self.each(key, |v| v.as_str().ok_or_else(|| wrong(v, "a string")))
    }

    pub(crate) fn boolean(self, key: &str) -> Parsed<Option<bool>> {
        self.read(key, |v| v.as_bool().ok_or_else(|| wrong(v, "a boolean")))
    }

    pub(crate) fn object(self, key: &str) -> Parsed<Option<Self>> {
        self.read(key, Self::of)
    }

    /// `extensions.<name>`.
    pub(crate) fn extension(self, name: &str) -> Parsed<Option<Self>> {
        match self.object("extensions")? {
            Some(all) => all.object(name).map_err(|e| e.under("extensions")),
            None => Ok(None),
        }
    }

    /// The array's elements through `f`; empty when the key is absent.
    pub(crate) fn each<T>(
        self,
        key: &str,
        mut f: impl FnMut(&'a Value) -> Parsed<T>,
    ) -> Parsed<Vec<T>> {
        let Some(value) = self.get(key) else {
            return Ok(Vec::new());
        };
        let array = value
            .as_array()
            .ok_or_else(|| wrong(value, "an array").under(key))?;
        array
            .iter()
            .enumerate()
            .map(|(i, v)| f(v).map_err(|e| e.under(format_args!("{key}[{i}]"))))
            .collect()
    }

    /// The array's objects through `f`.
    pub(crate) fn objects<T>(
        self,
        key: &str,
        mut f: impl FnMut(Obj<'a>) -> Parsed<T>,
    ) -> Parsed<Vec<T>> {
        self.each(key, |v| f(Obj::of(v)?))
    }

    /// Number of elements of the array at `key`, 0 without one.
    pub(crate) fn len_of(self, key: &str) -> usize {
        self.get(key).and_then(Value::as_array).map_or(0, Vec::len)
    }
}
