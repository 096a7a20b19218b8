//! The lens before a headset's screen, and its inverse.
//!
//! Radii are tangents of the angle to the lens's axis: `screen` ones as the bare screen would be
//! seen, `seen` ones as the lens shows it. The forward map is the profile's polynomial, the inverse
//! is found numerically.

use super::Eye;
use crate::settings::LensProfile;
use crate::{Error, Settings};

/// Seen radius up to which every profile must be sound: 45 degrees. Beyond, a frustum decides.
const LEAST_SEEN: f32 = 1.0;

impl LensProfile {
    /// Where green light of a screen radius is seen.
    pub(crate) fn seen(&self, screen: f32) -> f32 {
        let [k1, k2, k3] = self.distortion;
        let u = screen * screen;
        screen * (1.0 + u * (k1 + u * (k2 + u * k3)))
    }

    /// How fast the seen radius grows with the screen radius.
    fn growth(&self, screen: f32) -> f32 {
        let [k1, k2, k3] = self.distortion;
        let u = screen * screen;
        1.0 + u * (3.0 * k1 + u * (5.0 * k2 + u * 7.0 * k3))
    }

    /// The screen radius at which a radius is seen: the inverse of [`LensProfile::seen`]; none
    /// where the lens shows it nowhere.
    pub(crate) fn screen(&self, seen: f32) -> Option<f32> {
        let (mut low, mut high) = (0.0f32, 1.0f32);
        while self.seen(high) < seen {
            if high > 16.0 || self.growth(high) <= 0.0 {
                return None;
            }
            low = high;
            high *= 1.25;
        }
        // Bisection halves the interval to the last bit: no polynomial makes it fail.
        for _ in 0..48 {
            let center = 0.5 * (low + high);
            if self.seen(center) < seen {
                low = center;
            } else {
                high = center;
            }
        }
        Some(0.5 * (low + high))
    }

    /// Pixels of the screen per pixel of an evenly spaced picture, relative to the axis and as a
    /// length: the root of the areas' ratio.
    fn density(&self, screen: f32) -> f32 {
        let around = if screen > 0.0 {
            screen / self.seen(screen)
        } else {
            1.0
        };
        (around / self.growth(screen)).sqrt()
    }

    /// Whether seen radii grow with screen radii up to `screen`.
    fn is_sound_up_to(&self, screen: f32) -> bool {
        let steps = 256;
        (0..=steps).all(|i| self.growth(screen * i as f32 / steps as f32) > 0.01)
    }
}

/// Checks a profile as far as no frustum is needed.
///
/// # Errors
/// [`Error::Setting`] for `lens`.
pub(crate) fn check_lens(lens: &LensProfile) -> Result<(), Error> {
    let numbers = lens.distortion.iter().chain(&lens.red).chain(&lens.blue);
    let finite = numbers.clone().all(|n| n.abs() <= 1000.0);
    let colours = [lens.red, lens.blue]
        .iter()
        .all(|c| (0.5..=2.0).contains(&c[0]) && c[1].abs() <= 0.5);
    let grows = || {
        let reach = lens.screen(LEAST_SEEN);
        reach.is_some_and(|reach| lens.is_sound_up_to(reach))
    };
    if finite && colours && grows() {
        return Ok(());
    }
    Err(Error::Setting {
        name: "lens",
        value: format!("{:?}", numbers.collect::<Vec<_>>()),
        expected: "numbers up to 1000, with colour factors c0 from 0.5 to 2 and c1 from -0.5 to 0.5, and radii that \
                   grow at least up to 45 degrees",
    })
}

/// A lens fitted to an eye's frustum: its borders, along the axes, are those of the eye's half of
/// the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LensFit {
    pub(crate) lens: LensProfile,
    /// Left, right, bottom, top of the half of the screen, as tangents without the lens.
    pub(crate) screen: [f32; 4],
}

impl LensFit {
    /// # Errors
    /// [`Error::Setting`] where the lens cannot show the frustum.
    pub(crate) fn new(lens: LensProfile, eye: &Eye) -> Result<Self, Error> {
        let borders = eye.borders();
        let screen = borders.map(|b| lens.screen(b.abs()).map(|p| p.copysign(b)));
        if let [Some(l), Some(r), Some(b), Some(t)] = screen {
            let corner = l.abs().max(r.abs()).hypot(b.abs().max(t.abs()));
            if lens.is_sound_up_to(corner) {
                return Ok(Self {
                    lens,
                    screen: [l, r, b, t],
                });
            }
        }
        Err(Error::Setting {
            name: "lens",
            value: format!("{:?} for a frustum of {borders:?}", lens.distortion),
            expected: "one that shows the whole frustum; take a smaller field of view or another lens",
        })
    }

    /// Both eyes' fits, where the settings show through lenses.
    ///
    /// # Errors
    /// As [`LensFit::new`].
    pub(crate) fn of(settings: &Settings, eyes: &[Eye; 2]) -> Result<Option<[Self; 2]>, Error> {
        if !settings.is_stereo() || settings.stereo.output != crate::Output::Headset {
            return Ok(None);
        }
        let lens = settings.stereo.lens.profile();
        Ok(Some([
            Self::new(lens, &eyes[0])?,
            Self::new(lens, &eyes[1])?,
        ]))
    }

    /// Squared seen radii from which on levels 1, 2, ... 8 come nearest to the screen's own pixels,
    /// whose density falls outwards: samples per pixel of the screen stay within a factor of two of
    /// the axis's. Beyond what the screen's corners show, every level does.
    pub(crate) fn squared_radii(&self) -> [f32; 8] {
        let [l, r, b, t] = self.screen;
        let corner = l.abs().max(r.abs()).hypot(b.abs().max(t.abs()));
        std::array::from_fn(|level| {
            let wanted = 0.5f32.powf(level as f32 + 0.5);
            let radius = |step: u32| corner * step as f32 / 1024.0;
            let finer = (0..1024)
                .rev()
                .find(|&step| self.lens.density(radius(step)) > wanted);
            self.lens
                .seen(radius(finer.map_or(0, |step| step + 1)))
                .powi(2)
        })
    }
}
