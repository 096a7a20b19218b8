//! Folders for the window's open dialog, and the file in which it remembers.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::Context;
use foveal_generate as generate;
use foveal_host::atomic_file;
use foveal_view::{Files, Listing};

/// The real folders.
pub(super) struct Folders {
    /// Where the window's memory is; `None` where the system names no place for settings.
    memory: Option<PathBuf>,
}

impl Folders {
    pub(super) fn new() -> Self {
        let folder = settings_folder(std::env::consts::OS, |name| std::env::var_os(name));
        Self {
            memory: folder.map(|folder| folder.join("foveal").join("window.toml")),
        }
    }
}

/// The user's folder for programs' settings on this system.
fn settings_folder(system: &str, variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let folder = |name| {
        variable(name)
            .map(PathBuf::from)
            .filter(|p| p.is_absolute())
    };
    match system {
        "windows" => folder("APPDATA"),
        "macos" => Some(folder("HOME")?.join("Library/Application Support")),
        _ => folder("XDG_CONFIG_HOME").or_else(|| Some(folder("HOME")?.join(".config"))),
    }
}

impl Files for Folders {
    fn start(&self) -> PathBuf {
        std::env::current_dir().unwrap_or_else(|_| PathBuf::from("/"))
    }

    fn list(&self, folder: &Path) -> anyhow::Result<Listing> {
        let cannot = || format!("cannot list '{}'", folder.display());
        let mut listing = Listing::default();
        for entry in fs::read_dir(folder).with_context(cannot)? {
            let entry = entry.with_context(cannot)?;
            // Names that are no text could not be typed or remembered either.
            let Ok(name) = entry.file_name().into_string() else {
                continue;
            };
            // A link counts as what it leads to.
            let Ok(found) = fs::metadata(entry.path()) else {
                continue;
            };
            if found.is_dir() {
                listing.folders.push(name);
            } else if is_scene(&name) {
                listing.scenes.push(name);
            }
        }
        for names in [&mut listing.folders, &mut listing.scenes] {
            names.sort_by_key(|name| (name.to_lowercase(), name.clone()));
        }
        Ok(listing)
    }

    fn is_folder(&self, path: &Path) -> bool {
        path.is_dir()
    }

    fn is_there(&self, scene: &str) -> bool {
        is_generated(scene) || Path::new(scene).is_file()
    }

    fn full_name(&self, scene: &str) -> String {
        if is_generated(scene) {
            return scene.to_owned();
        }
        let path = fs::canonicalize(scene).or_else(|_| std::path::absolute(scene));
        path.map_or_else(|_| scene.to_owned(), |path| path.display().to_string())
    }

    fn memory(&self) -> String {
        let file = self.memory.as_ref();
        file.map_or_else(String::new, |file| file.display().to_string())
    }

    fn recall(&self) -> anyhow::Result<String> {
        let Some(file) = &self.memory else {
            return Ok(String::new());
        };
        match fs::read_to_string(file) {
            Ok(text) => Ok(text),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
            Err(error) => Err(error).with_context(|| format!("cannot read '{}'", file.display())),
        }
    }

    fn remember(&self, text: &str) -> anyhow::Result<()> {
        let Some(file) = &self.memory else {
            return Ok(());
        };
        if let Some(folder) = file.parent() {
            fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder '{}'", folder.display()))?;
        }
        atomic_file::write(file, text.as_bytes())
    }
}

fn is_scene(name: &str) -> bool {
    let ending = Path::new(name)
        .extension()
        .and_then(|ending| ending.to_str());
    let is_read = |ending: &str| {
        let mut known = foveal_scene::ENDINGS.iter();
        known.any(|known| ending.eq_ignore_ascii_case(known))
    };
    ending.is_some_and(is_read)
}

/// Whether it is a generated scene's name, as `demo:500`, so that it wins over a file.
fn is_generated(scene: &str) -> bool {
    let name = scene.split_once(':').map_or(scene, |(name, _)| name);
    generate::NAMES.contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_system_has_its_place_for_settings() {
        let of = |system, variables: &[(&str, &str)]| {
            settings_folder(system, |name| {
                let found = variables.iter().find(|(other, _)| *other == name);
                found.map(|(_, value)| OsString::from(value))
            })
        };
        let home = ("HOME", "/home/eva");
        assert_eq!(of("linux", &[home]), Some("/home/eva/.config".into()));
        let xdg = ("XDG_CONFIG_HOME", "/etc/eva");
        assert_eq!(of("linux", &[home, xdg]), Some("/etc/eva".into()));
        // The standard has relative ones ignored.
        let relative = ("XDG_CONFIG_HOME", "eva");
        assert_eq!(
            of("linux", &[home, relative]),
            Some("/home/eva/.config".into())
        );
        let mac = of("macos", &[home]).unwrap();
        assert!(mac.ends_with("Library/Application Support"));
        assert_eq!(of("linux", &[]), None);
    }

    #[test]
    fn a_folder_lists_its_folders_and_scenes_by_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.GLB", "A.gltf", "c.png", "c.bin", "d.Obj", "e.ply"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        fs::create_dir(folder.path().join("z.glb")).unwrap();
        let folders = Folders { memory: None };
        let listing = folders.list(folder.path()).unwrap();
        assert_eq!(listing.folders, ["z.glb"]);
        assert_eq!(listing.scenes, ["A.gltf", "b.GLB", "d.Obj", "e.ply"]);
        let missing = folder.path().join("missing");
        let error = folders.list(&missing).unwrap_err().to_string();
        assert!(error.contains("missing"), "{error}");
    }

    #[test]
    fn what_is_remembered_is_recalled_from_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new/window.toml");
        let folders = Folders { memory: Some(file) };
        assert_eq!(folders.recall().unwrap(), "");
        folders.remember("recent = []").unwrap();
        assert_eq!(folders.recall().unwrap(), "recent = []");
    }

    #[test]
    fn names_of_generated_scenes_stay_and_paths_become_absolute() {
        let folders = Folders { memory: None };
        for name in ["demo", "demo:500", "cornell"] {
            assert_eq!(folders.full_name(name), name);
            assert!(folders.is_there(name));
        }
        assert!(Path::new(&folders.full_name("a.glb")).is_absolute());
        assert!(!folders.is_there("no such.glb"));
    }
}
