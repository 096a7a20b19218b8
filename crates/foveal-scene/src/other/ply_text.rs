//! Elements of PLY files in text, a line each; empty lines are none. Numbers are what Rust and C99
//! (`%f`, `%g`) write: the crate `ply-rs-bw` refuses `nan`, `-nan(ind)`, `inf`, `1.` and `.5`.

use std::io::{BufRead, Cursor};
use std::str::SplitAsciiWhitespace;

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyType, ScalarType};

use super::numbers::{parsed, whole};

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
        ScalarType::Char => Property::Char(next(words, whole)?),
        ScalarType::UChar => Property::UChar(next(words, whole)?),
        ScalarType::Short => Property::Short(next(words, whole)?),
        ScalarType::UShort => Property::UShort(next(words, whole)?),
        ScalarType::Int => Property::Int(next(words, whole)?),
        ScalarType::UInt => Property::UInt(next(words, whole)?),
        ScalarType::Float => Property::Float(next(words, parsed)?),
        ScalarType::Double => Property::Double(next(words, parsed)?),
    })
}

fn list(scalar: &ScalarType, words: &mut SplitAsciiWhitespace<'_>) -> Result<Property, String> {
    Ok(match scalar {
        ScalarType::Char => Property::ListChar(numbers(words, whole)?),
        ScalarType::UChar => Property::ListUChar(numbers(words, whole)?),
        ScalarType::Short => Property::ListShort(numbers(words, whole)?),
        ScalarType::UShort => Property::ListUShort(numbers(words, whole)?),
        ScalarType::Int => Property::ListInt(numbers(words, whole)?),
        ScalarType::UInt => Property::ListUInt(numbers(words, whole)?),
        ScalarType::Float => Property::ListFloat(numbers(words, parsed)?),
        ScalarType::Double => Property::ListDouble(numbers(words, parsed)?),
    })
}

/// The next word, by what reads it as a number.
fn next<T>(
    words: &mut SplitAsciiWhitespace<'_>,
    read: impl Fn(&str) -> Result<T, String>,
) -> Result<T, String> {
    read(words.next().ok_or("has too few numbers")?)
}

/// As many numbers as the first one says.
fn numbers<T>(
    words: &mut SplitAsciiWhitespace<'_>,
    read: impl Fn(&str) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let count: u32 = next(words, whole)?;
    (0..count).map(|_| next(words, &read)).collect()
}

#[cfg(test)]
mod tests {
    use crate::{Code, LoadOptions, Scene, SceneError, load_bytes};

    fn read(bytes: &[u8]) -> Result<Scene, SceneError> {
        let no_files = |_: &str| Err("no files".to_owned());
        load_bytes(bytes, "scan.ply", &LoadOptions::default(), &no_files)
    }

    fn load(bytes: &[u8]) -> Scene {
        read(bytes).unwrap()
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

    /// A triangle with these colours of its first vertex and this face.
    fn triangle(color: &str, face: &str) -> String {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 {color}\n1 0 0 0 0 0\n0 1 0 0 0 0\n{face}\n"
        )
    }

    #[test]
    fn whole_numbers_may_be_written_with_a_point_or_an_exponent() {
        let plain = load(triangle("255 20 0", "3 0 1 2").as_bytes());
        assert_eq!(plain.triangle_count(), 1);
        for (color, face) in [
            ("255.0 2e1 -0.0", "3.0 0.0 1. 2e0"),
            ("+255 20. .0", "3 +0 1 2"),
        ] {
            let scene = load(triangle(color, face).as_bytes());
            assert_eq!(scene.meshes, plain.meshes, "{color}");
            assert_eq!(scene.warnings, []);
        }
        for (color, face, cause) in [
            (
                "0.5 0 0",
                "3 0 1 2",
                "line 13: \"0.5\" is not a whole number of 8 bits",
            ),
            (
                "256 0 0",
                "3 0 1 2",
                "line 13: \"256\" is not a whole number of 8 bits",
            ),
            (
                "0 0 0",
                "3 0 1 2.5",
                "line 16: \"2.5\" is not a whole number of 32 bits",
            ),
            (
                "0 0 0",
                "3 0 1 1e30",
                "line 16: \"1e30\" is not a whole number of 32 bits",
            ),
            (
                "0 0 0",
                "3 0 1 nan",
                "line 16: \"nan\" is not a whole number of 32 bits",
            ),
            ("0 0 x", "3 0 1 2", "line 13: \"x\" is not a number"),
        ] {
            let error = read(triangle(color, face).as_bytes()).unwrap_err();
            assert!(error.to_string().ends_with(cause), "{error}");
        }
    }
}
