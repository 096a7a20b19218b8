//! Sine, cosine and rotations whose bits do not depend on the platform's mathematics library.

use std::f64::consts::TAU;

use glam::{Mat4, Vec3, Vec4};

/// Sine and cosine of an angle in turns (1 = full circle).
///
/// Reduced to an eighth of a turn, then Taylor series in f64: only additions and multiplications,
/// which IEEE 754 defines to the last bit; error below one unit in the last place of f32.
pub(crate) fn sin_cos_turns(turns: f32) -> (f32, f32) {
    let turns = f64::from(turns);
    let quarter = (turns * 4.0).round();
    let a = (turns - quarter * 0.25) * TAU;
    let a2 = a * a;
    let sin = a
        * (1.0
            - a2 / 6.0
                * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0 * (1.0 - a2 / 110.0)))));
    let cos = 1.0
        - a2 / 2.0 * (1.0 - a2 / 12.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0 * (1.0 - a2 / 90.0))));
    let (sin, cos) = match (quarter as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    (sin as f32, cos as f32)
}

/// Rotation about y by `turns`, counter-clockwise seen from above: 0.25 takes +z to +x.
pub(crate) fn yaw(turns: f32) -> Mat4 {
    let (s, c) = sin_cos_turns(turns);
    Mat4::from_cols(
        Vec4::new(c, 0.0, -s, 0.0),
        Vec4::Y,
        Vec4::new(s, 0.0, c, 0.0),
        Vec4::W,
    )
}

/// Rotation about x by `turns`: 0.25 takes +y to +z.
pub(crate) fn pitch(turns: f32) -> Mat4 {
    let (s, c) = sin_cos_turns(turns);
    Mat4::from_cols(
        Vec4::X,
        Vec4::new(0.0, c, s, 0.0),
        Vec4::new(0.0, -s, c, 0.0),
        Vec4::W,
    )
}

/// Rotation about z by `turns`: 0.25 takes +x to +y.
pub(crate) fn roll(turns: f32) -> Mat4 {
    let (s, c) = sin_cos_turns(turns);
    Mat4::from_cols(
        Vec4::new(c, s, 0.0, 0.0),
        Vec4::new(-s, c, 0.0, 0.0),
        Vec4::Z,
        Vec4::W,
    )
}

/// Moves to `position`.
pub(crate) fn shift(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

/// Stands upright at `position`, turned by `turns` about y.
pub(crate) fn stand(position: Vec3, turns: f32) -> Mat4 {
    Mat4::from_translation(position) * yaw(turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library_to_a_millionth() {
        for i in -4000..4000 {
            let turns = i as f32 / 1000.0;
            let (s, c) = sin_cos_turns(turns);
            let (ls, lc) = (f64::from(turns) * TAU).sin_cos();
            assert!((f64::from(s) - ls).abs() < 1e-6, "{turns}");
            assert!((f64::from(c) - lc).abs() < 1e-6, "{turns}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos_turns(0.25), (1.0, 0.0));
        assert_eq!(sin_cos_turns(-0.25), (-1.0, 0.0));
        assert_eq!(yaw(0.25).transform_vector3(Vec3::Z), Vec3::X);
        assert_eq!(pitch(0.25).transform_vector3(Vec3::Y), Vec3::Z);
        assert_eq!(roll(0.25).transform_vector3(Vec3::X), Vec3::Y);
    }
}
