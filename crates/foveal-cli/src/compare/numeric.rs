//! Differences as numbers see them.

/// Peak signal-to-noise ratio of red, green and blue in decibels, peak 255; `None` (infinite) for
/// equal colours.
pub(super) fn psnr_db(a: &[[u8; 4]], b: &[[u8; 4]]) -> Option<f64> {
    let squares: u64 = a
        .iter()
        .zip(b)
        .flat_map(|(a, b)| [0, 1, 2].map(|c| u64::from(a[c].abs_diff(b[c])).pow(2)))
        .sum();
    let mean = squares as f64 / (3.0 * a.len() as f64);
    (squares > 0).then(|| 10.0 * (255.0f64.powi(2) / mean).log10())
}

/// The largest difference of any channel, alpha included.
pub(super) fn max_difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> u8 {
    let channels = a.as_flattened().iter().zip(b.as_flattened());
    channels.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// Number of pixels with a difference in any channel, alpha included.
pub(super) fn differing_pixels(a: &[[u8; 4]], b: &[[u8; 4]]) -> u64 {
    a.iter().zip(b).filter(|(a, b)| a != b).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_one_everywhere_is_48_decibels() {
        let (a, b) = ([[10, 20, 30, 255]; 7], [[11, 19, 31, 255]; 7]);
        // 20 log10(255)
        assert!((psnr_db(&a, &b).unwrap() - 48.130_803_6).abs() < 1e-6);
        assert_eq!(max_difference(&a, &b), 1);
        assert_eq!(differing_pixels(&a, &b), 7);
    }

    #[test]
    fn equal_pictures_have_no_difference() {
        let a = [[1, 2, 3, 4]; 5];
        assert_eq!(
            (
                psnr_db(&a, &a),
                max_difference(&a, &a),
                differing_pixels(&a, &a)
            ),
            (None, 0, 0)
        );
    }

    #[test]
    fn black_against_white_is_0_decibels() {
        assert_eq!(psnr_db(&[[0; 4]], &[[255; 4]]), Some(0.0));
    }
}
