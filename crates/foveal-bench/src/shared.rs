//! Settings that every way of a bench has, so that each is measured in the frame that a user draws:
//! with shadows, say.

use anyhow::{Context, bail};
use foveal::Settings;

use crate::changes::changed;

/// What a bench chooses itself: the picture, and what its ways are compared by.
const CHOSEN: [&str; 8] = [
    "width", "height", "view", "show", "stereo", "shading", "display", "gaze",
];

/// Settings that all ways share.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct SharedArgs {
    /// Setting that the plain frame and all others have, by its flag's name, such as shadows=soft;
    /// may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() && !value.is_empty() => {
            Ok((name.to_owned(), value.to_owned()))
        }
        _ => Err("a name, `=` and a value are expected, such as shadows=soft".to_owned()),
    }
}

impl SharedArgs {
    /// The plain settings of a picture of this size. Fails where a setting is unknown, has no such
    /// value, or is the bench's to choose.
    pub(super) fn plain(&self, (width, height): (u32, u32)) -> anyhow::Result<Settings> {
        let mut settings = Settings::default().with(|s| {
            s.picture.width = width;
            s.picture.height = height;
        });
        for (name, value) in &self.set {
            if CHOSEN.contains(&name.as_str()) {
                bail!("--set {name}={value}: this bench chooses `{name}` itself");
            }
            settings = changed(&settings, &[(name, value)])
                .with_context(|| format!("--set {name}={value}"))?;
        }
        Ok(settings)
    }

    /// As they were given, `NAME=VALUE` each.
    pub(super) fn spelled(&self) -> Vec<String> {
        let spell = |(name, value): &(String, String)| format!("{name}={value}");
        self.set.iter().map(spell).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shared(set: &[&str]) -> SharedArgs {
        SharedArgs {
            set: set.iter().map(|text| pair(text).unwrap()).collect(),
        }
    }

    #[test]
    fn plain_settings_have_what_is_shared() {
        let given = shared(&["shadows=soft", "exposure=1"]);
        let plain = given.plain((320, 180)).unwrap();
        assert_eq!((plain.picture.width, plain.picture.height), (320, 180));
        assert_eq!(plain.lighting.shadows, foveal::Shadows::Soft);
        assert_eq!(plain.picture.exposure_stops, 1.0);
        assert_eq!(given.spelled(), ["shadows=soft", "exposure=1"]);
    }

    #[test]
    fn what_cannot_be_set_is_named() {
        assert!(pair("shadows").is_err() && pair("=soft").is_err() && pair("shadows=").is_err());
        for text in [
            "shadow=soft",
            "shadows=softly",
            "width=100",
            "shading=coarse",
            "show=anaglyph",
            "environment=room.hdr",
        ] {
            let error = shared(&[text]).plain((320, 180)).unwrap_err();
            assert!(format!("{error:#}").contains(text), "{error:#}");
        }
    }
}
