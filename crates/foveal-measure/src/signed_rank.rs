//! The signed-rank test as an interval: which shifts of the differences the test would not refuse.
//!
//! F. Wilcoxon 1945; the interval by J. L. Hodges and E. L. Lehmann 1963: all means of two
//! differences (a difference with itself among them), sorted, without as many at either end as the
//! test allows.

use crate::spread::of_sorted;

/// Above this the statistic's distribution is taken for a normal one; below it is counted out.
const MOST_COUNTED: usize = 64;

/// The median of all means of two differences, and the interval that holds the true median with
/// `confidence`; no interval where there are too few differences for it. `None` of nothing.
pub(crate) fn estimate(differences: &[f64], confidence: f64) -> Option<(f64, Option<[f64; 2]>)> {
    let means = means(differences);
    let last = means.len().checked_sub(1)?;
    let interval = left_out(differences.len(), 0.5 * (1.0 - confidence))
        .map(|left_out| [means[left_out], means[last - left_out]]);
    Some((of_sorted(&means, 0.5), interval))
}

/// The median of all means of two differences. `None` of nothing.
pub(crate) fn median_of_means(differences: &[f64]) -> Option<f64> {
    let means = means(differences);
    (!means.is_empty()).then(|| of_sorted(&means, 0.5))
}

/// The means of any two differences, sorted.
fn means(differences: &[f64]) -> Vec<f64> {
    let mut means = Vec::new();
    for (i, a) in differences.iter().enumerate() {
        means.extend(differences[i..].iter().map(|b| 0.5 * (a + b)));
    }
    means.sort_by(f64::total_cmp);
    means
}

/// How many means are left out at either end, so that each end is missed with a probability of at
/// most `tail`.
fn left_out(n: usize, tail: f64) -> Option<usize> {
    if n > MOST_COUNTED {
        let n = n as f64;
        let mean = n * (n + 1.0) / 4.0;
        let deviation = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0).sqrt();
        // Half a step for what is whole in the true distribution, and one more for safety.
        let left_out = (mean - normal_quantile(tail) * deviation - 1.5).floor();
        return (left_out >= 0.0).then_some(left_out as usize);
    }
    let chances = chances(n);
    let mut below = 0.0;
    let refused = chances.iter().take_while(|&&chance| {
        below += chance;
        below <= tail
    });
    // The largest statistic that is refused: 0 to it are as many as it and one.
    refused.count().checked_sub(1)
}

/// The chance of each value of the statistic: the sum of the ranks 1 to n, each of which counts or
/// not by a fair coin.
fn chances(n: usize) -> Vec<f64> {
    let mut chances = vec![0.0; n * (n + 1) / 2 + 1];
    chances[0] = 1.0;
    for rank in 1..=n {
        for sum in (0..chances.len()).rev() {
            let with = if sum >= rank {
                chances[sum - rank]
            } else {
                0.0
            };
            chances[sum] = 0.5 * (chances[sum] + with);
        }
    }
    chances
}

/// How many standard deviations from the centre `tail` of a normal distribution begins: by
/// Abramowitz and Stegun 26.2.23, whose error is below 0.00045.
fn normal_quantile(tail: f64) -> f64 {
    let t = (-2.0 * tail.ln()).sqrt();
    let above = 2.515517 + t * (0.802853 + t * 0.010328);
    let below = 1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308));
    t - above / below
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Critical values of printed tables (two-sided): the largest statistic that is refused.
    #[test]
    fn as_many_are_left_out_as_tables_say() {
        for (n, confidence, refused) in [
            (6, 0.95, 0),
            (8, 0.95, 3),
            (10, 0.95, 8),
            (20, 0.95, 52),
            (8, 0.99, 0),
            (10, 0.99, 3),
            (20, 0.99, 37),
            (30, 0.99, 109),
        ] {
            let left_out = left_out(n, 0.5 * (1.0 - confidence));
            assert_eq!(left_out, Some(refused), "{n} {confidence}");
        }
        assert_eq!(left_out(5, 0.025), None);
        assert_eq!(left_out(7, 0.005), None);
    }

    /// The true median lies beyond an end where the statistic is at most what is left out there.
    #[test]
    fn each_end_is_missed_as_rarely_as_promised() {
        let tail = 0.5 * (1.0 - crate::CONFIDENCE);
        assert_eq!(left_out(crate::LEAST_PAIRS - 1, tail), None);
        for n in crate::LEAST_PAIRS..=MOST_COUNTED + 40 {
            let left_out = left_out(n, tail).unwrap();
            let missed: f64 = chances(n)[..=left_out].iter().sum();
            assert!(missed <= tail, "{n}: {missed}");
            // What is counted out is no wider than it must be.
            let next: f64 = chances(n)[..=left_out + 1].iter().sum();
            assert!(n > MOST_COUNTED || next > tail, "{n}: {next}");
        }
    }

    #[test]
    fn chances_sum_up_to_one_and_are_alike_from_both_ends() {
        let chances = chances(13);
        assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(chances.iter().eq(chances.iter().rev()));
    }

    #[test]
    fn the_normal_distribution_is_near_the_counted_one() {
        let n = MOST_COUNTED;
        let counted = left_out(n, 0.0005).unwrap() as f64;
        let (mean, deviation) = (
            (n * (n + 1)) as f64 / 4.0,
            ((n * (n + 1) * (2 * n + 1)) as f64 / 24.0).sqrt(),
        );
        let normal = mean - normal_quantile(0.0005) * deviation;
        assert!((normal - counted).abs() < 0.02 * mean, "{normal} {counted}");
        assert!(left_out(65, 0.0005).unwrap() > left_out(64, 0.0005).unwrap());
    }

    #[test]
    fn equal_differences_have_no_width() {
        let (median, interval) = estimate(&[0.25; 12], 0.999).unwrap();
        assert_eq!((median, interval), (0.25, Some([0.25, 0.25])));
        assert_eq!(estimate(&[], 0.9), None);
        assert_eq!(estimate(&[1.0], 0.9), Some((1.0, None)));
    }
}
