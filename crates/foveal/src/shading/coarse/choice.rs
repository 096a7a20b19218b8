//! Which backend is used: the one asked for, or the one that the first frames show to be faster.
//!
//! A device that does not reject fragments early by stencil pays the stencil backend as much as
//! full shading, and no feature flag tells. Both backends give the same bytes, so trying them costs
//! time alone.

use crate::CoarseBackend;
use crate::gpu::Gpu;

/// A backend that can be in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UsedBackend {
    Stencil,
    Compute,
}

impl UsedBackend {
    /// As in the settings.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Stencil => "stencil",
            Self::Compute => "compute",
        }
    }
}

/// Frames per backend that are measured, after one each that compiles its shaders.
const MEASURED: usize = 2;

/// The choice and its reason.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BackendChoice {
    /// Asked for, or nothing to measure with.
    Fixed(UsedBackend, &'static str),
    /// Shading times in milliseconds, backends in turn, stencil first.
    Measuring(Vec<f64>),
    /// Measured: the faster one and both times in milliseconds.
    Measured(UsedBackend, [f64; 2]),
}

impl BackendChoice {
    pub(super) fn new(asked: CoarseBackend, gpu: &Gpu) -> Self {
        match asked {
            CoarseBackend::Stencil => Self::Fixed(UsedBackend::Stencil, "asked for"),
            CoarseBackend::Compute => Self::Fixed(UsedBackend::Compute, "asked for"),
            CoarseBackend::Auto if gpu.tells_times() => Self::Measuring(Vec::new()),
            CoarseBackend::Auto => {
                Self::Fixed(UsedBackend::Compute, "no timestamps to measure with")
            }
        }
    }

    /// What was measured belongs to another scene.
    pub(super) fn start_again(&mut self) {
        if matches!(self, Self::Measured(..)) {
            *self = Self::Measuring(Vec::new());
        }
    }

    /// Whether it stands.
    pub(super) fn is_made(&self) -> bool {
        !matches!(self, Self::Measuring(_))
    }

    /// The backend of the frame at hand.
    pub(crate) fn now(&self) -> UsedBackend {
        match self {
            Self::Fixed(used, _) | Self::Measured(used, _) => *used,
            Self::Measuring(times) if times.len() % 2 == 0 => UsedBackend::Stencil,
            Self::Measuring(_) => UsedBackend::Compute,
        }
    }

    /// Takes note of how long shading took in the frame that [`BackendChoice::now`] was for.
    pub(crate) fn observe(&mut self, shading_ms: f64) {
        let Self::Measuring(times) = self else {
            return;
        };
        times.push(shading_ms);
        if times.len() < 2 * (1 + MEASURED) {
            return;
        }
        let least = |first: usize| {
            times[2..]
                .iter()
                .skip(first)
                .step_by(2)
                .fold(f64::MAX, |a, &b| a.min(b))
        };
        let [stencil, compute] = [least(0), least(1)];
        let faster = if stencil <= compute {
            UsedBackend::Stencil
        } else {
            UsedBackend::Compute
        };
        *self = Self::Measured(faster, [stencil, compute]);
    }

    /// Why this backend, in a few words.
    pub(crate) fn reason(&self) -> String {
        match self {
            Self::Fixed(_, reason) => (*reason).to_owned(),
            Self::Measuring(_) => "measuring".to_owned(),
            Self::Measured(_, [stencil, compute]) => {
                format!("measured: stencil {stencil:.1} ms, compute {compute:.1} ms")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn for_another_scene_what_was_measured_is_measured_again() {
        let mut choice = BackendChoice::Measured(UsedBackend::Stencil, [20.0, 25.0]);
        choice.start_again();
        assert_eq!(choice, BackendChoice::Measuring(Vec::new()));
        let mut asked = BackendChoice::Fixed(UsedBackend::Stencil, "asked for");
        asked.start_again();
        assert!(asked.is_made());
    }

    #[test]
    fn the_faster_backend_is_chosen_whatever_its_compilation_took() {
        let mut choice = BackendChoice::Measuring(Vec::new());
        let mut used = Vec::new();
        for ms in [900.0, 30.0, 20.0, 25.0, 21.0, 26.0] {
            used.push(choice.now());
            choice.observe(ms);
        }
        assert_eq!(used[..2], [UsedBackend::Stencil, UsedBackend::Compute]);
        assert_eq!(
            choice,
            BackendChoice::Measured(UsedBackend::Stencil, [20.0, 25.0])
        );
        assert_eq!(
            choice.reason(),
            "measured: stencil 20.0 ms, compute 25.0 ms"
        );
    }

    #[test]
    fn a_choice_that_was_asked_for_stands() {
        let mut choice = BackendChoice::Fixed(UsedBackend::Compute, "asked for");
        choice.observe(1.0);
        assert_eq!(choice.now(), UsedBackend::Compute);
    }
}
