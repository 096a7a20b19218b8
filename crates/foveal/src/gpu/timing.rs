//! How long stages take on the CPU.

use crate::clock::{self, ms_between};
use crate::{Clock, Timing};

/// Names the stages of a frame's CPU work; silent without a clock.
pub(crate) struct CpuTimer {
    clock: Option<Clock>,
    last_ns: u64,
    start_ns: u64,
    stages: Vec<Timing>,
}

impl CpuTimer {
    pub(crate) fn start(clock: Option<Clock>) -> Self {
        let now = clock::read(clock);
        Self {
            clock,
            last_ns: now,
            start_ns: now,
            stages: Vec::new(),
        }
    }

    /// Ends the stage that began with the last call.
    pub(crate) fn stage(&mut self, name: &str) {
        if let Some(clock) = self.clock {
            let now = clock();
            self.stages.push(Timing {
                name: name.to_owned(),
                ms: ms_between(self.last_ns, now),
            });
            self.last_ns = now;
        }
    }

    pub(crate) fn stages(&self) -> Vec<Timing> {
        self.stages.clone()
    }

    pub(crate) fn since_start_ms(&self) -> f64 {
        self.clock
            .map_or(0.0, |now| ms_between(self.start_ns, now()))
    }
}
