//! Irradiance as spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001, 'An Efficient
//! Representation for Irradiance Environment Maps').

use std::f32::consts::PI;

use foveal_scene::ImageLight;
use glam::{DVec3, Mat3, Vec3};

use super::cube::{Cube, SIDES, direction_of, relative_solid_angle};
use super::picture::Equirectangular;

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

/// The irradiance that a scene's own environment names, turned as it is.
pub(super) fn of_coefficients(light: &ImageLight) -> Irradiance {
    // So that nothing becomes infinite.
    let held = |v: f32| if v.is_nan() { 0.0 } else { v.clamp(-1e9, 1e9) };
    let intensity = held(light.intensity);
    let c = light.irradiance.map(|rgb| Vec3::from(rgb.map(held)));
    // Each harmonic's factor, over pi.
    let [zeroth, first, mixed, along, across] =
        [0.282_095, 0.488_603, 1.092_548, 0.315_392, 0.546_274].map(|f| f * intensity / PI);
    let linear = [c[3], c[1], c[2]].map(|c| c * first);
    let turn = Mat3::from_quat(light.rotation);
    let mut result = [Vec3::ZERO; 9];
    result[0] = c[0] * zeroth;
    for channel in 0..3 {
        let l = turn * Vec3::from(linear.map(|c| c[channel]));
        (result[1][channel], result[2][channel], result[3][channel]) = (l.y, l.z, l.x);
        // As a quadratic form without trace, where 3zz - 1 is 2zz - xx - yy.
        let [xy, yz, xz] = [c[4], c[5], c[7]].map(|c| 0.5 * mixed * c[channel]);
        let (z, x) = (along * c[6][channel], across * c[8][channel]);
        let form = Mat3::from_cols(
            Vec3::new(x - z, xy, xz),
            Vec3::new(xy, -x - z, yz),
            Vec3::new(xz, yz, 2.0 * z),
        );
        let form = turn * form * turn.transpose();
        result[4][channel] = 2.0 * form.x_axis.y;
        result[5][channel] = 2.0 * form.y_axis.z;
        result[6][channel] = 0.5 * form.z_axis.z;
        result[7][channel] = 2.0 * form.x_axis.z;
        result[8][channel] = 0.5 * (form.x_axis.x - form.y_axis.y);
    }
    result
}

/// Radiance from parts of the sphere, weighted by their solid angles in any unit.
#[derive(Default)]
struct Sum {
    terms: [DVec3; 9],
    sphere: f64,
}

impl Sum {
    /// Adds a row of directions with radiance and weight, which it sums in 32 bits.
    fn add(&mut self, row: impl Iterator<Item = (Vec3, Vec3, f32)>) {
        let mut sums = [Vec3::ZERO; 9];
        for (direction, radiance, weight) in row {
            for (sum, term) in sums.iter_mut().zip(polynomials(direction)) {
                *sum += radiance * weight * term;
            }
            self.sphere += f64::from(weight);
        }
        for (sum, row) in self.terms.iter_mut().zip(sums) {
            *sum += row.as_dvec3();
        }
    }

    fn irradiance(&self) -> Irradiance {
        let scale = 4.0 * std::f64::consts::PI / self.sphere;
        let factors = factors();
        std::array::from_fn(|i| (self.terms[i] * scale).as_vec3() * factors[i])
    }
}

/// The irradiance of a cube map.
pub(super) fn irradiance_of(cube: &Cube) -> Irradiance {
    let mut sum = Sum::default();
    for (face, y) in (0..SIDES).flat_map(|face| (0..cube.side).map(move |y| (face, y))) {
        sum.add((0..cube.side).map(|x| {
            let place = cube.center(x, y);
            let direction = direction_of(face, place).normalize();
            let radiance = cube.texel(face, x, y);
            (direction, radiance.into(), relative_solid_angle(place))
        }));
    }
    sum.irradiance()
}

/// The irradiance of a picture: of each of its texels, however small.
pub(super) fn irradiance_of_picture(picture: &Equirectangular) -> Irradiance {
    let mut sum = Sum::default();
    for (sine, row) in picture.rows() {
        sum.add(row.map(|(direction, radiance)| (direction, radiance.into(), sine)));
    }
    sum.irradiance()
}
