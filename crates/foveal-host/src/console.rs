//! What goes to the terminal: results to stdout, everything else to stderr.

use std::io::{ErrorKind, Write};

use anyhow::Context;
use foveal_scene::printable;

/// Writes a command's result to stdout. A reader that has gone away (`foveal … | head`) is no
/// failure.
pub fn print_result(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out
        .write_all(printable_lines(text).as_bytes())
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

/// Prints lines to stderr. Where nobody takes them, as on a full disk, they are lost, and the
/// command goes on.
pub fn note(text: &str) {
    let _ = std::io::stderr()
        .lock()
        .write_all(printable_lines(text).as_bytes());
}

/// `text` as it may stand in lines of a terminal or of a page.
pub fn printable_lines(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(printable).collect();
    lines.join("\n")
}

/// All white space, line breaks included, as single blanks; control characters escaped.
pub fn one_line(text: &str) -> String {
    printable(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Prints a warning as one paragraph.
pub fn warn(text: &str) {
    note(&format!("warning: {}\n", one_line(text)));
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
    fn lines_stay_lines() {
        assert_eq!(
            printable_lines("one\r\ntwo ü 市\n"),
            "one\\u000d\ntwo ü 市\n"
        );
    }

    #[test]
    fn escaped_json_means_the_same() {
        let text = "n\u{9b}\u{202e}\x7f\x1b\n";
        let json = serde_json::to_string(&[text]).unwrap() + "\n";
        let back: Vec<String> = serde_json::from_str(&printable_lines(&json)).unwrap();
        assert_eq!(back, [text]);
    }
}
