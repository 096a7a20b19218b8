//! Settings from three places: the defaults, below a TOML file, below the flags.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use foveal::{
    Antialiasing, Culling, EdgeTest, Geometry, LightAssignment, LightingModel, SamplePattern,
    Settings, ToneMap, View,
};

use super::coarse_args::CoarseArgs;
use crate::values::{self, VariantParser};

/// A flag for each field of [`Settings`]; what is not given stays as the file or the default says.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct SettingsArgs {
    /// Read settings from a TOML file; flags win over it
    #[arg(long = "settings", value_name = "FILE.toml")]
    file: Option<PathBuf>,

    /// Width and height in pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,

    /// What the picture shows [default: final]
    #[arg(long, value_parser = VariantParser::<View>::new())]
    view: Option<View>,

    /// Which objects are drawn: those in the frustum, of these the ones that nothing hides, or all (the
    /// reference); the picture is the same [default: frustum]
    #[arg(long, value_name = "WHICH", value_parser = VariantParser::<Culling>::new())]
    culling: Option<Culling>,

    /// How the G-buffer is filled: by the rasterizer, or by a visibility buffer whose materials are evaluated once
    /// per pixel; the picture is the same but for rounding [default: gbuffer]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<Geometry>::new())]
    geometry: Option<Geometry>,

    /// How surfaces reflect light [default: ggx]
    #[arg(long, value_name = "MODEL", value_parser = VariantParser::<LightingModel>::new())]
    lighting: Option<LightingModel>,

    /// Which lights a sample looks at: those that reach its cluster, or all of them (the reference)
    /// [default: clustered]
    #[arg(long, value_name = "WHICH", value_parser = VariantParser::<LightAssignment>::new())]
    lights: Option<LightAssignment>,

    /// Exposure in stops; +1 doubles the light [default: 0]
    #[arg(long, value_name = "EV", value_parser = values::finite, allow_hyphen_values = true)]
    exposure: Option<f32>,

    /// How radiance becomes display values [default: aces]
    #[arg(long, value_name = "CURVE", value_parser = VariantParser::<ToneMap>::new())]
    tone_map: Option<ToneMap>,

    /// Largest anisotropy of texture filtering, 1 to 16 [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=16))]
    anisotropy: Option<u16>,

    /// How edges are smoothed: not at all, by shading every sub-sample, or once per surface in a pixel
    /// [default: none]
    #[arg(long, value_name = "MODE", value_parser = VariantParser::<Antialiasing>::new())]
    aa: Option<Antialiasing>,

    /// Sub-samples per pixel with --aa: 4, 9, 16, ... up to 256 for the grid (msaa: 16), 4 or 8 for the
    /// rotated pattern [default: 4]
    #[arg(long, value_name = "N")]
    samples: Option<u32>,

    /// Where the sub-samples lie [default: grid]
    #[arg(long, value_parser = VariantParser::<SamplePattern>::new())]
    pattern: Option<SamplePattern>,

    /// Which pixels msaa takes for edges: several surfaces, the source's depth difference, or none
    /// [default: surface]
    #[arg(long, value_name = "TEST", value_parser = VariantParser::<EdgeTest>::new())]
    edge_test: Option<EdgeTest>,

    #[command(flatten)]
    coarse: CoarseArgs,
}

impl SettingsArgs {
    /// The settings that hold.
    ///
    /// # Errors
    /// Where the file cannot be read, and where a value makes no sense whatever the device is.
    pub(super) fn resolve(&self) -> anyhow::Result<Settings> {
        let mut settings = match &self.file {
            Some(path) => read(path)?,
            None => Settings::default(),
        };
        self.apply(&mut settings);
        check(&settings)?;
        Ok(settings)
    }

    fn apply(&self, settings: &mut Settings) {
        // Taken apart without `..`, so that a flag that is added but not applied does not compile.
        let Self {
            file: _,
            size,
            view,
            culling,
            geometry,
            lighting,
            lights,
            exposure,
            tone_map,
            anisotropy,
            aa,
            samples,
            pattern,
            edge_test,
            coarse,
        } = self.clone();
        if let Some((width, height)) = size {
            (settings.width, settings.height) = (width, height);
        }
        set(&mut settings.view, view);
        set(&mut settings.culling, culling);
        set(&mut settings.geometry, geometry);
        set(&mut settings.lighting, lighting);
        set(&mut settings.lights, lights);
        set(&mut settings.exposure, exposure);
        set(&mut settings.tone_map, tone_map);
        set(&mut settings.anisotropy, anisotropy);
        set(&mut settings.aa, aa);
        set(&mut settings.samples, samples);
        set(&mut settings.pattern, pattern);
        set(&mut settings.edge_test, edge_test);
        coarse.apply(settings);
    }
}

pub(super) fn set<T>(setting: &mut T, flag: Option<T>) {
    if let Some(value) = flag {
        *setting = value;
    }
}

/// What is wrong on every device; each device's own limits are the renderer's to check.
fn check(settings: &Settings) -> anyhow::Result<()> {
    let boundless = wgpu::Limits {
        max_texture_dimension_2d: u32::MAX,
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        ..wgpu::Limits::default()
    };
    Ok(settings.validate(&boundless)?)
}

fn read(path: &Path) -> anyhow::Result<Settings> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("cannot read the settings file '{}'", path.display()))?;
    parse(&text).map_err(|error| {
        let place = match error.span() {
            Some(span) => place(&text, span.start),
            None => String::new(),
        };
        anyhow!(
            "the settings file '{}' is wrong{place}: {}",
            path.display(),
            error.message()
        )
    })
}

fn parse(text: &str) -> Result<Settings, toml::de::Error> {
    toml::from_str(text)
}

/// «in line 3, key 'exposure'» for a byte offset.
fn place(text: &str, offset: usize) -> String {
    let before = &text[..text.floor_char_boundary(offset)];
    let number = before.matches('\n').count() + 1;
    let line = text.lines().nth(number - 1).unwrap_or_default();
    match line.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => {
            format!(" in line {number}, key '{}'", key.trim())
        }
        _ => format!(" in line {number}"),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

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

    /// For each key of the settings file: its flag, and a value that is not the default in both spellings.
    const KEYS: [(&str, &str, &[&str]); 30] = [
        ("width", "33", &["--size", "33x720"]),
        ("height", "44", &["--size", "1280x44"]),
        ("view", "\"normals\"", &["--view", "normals"]),
        ("culling", "\"off\"", &["--culling", "off"]),
        ("geometry", "\"visibility\"", &["--geometry", "visibility"]),
        (
            "lighting",
            "\"blinn-phong\"",
            &["--lighting", "blinn-phong"],
        ),
        ("lights", "\"brute\"", &["--lights", "brute"]),
        ("exposure", "-1.5", &["--exposure", "-1.5"]),
        ("tone-map", "\"linear\"", &["--tone-map", "linear"]),
        ("anisotropy", "2", &["--anisotropy", "2"]),
        ("aa", "\"msaa\"", &["--aa", "msaa"]),
        ("samples", "9", &["--samples", "9"]),
        ("pattern", "\"rotated\"", &["--pattern", "rotated"]),
        ("edge-test", "\"paper\"", &["--edge-test", "paper"]),
        ("shading", "\"coarse\"", &["--shading", "coarse"]),
        ("backend", "\"stencil\"", &["--backend", "stencil"]),
        ("coarsest-level", "5", &["--coarsest-level", "5"]),
        ("rate", "\"constant\"", &["--rate", "constant"]),
        ("rate-other", "\"image\"", &["--rate-other", "image"]),
        ("rate-combine", "\"finer\"", &["--rate-combine", "finer"]),
        ("rate-level", "3", &["--rate-level", "3"]),
        ("rate-image", "\"a.png\"", &["--rate-image", "a.png"]),
        ("gaze", "[0.25, -0.5]", &["--gaze", "0.25,-0.5"]),
        ("fovea-inner", "0.25", &["--fovea-inner", "0.25"]),
        ("fovea-outer", "0.75", &["--fovea-outer", "0.75"]),
        ("fovea-curve", "2.5", &["--fovea-curve", "2.5"]),
        ("rate-balance", "false", &["--rate-balance", "false"]),
        ("refine-edges", "\"off\"", &["--refine-edges", "off"]),
        (
            "coarse-sample",
            "\"typical\"",
            &["--coarse-sample", "typical"],
        ),
        ("composite", "\"paper\"", &["--composite", "paper"]),
    ];

    #[test]
    fn every_setting_has_a_key_and_a_flag_that_agree() {
        let default = serde_json::to_value(Settings::default()).unwrap();
        let mut keys: Vec<&str> = default
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        let mut tested = KEYS.map(|(key, ..)| key).to_vec();
        keys.sort_unstable();
        tested.sort_unstable();
        assert_eq!(
            keys, tested,
            "each setting needs a flag in SettingsArgs and a line in this test"
        );
        for (key, value, flags) in KEYS {
            let by_file = parse(&format!("{key} = {value}")).unwrap();
            assert_eq!(by_file, from_flags(flags), "{key}");
            assert_ne!(by_file, Settings::default(), "{key}");
        }
    }

    #[test]
    fn settings_survive_the_file_format() {
        let settings = Settings {
            exposure: -0.1,
            view: View::BaseColor,
            ..Settings::default()
        };
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
            (settings.width, settings.height, settings.exposure),
            (10, 20, 1.0)
        );
        assert_eq!(settings.anisotropy, Settings::default().anisotropy);
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
}
