//! What the window remembers from run to run: the scenes opened last, and each scene's bookmarks.
//!
//! The host keeps it as a text, TOML. It is read again before each change, so that two windows
//! forget little of each other.

use std::collections::BTreeMap;

use anyhow::Context;
use toml::{Table, Value};

use crate::Files;

/// How many scenes are remembered as opened.
const MOST_RECENT: usize = 12;

/// Bookmarks of a scene: cameras as texts, by their numbers from 1 to 9.
type Bookmarks = BTreeMap<u8, String>;

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Memory {
    /// Full names of scenes, the newest first.
    pub(crate) recent: Vec<String>,
    /// By the scene's full name.
    bookmarks: BTreeMap<String, Bookmarks>,
}

impl Memory {
    /// What the host kept.
    pub(crate) fn recalled(files: &dyn Files) -> anyhow::Result<Self> {
        let text = files.recall()?;
        let cannot = || format!("what the window remembers in '{}' is wrong", files.memory());
        Self::read(&text).with_context(cannot)
    }

    /// Changes what is remembered and has the host keep it.
    pub(crate) fn change(
        &mut self,
        files: &dyn Files,
        change: impl FnOnce(&mut Self),
    ) -> anyhow::Result<()> {
        *self = Self::recalled(files)?;
        let before = self.clone();
        change(self);
        if *self == before {
            return Ok(());
        }
        files.remember(&self.written())
    }

    /// Puts a scene before the others.
    pub(crate) fn opened(&mut self, scene: &str) {
        self.recent.retain(|other| other != scene);
        self.recent.insert(0, scene.to_owned());
        self.recent.truncate(MOST_RECENT);
    }

    /// A scene's bookmarks with their numbers.
    pub(crate) fn bookmarks(&self, scene: &str) -> impl Iterator<Item = (u8, &str)> {
        let of_scene = self.bookmarks.get(scene).into_iter().flatten();
        of_scene.map(|(number, camera)| (*number, camera.as_str()))
    }

    /// Sets or, with `None`, removes a bookmark.
    pub(crate) fn set_bookmark(&mut self, scene: &str, number: u8, camera: Option<String>) {
        let of_scene = self.bookmarks.entry(scene.to_owned()).or_default();
        match camera {
            Some(camera) => of_scene.insert(number, camera),
            None => of_scene.remove(&number),
        };
        if of_scene.is_empty() {
            self.bookmarks.remove(scene);
        }
    }

    fn read(text: &str) -> Result<Self, toml::de::Error> {
        let table: Table = text.parse()?;
        let recent = table.get("recent").and_then(Value::as_array);
        let recent = recent.into_iter().flatten().filter_map(Value::as_str);
        let scenes = table.get("bookmarks").and_then(Value::as_table);
        let bookmarks = scenes.into_iter().flatten().map(|(scene, cameras)| {
            let cameras = cameras.as_table().into_iter().flatten();
            let cameras = cameras.filter_map(|(number, camera)| {
                let number = number.parse().ok().filter(|n| (1..=9).contains(n))?;
                Some((number, camera.as_str()?.to_owned()))
            });
            (scene.clone(), cameras.collect())
        });
        Ok(Self {
            recent: recent.map(str::to_owned).collect(),
            bookmarks: bookmarks.collect(),
        })
    }

    fn written(&self) -> String {
        let scenes = self.bookmarks.iter().map(|(scene, cameras)| {
            let cameras = cameras.iter();
            let cameras: Table = cameras
                .map(|(number, camera)| (number.to_string(), Value::from(camera.as_str())))
                .collect();
            (scene.clone(), Value::Table(cameras))
        });
        let mut table = Table::new();
        table.insert("recent".to_owned(), self.recent.clone().into());
        table.insert("bookmarks".to_owned(), Value::Table(scenes.collect()));
        table.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let mut memory = Memory::default();
        assert_eq!(Memory::read(&memory.written()).unwrap(), memory);
        memory.opened("/home/a \"b\"/x.y.glb");
        memory.opened("cornell");
        memory.set_bookmark("/home/a \"b\"/x.y.glb", 3, Some("perspective,1".to_owned()));
        memory.set_bookmark("cornell", 9, Some("perspective,2".to_owned()));
        assert_eq!(Memory::read(&memory.written()).unwrap(), memory);
        let of_cornell: Vec<_> = memory.bookmarks("cornell").collect();
        assert_eq!(of_cornell, [(9, "perspective,2")]);
        memory.set_bookmark("cornell", 9, None);
        assert_eq!(memory.bookmarks("cornell").count(), 0);
    }

    #[test]
    fn what_cannot_be_read_is_named_and_stays() {
        let files = crate::browser::tests::Imagined::default();
        files.remember("recent = [").unwrap();
        let changed = Memory::default().change(&files, |memory| memory.opened("cornell"));
        let error = format!("{:#}", changed.unwrap_err());
        assert!(
            error.contains("'/home/eva/window.toml'") && error.contains("line 1"),
            "{error}"
        );
        assert_eq!(files.recall().unwrap(), "recent = [");
    }

    #[test]
    fn the_scene_opened_last_is_first_and_old_ones_are_forgotten() {
        let mut memory = Memory::default();
        for i in 0..20 {
            memory.opened(&format!("{i}.glb"));
        }
        memory.opened("15.glb");
        assert_eq!(memory.recent.len(), MOST_RECENT);
        assert_eq!(memory.recent[..3], ["15.glb", "19.glb", "18.glb"]);
    }

    #[test]
    fn a_text_of_another_kind_is_an_error_and_unknown_entries_are_not() {
        assert!(Memory::read("recent = [").is_err());
        let text = "recent = [1, \"a\"]\nother = 3\n[bookmarks.\"a\"]\n0 = \"x\"\n4 = \"y\"";
        let memory = Memory::read(text).unwrap();
        assert_eq!(memory.recent, ["a"]);
        assert_eq!(memory.bookmarks("a").collect::<Vec<_>>(), [(4, "y")]);
    }
}
