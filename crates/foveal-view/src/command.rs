//! The command that draws what the window shows, byte by byte.

use foveal::Settings;
use foveal_scene::{Camera, Projection};

use crate::Host;
use crate::worker::{LoadedScene, SETTLING_FRAMES};

/// `foveal render` and its words, not yet quoted.
pub(crate) fn words(
    host: &Host,
    scene: &LoadedScene,
    settings: &Settings,
    camera: &Camera,
    time_s: f32,
) -> Vec<String> {
    let mut words: Vec<String> = ["foveal", "render", &scene.source, "--output", "picture.png"]
        .map(str::to_owned)
        .to_vec();
    // A camera of the scene is said by its number, unless animation may have moved it.
    let of_scene = scene.cameras.iter().position(|c| c == camera);
    match of_scene.filter(|_| !scene.is_animated) {
        Some(number) => words.extend(["--camera".to_owned(), number.to_string()]),
        None => words.extend(["--exact-camera".to_owned(), exact(camera)]),
    }
    if scene.is_animated {
        words.extend(["--time".to_owned(), time_s.to_string()]);
    }
    words.push("--still".to_owned());
    // From its second frame on, which forgets what was before, the window draws a view that stands still as often.
    words.extend(["--warmup".to_owned(), (SETTLING_FRAMES - 2).to_string()]);
    words.extend(host.scene_flags.iter().cloned());
    words.extend((host.flags)(settings));
    words
}

/// A camera to the last bit, as `foveal render --exact-camera` takes it: shortest decimals that are the same numbers again.
#[must_use]
pub fn exact(camera: &Camera) -> String {
    let (kind, mut numbers) = match camera.projection {
        Projection::Perspective { fov_y_rad, near_m } => ("perspective", vec![fov_y_rad, near_m]),
        Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => ("orthographic", vec![height_m, near_m, far_m]),
    };
    let matrix = camera.world_from_view.to_cols_array_2d();
    numbers.extend(matrix.iter().flat_map(|column| &column[..3]));
    let numbers: Vec<String> = numbers.iter().map(f32::to_string).collect();
    format!("{kind},{}", numbers.join(","))
}

/// A word as a shell takes it.
#[must_use]
pub fn quoted(word: &str) -> String {
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
