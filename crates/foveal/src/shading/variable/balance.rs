//! What variable shading costs and saves, and whether it stays on.

use super::VariablePlan;
use crate::{RateStage, Timing, VariableStats};

/// Frames before the first comparison: the first ones compile shaders and shade in full.
const FIRST: u32 = 3;
/// Comparisons in a row at first, and how many losses in a row turn it off.
const LOSSES: u32 = 3;
/// Frames between later comparisons.
const PERIOD: u32 = 64;
/// Frames for which it stays off.
const REST: u32 = 240;
/// Share of the full cost that must be gained after a rest: more than before it, so that it does
/// not flutter.
const RETURN_GAIN: f64 = 0.05;

/// Compares, in single frames, shading in full with shading at a rate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Balance {
    forced: bool,
    /// Frames since it was switched on, or off.
    frames: u32,
    off: bool,
    rested: bool,
    /// Comparisons to come.
    wanted: u32,
    losses: u32,
    last: VariableStats,
}

impl Balance {
    pub(super) fn new(forced: bool) -> Self {
        Self {
            forced,
            ..Self::default()
        }
    }

    /// What the next frame does.
    pub(super) fn plan(&mut self) -> VariablePlan {
        if self.off && self.frames >= REST {
            (self.off, self.rested, self.frames) = (false, true, 0);
        }
        if !self.off {
            if self.frames == FIRST {
                self.wanted = LOSSES;
            } else if self.frames > 0 && self.frames.is_multiple_of(PERIOD) {
                self.wanted = 1;
            }
        }
        self.frames = self.frames.wrapping_add(1);
        VariablePlan {
            active: !self.off,
            compares: !self.off && self.wanted > 0,
        }
    }

    /// Takes note of what a frame's passes took; gives what is known of cost and gain.
    pub(super) fn observe(&mut self, stage: RateStage, gpu_ms: &[Timing]) -> VariableStats {
        let ms = |name: &str| {
            let passes = gpu_ms.iter().filter(|t| t.name == name);
            passes.map(|t| t.ms).sum::<f64>()
        };
        let last = &mut self.last;
        last.mask_ms = ms("rate mask");
        last.reproject_ms = ms("reprojection");
        last.binning_ms = ms("binning");
        // Sums of nothing are -0.
        for figure in [
            &mut last.mask_ms,
            &mut last.reproject_ms,
            &mut last.binning_ms,
        ] {
            *figure = figure.max(0.0);
        }
        // A later frame's times may stand in for those of the frame that was planned.
        let compared = gpu_ms.iter().any(|t| t.name.starts_with("full "));
        if compared && self.wanted > 0 {
            self.wanted -= 1;
            let (mut full, mut variable) = (0.0, 0.0);
            if stage.has_lighting() {
                full += ms("full shading");
                variable += ms("shading");
            }
            if stage.has_material() {
                full += ms("full binning") + ms("full material");
                variable += ms("binning") + ms("material");
            }
            last.full_ms = full;
            last.variable_ms = variable;
            last.saved_ms = full - variable;
            last.net_ms = last.saved_ms - last.mask_ms - last.reproject_ms;
            let needed = if self.rested { RETURN_GAIN * full } else { 0.0 };
            if last.net_ms < needed {
                self.losses += 1;
            } else {
                (self.losses, self.rested) = (0, false);
            }
            if self.losses >= LOSSES && !self.forced {
                (self.off, self.frames) = (true, 0);
                (self.wanted, self.losses) = (0, 0);
            }
        }
        let mut stats = self.last.clone();
        if self.off {
            stats.notice = format!(
                "variable shading is off: it saves {:.2} ms and costs {:.2} ms; --force-rate true keeps it on",
                stats.saved_ms,
                stats.saved_ms - stats.net_ms
            );
        }
        stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timings(plan: VariablePlan, shading: f64) -> Vec<Timing> {
        let times = [
            ("shading", shading, true),
            ("rate mask", 1.0, plan.active),
            ("full shading", 10.0, plan.compares),
        ];
        let passes = times.iter().filter(|t| t.2);
        passes
            .map(|&(name, ms, _)| Timing {
                name: name.to_owned(),
                ms,
            })
            .collect()
    }

    /// Frames of which `full` of shading in full are 10 ms; gives whether each was active.
    fn run(balance: &mut Balance, frames: u32, shading: f64) -> Vec<bool> {
        (0..frames)
            .map(|_| {
                let plan = balance.plan();
                balance.observe(RateStage::Lighting, &timings(plan, shading));
                plan.active
            })
            .collect()
    }

    #[test]
    fn a_gain_keeps_it_on() {
        let mut balance = Balance::new(false);
        assert!(run(&mut balance, 1000, 6.0).iter().all(|&a| a));
        assert!((balance.last.net_ms - 3.0).abs() < 1e-9);
    }

    #[test]
    fn three_losses_turn_it_off_and_it_comes_back_for_a_clear_gain_alone() {
        let mut balance = Balance::new(false);
        let active = run(&mut balance, 20, 9.5);
        assert_eq!(active.iter().filter(|&&a| a).count() as u32, FIRST + LOSSES);
        assert!(balance.off, "off after {FIRST} + {LOSSES} frames");
        // A gain of 3 % is too small to stay after the rest.
        let later = run(&mut balance, REST + 20, 8.7);
        let tried = later.iter().filter(|&&a| a).count() as u32;
        assert_eq!(tried, FIRST + LOSSES);
        // One of 10 % is enough.
        run(&mut balance, REST, 8.0);
        assert!(run(&mut balance, 500, 8.0).iter().all(|&a| a));
    }

    #[test]
    fn force_keeps_it_on() {
        let mut balance = Balance::new(true);
        assert!(run(&mut balance, 1000, 20.0).iter().all(|&a| a));
    }
}
