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
    let number = || text.parse::<f64>().map(Value::from);
    switch.or_else(|_| number()).unwrap_or_else(|_| text.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_switches_are_told_apart() {
        let changes = [
            ("shading", "coarse"),
            ("quality", "9"),
            ("force-rate", "true"),
        ];
        let settings = changed(&Settings::default(), &changes).unwrap();
        assert_eq!(settings.shading.mode, foveal::Shading::Coarse);
        assert_eq!((settings.eye.quality_jod, settings.rate.force), (9.0, true));
        assert!(changed(&Settings::default(), &[("shade", "coarse")]).is_err());
    }
}
