//! What goes to the terminal: results to stdout, everything else to stderr.

use std::io::{ErrorKind, Write};

use anyhow::Context;

/// Writes a command's result to stdout. A reader that has gone away (`foveal … | head`) is no failure.
pub(crate) fn print_result(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to standard output"),
    }
}

/// Prints a warning as one paragraph.
pub(crate) fn warn(text: &str) {
    eprintln!("warning: {}", crate::failure::one_line(text));
}
