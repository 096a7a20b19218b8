//! Settings from files and flags, and the table behind both.

use clap::Parser;
use foveal::{DebugView, Kind, Setting};
use toml::Value;

use super::super::args::flags;
use super::*;

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    settings: SettingsArgs,
}

fn from_flags(flags: &[&str]) -> Settings {
    let line = Line::try_parse_from([&["x"], flags].concat()).unwrap();
    line.settings.resolve().unwrap()
}

/// As the flags say, be it sensible or not.
fn unchecked(flags: &[String]) -> Settings {
    let words = std::iter::once("x").chain(flags.iter().map(String::as_str));
    let line = Line::try_parse_from(words).unwrap();
    with(&Settings::default(), &line.settings.given).unwrap()
}

/// Settings that differ from the defaults under each key, as far as they can, by the table alone.
fn changed(setting: &Setting, default: &Value) -> Value {
    match (setting.kind, default) {
        (Kind::Switch, Value::Boolean(on)) => Value::from(!on),
        (Kind::Choice(names), Value::String(default)) => {
            let other = names().iter().find(|name| *name != default);
            Value::from(*other.expect("a choice"))
        }
        (Kind::Integer { least, most }, Value::Integer(default)) => {
            Value::from(if *default == least { most } else { least })
        }
        (Kind::Number { least, most }, Value::Float(default)) => {
            let middle = f64::from((0.25 * least + 0.75 * most) as f32);
            assert_ne!(middle, *default);
            Value::from(middle)
        }
        (Kind::Place, Value::Array(_)) => Value::from(vec![0.25, -0.5]),
        (Kind::Text, Value::String(_)) if setting.key == "lens" => Value::from("dk1"),
        (Kind::Text, Value::String(_)) if setting.key == "display" => Value::from("fhd-24"),
        (Kind::Text, Value::String(_)) => Value::from("-1,0.5,-1,1,-0.5,1,-1,1"),
        (Kind::File, Value::String(_)) => Value::from("a b.png"),
        (kind, value) => panic!("{}: {value} is no {kind:?}", setting.key),
    }
}

#[test]
fn no_setting_is_missing_from_file_flags_or_table() {
    let defaults = Table::try_from(Settings::default()).unwrap();
    let mut in_file: Vec<&str> = defaults.keys().map(String::as_str).collect();
    let mut in_table: Vec<&str> = Settings::ALL.iter().map(|s| s.key).collect();
    in_file.sort_unstable();
    in_table.sort_unstable();
    assert_eq!(in_file, in_table, "what panels and flags are made from");
    let command = <Line as clap::CommandFactory>::command();
    let mut in_flags: Vec<&str> = command
        .get_arguments()
        .filter_map(|a| a.get_long())
        .collect();
    in_flags.retain(|flag| *flag != "settings");
    let size = in_flags.iter().position(|flag| *flag == "size").unwrap();
    in_flags.splice(size..=size, ["width", "height"]);
    in_flags.sort_unstable();
    assert_eq!(in_flags, in_table);
}

#[test]
fn every_setting_goes_through_file_flags_and_table_unchanged() {
    let defaults = Table::try_from(Settings::default()).unwrap();
    let mut all = Table::new();
    for setting in Settings::ALL {
        let key = setting.key;
        let value = changed(setting, &defaults[key]);
        let by_table = with(
            &Settings::default(),
            &Table::from_iter([(key.to_owned(), value.clone())]),
        )
        .unwrap();
        assert_ne!(by_table, Settings::default(), "{key}");
        let by_file = parse(&format!("{key} = {value}")).unwrap();
        assert_eq!(by_file, by_table, "{key}");
        assert_eq!(unchecked(&flags(&by_table)), by_table, "{key}");
        all.insert(key.to_owned(), value);
    }
    let all = with(&Settings::default(), &all).unwrap();
    assert_eq!(unchecked(&flags(&all)), all);
    assert_eq!(parse(&toml::to_string(&all).unwrap()).unwrap(), all);
}

/// What no slider can be set to shall not be what the renderer refuses.
#[test]
fn the_ends_of_every_range_are_valid() {
    for setting in Settings::ALL {
        let ends: [Value; 2] = match setting.kind {
            Kind::Integer { least, most } => [least.into(), most.into()],
            Kind::Number { least, most } => [least.into(), most.into()],
            _ => continue,
        };
        for end in ends {
            let one = Table::from_iter([(setting.key.to_owned(), end.clone())]);
            let settings = with(&Settings::default(), &one).unwrap();
            check(&settings).unwrap_or_else(|e| panic!("{} = {end}: {e}", setting.key));
        }
    }
}

#[test]
fn a_rate_may_be_a_file() {
    for flags in [
        &["--rate", "a.PNG"][..],
        &["--rate", "image", "--rate-image", "a.PNG"],
    ] {
        let settings = from_flags(flags);
        assert_eq!(settings.coarse.source, foveal::RateSource::Image);
        assert_eq!(settings.coarse.image_name, "a.PNG");
    }
    assert!(Line::try_parse_from(["x", "--rate", "sideways"]).is_err());
}

#[test]
fn an_environment_may_be_a_file() {
    for flags in [
        &["--environment", "a.HDR"][..],
        &["--environment", "image", "--environment-image", "a.HDR"],
    ] {
        let lighting = from_flags(flags).lighting;
        assert_eq!(lighting.environment, foveal::EnvironmentSource::Image);
        assert_eq!(lighting.environment_image, "a.HDR");
    }
    let sky = from_flags(&["--environment", "sky"]).lighting;
    assert_eq!(sky.environment, foveal::EnvironmentSource::Sky);
    assert!(Line::try_parse_from(["x", "--environment", "a.png"]).is_err());
}

#[test]
fn a_source_names_one_file() {
    let flags = ["x", "--environment", "a.hdr", "--environment-image"];
    let both = |name| Line::try_parse_from(flags.iter().chain([&name]));
    let error = both("b.hdr").map(|_| ()).unwrap_err().to_string();
    assert!(
        error.contains("a.hdr") && error.contains("b.hdr"),
        "{error}"
    );
    assert!(both("a.hdr").is_ok());
}

#[test]
fn settings_survive_the_file_format() {
    let settings = Settings::default().with(|s| {
        s.picture.exposure_stops = -0.1;
        s.picture.view = DebugView::BaseColor;
    });
    assert_eq!(
        parse(&toml::to_string(&settings).unwrap()).unwrap(),
        settings
    );
}

#[test]
fn flags_win_over_the_file_and_the_file_over_the_defaults() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, "width = 10\nheight = 20\nexposure = 3.0\n").unwrap();
    let settings = from_flags(&["--settings", path.to_str().unwrap(), "--exposure", "1"]);
    assert_eq!(
        (
            settings.picture.width,
            settings.picture.height,
            settings.picture.exposure_stops
        ),
        (10, 20, 1.0)
    );
    assert_eq!(
        settings.lighting.anisotropy,
        Settings::default().lighting.anisotropy
    );
}

#[test]
fn a_size_is_given_by_a_flag_or_by_a_file_that_names_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    for (text, of_file) in [
        ("exposure = 1.0", false),
        ("height = 20", true),
        ("", false),
    ] {
        std::fs::write(&path, text).unwrap();
        for (size, is_given) in [(None, of_file), (Some("30x20"), true)] {
            let args = SettingsArgs {
                file: Some(path.clone()),
                given: size.map_or_else(Table::new, |_| "width = 30".parse().unwrap()),
            };
            assert_eq!(
                args.resolve_sized().unwrap().1,
                is_given,
                "{text}, {size:?}"
            );
        }
    }
}

#[test]
fn a_lens_may_be_a_file_beside_the_settings() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let lens = write(
        "own.toml",
        "distortion = [0.34, 0.55, 0.0]\nblue = [1.014, 0.0]\n",
    );
    for named in ["\"own.toml\"", "'./own.toml'"] {
        let text = format!("exposure = 1.0\nlens = {named} # of my own\nwidth = 10\n");
        let (settings, is_sized) = read(&write("s.toml", &text)).unwrap();
        let by_flag = from_flags(&["--lens", lens.to_str().unwrap()]);
        assert_eq!(settings.stereo.lens, by_flag.stereo.lens);
        assert_ne!(settings.stereo.lens, Settings::default().stereo.lens);
        assert_eq!((settings.picture.width, is_sized), (10, true));
    }
    write("broken.toml", "distortion = 1\n");
    for (named, cause) in [("none.toml", "the lens file"), ("broken.toml", "array")] {
        let path = write("s.toml", &format!("exposure = 1.0\nlens = \"{named}\"\n"));
        let error = read(&path).unwrap_err().to_string();
        for part in ["s.toml' is wrong in line 2, key 'lens'", named, cause] {
            assert!(error.contains(part), "{part}: {error}");
        }
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn names_of_images_count_from_the_settings_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    let beside = folder.path().join("court.hdr").display().to_string();
    for (name, found) in [("court.hdr", &*beside), ("/a.hdr", "/a.hdr"), ("", "")] {
        let text = format!("environment-image = '{name}'\nrate-image = '{name}'\n");
        std::fs::write(&path, text).unwrap();
        let settings = read(&path).unwrap().0;
        assert_eq!(settings.lighting.environment_image, found);
        assert_eq!(settings.coarse.image_name, found);
    }
}

#[test]
fn a_wrong_settings_file_is_named_with_line_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    for (text, line, key) in [
        ("width = 10\nexposure = \"bright\"\n", 2, "exposure"),
        ("\n\ngamma = 2.2\n", 3, "gamma"),
        ("view = \"sideways\"", 1, "view"),
        ("width = -3", 1, "width"),
        ("width = ", 1, "width"),
    ] {
        std::fs::write(&path, text).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("s.toml"), "{error}");
        assert!(
            error.contains(&format!("line {line}, key '{key}'")),
            "{error}"
        );
    }
}

#[test]
fn senseless_values_are_refused() {
    for text in [
        "width = 0",
        "exposure = nan",
        "exposure = inf",
        "anisotropy = 0",
        "anisotropy = 17",
        "coarsest-level = 9",
        "fovea-curve = 0.0",
        "fovea-inner = -1.0",
        "gaze = [nan, 0.0]",
        "view = \"rate\"",
    ] {
        assert!(check(&parse(text).unwrap()).is_err(), "{text}");
    }
}

#[test]
fn a_file_whose_values_make_no_sense_is_named_unless_flags_mend_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dark.toml");
    std::fs::write(&file, "exposure = nan").unwrap();
    let resolve = |flags: &[&str]| {
        let words = ["x", "--settings", file.to_str().unwrap()];
        Line::try_parse_from([&words, flags].concat())
            .unwrap()
            .settings
            .resolve()
    };
    let error = format!("{:#}", resolve(&[]).unwrap_err());
    for part in ["dark.toml' is wrong: ", "exposure", "NaN"] {
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(
        resolve(&["--exposure", "1"])
            .unwrap()
            .picture
            .exposure_stops,
        1.0
    );
}
