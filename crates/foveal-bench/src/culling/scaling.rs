//! How cost grows: with occluder triangles, boxes, resolution and threads.
//!
//! Occluders are the demo scene's opaque instances, shuffled by a hash and taken until their
//! triangles reach the wanted number; beyond the whole town, copies of it stand around it. Boxes
//! are random ones within the town. The eye is the demo scene's first camera. What does not vary is
//! 1 million triangles, 27,000 boxes, 640x360 and one thread. Times are the shortest of all
//! repetitions: how work grows, not how busy the machine is.

use std::path::Path;

use foveal_cull::FrameOptions;
use foveal_scene::Scene;
use glam::{DAffine3, DVec3};
use serde::Serialize;

use super::boxes;
use super::cameras::Cameras;
use super::case::Case;
use super::plot::{self, Panel};
use super::rows::Row;
use foveal_host::culling::CullingArgs;
use foveal_host::culling::Workers;
use foveal_host::culling::{Choice, Occluders};
use foveal_host::progress::progress_bar;
use foveal_host::{atomic_file, console, scene_source};

const TRIANGLES: [u64; 9] = [
    1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000,
];
const BOXES: [u32; 7] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000];
const SIZES: [(u32, u32); 5] = [
    (320, 192),
    (640, 360),
    (1280, 720),
    (1920, 1080),
    (3840, 2160),
];
const THREADS: [u32; 4] = [1, 2, 4, 8];

/// What stays the same while one thing varies.
#[derive(Clone, Copy)]
struct Point {
    triangles: u64,
    boxes: u32,
    size: (u32, u32),
    threads: u32,
}

const BASE: Point = Point {
    triangles: 1_000_000,
    boxes: 27_000,
    size: (640, 360),
    threads: 1,
};

/// Measures all series and writes `file` and its plot.
pub(super) fn run(file: &Path, repetitions: u32, quiet: bool) -> anyhow::Result<()> {
    let svg = file.with_extension("svg");
    if svg == file {
        return foveal_host::failure::usage("--scaling writes CSV: its name must not end in .svg");
    }
    atomic_file::check_writable(file)?;
    atomic_file::check_writable(&svg)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = THREADS.into_iter().filter(|&t| t as usize <= cores);
    let series: [(&str, Vec<Point>); 4] = [
        (
            "occluder_triangles",
            TRIANGLES
                .map(|triangles| Point { triangles, ..BASE })
                .into(),
        ),
        ("boxes", BOXES.map(|boxes| Point { boxes, ..BASE }).into()),
        (
            "resolution",
            SIZES.map(|size| Point { size, ..BASE }).into(),
        ),
        (
            "threads",
            threads.map(|threads| Point { threads, ..BASE }).collect(),
        ),
    ];
    let town = Town::new()?;
    let total: usize = series.iter().map(|(_, points)| points.len()).sum();
    let progress = progress_bar(total as u64, "points", quiet);
    let mut measured: Vec<(&str, Vec<Row>)> = Vec::new();
    for (name, points) in &series {
        let mut rows = Vec::new();
        for point in points {
            rows.push(town.measure(point, repetitions)?);
            progress.inc(1);
        }
        measured.push((name, rows));
    }
    progress.finish_and_clear();
    atomic_file::write(file, &csv(&measured)?)?;
    atomic_file::write(&svg, plot::svg(&panels(&measured)).as_bytes())?;
    console::print_result(&format!("wrote {} and {}\n", file.display(), svg.display()))
}

/// The demo scene, from which all points are made.
struct Town {
    scene: Scene,
    all: Occluders,
    /// Numbers of placed occluders, shuffled.
    order: Vec<u32>,
}

impl Town {
    fn new() -> anyhow::Result<Self> {
        let scene = scene_source::load(scene_source::DEFAULT_SCENE)?;
        let all = Occluders::of_scene(&scene, &Choice::All)?;
        let mut order: Vec<u32> = (0..all.placed.len() as u32).collect();
        order.sort_by(|&a, &b| boxes::unit(a).total_cmp(&boxes::unit(b)).then(a.cmp(&b)));
        Ok(Self { scene, all, order })
    }

    fn measure(&self, point: &Point, repetitions: u32) -> anyhow::Result<Row> {
        let aspect = f64::from(point.size.0) / f64::from(point.size.1);
        let eyes = Cameras::new(&self.scene, &self.all, None)?.eyes(aspect)?;
        let occluders = self.occluders(point.triangles)?;
        let boxes = boxes::random(self.scene.bounds(), point.boxes);
        let case = Case {
            scene: &self.scene.name,
            eye: &eyes[0],
            size: point.size,
            occluders: &occluders,
            boxes: &boxes,
            culling: &CullingArgs {
                occluders: Choice::All,
                occluder_size_threshold: 0.0,
                occluder_pixels_per_quad: FrameOptions::default().occluder_pixels_per_quad,
                occludee_size_threshold: 0.0,
                eyes_apart: 0.0,
                validity_radius: 0.0,
                budget_ms: None,
            },
            objects: &[],
            learn: false,
        };
        let workers = [(point.threads, Workers::new(point.threads))];
        let mut rows = case.measure(&workers, repetitions, false)?;
        Ok(rows.swap_remove(0))
    }

    fn occluders(&self, triangles: u64) -> anyhow::Result<Occluders> {
        let mut chosen = Occluders::default();
        let size = self.scene.bounds().size().as_dvec3();
        let mut count = 0;
        for copy in 0.. {
            let before = count;
            let offset = DAffine3::from_translation(size * spiral(copy));
            for &i in &self.order {
                if count >= triangles {
                    return Ok(chosen);
                }
                let (shape, placed) = self.all.placed[i as usize];
                let mesh = &self.all.meshes[shape];
                chosen.set.add(mesh.clone(), offset * placed)?;
                count += mesh.triangle_count() as u64;
            }
            if count == before {
                break;
            }
        }
        Ok(chosen)
    }
}

/// Squares of a grid in rings around (0, 0).
fn spiral(copy: u32) -> DVec3 {
    let mut left = copy;
    for ring in 0_i32.. {
        for x in -ring..=ring {
            for z in -ring..=ring {
                if x.abs().max(z.abs()) != ring {
                    continue;
                }
                if left == 0 {
                    return DVec3::new(x.into(), 0.0, z.into());
                }
                left -= 1;
            }
        }
    }
    DVec3::ZERO
}

/// One line of the CSV.
#[derive(Serialize)]
struct Line<'a> {
    series: &'a str,
    occluder_triangles: u64,
    query_boxes: u64,
    width: u32,
    height: u32,
    threads: u32,
    raster_ms: String,
    query_ms: String,
    query_ns_per_box: String,
}

fn csv(series: &[(&str, Vec<Row>)]) -> anyhow::Result<Vec<u8>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    for (series, rows) in series {
        for r in rows {
            let ns = r.query_min_ms * 1e6 / r.query_boxes.max(1) as f64;
            table.serialize(Line {
                series,
                occluder_triangles: r.occluder_triangles,
                query_boxes: r.query_boxes,
                width: r.width,
                height: r.height,
                threads: r.threads,
                raster_ms: format!("{:.6}", r.raster_min_ms),
                query_ms: format!("{:.6}", r.query_min_ms),
                query_ns_per_box: format!("{ns:.3}"),
            })?;
        }
    }
    Ok(table.into_inner()?)
}

fn panels(series: &[(&str, Vec<Row>)]) -> Vec<Panel> {
    series
        .iter()
        .map(|(name, rows)| {
            let x = |r: &Row| match *name {
                "occluder_triangles" => r.occluder_triangles as f64,
                "boxes" => r.query_boxes as f64,
                "resolution" => f64::from(r.width) * f64::from(r.height),
                _ => f64::from(r.threads),
            };
            Panel {
                title: match *name {
                    "resolution" => "pixels".to_owned(),
                    name => name.replace('_', " "),
                },
                lines: vec![
                    (
                        "rasterize",
                        rows.iter().map(|r| (x(r), r.raster_min_ms)).collect(),
                    ),
                    (
                        "test boxes",
                        rows.iter().map(|r| (x(r), r.query_min_ms)).collect(),
                    ),
                ],
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_the_town_never_stand_in_each_other() {
        let mut places: Vec<String> = (0..50).map(|c| spiral(c).to_string()).collect();
        assert_eq!(spiral(0), DVec3::ZERO);
        places.sort();
        places.dedup();
        assert_eq!(places.len(), 50);
    }
}
