//! Screenshots, settings files, and the command that draws the same.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::anyhow;

use super::App;
use crate::command;
use crate::needs;
use crate::worker::Rgba;

impl App {
    /// Writes the picture, as it was drawn, beside the program's other files.
    pub(crate) fn take_screenshot(&mut self, context: &egui::Context) {
        let Some(shown) = &self.shown else { return };
        let free = (1..).map(|n| PathBuf::from(format!("foveal-{n:03}.png")));
        let path = free.into_iter().find(|path| !path.exists());
        let path = path.unwrap_or_else(|| PathBuf::from("foveal.png"));
        let written = png(&shown.picture).and_then(|png| (self.host.write_file)(&path, &png));
        self.tell_of(context, "Screenshot", &path, written);
    }

    pub(crate) fn save_settings(&mut self, context: &egui::Context) {
        if let Some(wrong) = &self.wrong {
            // Those of the picture are not the ones that the panels show.
            self.complain(format!("The settings are not saved: {wrong}"));
            return;
        }
        let path = PathBuf::from(&self.settings_file);
        let written = self
            .settings_text(&path)
            .and_then(|text| (self.host.write_file)(&path, text.as_bytes()));
        self.tell_of(context, "Settings saved", &path, written);
    }

    /// The settings as the file `path` has them; without a size where that is the window's.
    fn settings_text(&self, path: &Path) -> anyhow::Result<String> {
        let is_here = path.parent().is_some_and(|folder| folder == Path::new(""));
        let settings = self.settings.clone().with(|s| {
            let images = [&mut s.coarse.image_name, &mut s.lighting.environment_image];
            // In another folder's file their names would count from there.
            for image in images.into_iter().filter(|i| !is_here && !i.is_empty()) {
                if let Ok(path) = std::path::absolute(&*image) {
                    *image = path.display().to_string();
                }
            }
        });
        // A table of values would lose the list's order, and have numbers of 64 bits.
        let text = toml::to_string(&settings)?;
        let sizes = ["width = ", "height = "];
        let is_kept =
            |line: &&str| !self.display.fit || !sizes.iter().any(|size| line.starts_with(size));
        Ok(text.split_inclusive('\n').filter(is_kept).collect())
    }

    fn tell_of(
        &mut self,
        context: &egui::Context,
        what: &str,
        path: &Path,
        written: anyhow::Result<()>,
    ) {
        match written {
            Ok(()) => self.say(context, format!("{what}: {}", path.display())),
            Err(error) => self.complain(format!("{error:#}")),
        }
    }

    /// Reads settings from a file, which is the one that they are saved to then.
    pub(crate) fn load_settings(&mut self, context: &egui::Context, file: String) {
        let read = (self.host.read_settings)(Path::new(&file));
        let sound = read.and_then(|(settings, is_sized)| {
            let sound = needs::sound(settings);
            let cannot = |cause| anyhow!("the settings file '{file}' is wrong: {cause}");
            Ok((sound.map_err(cannot)?, is_sized))
        });
        match sound {
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

fn png(picture: &Rgba) -> anyhow::Result<Vec<u8>> {
    let Rgba {
        width,
        height,
        bytes,
    } = picture;
    let mut png = Cursor::new(Vec::new());
    let (color, format) = (image::ColorType::Rgba8, image::ImageFormat::Png);
    image::write_buffer_with_format(&mut png, bytes, *width, *height, color, format)?;
    Ok(png.into_inner())
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use anyhow::bail;
    use foveal::Settings;
    use toml::Table;

    use super::*;
    use crate::app::tests::{app, loaded};

    /// What was written last.
    static SAVED: Mutex<Vec<u8>> = Mutex::new(Vec::new());

    #[test]
    fn a_size_is_saved_only_where_it_is_not_the_windows() {
        let mut app = app();
        Arc::get_mut(&mut app.host).unwrap().write_file = |_, bytes| {
            *SAVED.lock().unwrap() = bytes.to_vec();
            Ok(())
        };
        for fit in [true, false] {
            app.display.fit = fit;
            app.save_settings(&egui::Context::default());
            let saved = String::from_utf8(std::mem::take(&mut *SAVED.lock().unwrap())).unwrap();
            let table: Table = saved.parse().unwrap();
            for key in ["width", "height"] {
                assert_eq!(table.contains_key(key), !fit, "{key}: {saved}");
            }
            let settings: Settings = table.try_into().unwrap();
            assert_eq!(settings, app.settings);
        }
    }

    #[test]
    fn saved_settings_read_as_people_write_them_in_the_lists_order() {
        let app = app();
        let text = app.settings_text(Path::new("s.toml")).unwrap();
        for line in ["contrast-threshold = 0.04", "ipd = 0.063"] {
            assert!(text.lines().any(|l| l == line), "{line}: {text}");
        }
        let keys: Vec<&str> = text.lines().filter_map(|l| l.split(" = ").next()).collect();
        let of_size = |key: &&str| ["width", "height"].contains(key);
        let listed = Settings::ALL.iter().map(|setting| setting.key);
        assert_eq!(keys, listed.filter(|key| !of_size(key)).collect::<Vec<_>>());
    }

    #[test]
    fn images_are_found_from_the_folder_that_settings_are_saved_in() {
        let mut app = app();
        app.settings.lighting.environment_image = "court.hdr".to_owned();
        let full = std::path::absolute("court.hdr")
            .unwrap()
            .display()
            .to_string();
        for (file, image) in [("s.toml", "court.hdr"), ("looks/s.toml", &full)] {
            let table: Table = app.settings_text(Path::new(file)).unwrap().parse().unwrap();
            assert_eq!(table["environment-image"].as_str(), Some(image), "{file}");
            assert_eq!(table["rate-image"].as_str(), Some(""), "{file}");
        }
    }

    #[test]
    fn what_cannot_be_written_is_told() {
        let mut app = loaded();
        Arc::get_mut(&mut app.host).unwrap().write_file =
            |path, _| bail!("cannot write '{}': the disk is full", path.display());
        let context = egui::Context::default();
        for save in [App::save_settings, App::take_screenshot] {
            app.messages.clear();
            save(&mut app, &context);
            let message = &app.messages[0];
            assert!(
                message.is_error && message.text.contains("full"),
                "{message:?}"
            );
        }
    }

    #[test]
    fn settings_that_make_no_sense_are_neither_loaded_nor_saved() {
        let mut app = loaded();
        let context = egui::Context::default();
        let before = app.draft.clone();
        let host = Arc::get_mut(&mut app.host).unwrap();
        host.read_settings = |_| {
            Ok((
                Settings::default().with(|s| s.picture.exposure_stops = f32::NAN),
                true,
            ))
        };
        host.write_file = |path, _| panic!("{} is written", path.display());
        app.load_settings(&context, "dark.toml".to_owned());
        let message = app.messages.pop().unwrap();
        assert!(message.is_error, "{message:?}");
        for part in ["'dark.toml'", "exposure", "NaN"] {
            assert!(message.text.contains(part), "{message:?}");
        }
        assert!(app.display.fit);
        assert_eq!(
            (app.draft.clone(), app.settings_file.as_str()),
            (before, "foveal.toml")
        );

        app.draft.insert("eye-tangents".to_owned(), "wide".into());
        app.take_settings();
        app.save_settings(&context);
        let message = &app.messages[0];
        assert!(
            message.is_error && message.text.contains("wide"),
            "{message:?}"
        );
    }

    #[test]
    fn a_screenshot_is_a_png_of_the_picture() {
        let picture = Rgba {
            width: 2,
            height: 1,
            bytes: vec![1, 2, 3, 255, 4, 5, 6, 255],
        };
        let read = image::load_from_memory(&png(&picture).unwrap()).unwrap();
        assert_eq!(read.to_rgba8().into_raw(), picture.bytes);
    }
}
