//! Lines of Wavefront OBJ and MTL files, and the names on them.

use std::borrow::Cow;

use crate::gltf::BYTE_ORDER_MARK;

/// The bytes of a text as UTF-8 has it: of UTF-16 with a byte order mark, as PowerShell writes it, else
/// the same.
pub(super) fn as_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xFF, 0xFE, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] => u16::from_be_bytes,
        _ => return Cow::Borrowed(bytes),
    };
    let units = bytes[2..].as_chunks::<2>().0.iter().copied().map(unit);
    let chars = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    Cow::Owned(chars.collect::<String>().into_bytes())
}

/// Longest name in bytes; longer ones are cut.
const MAX_NAME: usize = 200;

/// A line of text, lines that end in `\` joined with the next.
pub(super) struct Line<'a> {
    pub(super) text: Cow<'a, str>,
    /// From 1 on.
    pub(super) number: usize,
}

/// The lines that are neither empty nor comments, trimmed; a comment is not joined with the next.
/// A byte order mark before the first is left out. Bytes that are not UTF-8 are replaced.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    // Old programs for the Macintosh write CR alone.
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    let mut rest = bytes.split(move |&b| b == end).enumerate();
    std::iter::from_fn(move || {
        loop {
            let (index, first) = rest.next()?;
            let mut text = String::from_utf8_lossy(first.trim_ascii());
            let mut is_commented = has_comment(&text);
            while text.ends_with('\\') && !is_commented {
                let Some((_, next)) = rest.next() else { break };
                let next = String::from_utf8_lossy(next.trim_ascii());
                // Of the new line alone: a million may be joined.
                is_commented = has_comment(&next);
                let joined = text.to_mut();
                joined.pop();
                joined.push(' ');
                joined.push_str(&next);
            }
            if !text.is_empty() && !text.starts_with('#') {
                let number = index + 1;
                return Some(Line { text, number });
            }
        }
    })
}

/// Whether a line is a comment, or ends in one.
fn has_comment(line: &str) -> bool {
    line.starts_with('#') || line.contains(" #") || line.contains("\t#")
}

/// What stands before a comment behind a name. Its `#` stands alone: there are names as `Material #25`.
pub(super) fn uncommented(text: &str) -> &str {
    let is_alone = |&(at, _): &(usize, &str)| {
        let (before, after) = (&text[..at], &text[at + 1..]);
        (before.is_empty() || before.ends_with(char::is_whitespace))
            && (after.is_empty() || after.starts_with(char::is_whitespace))
    };
    let comment = text.match_indices('#').find(is_alone);
    comment.map_or(text, |(at, _)| text[..at].trim_end())
}

/// A name as it is kept.
pub(super) fn name_of(text: &str) -> String {
    let text = uncommented(text);
    let mut end = text.len().min(MAX_NAME);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    text[..end].to_owned()
}

/// What stands between two quotes.
pub(super) fn unquoted(text: &str) -> &str {
    let inner = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    inner.filter(|t| !t.contains('"')).unwrap_or(text)
}
