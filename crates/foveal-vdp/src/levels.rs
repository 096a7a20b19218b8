//! The pyramid's levels as the eye meets them: each with its frequency, and a sensitivity per
//! pixel.

use crate::eye::Geometry;
use crate::sensitivity::{SensitivityTable, transient_ratio};

/// Peak frequency of the levels below the first, by that of the first: the kernel's.
const BAND_PEAK: f32 = 0.3228;
/// Cycles per degree; the first level that is not above is the last.
const LAST_FREQUENCY: f32 = 0.5;

/// A level for one size of picture, one display and one gaze.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    width: usize,
    /// The first level's band holds what is finer than half of it too, the others' just what the
    /// next does not.
    gain: f32,
    table: SensitivityTable,
    /// Each pixel's column in the table.
    columns: Vec<f32>,
    ratios: Vec<f32>,
}

impl Level {
    /// All levels of a picture, the finest first.
    pub(crate) fn all(
        geometry: &Geometry,
        pixels_per_degree: f32,
        width: usize,
        height: usize,
    ) -> Vec<Self> {
        let mut levels = Vec::new();
        let (mut width, mut height) = (width, height);
        let mut frequency = pixels_per_degree / 2.0;
        let mut gain = 0.5;
        // Measured of the published metric: a picture of 16 pixels has three, one of 15 two.
        let most = width.min(height).max(4).ilog2() as usize - 1;
        let mut is_last = false;
        while !is_last && levels.len() < most {
            is_last = frequency <= LAST_FREQUENCY;
            let scale = geometry.ln_frequency_scale(width, height);
            levels.push(Self::new(frequency, gain, width, &scale));
            frequency *= if levels.len() == 1 { BAND_PEAK } else { 0.5 };
            gain = 1.0;
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
        levels
    }

    fn new(frequency: f32, gain: f32, width: usize, ln_scale: &[f32]) -> Self {
        let largest = ln_scale.iter().fold(0.0f32, |a, &b| a.max(b));
        let table = SensitivityTable::new(frequency, frequency * largest.exp());
        let ln_frequencies = ln_scale.iter().map(|scale| frequency.ln() + scale);
        let columns = ln_frequencies.clone().map(|ln| table.column(ln)).collect();
        let ratios = ln_frequencies
            .map(|ln| transient_ratio(f64::from(ln.exp())) as f32)
            .collect();
        Self {
            width,
            gain,
            table,
            columns,
            ratios,
        }
    }

    /// The sustained channel's sensitivity at a pixel, for a luminance in cd/m².
    pub(crate) fn sensitivity(&self, x: usize, y: usize, luminance: f32) -> f32 {
        self.gain * self.table.at(self.columns[y * self.width + x], luminance)
    }

    /// The transient channel's sensitivity by the sustained one's.
    pub(crate) fn transient_ratio(&self, x: usize, y: usize) -> f32 {
        self.ratios[y * self.width + x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Display, Gaze};

    fn count(display: &Display, width: usize, height: usize) -> usize {
        let geometry = Geometry::new(display, width, height, Gaze::CENTRE);
        Level::all(&geometry, display.pixels_per_degree(width), width, height).len()
    }

    #[test]
    fn levels_end_at_half_a_cycle_per_degree_or_with_the_pixels() {
        // 19.3, 21.8, 5.4, 1.4 and 0.7 pixels per degree.
        assert_eq!(count(&Display::DEGREES_60, 1280, 720), 5);
        assert_eq!(count(&Display::HEADSET, 2560, 1440), 5);
        assert_eq!(count(&Display::HEADSET, 640, 360), 3);
        assert_eq!(count(&Display::HEADSET, 160, 90), 2);
        assert_eq!(count(&Display::HEADSET, 80, 45), 1);
        let narrow = Display::parse("5").unwrap();
        assert_eq!(count(&narrow, 64, 64), 5);
        assert_eq!(count(&narrow, 64, 31), 3);
        assert_eq!(count(&narrow, 64, 15), 2);
        assert_eq!(count(&Display::MONITOR_24, 4, 4), 1);
    }
}
