//! `foveal render`: from a scene to pictures on the disk.
//!
//! In the order of a run: the arguments are checked, the places for the files are tried, the scene
//! loads while the device opens, the scene goes onto the device, each frame is drawn and written,
//! the figures are written.

mod args;
mod frame_files;
mod sharing;
mod stats;
mod summary;
mod without_effect;

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::thread;

use anyhow::{Context, anyhow};
use foveal::{AdapterStats, EnvironmentSource, FrameStats, Renderer, Settings, Timing};
use pollster::block_on;

use foveal_host::camera::Viewpoint;
use foveal_host::claims;
use foveal_host::clock::{now_ms, now_ns, timed};
use foveal_host::drawing::{Drawing, follows_on};
use foveal_host::environment::environment;
use foveal_host::linear_picture::{self, PictureFormat};
use foveal_host::memory;
use foveal_host::progress::progress_bar;
use foveal_host::rate_image::{self, rate_image};
use foveal_host::video::{self, Video};
use foveal_host::{atomic_file, console, gpu, scene_source};

pub(crate) use args::Args;
#[cfg(test)]
pub(crate) use args::FrameArgs;
use frame_files::{FrameJob, FramePattern, Moment};
use sharing::Turns;
use stats::{CommandStats, MedianStats, NamedSceneStats, NumberedFrameStats, RunStats};

/// Draws what the arguments ask for.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    now_ms();
    args.check()?;
    let settings = args.settings()?;
    args.check_beside(&settings)?;
    let wanted = jobs(args)?;
    let total = wanted.len();
    let skips = args.frames.skip_existing || args.frames.share;
    let is_there = |job: &FrameJob| job.file.as_deref().is_some_and(atomic_file::is_finished);
    let (done, jobs): (Vec<_>, Vec<_>) = wanted.into_iter().partition(|job| skips && is_there(job));
    for file in done.iter().filter_map(|job| job.file.as_deref()) {
        claims::remove_all(file);
    }
    let first = jobs.first().and_then(|job| job.file.as_ref());
    let first = first.filter(|_| !args.is_piped());
    let new_folder = first.and_then(|file| missing_folder(args, file));
    let place = new_folder.as_ref().or(first);
    for file in place.into_iter().chain(&args.video).chain(&args.stats) {
        atomic_file::check_writable(file)?;
    }
    args.video.as_deref().map_or(Ok(()), video::check)?;
    atomic_file::remove_abandoned(jobs.iter().filter_map(|job| job.file.as_deref()));
    for file in args.video.iter().chain(&args.stats) {
        atomic_file::remove_abandoned([file.as_path()]);
    }
    if jobs.is_empty() {
        if !args.quiet {
            say_nothing_is_drawn(args, total);
        }
        return Ok(());
    }
    if !args.quiet {
        warn_of_flags(args, &settings);
    }

    let mut load_ms = Vec::new();
    let (mut drawing, adapter) = prepare(args, &settings, &mut load_ms)?;
    let scene = NamedSceneStats {
        name: drawing.scene.name.clone(),
        animated: drawing.scene.is_animated(),
        warnings: drawing.scene.warnings.len() as u64,
        counts: drawing.renderer.scene_stats(),
    };
    for frames in (1..=args.warmup).rev() {
        draw(&mut drawing, jobs[0].moment, frames)?;
    }
    if let Some(folder) = &new_folder {
        make_folder(folder)?;
    }
    let video = match &args.video {
        Some(file) => Some(Video::create(
            file,
            drawing.renderer.settings().picture_size(),
            args.frames.fps,
        )?),
        None => None,
    };
    let mut written = Written {
        piped: args.is_piped(),
        video,
        video_name: args.output_name(),
    };
    let (there, open) = ((total - jobs.len()) as u64, jobs.len() as u64);
    let turns = if args.frames.share {
        Turns::shared(jobs, args.frames.share_expiry())
    } else {
        Turns::alone(jobs)
    };
    let (frames, first_picture_ms) = draw_all(
        &mut drawing,
        turns,
        open,
        &mut load_ms,
        &mut written,
        args.quiet,
    )?;
    if let Some(video) = written.video {
        video.finish()?;
    }
    if frames.is_empty() {
        if !args.quiet {
            let rest = summary::not_drawn(there, open);
            console::note(&format!("no frame was left to this job{rest}\n"));
        }
        return Ok(());
    }

    let run = RunStats {
        schema: "foveal-render-stats",
        schema_version: stats::SCHEMA_VERSION,
        program_version: env!("CARGO_PKG_VERSION"),
        command: CommandStats {
            scene: args.scene.clone(),
            output: args.output_name(),
            fps: args.frames.fps,
            point_lights: args.point_lights,
            light_seed: args.light_seed,
            warmup: args.warmup,
        },
        settings,
        adapter,
        scene,
        load_ms,
        first_picture_ms,
        skipped_frames: there,
        median: MedianStats::of(&frames),
        frames,
    };
    if let Some(path) = &args.stats {
        atomic_file::write(
            path,
            (serde_json::to_string_pretty(&run)? + "\n").as_bytes(),
        )?;
    }
    if !args.quiet {
        console::note(&summary::text(&run, open - run.frames.len() as u64));
    }
    Ok(())
}

/// Says why there is nothing to draw of the `total` frames that were asked for.
fn say_nothing_is_drawn(args: &Args, total: usize) {
    if let Some(file) = &args.stats {
        console::warn(&format!(
            "no frame is drawn: there are no figures, and '{}' is not written",
            file.display()
        ));
    }
    match total {
        0 => console::note("this part of the range has no frames; nothing to draw\n"),
        _ => console::note(&format!(
            "all {total} frames are there already; nothing to draw\n"
        )),
    }
}

/// Warns of flags that do nothing, or not what they do elsewhere.
fn warn_of_flags(args: &Args, settings: &Settings) {
    if args.frames.share && follows_on(settings) {
        console::warn(
            "frames with kept light, variable shading or a shadow budget follow on the ones before, and shared frames do \
             not: neighbours may differ; --part keeps them together",
        );
    }
    let reads = settings.lighting.environment == EnvironmentSource::Image;
    if args.settings.gives("environment-image") && !reads {
        console::warn("--environment-image is not read: it is for --environment image");
    }
    if args.settings.gives("rate-image") && !rate_image::is_read(settings) {
        console::warn(
            "--rate-image is not read: it is for --rate image with a --shading that has rates",
        );
    }
    let warnings = args.without_effect(settings);
    warnings.iter().for_each(|warning| console::warn(warning));
}

/// The folder of a sequence, where it is missing.
fn missing_folder(args: &Args, file: &Path) -> Option<PathBuf> {
    let folder = file.parent()?;
    let is_missing = args.frames.frames.is_some() && folder != Path::new("") && !folder.exists();
    is_missing.then(|| folder.to_owned())
}

/// Makes a folder that another job may have made since it was missing.
fn make_folder(folder: &Path) -> anyhow::Result<()> {
    match std::fs::create_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => Ok(()),
        made => made.with_context(|| format!("cannot make the folder '{}'", folder.display())),
    }
}

/// The pictures to draw.
fn jobs(args: &Args) -> anyhow::Result<Vec<FrameJob>> {
    let fps = args.frames.fps;
    match &args.frames.range()? {
        Some(range) => {
            let pattern = args.output().map(FramePattern::parse).transpose()?;
            Ok(frame_files::sequence(range.clone(), fps, pattern.as_ref()))
        }
        None => {
            let time_s = args.frames.time.unwrap_or(0.0);
            let moment = if args.frames.still {
                Moment::Rest(time_s)
            } else {
                Moment::Time(time_s, fps)
            };
            let job = FrameJob {
                frame: 0,
                moment,
                file: args.output().map(Path::to_owned),
            };
            Ok(vec![job])
        }
    }
}

/// Loads the scene while the device opens, and puts the one onto the other.
fn prepare(
    args: &Args,
    settings: &Settings,
    load_ms: &mut Vec<Timing>,
) -> anyhow::Result<(Drawing, AdapterStats)> {
    let (name, options) = (args.scene.clone(), args.import.options());
    let loading = thread::Builder::new()
        .name("load".to_owned())
        // Debug builds decode deep files with large frames.
        .stack_size(16 << 20)
        .spawn(move || {
            let mut load_ms = Vec::new();
            scene_source::load_timed(&name, &options, &mut load_ms).map(|scene| (scene, load_ms))
        })
        .context("cannot start a thread")?;

    let rate_image = rate_image(settings)?;
    let mut device_ms = Vec::new();
    let environment = match settings.lighting.environment {
        EnvironmentSource::Image => timed(&mut device_ms, "environment", || environment(settings))?,
        _ => None,
    };
    // Fails before the scene is there where the size is beyond the device: the thread then ends
    // with the program.
    let open = if args.quiet {
        gpu::open_quietly
    } else {
        gpu::open
    };
    let gpu = timed(&mut device_ms, "device", || open(args.adapter.as_deref()))?;
    if args.import.texture_flag().is_some() && !args.quiet {
        gpu::check_blocks(&gpu);
    }
    let mut renderer = timed(&mut device_ms, "pipelines", || {
        block_on(Renderer::new(
            &gpu,
            settings,
            foveal::RendererOptions::default().with_clock(now_ns),
        ))
    })?;

    if let Some(image) = rate_image {
        renderer.set_rate_image(image)?;
    }
    if let Some(environment) = environment {
        block_on(renderer.set_environment(environment))?;
    }

    let (mut scene, scene_ms) = loading
        .join()
        .unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
    load_ms.extend(scene_ms);
    load_ms.extend(device_ms);
    if args.point_lights > 0 {
        scene_source::add_point_lights(&mut scene, args.point_lights, args.light_seed);
    }
    // A file without lights would be seen by the sky's light alone.
    scene.light_by_default();
    if !args.quiet {
        scene
            .warnings
            .iter()
            .for_each(|warning| console::warn(&warning.text));
    }
    let viewpoint = Viewpoint::choose(&args.camera, &scene, &args.scene)?;
    memory::give_back();
    // Nothing here reads the texels again.
    timed(load_ms, "upload", || {
        block_on(renderer.set_scene_and_free_textures(&mut scene))
    })
    .with_context(|| format!("cannot draw the scene '{}'", scene.name))?;
    memory::give_back();
    Ok((
        Drawing::new(renderer, scene, Rc::new(viewpoint)),
        gpu.adapter_stats(),
    ))
}

/// Where frames go besides files.
struct Written {
    /// The picture goes to standard output.
    piped: bool,
    video: Option<Video>,
    /// As the command line named it.
    video_name: String,
}

impl Written {
    /// Writes the frame that was drawn last, of which these are the figures.
    fn write(
        &mut self,
        drawing: &Drawing,
        figures: &FrameStats,
        file: Option<&Path>,
        stages: &mut Vec<Timing>,
    ) -> anyhow::Result<()> {
        if let Some(file) = file
            && PictureFormat::of(file).is_some_and(PictureFormat::is_linear)
        {
            let radiance = timed(stages, "read_back", || drawing.radiance())?;
            timed(stages, "write", || linear_picture::write(file, &radiance))?;
            if self.video.is_none() {
                return Ok(());
            }
        }
        let picture = timed(stages, "read_back", || drawing.picture(figures))?;
        timed(stages, "write", || match file {
            Some(_) if self.piped => console::write_bytes(&picture.png()?),
            Some(file) if PictureFormat::of(file) == Some(PictureFormat::Png) => {
                picture.write_rgb(file)
            }
            _ => Ok(()),
        })?;
        match &mut self.video {
            Some(video) => timed(stages, "video", || video.push(&picture)),
            None => Ok(()),
        }
    }
}

/// Draws the picture that is so many frames before a moment.
fn draw(drawing: &mut Drawing, moment: Moment, frames: u32) -> anyhow::Result<FrameStats> {
    drawing.draw_picture(moment.before_s(frames), moment.before_s(frames + 1))
}

/// Draws and writes each frame; gives the figures and when the first picture was on the disk.
fn draw_all(
    drawing: &mut Drawing,
    mut turns: Turns,
    open: u64,
    load_ms: &mut Vec<Timing>,
    written: &mut Written,
    quiet: bool,
) -> anyhow::Result<(Vec<NumberedFrameStats>, f64)> {
    let progress = progress_bar(open, "frames", quiet);
    let mut frames = Vec::new();
    let mut first_picture_ms = 0.0;
    let (mut noticed, mut warned) = (quiet, quiet);
    while let Some((job, claim)) = turns.next()? {
        let mut stages = Vec::new();
        let figures = timed(&mut stages, "first_frame", || draw(drawing, job.moment, 0))
            .map_err(|error| anyhow!("frame {}: {error:#}", job.frame))?;
        if frames.is_empty() {
            // A driver that draws on the processor has compiled shaders.
            memory::give_back();
        }
        written.write(drawing, &figures, job.file.as_deref(), &mut stages)?;
        drop(claim);
        if figures.surfaces_left_out > 0 && !std::mem::replace(&mut warned, true) {
            console::warn(&format!(
                "frame {}: anti-aliasing left out {} surfaces for want of room, which the next frame has; \
                 --warmup draws frames before the first picture",
                job.frame, figures.surfaces_left_out
            ));
        }
        let notices = [
            figures.coarse.as_ref().map(|coarse| &coarse.notice),
            figures.variable.as_ref().map(|variable| &variable.notice),
        ];
        let notice = notices.into_iter().flatten().find(|n| !n.is_empty());
        if let Some(notice) = notice
            && !std::mem::replace(&mut noticed, true)
        {
            console::warn(notice);
        }
        if frames.is_empty() {
            load_ms.extend(stages);
            first_picture_ms = now_ms();
        }
        let time_s = job.moment.time_s();
        frames.push(NumberedFrameStats {
            frame: job.frame,
            time_s,
            file: match &job.file {
                Some(file) => file.display().to_string(),
                None => written.video_name.clone(),
            },
            camera: drawing.viewpoint.at(&drawing.scene, time_s).name,
            figures,
        });
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok((frames, first_picture_ms))
}
