//! What the eye makes of time: a sustained answer to what is there, a transient one to what
//! changes.
//!
//! The impulse responses have the form of Mantiuk et al. 2021: sustained, a Gaussian in the
//! logarithm of time around 60 ms; transient, its derivative. Both end after a quarter of a second.
//! Measured responses agree to 1e-5.

use crate::pyramid::Plane;

/// Seconds at which the sustained response is greatest.
const PEAK_S: f64 = 0.06;
/// Its width in natural logarithms.
const WIDTH: f64 = 0.5;
/// Keeps the logarithm finite at the moment 0.
const EPSILON_S: f64 = 1e-4;
/// Length of the filters.
const LENGTH_S: f64 = 0.25;
/// The scale to which the transient sensitivity is fitted: 4/105 s, the step between taps at 30
/// frames per second.
const TRANSIENT_SCALE_S: f64 = 4.0 / 105.0;

/// Taps by age in frames, the newest first.
#[derive(Clone, Debug)]
pub(crate) struct Filters {
    pub(crate) sustained: Vec<f32>,
    pub(crate) transient: Vec<f32>,
}

impl Filters {
    pub(crate) fn new(frames_per_second: f32) -> Self {
        let rate = f64::from(frames_per_second);
        let taps = (rate * LENGTH_S).ceil().max(2.0) as usize;
        // The taps are spread over all of the last frame too.
        let step_s = taps as f64 / rate / (taps - 1) as f64;
        let response = |tap: usize| {
            let time_s = tap as f64 * step_s + EPSILON_S;
            (-(time_s / PEAK_S).ln().powi(2) / (2.0 * WIDTH * WIDTH)).exp()
        };
        let sum: f64 = (0..taps).map(response).sum();
        let sustained: Vec<f64> = (0..taps).map(|tap| response(tap) / sum).collect();
        let transient = sustained
            .windows(2)
            .map(|pair| ((pair[1] - pair[0]) * TRANSIENT_SCALE_S / step_s) as f32)
            .collect();
        Self {
            sustained: sustained.iter().map(|&tap| tap as f32).collect(),
            transient,
        }
    }

    /// Both answers to the frames seen so far, newest first; before the first frame it was always
    /// there.
    pub(crate) fn apply<'a>(
        &self,
        newest_first: impl Iterator<Item = &'a Plane> + Clone,
    ) -> (Plane, Plane) {
        (
            weighted_sum(&self.sustained, newest_first.clone()),
            weighted_sum(&self.transient, newest_first),
        )
    }
}

fn weighted_sum<'a>(taps: &[f32], newest_first: impl Iterator<Item = &'a Plane>) -> Plane {
    let mut frames = newest_first.peekable();
    let mut sum = Plane::default();
    let mut used = 0;
    while let Some(frame) = frames.next() {
        let Some(&tap) = taps.get(used) else { break };
        used += 1;
        // The oldest frame stands for all before it.
        let weight = if frames.peek().is_none() {
            tap + taps[used..].iter().sum::<f32>()
        } else {
            tap
        };
        if sum.values.is_empty() {
            sum = Plane::new(frame.width, frame.height, vec![0.0; frame.values.len()]);
        }
        for (sum, &value) in sum.values.iter_mut().zip(&frame.values) {
            *sum += weight * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_video_is_sustained_and_hardly_transient() {
        for rate in [24.0, 30.0, 60.0, 90.0, 120.0] {
            let filters = Filters::new(rate);
            assert!((filters.sustained.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            assert!(filters.transient.iter().sum::<f32>().abs() < 0.02);
        }
    }

    #[test]
    fn the_filters_last_a_quarter_second() {
        assert_eq!(Filters::new(30.0).sustained.len(), 8);
        assert_eq!(Filters::new(60.0).sustained.len(), 15);
        // Measured: the sustained response to a single frame of 24 per second.
        let measured = [0.0, 0.5243, 0.33135, 0.10411, 0.03074, 0.0095];
        for (tap, measured) in Filters::new(24.0).sustained.iter().zip(measured) {
            assert!((tap - measured).abs() < 1e-4);
        }
    }

    #[test]
    fn the_first_frame_was_always_there() {
        let filters = Filters::new(30.0);
        let frame = Plane::new(1, 1, vec![5.0]);
        let (sustained, _) = filters.apply([&frame].into_iter());
        assert!((sustained.values[0] - 5.0).abs() < 1e-5);
        let old = Plane::new(1, 1, vec![1.0]);
        let (sustained, transient) = filters.apply([&frame, &old, &old].into_iter());
        assert!((sustained.values[0] - 1.0).abs() < 1e-3, "seen later");
        assert!(transient.values[0] > 1.0, "change is seen at once");
    }
}
