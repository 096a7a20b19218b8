//! Clusters that may be drawn in a frame, and the lists that hold them.

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

/// Lists of a frame. They keep their memory from frame to frame, so that nothing is allocated.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameScratch {
    pub(crate) candidates: Vec<Candidate>,
    /// Drawing order: the bits of the nearest distance, then the index of the candidate.
    pub(super) order: Vec<u64>,
    /// Where the best candidates are chosen.
    pub(super) worths: Vec<Worth>,
    /// Clip rows per instance.
    pub(crate) rows: Vec<[[f64; 4]; 4]>,
    /// Candidates found by each part of the selection.
    pub(crate) parts: Vec<Part>,
}

/// What a candidate is worth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worth {
    /// What it hides for its work, if that is known.
    pub(super) hides: Option<f32>,
    pub(super) work: f32,
    /// Its entry in the order of drawing.
    pub(super) order: u64,
}

/// Candidates among some of the clusters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub(super) candidates: Vec<Candidate>,
    pub(super) order: Vec<u64>,
    /// Instances that may be on the screen, by their place in the part.
    pub(super) near: Vec<u32>,
    /// Stats of the clusters looked at.
    pub(super) stats: CullStats,
}

impl Part {
    /// Empties the lists.
    pub(super) fn clear(&mut self) {
        self.candidates.clear();
        self.order.clear();
        self.near.clear();
        self.stats = CullStats::default();
    }
}

impl Candidate {
    pub(crate) fn place(&self) -> (u32, u32) {
        (self.instance, self.cluster)
    }
}
