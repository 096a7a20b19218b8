//! `foveal bench culling`: what rasterizing occluders and testing boxes cost on the CPU.
//!
//! For each scene, camera and size a row per number of threads, as docs/cull-schema.md describes.
//! Times are medians; numbers of threads take turns within each repetition, so that a busy machine
//! is unfair to none.

mod boxes;
mod cameras;
mod case;
mod inside;
mod learned;
mod plot;
mod rows;
mod scaling;

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use cameras::Cameras;
use case::Case;
use foveal_host::culling::CullingArgs;
use foveal_host::culling::Occludees;
use foveal_host::culling::Occluders;
use foveal_host::culling::Workers;
use foveal_host::import_args::ImportArgs;
use foveal_host::progress::progress_bar;
use foveal_host::{atomic_file, console, scene_source, values};
use rows::Row;

use super::figures::check_figures;
use super::subject::warn;

/// Arguments of `foveal bench culling`.
#[derive(Debug, Clone, clap::Args)]
pub struct Args {
    /// glTF 2.0, OBJ or PLY files, or generated scenes
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    scenes: Vec<String>,

    #[command(flatten)]
    culling: CullingArgs,

    #[command(flatten)]
    import: ImportArgs,

    /// Cameras: `inside` adds up to 48 at eye height above floors with free space around, found in
    /// the scene, to the scene's own and eight around it. A JSON list, as for `foveal cull`,
    /// replaces them all
    #[arg(long, value_name = "inside|FILE.json")]
    cameras: Option<cameras::Choice>,

    /// Sizes of the occlusion buffer in pixels
    #[arg(long, value_name = "WxH,…", value_parser = values::size, value_delimiter = ',')]
    #[arg(default_value = "640x360,1280x720")]
    sizes: Vec<(u32, u32)>,

    /// Numbers of threads
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "1,2")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=256))]
    threads: Vec<u32>,

    /// Number of random boxes to test
    #[arg(long, value_name = "N", default_value_t = 27_000)]
    boxes: u32,

    /// Repetitions, after three that warm up; times are their medians
    #[arg(long, value_name = "N", default_value_t = 31, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repetitions: u32,

    /// Compare with the exact reference at the same resolution and at four times it (slow). Exit
    /// code 1 if anything visible was culled
    #[arg(long)]
    check: bool,

    /// Also move each camera from side to side for 240 frames, and measure what learning from frame to
    /// frame gains: which occluders help to hide the scene's own objects
    #[arg(long)]
    learn: bool,

    /// Write the rows as JSON (see docs/cull-schema.md); `-` prints them instead of the table
    #[arg(long, value_name = "FILE.json|-")]
    json: Option<PathBuf>,

    /// Write cost against occluder triangles, boxes, resolution and threads as CSV, with a plot
    /// beside it (.svg). Generated scenes replace SCENE
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["scenes", "cameras", "json", "check", "learn", "threads", "boxes", "CullingArgs", "ImportArgs"])]
    scaling: Option<PathBuf>,

    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    instruction_set: String,
    repetitions: u32,
    rows: &'a [Row],
}

/// Measures what the arguments ask for.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(file) = &args.scaling {
        return scaling::run(file, args.repetitions, args.quiet);
    }
    let json_to_stdout = args.json.as_deref() == Some(Path::new("-"));
    let json_file = args.json.as_ref().filter(|_| !json_to_stdout);
    if let Some(file) = json_file {
        let cameras = match &args.cameras {
            Some(cameras::Choice::File(cameras)) => Some(cameras.as_path()),
            _ => None,
        };
        check_figures(file, &args.scenes, cameras)?;
    }
    scene_source::check_once(&args.scenes)?;
    let rows = measure(args)?;
    if args.json.is_some() {
        let report = Report {
            schema: "foveal-bench-culling",
            schema_version: 1,
            program_version: env!("CARGO_PKG_VERSION"),
            instruction_set: format!("{:?}", foveal_cull::InstructionSet::detect()),
            repetitions: args.repetitions,
            rows: &rows,
        };
        let json = serde_json::to_string_pretty(&report)? + "\n";
        match json_file {
            Some(file) => atomic_file::write(file, json.as_bytes())?,
            None => console::print_result(&json)?,
        }
    }
    if !json_to_stdout {
        console::print_result(&rows::table(&rows))?;
    }
    if rows.iter().any(Row::is_wrong) {
        anyhow::bail!("visible boxes were culled; see the columns 'wrong' and 'wrong 4x'");
    }
    Ok(())
}

fn measure(args: &Args) -> anyhow::Result<Vec<Row>> {
    let workers: Vec<(u32, Workers)> = args
        .threads
        .iter()
        .map(|&count| (count, Workers::new(count)))
        .collect();
    let mut rows = Vec::new();
    for name in &args.scenes {
        let scene = scene_source::load_among(name, &args.import.options())?;
        warn(&scene);
        let occluders = Occluders::of_scene(&scene, &args.culling.occluders)?;
        let boxes = boxes::random(scene.bounds(), args.boxes);
        let objects = Occludees::of_scene(&scene);
        let cameras = Cameras::new(&scene, &occluders, args.cameras.as_ref())?;
        let mut cases = Vec::new();
        for &(width, height) in &args.sizes {
            let aspect = f64::from(width) / f64::from(height);
            for eye in cameras.eyes(aspect)? {
                cases.push(((width, height), eye));
            }
        }
        let progress = progress_bar(cases.len() as u64, "views", args.quiet);
        for (size, eye) in &cases {
            let case = Case {
                scene: &scene.name,
                eye,
                size: *size,
                occluders: &occluders,
                boxes: &boxes,
                culling: &args.culling,
                objects: &objects.boxes,
                learn: args.learn,
            };
            let measured = case
                .measure(&workers, args.repetitions, args.check)
                .with_context(|| format!("the camera '{}' of '{}'", eye.name, scene.name))?;
            rows.extend(measured);
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    fn args(words: &[&str]) -> Args {
        let line = ["culling", "--quiet", "--repetitions", "1"]
            .iter()
            .chain(words);
        Line::try_parse_from(line).unwrap().args
    }

    #[test]
    fn there_is_a_row_per_camera_size_and_number_of_threads() {
        let rows = measure(&args(&[
            "cornell",
            "--sizes",
            "64x32,32x64",
            "--boxes",
            "100",
        ]))
        .unwrap();
        let scene = scene_source::load("cornell").unwrap();
        let cameras = foveal_host::culling::own_cameras(&scene).len() + 8;
        assert_eq!(rows.len(), cameras * 2 * 2);
        let json = serde_json::to_value(&rows[0]).unwrap();
        for key in [
            "scene",
            "camera",
            "width",
            "height",
            "threads",
            "occluder_triangles",
            "raster_ms",
            "query_boxes",
            "query_ms",
            "query_ns_per_box",
            "culled",
            "visible",
            "false_occluded",
            "false_occluded_4x",
            "missed",
        ] {
            assert!(json.get(key).is_some(), "{key}");
        }
        assert!(json["missed"].is_null());
    }

    #[test]
    fn cameras_inside_come_besides_the_others_or_are_refused() {
        let words = ["--cameras", "inside", "--sizes", "64x32", "--threads", "1"];
        let with = |scene: &str, words: &[&str]| measure(&args(&[&[scene], words].concat()));
        let all = with("demo:1000", &words).unwrap();
        let others = with("demo:1000", &words[2..]).unwrap();
        let inside = all.len() - others.len();
        assert!(inside > 0 && inside.is_multiple_of(4), "{inside}");
        let scene = scene_source::load("cornell").unwrap();
        let choice = Some(&cameras::Choice::Inside);
        let refused = Cameras::new(&scene, &Occluders::default(), choice);
        let refused = refused.err().unwrap().to_string();
        assert!(refused.contains("no floor"), "{refused}");
    }

    #[test]
    fn learning_is_measured_where_it_is_asked_for() {
        let words = [
            "demo:1000",
            "--sizes",
            "96x54",
            "--boxes",
            "10",
            "--threads",
            "1",
        ];
        let plain = measure(&args(&words)).unwrap();
        assert!(plain[0].learned.learned_ms.is_none());
        let rows = measure(&args(&[&words[..], &["--learn"]].concat())).unwrap();
        let learned = rows[0].learned;
        assert!(learned.learned_ms.unwrap() > 0.0 && learned.moving_ms.unwrap() > 0.0);
        let [all, useful] = [learned.moving_visible, learned.learned_visible].map(Option::unwrap);
        assert!(all > 0.0 && useful >= all * 0.9, "{all} {useful}");
        assert!(rows::table(&rows).contains("objects are visible"));
        assert!(!rows::table(&plain).contains("objects are visible"));
    }

    #[test]
    fn checked_rows_have_no_visible_box_culled() {
        let rows = measure(&args(&[
            "demo:1000",
            "--sizes",
            "96x54",
            "--boxes",
            "500",
            "--check",
        ]))
        .unwrap();
        assert!(!rows.is_empty() && !rows.iter().any(Row::is_wrong));
        assert!(rows.iter().all(|r| r.check.missed.is_some()));
    }
}
