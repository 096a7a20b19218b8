//! Screenshots, settings files, and the command that draws the same.

use std::path::{Path, PathBuf};

use super::App;
use crate::command;
use crate::worker::Rgba;

impl App {
    /// Writes the picture, as it was drawn, beside the program's other files.
    pub(crate) fn take_screenshot(&mut self, context: &egui::Context) {
        let Some(shown) = &self.shown else { return };
        let free = (1..).map(|n| PathBuf::from(format!("foveal-{n:03}.png")));
        let path = free.into_iter().find(|path| !path.exists());
        let path = path.unwrap_or_else(|| PathBuf::from("foveal.png"));
        let Rgba {
            width,
            height,
            bytes,
        } = &shown.picture;
        match image::save_buffer(&path, bytes, *width, *height, image::ColorType::Rgba8) {
            Ok(()) => self.say(context, format!("Screenshot: {}", path.display())),
            Err(error) => {
                self.complain(format!("cannot write '{}': {error}", path.display()));
            }
        }
    }

    pub(crate) fn save_settings(&mut self, context: &egui::Context) {
        let path = PathBuf::from(&self.settings_file);
        let written = toml::to_string(&self.settings)
            .map_err(anyhow::Error::from)
            .and_then(|text| Ok(std::fs::write(&path, text)?));
        match written {
            Ok(()) => self.say(context, format!("Settings saved: {}", path.display())),
            Err(error) => self.complain(format!("cannot write '{}': {error}", path.display())),
        }
    }

    /// Reads settings from a file, which is the one that they are saved to then.
    pub(crate) fn load_settings(&mut self, context: &egui::Context, file: String) {
        match (self.host.read_settings)(Path::new(&file)) {
            Ok((settings, is_sized)) => {
                // A file's size holds; what follows the window has none of its own.
                self.display.fit &= !is_sized;
                self.use_settings(&settings);
                self.say(context, format!("Settings loaded: {file}"));
                self.settings_file = file;
            }
            Err(error) => self.complain(format!("{error:#}")),
        }
    }

    /// The command that draws this picture to a file, byte by byte; `None` without a scene.
    pub(crate) fn command_line(&self) -> Option<String> {
        let (scene, navigator) = (self.scene.as_ref()?, self.navigator.as_ref()?);
        let words = command::words(
            &self.host,
            scene,
            &self.settings,
            navigator.camera(),
            (&self.display.clip, self.display.time_s),
        );
        let quoted: Vec<String> = words.iter().map(|word| (self.host.quoted)(word)).collect();
        Some(quoted.join(" "))
    }
}
