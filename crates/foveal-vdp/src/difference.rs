//! Visible difference within one band: contrast, masking, and what is pooled from them.
//!
//! After Mantiuk et al. 2021: contrast against the reference's local luminance, mutual masking (the
//! smaller of both pictures' contrasts hides), Minkowski sums over space, bands, channels and time,
//! and a power law from their result to JOD. The numbers are fitted to measurements
//! (docs/eye-metric.md), because the published program was calibrated anew after its paper.

use crate::levels::Level;
use crate::pyramid::Plane;

/// Power of a contrast difference in multiples of the threshold.
const DIFFERENCE_POWER: f32 = 2.4;
/// Power of the masking contrast, sustained and transient.
const MASKING_POWER: [f32; 2] = [2.43686, 4.9459];
/// Gain of the masking contrast.
const MASKING_GAIN: f32 = 0.106_207;
/// No pixel counts for more.
const LARGEST_DIFFERENCE: f32 = 1e4;
/// Minkowski exponent over a band's pixels.
const SPACE_POWER: f32 = 1.52146;
/// Minkowski exponent over the temporal channels.
const CHANNEL_POWER: f64 = 0.666_091;
/// Weight of the transient channel.
const TRANSIENT_WEIGHT: f64 = 0.25;
/// JOD lost at a difference of 1.
const JOD_SCALE: f64 = 0.016_171_3;
/// Power from difference to JOD lost.
const JOD_POWER: f64 = 0.591_562;
/// Luminance in cd/m² below which contrast is taken against this.
const LEAST_BACKGROUND: f32 = 0.1;

/// One temporal channel of both videos at one pyramid level.
pub(crate) struct Pair<'a> {
    pub(crate) reference: &'a Plane,
    pub(crate) test: &'a Plane,
    /// Their low-passed twins, which the band is the difference to.
    pub(crate) reference_low: &'a Plane,
    pub(crate) test_low: &'a Plane,
}

/// Which temporal channel a pair belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Sustained,
    Transient,
}

/// The difference at each pixel of a band, and the band's mean of it. `background` is the
/// reference's low-passed sustained luminance in cd/m².
pub(crate) fn band(
    level: &Level,
    channel: Channel,
    pair: &Pair<'_>,
    background: &Plane,
) -> (f64, Plane) {
    let (width, height) = (pair.reference.width, pair.reference.height);
    let mut values = vec![0.0; width * height];
    let sum = rows(&mut values, width, |y, out| {
        let at = y * width..(y + 1) * width;
        let (reference, test) = (
            &pair.reference.values[at.clone()],
            &pair.test.values[at.clone()],
        );
        let (reference_low, test_low) = (
            &pair.reference_low.values[at.clone()],
            &pair.test_low.values[at.clone()],
        );
        let background = &background.values[at];
        let mut sum = 0.0;
        for (x, out) in out.iter_mut().enumerate() {
            let luminance = background[x].max(LEAST_BACKGROUND);
            let mut sensitivity = level.sensitivity(x, y, luminance);
            if channel == Channel::Transient {
                sensitivity *= level.transient_ratio(x, y);
            }
            let to_thresholds = sensitivity / luminance;
            let reference = (reference[x] - reference_low[x]) * to_thresholds;
            let test = (test[x] - test_low[x]) * to_thresholds;
            *out = masked(channel, reference, test);
            sum += f64::from(out.powf(SPACE_POWER));
        }
        sum
    });
    let mean = sum / (width * height) as f64;
    let pooled = mean.powf(1.0 / f64::from(SPACE_POWER));
    (pooled, Plane::new(width, height, values))
}

/// The difference of two contrasts, both in multiples of the threshold.
fn masked(channel: Channel, reference: f32, test: f32) -> f32 {
    let mask = MASKING_GAIN * reference.abs().min(test.abs());
    let difference = (test - reference).abs().powf(DIFFERENCE_POWER);
    (difference / (1.0 + mask.powf(MASKING_POWER[channel as usize]))).min(LARGEST_DIFFERENCE)
}

/// Both channels' differences as one.
pub(crate) fn join_channels(sustained: f64, transient: f64) -> f64 {
    let transient = TRANSIENT_WEIGHT * transient;
    (sustained.powf(CHANNEL_POWER) + transient.powf(CHANNEL_POWER)).powf(1.0 / CHANNEL_POWER)
}

/// JOD that a difference costs: 0 where there is none.
pub(crate) fn jod_lost(difference: f64) -> f64 {
    JOD_SCALE * difference.powf(JOD_POWER)
}

/// Works on all rows and sums what they give, in the order of rows.
fn rows(
    values: &mut [f32],
    width: usize,
    work: impl Fn(usize, &mut [f32]) -> f64 + Sync + Send,
) -> f64 {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let rows = values.par_chunks_mut(width).enumerate();
        let sums: Vec<f64> = rows.map(|(y, row)| work(y, row)).collect();
        sums.iter().sum()
    }
    #[cfg(not(feature = "rayon"))]
    {
        let rows = values.chunks_mut(width).enumerate();
        rows.map(|(y, row)| work(y, row)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contrast_common_to_both_hides_a_difference() {
        let masked = |reference, test| masked(Channel::Sustained, reference, test);
        assert_eq!(masked(3.0, 3.0), 0.0);
        let alone = masked(0.0, 2.0);
        assert!((alone - 2.0f32.powf(2.4)).abs() < 1e-4);
        assert!(masked(40.0, 42.0) < 0.1 * alone);
        assert!(masked(-40.0, 42.0) > alone, "opposite signs differ");
        assert_eq!(masked(0.0, 1e6), LARGEST_DIFFERENCE);
    }

    #[test]
    fn change_hides_change_better_than_rest_hides_rest() {
        let [sustained, transient] =
            [Channel::Sustained, Channel::Transient].map(|channel| masked(channel, 40.0, 42.0));
        assert!(transient < 0.1 * sustained, "{transient} {sustained}");
    }

    #[test]
    fn no_difference_costs_nothing() {
        assert_eq!(jod_lost(join_channels(0.0, 0.0)), 0.0);
        assert!((join_channels(5.0, 0.0) - 5.0).abs() < 1e-9);
        assert!(jod_lost(1000.0) < 1.0 && jod_lost(1100.0) > 1.0);
    }
}
