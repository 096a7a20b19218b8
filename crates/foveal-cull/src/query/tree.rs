//! The hierarchy over occludees.
//!
//! Nodes have eight children whose boxes lie side by side in memory, so that one pass of the
//! projection kernel tests all of them. Every child covers one run of the tree's own order of
//! objects.

use crate::bounds::Aabb;
use crate::error::CullError;
use crate::projection::boxes::{Boxes8, ROUNDING};
use glam::{DVec3, Vec3};

/// A hierarchy over occludees that are tested in many frames.
///
/// Groups that are hidden or outside as a whole cost one test. Building is O(n log n), by median
/// splits of the widest axis; [`refit`](Self::refit) is O(n), about 18 ns per box. Up to 2^32 - 1
/// boxes.
///
/// ```
/// use foveal_cull::{Aabb, OccludeeTree};
///
/// let boxes = [Aabb::new([0.0; 3], [1.0; 3]), Aabb::new([4.0; 3], [5.0; 3])];
/// let mut tree = OccludeeTree::build(&boxes, [0.0; 3]);
/// let moved = boxes.map(|b| Aabb::new(b.min.map(|v| v + 1.0), b.max.map(|v| v + 1.0)));
/// tree.refit(&moved)?;
/// # Ok::<(), foveal_cull::CullError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct OccludeeTree {
    nodes: Vec<Node>,
    /// Object numbers in tree order.
    order: Vec<u32>,
    origin: DVec3,
    len: usize,
}

/// A node of four cache lines. A walk waits for memory more than for anything else.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) boxes: Boxes8,
    /// Child `i` covers `order[first[i]..first[i + 1]]`.
    first: [u32; 9],
    /// The first child that is a node. The others follow it.
    below: u32,
    /// Bit per lane: it has a child.
    pub(super) lanes: u8,
    /// Bit per lane: the child is an object.
    pub(super) objects: u8,
}

impl Node {
    /// A node whose children cover the given runs, which follow each other. A run of a single
    /// object is that object.
    fn over(runs: &[core::ops::Range<usize>]) -> Self {
        let end = runs.last().map_or(0, |run| run.end as u32);
        let mut node = Self {
            boxes: Boxes8::NONE,
            first: [end; 9],
            below: 0,
            lanes: 0,
            objects: 0,
        };
        for (lane, run) in runs.iter().enumerate() {
            node.first[lane] = run.start as u32;
            node.lanes |= 1 << lane;
            node.objects |= u8::from(run.len() == 1) << lane;
        }
        node
    }

    /// The number of the node that a child is.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn child(&self, lane: usize) -> u32 {
        let before = (1u32 << lane) - 1;
        self.below + (u32::from(self.lanes & !self.objects) & before).count_ones()
    }

    /// Lanes with a child.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn children(&self) -> impl Iterator<Item = usize> + use<> {
        let lanes = self.lanes;
        (0..8).filter(move |lane| lanes >> lane & 1 != 0)
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn is_object(&self, lane: usize) -> bool {
        self.objects >> lane & 1 != 0
    }

    /// Centre and half extent of a box around the children's. NaN spreads upwards: a node with a
    /// box that is invalid is never culled as a whole.
    fn around_children(&self) -> (Vec3, Vec3) {
        let child = |lane: u32| {
            let of = |rows: [[f32; 8]; 3]| Vec3::from_array(rows.map(|v| v[lane as usize]));
            (of(self.boxes.center), of(self.boxes.half))
        };
        // Bit by bit: refitting takes 0.8 of the time that it takes with `children`.
        let mut rest = self.lanes;
        if rest == 0 {
            return (Vec3::NAN, Vec3::NAN);
        }
        let (mut center, mut half) = child(rest.trailing_zeros());
        rest &= rest - 1;
        while rest != 0 {
            let (c, h) = child(rest.trailing_zeros());
            rest &= rest - 1;
            let (lo, hi) = ((center - half).min(c - h), (center + half).max(c + h));
            let nan = (center + half + c + h) * 0.0;
            center = (lo + hi) * 0.5 + nan;
            half = (hi - lo) * 0.5 * (1.0 + 1e-6) + (lo.abs() + hi.abs()) * 1e-7 + nan;
        }
        (center, half)
    }

    /// Takes out an object.
    pub(super) fn remove(&mut self, lane: usize) {
        self.lanes &= !(1 << lane);
        self.objects &= !(1 << lane);
        self.boxes.set(lane, Vec3::NAN, Vec3::NAN);
    }

    /// The run of the order that a child covers.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn run(&self, lane: usize) -> core::ops::Range<usize> {
        self.first[lane] as usize..self.first[lane + 1] as usize
    }
}

impl OccludeeTree {
    /// Builds a tree over boxes in metres relative to `origin` (world). A box that is invalid
    /// is always visible.
    #[must_use]
    pub fn build(boxes: &[Aabb], origin: impl Into<[f64; 3]>) -> Self {
        Self::build_from(boxes, DVec3::from(origin.into()))
    }

    pub(super) fn build_from(boxes: &[Aabb], origin: DVec3) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..boxes.len() as u32).collect(),
            origin,
            len: boxes.len(),
        };
        let mut order = core::mem::take(&mut tree.order);
        // Boxes that are not volumes go to the end, into nodes of their own, so that they do not
        // spoil others.
        order.sort_by_key(|&i| !boxes[i as usize].is_valid());
        let valid = order.partition_point(|&i| boxes[i as usize].is_valid());
        let runs: Vec<_> = [0..valid, valid..order.len()]
            .into_iter()
            .filter(|run| !run.is_empty())
            .collect();
        if !runs.is_empty() {
            tree.nodes.push(Node::over(&runs));
        }
        // Breadth first: the children of a node lie side by side.
        let mut n = 0;
        while n < tree.nodes.len() {
            tree.nodes[n].below = tree.nodes.len() as u32;
            let node = tree.nodes[n];
            for lane in node.children().filter(|&lane| !node.is_object(lane)) {
                let runs = eight_of(boxes, &mut order, node.run(lane));
                tree.nodes.push(Node::over(&runs));
            }
            n += 1;
        }
        tree.order = order;
        tree.refit_all(boxes);
        tree
    }

    /// Gives objects other numbers.
    pub(super) fn rename(&mut self, number: impl Fn(u32) -> u32) {
        for object in &mut self.order {
            *object = number(*object);
        }
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn node_mut(&mut self, n: u32) -> &mut Node {
        &mut self.nodes[n as usize]
    }

    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// All nodes. The first one is the root.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Object numbers in the order of the runs.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of occludees.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no occludees.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Takes new boxes for the same objects (moved or resized), and fits the hierarchy to them. Its
    /// structure stays: build a new tree when objects have moved far from their neighbours. O(n),
    /// without allocation.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if there are not as many boxes as occludees.
    pub fn refit(&mut self, boxes: &[Aabb]) -> Result<(), CullError> {
        CullError::check_length(self.len, boxes.len())?;
        self.refit_all(boxes);
        Ok(())
    }

    fn refit_all(&mut self, boxes: &[Aabb]) {
        // Children come after their parents.
        for n in (0..self.nodes.len()).rev() {
            let node = self.nodes[n];
            for lane in node.children() {
                let (center, half) = if node.is_object(lane) {
                    grown(&boxes[self.order[node.run(lane).start] as usize])
                } else {
                    self.nodes[node.child(lane) as usize].around_children()
                };
                self.nodes[n].boxes.set(lane, center, half);
            }
        }
    }
}

fn grown(b: &Aabb) -> (Vec3, Vec3) {
    if !b.is_valid() {
        return (Vec3::NAN, Vec3::NAN);
    }
    let (center, half) = (b.center(), b.half_extent());
    (
        center,
        half + ROUNDING * (center.abs().max_element() + half.max_element()),
    )
}

/// Splits a run into eight, or into as many as it has members.
fn eight_of(
    boxes: &[Aabb],
    order: &mut [u32],
    run: core::ops::Range<usize>,
) -> Vec<core::ops::Range<usize>> {
    let mut runs = vec![run];
    // Split the largest run until there are eight.
    while runs.len() < 8 {
        let Some(at) = (0..runs.len())
            .filter(|&r| runs[r].len() > 1)
            .max_by_key(|&r| runs[r].len())
        else {
            break;
        };
        let (start, end) = (runs[at].start, runs[at].end);
        let half = start + split(boxes, &mut order[start..end]);
        runs[at] = start..half;
        runs.insert(at + 1, half..end);
    }
    runs
}

/// Orders a run by the median of its widest axis; returns the length of the first half.
fn split(boxes: &[Aabb], run: &mut [u32]) -> usize {
    let (lo, hi) = run
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &i| {
            let c = boxes[i as usize].center();
            (lo.min(c), hi.max(c))
        });
    let size = hi - lo;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let half = run.len() / 2;
    run.select_nth_unstable_by(half, |&a, &b| {
        boxes[a as usize].center()[axis]
            .total_cmp(&boxes[b as usize].center()[axis])
            .then(a.cmp(&b))
    });
    half
}
