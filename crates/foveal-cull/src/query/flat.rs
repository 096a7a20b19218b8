//! All boxes one after the other.
//!
//! A first look at sixteen at a time tells what most of them are. What is to be done with the others cannot be foreseen,
//! and a wrong guess throws away what was begun. So at each step those that are left are put into a list without a
//! branch, and the list is gone through by itself.

use super::classify::Query;
use super::coarse::{Middles16, Sieve, Sifted16};
use super::compaction::List;
use crate::bounds::Aabb;
use crate::projection::boxes::Boxes8;
use crate::projection::points::Corners8;
use crate::projection::project::{Projected8, outline, project};
use crate::simd::{Kernel, Lanes};
use crate::visibility::Visibility;

/// Boxes against a frame.
pub(crate) struct Flat<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) boxes: &'a [Aabb],
    pub(crate) results: &'a mut [Visibility],
}

/// Groups of eight that are looked at together.
const GROUPS: usize = 16;
const BOXES: usize = 8 * GROUPS;

/// Answers for eight boxes of which none is seen: by a bit for each that is outside.
const TOLD: [[Visibility; 8]; 256] = {
    let mut told = [[Visibility::Occluded; 8]; 256];
    let mut n = 0;
    while n < 256 * 8 {
        if (n / 8) >> (n % 8) & 1 != 0 {
            told[n / 8][n % 8] = Visibility::Outside;
        }
        n += 1;
    }
    told
};

/// Working memory for some boxes.
struct Work {
    results: [Visibility; BOXES],
    sifted: [Sifted16; BOXES / 16],
    middles: [Middles16; BOXES / 16],
    left: List,
    open: List,
    copies: [[Aabb; 8]; GROUPS],
    eights: [Boxes8; GROUPS],
    corners: [Corners8; GROUPS],
    projected: [Projected8; GROUPS],
}

impl Work {
    const NEW: Self = Self {
        results: [Visibility::Visible; BOXES],
        sifted: [Sifted16::NONE; BOXES / 16],
        middles: [Middles16::NONE; BOXES / 16],
        left: List::NONE,
        open: List::NONE,
        copies: [[Aabb::EMPTY; 8]; GROUPS],
        eights: [Boxes8::NONE; GROUPS],
        corners: [Corners8::NONE; GROUPS],
        projected: [Projected8::NONE; GROUPS],
    };
}

impl Kernel for Flat<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let query = self.query;
        let sieve = query.sieve().filter(|_| query.small <= 0.0);
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
            query.answer_all(l, sieve.as_ref(), boxes, count, &mut work);
            results.copy_from_slice(&work.results[..count]);
        }
    }
}

impl Query<'_> {
    /// Answers for the first `count` boxes.
    #[inline(always)]
    fn answer_all<L: Lanes>(
        &self,
        l: L,
        sieve: Option<&Sieve<'_>>,
        boxes: &[Aabb; BOXES],
        count: usize,
        work: &mut Work,
    ) {
        work.left.count = 0;
        if let Some(sieve) = sieve {
            sift_all(l, sieve, boxes, count, work);
            work.left.end(count);
            self.keep_open(work);
        } else {
            (0..count).for_each(|n| work.left.add(n, true));
        }
        // The others exactly.
        let list = work.left.numbers();
        let groups = copy(l, boxes, list, &mut work.copies, &mut work.eights);
        let projected = &mut work.projected[..groups];
        for ((p, eight), corners) in projected
            .iter_mut()
            .zip(&work.eights)
            .zip(&mut work.corners)
        {
            *p = if sieve.is_some() {
                outline(l, &self.screen, eight, Some(corners))
            } else {
                project(l, &self.screen, eight)
            };
        }
        work.open.count = 0;
        for (g, p) in projected.iter().enumerate() {
            let told = p.outside | p.hidden;
            for (i, n) in list[8 * g..].iter().take(8).enumerate() {
                let outside = p.outside >> i & 1 != 0;
                let told = told >> i & 1 != 0;
                work.results[usize::from(*n)] = if outside {
                    Visibility::Outside
                } else if told {
                    Visibility::Occluded
                } else {
                    Visibility::Visible
                };
                work.open.add(8 * g + i, sieve.is_none() | !told);
            }
        }
        if sieve.is_some() {
            self.keep_cornerless(&mut work.open, projected, &work.corners);
        }
        for &k in work.open.numbers() {
            let (g, i) = (usize::from(k) / 8, usize::from(k) % 8);
            let n = usize::from(list[usize::from(k)]);
            let (p, eight) = (&projected[g], &work.eights[g]);
            work.results[n] = if sieve.is_some() {
                self.answer_open(l, p, i, eight)
            } else {
                self.answer(l, p, i, eight, true)
            };
        }
    }

    /// Of the boxes that are open then, most that can be seen are seen at a corner. Lists the others.
    #[inline(always)]
    pub(super) fn keep_cornerless(
        &self,
        open: &mut List,
        projected: &[Projected8],
        corners: &[Corners8],
    ) {
        for n in 0..core::mem::take(&mut open.count) {
            // What is kept goes no further back than where it was read.
            let k = usize::from(open.number(n));
            let (g, i) = (k / 8, k % 8);
            let beyond = projected[g].crossing >> i & 1 == 0;
            let seen = beyond & self.corner_seen(&corners[g], i);
            open.add(k, !seen);
        }
    }

    /// Of the boxes that are left most are simply seen, in the middle. Lists the others.
    #[inline(always)]
    fn keep_open(&self, work: &mut Work) {
        work.open.count = 0;
        for &n in work.left.numbers() {
            let n = usize::from(n);
            let (middles, i) = (&work.middles[n / 16], n % 16);
            work.results[n] = Visibility::Visible;
            work.open
                .add(n, !self.before(middles.at[i], middles.code[i]));
        }
        core::mem::swap(&mut work.left, &mut work.open);
    }
}

/// Groups of eight from the boxes of a list; gives how many.
#[inline(always)]
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

/// Answers for what a first look at the first `count` boxes tells, and lists the others.
#[inline(always)]
fn sift_all<L: Lanes>(
    l: L,
    sieve: &Sieve<'_>,
    boxes: &[Aabb; BOXES],
    count: usize,
    work: &mut Work,
) {
    let w = l.wide();
    let (boxes, _) = boxes.as_chunks::<16>();
    let (results, _) = work.results.as_chunks_mut::<8>();
    let (results, _) = results.as_chunks_mut::<2>();
    let sifted = &mut work.sifted[..count.div_ceil(16)];
    for ((sifted, middles), boxes) in sifted.iter_mut().zip(&mut work.middles).zip(boxes) {
        (*sifted, *middles) = sieve.sift(w, boxes);
    }
    for sifted in &mut *sifted {
        sifted.look_up(sieve.coarse);
    }
    for ((g, sifted), results) in sifted.iter().enumerate().zip(results) {
        let told = sifted.outside | sifted.hidden(w);
        for (half, results) in results.iter_mut().enumerate() {
            let bits = |mask: u32| (mask >> (8 * half)) as usize % 256;
            *results = TOLD[bits(sifted.outside)];
            work.left.add_eight(2 * g + half, bits(!told));
        }
    }
}
