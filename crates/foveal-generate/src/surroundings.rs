//! An environment for tests of environment light.

use glam::{Vec2, Vec3};

use crate::trig::sin_cos_turns;

/// An equirectangular picture of `width` x `width / 2` texels, as linear radiance row by row: a
/// court with a paved floor, a red wall towards -x, a blue one with a bright window towards +x, and
/// above them a sky with a small sun of a radiance of 5,000. The centre of the picture is +x, the
/// right half +z.
#[must_use]
pub fn surroundings(width: u32) -> (u32, u32, Vec<[f32; 3]>) {
    let height = width / 2;
    let texel = |x: u32, y: u32| {
        let (sin, cos) = sin_cos_turns((x as f32 + 0.5) / width as f32 - 0.5);
        let (across, up) = sin_cos_turns((y as f32 + 0.5) / height as f32 * 0.5);
        let d = Vec3::new(across * cos, up, across * sin);
        radiance(d).to_array()
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| texel(x, y)));
    (width, height, texels.collect())
}

/// Radiance that comes from a direction.
fn radiance(d: Vec3) -> Vec3 {
    // Walls 6 m away and 4 m high, the eye 1.6 m above the floor.
    let a = d.abs();
    let wall = 6.0 / a.x.max(a.z);
    let height = d.y * wall;
    if height < -1.6 {
        let floor = Vec2::new(d.x, d.z) * (-1.6 / d.y);
        let slab = (floor.x.floor() + floor.y.floor()).rem_euclid(2.0);
        return Vec3::new(0.24, 0.22, 0.19) * (0.6 + 0.4 * slab);
    }
    if height > 2.4 {
        return sky(d);
    }
    let along = if a.x >= a.z { d.z } else { d.x } * wall;
    match (a.x >= a.z, d.x > 0.0, d.z > 0.0) {
        (true, true, _) if along.abs() < 1.0 && height > 0.0 && height < 1.8 => {
            Vec3::new(14.0, 11.0, 7.0)
        }
        (true, true, _) => Vec3::new(0.08, 0.14, 0.42),
        (true, false, _) => Vec3::new(0.55, 0.07, 0.04),
        (false, _, true) => Vec3::new(0.42, 0.38, 0.30),
        // An arcade.
        _ if height < 1.0 && (along / 1.5).rem_euclid(1.0) < 0.6 => Vec3::splat(0.02),
        _ => Vec3::new(0.30, 0.34, 0.24),
    }
}

fn sky(d: Vec3) -> Vec3 {
    let sun = Vec3::new(-0.35, 0.75, -0.45).normalize();
    let cosine = d.dot(sun);
    // Three degrees across.
    if cosine > 0.999_66 {
        return Vec3::new(5000.0, 4400.0, 3600.0);
    }
    let glow = cosine.max(0.0).powi(32);
    let blue = Vec3::new(0.75, 0.82, 0.90).lerp(Vec3::new(0.16, 0.32, 0.72), d.y);
    blue + glow * Vec3::new(1.2, 1.0, 0.7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surroundings_have_a_sun_and_a_floor() {
        let (width, height, rgb) = surroundings(256);
        assert_eq!(rgb.len(), (width * height) as usize);
        let suns = rgb.iter().filter(|t| t[0] > 1000.0).count();
        assert!((4..40).contains(&suns), "{suns}");
        assert!(rgb[(width * height) as usize - 1][0] < 0.3);
        assert!(rgb.iter().flatten().all(|v| v.is_finite() && *v > 0.0));
    }
}
