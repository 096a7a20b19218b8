//! Occludees that come, move and go, in a hierarchy that follows them.
//!
//! The structure is an [`OccludeeTree`] of the time of the last rebuild. A moved object marks its
//! node; [`OccludeeSet::refit`] then takes over the boxes of the marked nodes' objects, and fits
//! these nodes and those above them, children before parents. New objects wait outside the tree,
//! where they are tested one by one, until it is built again.

use super::choice::tree_pays;
use super::groups::{around, half_area};
use super::occludee_id::OccludeeId;
use super::rebuild::{OccludeeRebuild, OccludeeSnapshot};
use super::tree::{OccludeeTree, grown};
use crate::bounds::Aabb;
use crate::error::CullError;
use crate::projection::boxes::Boxes8;
use crate::simd::{InstructionSet, Kernel, Lanes};
use core::num::NonZeroU32;
use glam::{DVec3, Vec3};

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
    tree: OccludeeTree,
    /// Per node of the tree: eight times its parent, plus the lane; [`NOWHERE`] for the root.
    parents: Vec<u32>,
    /// Bit per node: boxes in it have changed.
    marked: Vec<u64>,
    any_marked: bool,
    /// Per node of the tree: the boxes of its objects, as they were set.
    placed_bounds: Vec<[Aabb; 8]>,
    /// By slot.
    bounds: Vec<Aabb>,
    slots: Vec<Slot>,
    free: Vec<u32>,
    /// Slots of objects outside the tree.
    loose: Vec<u32>,
    /// Objects in the tree.
    placed: usize,
    /// Sum of half the surfaces of all groups, now and when the tree was built.
    area: f64,
    area_built: f64,
    origin: DVec3,
    prefers_tree: bool,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    /// Eight times the node, plus the lane; [`LOOSE`] plus the place in the list; or [`NOWHERE`].
    place: u32,
    generation: NonZeroU32,
}

const LOOSE: u32 = 1 << 31;
const NOWHERE: u32 = u32::MAX;

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
            tree: OccludeeTree::build_from(&[], origin),
            parents: Vec::new(),
            marked: Vec::new(),
            any_marked: false,
            placed_bounds: Vec::new(),
            bounds: Vec::new(),
            slots: Vec::new(),
            free: Vec::new(),
            loose: Vec::new(),
            placed: 0,
            area: 0.0,
            area_built: 0.0,
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
    #[inline]
    pub fn set_bounds(&mut self, id: OccludeeId, bounds: Aabb) -> Result<(), CullError> {
        let place = self.place(id)?;
        self.bounds[id.slot as usize] = bounds;
        if place & LOOSE != 0 {
            return Ok(());
        }
        if bounds.is_valid() {
            self.placed_bounds[place as usize / 8][place as usize % 8] = bounds;
            self.mark(place / 8);
        } else {
            // The tree has volumes only.
            self.take_out(place);
            self.loosen(id.slot);
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
        if core::mem::take(&mut self.any_marked) {
            InstructionSet::detect().run(Refit(self));
        }
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
        self.tree = tree;
        self.tree
            .rename(|n| ids.get(n as usize).map_or(0, |id| id.slot));
        let nodes = self.tree.nodes().len();
        self.parents.clear();
        self.parents.resize(nodes, NOWHERE);
        self.marked.clear();
        self.marked.resize(nodes.div_ceil(64), 0);
        self.placed_bounds.clear();
        self.placed_bounds.resize(nodes, [Aabb::EMPTY; 8]);
        self.any_marked = false;
        for slot in self.slots.iter_mut().filter(|s| s.place != NOWHERE) {
            slot.place = LOOSE;
        }
        self.placed = 0;
        for n in 0..nodes as u32 {
            self.place_children(n, &ids);
        }
        self.loose.clear();
        for (slot, number) in self.slots.iter_mut().zip(0..) {
            if slot.place == LOOSE {
                slot.place |= self.loose.len() as u32;
                self.loose.push(number);
            }
        }
        self.area = 0.0;
        for n in (0..nodes as u32).rev() {
            self.fit(n);
        }
        self.marked.fill(0);
        self.area_built = self.area;
    }

    /// Finds the objects of a node's leaves by the ids of the snapshot, and notes where its groups
    /// are.
    fn place_children(&mut self, n: u32, ids: &[OccludeeId]) {
        let node = self.tree.nodes()[n as usize];
        for lane in node.children() {
            let place = n * 8 + lane as u32;
            let bounds = if node.is_object(lane) {
                let slot = self.tree.order()[node.run(lane).start];
                let id = ids.binary_search_by_key(&slot, |id| id.slot);
                id.ok()
                    .and_then(|k| self.place(ids[k]).ok())
                    .map(|_| (slot, self.bounds[slot as usize]))
                    .filter(|(_, bounds)| bounds.is_valid())
            } else {
                self.parents[node.child(lane) as usize] = place;
                // Fitted afterwards, and its surface counted.
                self.tree.node_mut(n).boxes.set(lane, Vec3::NAN, Vec3::NAN);
                continue;
            };
            let node = self.tree.node_mut(n);
            let Some((slot, bounds)) = bounds else {
                node.remove(lane);
                continue;
            };
            let (center, half) = grown(&bounds);
            node.boxes.set(lane, center, half);
            self.placed_bounds[n as usize][lane] = bounds;
            self.slots[slot as usize].place = place;
            self.placed += 1;
        }
    }

    /// The tree. None while it does not fit, or where a list is as fast.
    pub(crate) fn tree(&self) -> Option<&OccludeeTree> {
        let worth_it = self.slots.len() > FEW && !self.has_spread();
        ((worth_it || self.prefers_tree) && !self.any_marked).then_some(&self.tree)
    }

    /// Whether a list takes less time than the tree, of whose objects so many have to be opened.
    pub(crate) fn prefers_list(&self, open: usize) -> bool {
        !self.prefers_tree && !tree_pays(open, self.bounds.len())
    }

    /// For tests: from here on queries take the hierarchy wherever it fits, also where a list is faster.
    #[doc(hidden)]
    pub fn prefer_tree(&mut self) {
        self.prefers_tree = true;
    }

    /// Whether objects have moved so far from their groups that a tree takes longer than a list.
    fn has_spread(&self) -> bool {
        self.area > GROWTH * self.area_built
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

    fn take_out(&mut self, place: u32) {
        self.tree.node_mut(place / 8).remove((place % 8) as usize);
        self.placed_bounds[place as usize / 8][place as usize % 8] = Aabb::EMPTY;
        self.mark(place / 8);
        self.placed -= 1;
    }

    #[inline]
    fn mark(&mut self, node: u32) {
        self.marked[node as usize / 64] |= 1 << (node % 64);
        self.any_marked = true;
    }

    /// Takes over the boxes of a node's objects, all at once.
    #[inline(always)]
    fn take_boxes<L: Lanes>(&mut self, l: L, n: u32) {
        let node = &self.tree.nodes()[n as usize];
        if node.objects == 0 {
            return;
        }
        let taken = Boxes8::of(l, &self.placed_bounds[n as usize]);
        let objects = node.objects;
        let node = self.tree.node_mut(n);
        if node.lanes == objects {
            node.boxes = taken;
        } else {
            for lane in (0..8).filter(|lane| objects >> lane & 1 != 0) {
                node.boxes.copy(lane, &taken, lane);
            }
        }
    }

    /// Fits the group that a node is, and marks the node above it.
    #[inline(always)]
    fn fit(&mut self, node: u32) {
        let parent = self.parents[node as usize];
        if parent == NOWHERE {
            return;
        }
        let (center, half) = around(&self.tree.nodes()[node as usize].boxes);
        let lane = (parent % 8) as usize;
        let above = self.tree.node_mut(parent / 8);
        let before = Vec3::from_array(above.boxes.half.map(|half| half[lane]));
        above.boxes.set(lane, center, half);
        self.area += half_area(half) - half_area(before);
        self.marked[parent as usize / 512] |= 1 << (parent / 8 % 64);
    }
}

/// Fits the marked nodes. A kernel for the sake of wide registers.
struct Refit<'a>(&'a mut OccludeeSet);

impl Kernel for Refit<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let set = self.0;
        for word in (0..set.marked.len()).rev() {
            // Parents come before their children, so that bits that are set here are lower ones.
            while set.marked[word] != 0 {
                let bit = 63 - set.marked[word].leading_zeros();
                set.marked[word] &= !(1 << bit);
                let node = word as u32 * 64 + bit;
                set.take_boxes(l, node);
                set.fit(node);
            }
        }
    }
}
