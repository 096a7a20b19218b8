//! How visible the difference between two pictures, or two videos, is to an eye that looks at one
//! point of them.
//!
//! The metric is FovVideoVDP (Mantiuk, Denes, Chapiro, Kaplanyan, Rufo, Bachy, Lian and Patney
//! 2021, «FovVideoVDP: A visible difference predictor for wide field-of-view video»), written after
//! its paper and calibrated by measurement: docs/eye-metric.md says what comes from where, and how
//! near it is to the published program. It knows the display (size, luminance, light in the room),
//! the eye's loss of detail away from the gaze, masking, and time.
//!
//! ```
//! use foveal_vdp::{Display, Gaze, Metric, Pixels};
//!
//! let metric = Metric::new(&Display::HEADSET, 64, 64, Gaze { x: 0.25, y: 0.5 })?;
//! let reference: Vec<[u8; 3]> = (0..64 * 64).map(|i| [(i % 64 * 4) as u8; 3]).collect();
//! let test: Vec<[u8; 3]> = reference.iter().map(|&[r, _, _]| [r / 16 * 16; 3]).collect();
//! let comparison = metric.compare(Pixels::Rgb(&reference), Pixels::Rgb(&test))?;
//! assert!(comparison.jod < 10.0);
//! # Ok::<(), foveal_vdp::VdpError>(())
//! ```
//!
//! The feature `rayon` spreads rows over the current rayon pool; results stay the same to the bit.
#![forbid(unsafe_code)]

mod difference;
mod display;
mod error;
mod eye;
mod flicker;
mod levels;
mod metric;
mod pyramid;
mod sensitivity;
mod temporal;

pub use display::{Display, Extent};
pub use error::VdpError;
pub use eye::Gaze;
pub use metric::{Comparison, FRAME_RATES, HeatMap, Metric, Pixels, VideoComparison, VideoMetric};
