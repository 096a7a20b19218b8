//! Light from all around as a scene file brings it: a cube of pictures and its irradiance.

use std::sync::Arc;

use glam::{Quat, Vec3};

/// An environment of a scene file (glTF's `EXT_lights_image_based`).
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLight {
    /// Its name in the file; may be empty.
    pub name: String,
    /// Turns the environment: a direction of the cube, to the world's.
    pub rotation: Quat,
    /// Factor of radiance and irradiance.
    pub intensity: f32,
    /// Texels a side of the cube, a power of two.
    pub side: u32,
    /// Radiance, linear RGB, without the intensity: sides +x, -x, +y, -y, +z, -z, each row by row
    /// from the top. With s and t from -1 to 1, to the right and down, a texel shows the direction
    /// (1, -t, -s), (-1, -t, s), (s, 1, t), (s, -1, -t), (s, -t, 1), (-s, -t, -1) of its side, as in
    /// cube maps of graphics APIs. Copies share them.
    pub radiance: Arc<[[f32; 3]]>,
    /// Irradiance, without intensity and rotation, as coefficients of the real spherical harmonics
    /// 0,0; 1,-1 (y); 1,0 (z); 1,1 (x); 2,-2 (xy); 2,-1 (yz); 2,0; 2,1 (xz); 2,2, all of positive sign
    /// (Ramamoorthi and Hanrahan 2001, equation 3).
    pub irradiance: [[f32; 3]; 9],
}

impl ImageLight {
    /// Takes means of 2 x 2 texels until a side has at most so many: filtering takes time and memory.
    /// One that has not the texels of six sides stays as it is; renderers refuse it.
    pub fn halve_to(&mut self, most: u32) {
        let texels = self.radiance.len();
        let of_side = u64::from(self.side) * u64::from(self.side);
        if !texels.is_multiple_of(6) || texels as u64 / 6 != of_side {
            return;
        }
        while self.side > most.max(1) {
            let side = self.side as usize;
            let sides = self.radiance.chunks(side * side);
            self.radiance = sides.flat_map(|texels| halved(texels, side)).collect();
            self.side /= 2;
        }
    }
}

/// Means of 2 x 2 texels of a square.
pub(crate) fn halved(texels: &[[f32; 3]], side: usize) -> Vec<[f32; 3]> {
    let half = side / 2;
    let mean = |i: usize| {
        let first = i / half * 2 * side + i % half * 2;
        let four = [first, first + 1, first + side, first + side + 1];
        std::array::from_fn(|c| four.iter().map(|&at| texels[at][c]).sum::<f32>() * 0.25)
    };
    (0..half * half).map(mean).collect()
}

/// The harmonics of [`ImageLight::irradiance`] in a unit direction.
#[must_use]
pub fn harmonics(d: Vec3) -> [f32; 9] {
    let Vec3 { x, y, z } = d;
    [
        0.282_095,
        0.488_603 * y,
        0.488_603 * z,
        0.488_603 * x,
        1.092_548 * x * y,
        1.092_548 * y * z,
        0.315_392 * (3.0 * z * z - 1.0),
        1.092_548 * x * z,
        0.546_274 * (x * x - y * y),
    ]
}

/// Of each harmonic: what the cosine makes of radiance (the same, equation 8).
pub(crate) const COSINE: [f32; 9] = {
    use std::f32::consts::{FRAC_PI_4, PI};
    let (a, b) = (2.0 * PI / 3.0, FRAC_PI_4);
    [PI, a, a, a, b, b, b, b, b]
};

/// The direction of a texel's centre, not of unit length.
pub(crate) fn direction_of(face: usize, s: f32, t: f32) -> Vec3 {
    match face {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    }
}

/// Irradiance of a cube of radiance.
pub(crate) fn irradiance_of(side: usize, radiance: &[[f32; 3]]) -> [[f32; 3]; 9] {
    let mut sums = [[0f64; 3]; 9];
    let mut sphere = 0f64;
    for (i, texel) in radiance.iter().enumerate() {
        let (face, x, y) = (i / (side * side), i % side, i / side % side);
        let place = |x: usize| (x as f32 + 0.5) * 2.0 / side as f32 - 1.0;
        let d = direction_of(face, place(x), place(y));
        let weight = d.length_squared().powf(-1.5);
        sphere += f64::from(weight);
        for (sum, harmonic) in sums.iter_mut().zip(harmonics(d.normalize())) {
            for (sum, value) in sum.iter_mut().zip(texel) {
                *sum += f64::from(value * harmonic * weight);
            }
        }
    }
    let scale = 4.0 * std::f64::consts::PI / sphere;
    std::array::from_fn(|k| sums[k].map(|v| (v * scale) as f32 * COSINE[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cosine takes pi of what is alike everywhere, 2 pi / 3 of what grows along an axis, and
    /// pi / 4 of what is quadratic (Ramamoorthi and Hanrahan 2001).
    #[test]
    fn irradiance_of_each_harmonic_is_its_part_of_the_radiance() {
        use std::f32::consts::{FRAC_PI_4, PI};
        type Radiance = fn(Vec3) -> f32;
        let cases: [(f32, Radiance); 9] = [
            (PI, |_| 1.0),
            (PI / 1.5, |d| d.x),
            (PI / 1.5, |d| d.y),
            (PI / 1.5, |d| d.z),
            (FRAC_PI_4, |d| d.x * d.y),
            (FRAC_PI_4, |d| d.y * d.z),
            (FRAC_PI_4, |d| d.x * d.z),
            (FRAC_PI_4, |d| d.x * d.x - d.y * d.y),
            (FRAC_PI_4, |d| 3.0 * d.z * d.z - 1.0),
        ];
        let side = 32;
        let center = |i: usize| (i as f32 + 0.5) * 2.0 / side as f32 - 1.0;
        let directions: Vec<Vec3> = (0..6 * side * side)
            .map(|i| direction_of(i / (side * side), center(i % side), center(i / side % side)))
            .map(Vec3::normalize)
            .collect();
        for (number, (part, radiance)) in cases.into_iter().enumerate() {
            let texels: Vec<_> = directions.iter().map(|&d| [radiance(d); 3]).collect();
            let coefficients = irradiance_of(side, &texels);
            for &d in directions.iter().step_by(97) {
                let terms = coefficients.iter().zip(harmonics(d));
                let found: f32 = terms.map(|(c, harmonic)| c[1] * harmonic).sum();
                let expected = part * radiance(d);
                assert!(
                    (found - expected).abs() < 0.02,
                    "{number}, {d}: {found} not {expected}"
                );
            }
        }
    }

    #[test]
    fn sides_are_halved_to_means_of_four_texels() {
        let mut light = ImageLight {
            name: String::new(),
            rotation: Quat::IDENTITY,
            intensity: 1.0,
            side: 4,
            radiance: (0..96u8).map(|i| [f32::from(i), 0.0, 1.0]).collect(),
            irradiance: [[0.0; 3]; 9],
        };
        light.halve_to(2);
        assert_eq!(light.side, 2);
        // Of rows of four texels: the first, 16 numbers a side.
        let means =
            (0..6u8).flat_map(|face| [2.5, 4.5, 10.5, 12.5].map(|m| m + 16.0 * f32::from(face)));
        let expected: Vec<[f32; 3]> = means.map(|mean| [mean, 0.0, 1.0]).collect();
        assert_eq!(light.radiance[..], expected);
    }

    #[test]
    fn what_lacks_texels_is_not_halved() {
        for (side, texels) in [(4, 95), (4, 97), (4, 0), (4, 6), (u32::MAX, 6)] {
            let mut light = ImageLight {
                name: String::new(),
                rotation: Quat::IDENTITY,
                intensity: 1.0,
                side,
                radiance: vec![[1.0; 3]; texels].into(),
                irradiance: [[0.0; 3]; 9],
            };
            light.halve_to(2);
            assert_eq!((light.side, light.radiance.len()), (side, texels));
        }
    }
}
