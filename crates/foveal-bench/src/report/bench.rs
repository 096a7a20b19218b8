//! A bench as the report knows it: how it is called, which rows it gives, and what of them the page
//! shows.

use std::path::Path;
use std::process::Command;

use foveal_host::command_line::quoted;
use serde_json::{Value, json};

use crate::changes::Changes;

/// A column of the page's table.
pub(super) struct Column {
    pub(super) key: &'static str,
    pub(super) title: &'static str,
    /// Multiplied before it is shown, for percent and the like.
    pub(super) factor: f64,
    pub(super) digits: usize,
}

pub(super) const fn column(key: &'static str, title: &'static str, digits: usize) -> Column {
    Column {
        key,
        title,
        factor: 1.0,
        digits,
    }
}

pub(super) const fn percent(key: &'static str, title: &'static str) -> Column {
    Column {
        key,
        title,
        factor: 100.0,
        digits: 2,
    }
}

/// Two settings whose pictures are laid over each other.
pub(super) struct Pair {
    pub(super) title: &'static str,
    pub(super) before: Changes,
    pub(super) after: Changes,
}

/// How cost grows with the load.
pub(super) struct Load {
    /// What the rows are loaded with, and its title.
    pub(super) x: &'static str,
    pub(super) title: &'static str,
    /// Costs in milliseconds, and what of the row they are where there are several.
    pub(super) costs: &'static [(&'static str, &'static str)],
    /// The cost of the plain way, which all rows of a load share.
    pub(super) reference: Option<(&'static str, &'static str)>,
    /// What tells a line from the others.
    pub(super) series: &'static [&'static str],
    /// Only rows that have this.
    pub(super) only: Option<(&'static str, &'static str)>,
}

/// Quality against speed.
pub(super) struct Quality {
    /// What lies to the right, and where on that axis better is.
    pub(super) x: &'static str,
    pub(super) axis: &'static str,
    /// An error, and what it is called; small is good.
    pub(super) error: (&'static str, &'static str),
    /// Where the figure is not the error itself but a quality: the best one, from which it is
    /// counted.
    pub(super) best: Option<f64>,
    /// What grows along a curve, and its title; none: each row stands alone.
    pub(super) along: Option<(&'static str, &'static str)>,
    /// What tells a curve from the others.
    pub(super) series: &'static [&'static str],
    /// A plot for each of this.
    pub(super) apart: Option<&'static str>,
}

/// One bench.
pub(super) struct Bench {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) subcommand: &'static [&'static str],
    /// Scenes, [`THE_SCENE`] among them for the report's, and flags; fewer where it must be quick.
    pub(super) quick: &'static [&'static str],
    pub(super) full: &'static [&'static str],
    /// Whether it takes `--size`.
    pub(super) sized: bool,
    pub(super) rows: fn(&Value) -> Option<Vec<Value>>,
    /// What tells a row from the others; the row's label is made of these.
    pub(super) label: &'static [&'static str],
    pub(super) columns: &'static [Column],
    /// The cost in the bar plot.
    pub(super) cost: &'static str,
    pub(super) quality: Option<Quality>,
    pub(super) load: Option<Load>,
    pub(super) pairs: &'static [Pair],
}

pub(super) fn own_rows(figures: &Value) -> Option<Vec<Value>> {
    let rows = figures.get("rows").unwrap_or(figures);
    rows.as_array().cloned()
}

/// The stages of `foveal render --stats`.
pub(super) fn stages(figures: &Value) -> Option<Vec<Value>> {
    let median = figures.get("median")?;
    let mut rows = Vec::new();
    for (unit, key) in [("CPU", "cpu_ms"), ("GPU", "gpu_ms")] {
        for timing in median.get(key)?.as_array()? {
            rows.push(json!({ "unit": unit, "stage": timing["name"], "ms": timing["ms"] }));
        }
    }
    rows.push(json!({ "unit": "both", "stage": "frame", "ms": median["frame_ms"] }));
    Some(rows)
}

/// The rows of the first camera: one per scene where scenes are the load.
pub(super) fn first_camera(figures: &Value) -> Option<Vec<Value>> {
    let mut rows = own_rows(figures)?;
    let first = rows.first()?["camera"].clone();
    rows.retain(|row| row["camera"] == first);
    Some(rows)
}

/// Stands for the scene that the report is about.
pub(super) const THE_SCENE: &str = "SCENE";

/// The bench that the first page is made of.
pub(super) const VERDICT: &str = "verdict";

/// A word of a command, or the scene where it stands for that.
fn named<'a>(word: &'a str, scene: &'a str) -> &'a str {
    if word == THE_SCENE { scene } else { word }
}

impl Bench {
    /// How many passes are made where all others make `passes`: some draw their sides in turn, and
    /// have intervals of their own.
    pub(super) fn passes(&self, passes: usize) -> usize {
        match self.name {
            VERDICT | "eye" => 1,
            _ => passes,
        }
    }

    /// The command's words, without where its figures go; `import` says how the report's scene is
    /// read.
    pub(super) fn words(
        &self,
        scene: &str,
        size: (u32, u32),
        quick: bool,
        adapter: Option<&str>,
        import: &[String],
    ) -> Vec<String> {
        let mut words: Vec<String> = self.subcommand.iter().map(|&w| w.to_owned()).collect();
        if self.sized {
            words.extend(["--size".to_owned(), format!("{}x{}", size.0, size.1)]);
        }
        let own = self.own(quick).iter();
        words.extend(own.map(|word| named(word, scene).to_owned()));
        if let Some(adapter) = adapter
            && self.subcommand != ["bench", "culling"]
        {
            words.extend(["--adapter".to_owned(), adapter.to_owned()]);
        }
        if self.own(quick).contains(&THE_SCENE) {
            words.extend_from_slice(import);
        }
        words
    }

    fn own(&self, quick: bool) -> &'static [&'static str] {
        if quick { self.quick } else { self.full }
    }

    /// The scenes that it measures, which come before all flags.
    pub(super) fn scenes<'a>(&self, scene: &'a str, quick: bool) -> Vec<&'a str> {
        let own = self.own(quick).iter();
        let scenes = own.take_while(|word| !word.starts_with("--"));
        scenes.map(|word| named(word, scene)).collect()
    }

    /// The command as a user types it.
    pub(super) fn command_line(&self, words: &[String]) -> String {
        let output = match self.subcommand {
            ["render"] => " --output frame_#.png",
            _ => "",
        };
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        format!("foveal {}{output}", words.join(" "))
    }

    /// Adds where the figures go.
    pub(super) fn output(&self, command: &mut Command, folder: &Path, file: &Path) {
        if self.subcommand == ["render"] {
            command
                .arg("--quiet")
                .arg("--output")
                .arg(folder.join("frame_#.png"))
                .arg("--stats")
                .arg(file);
        } else {
            command.arg("--json").arg(file);
        }
    }
}
