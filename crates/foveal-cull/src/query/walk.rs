//! Classification of a whole tree.
//!
//! The outcome at each child (occluded, visible, too small, to be opened) is unpredictable, and a
//! mispredicted branch costs as much as a box. Many nodes are therefore taken from the stack at
//! once, and their children go through the same steps as a list of boxes (see [`super::flat`]),
//! from one compacted list to the next.

use super::classify::Query;
use super::coarse::{CoarseNode16, CoarseTest};
use super::compaction::Compacted;
use super::tree::{Node, OccludeeTree};
use crate::projection::boxes::Boxes8;
use crate::projection::points::Corners8;
use crate::projection::project::{Projected8, outline, project};
use crate::simd::{Kernel, Lanes};
use crate::visibility::Visibility;

/// The kernel that classifies a tree.
pub(crate) struct Walk<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) tree: &'a OccludeeTree,
    pub(crate) results: &'a mut [Visibility],
}

/// Nodes per round. They are classified two by two.
const NODES: usize = 32;
/// Groups of eight that are projected together.
const GROUPS: usize = 8;
/// Room for nodes to be opened. Opening a node replaces it by at most eight children, and runs
/// become at least half as long from each level to the next. Below [`FEW`] there is room for many
/// nodes at once, and above it for one and everything below it.
const STACK: usize = 1024;
const FEW: usize = 512;

/// Working memory.
struct Work {
    stack: [u32; STACK],
    top: usize,
    nodes: [u32; NODES],
    nodes16: [CoarseNode16; NODES / 2],
    objects: Compacted,
    groups: Compacted,
    undecided: Compacted,
    rest: Compacted,
    eights: [Boxes8; GROUPS],
    projected: [Projected8; GROUPS],
    corners: [Corners8; GROUPS],
}

impl Work {
    const NEW: Self = Self {
        stack: [0; STACK],
        top: 1,
        nodes: [0; NODES],
        nodes16: [CoarseNode16::NONE; NODES / 2],
        objects: Compacted::EMPTY,
        groups: Compacted::EMPTY,
        undecided: Compacted::EMPTY,
        rest: Compacted::EMPTY,
        eights: [Boxes8::NONE; GROUPS],
        projected: [Projected8::NONE; GROUPS],
        corners: [Corners8::NONE; GROUPS],
    };

    /// Takes nodes from the stack; returns how many.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn take(&mut self) -> usize {
        let count = if self.top > FEW {
            1
        } else {
            self.top.min(NODES)
        };
        self.top -= count;
        self.nodes[..count].copy_from_slice(&self.stack[self.top..self.top + count]);
        count
    }

    /// Puts a node onto the stack if `wanted`, without a branch.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn push(&mut self, node: u32, wanted: bool) {
        self.stack[self.top] = node;
        self.top += usize::from(wanted);
    }
}

impl Kernel for Walk<'_> {
    type Output = ();

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(mut self, l: L) {
        if self.tree.nodes().is_empty() {
            return;
        }
        let mut work = Work::NEW;
        let Some(coarse) = self.query.coarse_test() else {
            return self.one_by_one(l, &mut work);
        };
        // Most objects that are not visible are occluded, in long runs.
        self.results.fill(Visibility::Occluded);
        while work.top > 0 {
            let count = work.take();
            self.classify_children(l, &coarse, count, &mut work);
            self.test_object_centers(&mut work);
            self.exact::<L, true>(l, &mut work);
            self.test_group_centers(l, &mut work);
            self.exact::<L, false>(l, &mut work);
        }
    }
}

impl<'a> Walk<'a> {
    #[cfg_attr(not(unoptimized), inline(always))]
    fn node(&self, n: u32) -> &'a Node {
        &self.tree.nodes()[n as usize]
    }

    /// Gives all objects of a run the same result.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn assign(&mut self, node: &Node, lane: usize, result: Visibility) {
        for &object in &self.tree.order()[node.run(lane)] {
            self.results[object as usize] = result;
        }
    }

    /// Classifies the children of `count` nodes by the coarse test. Those outside get their result,
    /// and those that are not occluded are listed.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_children<L: Lanes>(
        &mut self,
        l: L,
        coarse: &CoarseTest<'_>,
        count: usize,
        work: &mut Work,
    ) {
        let w = l.wide();
        // An odd node is classified twice.
        let last = work.nodes[count - 1];
        if let Some(next) = work.nodes.get_mut(count) {
            *next = last;
        }
        let (pairs, _) = work.nodes.as_chunks::<2>();
        let nodes16 = &mut work.nodes16[..count.div_ceil(2)];
        for (nodes16, pair) in nodes16.iter_mut().zip(pairs) {
            let pair = pair.map(|n| &self.node(n).boxes);
            *nodes16 = coarse.classify_nodes(w, pair, self.query.small);
        }
        for nodes16 in &mut *nodes16 {
            nodes16.coarse.fetch(coarse.hiz);
        }
        (work.objects.count, work.groups.count) = (0, 0);
        for (g, &n) in work.nodes[..count].iter().enumerate() {
            let (node, nodes16) = (self.node(n), &work.nodes16[g / 2]);
            let of_node = |mask: u32| (mask >> (8 * (g % 2))) as u8 & node.lanes;
            let outside = nodes16.coarse.outside;
            let culled = of_node(outside | nodes16.coarse.hidden(w));
            // Too small takes precedence over occluded.
            let rest = node.lanes & !culled;
            let small = of_node(nodes16.small & !outside);
            work.objects
                .push_eight(g, ((rest | small) & node.objects).into());
            work.groups.push_eight(g, (rest & !node.objects).into());
            let mut outside = of_node(outside);
            while outside != 0 {
                self.assign(node, outside.trailing_zeros() as usize, Visibility::Outside);
                outside &= outside - 1;
            }
        }
    }

    /// Decides the remaining objects that are visible at their centre, or too small, and lists the
    /// others.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn test_object_centers(&mut self, work: &mut Work) {
        work.undecided.count = 0;
        for &k in work.objects.indices() {
            let (g, lane) = (usize::from(k) / 8, usize::from(k) % 8);
            let node = self.node(work.nodes[g]);
            let nodes16 = &work.nodes16[g / 2];
            let i = usize::from(k) % 16;
            let small = nodes16.small >> i & 1 != 0;
            let on = nodes16.centers.on >> i & 1 != 0;
            let seen = self
                .query
                .is_in_front(nodes16.centers.at[i], nodes16.centers.code[i]);
            // A small object whose centre is beside the screen may be outside.
            let culled = if small { on } else { seen };
            let result = if small {
                Visibility::Small
            } else {
                Visibility::Visible
            };
            let object = self.tree.order()[node.run(lane).start];
            self.results[object as usize] = if culled { result } else { Visibility::Occluded };
            work.undecided.push_if(k.into(), !culled);
        }
    }

    /// Opens the groups that are visible at their centre, and lists the others.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn test_group_centers<L: Lanes>(&mut self, l: L, work: &mut Work) {
        work.undecided.count = 0;
        for n in 0..work.groups.count {
            let k = usize::from(work.groups.indices()[n]);
            let node = self.node(work.nodes[k / 8]);
            let centers = &work.nodes16[k / 16].centers;
            let seen = self
                .query
                .is_in_front(centers.at[k % 16], centers.code[k % 16]);
            let child = node.child(k % 8);
            l.prefetch(self.node(child));
            work.push(child, seen);
            work.undecided.push_if(k, !seen);
        }
    }

    /// Classifies the listed children by exact rectangles; objects by their corners and faces too.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn exact<L: Lanes, const OBJECTS: bool>(&mut self, l: L, work: &mut Work) {
        for first in (0..work.undecided.count).step_by(8 * GROUPS) {
            let count = (work.undecided.count - first).min(8 * GROUPS);
            self.exact_part::<L, OBJECTS>(l, first, count, work);
        }
    }

    /// Classifies a part of the list.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn exact_part<L: Lanes, const OBJECTS: bool>(
        &mut self,
        l: L,
        first: usize,
        count: usize,
        work: &mut Work,
    ) {
        let list = &work.undecided.indices()[first..first + count];
        for (k, &n) in list.iter().enumerate() {
            let n = usize::from(n);
            let boxes = &self.node(work.nodes[n / 8]).boxes;
            work.eights[k / 8].copy(k % 8, boxes, n % 8);
        }
        let projected = &mut work.projected[..count.div_ceil(8)];
        for ((p, eight), corners) in projected
            .iter_mut()
            .zip(&work.eights)
            .zip(&mut work.corners)
        {
            *p = outline(l, &self.query.screen, eight, OBJECTS.then_some(corners));
        }
        work.rest.count = 0;
        for (g, p) in projected.iter().enumerate() {
            for (i, &n) in list[8 * g..].iter().take(8).enumerate() {
                let n = usize::from(n);
                let node = self.node(work.nodes[n / 8]);
                let outside = p.outside >> i & 1 != 0;
                let mut culled = outside | (p.hidden >> i & 1 != 0);
                if OBJECTS {
                    let small = work.nodes16[n / 16].small >> (n % 16) & 1 != 0;
                    let object = self.tree.order()[node.run(n % 8).start];
                    self.results[object as usize] = if outside {
                        Visibility::Outside
                    } else if small {
                        Visibility::Small
                    } else if culled {
                        Visibility::Occluded
                    } else {
                        Visibility::Visible
                    };
                    culled |= small;
                } else if outside {
                    self.assign(node, n % 8, Visibility::Outside);
                }
                work.rest.push_if(8 * g + i, !culled);
            }
        }
        if OBJECTS {
            self.query
                .keep_uncertain_corners(&mut work.rest, projected, &work.corners);
        }
        for k in 0..work.rest.count {
            let k = usize::from(work.rest.indices()[k]);
            let n = usize::from(work.undecided.indices()[first + k]);
            let node = self.node(work.nodes[n / 8]);
            let (p, eight, i) = (&work.projected[k / 8], &work.eights[k / 8], k % 8);
            let result = if OBJECTS {
                self.query.classify_remaining(l, p, i, eight)
            } else {
                self.query.classify_group(l, p, i, eight)
            };
            if OBJECTS || result != Visibility::Visible {
                self.assign(node, n % 8, result);
            } else {
                let child = node.child(n % 8);
                l.prefetch(self.node(child));
                work.push(child, true);
            }
        }
    }

    /// Classifies node by node, without a coarse test.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn one_by_one<L: Lanes>(&mut self, l: L, work: &mut Work) {
        while work.top > 0 {
            work.top -= 1;
            let node = self.node(work.stack[work.top]);
            let p = project(l, &self.query.screen, &node.boxes);
            for lane in node.children() {
                let object = node.is_object(lane);
                let result = self.query.classify(l, &p, lane, &node.boxes, object);
                if object || result != Visibility::Visible {
                    self.assign(node, lane, result);
                } else {
                    work.push(node.child(lane), true);
                }
            }
        }
    }
}
