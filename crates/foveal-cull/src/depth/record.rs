//! A record of what each cluster changed, for learning what clusters are worth.

/// Some neighbouring blocks that one polygon of a cluster changed, or may have changed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touched {
    /// Number of the candidate.
    pub(crate) candidate: u32,
    /// Row of blocks, and the first and the last block in it.
    pub(crate) row: u16,
    pub(crate) first: u16,
    pub(crate) last: u16,
    pub(crate) work: u16,
}

/// Where a thread writes its record.
#[derive(Debug)]
pub(crate) struct Record<'a> {
    pub(crate) touched: &'a mut Vec<Touched>,
    /// The candidate that is being drawn.
    pub(crate) candidate: u32,
}

impl Record<'_> {
    #[inline(never)]
    pub(crate) fn add(&mut self, row: u32, blocks: [u32; 2], work: u32) {
        self.touched.push(Touched {
            candidate: self.candidate,
            row: row as u16,
            first: blocks[0] as u16,
            last: blocks[1] as u16,
            work: work.min(u32::from(u16::MAX)) as u16,
        });
    }
}
