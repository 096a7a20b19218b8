//! Which animation of a scene plays.

use std::convert::Infallible;
use std::str::FromStr;

/// One animation of a scene, or all of them at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Clip {
    /// By its number in the file, from 0.
    Number(u32),
    /// The first one of this name; without one, the one whose number this is.
    Named(String),
    /// All together, each looped over its own length.
    All,
}

impl Default for Clip {
    /// The first one.
    fn default() -> Self {
        Self::Number(0)
    }
}

impl FromStr for Clip {
    type Err = Infallible;

    /// `all`, or else a name, which may be a number: only the scene tells which it is.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "all" => Self::All,
            text => Self::Named(text.to_owned()),
        })
    }
}

impl std::fmt::Display for Clip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Named(name) => f.write_str(name),
            Self::All => f.write_str("all"),
        }
    }
}
