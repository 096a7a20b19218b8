//! The settings as flags, made from their table: `--tone-map aces` for the key `tone-map`.
//!
//! Three flags are spelled otherwise: `--size WxH` is width and height; `--rate FILE.png` and
//! `--environment FILE.hdr` name the source `image` and its file at once.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::{
    BoolValueParser, PossibleValuesParser, RangedI64ValueParser, TypedValueParser, ValueParser,
};
use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Command, value_parser};
use foveal::{Display, EyeFrusta, Kind, Lens, LensProfile, Setting, Settings};
use toml::{Table, Value};

use crate::values;

/// A flag for each of [`Settings::ALL`]; what is not given stays as the file or the default says.
#[derive(Debug, Clone, Default)]
pub struct SettingsArgs {
    /// `--settings`
    pub(super) file: Option<PathBuf>,
    /// What the flags say, under the keys of a settings file.
    pub(super) given: Table,
}

/// Settings that choose a source, of which one is a file: the key, the key of the file's name, and
/// what files end with.
const SOURCES: [(&str, &str, &[&str]); 2] = [
    ("rate", "rate-image", &[".png"]),
    ("environment", "environment-image", &[".hdr", ".exr"]),
];

/// Whether `--size` stands for this setting.
fn is_part_of_size(key: &str) -> bool {
    matches!(key, "width" | "height")
}

/// Whether these settings say how large the picture is.
pub(super) fn gives_size(given: &Table) -> bool {
    given.keys().any(|key| is_part_of_size(key))
}

impl clap::Args for SettingsArgs {
    fn augment_args(command: Command) -> Command {
        let defaults = Table::try_from(Settings::default()).unwrap_or_default();
        let general = [
            Arg::new("settings")
                .long("settings")
                .value_name("FILE.toml")
                .value_parser(value_parser!(PathBuf))
                .help("Read settings from a TOML file; flags win over it")
                .help_heading("Settings"),
            Arg::new("size")
                .long("size")
                .value_name("WxH")
                .value_parser(values::size)
                .help("Width and height in pixels [default: 1280x720]")
                .help_heading("Picture"),
        ];
        let settings = Settings::ALL
            .iter()
            .filter(|setting| !is_part_of_size(setting.key));
        command
            .args(general)
            .args(settings.map(|setting| flag(setting, defaults.get(setting.key))))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

fn flag(setting: &Setting, default: Option<&Value>) -> Arg {
    let default = match default.map(spelled) {
        Some(default) if !default.is_empty() => format!(" [default: {default}]"),
        _ => String::new(),
    };
    let (value_name, parser) = match setting.kind {
        _ if setting.key == "rate" => ("SOURCE|FILE.png", source_parser(setting)),
        _ if setting.key == "environment" => ("SOURCE|FILE.hdr|FILE.exr", source_parser(setting)),
        Kind::Switch => (
            "BOOL",
            ValueParser::new(BoolValueParser::new().map(Value::from)),
        ),
        Kind::Choice(names) => (
            "WHICH",
            ValueParser::new(PossibleValuesParser::new(names()).map(Value::from)),
        ),
        Kind::Integer { least, most } => {
            let range = RangedI64ValueParser::<i64>::new().range(least..=most);
            ("N", ValueParser::new(range.map(Value::from)))
        }
        Kind::Number { least, .. } if least > 0.0 => (
            "X",
            ValueParser::new(|text: &str| values::positive(text).map(Value::from)),
        ),
        Kind::Number { .. } => (
            "X",
            ValueParser::new(|text: &str| values::finite(text).map(Value::from)),
        ),
        Kind::Place => (
            "X,Y",
            ValueParser::new(|text: &str| values::vec2(text).map(|at| Value::from(at.to_vec()))),
        ),
        Kind::Text if setting.key == "lens" => ("NAME|FILE.toml", ValueParser::new(lens)),
        Kind::Text if setting.key == "display" => ("DISPLAY", text_of::<Display>()),
        Kind::Text if setting.key == "eye-tangents" => ("TANGENTS", text_of::<EyeFrusta>()),
        Kind::Text => (
            "TEXT",
            ValueParser::new(|text: &str| Ok::<_, String>(Value::from(text))),
        ),
        Kind::File => (
            match setting.key {
                "environment-image" => "FILE.hdr|FILE.exr",
                _ => "FILE.png",
            },
            ValueParser::new(|text: &str| Ok::<_, String>(Value::from(text))),
        ),
    };
    Arg::new(setting.key)
        .long(setting.key)
        .value_name(value_name)
        .value_parser(parser)
        .allow_negative_numbers(matches!(setting.kind, Kind::Number { .. }))
        .allow_hyphen_values(matches!(
            setting.kind,
            Kind::Number { .. } | Kind::Place | Kind::Text
        ))
        .help(format!("{}{default}", setting.help))
        .help_heading(setting.stage)
}

/// A text that a setting's type can read.
fn text_of<T: FromStr<Err = foveal::Error>>() -> ValueParser {
    ValueParser::new(|text: &str| match text.parse::<T>() {
        Ok(_) => Ok(Value::from(text)),
        // The flag is named already.
        Err(foveal::Error::Setting { expected, .. }) => Err(format!("it must be {expected}")),
        Err(cause) => Err(cause.to_string()),
    })
}

/// What `--lens` names; a file's coefficients go into the settings themselves.
fn lens(text: &str) -> Result<Value, String> {
    if names_lens_file(text) {
        return lens_file(Path::new(text)).map(Value::from);
    }
    match text.parse::<Lens>() {
        Ok(_) => Ok(Value::from(text)),
        Err(foveal::Error::Setting { expected, .. }) => Err(format!("it must be {expected}")),
        Err(cause) => Err(cause.to_string()),
    }
}

/// Whether a lens is said by a file.
pub(super) fn names_lens_file(text: &str) -> bool {
    is_file(text, &[".toml"])
}

/// A lens's file as the coefficients that stand for it.
pub(super) fn lens_file(path: &Path) -> Result<String, String> {
    let wrong = |cause: &str| format!("the lens file '{}': {cause}", path.display());
    let file = crate::text_file::read(path).map_err(|e| wrong(&e.to_string()))?;
    let LensProfile {
        distortion,
        red,
        blue,
    } = toml::from_str(&file).map_err(|e: toml::de::Error| wrong(e.message()))?;
    let numbers = distortion.iter().chain(&red).chain(&blue);
    let numbers: Vec<String> = numbers.map(ToString::to_string).collect();
    Ok(numbers.join(","))
}

/// Whether a name ends like one of these.
fn is_file(name: &str, ends: &[&str]) -> bool {
    let name = name.to_lowercase();
    ends.iter().any(|end| name.ends_with(end))
}

/// What `--rate` or `--environment` names.
fn source_parser(setting: &Setting) -> ValueParser {
    let names = match setting.kind {
        Kind::Choice(names) => names(),
        _ => &[],
    };
    let of_key = |(key, ..): &&(&str, &str, _)| *key == setting.key;
    let ends = SOURCES.iter().find(of_key).map_or(&[][..], |s| s.2);
    ValueParser::new(move |text: &str| {
        if names.contains(&text) || is_file(text, ends) {
            Ok(Value::from(text))
        } else {
            let (names, ends) = (names.join(", "), ends.join(" or "));
            Err(format!("neither {names}, nor a {ends} file"))
        }
    })
}

/// A value as its flag spells it.
fn spelled(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => (*number as f32).to_string(),
        Value::Array(parts) => parts.iter().map(spelled).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}

impl clap::FromArgMatches for SettingsArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut args = Self::default();
        args.update_from_arg_matches(matches)?;
        Ok(args)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        if let Some(file) = matches.get_one::<PathBuf>("settings") {
            self.file = Some(file.clone());
        }
        if let Some(&(width, height)) = matches.get_one::<(u32, u32)>("size") {
            self.given.insert("width".to_owned(), width.into());
            self.given.insert("height".to_owned(), height.into());
        }
        for setting in Settings::ALL {
            if is_part_of_size(setting.key) {
                continue;
            }
            if let Some(value) = matches.get_one::<Value>(setting.key) {
                self.given.insert(setting.key.to_owned(), value.clone());
            }
        }
        self.split_sources(matches)
    }
}

impl SettingsArgs {
    /// The settings file, where there is one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Whether the flag `--key` is given.
    pub fn gives(&self, key: &str) -> bool {
        self.given.contains_key(key)
    }

    /// As the flag `--key value` does.
    pub fn set(&mut self, key: &str, value: &str) {
        self.given.insert(key.to_owned(), value.into());
    }

    /// As the flag `--key true` does, where that flag is not given.
    pub fn switch_on_by_default(&mut self, key: &str) {
        if !self.gives(key) {
            self.given.insert(key.to_owned(), true.into());
        }
    }

    /// A file's name given for a source goes where it belongs.
    ///
    /// # Errors
    /// Where another file is named there.
    fn split_sources(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for (key, file_key, ends) in SOURCES {
            let Some(Value::String(name)) = matches.get_one::<Value>(key) else {
                continue;
            };
            if !is_file(name, ends) {
                continue;
            }
            let file = Value::from(name.as_str());
            if let Some(other) = matches.get_one::<Value>(file_key)
                && *other != file
            {
                let other = spelled(other);
                return Err(clap::Error::raw(
                    ErrorKind::ArgumentConflict,
                    format!("--{key} {name} and --{file_key} {other} name two files: give one\n"),
                ));
            }
            self.given.insert(key.to_owned(), Value::from("image"));
            self.given.insert(file_key.to_owned(), file);
        }
        Ok(())
    }
}

/// The flags that make `settings` out of the defaults, in the order of the table.
pub fn flags(settings: &Settings) -> Vec<String> {
    let of = |settings: &Settings| Table::try_from(settings).unwrap_or_default();
    let (chosen, default) = (of(settings), of(&Settings::default()));
    let mut flags = Vec::new();
    let sizes = [settings, &Settings::default()].map(|s| (s.picture.width, s.picture.height));
    if sizes[0] != sizes[1] {
        flags.push("--size".to_owned());
        flags.push(format!(
            "{}x{}",
            settings.picture.width, settings.picture.height
        ));
    }
    for setting in Settings::ALL {
        if is_part_of_size(setting.key) || chosen.get(setting.key) == default.get(setting.key) {
            continue;
        }
        if let Some(value) = chosen.get(setting.key) {
            flags.push(format!("--{}", setting.key));
            flags.push(spelled(value));
        }
    }
    flags
}
