//! The open dialog's state: a folder, what of it is listed, and which line is chosen.

use std::path::{Component, Path, PathBuf};

use crate::{Files, Listing};

/// A line of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    Folder(String),
    Scene(String),
}

impl Entry {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Folder(name) | Self::Scene(name) => name,
        }
    }
}

/// What becomes of a choice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    /// The dialog goes on.
    Stays,
    /// This scene is opened.
    Opens(String),
}

#[derive(Clone, Debug)]
pub(crate) struct Browser {
    folder: PathBuf,
    listing: Listing,
    /// Why the folder cannot be read, or what was typed is neither.
    pub(crate) fault: Option<String>,
    /// Part of a name, or a path.
    pub(crate) typed: String,
    /// The chosen line of those that are listed.
    pub(crate) chosen: usize,
}

impl Browser {
    pub(crate) fn new(files: &dyn Files, folder: PathBuf) -> Self {
        let mut this = Self {
            folder: PathBuf::new(),
            listing: Listing::default(),
            fault: None,
            typed: String::new(),
            chosen: 0,
        };
        this.enter(files, folder);
        this
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Lists another folder; this one stays, with the reason, where that one cannot be read.
    pub(crate) fn enter(&mut self, files: &dyn Files, folder: PathBuf) {
        match files.list(&folder) {
            Ok(listing) => {
                self.listing = listing;
                self.folder = folder;
                self.fault = None;
                self.typed.clear();
                self.chosen = 0;
            }
            Err(error) => self.fault = Some(format!("{error:#}")),
        }
    }

    pub(crate) fn enter_parent(&mut self, files: &dyn Files) {
        let Some(parent) = self.folder.parent().map(Path::to_owned) else {
            return;
        };
        let left = self
            .folder
            .file_name()
            .map(|n| n.to_string_lossy().into_owned());
        self.enter(files, parent);
        let is_left = |entry: &Entry| Some(entry.name()) == left.as_deref();
        self.chosen = self.entries().iter().position(is_left).unwrap_or(0);
    }

    /// Folders, then scenes, whose names contain what is typed; hidden ones only where it begins
    /// with a dot.
    pub(crate) fn entries(&self) -> Vec<Entry> {
        let wanted = self.typed.to_lowercase();
        let is_listed = |name: &&String| {
            (!name.starts_with('.') || wanted.starts_with('.'))
                && name.to_lowercase().contains(&wanted)
        };
        let folders = self.listing.folders.iter().filter(is_listed);
        let scenes = self.listing.scenes.iter().filter(is_listed);
        folders
            .map(|name| Entry::Folder(name.clone()))
            .chain(scenes.map(|name| Entry::Scene(name.clone())))
            .collect()
    }

    /// Moves the choice by some lines.
    pub(crate) fn step(&mut self, by: isize) {
        let last = self.entries().len().saturating_sub(1);
        self.chosen = self.chosen.min(last).saturating_add_signed(by).min(last);
    }

    /// Enters the folder or opens the scene of a line.
    pub(crate) fn choose(&mut self, files: &dyn Files, entry: &Entry) -> Choice {
        match entry {
            Entry::Folder(name) => {
                self.enter(files, self.folder.join(name));
                Choice::Stays
            }
            Entry::Scene(name) => Choice::Opens(self.folder.join(name).display().to_string()),
        }
    }

    /// What Enter does: follows a path that was typed, else the chosen line. A line below the first
    /// was chosen by hand; a dot alone lists what is hidden.
    pub(crate) fn accept(&mut self, files: &dyn Files) -> Choice {
        let typed = self.typed.trim();
        if self.chosen == 0 && !["", "."].contains(&typed) {
            let path = self.folder.join(typed);
            if files.is_folder(&path) {
                // Of `a/..` the folder above would be `a`.
                let leads_up = path.components().any(|part| part == Component::ParentDir);
                let path = if leads_up {
                    files.full_name(&path.display().to_string()).into()
                } else {
                    path
                };
                self.enter(files, path);
                return Choice::Stays;
            }
            let path = path.display().to_string();
            if files.is_there(&path) {
                return Choice::Opens(path);
            }
        }
        match self.entries().get(self.chosen) {
            Some(entry) => self.choose(files, &entry.clone()),
            None => {
                self.fault = Some(format!("There is nothing called '{typed}' here"));
                Choice::Stays
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use anyhow::bail;
    use std::sync::Mutex;

    /// Folders that are not on any disk, and a memory.
    #[derive(Default)]
    pub(crate) struct Imagined {
        pub(crate) memory: Mutex<String>,
    }

    /// `a/.` and `a/b/..` are `a`.
    fn resolved(path: &Path) -> PathBuf {
        let mut found = PathBuf::new();
        for part in path.components() {
            if part == Component::ParentDir {
                found.pop();
            } else {
                found.push(part);
            }
        }
        found
    }

    impl Files for Imagined {
        fn start(&self) -> PathBuf {
            "/home/eva".into()
        }

        fn list(&self, folder: &Path) -> anyhow::Result<Listing> {
            let names = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
            Ok(match resolved(folder).to_str() {
                Some("/home/eva") => Listing {
                    folders: names(&[".cache", "models", "pictures"]),
                    scenes: names(&["Castle.glb", "room.gltf"]),
                },
                Some("/home") => Listing {
                    folders: names(&["adam", "eva", "evan"]),
                    scenes: Vec::new(),
                },
                Some("/home/eva/models") => Listing::default(),
                _ => bail!("'{}' cannot be read", folder.display()),
            })
        }

        fn is_folder(&self, path: &Path) -> bool {
            self.list(path).is_ok()
        }

        fn is_there(&self, scene: &str) -> bool {
            ["/home/eva/Castle.glb", "/home/eva/room.gltf", "cornell"].contains(&scene)
        }

        fn full_name(&self, scene: &str) -> String {
            resolved(Path::new(scene)).display().to_string()
        }

        fn memory(&self) -> String {
            "/home/eva/window.toml".to_owned()
        }

        fn recall(&self) -> anyhow::Result<String> {
            Ok(self.memory.lock().unwrap().clone())
        }

        fn remember(&self, text: &str) -> anyhow::Result<()> {
            text.clone_into(&mut self.memory.lock().unwrap());
            Ok(())
        }
    }

    fn browser() -> (Imagined, Browser) {
        let files = Imagined::default();
        let browser = Browser::new(&files, files.start());
        (files, browser)
    }

    fn names(browser: &Browser) -> Vec<String> {
        let entries = browser.entries();
        entries.iter().map(|e| e.name().to_owned()).collect()
    }

    #[test]
    fn what_is_typed_narrows_the_list_and_enter_opens() {
        let (files, mut browser) = browser();
        assert_eq!(
            names(&browser),
            ["models", "pictures", "Castle.glb", "room.gltf"]
        );
        browser.typed = "cas".to_owned();
        assert_eq!(names(&browser), ["Castle.glb"]);
        let opens = Choice::Opens("/home/eva/Castle.glb".to_owned());
        assert_eq!(browser.accept(&files), opens);
        browser.typed = ".".to_owned();
        assert!(names(&browser).contains(&".cache".to_owned()));
    }

    #[test]
    fn arrows_choose_within_the_list() {
        let (files, mut browser) = browser();
        browser.step(-1);
        assert_eq!(browser.chosen, 0);
        browser.step(3);
        browser.step(9);
        assert_eq!(browser.chosen, 3);
        let opens = Choice::Opens("/home/eva/room.gltf".to_owned());
        assert_eq!(browser.accept(&files), opens);
    }

    #[test]
    fn folders_are_entered_and_left() {
        let (files, mut browser) = browser();
        assert_eq!(browser.accept(&files), Choice::Stays);
        assert_eq!(browser.folder(), Path::new("/home/eva/models"));
        assert!(browser.entries().is_empty());
        browser.enter_parent(&files);
        browser.enter_parent(&files);
        assert_eq!(browser.folder(), Path::new("/home"));
        assert_eq!(names(&browser)[browser.chosen], "eva");
        // Up there is nothing that can be read: it stays, and says why.
        browser.enter_parent(&files);
        assert_eq!(browser.folder(), Path::new("/home"));
        assert!(browser.fault.is_some());
    }

    #[test]
    fn the_folder_above_one_that_dots_led_to_is_above_it() {
        let (files, mut browser) = browser();
        browser.typed = "models/../..".to_owned();
        assert_eq!(browser.accept(&files), Choice::Stays);
        assert_eq!(browser.folder(), Path::new("/home"));
        browser.enter_parent(&files);
        // It cannot be read: had it been /home/eva/models, it could.
        assert_eq!(browser.folder(), Path::new("/home"));
        assert!(browser.fault.is_some());
    }

    #[test]
    fn a_line_that_was_chosen_comes_before_what_was_typed() {
        let (files, mut browser) = browser();
        let tried = |browser: &mut Browser| {
            assert_eq!(browser.accept(&files), Choice::Stays);
            browser.fault.take().unwrap_or_default()
        };
        browser.typed = ".".to_owned();
        assert!(tried(&mut browser).contains(".cache"));
        browser.enter(&files, "/home".into());
        browser.typed = "eva".to_owned();
        browser.step(1);
        assert!(tried(&mut browser).contains("evan"));
        browser.step(-1);
        assert_eq!(tried(&mut browser), "");
        assert_eq!(browser.folder(), Path::new("/home/eva"));
    }

    #[test]
    fn a_path_can_be_typed() {
        let (files, mut browser) = browser();
        browser.typed = "/home".to_owned();
        assert_eq!(browser.accept(&files), Choice::Stays);
        assert_eq!(browser.folder(), Path::new("/home"));
        browser.typed = "/home/eva/room.gltf".to_owned();
        let opens = Choice::Opens("/home/eva/room.gltf".to_owned());
        assert_eq!(browser.accept(&files), opens);
        browser.typed = "/nowhere/a.glb".to_owned();
        assert_eq!(browser.accept(&files), Choice::Stays);
        assert!(
            browser
                .fault
                .as_deref()
                .is_some_and(|f| f.contains("a.glb"))
        );
    }
}
