//! One view of one scene, measured with each number of threads.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

use foveal_cull::{Culler, Visibility};
use serde::Serialize;

use foveal_host::culling::Check;
use foveal_host::culling::Clock;
use foveal_host::culling::Workers;
use foveal_measure::median;

use super::case::Case;
use super::learned::LearnedColumns;

const WARM_UP: u32 = 3;

/// A row of the report.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) camera: String,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) threads: u32,
    pub(super) occluder_triangles: u64,
    pub(super) raster_ms: f64,
    /// The shortest.
    pub(super) raster_min_ms: f64,
    pub(super) query_boxes: u64,
    pub(super) query_ms: f64,
    pub(super) query_min_ms: f64,
    pub(super) query_ns_per_box: f64,
    pub(super) culled: u64,
    pub(super) visible: u64,
    #[serde(flatten)]
    pub(super) check: CheckColumns,
    #[serde(flatten)]
    pub(super) learned: LearnedColumns,
}

/// `null` unless compared.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct CheckColumns {
    pub(super) false_occluded: Option<u64>,
    pub(super) false_occluded_4x: Option<u64>,
    pub(super) hidden: Option<u64>,
    pub(super) missed: Option<u64>,
    pub(super) hidden_4x: Option<u64>,
    pub(super) missed_4x: Option<u64>,
}

impl From<Check> for CheckColumns {
    fn from(check: Check) -> Self {
        Self {
            false_occluded: Some(check.false_occluded),
            false_occluded_4x: Some(check.false_occluded_4x),
            hidden: Some(check.hidden),
            missed: Some(check.missed),
            hidden_4x: Some(check.hidden_4x),
            missed_4x: Some(check.missed_4x),
        }
    }
}

impl Row {
    /// Whether the comparison found something visible that was culled.
    pub(super) fn is_wrong(&self) -> bool {
        let wrong = |count: Option<u64>| count.is_some_and(|c| c > 0);
        wrong(self.check.false_occluded) || wrong(self.check.false_occluded_4x)
    }
}

impl Case<'_> {
    /// A row for each of `workers`, which take turns.
    pub(super) fn measure(
        &self,
        workers: &[(u32, Workers)],
        repetitions: u32,
        check: bool,
    ) -> anyhow::Result<Vec<Row>> {
        let mut culler = Culler::new(self.size.0, self.size.1)?;
        let view = self.culling.view(&self.eye.eye)?;
        let mut results = vec![Visibility::Visible; self.boxes.len()];
        let mut times: Vec<[Vec<f64>; 2]> = workers.iter().map(|_| Default::default()).collect();
        for repetition in 0..WARM_UP + repetitions {
            for ((_, workers), [raster_ms, query_ms]) in workers.iter().zip(&mut times) {
                let start = Instant::now();
                let clock = Clock::start();
                let clock = || clock.now_ns();
                let options = self.culling.options(&clock);
                workers.rasterize(&mut culler, &view, &self.occluders.set, &options)?;
                let between = Instant::now();
                workers.query(&culler, self.boxes, &mut results)?;
                let [raster, query] =
                    [between - start, between.elapsed()].map(|d| d.as_secs_f64() * 1e3);
                if repetition >= WARM_UP {
                    raster_ms.push(raster);
                    query_ms.push(query);
                }
            }
        }
        let check = if check {
            Check::new(self.occluders, &view, self.size, self.boxes, &results)?.into()
        } else {
            CheckColumns::default()
        };
        let visible = results.iter().filter(|r| r.is_visible()).count() as u64;
        let boxes = self.boxes.len() as u64;
        let rows = workers.iter().zip(&mut times);
        rows.map(|((threads, workers), [raster_ms, query_ms])| {
            let learned = match self.learn {
                true => LearnedColumns::measure(self, workers)?,
                false => LearnedColumns::default(),
            };
            let least = |ms: &[f64]| ms.iter().copied().fold(f64::INFINITY, f64::min);
            let (raster_min_ms, query_min_ms) = (least(raster_ms), least(query_ms));
            let query_ms = median(query_ms);
            Ok(Row {
                scene: self.scene.to_owned(),
                camera: self.eye.name.clone(),
                width: self.size.0,
                height: self.size.1,
                threads: *threads,
                occluder_triangles: self.occluders.set.triangle_count() as u64,
                raster_ms: median(raster_ms),
                raster_min_ms,
                query_boxes: boxes,
                query_ms,
                query_min_ms,
                query_ns_per_box: query_ms * 1e6 / (boxes.max(1) as f64),
                culled: boxes - visible,
                visible,
                check,
                learned,
            })
        })
        .collect()
    }
}

/// For a human.
pub(super) fn table(rows: &[Row]) -> String {
    let width = |of: fn(&Row) -> &str, title: &str| {
        rows.iter()
            .map(|r| of(r).chars().count())
            .chain([title.len()])
            .max()
            .unwrap_or(0)
    };
    let scene = width(|r| &r.scene, "scene");
    let camera = width(|r| &r.camera, "camera");
    let mut text = format!(
        "{:scene$}  {:camera$}  {:>9}  {:>7}  {:>10}  {:>9}  {:>9}  {:>6}  {:>6}  {:>7}  {:>5}  {:>8}  {:>6}  {:>6}\n",
        "scene",
        "camera",
        "size",
        "threads",
        "triangles",
        "raster ms",
        "query ms",
        "ns/box",
        "culled",
        "visible",
        "wrong",
        "wrong 4x",
        "hidden",
        "missed"
    );
    let count = |count: Option<u64>| count.map_or_else(|| "-".to_owned(), |c| c.to_string());
    for r in rows {
        let _ = writeln!(
            text,
            "{:scene$}  {:camera$}  {:>9}  {:>7}  {:>10}  {:>9.3}  {:>9.3}  {:>6.1}  {:>6}  {:>7}  {:>5}  {:>8}  {:>6}  {:>6}",
            r.scene,
            r.camera,
            format!("{}x{}", r.width, r.height),
            r.threads,
            r.occluder_triangles,
            r.raster_ms,
            r.query_ms,
            r.query_ns_per_box,
            r.culled,
            r.visible,
            count(r.check.false_occluded),
            count(r.check.false_occluded_4x),
            count(r.check.hidden),
            count(r.check.missed),
        );
    }
    text + &learned_table(rows)
}

/// What learning gains at all cameras of a scene, by size and number of threads; empty unless it was
/// measured.
fn learned_table(rows: &[Row]) -> String {
    let mut by_kind: BTreeMap<_, Vec<[f64; 4]>> = BTreeMap::new();
    for row in rows {
        let l = row.learned;
        if let (Some(all_ms), Some(learned_ms), Some(all), Some(learned)) = (
            l.moving_ms,
            l.learned_ms,
            l.moving_visible,
            l.learned_visible,
        ) {
            let kind = (&row.scene, row.width, row.height, row.threads);
            let figures = [all_ms, learned_ms, all, learned];
            by_kind.entry(kind).or_default().push(figures);
        }
    }
    let mut text = String::new();
    for ((scene, width, height, threads), cameras) in by_kind {
        let [all_ms, learned_ms, all, learned] =
            [0, 1, 2, 3].map(|k| cameras.iter().map(|c| c[k]).sum::<f64>() / cameras.len() as f64);
        let ratios: Vec<f64> = cameras.iter().map(|c| c[1] / c[0]).collect();
        let _ = writeln!(
            text,
            "{scene}, {width}x{height}, {threads} threads, {} moving cameras: useful occluders take {:.2} \
             of the time of all (median), {learned_ms:.3} ms instead of {all_ms:.3} (mean); \
             {learned:.1} objects are visible instead of {all:.1}",
            cameras.len(),
            median(&ratios),
        );
    }
    text
}
