//! The words of a command as a shell and the program take them.

use foveal_scene::{Camera, Projection};

/// A camera to the last bit, as `foveal render --exact-camera` takes it: shortest decimals that are
/// the same numbers again.
#[must_use]
pub fn exact_camera(camera: &Camera) -> String {
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
    // In front of a word # begins a comment, and zsh takes = for a command's path.
    if !word.is_empty() && !word.starts_with(['#', '=']) && word.chars().all(plain) {
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
        assert_eq!(quoted("#2=a.glb"), "'#2=a.glb'");
        assert_eq!(quoted("=a.glb"), "'=a.glb'");
        assert_eq!(quoted("a#2=b.glb"), "a#2=b.glb");
    }
}
