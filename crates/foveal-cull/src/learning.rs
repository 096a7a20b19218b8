//! What occluders were worth in a frame: hidden boxes, laid over the record of the rasterizer.

use crate::bounds::Aabb;
use crate::culler::{Culler, Drawn};
use crate::error::CullError;
use crate::format::{BLOCK, SAMPLES};
use crate::occluder::OccluderUsefulness;
use crate::occluder::set::OccluderSet;
use crate::occluder::usefulness::{ObservedBoxes, Outcome};
use crate::projection::boxes::Boxes8;
use crate::projection::near::{Clipped, clip_box};
use crate::projection::project::project;
use crate::projection::screen::Screen;
use crate::query::classify::Query;
use crate::query::moving::OccludeeSet;
use crate::query::rect::PixelRect;
use crate::raster::draw::work_of;
use crate::simd::{Kernel, Lanes};
use crate::visibility::Visibility;
use glam::DVec3;

/// Hidden boxes that one call looks at, at most. The next frame goes on with the others.
const MOST_BOXES: usize = 256;

/// Calls within a frame that remember each by itself with which box the next frame begins.
const MOST_CALLS: usize = 1024;

impl OccluderUsefulness {
    /// Observes results of the culler's frame: as many calls as there were queries, before
    /// [`learn`](Self::learn). Boxes are in metres relative to `origin` (world).
    ///
    /// Up to 256 hidden boxes are looked at, others in the next frame.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if there are not as many results as boxes.
    pub fn observe(
        &mut self,
        culler: &Culler,
        boxes: &[Aabb],
        origin: impl Into<[f64; 3]>,
        results: &[Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(boxes.len(), results.len())?;
        if let Some(query) = culler.prepared(DVec3::from(origin.into())) {
            culler.instruction_set().run(LayOver {
                query: &query,
                boxes,
                results,
                observed: &mut self.observed,
            });
        }
        Ok(())
    }

    /// Observes the results of [`Culler::query_set`], as [`observe`](Self::observe) does.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `results` has not [`OccludeeSet::result_count`] elements.
    pub fn observe_set(
        &mut self,
        culler: &Culler,
        set: &OccludeeSet,
        results: &[Visibility],
    ) -> Result<(), CullError> {
        self.observe(culler, set.boxes(), set.origin(), results)
    }

    /// Learns what the occluders of the culler's frame were worth, from what was observed since the
    /// last call. Learns nothing if nothing was observed, or if the frame was rasterized without
    /// [`FrameOptions::usefulness`](crate::FrameOptions::usefulness), or if the culler has a buffer of
    /// another size than the one whose results were observed.
    ///
    /// `occluders` is the set that was rasterized.
    pub fn learn(&mut self, culler: &Culler, occluders: &OccluderSet) {
        self.observed.calls = 0;
        if !core::mem::take(&mut self.observed.has_results) {
            return;
        }
        let blocks = self.observed.blocks;
        let Some(drawn) = culler.recorded().filter(|d| d.blocks == blocks) else {
            self.observed.box_counts.fill(0);
            return;
        };
        self.count_frame();
        let mut outcomes = core::mem::take(&mut self.outcomes);
        self.find_outcomes(&drawn, occluders, &mut outcomes);
        let drawn_ones = outcomes.iter().flatten();
        let work = drawn_ones.map(|outcome| u64::from(outcome.work)).sum();
        if drawn.ns > 0 {
            self.learn_unit_time(drawn.ns, work);
        }
        for (candidate, outcome) in drawn.candidates.iter().zip(&outcomes) {
            let (slot, cluster) = candidate.place();
            let known = occluders.instances.get(slot as usize);
            if let Some(outcome) = *outcome
                && let Some(instance) = known.filter(|i| cluster < i.clusters)
            {
                let first = self.make_entries(slot as usize, instance);
                self.add_outcome(first + cluster as usize, outcome);
            }
        }
        self.outcomes = outcomes;
        self.observed.box_counts.fill(0);
    }

    /// What each candidate did; none for those that were not drawn.
    fn find_outcomes(
        &mut self,
        drawn: &Drawn<'_>,
        occluders: &OccluderSet,
        outcomes: &mut Vec<Option<Outcome>>,
    ) {
        outcomes.clear();
        outcomes.resize(drawn.candidates.len(), None);
        for &candidate in drawn.drawn.iter().flatten() {
            let (slot, cluster) = drawn.candidates[candidate as usize].place();
            let mesh = occluders.instances.get(slot as usize);
            let cluster = mesh
                .and_then(|i| i.mesh.as_deref())
                .and_then(|mesh| mesh.clusters.get(cluster as usize));
            outcomes[candidate as usize] = Some(Outcome {
                hidden_blocks: 0,
                work: cluster.map_or(0, work_of),
            });
        }
        // From differences to boxes over each block, then to sums from the left.
        let width = drawn.blocks[0] as usize + 1;
        for row in self.observed.box_counts.chunks_mut(width) {
            let (mut boxes, mut sum) = (0i32, 0i32);
            for at in row {
                boxes = boxes.saturating_add(*at);
                *at = sum;
                sum = sum.saturating_add(boxes);
            }
        }
        for touched in drawn.touched.iter().flatten() {
            if let Some(outcome) = &mut outcomes[touched.candidate as usize] {
                let row = usize::from(touched.row) * width;
                let sum = |block: u16| self.observed.box_counts.get(row + usize::from(block));
                let ends = sum(touched.first).zip(sum(touched.last + 1));
                let hidden = ends.map_or(0, |(first, end)| end.saturating_sub(*first).max(0));
                outcome.hidden_blocks = outcome.hidden_blocks.saturating_add(hidden as u32);
                outcome.work = outcome.work.saturating_add(touched.work.into());
            }
        }
    }
}

/// The kernel that lays hidden boxes over the blocks of the buffer.
struct LayOver<'a> {
    query: &'a Query<'a>,
    boxes: &'a [Aabb],
    results: &'a [Visibility],
    observed: &'a mut ObservedBoxes,
}

impl Kernel for LayOver<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self {
            query,
            boxes,
            results,
            observed,
        } = self;
        let width = query.buffer.blocks_x as usize + 1;
        if !observed.has_results {
            observed.has_all_hidden = true;
        }
        observed.has_results = true;
        let blocks = [query.buffer.blocks_x, query.buffer.blocks_y];
        if observed.blocks != blocks {
            observed.blocks = blocks;
            observed.box_counts.clear();
        }
        observed.box_counts.resize(width * blocks[1] as usize, 0);
        if boxes.is_empty() {
            return;
        }
        let screen = Screen {
            hiz: None,
            ..query.screen
        };
        let call = observed.calls;
        observed.calls += 1;
        if observed.first_boxes.len() <= call {
            observed.first_boxes.resize(call.min(MOST_CALLS) + 1, 0);
        }
        let call = call.min(MOST_CALLS);
        let start = observed.first_boxes[call] % boxes.len();
        let mut hidden = (start..boxes.len())
            .chain(0..start)
            // Invalid boxes are the free places of a set: results there mean nothing.
            .filter(|&i| results[i] == Visibility::Occluded && boxes[i].is_valid())
            .take(MOST_BOXES);
        let mut seen = 0;
        loop {
            let mut eight = [Aabb::EMPTY; 8];
            let mut count = 0;
            for (to, i) in eight.iter_mut().zip(&mut hidden) {
                *to = boxes[i];
                observed.first_boxes[call] = i + 1;
                count += 1;
                seen += 1;
            }
            let p = project(l, &screen, &Boxes8::of(l, &eight));
            for i in (0..count).filter(|i| p.outside >> i & 1 == 0) {
                let place = if p.crossing >> i & 1 == 0 {
                    Some(p.pixels.map(|v| v[i] as u32 / BLOCK))
                } else {
                    crossing(&screen, eight[i])
                };
                let Some([x0, y0, x1, y1]) = place.map(|b| b.map(|b| b as usize)) else {
                    continue;
                };
                for row in observed.box_counts.chunks_mut(width).take(y1 + 1).skip(y0) {
                    row[x0] = row[x0].saturating_add(1);
                    row[x1 + 1] = row[x1 + 1].saturating_sub(1);
                }
            }
            if count < 8 {
                observed.has_all_hidden &= seen < MOST_BOXES;
                return;
            }
        }
    }
}

/// Blocks of a hidden box that crosses the near plane.
fn crossing(screen: &Screen<'_>, bounds: Aabb) -> Option<[u32; 4]> {
    let Clipped::Rect(rect, _) = clip_box(screen, bounds.center(), bounds.half_extent()) else {
        return None;
    };
    let [width, height] = [screen.width, screen.height].map(|v| v as u32 / SAMPLES);
    Some(PixelRect::from_samples(rect, width, height).blocks())
}
