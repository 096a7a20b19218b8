//! `foveal cull`: occlusion culling alone, on the CPU.
//!
//! In the order of a run: the arguments are checked, the scene or recording becomes subjects
//! (occluders, boxes, eyes), each eye is culled and timed, compared with the exact reference where
//! wanted, and drawn.

mod args;
mod measure;
mod picture;
mod report;
mod table;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use foveal_cull::Culler;

pub(crate) use args::Args;

use foveal_host::culling::{Check, NamedEye, Subject, Workers, mocrec};
use foveal_host::progress::progress_bar;
use foveal_host::{atomic_file, console, scene_source};
use measure::measure;
use report::{CameraReport, Report};

/// Culls what the arguments ask for.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    args.check()?;
    let json_to_stdout = args.json.as_deref() == Some(Path::new("-"));
    let json_file = args.json.as_ref().filter(|_| !json_to_stdout);
    for file in args.depth.iter().chain(&args.overlay).chain(json_file) {
        atomic_file::check_writable(file)?;
    }
    let report = cull(args)?;
    if !args.quiet {
        report.warnings.iter().for_each(|w| console::warn(w));
    }
    if args.json.is_some() {
        let json = serde_json::to_string(&report)? + "\n";
        match json_file {
            Some(file) => atomic_file::write(file, json.as_bytes())?,
            None => console::print_result(&json)?,
        }
    }
    if !json_to_stdout {
        console::print_result(&table::text(&report))?;
    }
    verdict(&report)
}

/// An error where `--check` found a wrong answer.
fn verdict(report: &Report) -> anyhow::Result<()> {
    let wrong: Vec<&str> = report
        .cameras
        .iter()
        .filter(|c| c.check.is_some_and(|check| !check.is_safe()))
        .map(|c| c.name.as_str())
        .collect();
    if !wrong.is_empty() {
        bail!("visible objects were culled, seen by: {}", wrong.join(", "));
    }
    Ok(())
}

/// Loads, culls, checks and draws; prints nothing.
fn cull(args: &Args) -> anyhow::Result<Report> {
    let (width, height) = args.size;
    let mut culler = Culler::new(width, height).context("--size")?;
    let workers = Workers::new(args.threads);
    let (scene, subjects, mut warnings) = subjects(args)?;
    let total: usize = subjects.iter().map(|s| s.eyes.len()).sum();
    let progress = progress_bar(total as u64, "cameras", args.quiet);
    let mut cameras = Vec::with_capacity(total);
    for subject in &subjects {
        warnings.extend(subject.notes.iter().cloned());
        for eye in &subject.eyes {
            let camera = cull_one(args, &mut culler, &workers, subject, eye)
                .with_context(|| format!("the camera '{}' of '{}'", eye.name, subject.name))?;
            let number = (total > 1).then_some(cameras.len());
            draw(args, &culler, subject, eye, &camera.1, number)?;
            cameras.push(camera.0);
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    Ok(Report {
        schema: "foveal-cull",
        schema_version: report::SCHEMA_VERSION,
        program_version: env!("CARGO_PKG_VERSION"),
        scene,
        width,
        height,
        threads: args.threads,
        frames: args.frames,
        eyes_apart_m: args.culling.eyes_apart,
        validity_radius_m: args.culling.validity_radius,
        budget_ms: args.culling.budget_ms,
        instruction_set: format!("{:?}", culler.instruction_set()),
        warnings,
        cameras,
    })
}

fn subjects(args: &Args) -> anyhow::Result<(String, Vec<Subject>, Vec<String>)> {
    if args::is_recording(&args.scene) {
        let recording = mocrec::Recording::read(Path::new(&args.scene))?;
        let mut subjects = mocrec::subjects(&args.scene, &recording)
            .with_context(|| format!("the recording '{}'", args.scene))?;
        if let Some(first) = subjects.first_mut() {
            first.notes.push(format!(
                "recorded at {}x{} with {} records",
                recording.width,
                recording.height,
                recording.records.len()
            ));
        }
        return Ok((args.scene.clone(), subjects, Vec::new()));
    }
    let scene = scene_source::load_with(&args.scene, &args.import.options())?;
    let (width, height) = args.size;
    let aspect = f64::from(width) / f64::from(height);
    let eyes = args.views.choose(&scene, aspect)?;
    let subject = Subject::of_scene(&scene, &args.culling.occluders, eyes)?;
    let warnings = scene.warnings.iter().map(|w| w.text.clone()).collect();
    Ok((scene.name, vec![subject], warnings))
}

fn cull_one(
    args: &Args,
    culler: &mut Culler,
    workers: &Workers,
    subject: &Subject,
    eye: &NamedEye,
) -> anyhow::Result<(CameraReport, measure::Outcome)> {
    let view = args.culling.view(&eye.eye)?;
    let outcome = measure(culler, workers, subject, &view, &args.culling, args.frames)?;
    let check = args
        .check
        .then(|| {
            let boxes = &subject.occludees.boxes;
            Check::new(
                &subject.occluders,
                &view,
                args.size,
                boxes,
                &outcome.results,
            )
        })
        .transpose()?;
    Ok((CameraReport::new(subject, eye, &outcome, check), outcome))
}

fn draw(
    args: &Args,
    culler: &Culler,
    subject: &Subject,
    eye: &NamedEye,
    outcome: &measure::Outcome,
    number: Option<usize>,
) -> anyhow::Result<()> {
    if let Some(file) = &args.depth {
        picture::depth(culler)?.write_rgb(&numbered(file, number))?;
    }
    if let Some(file) = &args.overlay {
        let boxes = &subject.occludees.boxes;
        picture::overlay(culler, &eye.eye, boxes, &outcome.results)?
            .write_rgb(&numbered(file, number))?;
    }
    Ok(())
}

/// `depth.png` as `depth-3.png`.
fn numbered(file: &Path, number: Option<usize>) -> PathBuf {
    let (Some(number), Some(stem)) = (number, file.file_stem()) else {
        return file.to_owned();
    };
    let mut name = stem.to_owned();
    name.push(format!("-{number}.png"));
    file.with_file_name(name)
}
