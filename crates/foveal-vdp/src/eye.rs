//! Where the eye looks, and how finely it sees each pixel.
//!
//! Angles are taken per axis: a pixel's direction is (atan(x/d), atan(y/d)), eccentricity the
//! length of the difference to the gaze's direction. A flat display has more pixels per degree away
//! from its middle, by 1/cos².

use crate::{Display, VdpError};

/// The point looked at, as fractions of the picture from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// From the left border: 0 to 1, beyond them outside of the picture.
    pub x: f32,
    /// From the upper border.
    pub y: f32,
}

impl Gaze {
    /// The picture's middle.
    pub const CENTRE: Self = Self { x: 0.5, y: 0.5 };

    pub(crate) fn check(self) -> Result<(), VdpError> {
        let near = |v: f32| (-10.0..=11.0).contains(&v);
        if near(self.x) && near(self.y) {
            Ok(())
        } else {
            Err(VdpError::Gaze {
                x: self.x,
                y: self.y,
            })
        }
    }
}

/// Dougherty et al. 2003: eccentricity in degrees at which cortical magnification is half of the
/// fovea's.
const HALF_MAGNIFICATION_DEG: f64 = 3.67;
/// By which power of the magnification frequencies grow; fitted to measurements
/// (docs/eye-metric.md).
const MAGNIFICATION_POWER: f64 = 0.6058;

/// A picture's geometry before the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Geometry {
    width: f64,
    height: f64,
    distance: f64,
    gaze: (f64, f64),
}

impl Geometry {
    pub(crate) fn new(display: &Display, width: usize, height: usize, gaze: Gaze) -> Self {
        let distance = display.distance_in_pixels(width);
        let (width, height) = (width as f64, height as f64);
        let angle =
            |fraction: f32, size: f64| ((f64::from(fraction) - 0.5) * size / distance).atan();
        Self {
            width,
            height,
            distance,
            gaze: (angle(gaze.x, width), angle(gaze.y, height)),
        }
    }

    /// ln of the factor by which a pyramid level's frequency grows, for each of its `width *
    /// height` pixels: what the fovea sees as fine as this place sees the middle's frequency.
    pub(crate) fn ln_frequency_scale(&self, width: usize, height: usize) -> Vec<f32> {
        let angles = |count: usize, size: f64| -> Vec<f64> {
            let place = |i: usize| ((i as f64 + 0.5) / count as f64 - 0.5) * size;
            (0..count)
                .map(|i| (place(i) / self.distance).atan())
                .collect()
        };
        let (columns, rows) = (angles(width, self.width), angles(height, self.height));
        rows.iter()
            .flat_map(|&y| columns.iter().map(move |&x| (x, y)))
            .map(|(x, y)| {
                let off_axis = x.hypot(y).min(1.5);
                let density = -2.0 * off_axis.cos().ln();
                let eccentricity = (x - self.gaze.0).hypot(y - self.gaze.1).to_degrees();
                let magnification = (1.0 + eccentricity / HALF_MAGNIFICATION_DEG).ln();
                (density + MAGNIFICATION_POWER * magnification) as f32
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gaze_sees_frequencies_as_they_are_and_the_periphery_as_higher_ones() {
        let geometry = Geometry::new(&Display::DEGREES_60, 600, 400, Gaze::CENTRE);
        let scale = geometry.ln_frequency_scale(601, 401);
        let at = |x: usize, y: usize| scale[y * 601 + x];
        assert!(at(300, 200).abs() < 1e-6);
        // 30 degrees: ((30 + 3.67) / 3.67) ^ 0.6058, and 1 / cos² of the place itself.
        let expected =
            0.6058 * (1.0f32 + 29.95 / 3.67).ln() - 2.0 * 29.95f32.to_radians().cos().ln();
        assert!(
            (at(0, 200) - expected).abs() < 2e-3,
            "{} {expected}",
            at(0, 200)
        );
        assert!(at(0, 0) > at(0, 200));
    }
}
