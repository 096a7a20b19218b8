//! The sides of a verdict, drawn in turn.

use foveal::{Frame, FrameStats, Gpu, Renderer, Settings};
use foveal_host::difference::Nearness;
use foveal_host::picture::Picture;
use foveal_measure::{Comparison, turn};
use foveal_scene::{Camera, Scene};
use pollster::block_on;

use super::decision::{Found, Measured};
use crate::subject::{Subject, WARM_UP, swayed, timed_renderer};

/// Frames that are drawn before any is timed. From the fourth on, over a visibility buffer from the
/// ninth, three or four shade in both ways, at rates and in full, to compare them; where rates do not
/// pay, they are off from then on. Later ones that compare, one or more of 64, give no time.
const UNTIMED: u32 = 16;

/// One of those that are drawn in turn.
struct Side {
    renderer: Renderer,
    settings: Settings,
    frame_ms: Vec<f64>,
    work_ms: Vec<f64>,
    /// What the last frame said of a technique that turned itself off.
    notice: String,
}

/// What a frame says of techniques that turned themselves off.
fn off_notice(stats: &FrameStats) -> String {
    let coarse = (stats.coarse.as_ref()).map(|coarse| (coarse.active, &coarse.notice));
    let variable = (stats.variable.as_ref()).map(|variable| (variable.active, &variable.notice));
    let said = [coarse, variable].into_iter().flatten();
    said.filter(|(is_active, notice)| !is_active && !notice.is_empty())
        .map(|(_, notice)| notice.as_str())
        .collect::<Vec<_>>()
        .join("; ")
}

/// Whether a frame shades in both ways, at rates and in full.
fn compares(stats: &FrameStats) -> bool {
    stats
        .gpu_ms
        .iter()
        .any(|pass| pass.name.starts_with("full "))
}

/// Whether an error says that these settings cannot be drawn here, by this device or at all.
fn is_refused(error: &anyhow::Error) -> bool {
    use foveal::Error::{Limit, Setting};
    matches!(error.downcast_ref(), Some(Setting { .. } | Limit { .. }))
}

/// Draws the plain settings and the others in turn; what each of the others turned out to be.
pub(super) fn measure(
    Subject { gpu, scene, camera }: &Subject,
    plain: &Settings,
    chosen: &[&Settings],
    rounds: u32,
) -> anyhow::Result<Vec<Measured>> {
    let mut plain = Side::new(gpu, scene, plain)?;
    let mut sides: Vec<Result<Side, String>> = Vec::new();
    for settings in chosen {
        sides.push(match Side::new(gpu, scene, settings) {
            Ok(side) => Ok(side),
            Err(error) if is_refused(&error) => Err(error.to_string()),
            Err(error) => return Err(error),
        });
    }
    let count = sides.iter().flatten().count() + 1;
    // The camera sways, as a head does: what is kept from frame to frame costs nothing at rest.
    let at = |frame: u32| swayed(camera, frame);
    for frame in 1..=UNTIMED {
        plain.draw(&at(frame), &at(frame - 1))?;
        for side in sides.iter_mut().flatten() {
            side.draw(&at(frame), &at(frame - 1))?;
        }
    }
    for side in std::iter::once(&mut plain).chain(sides.iter_mut().flatten()) {
        side.frame_ms.clear();
        side.work_ms.clear();
    }
    let processor_draws = gpu.adapter_stats().kind == "cpu";
    for round in 0..rounds {
        let frame = UNTIMED + 1 + round;
        let [now, before] = [at(frame), at(frame - 1)];
        for number in turn(u64::from(round), count) {
            match number.checked_sub(1) {
                None => {
                    plain.draw(&now, &before)?;
                }
                Some(number) => {
                    if let Some(side) = sides.iter_mut().flatten().nth(number) {
                        side.draw(&now, &before)?;
                    }
                }
            }
        }
    }
    let reference = plain.picture(camera)?;
    let mut number = 0;
    sides
        .into_iter()
        .map(|side| {
            let mut side = match side {
                Ok(side) => side,
                Err(cause) => return Ok(Err(cause)),
            };
            number += 1;
            let compared = |plain_ms: &[f64], side_ms: &[f64]| {
                Comparison::of_rounds(count, (0, plain_ms), (number, side_ms))
            };
            let Some(frame) = compared(&plain.frame_ms, &side.frame_ms) else {
                return Ok(Err("no time could be taken".to_owned()));
            };
            let work = processor_draws.then(|| compared(&plain.work_ms, &side.work_ms));
            Ok(Ok(Found {
                frame,
                work: work.flatten(),
                nearness: match side.notice.as_str() {
                    "" => Ok(Nearness::of(&reference, &side.picture(camera)?)),
                    notice => Err(notice.to_owned()),
                },
            }))
        })
        .collect()
}

impl Side {
    fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> anyhow::Result<Self> {
        let renderer = timed_renderer(gpu, scene, settings)?;
        Ok(Self {
            renderer,
            settings: settings.clone(),
            frame_ms: Vec::new(),
            work_ms: Vec::new(),
            notice: String::new(),
        })
    }

    /// Draws a frame; one that compares has no time, and its round is left out.
    fn draw(&mut self, camera: &Camera, before: &Camera) -> anyhow::Result<FrameStats> {
        let frame = Frame::new(camera).with_previous(before);
        let before_ms = process_ms();
        let stats: FrameStats = block_on(self.renderer.render(&frame))?;
        let work_ms = process_ms() - before_ms;
        let time = |ms| if compares(&stats) { f64::NAN } else { ms };
        self.work_ms.push(time(work_ms));
        self.frame_ms.push(time(stats.frame_ms));
        self.notice = off_notice(&stats);
        Ok(stats)
    }

    /// The picture of the camera at rest, as the row's command makes it: with all techniques on.
    fn picture(&mut self, camera: &Camera) -> anyhow::Result<Picture> {
        let forced = self.settings.clone().with(|s| s.rate.force = true);
        block_on(self.renderer.set_settings(&forced))?;
        // A frame that follows none: nothing of the frames before is in it.
        let none = Camera {
            name: format!("before {}", camera.name),
            ..camera.clone()
        };
        self.draw(camera, &none)?;
        for _ in 0..WARM_UP {
            self.draw(camera, camera)?;
        }
        let bytes = block_on(self.renderer.read_picture())?;
        let (width, height) = self.settings.picture_size();
        Picture::from_rgba(width, height, bytes)
    }
}

/// Milliseconds that this process has had of the processor, all threads together; 0 where nobody
/// says.
fn process_ms() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
    }
    #[cfg(not(unix))]
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::candidates::candidates_of;
    use foveal::CoarseStats;

    #[test]
    fn no_time_is_that_of_a_frame_that_shades_at_rates_and_in_full() {
        let gpu = foveal_host::gpu::open(None).unwrap();
        let mut scene = foveal_generate::cornell();
        scene.light_by_default();
        let plain = Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 48;
        });
        let mut compared = 0;
        for (candidate, settings) in candidates_of(&plain, |pass| pass).unwrap() {
            let mut side = Side::new(&gpu, &scene, &settings).unwrap();
            // After 64 frames they compare again.
            for frame in 1..=UNTIMED + 60 {
                let [now, before] = [frame, frame - 1].map(|f| swayed(&scene.cameras[0], f));
                let stats = side.draw(&now, &before).unwrap();
                let in_full = |pass: &foveal::Timing| pass.name.starts_with("full ");
                let both = stats.gpu_ms.iter().any(in_full);
                for times in [&side.frame_ms, &side.work_ms] {
                    let is_left_out = times.last().unwrap().is_nan();
                    assert_eq!(is_left_out, both, "{}, frame {frame}", candidate.name);
                }
                compared += u32::from(both);
            }
        }
        assert!(compared > 0);
    }

    /// Of 8K pictures lavapipe cannot bind the lists of pixels that half of the candidates have.
    #[test]
    fn what_goes_beyond_the_device_is_impossible_and_nothing_else_is() {
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: 4096,
            ..wgpu::Limits::default()
        };
        let plain = Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 48;
        });
        let (mut possible, mut refused) = (0, 0);
        for (_, settings) in candidates_of(&plain, |pass| pass).unwrap() {
            match settings.validate(&limits) {
                Ok(()) => possible += 1,
                Err(error) => {
                    assert!(is_refused(&error.into()));
                    refused += 1;
                }
            }
        }
        assert!(possible > 0 && refused > 0, "{possible} {refused}");
        let lost = foveal::Error::DeviceLost {
            reason: "gone".to_owned(),
        };
        assert!(!is_refused(&lost.into()));
    }

    #[test]
    fn a_technique_that_says_something_is_not_off_for_that() {
        let stats = |active| {
            let mut coarse = CoarseStats::default();
            (coarse.active, coarse.notice) = (active, "said".to_owned());
            let mut stats = FrameStats::default();
            stats.coarse = Some(coarse);
            stats
        };
        assert_eq!(off_notice(&stats(true)), "");
        assert_eq!(off_notice(&stats(false)), "said");
    }
}
