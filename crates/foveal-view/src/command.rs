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
        words.extend(["--clip".to_owned(), clip.to_string()]);
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
