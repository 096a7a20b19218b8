//! What goes to the terminal: results to stdout, everything else to stderr.

use std::fmt::Write as _;
use std::io::{ErrorKind, Write};

use anyhow::Context;

/// Writes a command's result to stdout. A reader that has gone away (`foveal … | head`) is no
/// failure.
pub fn print_result(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out
        .write_all(escaped(text, true).as_bytes())
        .and_then(|()| out.flush())
    {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to standard output"),
    }
}

/// Writes a file's bytes to stdout. Here a reader that has gone away is a failure: it did not get
/// the file.
pub fn write_bytes(bytes: &[u8]) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes)
        .and_then(|()| out.flush())
        .context("cannot write to standard output")
}

/// Prints lines to stderr.
pub fn note(text: &str) {
    eprint!("{}", escaped(text, true));
}

/// `text` as it may stand in one line of a terminal.
pub fn escaped_line(text: &str) -> String {
    escaped(text, false)
}

/// Names in files may hold anything. Control characters, and those that change the direction of
/// writing, could make a terminal show or do what the program never said: they are written as JSON
/// writes them, `\u001b`.
fn escaped(text: &str, lines: bool) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let bidi = matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if (c.is_control() && !(lines && c == '\n')) || bidi || c == '\u{feff}' {
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    out
}

/// All white space, line breaks included, as single blanks; control characters escaped.
pub fn one_line(text: &str) -> String {
    escaped_line(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Prints a warning as one paragraph.
pub fn warn(text: &str) {
    eprintln!("warning: {}", one_line(text));
}

/// 1234567 as 1,234,567.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_are_readable() {
        let shown = ["0", "999", "1,000", "1,234,567"];
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), shown);
    }

    #[test]
    fn control_characters_are_shown_and_not_obeyed() {
        let hostile = "a\x1b[2Jb\rc\u{9b}1md\u{202e}e\x7ff\u{0}";
        let shown = r"a\u001b[2Jb\u000dc\u009b1md\u202ee\u007ff\u0000";
        assert_eq!(escaped(hostile, true), shown);
        assert_eq!(escaped_line("one\ntwo"), r"one\u000atwo");
        assert_eq!(escaped("one\ntwo ü 市\n", true), "one\ntwo ü 市\n");
    }

    #[test]
    fn escaped_json_means_the_same() {
        let text = "n\u{9b}\u{202e}\x7f\x1b\n";
        let json = serde_json::to_string(&[text]).unwrap() + "\n";
        let back: Vec<String> = serde_json::from_str(&escaped(&json, true)).unwrap();
        assert_eq!(back, [text]);
    }
}
