//! Structural similarity: Wang, Bovik, Sheikh and Simoncelli 2004, «Image Quality Assessment: From
//! Error Visibility to Structural Similarity», on luma (Rec. 601 weights, not rounded), with the
//! paper's own choices: an 11x11 Gaussian window of σ = 1.5, K₁ = 0.01, K₂ = 0.03, the mean over
//! all places where the window lies within the picture.

use foveal_host::picture::Picture;

/// Width and height of the window.
pub(super) const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// The mean over the picture; `None` where the picture is smaller than the window.
pub(super) fn mean_ssim(a: &Picture, b: &Picture) -> Option<f64> {
    let (width, height) = (a.width as usize, a.height as usize);
    if width < WINDOW || height < WINDOW {
        return None;
    }
    let (a, b) = (luma(a), luma(b));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let mean = |signal: &[f64]| blurred(width, height, signal);
    let (mean_a, mean_b) = (mean(&a), mean(&b));
    let (mean_aa, mean_bb, mean_ab) = (
        mean(&product(&a, &a)),
        mean(&product(&b, &b)),
        mean(&product(&a, &b)),
    );
    let sum: f64 = (0..mean_a.len())
        .map(|i| {
            let (ma, mb) = (mean_a[i], mean_b[i]);
            let (variance_a, variance_b) = (mean_aa[i] - ma * ma, mean_bb[i] - mb * mb);
            let covariance = mean_ab[i] - ma * mb;
            let luminance = (2.0 * ma * mb + C1) / (ma * ma + mb * mb + C1);
            let structure = (2.0 * covariance + C2) / (variance_a + variance_b + C2);
            luminance * structure
        })
        .sum();
    Some(sum / mean_a.len() as f64)
}

fn luma(picture: &Picture) -> Vec<f64> {
    let weigh = |&[r, g, b, _]: &[u8; 4]| {
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    };
    picture.pixels.iter().map(weigh).collect()
}

/// The window's weighted mean at each place where it lies within the picture: first along rows,
/// then columns.
fn blurred(width: usize, height: usize, signal: &[f64]) -> Vec<f64> {
    let weights = gaussian();
    let weighted = |values: &[f64], stride: usize| {
        weights
            .iter()
            .zip(values.iter().step_by(stride))
            .map(|(w, v)| w * v)
            .sum::<f64>()
    };
    let columns = width + 1 - WINDOW;
    let rows: Vec<f64> = signal
        .chunks(width)
        .flat_map(|row| row.windows(WINDOW))
        .map(|w| weighted(w, 1))
        .collect();
    let places = columns * (height + 1 - WINDOW);
    (0..places)
        .map(|place| weighted(&rows[place..], columns))
        .collect()
}

fn gaussian() -> [f64; WINDOW] {
    let middle = (WINDOW / 2) as f64;
    let weights: [f64; WINDOW] =
        std::array::from_fn(|i| (-(i as f64 - middle).powi(2) / (2.0 * SIGMA * SIGMA)).exp());
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, grey: impl Fn(u32, u32) -> u32) -> Picture {
        let pixels = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let grey = grey(x, y) as u8;
                [grey, grey, grey, 255]
            })
            .collect();
        Picture {
            width,
            height,
            pixels,
        }
    }

    #[test]
    fn the_same_picture_is_1() {
        let a = picture(20, 30, |x, y| (x * 37 + y * 91) % 256);
        assert!((mean_ssim(&a, &a).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flat_pictures_differ_by_the_luminance_term_alone() {
        let (a, b) = (picture(11, 11, |_, _| 100), picture(11, 11, |_, _| 150));
        let expected =
            (2.0 * 100.0 * 150.0 + 6.5025) / (100.0f64.powi(2) + 150.0f64.powi(2) + 6.5025);
        assert!((mean_ssim(&a, &b).unwrap() - expected).abs() < 1e-9);
    }

    /// The value comes from a direct evaluation of the paper's formula with the full 11x11 window
    /// in NumPy.
    #[test]
    fn a_textured_pair_has_the_value_of_an_independent_evaluation() {
        let base = |x: u32, y: u32| x * 37 + y * 91 + x * y * 5;
        let a = picture(24, 17, |x, y| base(x, y) % 256);
        let b = picture(24, 17, |x, y| (base(x, y) + (x * 7 + y * 3) % 23) % 256);
        assert!((mean_ssim(&a, &b).unwrap() - 0.719_706_569_681).abs() < 1e-9);
    }

    #[test]
    fn a_picture_smaller_than_the_window_has_none() {
        let a = picture(10, 40, |_, _| 0);
        assert_eq!(mean_ssim(&a, &a), None);
    }
}
