//! Captures: what is recorded, and how far it is.

use egui::Context;
use foveal_scene::Aabb;

use super::App;
use crate::Format;
use crate::capture::{Ended, Flight, Job, Pose, turntable};

/// The way that the camera takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Way {
    /// Once around what is selected, or around the scene.
    #[default]
    Turntable,
    /// As it is flown in the next seconds.
    Flight,
}

#[derive(Debug, Default)]
pub(crate) enum Phase {
    #[default]
    Idle,
    /// The flight is noted; from this second of the interface's clock on.
    Flying(f64, Flight),
    /// Frames that are written, and all.
    Drawing(usize, usize),
}

/// The capture card.
#[derive(Debug)]
pub(crate) struct Capture {
    pub(crate) is_open: bool,
    pub(crate) way: Way,
    pub(crate) format: Format,
    pub(crate) seconds: f32,
    pub(crate) per_second: f32,
    /// Size of the frames; `None`: the picture's.
    pub(crate) size: Option<(u32, u32)>,
    pub(crate) phase: Phase,
    /// How the last one ended.
    pub(crate) ended: Option<Ended>,
}

impl Default for Capture {
    fn default() -> Self {
        Self {
            is_open: false,
            way: Way::default(),
            format: Format::default(),
            seconds: 4.0,
            per_second: 30.0,
            size: None,
            phase: Phase::Idle,
            ended: None,
        }
    }
}

impl Capture {
    pub(crate) fn frames(&self) -> u32 {
        ((self.seconds * self.per_second).round() as u32).max(1)
    }

    pub(crate) fn is_idle(&self) -> bool {
        matches!(self.phase, Phase::Idle)
    }
}

impl App {
    /// Starts what the capture card says.
    pub(crate) fn start_capture(&mut self, context: &Context) {
        let can_start = self.capture.is_idle() && self.opening.is_none();
        let (Some(_), Some(pose), true) = (&self.scene, self.pose(), can_start) else {
            return;
        };
        self.capture.ended = None;
        let capture = &self.capture;
        match capture.way {
            Way::Turntable => {
                let clock = (
                    self.display.time_s,
                    capture.per_second,
                    self.display.playing,
                );
                let poses = turntable(&pose.camera, self.framed(), capture.frames(), clock);
                self.draw_capture(poses);
            }
            Way::Flight => {
                self.capture.phase = Phase::Flying(context.input(|i| i.time), Flight::default());
            }
        }
    }

    /// Ends the running capture early.
    pub(crate) fn cancel_capture(&mut self) {
        match self.capture.phase {
            Phase::Idle => {}
            Phase::Flying(..) => self.capture.phase = Phase::Idle,
            Phase::Drawing(..) => self.worker.cancel_capture(),
        }
    }

    /// Notes where the camera is while it is flown; has the flight drawn when its time is over.
    pub(super) fn note_flight(&mut self, context: &Context) {
        let pose = self.pose();
        let Phase::Flying(since_s, flight) = &mut self.capture.phase else {
            return;
        };
        let at_s = context.input(|i| i.time) - *since_s;
        if let Some(pose) = pose {
            flight.add(at_s, pose);
        }
        if at_s < f64::from(self.capture.seconds) {
            context.request_repaint();
            return;
        }
        let flight = std::mem::take(flight);
        let poses = flight.frames(self.capture.frames(), self.capture.per_second);
        self.draw_capture(poses);
    }

    pub(super) fn take_capture_end(&mut self, context: &Context, ended: Ended) {
        if !matches!(self.capture.phase, Phase::Drawing(..)) {
            // It had ended before it was told to.
            return;
        }
        self.capture.phase = Phase::Idle;
        match &ended {
            Ended::Done(name) => self.say(context, format!("Captured: {name}")),
            Ended::Cancelled(text) => self.say(context, text.clone()),
            Ended::Failed(cause) => self.complain(format!("capture: {cause}")),
        }
        self.capture.ended = Some(ended);
    }

    fn draw_capture(&mut self, poses: Vec<Pose>) {
        self.capture.phase = Phase::Drawing(0, poses.len());
        let settings = self.settings.clone().with(|s| {
            // What is in files hangs on the settings, not on how long frames took.
            s.rate.force = true;
            if let Some((width, height)) = self.capture.size {
                (s.picture.width, s.picture.height) = (width, height);
            }
        });
        self.worker.capture(Job {
            settings,
            clip: self.display.clip.clone(),
            poses,
            format: self.capture.format,
            per_second: self.capture.per_second,
        });
    }

    /// What is seen now.
    fn pose(&self) -> Option<Pose> {
        Some(Pose {
            camera: self.navigator.as_ref()?.camera().clone(),
            time_s: self.display.time_s,
        })
    }

    /// What is selected, or else everything.
    pub(crate) fn framed(&self) -> Aabb {
        let selected = self.selected.as_ref().map(|picked| picked.bounds);
        let all = self.scene.as_ref().map(|scene| scene.bounds);
        selected.or(all).unwrap_or(Aabb::EMPTY)
    }
}
