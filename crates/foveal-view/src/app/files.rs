//! Screenshots, settings files, and the command that draws the same.

use std::path::PathBuf;

use glam::Vec3;

use super::App;
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

    pub(crate) fn load_settings(&mut self, context: &egui::Context) {
        match (self.host.read_settings)(&PathBuf::from(&self.settings_file)) {
            Ok(settings) => {
                // A file's size holds; what follows the window has none of its own.
                self.display.fit = false;
                self.use_settings(&settings);
                self.say(context, format!("Settings loaded: {}", self.settings_file));
            }
            Err(error) => self.complain(format!("{error:#}")),
        }
    }

    /// The command that draws this picture to a file.
    pub(crate) fn command_line(&self) -> String {
        let mut words = vec!["foveal".to_owned(), "render".to_owned()];
        words.push(quoted(&self.scene_name));
        words.extend(["--output".to_owned(), "picture.png".to_owned()]);
        if let Some(navigator) = &self.navigator {
            let camera = navigator.camera();
            let forward = -camera.world_from_view.z_axis.truncate();
            let eye = camera.eye();
            let list = |v: Vec3| format!("{},{},{}", v.x, v.y, v.z);
            if let foveal_scene::Projection::Perspective { fov_y_rad, .. } = camera.projection {
                words.extend([
                    "--eye".to_owned(),
                    list(eye),
                    "--target".to_owned(),
                    list(eye + forward),
                    "--fov".to_owned(),
                    fov_y_rad.to_degrees().to_string(),
                ]);
            } else {
                words.extend(["--camera".to_owned(), quoted(&camera.name)]);
            }
        }
        let flags = (self.host.flags)(&self.settings);
        words.extend(flags.iter().map(|flag| quoted(flag)));
        words.join(" ")
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,+=@%#".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_with_spaces_and_quotes_survive_a_shell() {
        assert_eq!(quoted("demo:2000"), "demo:2000");
        assert_eq!(quoted("my scene.glb"), "'my scene.glb'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
