//! Settings from three places: the defaults, below a TOML file, below the flags.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, anyhow};
use foveal::Settings;
use serde::Deserialize;
use toml::{Spanned, Table};

use super::args::{SettingsArgs, gives_size, lens_file, names_lens_file};

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
        let checked = check(&settings);
        match &self.file {
            Some(path) if check(&below).is_err() => {
                checked.with_context(|| format!("the settings file '{}' is wrong", path.display()))
            }
            _ => checked,
        }?;
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

/// Reads a settings file, and whether it says how large the picture is. Names of files in it, a
/// lens's too, count from its folder.
///
/// # Errors
/// Where it cannot be read, and where it is wrong, with line and key.
pub fn read(path: &Path) -> anyhow::Result<(Settings, bool)> {
    let text = crate::text_file::read(path)
        .with_context(|| format!("cannot read the settings file '{}'", path.display()))?;
    let name = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = with_lens(text, folder, &name)?;
    let settings = from_text(&text, &name)?.with(|s| {
        let images = [&mut s.coarse.image_name, &mut s.lighting.environment_image];
        for image in images.into_iter().filter(|image| !image.is_empty()) {
            *image = folder.join(&*image).display().to_string();
        }
    });
    let given: Table = toml::from_str(&text)?;
    Ok((settings, gives_size(&given)))
}

/// The settings file's text with the coefficients of its lens where it names the lens's file.
fn with_lens(mut text: String, folder: &Path, name: &str) -> anyhow::Result<String> {
    #[derive(Deserialize)]
    struct Named {
        lens: Spanned<String>,
    }
    // What else is wrong is found when all of it is read.
    if let Ok(Named { lens }) = toml::from_str(&text)
        && names_lens_file(lens.get_ref())
    {
        let coefficients = lens_file(&folder.join(lens.get_ref()))
            .map_err(|cause| wrong(&text, name, Some(lens.span()), &cause))?;
        text.replace_range(lens.span(), &format!("\"{coefficients}\""));
    }
    Ok(text)
}

/// Reads the text of a settings file of this name.
///
/// # Errors
/// Where it is wrong, with line and key.
pub fn from_text(text: &str, name: &str) -> anyhow::Result<Settings> {
    parse(text).map_err(|error| wrong(text, name, error.span(), error.message()))
}

/// Says what is wrong with a settings file, and where.
fn wrong(text: &str, name: &str, span: Option<Range<usize>>, cause: &str) -> anyhow::Error {
    let place = span.map_or_else(String::new, |span| place(text, span.start));
    anyhow!("the settings file '{name}' is wrong{place}: {cause}")
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
