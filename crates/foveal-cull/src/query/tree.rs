//! A hierarchy over occludees: what is hidden or outside as a whole costs one test.
//!
//! Nodes have eight children whose boxes lie side by side, so that one pass of the projection kernel tests
//! all of them. Every child covers one run of the tree's own order of objects.

use super::project::{Boxes8, ROUNDING, project};
use crate::Visibility;
use crate::query::answer::Query;
use crate::simd::{Kernel, Lanes};
use crate::{Aabb, CullError};
use glam::{DVec3, Vec3};

/// Occludees that are tested together, again and again.
#[derive(Clone, Debug, Default)]
pub struct OccludeeTree {
    nodes: Vec<Node>,
    /// Object numbers in tree order.
    order: Vec<u32>,
    origin: DVec3,
    len: usize,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    boxes: Boxes8,
    children: [Child; 8],
    count: u8,
}

#[derive(Clone, Copy, Debug, Default)]
struct Child {
    /// Node, or [`OBJECT`].
    node: u32,
    /// Run of `order`.
    first: u32,
    count: u32,
}

const OBJECT: u32 = u32::MAX;

impl OccludeeTree {
    /// Builds a tree over boxes in metres relative to `origin` (world). A box that is not a volume is always
    /// visible.
    #[must_use]
    pub fn build(boxes: &[Aabb], origin: DVec3) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..boxes.len() as u32).collect(),
            origin,
            len: boxes.len(),
        };
        let mut order = core::mem::take(&mut tree.order);
        // Boxes that are no volumes go to the end, into nodes of their own, so that they spoil no other.
        order.sort_by_key(|&i| !boxes[i as usize].is_valid());
        let valid = order.partition_point(|&i| boxes[i as usize].is_valid());
        if !order.is_empty() {
            let mut children = Vec::new();
            for (first, part) in [(0, 0..valid), (valid, valid..order.len())] {
                if !part.is_empty() {
                    children.push((first, part.len()));
                }
            }
            tree.node(boxes, &mut order, &children);
        }
        tree.order = order;
        tree.refit_all(boxes);
        tree
    }

    /// Appends a node whose children cover the given runs, and all below it.
    fn node(&mut self, boxes: &[Aabb], order: &mut [u32], runs: &[(usize, usize)]) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node {
            boxes: Boxes8::NONE,
            children: [Child::default(); 8],
            count: runs.len() as u8,
        });
        for (lane, &(first, count)) in runs.iter().enumerate() {
            let node = if count == 1 {
                OBJECT
            } else {
                self.node_over(boxes, order, first, count)
            };
            self.nodes[index].children[lane] = Child {
                node,
                first: first as u32,
                count: count as u32,
            };
        }
        index as u32
    }

    fn node_over(&mut self, boxes: &[Aabb], order: &mut [u32], first: usize, count: usize) -> u32 {
        let mut runs: Vec<(usize, usize)> = vec![(first, count)];
        // Split the largest run until there are eight.
        while runs.len() < 8 {
            let Some(at) = (0..runs.len())
                .filter(|&r| runs[r].1 > 1)
                .max_by_key(|&r| runs[r].1)
            else {
                break;
            };
            let (first, count) = runs[at];
            let middle = split(boxes, &mut order[first..first + count]);
            runs[at] = (first, middle);
            runs.insert(at + 1, (first + middle, count - middle));
        }
        self.node(boxes, order, &runs)
    }

    /// How many occludees there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Takes new boxes for the same objects (moved or resized) and fits the hierarchy to them. The structure
    /// stays; build a new tree when objects have moved far from their neighbours.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] when there are not as many boxes as occludees.
    pub fn refit(&mut self, boxes: &[Aabb]) -> Result<(), CullError> {
        if boxes.len() != self.len {
            return Err(CullError::LengthMismatch {
                expected: self.len,
                found: boxes.len(),
            });
        }
        self.refit_all(boxes);
        Ok(())
    }

    fn refit_all(&mut self, boxes: &[Aabb]) {
        // Children come after their parents.
        for n in (0..self.nodes.len()).rev() {
            for lane in 0..usize::from(self.nodes[n].count) {
                let child = self.nodes[n].children[lane];
                let (center, half) = if child.node == OBJECT {
                    grown(&boxes[self.order[child.first as usize] as usize])
                } else {
                    let below = &self.nodes[child.node as usize];
                    (0..usize::from(below.count))
                        .fold(None, |all: Option<(Vec3, Vec3)>, i| {
                            let (c, h) = (
                                Vec3::from_array(below.boxes.center.map(|v| v[i])),
                                Vec3::from_array(below.boxes.half.map(|v| v[i])),
                            );
                            // NaN spreads upwards: a node with a box that is no volume is never culled whole.
                            Some(match all {
                                None => (c, h),
                                Some((ac, ah)) => {
                                    let (lo, hi) = ((ac - ah).min(c - h), (ac + ah).max(c + h));
                                    let nan = (ac + ah + c + h) * 0.0;
                                    (
                                        (lo + hi) * 0.5 + nan,
                                        (hi - lo) * 0.5 * (1.0 + 1e-6)
                                            + (lo.abs() + hi.abs()) * 1e-7
                                            + nan,
                                    )
                                }
                            })
                        })
                        .unwrap_or((Vec3::NAN, Vec3::NAN))
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

/// Orders a run by the median of its widest axis; gives the number in the first part.
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
    let middle = run.len() / 2;
    run.select_nth_unstable_by(middle, |&a, &b| {
        boxes[a as usize].center()[axis]
            .total_cmp(&boxes[b as usize].center()[axis])
            .then(a.cmp(&b))
    });
    middle
}

/// Answers for a whole tree.
pub(crate) struct Walk<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) tree: &'a OccludeeTree,
    pub(crate) results: &'a mut [Visibility],
}

impl OccludeeTree {
    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }
}

impl Kernel for Walk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self {
            query,
            tree,
            results,
        } = self;
        if tree.nodes.is_empty() {
            return;
        }
        // Depth-first; eight children per level and a depth that 32-bit counts bound.
        let mut stack = [0u32; 128];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node = &tree.nodes[stack[top] as usize];
            let p = project(l, &query.screen, &node.boxes);
            for lane in 0..usize::from(node.count) {
                let child = node.children[lane];
                let answer = query.answer(l, &p, lane, &node.boxes, child.node == OBJECT);
                if child.node == OBJECT {
                    results[tree.order[child.first as usize] as usize] = answer;
                } else if answer == Visibility::Visible && top < stack.len() {
                    stack[top] = child.node;
                    top += 1;
                } else {
                    for &i in
                        &tree.order[child.first as usize..(child.first + child.count) as usize]
                    {
                        results[i as usize] = answer;
                    }
                }
            }
        }
    }
}
