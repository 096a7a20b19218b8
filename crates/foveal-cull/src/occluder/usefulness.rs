//! Which occluders are worth their time, learned from frame to frame.
//!
//! Rasterizing leaves a record: which cluster has changed which blocks of the buffer. Hidden boxes
//! are laid over it. A cluster that changed a block within the rectangle of a hidden box has helped
//! to hide it; one that never does is left out, and drawn again now and then. That changes
//! results to the safe side only: what is not drawn hides nothing.

use super::set::Instance;
use core::num::NonZeroU32;

/// Idle count of a cluster from which on it is left out. Each frame in which a cluster is drawn and
/// hides nothing adds 1, or [`IDLE_STEP`] if all hidden boxes of that frame were looked at.
const IDLE_LIMIT: u8 = 24;
const IDLE_STEP: u8 = 4;
/// Frames for which a cluster that was left out is drawn again, where not all hidden boxes are
/// looked at; where all are, one frame tells.
const RETRY_FRAMES: u8 = 2;
/// A cluster that is left out is drawn again this many frames after it was drawn last, and fewer
/// than [`RETRY_RANGE`] later by its number, so that not all come back in the same frame.
const RETRY_AFTER: u32 = 12;
const RETRY_RANGE: u32 = 16;
/// Frames after its last drawing when what is known of a cluster is forgotten.
const FORGET_AFTER: u32 = 1000;
/// Weight of the latest frame in moving averages.
const LATEST_WEIGHT: f32 = 0.125;
/// Part of the time that is left for which work is planned.
const PLANNED_PART: f64 = 0.9;
/// Largest time per unit of work that a frame counts with in the average, as a multiple of it.
const LARGEST_OUTLIER: f64 = 4.0;
/// Work that is expected for each block of a cluster that was never drawn.
const BLOCK_WORK: f32 = 2.0;

/// What each cluster of the occluders was worth in the frames before.
///
/// Many occluders hide nothing that is asked for: floors and outer walls with nothing behind them.
/// In each frame: rasterize with [`FrameOptions::usefulness`](crate::FrameOptions::usefulness), query,
/// [`observe`](Self::observe) the results, and [`learn`](Self::learn). Clusters (up to 64 quads of an
/// occluder) that helped to hide no box for 6 to 24 frames are then left out, and looked at again after
/// 12 to 28 frames. With a [`Budget`](crate::Budget) those are drawn that hide most for their time,
/// instead of the nearest ones.
///
/// Results stay safe: what is left out hides nothing. They depend on the frames before, so call
/// [`forget`](Self::forget) where the camera is cut to another place. Where more than 256 boxes are
/// hidden, what hides few of them may be left out too. One object serves one culler. `learn` takes
/// about as long as a tenth of rasterizing; a cluster takes 16 bytes, and a frame's record 12 for
/// each row of blocks of a polygon.
///
/// ```
/// use foveal_cull::*;
/// use std::sync::Arc;
///
/// // A wall with a box behind it, and another wall with nothing behind it.
/// let wall = Arc::new(OccluderMesh::from_box(Aabb::new([-2.0, -1.0, -0.1], [2.0, 1.0, 0.1]))?);
/// let mut occluders = OccluderSet::new();
/// occluders.add(wall.clone(), Affine::from_translation([-2.5, 0.0, -5.0]))?;
/// occluders.add(wall, Affine::from_translation([2.5, 0.0, -5.0]))?;
/// let boxes = [Aabb::new([-3.0, -0.5, -9.0], [-2.0, 0.5, -8.0])];
///
/// let view = View::perspective([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.2, 1.78, 0.1);
/// let mut culler = Culler::new(320, 180)?;
/// let mut usefulness = OccluderUsefulness::new();
/// let mut results = [Visibility::Visible];
/// for _ in 0..30 {
///     let options = FrameOptions::default().with_usefulness(Some(&usefulness));
///     culler.rasterize(&view, &occluders, &options, &SingleThread)?;
///     culler.query(&boxes, [0.0; 3], &mut results)?;
///     assert_eq!(results, [Visibility::Occluded]);
///     usefulness.observe(&culler, &boxes, [0.0; 3], &results)?;
///     usefulness.learn(&culler, &occluders);
/// }
/// assert_eq!(culler.stats().occluder_models_rasterized, 1);
/// # Ok::<(), CullError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct OccluderUsefulness {
    frame: u32,
    slots: Vec<Slot>,
    entries: Vec<Entry>,
    /// Nanoseconds that a unit of work takes; 0 where not known.
    unit_ns: f64,
    /// Boxes that were observed since the last frame was learned.
    pub(crate) observed: ObservedBoxes,
    /// What each candidate did, while a frame is learned; none for those that were not drawn.
    pub(crate) outcomes: Vec<Option<Outcome>>,
}

/// Hidden boxes of a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObservedBoxes {
    /// Number of hidden boxes over each block, as differences along rows that are one longer than
    /// the buffer's.
    pub(crate) box_counts: Vec<i32>,
    /// Blocks of the buffer across and down.
    pub(crate) blocks: [u32; 2],
    /// The box with which the next frame begins, for each call of
    /// [`observe`](OccluderUsefulness::observe) within a frame.
    pub(crate) first_boxes: Vec<usize>,
    /// Calls since the last frame was learned.
    pub(crate) calls: usize,
    /// Whether results were observed since the last frame was learned.
    pub(crate) has_results: bool,
    /// Whether all hidden boxes among them were looked at.
    pub(crate) has_all_hidden: bool,
}

/// The clusters of one slot of the set.
#[derive(Clone, Copy, Debug)]
struct Slot {
    /// None where no occluder is known.
    generation: Option<NonZeroU32>,
    first_entry: u32,
    /// Number of clusters, with an entry each.
    count: u32,
    /// Number of entries that belong to the slot.
    capacity: u32,
}

/// What is known about one cluster.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// The frame in which it was drawn last; 0 if never.
    drawn: u32,
    /// Idle count: see [`IDLE_LIMIT`].
    idle: u8,
    /// Moving averages of [`Outcome::hidden_blocks`] and of [`Outcome::work`].
    hidden_blocks: f32,
    work: f32,
}

/// What one cluster did in a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Blocks that it changed, once for each hidden box over them.
    pub(crate) hidden_blocks: u32,
    /// Work that drawing it took, in the rasterizer's units.
    pub(crate) work: u32,
}

impl OccluderUsefulness {
    /// Nothing is known: all occluders are drawn.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets all that was learned, for instance when the camera is cut to another place.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Whether a cluster is to be drawn.
    pub(crate) fn wants(&self, slot: usize, instance: &Instance, cluster: usize) -> bool {
        self.entry(slot, instance, cluster).is_none_or(|e| {
            e.idle < IDLE_LIMIT || {
                let further = (slot + cluster) as u32 % RETRY_RANGE;
                self.frame.wrapping_sub(e.drawn) >= RETRY_AFTER + further
            }
        })
    }

    /// What a cluster hides for its work, if that is known, and the work.
    pub(crate) fn worth(
        &self,
        slot: usize,
        instance: &Instance,
        cluster: usize,
        blocks: u32,
    ) -> (Option<f32>, f32) {
        match self.entry(slot, instance, cluster) {
            // What a cluster hid so long ago says little.
            Some(e) if e.drawn > 0 && self.frame.wrapping_sub(e.drawn) < RETRY_AFTER => {
                (Some(e.hidden_blocks / e.work.max(1.0)), e.work)
            }
            _ => (None, BLOCK_WORK * blocks as f32),
        }
    }

    /// The work that fits into so many nanoseconds; none if that is not known.
    pub(crate) fn work_within(&self, ns: u64) -> Option<f64> {
        (self.unit_ns > 0.0).then(|| PLANNED_PART * ns as f64 / self.unit_ns)
    }

    /// Learns the time of a unit of work from a frame that took `ns` nanoseconds for `work`. A
    /// frame that something else held up counts as [`LARGEST_OUTLIER`] times the average at most.
    pub(crate) fn learn_unit_time(&mut self, ns: u64, work: u64) {
        if work == 0 {
            // Nothing is drawn any more: perhaps it takes less than is thought.
            self.unit_ns *= 1.0 - f64::from(LATEST_WEIGHT);
        } else if ns > 0 {
            let unit = ns as f64 / work as f64;
            self.unit_ns = if self.unit_ns > 0.0 {
                let unit = unit.min(LARGEST_OUTLIER * self.unit_ns);
                self.unit_ns + (unit - self.unit_ns) * f64::from(LATEST_WEIGHT)
            } else {
                unit
            };
        }
    }

    /// The one of `count` clusters of which nothing is known that this frame tries first.
    pub(crate) fn first_unknown(&self, count: usize) -> usize {
        (self.frame as usize).wrapping_mul(7) % count.max(1)
    }

    /// The number of the first entry of an occluder, whose clusters' entries follow each other. New
    /// entries for an occluder that has none yet, or other clusters than before.
    pub(crate) fn make_entries(&mut self, slot: usize, instance: &Instance) -> usize {
        if self.slots.len() <= slot {
            self.slots.resize(slot + 1, Slot::NONE);
        }
        let to = &mut self.slots[slot];
        let count = instance.clusters;
        if to.generation != Some(instance.generation()) || to.count != count {
            if to.capacity < count {
                to.first_entry = self.entries.len() as u32;
                let end = self.entries.len() + count as usize;
                self.entries.resize(end, Entry::default());
                to.capacity = count;
            }
            to.generation = Some(instance.generation());
            to.count = count;
            let first = to.first_entry as usize;
            self.entries[first..first + count as usize].fill(Entry::default());
        }
        to.first_entry as usize
    }

    /// Adds to an entry what its cluster did in this frame.
    pub(crate) fn add_outcome(&mut self, entry: usize, outcome: Outcome) {
        let has_all = self.observed.has_all_hidden;
        let frame = self.frame;
        let e = &mut self.entries[entry];
        let (hidden_blocks, work) = (outcome.hidden_blocks as f32, outcome.work as f32);
        let is_new = e.drawn == 0 || frame.wrapping_sub(e.drawn) > FORGET_AFTER;
        if is_new {
            *e = Entry {
                hidden_blocks,
                work,
                ..Entry::default()
            };
        }
        // One that was left out: it is drawn for a frame if that tells all, else for some.
        if frame.wrapping_sub(e.drawn) >= RETRY_AFTER {
            let retry = if has_all { IDLE_STEP } else { RETRY_FRAMES };
            e.idle = e.idle.min(IDLE_LIMIT - retry);
        }
        e.hidden_blocks += (hidden_blocks - e.hidden_blocks) * LATEST_WEIGHT;
        e.work += (work - e.work) * LATEST_WEIGHT;
        e.idle = if outcome.hidden_blocks > 0 {
            0
        } else {
            e.idle.saturating_add(if has_all { IDLE_STEP } else { 1 })
        };
        e.drawn = frame;
    }

    /// Counts a frame that is learned. The first is number 1.
    pub(crate) fn count_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1).max(1);
    }

    fn entry(&self, slot: usize, instance: &Instance, cluster: usize) -> Option<&Entry> {
        let s = self.slots.get(slot)?;
        let known = s.generation == Some(instance.generation()) && cluster < s.count as usize;
        known.then(|| &self.entries[s.first_entry as usize + cluster])
    }
}

impl Slot {
    const NONE: Self = Self {
        generation: None,
        first_entry: 0,
        count: 0,
        capacity: 0,
    };
}
