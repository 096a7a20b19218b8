//! Answers for a whole tree.
//!
//! What comes next in a walk cannot be foreseen: whether a child is hidden, seen, too small or to be opened is as good as
//! chance, and a wrong guess costs as much as a box. So many nodes are taken from the stack at once, and their children
//! go through the same steps as boxes that are asked one after the other (see [`super::flat`]), from list to list.

use super::classify::Query;
use super::coarse::{Looked16, Sieve};
use super::compaction::List;
use super::tree::{Node, OccludeeTree};
use crate::projection::boxes::Boxes8;
use crate::projection::points::Corners8;
use crate::projection::project::{Projected8, outline, project};
use crate::simd::{Kernel, Lanes};
use crate::visibility::Visibility;

/// A tree against a frame.
pub(crate) struct Walk<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) tree: &'a OccludeeTree,
    pub(crate) results: &'a mut [Visibility],
}

/// Nodes that are looked at together; two by two.
const NODES: usize = 32;
/// Groups of eight that are projected together.
const GROUPS: usize = 8;
/// Room for nodes that are to be opened. A node in place of its at most eight children is one less, and runs become
/// half as long at least from each level to the next: below [`FEW`] there is room for many nodes at once, and above
/// it for one and all below it.
const STACK: usize = 1024;
const FEW: usize = 512;

/// Working memory.
struct Work {
    stack: [u32; STACK],
    top: usize,
    nodes: [u32; NODES],
    looked: [Looked16; NODES / 2],
    objects: List,
    groups: List,
    open: List,
    rest: List,
    eights: [Boxes8; GROUPS],
    projected: [Projected8; GROUPS],
    corners: [Corners8; GROUPS],
}

impl Work {
    const NEW: Self = Self {
        stack: [0; STACK],
        top: 1,
        nodes: [0; NODES],
        looked: [Looked16::NONE; NODES / 2],
        objects: List::NONE,
        groups: List::NONE,
        open: List::NONE,
        rest: List::NONE,
        eights: [Boxes8::NONE; GROUPS],
        projected: [Projected8::NONE; GROUPS],
        corners: [Corners8::NONE; GROUPS],
    };

    /// Takes nodes from the stack; gives how many.
    #[inline(always)]
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

    /// Puts a node onto the stack if `wanted`.
    #[inline(always)]
    fn push(&mut self, node: u32, wanted: bool) {
        self.stack[self.top] = node;
        self.top += usize::from(wanted);
    }
}

impl Kernel for Walk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        if self.tree.nodes().is_empty() {
            return;
        }
        let mut work = Work::NEW;
        let Some(sieve) = self.query.sieve() else {
            return self.one_by_one(l, &mut work);
        };
        // Most of what is not seen is hidden, and the runs of what is hidden are long.
        self.results.fill(Visibility::Occluded);
        while work.top > 0 {
            let count = work.take();
            self.look(l, &sieve, count, &mut work);
            self.middles_of_objects(&mut work);
            self.exact::<L, true>(l, &mut work);
            self.middles_of_groups(l, &mut work);
            self.exact::<L, false>(l, &mut work);
        }
    }
}

impl<'a> Walk<'a> {
    #[inline(always)]
    fn node(&self, n: u32) -> &'a Node {
        &self.tree.nodes()[n as usize]
    }

    /// The same answer for all of a run.
    #[inline(always)]
    fn tell(&mut self, node: &Node, lane: usize, answer: Visibility) {
        for &object in &self.tree.order()[node.run(lane)] {
            self.results[object as usize] = answer;
        }
    }

    /// A first look at the children of `count` nodes: what lies outside is told, and what is not hidden is listed.
    #[inline(always)]
    fn look<L: Lanes>(&mut self, l: L, sieve: &Sieve<'_>, count: usize, work: &mut Work) {
        let w = l.wide();
        // An odd one is looked at twice.
        let last = work.nodes[count - 1];
        if let Some(next) = work.nodes.get_mut(count) {
            *next = last;
        }
        let (pairs, _) = work.nodes.as_chunks::<2>();
        let looked = &mut work.looked[..count.div_ceil(2)];
        for (looked, pair) in looked.iter_mut().zip(pairs) {
            let pair = pair.map(|n| &self.node(n).boxes);
            *looked = sieve.look(w, pair, self.query.small);
        }
        for looked in &mut *looked {
            looked.sifted.look_up(sieve.coarse);
        }
        (work.objects.count, work.groups.count) = (0, 0);
        for (g, &n) in work.nodes[..count].iter().enumerate() {
            let (node, looked) = (self.node(n), &work.looked[g / 2]);
            let of_node = |mask: u32| (mask >> (8 * (g % 2))) as u8 & node.lanes;
            let outside = looked.sifted.outside;
            let told = of_node(outside | looked.sifted.hidden(w));
            // What is too small is called so, hidden or not.
            let rest = node.lanes & !told;
            let small = of_node(looked.small & !outside);
            work.objects
                .add_eight(g, ((rest | small) & node.objects).into());
            work.groups.add_eight(g, (rest & !node.objects).into());
            let mut outside = of_node(outside);
            while outside != 0 {
                self.tell(node, outside.trailing_zeros() as usize, Visibility::Outside);
                outside &= outside - 1;
            }
        }
    }

    /// Of the objects that are left most are simply seen, in the middle, or too small. Lists the others.
    #[inline(always)]
    fn middles_of_objects(&mut self, work: &mut Work) {
        work.open.count = 0;
        for &k in work.objects.numbers() {
            let (g, lane) = (usize::from(k) / 8, usize::from(k) % 8);
            let node = self.node(work.nodes[g]);
            let looked = &work.looked[g / 2];
            let i = usize::from(k) % 16;
            let small = looked.small >> i & 1 != 0;
            let on = looked.middle.on >> i & 1 != 0;
            let seen = self
                .query
                .before(looked.middle.at[i], looked.middle.code[i]);
            // What is small and beside the screen counts as outside.
            let told = if small { on } else { seen };
            let answer = if small {
                Visibility::Small
            } else {
                Visibility::Visible
            };
            let object = self.tree.order()[node.run(lane).start];
            self.results[object as usize] = if told { answer } else { Visibility::Occluded };
            work.open.add(k.into(), !told);
        }
    }

    /// Groups that are seen in the middle are opened. Lists the others.
    #[inline(always)]
    fn middles_of_groups<L: Lanes>(&mut self, l: L, work: &mut Work) {
        work.open.count = 0;
        for n in 0..work.groups.count {
            let k = usize::from(work.groups.numbers()[n]);
            let node = self.node(work.nodes[k / 8]);
            let middle = &work.looked[k / 16].middle;
            let seen = self.query.before(middle.at[k % 16], middle.code[k % 16]);
            let child = node.child(k % 8);
            l.prefetch(self.node(child));
            work.push(child, seen);
            work.open.add(k, !seen);
        }
    }

    /// Answers for the list by exact rectangles, and for objects by their corners and faces.
    #[inline(always)]
    fn exact<L: Lanes, const OBJECTS: bool>(&mut self, l: L, work: &mut Work) {
        for first in (0..work.open.count).step_by(8 * GROUPS) {
            let count = (work.open.count - first).min(8 * GROUPS);
            self.exact_part::<L, OBJECTS>(l, first, count, work);
        }
    }

    /// The same for a part of the list.
    #[inline(always)]
    fn exact_part<L: Lanes, const OBJECTS: bool>(
        &mut self,
        l: L,
        first: usize,
        count: usize,
        work: &mut Work,
    ) {
        let list = &work.open.numbers()[first..first + count];
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
                let mut told = outside | (p.hidden >> i & 1 != 0);
                if OBJECTS {
                    let small = work.looked[n / 16].small >> (n % 16) & 1 != 0;
                    let object = self.tree.order()[node.run(n % 8).start];
                    self.results[object as usize] = if outside {
                        Visibility::Outside
                    } else if small {
                        Visibility::Small
                    } else if told {
                        Visibility::Occluded
                    } else {
                        Visibility::Visible
                    };
                    told |= small;
                } else if outside {
                    self.tell(node, n % 8, Visibility::Outside);
                }
                work.rest.add(8 * g + i, !told);
            }
        }
        if OBJECTS {
            self.query
                .keep_cornerless(&mut work.rest, projected, &work.corners);
        }
        for k in 0..work.rest.count {
            let k = usize::from(work.rest.numbers()[k]);
            let n = usize::from(work.open.numbers()[first + k]);
            let node = self.node(work.nodes[n / 8]);
            let (p, eight, i) = (&work.projected[k / 8], &work.eights[k / 8], k % 8);
            let answer = if OBJECTS {
                self.query.answer_open(l, p, i, eight)
            } else {
                self.query.answer_group(l, p, i, eight)
            };
            if OBJECTS || answer != Visibility::Visible {
                self.tell(node, n % 8, answer);
            } else {
                let child = node.child(n % 8);
                l.prefetch(self.node(child));
                work.push(child, true);
            }
        }
    }

    /// Where there is nothing to take a first look with.
    #[inline(always)]
    fn one_by_one<L: Lanes>(&mut self, l: L, work: &mut Work) {
        while work.top > 0 {
            work.top -= 1;
            let node = self.node(work.stack[work.top]);
            let p = project(l, &self.query.screen, &node.boxes);
            for lane in 0..node.lanes.count_ones() as usize {
                let object = node.objects >> lane & 1 != 0;
                let answer = self.query.answer(l, &p, lane, &node.boxes, object);
                if object || answer != Visibility::Visible {
                    self.tell(node, lane, answer);
                } else {
                    work.push(node.child(lane), true);
                }
            }
        }
    }
}
