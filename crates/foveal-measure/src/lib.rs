//! How two ways of drawing are compared: the one method of the window, the report and the benches.
//!
//! Both sides draw the same frames, warm, one after the other. [`turn`] says in which order: it is
//! drawn by lot for each frame, so that with equal sides each of the two is as likely to meet a
//! slow moment as the other, whatever the machine does meanwhile. The test needs nothing else:
//! drift, outliers and a neighbour's load cannot make a difference of their own.
//!
//! [`Comparison::of`] takes the pairs of times. Its ratio is *reference / chosen*: above 1 the
//! chosen side is faster. The ratio comes with an interval, by the signed-rank test of Wilcoxon on
//! the logarithms of the pairs' ratios (Hodges and Lehmann 1963). Only an interval that lies wholly
//! beyond [`MARGIN`] is a difference.
//!
//! ```
//! use foveal_measure::{Comparison, Finding, Pair, turn};
//! let pairs: Vec<Pair> = (0..24)
//!     .map(|frame| Pair {
//!         reference_ms: 20.0 + 0.1 * (frame % 5) as f64,
//!         chosen_ms: 16.0,
//!         reference_first: turn(frame, 2)[0] == 0,
//!     })
//!     .collect();
//! let found = Comparison::of(&pairs).expect("there are pairs");
//! assert_eq!(found.finding, Finding::Faster);
//! assert!((found.ratio - 20.2 / 16.0).abs() < 0.01);
//! ```
//!
//! No clock, no device, no randomness of its own: the same times give the same answer on every
//! machine.
#![forbid(unsafe_code)]

mod comparison;
mod series;
mod signed_rank;
#[cfg(test)]
mod simulation;
mod spread;
mod turns;

pub use comparison::{CONFIDENCE, Comparison, Finding, MARGIN, Pair};
pub use series::{ENOUGH_PAIRS, LEAST_PAIRS, Series, turn};
pub use spread::{Spread, median, quantile};
pub use turns::{FrameTimes, Turns, WARM_UP};
