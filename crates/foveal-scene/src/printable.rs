//! Text of files as it may be shown.

use std::fmt::Write as _;

/// `text` as it may stand in a line of a terminal, a window or a page.
///
/// Names in files may hold anything. Control characters, line breaks among them, and characters that
/// change the direction of writing could show or do what the program never said: they are written as
/// JSON writes them, `\u001b`.
#[must_use]
pub fn printable(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}');
        if c.is_control() || turns {
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_not_obeyed() {
        let hostile = "a\x1b[2Jb\rc\u{9b}1md\u{202e}e\x7ff\u{0}\n";
        let shown = r"a\u001b[2Jb\u000dc\u009b1md\u202ee\u007ff\u0000\u000a";
        assert_eq!(printable(hostile), shown);
        assert_eq!(printable("ü 市 🙂"), "ü 市 🙂");
    }
}
