//! Classification of a list of boxes.
//!
//! Boxes go through tests of rising cost: a coarse HiZ test of sixteen at once, the depth at their
//! centres, their exact screen rectangles against the HiZ, the depth at their corners, and last
//! block by block. Branch-free between the steps: the outcomes are unpredictable, so each step
//! compacts the boxes that remain into a list for the next one.

use super::classify::Query;
use super::coarse::{Centers16, Coarse16, CoarseTest};
use super::compaction::Compacted;
use crate::bounds::Aabb;
use crate::projection::boxes::Boxes8;
use crate::projection::points::Corners8;
use crate::projection::project::{Projected8, outline, project};
use crate::simd::{Kernel, Lanes};
use crate::visibility::Visibility;

/// The kernel that classifies a list of boxes.
pub(crate) struct Flat<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) boxes: &'a [Aabb],
    pub(crate) results: &'a mut [Visibility],
}

/// Groups of eight boxes per round.
const GROUPS: usize = 16;
const BOXES: usize = 8 * GROUPS;

/// Results of eight culled boxes, by a bit for each that is outside the frustum; the others are
/// occluded.
const CULLED: [[Visibility; 8]; 256] = {
    let mut culled = [[Visibility::Occluded; 8]; 256];
    let mut n = 0;
    while n < 256 * 8 {
        if (n / 8) >> (n % 8) & 1 != 0 {
            culled[n / 8][n % 8] = Visibility::Outside;
        }
        n += 1;
    }
    culled
};

/// Working memory of one round.
struct Work {
    results: [Visibility; BOXES],
    coarse: [Coarse16; BOXES / 16],
    centers: [Centers16; BOXES / 16],
    remaining: Compacted,
    undecided: Compacted,
    copies: [[Aabb; 8]; GROUPS],
    eights: [Boxes8; GROUPS],
    corners: [Corners8; GROUPS],
    projected: [Projected8; GROUPS],
}

impl Work {
    const NEW: Self = Self {
        results: [Visibility::Visible; BOXES],
        coarse: [Coarse16::NONE; BOXES / 16],
        centers: [Centers16::NONE; BOXES / 16],
        remaining: Compacted::EMPTY,
        undecided: Compacted::EMPTY,
        copies: [[Aabb::EMPTY; 8]; GROUPS],
        eights: [Boxes8::NONE; GROUPS],
        corners: [Corners8::NONE; GROUPS],
        projected: [Projected8::NONE; GROUPS],
    };
}

impl Kernel for Flat<'_> {
    type Output = ();

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, l: L) {
        let query = self.query;
        let coarse = query.coarse_test().filter(|_| query.small <= 0.0);
        let mut work = Work::NEW;
        let mut last = [Aabb::EMPTY; BOXES];
        for (some, results) in self.boxes.chunks(BOXES).zip(self.results.chunks_mut(BOXES)) {
            let count = some.len();
            let boxes = if let Ok(boxes) = some.try_into() {
                boxes
            } else {
                last[..count].copy_from_slice(some);
                &last
            };
            query.classify_all(l, coarse.as_ref(), boxes, count, &mut work);
            results.copy_from_slice(&work.results[..count]);
        }
    }
}

impl Query<'_> {
    /// Classifies the first `count` boxes.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_all<L: Lanes>(
        &self,
        l: L,
        coarse: Option<&CoarseTest<'_>>,
        boxes: &[Aabb; BOXES],
        count: usize,
        work: &mut Work,
    ) {
        work.remaining.count = 0;
        if let Some(coarse) = coarse {
            classify_coarse(l, coarse, boxes, count, work);
            work.remaining.truncate_at(count);
            self.keep_uncertain_centers(work);
        } else {
            (0..count).for_each(|n| work.remaining.push_if(n, true));
        }
        // The remaining ones by exact rectangles.
        let list = work.remaining.indices();
        let groups = copy(l, boxes, list, &mut work.copies, &mut work.eights);
        let projected = &mut work.projected[..groups];
        for ((p, eight), corners) in projected
            .iter_mut()
            .zip(&work.eights)
            .zip(&mut work.corners)
        {
            *p = if coarse.is_some() {
                outline(l, &self.screen, eight, Some(corners))
            } else {
                project(l, &self.screen, eight)
            };
        }
        work.undecided.count = 0;
        for (g, p) in projected.iter().enumerate() {
            let culled = p.outside | p.hidden;
            for (i, n) in list[8 * g..].iter().take(8).enumerate() {
                let outside = p.outside >> i & 1 != 0;
                let culled = culled >> i & 1 != 0;
                work.results[usize::from(*n)] = if outside {
                    Visibility::Outside
                } else if culled {
                    Visibility::Occluded
                } else {
                    Visibility::Visible
                };
                work.undecided
                    .push_if(8 * g + i, coarse.is_none() | !culled);
            }
        }
        if coarse.is_some() {
            self.keep_uncertain_corners(&mut work.undecided, projected, &work.corners);
        }
        for &k in work.undecided.indices() {
            let (g, i) = (usize::from(k) / 8, usize::from(k) % 8);
            let n = usize::from(list[usize::from(k)]);
            let (p, eight) = (&projected[g], &work.eights[g]);
            work.results[n] = if coarse.is_some() {
                self.classify_remaining(l, p, i, eight)
            } else {
                self.classify(l, p, i, eight, true)
            };
        }
    }

    /// Keeps the undecided boxes of which no corner is in front of the buffer. Most visible boxes
    /// that get here are visible at a corner.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn keep_uncertain_corners(
        &self,
        undecided: &mut Compacted,
        projected: &[Projected8],
        corners: &[Corners8],
    ) {
        for n in 0..core::mem::take(&mut undecided.count) {
            // Entries are read before the compacted list, which is never longer, overwrites them.
            let k = usize::from(undecided.index(n));
            let (g, i) = (k / 8, k % 8);
            let beyond = projected[g].crossing >> i & 1 == 0;
            let seen = beyond & self.corner_seen(&corners[g], i);
            undecided.push_if(k, !seen);
        }
    }

    /// Marks the remaining boxes visible whose centre is in front of the buffer, and keeps the
    /// others. Most visible boxes are visible at their centre.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn keep_uncertain_centers(&self, work: &mut Work) {
        work.undecided.count = 0;
        for &n in work.remaining.indices() {
            let n = usize::from(n);
            let (centers, i) = (&work.centers[n / 16], n % 16);
            work.results[n] = Visibility::Visible;
            work.undecided
                .push_if(n, !self.is_in_front(centers.at[i], centers.code[i]));
        }
        core::mem::swap(&mut work.remaining, &mut work.undecided);
    }
}

/// Gathers the listed boxes into groups of eight; returns how many groups.
#[cfg_attr(not(unoptimized), inline(always))]
fn copy<L: Lanes>(
    l: L,
    boxes: &[Aabb; BOXES],
    list: &[u8],
    copies: &mut [[Aabb; 8]; GROUPS],
    eights: &mut [Boxes8; GROUPS],
) -> usize {
    for (copy, n) in copies.as_flattened_mut().iter_mut().zip(list) {
        *copy = boxes[usize::from(*n)];
    }
    let groups = list.len().div_ceil(8);
    for (copies, eight) in copies[..groups].iter().zip(eights) {
        *eight = Boxes8::of(l, copies);
    }
    groups
}

/// Classifies the first `count` boxes by the coarse test. Culled ones get their result; the others
/// are listed.
#[cfg_attr(not(unoptimized), inline(always))]
fn classify_coarse<L: Lanes>(
    l: L,
    test: &CoarseTest<'_>,
    boxes: &[Aabb; BOXES],
    count: usize,
    work: &mut Work,
) {
    let w = l.wide();
    let (boxes, _) = boxes.as_chunks::<16>();
    let (results, _) = work.results.as_chunks_mut::<8>();
    let (results, _) = results.as_chunks_mut::<2>();
    let coarse = &mut work.coarse[..count.div_ceil(16)];
    for ((coarse, centers), boxes) in coarse.iter_mut().zip(&mut work.centers).zip(boxes) {
        (*coarse, *centers) = test.classify(w, boxes);
    }
    for coarse in &mut *coarse {
        coarse.fetch(test.hiz);
    }
    for ((g, coarse), results) in coarse.iter().enumerate().zip(results) {
        let culled = coarse.outside | coarse.hidden(w);
        for (half, results) in results.iter_mut().enumerate() {
            let bits = |mask: u32| (mask >> (8 * half)) as usize % 256;
            *results = CULLED[bits(coarse.outside)];
            work.remaining.push_eight(2 * g + half, bits(!culled));
        }
    }
}
