//! A tree whose boxes change one by one.
//!
//! Every child of a node, object or group, has its box as two corners beside those of its
//! neighbours. A changed box marks its node. A fit goes through the marked nodes from the last to the
//! first, children before parents: eight boxes become the centres and half extents that queries read,
//! and the box around them goes to the node above.

use super::groups::{around, half_areas};
use super::tree::OccludeeTree;
use crate::bounds::Aabb;
use crate::projection::boxes::Boxes8;
use crate::simd::{InstructionSet, Kernel, Lanes};

/// No place: eight times a node, plus the lane, is less.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Part of its greatest value below which the sum of surfaces is added up anew: differences alone
/// would keep the rounding of a surface that was very large.
const MUCH_SMALLER: f64 = 1e-5;

/// A tree that is fitted to the boxes of its objects.
#[derive(Clone, Debug, Default)]
pub(super) struct FittedTree {
    tree: OccludeeTree,
    /// Per node: its own place in the node above; [`NOWHERE`] for the root.
    parents: Vec<u32>,
    /// Per node: the boxes of its children; [`Aabb::EMPTY`] where there is none.
    boxes: Vec<[Aabb; 8]>,
    /// Bit per node: boxes of its children have changed.
    marked: Vec<u64>,
    any_marked: bool,
    /// Bit per node: some of its children are groups.
    with_groups: Vec<u64>,
    /// Per node: the sum of half the surfaces of the groups among its children.
    areas: Vec<f64>,
    /// Their sum, now and when the tree was built.
    area: f64,
    area_built: f64,
    /// The greatest sum after a fit since all were added up, whose rounding the sum has.
    area_most: f64,
}

impl FittedTree {
    /// Fits a tree to the boxes that `place` gives for an object's number and its place. An object
    /// without one is left out.
    pub(super) fn new(tree: OccludeeTree, mut place: impl FnMut(u32, u32) -> Option<Aabb>) -> Self {
        let nodes = tree.nodes().len();
        let mut fitted = Self {
            tree,
            parents: vec![NOWHERE; nodes],
            boxes: vec![[Aabb::EMPTY; 8]; nodes],
            marked: vec![0; nodes.div_ceil(64)],
            any_marked: nodes > 0,
            with_groups: vec![0; nodes.div_ceil(64)],
            areas: vec![0.0; nodes],
            area: 0.0,
            area_built: 0.0,
            area_most: 0.0,
        };
        for n in 0..nodes {
            let node = fitted.tree.nodes()[n];
            for lane in node.children() {
                let at = 8 * n as u32 + lane as u32;
                if !node.is_object(lane) {
                    fitted.parents[node.child(lane) as usize] = at;
                    fitted.with_groups[n / 64] |= 1 << (n % 64);
                } else if let Some(bounds) = place(fitted.tree.order()[node.run(lane).start], at) {
                    fitted.boxes[n][lane] = bounds;
                } else {
                    fitted.tree.node_mut(n as u32).remove(lane);
                }
            }
            fitted.marked[n / 64] |= 1 << (n % 64);
        }
        fitted.refit();
        fitted.area_built = fitted.area;
        fitted
    }

    /// The tree. None where boxes have changed since the last fit.
    pub(super) fn tree(&self) -> Option<&OccludeeTree> {
        (!self.any_marked).then_some(&self.tree)
    }

    /// Gives objects other numbers.
    pub(super) fn rename(&mut self, number: impl Fn(u32) -> u32) {
        self.tree.rename(number);
    }

    /// Whether the groups have that many times the surface that they had when the tree was built.
    pub(super) fn has_grown(&self, times: f64) -> bool {
        self.area > times * self.area_built
    }

    /// Gives the object at a place another box, which is a volume.
    #[inline]
    pub(super) fn set(&mut self, place: u32, bounds: Aabb) {
        self.boxes[place as usize / 8][place as usize % 8] = bounds;
        self.marked[place as usize / 512] |= 1 << (place / 8 % 64);
        self.any_marked = true;
    }

    /// Takes the object at a place out.
    pub(super) fn take_out(&mut self, place: u32) {
        self.set(place, Aabb::EMPTY);
        self.tree.node_mut(place / 8).remove(place as usize % 8);
    }

    /// Fits the marked nodes and those above them.
    pub(super) fn refit(&mut self) {
        if core::mem::take(&mut self.any_marked) {
            InstructionSet::detect().run(Refit(self));
            self.area_most = self.area_most.max(self.area);
            if self.area < self.area_most * MUCH_SMALLER {
                self.area = self.areas.iter().sum();
                self.area_most = self.area;
            }
        }
    }

    /// Fits one node, and writes the box of its group to the node above, which it returns.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn fit<L: Lanes>(&mut self, l: L, n: u32, with_groups: bool) -> u32 {
        let boxes = &self.boxes[n as usize];
        let (eight, group) = (Boxes8::of(l, boxes), around(l, boxes));
        let node = self.tree.node_mut(n);
        node.boxes = eight;
        if with_groups {
            let area = half_areas(l, &eight, node.lanes & !node.objects);
            self.area += area - core::mem::replace(&mut self.areas[n as usize], area);
        }
        let place = self.parents[n as usize];
        if place == NOWHERE {
            return NOWHERE;
        }
        self.boxes[place as usize / 8][place as usize % 8] = group;
        place / 8
    }
}

/// The kernel that fits the marked nodes.
struct Refit<'a>(&'a mut FittedTree);

impl Kernel for Refit<'_> {
    type Output = ();

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, l: L) {
        let fitted = self.0;
        for word in (0..fitted.marked.len()).rev() {
            // Parents come before their children, so bits that are set here are lower ones.
            let mut bits = core::mem::take(&mut fitted.marked[word]);
            while bits != 0 {
                let bit = 63 - bits.leading_zeros();
                bits &= !(1 << bit);
                let with_groups = fitted.with_groups[word] >> bit & 1 != 0;
                let above = fitted.fit(l, word as u32 * 64 + bit, with_groups);
                if above as usize / 64 == word {
                    bits |= 1 << (above % 64);
                } else if above != NOWHERE {
                    fitted.marked[above as usize / 64] |= 1 << (above % 64);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes on a lattice, which differ in size.
    fn lattice(count: u32) -> Vec<Aabb> {
        let one = |i: u32| {
            let at = [i % 13, i / 13 % 7, i / 91].map(|v| v as f32 * 2.5 - 9.0);
            Aabb::new(at, at.map(|v| v + 0.1 + (i % 5) as f32 * 0.7))
        };
        (0..count).map(one).collect()
    }

    fn fitted(boxes: &[Aabb], places: &mut Vec<u32>) -> FittedTree {
        places.clear();
        places.resize(boxes.len(), NOWHERE);
        FittedTree::new(OccludeeTree::build(boxes, [0.0; 3]), |slot, place| {
            places[slot as usize] = place;
            Some(boxes[slot as usize])
        })
    }

    /// The smallest and largest corner of all objects below a place.
    fn exact(fitted: &FittedTree, boxes: &[Aabb], n: u32, lane: usize) -> Aabb {
        let run = fitted.tree.nodes()[n as usize].run(lane);
        let order = &fitted.tree.order()[run];
        let of = |all: Aabb, &slot: &u32| all.union(boxes[slot as usize]);
        order.iter().fold(Aabb::EMPTY, of)
    }

    fn assert_fits(fitted: &FittedTree, boxes: &[Aabb]) {
        for (n, node) in fitted.tree.nodes().iter().enumerate() {
            for lane in node.children() {
                let all = exact(fitted, boxes, n as u32, lane);
                assert_eq!(fitted.boxes[n][lane], all, "{n}, {lane}");
                for axis in 0..3 {
                    let (c, h) = (node.boxes.center[axis][lane], node.boxes.half[axis][lane]);
                    let [lo, hi] = [all.min[axis], all.max[axis]].map(f64::from);
                    let [c, h] = [c, h].map(f64::from);
                    assert!(c - h <= lo && hi <= c + h, "{n}, {lane}: {c} {h}");
                    assert!(h < (hi - lo) * 0.5001 + 1e-4, "{n}, {lane}: {h}");
                }
            }
        }
    }

    #[test]
    fn groups_hold_their_objects_exactly_after_every_fit() {
        for count in [1, 7, 8, 9, 65, 700] {
            let (mut boxes, mut places) = (lattice(count), Vec::new());
            let mut fitted = fitted(&boxes, &mut places);
            assert_fits(&fitted, &boxes);
            for step in 1..30u32 {
                for i in (0..boxes.len()).filter(|i| *i as u32 % 30 < step) {
                    let by = ((i as u32 * step) % 11) as f32 - 5.0;
                    let corner = |v: [f32; 3]| [v[0] + by, v[1], v[2] - 0.5 * by];
                    boxes[i] = Aabb::new(corner(boxes[i].min), corner(boxes[i].max));
                    fitted.set(places[i], boxes[i]);
                    assert!(fitted.tree().is_none(), "not fitted yet");
                }
                fitted.refit();
                assert!(fitted.tree().is_some());
                assert_fits(&fitted, &boxes);
            }
        }
    }

    #[test]
    fn surfaces_add_up_whatever_has_moved_before() {
        let (mut boxes, mut places) = (lattice(700), Vec::new());
        let mut moved = fitted(&boxes, &mut places);
        for step in 0..200u32 {
            let i = (step * 37 % 700) as usize;
            let corner = |v: [f32; 3]| v.map(|v| v * 1.5 + step as f32);
            boxes[i] = Aabb::new(corner(boxes[i].min), corner(boxes[i].max));
            moved.set(places[i], boxes[i]);
            moved.refit();
        }
        assert!(moved.has_grown(1.5));
        let again: f64 = (0..moved.tree.nodes().len())
            .map(|n| {
                let node = &moved.tree.nodes()[n];
                let groups = node.children().filter(|lane| !node.is_object(*lane));
                groups
                    .map(|lane| {
                        let b = exact(&moved, &boxes, n as u32, lane);
                        let h = [0, 1, 2].map(|k| 0.5 * f64::from(b.max[k] - b.min[k]));
                        h[0] * h[1] + h[1] * h[2] + h[2] * h[0]
                    })
                    .sum::<f64>()
            })
            .sum();
        assert!(
            (moved.area / again - 1.0).abs() < 1e-4,
            "{} {again}",
            moved.area
        );
    }

    #[test]
    fn a_box_that_was_very_large_for_a_frame_leaves_no_trace_in_the_sum_of_surfaces() {
        let (boxes, mut places) = (lattice(700), Vec::new());
        let mut moved = fitted(&boxes, &mut places);
        for size in [1e5, 1e10, 1e15, 1e18] {
            for (place, bounds) in places.iter().zip(&boxes).step_by(111) {
                moved.set(*place, Aabb::new([-size; 3], [size; 3]));
                moved.refit();
                assert!(moved.has_grown(2.0), "{size}");
                moved.set(*place, *bounds);
                moved.refit();
                let off = (moved.area / moved.area_built - 1.0).abs();
                assert!(off < 1e-6, "{size}: {off}");
            }
        }
    }

    #[test]
    fn all_instruction_sets_fit_to_the_same_bits() {
        let (mut boxes, mut places) = (lattice(700), Vec::new());
        boxes[5] = Aabb::new([-f32::MAX; 3], [f32::MAX; 3]);
        let mut first = fitted(&boxes, &mut places);
        // Every node is fitted again, by each set.
        for (place, bounds) in places.iter().zip(&boxes) {
            first.set(*place, *bounds);
        }
        first.take_out(places[9]);
        first.set(places[3], Aabb::new([-1e30, 0.0, -0.0], [1e-30, 1e30, 0.0]));
        let mut found: Vec<(InstructionSet, Vec<u32>, u64)> = Vec::new();
        for set in InstructionSet::available() {
            let mut fitted = first.clone();
            set.run(Refit(&mut fitted));
            let mut bits = Vec::new();
            for node in fitted.tree.nodes() {
                for lane in node.children() {
                    let boxes = &node.boxes;
                    let numbers = boxes.center.iter().chain(&boxes.half);
                    bits.extend(numbers.map(|numbers| numbers[lane].to_bits()));
                }
            }
            found.push((set, bits, fitted.area.to_bits()));
        }
        for (set, bits, area) in &found[1..] {
            assert!((bits, area) == (&found[0].1, &found[0].2), "{set:?}");
        }
    }
}
