//! Frames of one eye: culled, timed, counted.

use std::time::Instant;

use anyhow::Context;
use foveal_cull::{Culler, OccludeeTree, View, Visibility};
use glam::DVec3;
use serde::Serialize;

use foveal_host::culling::Clock;
use foveal_host::culling::{CullingArgs, Occludees, Subject, Workers};
use foveal_measure::median;

/// The figures of one eye, those that Intel's occlusion culling sample shows. Times are medians.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Figures {
    pub(crate) occluders: OccluderFigures,
    pub(crate) occludees: OccludeeFigures,
    pub(crate) draw_calls: DrawCalls,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct OccluderFigures {
    pub(crate) models: u64,
    pub(crate) rasterized_models: u64,
    pub(crate) triangles: u64,
    pub(crate) rasterized_triangles: u64,
    pub(crate) rasterize_ms: f64,
    /// Clusters of the last frame that the time budget left out.
    pub(crate) clusters_over_budget: u64,
    pub(crate) size_threshold: f32,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct OccludeeFigures {
    pub(crate) models: u64,
    pub(crate) culled: u64,
    pub(crate) culled_by_frustum: u64,
    pub(crate) culled_by_size: u64,
    pub(crate) culled_by_occlusion: u64,
    pub(crate) visible: u64,
    pub(crate) triangles: u64,
    pub(crate) culled_triangles: u64,
    pub(crate) visible_triangles: u64,
    pub(crate) test_ms: f64,
    /// The same objects by their hierarchy, on one thread.
    pub(crate) tree_test_ms: f64,
    pub(crate) size_threshold: f32,
}

/// How many draws are issued without culling, with the frustum alone, and with everything.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub(crate) struct DrawCalls {
    pub(crate) off: u64,
    pub(crate) frustum: u64,
    pub(crate) occlusion: u64,
}

/// What one eye gave.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) figures: Figures,
    /// One per occludee.
    pub(crate) results: Vec<Visibility>,
}

/// Culls a view `frames` times (and once before, to warm up) and takes the medians.
pub(crate) fn measure(
    culler: &mut Culler,
    workers: &Workers,
    subject: &Subject,
    view: &View,
    culling: &CullingArgs,
    frames: u32,
) -> anyhow::Result<Outcome> {
    let Occludees {
        boxes,
        triangles,
        draws,
        ..
    } = &subject.occludees;
    let mut results = vec![Visibility::Visible; boxes.len()];
    let tree = OccludeeTree::build(boxes, DVec3::ZERO);
    let mut by_tree = results.clone();
    let (mut rasterize_ms, mut test_ms, mut tree_ms) = (Vec::new(), Vec::new(), Vec::new());
    let mut frame = || -> Result<[f64; 3], foveal_cull::CullError> {
        let start = Instant::now();
        let clock = Clock::start();
        let clock = || clock.now_ns();
        let options = culling.options(&clock);
        workers.rasterize(culler, view, &subject.occluders.set, &options)?;
        let between = Instant::now();
        workers.query(culler, boxes, &mut results)?;
        let tested = Instant::now();
        culler.query_tree(&tree, &mut by_tree)?;
        let times = [between - start, tested - between, tested.elapsed()];
        Ok(times.map(|d| d.as_secs_f64() * 1e3))
    };
    for n in 0..=frames {
        let [rasterize, test, tree] = frame().context("this view cannot be culled")?;
        if n > 0 {
            rasterize_ms.push(rasterize);
            test_ms.push(test);
            tree_ms.push(tree);
        }
    }
    culler.count(&results, Some(triangles))?;
    let stats = culler.stats();
    let figures = Figures {
        occluders: OccluderFigures {
            models: subject.occluders.set.len() as u64,
            rasterized_models: stats.occluder_models_rasterized,
            triangles: subject.occluders.set.triangle_count() as u64,
            rasterized_triangles: stats.occluder_triangles_rasterized,
            rasterize_ms: median(&rasterize_ms),
            clusters_over_budget: stats.clusters_over_budget,
            size_threshold: culling.occluder_size_threshold,
        },
        occludees: OccludeeFigures {
            models: stats.occludees,
            culled: stats.occludees_culled(),
            culled_by_frustum: stats.occludees_outside,
            culled_by_size: stats.occludees_small,
            culled_by_occlusion: stats.occludees_occluded,
            visible: stats.occludees_visible,
            triangles: stats.occludee_triangles,
            culled_triangles: stats.occludee_triangles_culled(),
            visible_triangles: stats.occludee_triangles_visible,
            test_ms: median(&test_ms),
            tree_test_ms: median(&tree_ms),
            size_threshold: culling.occludee_size_threshold,
        },
        draw_calls: draw_calls(draws, &results),
    };
    Ok(Outcome { figures, results })
}

fn draw_calls(draws: &[u32], results: &[Visibility]) -> DrawCalls {
    let mut calls = DrawCalls::default();
    for (&draws, result) in draws.iter().zip(results) {
        let draws = u64::from(draws);
        calls.off += draws;
        calls.frustum += if *result == Visibility::Outside {
            0
        } else {
            draws
        };
        calls.occlusion += if result.is_visible() { draws } else { 0 };
    }
    calls
}
