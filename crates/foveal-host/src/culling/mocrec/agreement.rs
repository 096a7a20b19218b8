//! A recording's results beside this culler's.

use foveal_cull::Visibility;
use serde::Serialize;

use super::read::Verdict;

/// What a recording says of a query, and whether that question could be asked again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Recorded {
    /// What the recorder answered.
    pub verdict: Verdict,
}

/// A recording's answers beside this culler's.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Agreement {
    /// All of them.
    pub queries: u64,
    /// Recorded as visible.
    pub recorded_visible: u64,
    /// Recorded as occluded.
    pub recorded_occluded: u64,
    /// Recorded as outside the frustum.
    pub recorded_view_culled: u64,
    /// Both say visible, or both say culled.
    pub agree: u64,
    /// Recorded as occluded or view-culled, visible here.
    pub kept_here: u64,
    /// Recorded as visible, culled here.
    pub culled_here: u64,
}

impl Agreement {
    /// Counts; `None` without recorded answers.
    pub fn of(recorded: &[Recorded], results: &[Visibility]) -> Option<Self> {
        let mut a = Self::default();
        for (recorded, result) in recorded.iter().zip(results) {
            a.queries += 1;
            match recorded.verdict {
                Verdict::Visible => a.recorded_visible += 1,
                Verdict::Occluded => a.recorded_occluded += 1,
                Verdict::ViewCulled => a.recorded_view_culled += 1,
                Verdict::Unknown => continue,
            }
            match (recorded.verdict == Verdict::Visible, result.is_visible()) {
                (true, false) => a.culled_here += 1,
                (false, true) => a.kept_here += 1,
                _ => a.agree += 1,
            }
        }
        (a.queries > 0).then_some(a)
    }
}
