//! How much the periphery changes from frame to frame.

use crate::{Gaze, Pixels};

/// Standard deviation of the low-pass in pixels, and where its kernel ends.
const SIGMA: f32 = 4.0;
const REACH: usize = 12;
/// The periphery begins at this distance from the gaze, by the picture's height.
const PERIPHERY: f32 = 0.35;

/// Sums frame-to-frame changes of a video's low-passed luma (8-bit code values) in the periphery.
#[derive(Clone, Debug)]
pub(crate) struct FlickerMeter {
    width: usize,
    far: Vec<bool>,
    kernel: Vec<f32>,
    last: Vec<f32>,
    sum: f64,
}

impl FlickerMeter {
    pub(crate) fn new(width: usize, height: usize, gaze: Gaze) -> Self {
        let (gaze_x, gaze_y) = (gaze.x * width as f32, gaze.y * height as f32);
        let far = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let distance = (x as f32 - gaze_x).hypot(y as f32 - gaze_y);
                distance > PERIPHERY * height as f32
            })
            .collect();
        let weights = (0..=2 * REACH)
            .map(|i| (-(i as f32 - REACH as f32).powi(2) / (2.0 * SIGMA * SIGMA)).exp());
        let sum: f32 = weights.clone().sum();
        Self {
            width,
            far,
            kernel: weights.map(|w| w / sum).collect(),
            last: Vec::new(),
            sum: 0.0,
        }
    }

    pub(crate) fn push(&mut self, pixels: Pixels<'_>) {
        let luma: Vec<f32> = pixels
            .iter()
            .map(|[r, g, b]| 0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b))
            .collect();
        let low = self.low_passed(&luma);
        let changes = low.iter().zip(&self.last).zip(&self.far);
        self.sum += changes
            .filter(|(_, far)| **far)
            .map(|((now, before), _)| f64::from((now - before).abs()))
            .sum::<f64>();
        self.last = low;
    }

    /// The changes' sum; `None` without a periphery.
    pub(crate) fn sum(&self) -> Option<f64> {
        self.far.contains(&true).then_some(self.sum)
    }

    /// Number of pixels in the periphery.
    pub(crate) fn samples(&self) -> f64 {
        self.far.iter().filter(|far| **far).count() as f64
    }

    /// Black around the picture.
    fn low_passed(&self, luma: &[f32]) -> Vec<f32> {
        let width = self.width;
        let mut rows = vec![0.0; luma.len()];
        for (out, row) in rows.chunks_mut(width).zip(luma.chunks(width)) {
            for (tap, weight) in self.kernel.iter().enumerate() {
                // out[x] takes row[x + tap - REACH].
                let (to, from) = (REACH.saturating_sub(tap), tap.saturating_sub(REACH));
                if to < width && from < width {
                    let pairs = out[to..].iter_mut().zip(&row[from..]);
                    pairs.for_each(|(out, value)| *out += weight * value);
                }
            }
        }
        let mut low = vec![0.0; luma.len()];
        let height = luma.len() / width;
        for (y, out) in low.chunks_mut(width).enumerate() {
            for (tap, weight) in self.kernel.iter().enumerate() {
                let from = (y + tap).checked_sub(REACH).filter(|&from| from < height);
                if let Some(from) = from {
                    let row = &rows[from * width..][..width];
                    out.iter_mut()
                        .zip(row)
                        .for_each(|(out, value)| *out += weight * value);
                }
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_change_does_not_flicker_and_the_fovea_does_not_count() {
        let size = 60;
        let grey = vec![[90u8; 3]; size * size];
        let mut dot = grey.clone();
        dot[30 * size + 30] = [255; 3];
        let mut corner = grey.clone();
        corner[0] = [255; 3];
        let sum = |frames: &[&Vec<[u8; 3]>]| {
            let mut meter = FlickerMeter::new(size, size, Gaze::CENTRE);
            frames
                .iter()
                .for_each(|frame| meter.push(Pixels::Rgb(frame)));
            meter.sum().unwrap()
        };
        assert_eq!(sum(&[&grey, &grey, &grey]), 0.0);
        assert!(sum(&[&grey, &dot]) < 1e-2);
        assert!(sum(&[&grey, &corner]) > 10.0);
    }
}
