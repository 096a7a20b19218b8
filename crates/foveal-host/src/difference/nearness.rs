//! How near one picture is to another, as the benches say it: by FLIP, and by the eye's metric at
//! one display.

use foveal_vdp::{Display, Gaze, Metric, Pixels};

use super::flip::ErrorMap;
use crate::picture::Picture;

/// The display of the benches that name none: `h60`, 60 degrees across, whatever the picture's
/// size; the eye looks at the centre.
pub const BENCH_DISPLAY: &str = "h60";

/// How near a picture is to its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// Mean FLIP error; 0 is equal.
    pub flip: f64,
    /// At [`BENCH_DISPLAY`]: 10 is no visible difference. `None` where the picture is too small for
    /// the metric.
    pub jod: Option<f32>,
}

impl Nearness {
    /// Of two pictures of one size.
    pub fn of(reference: &Picture, test: &Picture) -> Self {
        Self {
            flip: ErrorMap::between(reference, test).mean(),
            jod: jod(reference, test),
        }
    }
}

/// JOD at [`BENCH_DISPLAY`].
pub fn jod(reference: &Picture, test: &Picture) -> Option<f32> {
    let display = Display::named(BENCH_DISPLAY)?;
    let (width, height) = (reference.width as usize, reference.height as usize);
    let metric = Metric::new(&display, width, height, Gaze::CENTRE).ok()?;
    let found = metric.compare(pixels(reference), pixels(test)).ok()?;
    Some(found.jod)
}

/// A picture as the metric takes it.
pub fn pixels(picture: &Picture) -> Pixels<'_> {
    Pixels::Rgba(&picture.pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_as_near_to_itself_as_can_be() {
        let pixels = (0..64 * 48).map(|i| [(i % 64 * 4) as u8, 90, 20, 255]);
        let a = Picture {
            width: 64,
            height: 48,
            pixels: pixels.collect(),
        };
        let same = Nearness {
            flip: 0.0,
            jod: Some(10.0),
        };
        assert_eq!(Nearness::of(&a, &a), same);
        let mut b = a.clone();
        b.pixels.iter_mut().step_by(3).for_each(|p| *p = [0; 4]);
        let found = Nearness::of(&a, &b);
        assert!(found.flip > 0.05 && found.jod.unwrap() < 9.0, "{found:?}");
    }
}
