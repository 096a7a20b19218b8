//! `--stats`: what the pictures cost, as JSON. docs/stats.schema.json describes each field; a
//! change that breaks a reader of it raises [`SCHEMA_VERSION`].

use foveal::{AdapterStats, FrameStats, SceneStats, Settings, Timing};
use serde::Serialize;

use foveal_measure::median;

/// Version of the JSON's shape.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// One run of `foveal render`.
#[derive(Debug, Serialize)]
pub(super) struct RunStats {
    pub(super) schema: &'static str,
    pub(super) schema_version: u32,
    pub(super) program_version: &'static str,
    pub(super) command: CommandStats,
    pub(super) settings: Settings,
    pub(super) adapter: AdapterStats,
    pub(super) scene: NamedSceneStats,
    /// What happened until the first frame was drawn, in order; loading and opening the device
    /// overlap.
    pub(super) load_ms: Vec<Timing>,
    /// From the program's start until the first picture was on the disk.
    pub(super) first_picture_ms: f64,
    pub(super) skipped_frames: u64,
    pub(super) frames: Vec<NumberedFrameStats>,
    /// Medians over `frames`.
    pub(super) median: MedianStats,
}

/// What was asked for, besides the settings.
#[derive(Debug, Serialize)]
pub(super) struct CommandStats {
    pub(super) scene: String,
    pub(super) output: String,
    pub(super) fps: f32,
    pub(super) point_lights: u32,
    pub(super) light_seed: u64,
    pub(super) warmup: u32,
}

/// The scene's counts under its name.
#[derive(Debug, Serialize)]
pub(super) struct NamedSceneStats {
    pub(super) name: String,
    pub(super) animated: bool,
    pub(super) warnings: u64,
    #[serde(flatten)]
    pub(super) counts: SceneStats,
}

/// One frame.
#[derive(Debug, Serialize)]
pub(super) struct NumberedFrameStats {
    pub(super) frame: u32,
    pub(super) time_s: f32,
    pub(super) file: String,
    pub(super) camera: String,
    #[serde(flatten)]
    pub(super) figures: FrameStats,
}

/// The middle of all frames, figure by figure.
#[derive(Debug, Default, PartialEq, Serialize)]
pub(super) struct MedianStats {
    pub(super) cpu_ms: Vec<Timing>,
    pub(super) gpu_ms: Vec<Timing>,
    pub(super) objects_visible: f64,
    pub(super) objects_outside: f64,
    pub(super) objects_occluded: f64,
    pub(super) objects_small: f64,
    pub(super) occluder_triangles: f64,
    pub(super) draws: f64,
    pub(super) triangles: f64,
    pub(super) shaded_samples: f64,
    pub(super) frame_ms: f64,
}

impl MedianStats {
    pub(super) fn of(frames: &[NumberedFrameStats]) -> Self {
        let median = |figure: fn(&FrameStats) -> f64| {
            let figures = frames.iter().map(|frame| figure(&frame.figures));
            median(&figures.collect::<Vec<_>>())
        };
        Self {
            cpu_ms: medians(frames, |figures| &figures.cpu_ms),
            gpu_ms: medians(frames, |figures| &figures.gpu_ms),
            objects_visible: median(|f| f.objects_visible as f64),
            objects_outside: median(|f| f.objects_outside as f64),
            objects_occluded: median(|f| f.objects_occluded as f64),
            objects_small: median(|f| f.objects_small as f64),
            occluder_triangles: median(|f| f.occluder_triangles as f64),
            draws: median(|f| f.draws as f64),
            triangles: median(|f| f.triangles as f64),
            shaded_samples: median(|f| f.shaded_samples as f64),
            frame_ms: median(|f| f.frame_ms),
        }
    }
}

/// The median of each stage over all frames, in the order of their first appearance. A frame without
/// a stage counts as 0.
fn medians(frames: &[NumberedFrameStats], timings: fn(&FrameStats) -> &[Timing]) -> Vec<Timing> {
    let mut stages: Vec<(&str, Vec<f64>)> = Vec::new();
    for timing in frames.iter().flat_map(|frame| timings(&frame.figures)) {
        match stages.iter_mut().find(|(name, _)| *name == timing.name) {
            Some((_, ms)) => ms.push(timing.ms),
            None => stages.push((&timing.name, vec![timing.ms])),
        }
    }
    stages
        .into_iter()
        .map(|(name, mut ms)| {
            ms.resize(frames.len(), 0.0);
            Timing {
                name: name.to_owned(),
                ms: median(&ms),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(frame_ms: f64, gpu: &[(&str, f64)]) -> NumberedFrameStats {
        let gpu_ms = gpu
            .iter()
            .map(|&(name, ms)| Timing {
                name: name.to_owned(),
                ms,
            })
            .collect();
        let mut figures = FrameStats::default();
        figures.frame_ms = frame_ms;
        figures.gpu_ms = gpu_ms;
        NumberedFrameStats {
            frame: 0,
            time_s: 0.0,
            file: String::new(),
            camera: String::new(),
            figures,
        }
    }

    #[test]
    fn medians_are_taken_figure_by_figure() {
        let frames = [
            frame(
                9.0,
                &[("geometry", 1.0), ("lighting", 5.0), ("shadows", 9.0)],
            ),
            frame(2.0, &[("geometry", 3.0)]),
            frame(4.0, &[("geometry", 2.0), ("lighting", 7.0)]),
        ];
        let median = MedianStats::of(&frames);
        assert_eq!(median.frame_ms, 4.0);
        let gpu: Vec<_> = median
            .gpu_ms
            .iter()
            .map(|t| (t.name.as_str(), t.ms))
            .collect();
        assert_eq!(
            gpu,
            [("geometry", 2.0), ("lighting", 5.0), ("shadows", 0.0)]
        );
        assert_eq!(MedianStats::of(&[]), MedianStats::default());
    }
}
