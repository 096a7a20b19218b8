//! Files that are dropped onto the window.

use std::path::{Path, PathBuf};

use foveal_scene::ENDINGS;

use super::App;
use crate::browser::Browser;

/// What becomes of the files of one drop.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Sorted {
    scenes: Vec<PathBuf>,
    settings: Vec<PathBuf>,
    others: Vec<PathBuf>,
}

/// Endings of files that scenes name: given together with a scene they are its own business.
const PARTS: [&str; 7] = ["bin", "mtl", "png", "jpg", "jpeg", "webp", "ktx2"];

/// Endings of scene files, as a list for people.
pub(crate) fn endings() -> String {
    let all: Vec<String> = ENDINGS.iter().map(|ending| format!(".{ending}")).collect();
    all.join(", ")
}

fn sorted(files: impl IntoIterator<Item = PathBuf>) -> Sorted {
    let mut found = Sorted::default();
    for file in files {
        match ending(&file).as_str() {
            known if ENDINGS.contains(&known) => found.scenes.push(file),
            "toml" => found.settings.push(file),
            _ => found.others.push(file),
        }
    }
    if !found.scenes.is_empty() {
        (found.others).retain(|file| !PARTS.contains(&ending(file).as_str()));
    }
    found
}

fn ending(file: &Path) -> String {
    let ending = file.extension().and_then(|e| e.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

impl App {
    /// Takes the files that were dropped since the last pass.
    pub(super) fn take_drops(&mut self, context: &egui::Context) {
        let dropped = context.input(|i| i.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_owned()).collect();
        self.take_files(context, paths);
    }

    fn take_files(&mut self, context: &egui::Context, files: impl IntoIterator<Item = PathBuf>) {
        let Sorted {
            scenes,
            settings,
            others,
        } = sorted(files);
        let name = |path: &Path| path.display().to_string();
        if let Some(file) = settings.last() {
            self.load_settings(context, name(file));
        }
        for other in others {
            if self.host.files.is_folder(&other) {
                self.browser = Some(Browser::new(self.host.files.as_ref(), other));
            } else {
                self.complain(format!(
                    "'{}' is neither a scene ({}) nor settings (.toml)",
                    name(&other),
                    endings()
                ));
            }
        }
        let mut scenes = scenes.into_iter();
        let Some(first) = scenes.next() else { return };
        let further: Vec<String> = scenes.map(|path| name(&path)).collect();
        if !further.is_empty() {
            let host = std::sync::Arc::clone(&self.host);
            self.remember(|memory| {
                for scene in further.iter().rev() {
                    memory.opened(&host.files.full_name(scene));
                }
            });
            let others = match further.len() {
                1 => "the other one is".to_owned(),
                n => format!("the {n} others are"),
            };
            self.say(
                context,
                format!("Opening the first scene; {others} among the recent ones"),
            );
        }
        self.open_scene(name(&first));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::app;
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn files_are_told_apart_by_their_endings() {
        let found = sorted(paths(&[
            "a.GLB", "b.gltf", "c.toml", "d.txt", "e.obj", "folder",
        ]));
        assert_eq!(found.scenes, paths(&["a.GLB", "b.gltf", "e.obj"]));
        assert_eq!(found.settings, paths(&["c.toml"]));
        assert_eq!(found.others, paths(&["d.txt", "folder"]));
        // What a scene names is looked for beside it.
        let found = sorted(paths(&["b.gltf", "b.bin", "wood.PNG"]));
        assert_eq!(found.others, paths(&[]));
        assert_eq!(sorted(paths(&["wood.png"])).others, paths(&["wood.png"]));
    }

    #[test]
    fn of_several_scenes_the_first_opens_and_the_others_are_recent() {
        let mut app = app();
        let context = egui::Context::default();
        app.take_files(
            &context,
            paths(&["/a.glb", "/b.glb", "/notes.txt", "/c.gltf"]),
        );
        assert_eq!(app.scene_name, "/a.glb");
        assert_eq!(app.memory.recent, ["/b.glb", "/c.gltf"]);
        let said: Vec<_> = app.messages.iter().map(|m| m.text.as_str()).collect();
        assert!(
            said.iter().any(|text| text.contains("notes.txt")),
            "{said:?}"
        );
        assert!(
            said.iter().any(|text| text.contains("2 others")),
            "{said:?}"
        );
    }

    #[test]
    fn a_dropped_folder_is_listed_and_settings_are_read() {
        let mut app = app();
        let host = std::sync::Arc::get_mut(&mut app.host).unwrap();
        host.read_settings = |path| {
            let is_sized = path.ends_with("sized.toml");
            Ok((foveal::Settings::default(), is_sized))
        };
        let context = egui::Context::default();
        app.take_files(&context, paths(&["/sized.toml"]));
        assert!(!app.display.fit);
        app.display.fit = true;
        app.take_files(&context, paths(&["/home/eva", "/quick.toml"]));
        assert!(app.display.fit);
        let folder = app
            .browser
            .as_ref()
            .map(|browser| browser.folder().to_owned());
        assert_eq!(folder, Some("/home/eva".into()));
        assert_eq!(app.settings_file, "/quick.toml");
    }

    #[test]
    fn settings_are_not_saved_to_a_dropped_file_that_has_none() {
        let mut app = app();
        app.take_files(&egui::Context::default(), paths(&["/Cargo.toml"]));
        assert_eq!(app.settings_file, "foveal.toml");
        assert!(app.messages[0].is_error);
    }
}
