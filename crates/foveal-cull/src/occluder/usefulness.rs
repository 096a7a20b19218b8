//! Which occluders are worth their time, learned from frame to frame.
//!
//! Rasterizing leaves a record: which cluster has changed which blocks of the buffer. Hidden boxes
//! are laid over it. A cluster that changed a block within the rectangle of a hidden box has helped
//! to hide it; one that never does is left out, and looked at again now and then. That changes
//! results to the safe side only: what is not drawn hides nothing.

use super::set::Instance;
use core::num::NonZeroU32;

/// A cluster is left out after so many frames in which it was drawn and has hidden nothing; a frame
/// in which all hidden boxes were looked at counts as [`STEP`].
const PATIENCE: u8 = 24;
const STEP: u8 = 4;
/// Frames for which it is looked at again where not all hidden boxes are looked at.
const AGAIN: u8 = 2;
/// It is drawn again after so many frames, and as many more as its number says, so that not all
/// come back in the same frame.
const PAUSE: u32 = 12;
const STAGGER: u32 = 16;
/// What was known of one that was not drawn for so many frames is forgotten.
const ABSENCE: u32 = 1000;
/// How fast averages over frames follow.
const FOLLOW: f32 = 0.125;
/// Part of the time that is left which is planned for.
const PLANNED: f64 = 0.9;
/// How many times the usual time a frame counts at most.
const MOST_HELD_UP: f64 = 4.0;
/// Work that is expected of a block of a cluster that was never drawn.
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
    pub(crate) observed: Observed,
    /// What each candidate did, while a frame is learned; none for those that were not drawn.
    pub(crate) done: Vec<Option<Done>>,
}

/// Hidden boxes of a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Observed {
    /// Boxes over each block, as differences along rows that are one longer than the buffer's.
    pub(crate) over: Vec<i32>,
    /// Blocks of the buffer across and down.
    pub(crate) blocks: [u32; 2],
    /// Where the next frame begins to look, by the call within a frame.
    pub(crate) turns: Vec<usize>,
    /// Calls since the last frame was learned.
    pub(crate) calls: usize,
    /// Whether results were observed at all.
    pub(crate) any: bool,
    /// Whether all hidden boxes were looked at.
    pub(crate) all: bool,
}

/// The clusters of one slot of the set.
#[derive(Clone, Copy, Debug)]
struct Slot {
    /// None where no occluder is known.
    generation: Option<NonZeroU32>,
    first: u32,
    count: u32,
    /// Entries that there is room for.
    room: u32,
}

/// What is known about one cluster.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// The frame in which it was drawn last; 0 if never.
    drawn: u32,
    /// Frames since it hid something, of those in which it was drawn.
    idle: u8,
    /// Averages over frames: blocks of hidden boxes that it covered, and work.
    hidden: f32,
    work: f32,
}

/// What one cluster did in a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Done {
    pub(crate) hidden: u32,
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
            e.idle < PATIENCE || {
                let stagger = (slot + cluster) as u32 % STAGGER;
                self.frame.wrapping_sub(e.drawn) >= PAUSE + stagger
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
            // What was not drawn for long is looked at again.
            Some(e) if e.drawn > 0 && self.frame.wrapping_sub(e.drawn) < PAUSE => {
                (Some(e.hidden / e.work.max(1.0)), e.work)
            }
            _ => (None, BLOCK_WORK * blocks as f32),
        }
    }

    /// The work that fits into so many nanoseconds; none if that is not known.
    pub(crate) fn work_within(&self, ns: u64) -> Option<f64> {
        (self.unit_ns > 0.0).then(|| PLANNED * ns as f64 / self.unit_ns)
    }

    /// Learns how long a unit of work takes. Frames that were held up count a little more only.
    pub(crate) fn timed(&mut self, ns: u64, work: u64) {
        if work == 0 {
            // Nothing is drawn any more: perhaps it takes less than is thought.
            self.unit_ns *= 1.0 - f64::from(FOLLOW);
        } else if ns > 0 {
            let unit = ns as f64 / work as f64;
            self.unit_ns = if self.unit_ns > 0.0 {
                let unit = unit.min(MOST_HELD_UP * self.unit_ns);
                self.unit_ns + (unit - self.unit_ns) * f64::from(FOLLOW)
            } else {
                unit
            };
        }
    }

    /// Which one of so many comes first in this frame.
    pub(crate) fn turn(&self, count: usize) -> usize {
        (self.frame as usize).wrapping_mul(7) % count.max(1)
    }

    /// Makes room for the clusters of an occluder; returns the place of the first.
    pub(crate) fn room(&mut self, slot: usize, instance: &Instance) -> usize {
        if self.slots.len() <= slot {
            self.slots.resize(slot + 1, Slot::NONE);
        }
        let to = &mut self.slots[slot];
        let count = instance.clusters;
        if to.generation != Some(instance.generation()) || to.count != count {
            if to.room < count {
                to.first = self.entries.len() as u32;
                let end = self.entries.len() + count as usize;
                self.entries.resize(end, Entry::default());
                to.room = count;
            }
            to.generation = Some(instance.generation());
            to.count = count;
            let first = to.first as usize;
            self.entries[first..first + count as usize].fill(Entry::default());
        }
        to.first as usize
    }

    /// Enters what one cluster did in this frame.
    pub(crate) fn enter(&mut self, place: usize, done: Done) {
        let step = if self.observed.all { STEP } else { 1 };
        let frame = self.frame;
        let e = &mut self.entries[place];
        let (hidden, work) = (done.hidden as f32, done.work as f32);
        let is_new = e.drawn == 0 || frame.wrapping_sub(e.drawn) > ABSENCE;
        if is_new {
            *e = Entry {
                hidden,
                work,
                ..Entry::default()
            };
        }
        // One that is looked at again: for a frame if that tells all, else for some.
        if frame.wrapping_sub(e.drawn) >= PAUSE {
            e.idle = e
                .idle
                .min(PATIENCE - if self.observed.all { STEP } else { AGAIN });
        }
        e.hidden += (hidden - e.hidden) * FOLLOW;
        e.work += (work - e.work) * FOLLOW;
        e.idle = if done.hidden > 0 {
            0
        } else {
            e.idle.saturating_add(step)
        };
        e.drawn = frame;
    }

    /// The next frame begins. Frames are counted from 1.
    pub(crate) fn next(&mut self) {
        self.frame = self.frame.wrapping_add(1).max(1);
    }

    fn entry(&self, slot: usize, instance: &Instance, cluster: usize) -> Option<&Entry> {
        let s = self.slots.get(slot)?;
        let known = s.generation == Some(instance.generation()) && cluster < s.count as usize;
        known.then(|| &self.entries[s.first as usize + cluster])
    }
}

impl Slot {
    const NONE: Self = Self {
        generation: None,
        first: 0,
        count: 0,
        room: 0,
    };
}
