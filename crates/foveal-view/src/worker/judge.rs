//! How visible the difference of both sides is, in JOD, found by a thread of its own: drawing goes
//! on meanwhile.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use foveal::{Output, Settings};
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

/// Of two pictures side by side the one whose difference is more visible counts. `None` for pictures
/// that cannot be compared: of different sizes, too small, or bent for a headset's lens.
fn quality(pair: Pair) -> Option<Quality> {
    let Pair {
        request,
        reference,
        chosen,
    } = pair;
    let settings = &request.settings;
    let eyes = if settings.is_stereo() {
        match settings.stereo.output {
            Output::Flat | Output::Anaglyph | Output::AnaglyphDubois => 1,
            Output::SideBySide | Output::SideBySideHalf => 2,
            Output::Headset => return None,
        }
    } else {
        1
    };
    let stretch = 1 + usize::from(eyes == 2 && settings.stereo.output == Output::SideBySideHalf);
    let size = |picture: &Rgba| (picture.width as usize, picture.height as usize);
    if size(&reference) != size(&chosen) {
        return None;
    }
    let (width, height) = (
        chosen.width as usize / eyes * stretch,
        chosen.height as usize,
    );
    let (display, name) = display(settings, &request.camera, (width, height))?;
    let mut jod = f32::INFINITY;
    for eye in 0..eyes {
        let (gaze, shift) = (settings.eye.gaze, settings.stereo.gaze_shift);
        let [x, y] = [0, 1].map(|axis| gaze[axis] + eye as f32 * shift[axis]);
        let metric = Metric::new(&display, width, height, Gaze { x, y }).ok()?;
        let [a, b] = [&reference, &chosen].map(|picture| of_eye(picture, eye, eyes, stretch));
        let found = metric.compare(Pixels::Rgba(&a), Pixels::Rgba(&b)).ok()?;
        jod = jod.min(found.jod);
    }
    Some(Quality {
        request,
        jod,
        display: name,
    })
}

/// One of so many pictures side by side, each of its columns repeated.
fn of_eye(picture: &Rgba, eye: usize, eyes: usize, repeat: usize) -> Vec<[u8; 4]> {
    let width = picture.width as usize;
    let columns = eye * (width / eyes)..(eye + 1) * (width / eyes);
    let rows = picture.bytes.as_chunks::<4>().0.chunks_exact(width.max(1));
    let pixels = rows.flat_map(|row| &row[columns.clone()]);
    pixels
        .flat_map(|&pixel| std::iter::repeat_n(pixel, repeat))
        .collect()
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

    /// A grid of lines, dark where `is_off` says so.
    fn grid(width: u32, height: u32, is_off: impl Fn(u32, u32) -> bool) -> Rgba {
        let pixels = (0..width * height).map(|i| (i % width, i / width));
        let bytes = pixels.flat_map(|(x, y)| {
            let is_line = x.is_multiple_of(8) || y.is_multiple_of(8);
            let value = if is_line && !is_off(x, y) { 220 } else { 40 };
            [value, value, value, 255]
        });
        Rgba {
            width,
            height,
            bytes: bytes.collect(),
        }
    }

    #[test]
    fn each_eye_sees_its_own_picture_at_its_own_gaze() {
        let camera = Camera::look_at(
            glam::Vec3::ZERO,
            glam::Vec3::X,
            glam::Vec3::Y,
            std::f32::consts::FRAC_PI_2,
        );
        let jod = |output, reference, chosen| {
            let settings = Settings::default().with(|s| {
                s.stereo.mode = foveal::Stereo::Instanced;
                s.stereo.output = output;
                s.eye.display = foveal::Display::Quest3;
            });
            let request = Request {
                settings,
                reference: None,
                camera: camera.clone(),
                frozen: false,
                boxes: false,
                depth: false,
                time_s: 0.0,
                clip: foveal_scene::Clip::default(),
                always: false,
            };
            quality(Pair {
                request,
                reference,
                chosen,
            })
            .map(|found| found.jod)
        };
        let (w, h) = (192, 160);
        let never = |_, _| false;
        // Within an eye's gaze, of one eye's own picture.
        let at_gaze = |x: u32, y: u32| x.abs_diff(w / 2) < 20 && y.abs_diff(h / 2) < 20;
        let flat = jod(Output::Flat, grid(w, h, never), grid(w, h, at_gaze)).unwrap();
        assert!(flat < 9.9, "{flat}");
        for eye in 0..2 {
            let both = grid(2 * w, h, |x, y| x / w == eye && at_gaze(x % w, y));
            let found = jod(Output::SideBySide, grid(2 * w, h, never), both).unwrap();
            assert_eq!(found, flat, "eye {eye}");
        }
        let halves = grid(w, h, |x, y| x < w / 2 && at_gaze(2 * x, y));
        let half = jod(Output::SideBySideHalf, grid(w, h, never), halves).unwrap();
        assert!(half < 9.9, "{half}");
        assert_eq!(
            jod(
                Output::Headset,
                grid(2 * w, h, never),
                grid(2 * w, h, never)
            ),
            None
        );
    }

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
