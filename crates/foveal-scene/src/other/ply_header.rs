//! Headers of PLY files. Read here and not by the crate `ply-rs-bw` (4.0.1), which refuses names of
//! properties as CloudCompare writes them (`scalar_Number_of_neighbors_(r=0.5)`) and comments that
//! are not UTF-8, and takes two properties of one name for one, so that all behind them is misread.

use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyDef, PropertyType, ScalarType,
};

/// Longest line in bytes, and most lines.
const MAX_LINE: usize = 4 << 10;
const MAX_LINES: usize = 10_000;

/// A header, how its lines end, and the length with which the elements begin.
pub(super) struct Found {
    pub(super) header: Header,
    pub(super) line_end: u8,
    pub(super) length: usize,
}

/// Reads a header. Lines end in LF, with or without CR, or in CR alone, as the first one does.
pub(super) fn read(bytes: &[u8]) -> Result<Found, String> {
    let first = bytes.iter().position(|b| b"\r\n".contains(b));
    let is_alone = first.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    let line_end = if is_alone { b'\r' } else { b'\n' };
    let mut header = Header::new();
    let mut has_format = false;
    let mut length = 0;
    for (index, line) in bytes.split(|&b| b == line_end).enumerate() {
        length = bytes.len().min(length + line.len() + 1);
        if line.len() > MAX_LINE || index == MAX_LINES {
            return Err(format!(
                "its header has a line of over {MAX_LINE} bytes, or over {MAX_LINES} lines"
            ));
        }
        let text = String::from_utf8_lossy(line.trim_ascii());
        let (key, rest) = split(&text);
        let understood = match (index, key) {
            (0, "ply") => Some(()),
            (0, _) => return Err("its first line is not \"ply\"".to_owned()),
            (_, "end_header") if has_format => {
                return Ok(Found {
                    header,
                    line_end,
                    length,
                });
            }
            (_, "end_header") => return Err("its header names no format".to_owned()),
            (_, "" | "obj_info") => Some(()),
            (_, "comment") => {
                header.comments.push(rest.to_owned());
                Some(())
            }
            (_, "format") => encoding(rest).map(|encoding| {
                header.encoding = encoding;
                has_format = true;
            }),
            (_, "element") => element(rest).map(|element| add_element(&mut header, element)),
            (_, "property") => property(rest).and_then(|it| add_property(&mut header, it)),
            _ => None,
        };
        understood.ok_or_else(|| {
            let text: String = text.chars().take(40).collect();
            format!("line {}: \"{text}\" is no line of a header", index + 1)
        })?;
    }
    Err("its header has no end".to_owned())
}

/// A line's first word, and what follows it.
fn split(text: &str) -> (&str, &str) {
    let (word, rest) = text
        .split_once(|c: char| c.is_ascii_whitespace())
        .unwrap_or((text, ""));
    (word, rest.trim_ascii())
}

fn encoding(text: &str) -> Option<Encoding> {
    match split(text).0 {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::BinaryLittleEndian),
        "binary_big_endian" => Some(Encoding::BinaryBigEndian),
        _ => None,
    }
}

fn element(text: &str) -> Option<ElementDef> {
    let (name, count) = split(text);
    let mut element = ElementDef::new(name.to_owned());
    element.count = count.parse().ok()?;
    Some(element)
}

fn property(text: &str) -> Option<PropertyDef> {
    let (kind, rest) = split(text);
    let (data_type, name) = if kind == "list" {
        let (count, rest) = split(rest);
        let (item, name) = split(rest);
        (PropertyType::List(scalar(count)?, scalar(item)?), name)
    } else {
        (PropertyType::Scalar(scalar(kind)?), rest)
    };
    (!name.is_empty()).then(|| PropertyDef::new(name.to_owned(), data_type))
}

fn scalar(name: &str) -> Option<ScalarType> {
    Some(match name {
        "char" | "int8" => ScalarType::Char,
        "uchar" | "uint8" => ScalarType::UChar,
        "short" | "int16" => ScalarType::Short,
        "ushort" | "uint16" => ScalarType::UShort,
        "int" | "int32" => ScalarType::Int,
        "uint" | "uint32" => ScalarType::UInt,
        "float" | "float32" => ScalarType::Float,
        "double" | "float64" => ScalarType::Double,
        _ => return None,
    })
}

/// Adds an element. A second one of a name gets another, so that it is passed over.
fn add_element(header: &mut Header, mut element: ElementDef) {
    if header.elements.contains_key(&element.name) {
        element.name = format!("{}\n{}", element.name, header.elements.len());
    }
    header.elements.add(element);
}

/// Adds a property to the last element, as [`add_element`] does; `None` where there is none.
fn add_property(header: &mut Header, mut property: PropertyDef) -> Option<()> {
    let (_, element) = header.elements.last_mut()?;
    if element.properties.contains_key(&property.name) {
        property.name = format!("{}\n{}", property.name, element.properties.len());
    }
    element.properties.add(property);
    Some(())
}

#[cfg(test)]
mod tests {
    use crate::{Code, LoadOptions, Scene, SceneError, load_bytes};

    fn load(bytes: &[u8]) -> Result<Scene, SceneError> {
        let no_files = |_: &str| Err("no files".to_owned());
        load_bytes(bytes, "scan.ply", &LoadOptions::default(), &no_files)
    }

    /// Two points, whose header has these lines more, in text.
    fn points(lines: &[u8], values: &str) -> Vec<u8> {
        let axes = "property float x\nproperty float y\nproperty float z\n";
        let mut out = format!("ply\nformat ascii 1.0\nelement vertex 2\n{axes}").into_bytes();
        out.extend(lines);
        out.extend(format!("end_header\n0 0 0 {values}\n1 2 3 {values}\n").bytes());
        out
    }

    #[test]
    fn names_and_comments_may_be_any() {
        for (lines, values) in [
            (&b"comment Gr\xf6\xdfe\nobj_info\n\ncomment\n"[..], ""),
            (
                b"property float scalar_Number_of_neighbors_(r=0.5)\nproperty int8 #2\n",
                "7 7",
            ),
            (b"property float a scalar\nproperty float a scalar\n", "7 7"),
        ] {
            let scene = load(&points(lines, values)).unwrap();
            assert_eq!(scene.bounds().max.to_array(), [1.0, 2.0, 3.0]);
            assert_eq!(scene.warnings, []);
        }
    }

    #[test]
    fn a_second_property_of_a_name_is_passed_over() {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n\
                      property float s\nproperty float s\nproperty float y\nproperty float x\n\
                      end_header\n";
        let mut bytes = header.as_bytes().to_vec();
        for number in [0.0f32, 9., 9., 0., 9., 1., 9., 9., 2., 9.] {
            bytes.extend(number.to_le_bytes());
        }
        let scene = load(&bytes).unwrap();
        assert_eq!(scene.bounds().max.to_array(), [1.0, 2.0, 0.0]);
    }

    #[test]
    fn lines_may_end_in_any_way_and_a_byte_order_mark_may_come_first() {
        let text = String::from_utf8(points(b"", "")).unwrap();
        for end in ["\n", "\r\n", "\r"] {
            for mark in ["", "\u{feff}"] {
                let text = format!("{mark}{}", text.replace('\n', end));
                let scene = load(text.as_bytes()).unwrap();
                assert_eq!(scene.bounds().max.to_array(), [1.0, 2.0, 3.0]);
            }
        }
        let wrong = text.replace("1 2 3", "1 x 3").replace('\n', "\r");
        let said = load(wrong.as_bytes()).unwrap_err().to_string();
        assert!(said.ends_with("line 9: \"x\" is not a number"), "{said}");
    }

    #[test]
    fn a_line_that_is_none_of_a_header_is_named() {
        for line in [
            "property quad a",
            "property float",
            "property list uchar vertex_indices",
            "element face -3",
            "format",
            "nothing",
        ] {
            let error = load(&points(format!("{line}\n").as_bytes(), "")).unwrap_err();
            assert_eq!(error.code(), Code::NotMesh);
            let cause = format!("line 7: \"{line}\" is no line of a header");
            assert!(error.to_string().ends_with(&cause), "{error}");
        }
        for (text, cause) in [
            ("plyx\n", "its first line is not \"ply\""),
            ("ply\nend_header\n", "its header names no format"),
            (
                "ply\nproperty float x\n",
                "line 2: \"property float x\" is no line of a header",
            ),
            ("ply\nformat ascii 1.0\n", "its header has no end"),
        ] {
            let said = load(text.as_bytes()).unwrap_err().to_string();
            assert!(said.ends_with(cause), "{said}");
        }
    }
}
