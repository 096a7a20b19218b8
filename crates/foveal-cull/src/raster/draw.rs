//! Drawing the selected clusters in their order.
//!
//! Just before a cluster is drawn, its rectangle is tested against the depth so far. A cluster
//! hidden there would have changed nothing.

use super::candidates::FrameScratch;
use super::cluster::draw_cluster;
use super::facing::{Facing, ValidityRadius};
use super::scratch::Scratch;
use crate::depth::band::Band;
use crate::occluder::mesh::Cluster;
use crate::occluder::set::OccluderSet;
use crate::options::Budget;
use crate::simd::{Kernel, Lanes};

/// Larger rectangles of blocks are not prefetched.
const MOST_FETCHED: u32 = 64;

/// Work of setting up a cluster, besides one unit for each quad, in the unit of
/// [`WORK_OF_FULL`](super::block::WORK_OF_FULL).
const WORK_OF_CLUSTER: u32 = 16;

/// Work of a cluster besides that of its blocks.
pub(crate) fn work_of(cluster: &Cluster) -> u32 {
    WORK_OF_CLUSTER + u32::from(cluster.quad_count)
}

/// The kernel that draws the candidates into one band.
pub(crate) struct Draw<'a, 'b> {
    pub(crate) set: &'a OccluderSet,
    pub(crate) frame: &'a FrameScratch,
    pub(crate) band: Band<'b>,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) drawn: Option<&'a mut Vec<u32>>,
    pub(crate) budget: Option<Budget<'a>>,
    pub(crate) radius: Option<ValidityRadius>,
}

impl Kernel for Draw<'_, '_> {
    type Output = u64;

    /// Returns the number of clusters that the budget left out.
    #[cfg_attr(not(unoptimized), inline(always))]
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
                return (frame.order.len() - n) as u64;
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
            if let Some(record) = &mut band.record {
                record.candidate = o as u32;
            }
            let cluster = &mesh.clusters[c.cluster as usize];
            let rows = blocks[1] - band.first_row..blocks[3] + 1 - band.first_row;
            band.share(rows, work_of(cluster));
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
