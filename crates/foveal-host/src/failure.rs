//! How the program fails: one paragraph on stderr and an exit code, whatever went wrong.

use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::process::ExitCode;
use std::sync::Mutex;

use crate::console::{note, one_line};

/// Arguments that are well-formed one by one but make no sense together. Exit code 2.
#[derive(Debug)]
pub struct Usage(pub String);

impl std::fmt::Display for Usage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// [`Usage`] as an error to return.
pub fn usage<T>(message: impl Into<String>) -> anyhow::Result<T> {
    Err(anyhow::Error::new(Usage(message.into())))
}

/// Where the last panic happened and what it said; printed only if nothing catches it below `main`.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Runs `command`, prints what went wrong, and chooses the exit code.
///
/// A panic is a defect of this program; it still ends as one paragraph and exit code 1. The hook
/// keeps quiet itself, because a panic that a guard further down catches is that guard's to report.
pub fn report(name: &str, command: impl FnOnce() -> anyhow::Result<()>) -> ExitCode {
    std::panic::set_hook(Box::new(remember));
    match catch_unwind(AssertUnwindSafe(command)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => match error.downcast_ref::<Usage>() {
            Some(usage) => {
                let usage = one_line(&usage.to_string());
                note(&format!(
                    "error: {usage}\n\nFor more information, try 'foveal {name} --help'.\n"
                ));
                ExitCode::from(2)
            }
            None => {
                note(&format!("error: {}\n", paragraph(&error)));
                ExitCode::FAILURE
            }
        },
        Err(_) => {
            let what = LAST_PANIC.lock().ok().and_then(|mut last| last.take());
            note(&format!(
                "error: foveal {name} has a defect and stopped: {}; please report it with the command line and the scene\n",
                what.as_deref().unwrap_or("no message")
            ));
            ExitCode::FAILURE
        }
    }
}

/// The error and its causes in one paragraph.
fn paragraph(error: &anyhow::Error) -> String {
    one_line(&format!("{error:#}"))
}

fn remember(info: &PanicHookInfo<'_>) {
    let message = info.payload_as_str().unwrap_or("a panic without a message");
    let place = info
        .location()
        .map_or_else(String::new, |l| format!(" ({}:{})", l.file(), l.line()));
    if let Ok(mut last) = LAST_PANIC.lock() {
        *last = Some(one_line(&format!("{message}{place}")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_become_one_paragraph() {
        let error = anyhow::anyhow!("the driver said:\n  no").context("cannot draw");
        assert_eq!(paragraph(&error), "cannot draw: the driver said: no");
    }
}
