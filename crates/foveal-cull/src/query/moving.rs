//! Occludees that come, move and go, in a hierarchy that follows them.
//!
//! The structure is an [`OccludeeTree`] of the time of the last rebuild, which [`OccludeeSet::refit`]
//! fits to what has moved (`fitted.rs`). New objects wait outside the tree, where they are tested one
//! by one, until it is built again.

use super::choice::tree_pays;
use super::fitted::{FittedTree, NOWHERE};
use super::occludee_id::OccludeeId;
use super::rebuild::{OccludeeRebuild, OccludeeSnapshot};
use super::tree::OccludeeTree;
use crate::bounds::Aabb;
use crate::error::CullError;
use core::num::NonZeroU32;
use glam::DVec3;

/// Occludees that are inserted, moved and removed while running.
///
/// In each frame: change what has changed, [`refit`](Self::refit), then
/// [`Culler::query_set`](crate::Culler::query_set). Now and then, when
/// [`wants_rebuild`](Self::wants_rebuild) says so, [`rebuild`](Self::rebuild), or build on another
/// thread: [`snapshot`](Self::snapshot), [`OccludeeSnapshot::build`], [`adopt`](Self::adopt).
///
/// ```
/// use foveal_cull::{Aabb, OccludeeSet};
///
/// let mut set = OccludeeSet::new([0.0; 3]);
/// let cart = set.insert(Aabb::new([0.0; 3], [1.0; 3]));
/// set.rebuild();
/// set.set_bounds(cart, Aabb::new([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]))?;
/// set.refit();
/// set.remove(cart)?;
/// assert!(set.set_bounds(cart, Aabb::EMPTY).is_err());
/// # Ok::<(), foveal_cull::CullError>(())
/// ```
#[derive(Clone, Debug)]
pub struct OccludeeSet {
    tree: FittedTree,
    /// By slot.
    bounds: Vec<Aabb>,
    slots: Vec<Slot>,
    free: Vec<u32>,
    /// Slots of objects outside the tree.
    loose: Vec<u32>,
    /// Objects in the tree.
    placed: usize,
    origin: DVec3,
    /// Whether queries take the tree where a list is faster: for tests only.
    prefers_tree: bool,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    /// Eight times the node, plus the lane; [`LOOSE`] plus the place in the list; or [`NOWHERE`].
    place: u32,
    generation: NonZeroU32,
}

const LOOSE: u32 = 1 << 31;

/// Up to so many objects a list takes no longer than a tree.
const FEW: usize = 1000;
/// So many objects may be outside the tree before it is built again, and this part of all.
const LOOSE_AT_LEAST: usize = 64;
const LOOSE_PART: usize = 8;
/// Growth of the groups' surfaces at which the tree is built again.
const GROWTH: f64 = 2.0;

impl OccludeeSet {
    /// An empty set, for boxes in metres relative to `origin` (world).
    #[must_use]
    pub fn new(origin: impl Into<[f64; 3]>) -> Self {
        let origin = DVec3::from(origin.into());
        Self {
            tree: FittedTree::default(),
            bounds: Vec::new(),
            slots: Vec::new(),
            free: Vec::new(),
            loose: Vec::new(),
            placed: 0,
            origin,
            prefers_tree: false,
        }
    }

    /// Inserts an object. O(1). Up to 2^28 objects.
    pub fn insert(&mut self, bounds: Aabb) -> OccludeeId {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.bounds.push(bounds);
            self.slots.push(Slot {
                place: NOWHERE,
                generation: NonZeroU32::MIN,
            });
            self.slots.len() as u32 - 1
        });
        self.bounds[slot as usize] = bounds;
        self.loosen(slot);
        OccludeeId {
            slot,
            generation: self.slots[slot as usize].generation,
        }
    }

    /// Moves or resizes an object. O(1). A box that is not a volume is always visible.
    ///
    /// # Errors
    /// [`CullError::UnknownOccludee`].
    // Always: a box that the caller has in registers would be written in parts and read as a whole,
    // which a processor waits for.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub fn set_bounds(&mut self, id: OccludeeId, bounds: Aabb) -> Result<(), CullError> {
        let place = self.place(id)?;
        self.bounds[id.slot as usize] = bounds;
        if place & LOOSE == 0 {
            if bounds.is_valid() {
                self.tree.set(place, bounds);
            } else {
                self.no_volume(place, id.slot);
            }
        }
        Ok(())
    }

    /// Removes an object. Its id names nothing from then on. O(1).
    ///
    /// # Errors
    /// [`CullError::UnknownOccludee`].
    pub fn remove(&mut self, id: OccludeeId) -> Result<(), CullError> {
        let place = self.place(id)?;
        if place & LOOSE == 0 {
            self.take_out(place);
        } else {
            let at = (place & !LOOSE) as usize;
            self.loose.swap_remove(at);
            if let Some(&moved) = self.loose.get(at) {
                self.slots[moved as usize].place = LOOSE | at as u32;
            }
        }
        let slot = &mut self.slots[id.slot as usize];
        slot.place = NOWHERE;
        self.bounds[id.slot as usize] = Aabb::EMPTY;
        // A slot that has used up all generations stays empty.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.slot);
        }
        Ok(())
    }

    /// Whether an id names an object of this set. O(1).
    #[must_use]
    pub fn contains(&self, id: OccludeeId) -> bool {
        self.place(id).is_ok()
    }

    /// The box of an object.
    ///
    /// # Errors
    /// [`CullError::UnknownOccludee`].
    pub fn bounds(&self, id: OccludeeId) -> Result<Aabb, CullError> {
        self.place(id).map(|_| self.bounds[id.index()])
    }

    /// Number of objects.
    #[must_use]
    pub fn len(&self) -> usize {
        self.placed + self.loose.len()
    }

    /// Whether there are no objects.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Length of the results of a query: more than the largest [`OccludeeId::index`]. Results at
    /// places that no object has mean nothing.
    #[must_use]
    pub fn result_count(&self) -> usize {
        self.slots.len()
    }

    /// Fits the hierarchy to what has moved since the last time. Call it once before the queries of
    /// a frame; without it queries test box by box, which is as right but slower. So they do where
    /// there are few objects, and where groups have spread until they are built again. Cost grows with
    /// the nodes of eight that have changed.
    pub fn refit(&mut self) {
        self.tree.refit();
    }

    /// Whether the hierarchy is so much worse than a new one that it is worth building it again: many
    /// objects are new, or groups have grown.
    #[must_use]
    pub fn wants_rebuild(&self) -> bool {
        let most = LOOSE_AT_LEAST.max(self.len() / LOOSE_PART);
        // Invalid boxes stay outside, however often it is built.
        let would_be_placed = || {
            let boxes = self.loose.iter().map(|&slot| self.bounds[slot as usize]);
            boxes.filter(|bounds| bounds.is_valid()).count()
        };
        (self.loose.len() > most && would_be_placed() > most) || self.has_spread()
    }

    /// Builds the hierarchy again, on this thread. O(n log n), about half a microsecond per object.
    pub fn rebuild(&mut self) {
        self.adopt(self.snapshot().build());
    }

    /// The objects of now, for [`OccludeeSnapshot::build`] on another thread. O(n).
    #[must_use]
    pub fn snapshot(&self) -> OccludeeSnapshot {
        let live =
            |slot: &usize| self.slots[*slot].place != NOWHERE && self.bounds[*slot].is_valid();
        let slots: Vec<usize> = (0..self.slots.len()).filter(live).collect();
        OccludeeSnapshot {
            boxes: slots.iter().map(|&slot| self.bounds[slot]).collect(),
            ids: slots
                .iter()
                .map(|&slot| OccludeeId {
                    slot: slot as u32,
                    generation: self.slots[slot].generation,
                })
                .collect(),
            origin: self.origin,
        }
    }

    /// Takes over a hierarchy that was built from a snapshot of this set, fits it to what has moved
    /// since, and leaves out what was removed since. O(n).
    ///
    /// A hierarchy of another set is not refused. Results stay right with it, but groups that do not
    /// fit the objects make queries slower until the next rebuild.
    pub fn adopt(&mut self, rebuild: OccludeeRebuild) {
        let OccludeeRebuild { tree, ids } = rebuild;
        if ids.last().is_some_and(|id| id.index() >= self.slots.len()) {
            return;
        }
        for slot in self.slots.iter_mut().filter(|s| s.place != NOWHERE) {
            slot.place = LOOSE;
        }
        self.placed = 0;
        self.tree = FittedTree::new(tree, |number, place| {
            // An object that has been removed or is no volume by now is left out.
            let id = ids.get(number as usize)?;
            let slot = self.slots.get_mut(id.index())?;
            let bounds = self.bounds[id.index()];
            let is_there = slot.generation == id.generation && slot.place == LOOSE;
            if !is_there || !bounds.is_valid() {
                return None;
            }
            slot.place = place;
            self.placed += 1;
            Some(bounds)
        });
        self.tree
            .rename(|n| ids.get(n as usize).map_or(0, |id| id.slot));
        self.loose.clear();
        for (slot, number) in self.slots.iter_mut().zip(0..) {
            if slot.place == LOOSE {
                slot.place |= self.loose.len() as u32;
                self.loose.push(number);
            }
        }
    }

    /// The tree. None while it does not fit, or where a list is as fast.
    pub(crate) fn tree(&self) -> Option<&OccludeeTree> {
        let worth_it = self.slots.len() > FEW && !self.has_spread();
        self.tree.tree().filter(|_| worth_it || self.prefers_tree)
    }

    /// Whether a list takes less time than the tree, of whose objects so many have to be opened.
    pub(crate) fn prefers_list(&self, open: usize) -> bool {
        !self.prefers_tree && !tree_pays(open, self.bounds.len())
    }

    #[cfg(feature = "testing")]
    pub(crate) fn prefer_tree(&mut self) {
        self.prefers_tree = true;
    }

    /// Whether objects have moved so far from their groups that a tree takes longer than a list.
    fn has_spread(&self) -> bool {
        self.tree.has_grown(GROWTH)
    }

    /// Whether a slot has an object.
    pub(crate) fn has_object(&self, slot: usize) -> bool {
        self.slots.get(slot).is_some_and(|s| s.place != NOWHERE)
    }

    /// Slots of objects outside the tree.
    pub(crate) fn loose(&self) -> &[u32] {
        &self.loose
    }

    /// Boxes by slot.
    pub(crate) fn boxes(&self) -> &[Aabb] {
        &self.bounds
    }

    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    #[inline]
    fn place(&self, id: OccludeeId) -> Result<u32, CullError> {
        let slot = self.slots.get(id.index());
        slot.filter(|s| s.generation == id.generation && s.place != NOWHERE)
            .map(|s| s.place)
            .ok_or(CullError::UnknownOccludee)
    }

    fn loosen(&mut self, slot: u32) {
        self.slots[slot as usize].place = LOOSE | self.loose.len() as u32;
        self.loose.push(slot);
    }

    /// Takes an object out whose box is no volume: the tree has volumes only.
    #[cold]
    fn no_volume(&mut self, place: u32, slot: u32) {
        self.take_out(place);
        self.loosen(slot);
    }

    fn take_out(&mut self, place: u32) {
        self.tree.take_out(place);
        self.placed -= 1;
    }
}
