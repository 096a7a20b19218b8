//! A capture while it runs: frame by frame, between other orders.

use super::drawing::Drawing;
use super::{Request, SETTLING_FRAMES, Shown};
use crate::capture::{Ended, Job};
use crate::{Host, Recording};

pub(super) struct Capturing {
    job: Job,
    recording: Box<dyn Recording>,
    /// Frames that were drawn of the first pose alone, so that the light is there.
    warmed: u32,
    written: usize,
}

impl Capturing {
    pub(super) fn start(host: &Host, job: Job) -> anyhow::Result<Self> {
        let size = job.settings.picture_size();
        let recording = (host.record)(job.format, size, job.per_second)?;
        Ok(Self {
            job,
            recording,
            warmed: 0,
            written: 0,
        })
    }

    /// Draws the next frame and writes it; what was drawn, where there is a scene.
    pub(super) fn step(
        &mut self,
        host: &Host,
        drawing: &mut Drawing,
    ) -> anyhow::Result<Option<Shown>> {
        let Some(pose) = self.job.poses.get(self.written) else {
            return Ok(None);
        };
        let request = Request {
            settings: self.job.settings.clone(),
            reference: None,
            camera: pose.camera.clone(),
            frozen: false,
            boxes: false,
            depth: false,
            time_s: pose.time_s,
            clip: self.job.clip.clone(),
            always: false,
        };
        let is_warming = self.warmed < SETTLING_FRAMES - 1;
        // After the first frames each one follows on the one before.
        let repeat = if is_warming { self.warmed } else { 0 };
        let shown = drawing.draw(host, &request, repeat)?;
        if is_warming {
            self.warmed += 1;
        } else {
            if let Some(shown) = &shown {
                self.recording.add(&shown.picture.bytes)?;
            }
            self.written += 1;
        }
        Ok(shown)
    }

    pub(super) fn written(&self) -> usize {
        self.written
    }

    pub(super) fn of(&self) -> usize {
        self.job.poses.len()
    }

    pub(super) fn is_done(&self) -> bool {
        self.written >= self.of()
    }

    pub(super) fn finished(self) -> Ended {
        let name = self.recording.name();
        match self.recording.finish() {
            Ok(()) => Ended::Done(name),
            Err(error) => Ended::Failed(format!("{error:#}")),
        }
    }

    pub(super) fn cancelled(self) -> Ended {
        let mut text = format!(
            "Capture cancelled after {} of {} frames",
            self.written,
            self.of()
        );
        if self.recording.keeps_parts() {
            text = format!("{text}: {}", self.recording.name());
        }
        Ended::Cancelled(text)
    }

    pub(super) fn failed(&self, error: &anyhow::Error) -> Ended {
        Ended::Failed(format!("{error:#}"))
    }
}
