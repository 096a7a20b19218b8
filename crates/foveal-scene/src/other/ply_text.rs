//! Elements of PLY files in text, a line each; empty lines are none. Numbers are what Rust and C99
//! (`%f`, `%g`) write: the crate `ply-rs-bw` refuses `nan`, `-nan(ind)`, `inf`, `1.` and `.5`.

use std::io::{BufRead, Cursor};
use std::str::{FromStr, SplitAsciiWhitespace};

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyType, ScalarType};

use super::numbers::parsed;

/// Reads all elements of a kind.
pub(super) fn elements<E: PropertyAccess>(
    from: &mut Cursor<&[u8]>,
    kind: &ElementDef,
    line_end: u8,
) -> Result<Vec<E>, String> {
    let mut found = Vec::with_capacity(kind.count);
    let mut line = Vec::new();
    while found.len() < kind.count {
        line.clear();
        let length = from.read_until(line_end, &mut line);
        if length.map_err(|error| error.to_string())? == 0 {
            let (name, count) = (&kind.name, kind.count);
            let there = found.len();
            return Err(format!("has {there} elements {name} instead of {count}"));
        }
        if !line.trim_ascii().is_empty() {
            let read = element(&line, kind);
            found.push(
                read.map_err(|cause| format!("line {}: {cause}", line_before(from, line_end)))?,
            );
        }
    }
    Ok(found)
}

/// The number of the line that has been read last, from 1 on.
fn line_before(from: &Cursor<&[u8]>, line_end: u8) -> usize {
    let read = from.get_ref().get(..from.position() as usize);
    read.unwrap_or_default()
        .trim_ascii_end()
        .split(|&b| b == line_end)
        .count()
}

fn element<E: PropertyAccess>(line: &[u8], kind: &ElementDef) -> Result<E, String> {
    let line = String::from_utf8_lossy(line);
    let mut words = line.split_ascii_whitespace();
    let mut found = E::new();
    for (name, property) in &kind.properties {
        let value = match &property.data_type {
            PropertyType::Scalar(scalar) => one(scalar, &mut words)?,
            PropertyType::List(_, scalar) => list(scalar, &mut words)?,
        };
        found.set_property(name, value);
    }
    Ok(found)
}

fn one(scalar: &ScalarType, words: &mut SplitAsciiWhitespace<'_>) -> Result<Property, String> {
    Ok(match scalar {
        ScalarType::Char => Property::Char(number(words)?),
        ScalarType::UChar => Property::UChar(number(words)?),
        ScalarType::Short => Property::Short(number(words)?),
        ScalarType::UShort => Property::UShort(number(words)?),
        ScalarType::Int => Property::Int(number(words)?),
        ScalarType::UInt => Property::UInt(number(words)?),
        ScalarType::Float => Property::Float(number(words)?),
        ScalarType::Double => Property::Double(number(words)?),
    })
}

fn list(scalar: &ScalarType, words: &mut SplitAsciiWhitespace<'_>) -> Result<Property, String> {
    Ok(match scalar {
        ScalarType::Char => Property::ListChar(numbers(words)?),
        ScalarType::UChar => Property::ListUChar(numbers(words)?),
        ScalarType::Short => Property::ListShort(numbers(words)?),
        ScalarType::UShort => Property::ListUShort(numbers(words)?),
        ScalarType::Int => Property::ListInt(numbers(words)?),
        ScalarType::UInt => Property::ListUInt(numbers(words)?),
        ScalarType::Float => Property::ListFloat(numbers(words)?),
        ScalarType::Double => Property::ListDouble(numbers(words)?),
    })
}

fn number<T: FromStr>(words: &mut SplitAsciiWhitespace<'_>) -> Result<T, String> {
    parsed(words.next().ok_or("has too few numbers")?)
}

/// As many numbers as the first one says.
fn numbers<T: FromStr>(words: &mut SplitAsciiWhitespace<'_>) -> Result<Vec<T>, String> {
    let count: usize = number(words)?;
    (0..count).map(|_| number(words)).collect()
}

#[cfg(test)]
mod tests {
    use crate::{Code, LoadOptions, Scene, load_bytes};

    fn load(bytes: &[u8]) -> Scene {
        let no_files = |_: &str| Err("no files".to_owned());
        load_bytes(bytes, "scan.ply", &LoadOptions::default(), &no_files).unwrap()
    }

    #[test]
    fn a_ply_file_in_text_holds_all_that_a_binary_one_may() {
        let header = |format: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex 6\nproperty float x\nproperty float y\n\
                 end_header\n"
            )
        };
        let text = header("ascii")
            + "-nan(ind) 0\n0 nan(0x8000)\n\n1. .5\r\n  \n+2e0 -.25\nNaN 1\ninf -inf";
        let (nan, infinity) = (f32::NAN, f32::INFINITY);
        let numbers = [
            -nan, 0., 0., nan, 1., 0.5, 2., -0.25, nan, 1., infinity, -infinity,
        ];
        let mut binary = header("binary_little_endian").into_bytes();
        binary.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        let [text, binary] = [text.as_bytes(), &binary].map(load);
        assert_eq!(text.meshes[0].points, [0, 1]);
        assert_eq!(text.meshes, binary.meshes);
        assert_eq!(text.warnings, binary.warnings);
        assert_eq!(text.warnings[0].code, Code::TrianglesUnusable);
    }
}
