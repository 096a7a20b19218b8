//! Settings that differ from others by what the command line would say.

use foveal::Settings;
use toml::{Table, Value};

/// Keys of a settings file, and their values as flags spell them.
pub(super) type Changes = &'static [(&'static str, &'static str)];

/// `plain` with other values under some keys.
pub(super) fn changed(plain: &Settings, changes: &[(&str, &str)]) -> anyhow::Result<Settings> {
    let mut table = Table::try_from(plain)?;
    for &(key, text) in changes {
        table.insert(key.to_owned(), value(text));
    }
    Ok(table.try_into()?)
}

fn value(text: &str) -> Value {
    let switch = text.parse::<bool>().map(Value::from);
    let whole = || text.parse::<i64>().map(Value::from);
    let number = || text.parse::<f64>().map(Value::from);
    (switch.ok().or_else(|| whole().ok()))
        .or_else(|| number().ok())
        .unwrap_or_else(|| text.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_switches_are_told_apart() {
        let changes = [
            ("shading", "coarse"),
            ("quality", "9"),
            ("shadow-bias", "0.5"),
            ("shadow-atlas", "2048"),
            ("force-rate", "true"),
        ];
        let settings = changed(&Settings::default(), &changes).unwrap();
        assert_eq!(settings.shading.mode, foveal::Shading::Coarse);
        assert_eq!((settings.eye.quality_jod, settings.rate.force), (9.0, true));
        assert_eq!(settings.lighting.shadow_bias, 0.5);
        assert_eq!(settings.lighting.shadow_atlas, 2048);
        assert!(changed(&Settings::default(), &[("shade", "coarse")]).is_err());
    }
}
