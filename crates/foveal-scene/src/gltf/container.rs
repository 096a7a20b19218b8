//! The outermost layer: text or GLB container (glTF 2.0 specification, section 4.4).

use crate::{Code, Warning};

/// The two parts of a file.
pub(crate) struct Container<'a> {
    pub(crate) json: &'a [u8],
    pub(crate) bin: Option<&'a [u8]>,
    /// What was odd about the container, in sentences.
    pub(crate) notes: Vec<Warning>,
}

const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?))
}

/// What text in UTF-8 may begin with.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Splits a file into JSON and binary part; the error is a cause for 'not glTF 2.0'.
pub(crate) fn split(bytes: &[u8]) -> Result<Container<'_>, String> {
    if !bytes.starts_with(b"glTF") {
        return split_text(bytes);
    }
    let header = |at| word(bytes, at).ok_or("its header is cut short");
    let (version, length) = (header(4)?, header(8)? as usize);
    if version != 2 {
        return Err(format!("it is a GLB container of version {version}"));
    }
    if length > bytes.len() {
        return Err(format!(
            "its header promises {length} bytes, there are {}",
            bytes.len()
        ));
    }
    let mut notes = Vec::new();
    if length < bytes.len() {
        notes.push(Warning::new(
            Code::ContainerTail,
            format!(
                "{} bytes after the end of the container are ignored",
                bytes.len() - length
            ),
        ));
    }
    let body = &bytes[..length];
    let (mut json, mut bin) = (None, None);
    let mut at = 12;
    let mut number = 0;
    while at < body.len() {
        let (Some(size), Some(kind)) = (word(body, at), word(body, at + 4)) else {
            return Err(format!("the header of chunk {number} is cut short"));
        };
        let start = at + 8;
        let end = start
            .checked_add(size as usize)
            .filter(|&end| end <= body.len())
            .ok_or_else(|| format!("chunk {number} of {size} bytes is cut short"))?;
        let chunk = &body[start..end];
        match (number, kind) {
            (0, JSON) => json = Some(chunk),
            (0, _) => return Err("its first chunk is not JSON".to_owned()),
            (1, BIN) => bin = Some(chunk),
            (_, JSON) => return Err(format!("chunk {number} is a second JSON chunk")),
            (_, BIN) if bin.is_some() => {
                return Err(format!("chunk {number} is a second binary chunk"));
            }
            (_, BIN) => {
                return Err(format!("chunk {number} is binary but not the second chunk"));
            }
            _ => notes.push(Warning::new(
                Code::ContainerChunk,
                format!("chunk {number} of the unknown kind {kind:#010x} is ignored"),
            )),
        }
        at = end;
        number += 1;
    }
    let json = json.ok_or("it has no JSON chunk")?;
    if json.is_empty() {
        return Err("its JSON chunk is empty".to_owned());
    }
    Ok(Container { json, bin, notes })
}

fn split_text(bytes: &[u8]) -> Result<Container<'_>, String> {
    let json = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    match json.iter().find(|b| !b.is_ascii_whitespace()) {
        None => Err("it is empty".to_owned()),
        Some(b'{') => Ok(Container {
            json,
            bin: None,
            notes: Vec::new(),
        }),
        Some(_) => Err("it begins neither like JSON nor like a GLB container".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, chunk) in chunks {
            body.extend((chunk.len() as u32).to_le_bytes());
            body.extend(kind.to_le_bytes());
            body.extend(*chunk);
        }
        let mut out = b"glTF".to_vec();
        out.extend(2u32.to_le_bytes());
        out.extend((12 + body.len() as u32).to_le_bytes());
        out.extend(body);
        out
    }

    #[test]
    fn a_container_gives_its_two_parts() {
        let bytes = glb(&[(JSON, b"{}  "), (BIN, b"1234"), (7, b"xyzw")]);
        let parts = split(&bytes).unwrap();
        assert_eq!(parts.json, b"{}  ");
        assert_eq!(parts.bin, Some(&b"1234"[..]));
        assert_eq!(parts.notes.len(), 1);
    }

    #[test]
    fn every_truncation_is_refused_or_shorter() {
        let bytes = glb(&[(JSON, b"{}  "), (BIN, b"1234")]);
        for end in 0..bytes.len() {
            assert!(split(&bytes[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn chunks_out_of_order_are_refused() {
        for chunks in [
            &[(BIN, &b"1234"[..]), (JSON, &b"{}"[..])][..],
            &[(JSON, b"{}"), (JSON, b"{}")],
            &[(JSON, b"{}"), (BIN, b"1"), (BIN, b"2")],
            &[(JSON, b"")],
            &[],
        ] {
            assert!(split(&glb(chunks)).is_err());
        }
        assert!(split(b"# an OBJ file").is_err());
        assert!(split(b"  ").is_err());
    }
}
