//! What learning which occluders are useful gains while a camera looks around.

use std::time::Instant;

use foveal_cull::{Culler, Eye, FrameOptions, OccluderUsefulness, Visibility};
use glam::{DAffine3, DVec3};
use serde::Serialize;

use super::case::Case;
use foveal_host::culling::{Clock, Workers};
use foveal_measure::median;

/// Frames before the first that counts, and frames that count: a turn to both sides.
const WARM_UP: u32 = 60;
const FRAMES: u32 = 180;
/// How far the camera turns and steps to each side, at 60 frames a second within three seconds.
const TURN_RADIANS: f64 = 0.5;
const STEP_M: f64 = 0.5;

/// `null` unless asked for. Times are medians over the frames, counts means.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct LearnedColumns {
    /// Rasterizing everything.
    pub(super) moving_ms: Option<f64>,
    /// Rasterizing what is useful, and learning what is.
    pub(super) learned_ms: Option<f64>,
    /// The scene's objects that are visible by each.
    pub(super) moving_visible: Option<f64>,
    pub(super) learned_visible: Option<f64>,
}

/// One way of culling over the frames.
struct Side {
    culler: Culler,
    results: Vec<Visibility>,
    ms: Vec<f64>,
    visible: u64,
}

impl LearnedColumns {
    /// Moves the case's camera and culls the scene's own objects, with and without learning in turn.
    pub(super) fn measure(case: &Case<'_>, workers: &Workers) -> anyhow::Result<Self> {
        let side = || -> anyhow::Result<Side> {
            Ok(Side {
                culler: Culler::new(case.size.0, case.size.1)?,
                results: vec![Visibility::Visible; case.objects.len()],
                ms: Vec::new(),
                visible: 0,
            })
        };
        let (mut plain, mut learned) = (side()?, side()?);
        let mut usefulness = OccluderUsefulness::new();
        for frame in 0..WARM_UP + FRAMES {
            let view = case.culling.view(&moved(&case.eye.eye, frame))?;
            // The side that comes first finds the caches as the other one left them.
            let mut sides = [(false, &mut plain), (true, &mut learned)];
            sides.rotate_left(frame as usize % 2);
            for (learns, side) in sides {
                let clock = Clock::start();
                let clock = || clock.now_ns();
                let known = learns.then_some(&usefulness);
                let options: FrameOptions<'_> = case.culling.options(&clock).with_usefulness(known);
                let start = Instant::now();
                workers.rasterize(&mut side.culler, &view, &case.occluders.set, &options)?;
                let mut time = start.elapsed();
                workers.query(&side.culler, case.objects, &mut side.results)?;
                if learns {
                    let start = Instant::now();
                    usefulness.observe(&side.culler, case.objects, [0.0; 3], &side.results)?;
                    usefulness.learn(&side.culler, &case.occluders.set);
                    time += start.elapsed();
                }
                if frame >= WARM_UP {
                    side.ms.push(time.as_secs_f64() * 1e3);
                    side.visible += side.results.iter().filter(|r| r.is_visible()).count() as u64;
                }
            }
        }
        let mean = |side: &Side| side.visible as f64 / f64::from(FRAMES);
        Ok(Self {
            moving_visible: Some(mean(&plain)),
            learned_visible: Some(mean(&learned)),
            moving_ms: Some(median(&plain.ms)),
            learned_ms: Some(median(&learned.ms)),
        })
    }
}

/// The camera in a frame: it looks and steps from side to side.
fn moved(eye: &Eye, frame: u32) -> Eye {
    let phase = f64::from(frame) / f64::from(FRAMES) * std::f64::consts::TAU;
    let pose: DAffine3 = eye.world_from_eye.into();
    let step = DVec3::X * (STEP_M * phase.sin());
    let turn = DAffine3::from_rotation_y(TURN_RADIANS * phase.sin());
    Eye::new(
        pose * DAffine3::from_translation(step) * turn,
        eye.projection,
    )
}
