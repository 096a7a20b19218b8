//! Where a pixel's sub-samples lie, and where each has its texel.
//!
//! A frame is drawn in bands of rows, so that the supersampled G-buffer stays small whatever the
//! frame's size. A grid of n x n fills a band of n times the width and height in one go; a rotated
//! pattern has one tile per sub-sample, one below the other, each drawn by itself with the frame
//! moved by a part of a texel.

use bytemuck::{Pod, Zeroable};

use crate::geometry::Window;
use crate::{SamplePattern, Settings};

/// Direct3D's and Vulkan's standard positions, in sixteenths of a pixel.
const ROTATED_4: [[u8; 2]; 4] = [[6, 2], [14, 6], [2, 10], [10, 14]];
const ROTATED_8: [[u8; 2]; 8] = [
    [9, 5],
    [7, 11],
    [13, 9],
    [5, 3],
    [3, 13],
    [1, 7],
    [11, 15],
    [15, 1],
];

/// A band's G-buffer may have this many bytes.
const MAX_BAND_BYTES: u64 = 96_000_000;
/// Pixels of a band: more would need a second row of workgroups.
const MAX_BAND_PIXELS: u64 = 65_535 * 64;

/// The sub-samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pattern {
    /// Side x side cells, a sample in the centre of each, row by row.
    Grid { side: u32 },
    /// Samples at these sixteenths of a pixel.
    Rotated(&'static [[u8; 2]]),
}

impl Pattern {
    /// The pattern of settings that were found valid.
    pub(crate) fn of(settings: &Settings) -> Self {
        match (settings.antialiasing.pattern, settings.antialiasing.samples) {
            (SamplePattern::Rotated, 8) => Self::Rotated(&ROTATED_8),
            (SamplePattern::Rotated, _) => Self::Rotated(&ROTATED_4),
            (SamplePattern::Grid, samples) => Self::Grid {
                side: samples.isqrt(),
            },
        }
    }

    /// Sub-samples per pixel.
    pub(crate) fn count(&self) -> u32 {
        match self {
            Self::Grid { side } => side * side,
            Self::Rotated(offsets) => offsets.len() as u32,
        }
    }

    /// The overrides of `antialias/samples.wgsl`.
    pub(crate) fn constants(&self) -> [(&'static str, f64); 2] {
        let side = match self {
            Self::Grid { side } => *side,
            Self::Rotated(_) => 0,
        };
        [
            ("COUNT", f64::from(self.count())),
            ("SIDE", f64::from(side)),
        ]
    }

    /// Texels across and down that a block of pixels needs.
    pub(crate) fn texels(&self, width: u32, rows: u32) -> (u32, u32) {
        match self {
            Self::Grid { side } => (width * side, rows * side),
            Self::Rotated(offsets) => (width, rows * offsets.len() as u32),
        }
    }

    /// Rows of pixels in a band of a frame of this size, at most, where a sub-sample takes `bytes`
    /// and a texture has at most `max_texels` rows.
    pub(crate) fn rows_per_band(
        &self,
        (width, height): (u32, u32),
        bytes: u64,
        max_texels: u32,
    ) -> u32 {
        let bytes_per_row = u64::from(width) * u64::from(self.count()) * bytes;
        let by_texels = u64::from(max_texels / self.texels(1, 1).1);
        (MAX_BAND_BYTES / bytes_per_row)
            .min(MAX_BAND_PIXELS / u64::from(width))
            .min(by_texels)
            .clamp(1, u64::from(height)) as u32
    }
}

/// Some rows of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Band {
    pub(crate) first_row: u32,
    pub(crate) rows: u32,
}

impl Band {
    /// The bands of `rows` rows that a frame of `height` rows falls into.
    pub(crate) fn all(height: u32, rows: u32) -> impl Iterator<Item = Self> {
        (0..height)
            .step_by(rows as usize)
            .map(move |first_row| Self {
                first_row,
                rows: rows.min(height - first_row),
            })
    }

    /// How a frame of `width` x `height` pixels is drawn to fill the band's texels.
    pub(crate) fn windows(&self, pattern: &Pattern, width: u32, height: u32) -> Vec<Window> {
        match pattern {
            Pattern::Grid { side } => {
                let [left, top, w, h] =
                    [0, self.first_row, width, height].map(|v| (v * side) as f32);
                vec![Window {
                    frame: [left, -top, w, h],
                    part: [0, 0, width * side, self.rows * side],
                }]
            }
            Pattern::Rotated(offsets) => (0..)
                .zip(*offsets)
                .map(|(index, offset)| {
                    // The rasterizer looks at the centre of a texel: the frame moves against the
                    // offset.
                    let [x, y] = offset.map(|sixteenths| 0.5 - f32::from(sixteenths) / 16.0);
                    let tile = index * self.rows;
                    Window {
                        frame: [
                            x,
                            tile as f32 - self.first_row as f32 + y,
                            width as f32,
                            height as f32,
                        ],
                        part: [0, tile, width, self.rows],
                    }
                })
                .collect(),
        }
    }
}

/// Mirrors `Band` in `antialias/samples.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct BandUniform {
    pub(crate) first_row: u32,
    pub(crate) rows: u32,
    pub(crate) reserved: [u32; 2],
    pub(crate) offsets: [[f32; 4]; 4],
}

impl BandUniform {
    pub(crate) fn new(pattern: &Pattern, band: Band) -> Self {
        let mut offsets = [[0.0; 4]; 4];
        if let Pattern::Rotated(sixteenths) = pattern {
            let parts = sixteenths.iter().flatten().map(|&v| f32::from(v) / 16.0);
            for (slot, part) in offsets.iter_mut().flatten().zip(parts) {
                *slot = part;
            }
        }
        Self {
            first_row: band.first_row,
            rows: band.rows,
            reserved: [0; 2],
            offsets,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn rotated_patterns_have_no_two_samples_in_one_row_or_column_and_no_bias() {
        for offsets in [&ROTATED_4[..], &ROTATED_8] {
            for axis in 0..2 {
                let mut cells: Vec<u8> = offsets.iter().map(|o| o[axis]).collect();
                let sum: u32 = cells.iter().map(|&c| u32::from(c)).sum();
                assert_eq!(sum, 8 * offsets.len() as u32, "the mean is the centre");
                cells.sort_unstable();
                cells.dedup();
                assert_eq!(cells.len(), offsets.len());
            }
        }
    }

    proptest! {
        #[test]
        fn every_row_is_in_exactly_one_band(height in 1_u32..5000, rows in 1_u32..5000) {
            let rows = rows.min(height);
            let mut next = 0;
            for band in Band::all(height, rows) {
                prop_assert_eq!(band.first_row, next);
                prop_assert!((1..=rows).contains(&band.rows));
                next += band.rows;
            }
            prop_assert_eq!(next, height);
        }

        #[test]
        fn bands_fit_the_device(width in 1_u32..8192, height in 1_u32..8192, side in 2_u32..=16) {
            let pattern = Pattern::Grid { side };
            let rows = pattern.rows_per_band((width, height), 28, 8192);
            prop_assert!((1..=height).contains(&rows));
            prop_assert!(rows * side <= 8192);
            let pixels = u64::from(width) * u64::from(rows);
            prop_assert!(pixels <= MAX_BAND_PIXELS);
            prop_assert!(rows == 1 || pixels * u64::from(side * side) * 28 <= MAX_BAND_BYTES);
        }
    }
}
