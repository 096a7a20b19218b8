//! Settings on the command line and in files.

mod args;
mod file;

pub use args::{SettingsArgs, flags};
pub use file::{check, from_text, read};
