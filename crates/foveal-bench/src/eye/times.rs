//! Whole frames of each way against full shading, drawn in turn.

use foveal::Settings;
use foveal_measure::{Comparison, Finding, median, turn};
use serde::Serialize;

use super::studio::Studio;
use crate::subject::WARM_UP;
use foveal_host::drawing::{Drawing, moment};

/// A way's whole frames; times are medians in milliseconds.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Timed {
    pub(super) full_frame_ms: f64,
    pub(super) frame_ms: f64,
    /// Full / this: above 1 this is faster; with its interval where there are rounds enough.
    pub(super) frame_ratio: f64,
    pub(super) frame_ratio_low: Option<f64>,
    pub(super) frame_ratio_high: Option<f64>,
    pub(super) finding: Finding,
    pub(super) pairs: usize,
}

/// A way while it is measured.
struct Side {
    drawing: Drawing,
    frame_ms: Vec<f64>,
}

/// Times of ways against full shading; what several displays share is measured once.
#[derive(Default)]
pub(super) struct Times {
    known: Vec<(Settings, Timed)>,
}

impl Times {
    /// Measures those of `chosen` that are not known yet.
    pub(super) fn measure(
        &mut self,
        studio: &Studio<'_>,
        full: &Settings,
        chosen: &[Settings],
        (rounds, fps): (u32, f32),
    ) -> anyhow::Result<()> {
        let is_new = |settings: &&Settings| *settings != full && self.of(settings).is_none();
        let new: Vec<&Settings> = chosen.iter().filter(is_new).collect();
        let mut sides = std::iter::once(full)
            .chain(new.iter().copied())
            .map(|settings| {
                Ok(Side {
                    drawing: studio.along(settings)?,
                    frame_ms: Vec::new(),
                })
            })
            .collect::<anyhow::Result<Vec<Side>>>()?;
        // All that is measured moves: what is kept from frame to frame costs nothing at rest.
        let at = |frame: u32| moment(frame, fps);
        for frame in 1..=WARM_UP {
            for side in &mut sides {
                side.drawing.draw_moment(at(frame), at(frame - 1))?;
            }
        }
        let count = sides.len();
        for round in 0..u64::from(rounds) {
            for number in turn(round, count) {
                let side = &mut sides[number];
                let frame = WARM_UP + 1 + round as u32;
                let stats = side.drawing.draw_moment(at(frame), at(frame - 1))?;
                side.frame_ms.push(stats.frame_ms);
            }
        }
        let full_ms = &sides[0].frame_ms;
        for (number, settings) in (1..).zip(new) {
            let ms = &sides[number].frame_ms;
            let Some(found) = Comparison::of_rounds(count, (0, full_ms), (number, ms)) else {
                continue;
            };
            let timed = Timed {
                full_frame_ms: median(full_ms),
                frame_ms: median(ms),
                frame_ratio: found.ratio,
                frame_ratio_low: found.interval.map(|ends| ends[0]),
                frame_ratio_high: found.interval.map(|ends| ends[1]),
                finding: found.finding,
                pairs: found.pairs,
            };
            self.known.push((settings.clone(), timed));
        }
        Ok(())
    }

    /// What was measured of these settings.
    pub(super) fn of(&self, settings: &Settings) -> Option<&Timed> {
        let found = self.known.iter().find(|(known, _)| known == settings);
        found.map(|(_, timed)| timed)
    }
}
