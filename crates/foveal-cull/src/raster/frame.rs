//! One frame: the chosen clusters, drawn in their order.
//!
//! Just before a cluster is drawn, its rectangle is tested against the depth so far; one that is hidden there could
//! not have changed anything.

use super::band::Band;
use super::select::Part;
use super::setup::{Facing, Radius, Scratch, draw_cluster};
use crate::Budget;
use crate::occluder::OccluderSet;
use crate::simd::{Kernel, Lanes};

/// Larger rectangles of blocks are not fetched before they are drawn into.
const MOST_FETCHED: u32 = 64;

/// What the set-up of a cluster takes, besides one for each quad, in the unit of
/// [`WORK_OF_FULL`](super::block::WORK_OF_FULL).
const WORK_OF_CLUSTER: u32 = 16;

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

/// Draws the candidates into one band.
pub(crate) struct Draw<'a, 'b> {
    pub(crate) set: &'a OccluderSet,
    pub(crate) frame: &'a FrameScratch,
    pub(crate) band: Band<'b>,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) drawn: Option<&'a mut Vec<u32>>,
    pub(crate) budget: Option<Budget<'a>>,
    pub(crate) radius: Option<Radius>,
}

impl Kernel for Draw<'_, '_> {
    type Output = u64;

    /// Gives the number of clusters that the budget left out.
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> u64 {
        let Self {
            set,
            frame,
            mut band,
            scratch,
            mut drawn,
            budget,
            radius,
        } = self;
        let (row0, row1) = (
            band.first_row as u16,
            (band.first_row + band.rows - 1) as u16,
        );
        for (n, &o) in frame.order.iter().enumerate() {
            let c = &frame.candidates[o as u32 as usize];
            if let Some(b) = budget
                && n % 16 == 0
                && (b.clock)() >= b.deadline_ns
            {
                return (frame.candidates.len() - n) as u64;
            }
            let [x0, y0, x1, y1] = c.blocks;
            let blocks = [x0, y0.max(row0), x1, y1.min(row1)].map(u32::from);
            if blocks[1] > blocks[3] || band.hides(blocks, c.code) {
                continue;
            }
            let instance = &set.instances[c.instance as usize];
            let Some(mesh) = instance.mesh.as_deref() else {
                continue;
            };
            let [x0, y0, x1, y1] = blocks;
            if (x1 + 1 - x0) * (y1 + 1 - y0) <= MOST_FETCHED {
                band.prefetch(l, blocks, c.code);
            }
            if let Some(drawn) = drawn.as_deref_mut() {
                drawn.push(o as u32);
            }
            let cluster = &mesh.clusters[c.cluster as usize];
            let rows = blocks[1] - band.first_row..blocks[3] + 1 - band.first_row;
            let work = WORK_OF_CLUSTER + u32::from(cluster.quad_count);
            band.share(rows, work);
            let facing = Facing {
                mirrored: instance.mirrored,
                two_sided: mesh.two_sided,
                cluster: c.cluster as usize,
                radius,
            };
            draw_cluster(
                l,
                &mut band,
                scratch,
                mesh,
                cluster,
                &frame.rows[c.instance as usize],
                facing,
            );
        }
        0
    }
}

impl Candidate {
    pub(crate) fn place(&self) -> (u32, u32) {
        (self.instance, self.cluster)
    }
}
