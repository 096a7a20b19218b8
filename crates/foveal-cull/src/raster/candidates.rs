//! Candidates

use crate::stats::CullStats;

/// A cluster that may be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Content hash: decides between equal distances.
    pub(super) hash: u32,
    pub(super) instance: u32,
    pub(super) cluster: u32,
    /// First and last block, inclusive.
    pub(super) blocks: [u16; 4],
    pub(super) code: i16,
    /// Its box crosses the near plane.
    pub(super) crossing: bool,
}

/// What the frame keeps between its two steps, and from frame to frame (so nothing is allocated).
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameScratch {
    pub(crate) candidates: Vec<Candidate>,
    /// The order of drawing: the bits of the nearest distance, then the number of the candidate.
    pub(super) order: Vec<u64>,
    /// Clip rows per instance.
    pub(crate) rows: Vec<[[f64; 4]; 4]>,
    /// What each thread finds.
    pub(crate) parts: Vec<Part>,
}

/// Candidates from some of the clusters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub(super) candidates: Vec<Candidate>,
    pub(super) order: Vec<u64>,
    /// Counts of what was looked at.
    pub(super) stats: CullStats,
}

impl Candidate {
    pub(crate) fn place(&self) -> (u32, u32) {
        (self.instance, self.cluster)
    }
}
