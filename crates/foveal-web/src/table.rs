//! The settings' own table, as the page's controls are made from it.

use foveal::{Kind, Setting, Settings};
use serde::Serialize;

/// A setting as the page sees it; `kind` says which of the others mean something.
#[derive(Serialize)]
struct Described {
    key: &'static str,
    stage: &'static str,
    label: &'static str,
    help: &'static str,
    kind: &'static str,
    names: Vec<&'static str>,
    least: f64,
    most: f64,
}

impl From<&Setting> for Described {
    fn from(setting: &Setting) -> Self {
        let (kind, names, (least, most)) = match setting.kind {
            Kind::Switch => ("switch", Vec::new(), (0.0, 1.0)),
            Kind::Choice(names) => ("choice", offered(setting, names()), (0.0, 0.0)),
            Kind::Integer { least, most } => ("integer", Vec::new(), (least as f64, most as f64)),
            Kind::Number { least, most } => ("number", Vec::new(), (least, most)),
            Kind::Place => ("place", Vec::new(), (0.0, 1.0)),
            Kind::Text => ("text", Vec::new(), (0.0, 0.0)),
            Kind::File => ("file", Vec::new(), (0.0, 0.0)),
        };
        Self {
            key: setting.key,
            stage: setting.stage,
            label: setting.label,
            help: setting.help,
            kind,
            names,
            least,
            most,
        }
    }
}

/// A choice's names that this build can meet: `image` needs a file, which a page has no way to name.
fn offered(setting: &Setting, names: &[&'static str]) -> Vec<&'static str> {
    let is_met = |name: &str| !cfg!(feature = "webgl") || setting.has_name_in_reduced_set(name);
    let is_offered = |name: &&str| *name != "image" && is_met(name);
    names.iter().copied().filter(is_offered).collect()
}

/// All settings that this build can meet, in the order of the frame, as JSON.
pub(crate) fn json() -> String {
    let offered = |setting: &&Setting| !cfg!(feature = "webgl") || setting.is_in_reduced_set();
    let all: Vec<Described> = (Settings::ALL.iter().filter(offered))
        .map(Described::from)
        .collect();
    serde_json::to_string(&all).unwrap_or_default()
}
