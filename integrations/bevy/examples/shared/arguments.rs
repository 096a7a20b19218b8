//! `--name value` on the command line.

use bevy::prelude::UVec2;
use std::process::exit;
use std::str::FromStr;

/// The command line.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// Reads it.
    pub fn read() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    fn value(&self, name: &str) -> Option<&str> {
        let flag = format!("--{name}");
        let at = self.0.iter().position(|word| *word == flag)?;
        Some(self.0.get(at + 1).map_or("", String::as_str))
    }

    /// The first word that is no flag and belongs to none.
    pub fn file(&self) -> Option<&str> {
        let mut words = self.0.iter();
        while let Some(word) = words.next() {
            if !word.starts_with("--") {
                return Some(word);
            }
            words.next();
        }
        None
    }

    /// What follows a flag, if that is there.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.value(name)
    }

    /// A number, or what stands for it.
    pub fn number<T: FromStr>(&self, name: &str, default: T) -> T {
        self.value(name)
            .map_or(default, |value| parsed(name, value))
    }

    /// Frames to draw without a window.
    pub fn frames(&self) -> Option<usize> {
        self.value("frames").map(|value| parsed("frames", value))
    }

    /// The size of the picture.
    pub fn size(&self, default: UVec2) -> UVec2 {
        let Some(value) = self.value("size") else {
            return default;
        };
        let (width, height) = value.split_once('x').unwrap_or((value, ""));
        UVec2::new(parsed("size", width), parsed("size", height))
    }
}

#[expect(clippy::print_stderr, reason = "a program says what is wrong")]
fn parsed<T: FromStr>(name: &str, value: &str) -> T {
    value.parse().unwrap_or_else(|_| {
        eprintln!("--{name}: '{value}' is not what is needed");
        exit(2)
    })
}
