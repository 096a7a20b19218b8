//! How visible the difference of both sides is, in JOD, found by a thread of its own: drawing goes
//! on meanwhile.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use foveal::Settings;
use foveal_scene::{Camera, Projection};
use foveal_vdp::{Display, Extent, Gaze, Metric, Pixels};

use super::{Request, Rgba};

/// What an eye sees of the difference, at the display and the gaze of the settings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Quality {
    /// What was drawn.
    pub(crate) request: Request,
    /// 10: no visible difference.
    pub(crate) jod: f32,
    /// The display in few words.
    pub(crate) display: String,
}

/// Two pictures to compare.
struct Pair {
    request: Request,
    reference: Rgba,
    chosen: Rgba,
}

#[derive(Default)]
struct Orders {
    pair: Option<Pair>,
    quit: bool,
}

#[derive(Default)]
struct Desk {
    orders: Mutex<Orders>,
    changed: Condvar,
}

/// The thread; only the newest pair counts.
pub(super) struct Judge {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

impl Judge {
    pub(super) fn start(tell: impl Fn(Quality) + Send + 'static) -> std::io::Result<Self> {
        let desk = Arc::new(Desk::default());
        let theirs = Arc::clone(&desk);
        let thread = std::thread::Builder::new()
            .name("judge".to_owned())
            .spawn(move || {
                while let Some(pair) = theirs.next() {
                    if let Some(quality) = quality(pair) {
                        tell(quality);
                    }
                }
            })?;
        Ok(Self {
            desk,
            thread: Some(thread),
        })
    }

    /// Hands over a pair in place of one that waits.
    pub(super) fn judge(&self, request: &Request, reference: &Rgba, chosen: &Rgba) {
        self.desk.orders().pair = Some(Pair {
            request: request.clone(),
            reference: reference.clone(),
            chosen: chosen.clone(),
        });
        self.desk.changed.notify_one();
    }
}

impl Drop for Judge {
    fn drop(&mut self) {
        self.desk.orders().quit = true;
        self.desk.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Desk {
    fn orders(&self) -> MutexGuard<'_, Orders> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a pair; `None` at the end.
    fn next(&self) -> Option<Pair> {
        let mut orders = self.orders();
        loop {
            if orders.quit {
                return None;
            }
            if let Some(pair) = orders.pair.take() {
                return Some(pair);
            }
            orders = self
                .changed
                .wait(orders)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// `None` for pictures that cannot be compared: of different sizes, or too small.
fn quality(pair: Pair) -> Option<Quality> {
    let Pair {
        request,
        reference,
        chosen,
    } = pair;
    let (width, height) = (chosen.width as usize, chosen.height as usize);
    let [x, y] = request.settings.eye.gaze;
    let (display, name) = display(&request.settings, &request.camera, (width, height))?;
    let metric = Metric::new(&display, width, height, Gaze { x, y }).ok()?;
    let found = metric.compare(pixels(&reference), pixels(&chosen)).ok()?;
    Some(Quality {
        request,
        jod: found.jod,
        display: name,
    })
}

fn pixels(picture: &Rgba) -> Pixels<'_> {
    Pixels::Rgba(picture.bytes.as_chunks::<4>().0)
}

/// The display that the settings name. `camera` is one that the camera's own field of view fills,
/// as a headset's.
fn display(
    settings: &Settings,
    camera: &Camera,
    (width, height): (usize, usize),
) -> Option<(Display, String)> {
    if settings.eye.display != foveal::Display::Camera {
        let name = settings.eye.display.to_string();
        return Some((Display::parse(&name)?, name));
    }
    let degrees = match camera.projection {
        Projection::Perspective { fov_y_rad, .. } => {
            let across = (0.5 * fov_y_rad).tan() * width as f32 / height as f32;
            (2.0 * across.atan()).to_degrees().clamp(1.0, 170.0)
        }
        Projection::Orthographic { .. } => 60.0,
    };
    let display = Display {
        extent: Extent::FieldOfView(degrees),
        ..Display::HEADSET
    };
    Some((display, format!("camera, {degrees:.0}°")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_display_is_the_one_of_the_settings() {
        let mut settings = Settings::default();
        let camera = Camera::look_at(
            glam::Vec3::ZERO,
            glam::Vec3::X,
            glam::Vec3::Y,
            std::f32::consts::FRAC_PI_2,
        );
        let (found, name) = display(&settings, &camera, (200, 100)).unwrap();
        // tan 45° times two.
        assert!((found.degrees_across() - 126.87).abs() < 0.01);
        assert_eq!(name, "camera, 127°");
        settings.eye.display = foveal::Display::Fhd24;
        let (found, name) = display(&settings, &camera, (200, 100)).unwrap();
        assert_eq!(
            (Some(found), name.as_str()),
            (Display::named("fhd-24"), "fhd-24")
        );
    }
}
