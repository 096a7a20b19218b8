//! The command that draws what the window shows, byte by byte.

use foveal::Settings;
use foveal_scene::{Camera, Clip};

use crate::Host;
use crate::worker::{LoadedScene, SETTLING_FRAMES};

/// `foveal render` and its words, not yet quoted.
pub(crate) fn words(
    host: &Host,
    scene: &LoadedScene,
    settings: &Settings,
    camera: &Camera,
    (clip, time_s): (&Clip, f32),
) -> Vec<String> {
    let mut words: Vec<String> = ["foveal", "render", &file_word(&scene.source)]
        .into_iter()
        .chain(["--output", "picture.png"])
        .map(str::to_owned)
        .collect();
    let is_animated = scene.duration_s(clip) > 0.0;
    // A camera of the scene is said by its number, unless animation may have moved it. Even a clip
    // without length has a pose of its own.
    let is_moved = is_animated || *clip != scene.clip;
    let of_scene = scene.cameras.iter().position(|c| c == camera);
    match of_scene.filter(|_| !is_moved) {
        Some(number) => {
            let names = scene.cameras.iter().map(|c| c.name.as_str());
            words.extend(["--camera".to_owned(), number_word(number, names)]);
        }
        None => words.extend(["--exact-camera".to_owned(), (host.exact_camera)(camera)]),
    }
    if *clip != Clip::default() {
        words.extend(["--clip".to_owned(), clip_word(clip, &scene.clips)]);
    }
    if is_animated {
        words.extend(["--time".to_owned(), time_s.to_string()]);
    }
    words.push("--still".to_owned());
    // From its second frame on, which forgets what was before, the window draws a view that stands
    // still as often.
    words.extend(["--warmup".to_owned(), (SETTLING_FRAMES - 2).to_string()]);
    words.extend((host.scene_flags)(&scene.source));
    words.extend((host.flags)(settings));
    words
}

/// A scene's file: a name that begins as a flag does would be taken for one.
fn file_word(source: &str) -> String {
    let folder = if source.starts_with('-') { "./" } else { "" };
    format!("{folder}{source}")
}

/// What `--clip` is given.
fn clip_word(clip: &Clip, clips: &[(String, f32)]) -> String {
    match clip {
        Clip::Number(number) => number_word(
            *number as usize,
            clips.iter().map(|(name, _)| name.as_str()),
        ),
        other => other.to_string(),
    }
}

/// A clip's number, as the flag takes it beside names. A name of the same spelling would be taken
/// first: zeros go in front until no clip has that name.
fn number_word<'n>(number: usize, names: impl Iterator<Item = &'n str> + Clone) -> String {
    let mut word = number.to_string();
    while names.clone().any(|name| name == word) {
        word.insert(0, '0');
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{host, scene};

    /// The command for a camera of the scene, without its last words.
    fn first_words(scene: &LoadedScene, camera: usize, clip: &Clip) -> String {
        let camera = &scene.cameras[camera];
        let words = words(&host(), scene, &Settings::default(), camera, (clip, 0.0));
        words[2..7].join(" ")
    }

    #[test]
    fn a_clips_number_is_written_as_no_clip_is_named() {
        let clips = ["2", "02", "Run"].map(|name| (name.to_owned(), 1.0));
        assert_eq!(clip_word(&Clip::Number(2), &clips), "002");
        assert_eq!(clip_word(&Clip::Number(1), &clips), "1");
        assert_eq!(clip_word(&Clip::All, &clips), "all");
    }

    #[test]
    fn a_cameras_number_is_written_as_no_camera_is_named() {
        let mut scene = scene();
        scene.clips.clear();
        let named = |name: &str| Camera {
            name: name.to_owned(),
            ..scene.cameras[0].clone()
        };
        scene.cameras = ["1", "door", "0"].map(named).to_vec();
        for (camera, word) in [(0, "00"), (1, "01"), (2, "2")] {
            let first = first_words(&scene, camera, &Clip::default());
            assert_eq!(
                first,
                format!("cornell --output picture.png --camera {word}")
            );
        }
    }

    #[test]
    fn a_camera_that_another_clip_may_have_moved_is_said_exactly() {
        let mut scene = scene();
        scene.clips = ["still", "pose"]
            .map(|name| (name.to_owned(), 0.0))
            .to_vec();
        let first = |clip| first_words(&scene, 0, &Clip::Number(clip));
        assert!(first(0).contains("--camera 0"), "{}", first(0));
        assert!(first(1).contains("--exact-camera"), "{}", first(1));
    }

    #[test]
    fn a_files_name_is_not_taken_for_a_flag() {
        let mut scene = scene();
        scene.source = "-x.glb".to_owned();
        let first = first_words(&scene, 0, &Clip::default());
        assert!(first.starts_with("./-x.glb --output"), "{first}");
    }
}
