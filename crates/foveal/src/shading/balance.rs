//! Whether shading at rates stays on: what it saves against what it costs.

use crate::Timing;

/// How many comparisons in a row decide.
const LOSSES: u32 = 3;
/// Frames between later comparisons.
const PERIOD: u32 = 64;
/// Frames for which it stays off.
const REST: u32 = 240;
/// Share of the full cost that must be gained after a rest: more than before it, so that it does
/// not flutter.
const RETURN_GAIN: f64 = 0.05;

/// What a frame does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct RatePlan {
    /// Shades at rates; else in full.
    pub(crate) active: bool,
    /// Shades in full besides, to compare.
    pub(crate) compares: bool,
}

/// A frame's times in milliseconds that were taken for comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Compared {
    /// The stages that run at rates, in full.
    pub(crate) full_ms: f64,
    /// The same at rates.
    pub(crate) rated_ms: f64,
    /// What shading at rates needs besides.
    pub(crate) extra_ms: f64,
}

impl Compared {
    /// From the times of a frame's passes, where it shaded in full besides. `lighting` and
    /// `material` say what runs at rates; the passes `extra` are what that needs besides.
    pub(crate) fn find(
        gpu_ms: &[Timing],
        (lighting, material): (bool, bool),
        extra: &[&str],
    ) -> Option<Self> {
        if !gpu_ms.iter().any(|t| t.name.starts_with("full ")) {
            return None;
        }
        let mut compared = Self {
            extra_ms: extra.iter().map(|name| sum_ms(gpu_ms, name)).sum(),
            ..Self::default()
        };
        let stages = [
            (lighting, "shading"),
            (material, "binning"),
            (material, "material"),
        ];
        for (_, name) in stages.iter().filter(|(runs, _)| *runs) {
            compared.rated_ms += sum_ms(gpu_ms, name);
            compared.full_ms += sum_ms(gpu_ms, &format!("full {name}"));
        }
        Some(compared)
    }

    /// What is saved on the whole.
    pub(crate) fn net_ms(self) -> f64 {
        self.full_ms - self.rated_ms - self.extra_ms
    }
}

/// Time of all passes of a name.
pub(crate) fn sum_ms(gpu_ms: &[Timing], name: &str) -> f64 {
    // A sum of nothing is -0.
    gpu_ms
        .iter()
        .filter(|t| t.name == name)
        .fold(0.0, |sum, t| sum + t.ms)
}

/// Compares, in single frames, shading in full with shading at rates.
#[derive(Clone, Debug)]
pub(crate) struct Balance {
    forced: bool,
    /// Passes tell how long they take, and somebody wants to know.
    compares: bool,
    /// Frames before the first comparison: the first ones compile shaders and shade in full.
    first: u32,
    /// Frames since it was switched on, or off.
    frames: u32,
    off: bool,
    rested: bool,
    /// Comparisons to come.
    wanted: u32,
    losses: u32,
    last: Compared,
}

impl Balance {
    /// `forced`: it stays on. The first `first` frames are not compared, and none without
    /// `compares`: where passes do not tell how long they take, that would never end.
    pub(crate) fn new(forced: bool, first: u32, compares: bool) -> Self {
        Self {
            forced,
            compares,
            first,
            frames: 0,
            off: false,
            rested: false,
            wanted: 0,
            losses: 0,
            last: Compared::default(),
        }
    }

    /// As after losses: off for the usual time.
    #[cfg(test)]
    pub(crate) fn turned_off() -> Self {
        Self {
            off: true,
            ..Self::new(false, 0, true)
        }
    }

    /// What the next frame does.
    pub(crate) fn plan(&mut self) -> RatePlan {
        if self.off && self.frames >= REST {
            (self.off, self.rested, self.frames) = (false, true, 0);
        }
        if !self.off && self.compares {
            if self.frames == self.first {
                self.wanted = LOSSES;
            } else if self.frames > self.first && self.frames.is_multiple_of(PERIOD) {
                self.wanted = self.wanted.max(1);
            }
        }
        self.frames = self.frames.wrapping_add(1);
        RatePlan {
            active: !self.off,
            compares: !self.off && self.wanted > 0,
        }
    }

    /// Forgets what was measured: another scene or size costs another time.
    pub(crate) fn start_again(&mut self) {
        *self = Self::new(self.forced, self.first, self.compares);
    }

    /// Whether frames are shaded in full.
    pub(crate) fn is_off(&self) -> bool {
        self.off
    }

    /// Takes note of a comparison.
    pub(crate) fn observe(&mut self, compared: Compared) {
        // A later frame's times may stand in for those of the frame that was planned.
        if self.wanted == 0 {
            return;
        }
        self.wanted -= 1;
        self.last = compared;
        let needed = if self.rested {
            RETURN_GAIN * compared.full_ms
        } else {
            0.0
        };
        if compared.net_ms() < needed {
            // A loss is looked into at once.
            self.losses += 1;
            self.wanted = self.wanted.max(1);
        } else {
            (self.losses, self.rested) = (0, false);
        }
        if self.losses >= LOSSES && !self.forced {
            (self.off, self.frames) = (true, 0);
            (self.wanted, self.losses) = (0, 0);
        } else if self.losses >= LOSSES {
            (self.wanted, self.losses) = (0, 0);
        }
    }

    /// The last comparison.
    pub(crate) fn last(&self) -> Compared {
        self.last
    }

    /// A sentence where `what` is off; else empty.
    pub(crate) fn notice(&self, what: &str) -> String {
        if !self.off {
            return String::new();
        }
        let Compared {
            full_ms,
            rated_ms,
            extra_ms,
        } = self.last;
        format!(
            "{what} is off: it saves {:.2} ms and costs {extra_ms:.2} ms; --force-rate true keeps it on",
            full_ms - rated_ms
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST: u32 = 3;

    /// Frames of which `full` of shading in full are 10 ms and the mask's cost is 1 ms; gives
    /// whether each was active, and how many of them compared.
    fn run(balance: &mut Balance, frames: u32, rated_ms: impl Fn(u32) -> f64) -> (Vec<bool>, u32) {
        let mut comparisons = 0;
        let active = (0..frames).map(|frame| {
            let plan = balance.plan();
            if plan.compares {
                comparisons += 1;
                balance.observe(Compared {
                    full_ms: 10.0,
                    rated_ms: rated_ms(frame),
                    extra_ms: 1.0,
                });
            }
            plan.active
        });
        (active.collect(), comparisons)
    }

    fn active(frames: &[bool]) -> u32 {
        frames.iter().filter(|&&active| active).count() as u32
    }

    #[test]
    fn a_gain_keeps_it_on_and_is_looked_at_now_and_then() {
        let mut balance = Balance::new(false, FIRST, true);
        let (frames, comparisons) = run(&mut balance, 1000, |_| 6.0);
        assert_eq!(active(&frames), 1000);
        assert!((balance.last().net_ms() - 3.0).abs() < 1e-9);
        assert_eq!(comparisons, LOSSES + 999 / PERIOD);
        assert!(balance.notice("it").is_empty());
    }

    #[test]
    fn three_losses_turn_it_off_and_it_comes_back_for_a_clear_gain_alone() {
        let mut balance = Balance::new(false, FIRST, true);
        let (frames, _) = run(&mut balance, 20, |_| 9.5);
        assert_eq!(active(&frames), FIRST + LOSSES);
        assert!(balance.is_off(), "off after {FIRST} + {LOSSES} frames");
        assert!(
            balance
                .notice("it")
                .contains("saves 0.50 ms and costs 1.00 ms")
        );
        // A gain of 3 % is too small to stay after the rest.
        let (later, _) = run(&mut balance, REST + 20, |_| 8.7);
        assert_eq!(active(&later), FIRST + LOSSES);
        // One of 10 % is enough.
        run(&mut balance, REST, |_| 8.0);
        assert_eq!(active(&run(&mut balance, 500, |_| 8.0).0), 500);
    }

    #[test]
    fn a_first_comparison_that_compiles_shaders_does_not_keep_a_loss_on() {
        let mut balance = Balance::new(false, FIRST, true);
        let slow_once = |frame| if frame == FIRST { -500.0 } else { 9.5 };
        let (frames, _) = run(&mut balance, 20, slow_once);
        assert_eq!(active(&frames), FIRST + LOSSES + 1);
    }

    #[test]
    fn what_becomes_a_loss_later_is_off_within_a_period() {
        let mut balance = Balance::new(false, FIRST, true);
        assert_eq!(active(&run(&mut balance, 200, |_| 6.0).0), 200);
        let (frames, _) = run(&mut balance, PERIOD + LOSSES, |_| 9.5);
        assert!(!frames[frames.len() - 1]);
    }

    #[test]
    fn without_times_nothing_is_compared() {
        let mut balance = Balance::new(false, FIRST, false);
        for _ in 0..1000 {
            let plan = balance.plan();
            assert!(plan.active && !plan.compares);
        }
    }

    #[test]
    fn another_scene_is_measured_anew() {
        let mut balance = Balance::new(false, FIRST, true);
        run(&mut balance, 20, |_| 9.5);
        assert!(balance.is_off());
        balance.start_again();
        assert!(!balance.is_off() && balance.notice("it").is_empty());
        assert_eq!(balance.last(), Compared::default());
    }

    #[test]
    fn stages_that_do_not_run_at_rates_do_not_count() {
        let timing = |name: &str, ms| Timing {
            name: name.to_owned(),
            ms,
        };
        let mut passes = vec![
            timing("shading", 1.0),
            timing("shading", 2.0),
            timing("binning", 4.0),
            timing("material", 8.0),
            timing("rate mask", 16.0),
        ];
        assert_eq!(Compared::find(&passes, (true, true), &["rate mask"]), None);
        passes.extend([
            timing("full shading", 30.0),
            timing("full binning", 40.0),
            timing("full material", 50.0),
        ]);
        let found = |runs| Compared::find(&passes, runs, &["rate mask", "reprojection"]).unwrap();
        let all = found((true, true));
        assert_eq!(
            all,
            Compared {
                full_ms: 120.0,
                rated_ms: 15.0,
                extra_ms: 16.0
            }
        );
        assert!((all.net_ms() - 89.0).abs() < 1e-9);
        assert_eq!(found((true, false)).rated_ms, 3.0);
        assert_eq!(found((false, true)).full_ms, 90.0);
    }

    #[test]
    fn force_keeps_it_on_and_does_not_compare_all_the_time() {
        let mut balance = Balance::new(true, FIRST, true);
        let (frames, comparisons) = run(&mut balance, 1000, |_| 20.0);
        assert_eq!(active(&frames), 1000);
        assert!(comparisons <= LOSSES * (2 + 1000 / PERIOD), "{comparisons}");
    }
}
