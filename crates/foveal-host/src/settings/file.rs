//! Settings from three places: the defaults, below a TOML file, below the flags.

use std::path::Path;

use anyhow::{Context, anyhow};
use foveal::Settings;
use toml::Table;

use super::args::{SettingsArgs, gives_size};

impl SettingsArgs {
    /// The settings that hold.
    ///
    /// # Errors
    /// Where the file cannot be read, and where a value makes no sense whatever the device is.
    pub fn resolve(&self) -> anyhow::Result<Settings> {
        Ok(self.resolve_sized()?.0)
    }

    /// The settings that hold, and whether flags or file say how large the picture is.
    ///
    /// # Errors
    /// As [`SettingsArgs::resolve`].
    pub fn resolve_sized(&self) -> anyhow::Result<(Settings, bool)> {
        let (below, is_sized) = match &self.file {
            Some(path) => read(path)?,
            None => (Settings::default(), false),
        };
        let settings = with(&below, &self.given)?;
        check(&settings)?;
        Ok((settings, is_sized || gives_size(&self.given)))
    }
}

/// `settings` with other values under some keys.
fn with(settings: &Settings, given: &Table) -> anyhow::Result<Settings> {
    let mut table = Table::try_from(settings)?;
    table.extend(given.clone());
    Ok(table.try_into()?)
}

/// Refuses what is wrong on every device; each device's own limits are the renderer's to check.
///
/// # Errors
/// Names the setting.
pub fn check(settings: &Settings) -> anyhow::Result<()> {
    let boundless = wgpu::Limits {
        max_texture_dimension_2d: u32::MAX,
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        ..wgpu::Limits::default()
    };
    Ok(settings.validate(&boundless)?)
}

/// Reads a settings file, and whether it says how large the picture is.
///
/// # Errors
/// Where it cannot be read, and where it is wrong, with line and key.
pub fn read(path: &Path) -> anyhow::Result<(Settings, bool)> {
    let text = crate::text_file::read(path)
        .with_context(|| format!("cannot read the settings file '{}'", path.display()))?;
    let settings = from_text(&text, &path.display().to_string())?;
    let given: Table = toml::from_str(&text)?;
    Ok((settings, gives_size(&given)))
}

/// Reads the text of a settings file of this name.
///
/// # Errors
/// Where it is wrong, with line and key.
pub fn from_text(text: &str, name: &str) -> anyhow::Result<Settings> {
    parse(text).map_err(|error| {
        let place = match error.span() {
            Some(span) => place(text, span.start),
            None => String::new(),
        };
        anyhow!(
            "the settings file '{name}' is wrong{place}: {}",
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
mod tests;
