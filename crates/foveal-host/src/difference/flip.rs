//! FLIP: the difference that a viewer sees when two pictures are shown in turn at the same place
//! (Andersson et al. 2020, «FLIP: A Difference Evaluator for Alternating Images»), by NVIDIA's own
//! code.
//!
//! The viewer sits as the paper assumes: 0.7 m from a display 0.7 m wide with 3840 pixels, 67
//! pixels per degree.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageFloat, FlipImageRgb8};

use crate::picture::Picture;

/// FLIP's error per pixel, 0 to 1.
pub struct ErrorMap(FlipImageFloat);

impl ErrorMap {
    /// The map between two pictures of the same size.
    pub fn between(reference: &Picture, test: &Picture) -> Self {
        let image = |p: &Picture| FlipImageRgb8::with_data(p.width, p.height, &p.rgb_bytes());
        Self(nv_flip::flip(
            image(reference),
            image(test),
            DEFAULT_PIXELS_PER_DEGREE,
        ))
    }

    /// The mean over all pixels.
    pub fn mean(&self) -> f64 {
        let errors = self.0.to_vec();
        errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64
    }

    /// The map in the magma colours, RGB8 rows.
    pub fn heat_rgb(&self) -> Vec<u8> {
        self.0.apply_color_lut(&nv_flip::magma_lut()).to_vec()
    }
}

/// Shares of 0 to 1 in the magma colours, RGB8.
pub fn magma(shares: impl Iterator<Item = f32>) -> Vec<u8> {
    let colours = nv_flip::magma_lut().to_vec();
    let last = colours.len() / 3 - 1;
    shares
        .flat_map(|share| {
            let colour = (share.clamp(0.0, 1.0) * last as f32).round() as usize;
            [0, 1, 2].map(|channel| colours[3 * colour + channel])
        })
        .collect()
}
