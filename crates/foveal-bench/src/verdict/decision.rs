//! From what was measured of a candidate to what is to be done with it.

use foveal_host::difference::Nearness;
use foveal_measure::{Comparison, Finding};
use serde::Serialize;

use super::candidates::Aim;

/// The mean FLIP error up to which a faster picture is taken for as good.
const MOST_FLIP: f64 = 0.05;

/// The quality from which on it is: one difference that three quarters of observers see.
const LEAST_JOD: f32 = 9.0;

/// What is to be done with a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Decision {
    /// Faster, and near enough.
    Adopt,
    /// Faster, but far from the plain picture.
    FasterButVisible,
    /// No gain.
    Skip,
    /// A better picture in the same time, as far as can be told.
    BetterAsFast,
    /// A better picture that takes longer.
    BetterButSlower,
    /// The device cannot do it.
    Impossible,
}

/// What was found out about a candidate.
#[derive(Debug)]
pub(super) struct Found {
    /// Whole frames by the clock on the wall.
    pub(super) frame: Comparison,
    /// Whole frames by the processor's time, of all threads: where the processor draws, and other
    /// programs take their share of it, that is steadier.
    pub(super) work: Option<Comparison>,
    /// How near the picture is to the plain one. `Err` is what the renderer said of a technique
    /// that turned itself off: what was timed then is another frame than the one that its settings draw.
    pub(super) nearness: Result<Nearness, String>,
}

impl Found {
    /// What decides, and whether it is the processor's time.
    fn deciding(&self) -> (&Comparison, bool) {
        match &self.work {
            Some(work) if !self.frame.differs() && work.differs() => (work, true),
            _ => (&self.frame, false),
        }
    }
}

/// `Err` says why a candidate cannot be drawn.
pub(super) type Measured = Result<Found, String>;

/// Whether a picture is taken for as good as the plain one.
fn is_near(Nearness { flip, jod }: Nearness) -> bool {
    flip <= MOST_FLIP && jod.is_none_or(|jod| jod >= LEAST_JOD)
}

/// What to do, and why, in a sentence.
pub(super) fn decide(aim: Aim, measured: &Measured) -> (Decision, String) {
    let measured = match measured {
        Ok(measured) => measured,
        Err(cause) => return (Decision::Impossible, cause.clone()),
    };
    let (found, is_work) = measured.deciding();
    let subject = if is_work {
        "whole frames by the processor's time"
    } else {
        "whole frames"
    };
    let gain = found.text();
    if found.finding == Finding::TooFew {
        let why = "too few frames were drawn for a verdict";
        return (Decision::Skip, why.to_owned());
    }
    let nearness = match &measured.nearness {
        Ok(nearness) => *nearness,
        Err(notice) => return (Decision::Skip, format!("{subject}: {gain}; {notice}")),
    };
    let Nearness { flip, jod } = nearness;
    let picture = if flip == 0.0 {
        "the picture is the same".to_owned()
    } else {
        let seen = jod.map_or_else(String::new, |jod| format!("{jod:.2} JOD, "));
        format!("{seen}mean FLIP error {flip:.4}")
    };
    match (found.finding, aim) {
        (Finding::Faster, _) if is_near(nearness) => {
            (Decision::Adopt, format!("{subject}: {gain}; {picture}"))
        }
        (Finding::Faster, _) => (
            Decision::FasterButVisible,
            format!("{subject}: {gain}; but {picture}"),
        ),
        (Finding::Slower, Aim::Better) => (
            Decision::BetterButSlower,
            format!("smoother edges; {subject}: {gain}"),
        ),
        (_, Aim::Better) => (
            Decision::BetterAsFast,
            format!("smoother edges; {subject}: {gain}"),
        ),
        (_, Aim::Faster) => (Decision::Skip, format!("{subject}: {gain}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_measure::{Pair, turn};

    fn measured(reference_ms: f64, chosen_ms: f64, flip: f64, frames: u64) -> Measured {
        let pairs: Vec<Pair> = (0..frames)
            .map(|frame| Pair {
                reference_ms,
                chosen_ms,
                reference_first: turn(frame, 2)[0] == 0,
            })
            .collect();
        Ok(Found {
            frame: Comparison::of(&pairs).unwrap(),
            work: None,
            nearness: Ok(Nearness { flip, jod: None }),
        })
    }

    #[test]
    fn a_technique_that_turned_itself_off_is_named_and_not_adopted() {
        // Though what is left of its settings is faster.
        for plain_ms in [20.0, 40.0] {
            let mut found = measured(plain_ms, 20.0, 0.0, 20);
            found.as_mut().unwrap().nearness = Err("coarse shading is off".to_owned());
            let (decision, why) = decide(Aim::Faster, &found);
            assert_eq!(decision, Decision::Skip);
            assert!(why.ends_with("; coarse shading is off"), "{why}");
        }
    }

    #[test]
    fn the_processors_time_decides_where_the_wall_clock_cannot() {
        let both = |frame: Measured, work: Measured| {
            Ok(Found {
                work: Some(work.unwrap().frame),
                ..frame.unwrap()
            })
        };
        let less_work = || measured(20.0, 15.0, 0.0, 20);
        let decided = decide(
            Aim::Faster,
            &both(measured(20.0, 20.0, 0.0, 20), less_work()),
        );
        assert_eq!(decided.0, Decision::Adopt);
        assert!(decided.1.contains("processor"), "{}", decided.1);
        // What the wall clock says holds.
        let slower = both(measured(20.0, 30.0, 0.0, 20), less_work());
        assert_eq!(decide(Aim::Faster, &slower).0, Decision::Skip);
    }

    #[test]
    fn what_the_eye_sees_is_looked_at_first() {
        for (jod, expected) in [(9.2, Decision::Adopt), (8.9, Decision::FasterButVisible)] {
            let mut found = measured(20.0, 10.0, 0.01, 20);
            let jod = Some(jod);
            found.as_mut().unwrap().nearness = Ok(Nearness { flip: 0.01, jod });
            let (decision, why) = decide(Aim::Faster, &found);
            assert_eq!(decision, expected, "{why}");
            assert!(why.contains(" JOD, mean FLIP error 0.0100"), "{why}");
        }
    }

    #[test]
    fn only_what_is_faster_and_near_is_adopted() {
        for (measured, aim, expected) in [
            (measured(20.0, 10.0, 0.0, 20), Aim::Faster, Decision::Adopt),
            (measured(20.0, 10.0, 0.01, 20), Aim::Better, Decision::Adopt),
            (
                measured(20.0, 10.0, 0.2, 20),
                Aim::Faster,
                Decision::FasterButVisible,
            ),
            (measured(20.0, 20.0, 0.0, 20), Aim::Faster, Decision::Skip),
            (measured(10.0, 20.0, 0.0, 20), Aim::Faster, Decision::Skip),
            (
                measured(10.0, 20.0, 0.1, 20),
                Aim::Better,
                Decision::BetterButSlower,
            ),
            (
                measured(20.0, 20.0, 0.1, 20),
                Aim::Better,
                Decision::BetterAsFast,
            ),
            (measured(20.0, 10.0, 0.0, 9), Aim::Faster, Decision::Skip),
            (Err("no".to_owned()), Aim::Faster, Decision::Impossible),
        ] {
            assert_eq!(decide(aim, &measured).0, expected, "{measured:?}");
        }
    }
}
