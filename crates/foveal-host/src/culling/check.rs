//! Comparison with the exact reference: was anything culled that can be seen, was anything kept
//! that cannot.

use anyhow::Context;
use foveal_cull::reference::{Reference, Seen};
use foveal_cull::{Aabb, Eye, View, Visibility};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::around::places;
use super::frustum::is_outside;
use super::occluders::Occluders;

/// How the culler's answers compare with what is really visible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Check {
    /// Culled as occluded or outside, yet seen by a reference of the depth buffer's own resolution.
    pub false_occluded: u64,
    /// The same against four times the resolution in each axis.
    pub false_occluded_4x: u64,
    /// Hidden in the reference of the same resolution.
    pub hidden: u64,
    /// Of these, kept.
    pub missed: u64,
    /// Hidden in the reference of four times the resolution.
    pub hidden_4x: u64,
    /// Of these, kept.
    pub missed_4x: u64,
}

impl Check {
    /// Whether nothing visible was culled.
    pub fn is_safe(&self) -> bool {
        self.false_occluded == 0 && self.false_occluded_4x == 0
    }

    /// Compares `results`, one per box, with what can be seen from any place that they hold for.
    pub fn new(
        occluders: &Occluders,
        view: &View,
        (width, height): (u32, u32),
        boxes: &[Aabb],
        results: &[Visibility],
    ) -> anyhow::Result<Self> {
        let [same, fine] = [1, 4].map(|n| -> anyhow::Result<Counts> {
            let mut seen = vec![Seen::Outside; boxes.len()];
            for eye in places(view) {
                let truth = reference(occluders, &eye, n * width, n * height)?;
                look(&truth, &eye, boxes, &mut seen);
            }
            Ok(count(&seen, results))
        });
        let (same, fine) = (same?, fine?);
        Ok(Self {
            false_occluded: same.culled_but_seen,
            false_occluded_4x: fine.culled_but_seen,
            hidden: same.hidden,
            missed: same.hidden_but_kept,
            hidden_4x: fine.hidden,
            missed_4x: fine.hidden_but_kept,
        })
    }
}

fn reference(
    occluders: &Occluders,
    eye: &Eye,
    width: u32,
    height: u32,
) -> anyhow::Result<Reference> {
    let mut truth = Reference::new(eye, width, height).context("the exact reference")?;
    for &(shape, world_from_mesh) in &occluders.placed {
        let shape = &occluders.shapes[shape];
        truth.add(
            &shape.positions,
            &shape.indices,
            world_from_mesh,
            shape.two_sided,
        );
    }
    truth.finish();
    Ok(truth)
}

#[derive(Default)]
struct Counts {
    culled_but_seen: u64,
    hidden: u64,
    hidden_but_kept: u64,
}

/// Adds what one eye sees: visible to one is visible, hidden from all that it is before is hidden.
fn look(truth: &Reference, eye: &Eye, boxes: &[Aabb], seen: &mut [Seen]) {
    boxes.par_iter().zip(seen).for_each(|(bounds, seen)| {
        // The reference would follow rays through the whole screen for a box behind the eye.
        if *seen == Seen::Visible || is_outside(eye, bounds) {
            return;
        }
        let here = truth.seen(bounds, DVec3::ZERO);
        if here != Seen::Outside {
            *seen = here;
        }
    });
}

fn count(seen: &[Seen], results: &[Visibility]) -> Counts {
    let mut counts = Counts::default();
    for (seen, result) in seen.iter().zip(results) {
        let culled = matches!(result, Visibility::Occluded | Visibility::Outside);
        counts.culled_but_seen += u64::from(culled && *seen == Seen::Visible);
        counts.hidden += u64::from(*seen == Seen::Hidden);
        counts.hidden_but_kept += u64::from(result.is_visible() && *seen == Seen::Hidden);
    }
    counts
}
