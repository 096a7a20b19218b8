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
    let mut words: Vec<String> = ["foveal", "render", &scene.source, "--output", "picture.png"]
        .map(str::to_owned)
        .to_vec();
    let is_animated = scene.duration_s(clip) > 0.0;
    // A camera of the scene is said by its number, unless animation may have moved it.
    let of_scene = scene.cameras.iter().position(|c| c == camera);
    match of_scene.filter(|_| !is_animated) {
        Some(number) => words.extend(["--camera".to_owned(), number.to_string()]),
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

/// What `--clip` is given: a name that looks like the number would come before it, so that the
/// number has zeros in front until none does.
fn clip_word(clip: &Clip, clips: &[(String, f32)]) -> String {
    let mut word = clip.to_string();
    while matches!(clip, Clip::Number(_)) && clips.iter().any(|(name, _)| *name == word) {
        word.insert(0, '0');
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clips_number_is_written_as_no_clip_is_named() {
        let clips = ["2", "02", "Run"].map(|name| (name.to_owned(), 1.0));
        assert_eq!(clip_word(&Clip::Number(2), &clips), "002");
        assert_eq!(clip_word(&Clip::Number(1), &clips), "1");
        assert_eq!(clip_word(&Clip::All, &clips), "all");
    }
}
