//! Irradiance as spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001, 'An Efficient
//! Representation for Irradiance Environment Maps').

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::cube::{Cube, SIDES, direction_of, relative_solid_angle};

/// Irradiance over pi, on a surface with the normal (x, y, z), is the sum of these times
/// 1, y, z, x, xy, yz, 3zz - 1, xz, xx - yy.
pub(crate) type Irradiance = [Vec3; 9];

/// The polynomials of [`Irradiance`].
pub(super) fn polynomials(n: Vec3) -> [f32; 9] {
    let Vec3 { x, y, z } = n;
    [
        1.0,
        y,
        z,
        x,
        x * y,
        y * z,
        3.0 * z * z - 1.0,
        x * z,
        x * x - y * y,
    ]
}

/// Of each polynomial: the square of its spherical harmonic's factor, times what the cosine leaves
/// of its order, over pi.
fn factors() -> [f32; 9] {
    let zeroth = 1.0 / (4.0 * PI);
    let first = 3.0 / (4.0 * PI) * (2.0 / 3.0);
    let second = 0.25;
    let mixed = 15.0 / (4.0 * PI) * second;
    let along = 5.0 / (16.0 * PI) * second;
    let across = 15.0 / (16.0 * PI) * second;
    [
        zeroth, first, first, first, mixed, mixed, along, mixed, across,
    ]
}

/// The irradiance of a cube map.
pub(super) fn irradiance_of(cube: &Cube) -> Irradiance {
    let mut sums = [DVec3::ZERO; 9];
    let mut sphere = 0.0;
    for face in 0..SIDES {
        for y in 0..cube.side {
            // A row by itself, in 32 bits.
            let mut row = [Vec3::ZERO; 9];
            for x in 0..cube.side {
                let place = cube.center(x, y);
                let weight = relative_solid_angle(place);
                let radiance = Vec3::from(cube.texel(face, x, y)) * weight;
                let terms = polynomials(direction_of(face, place).normalize());
                for (sum, term) in row.iter_mut().zip(terms) {
                    *sum += radiance * term;
                }
                sphere += f64::from(weight);
            }
            for (sum, row) in sums.iter_mut().zip(row) {
                *sum += row.as_dvec3();
            }
        }
    }
    let scale = 4.0 * std::f64::consts::PI / sphere;
    let factors = factors();
    std::array::from_fn(|i| (sums[i] * scale).as_vec3() * factors[i])
}
