//! Where the shown picture has what each eye sees, as `output/eyes.wgsl` puts it there.

use foveal_scene::Camera;
use glam::{Mat4, Vec2};

use super::{Eye, LensFit, eyes};
use crate::{Error, Output, Settings};

/// The eyes whose pictures are shown, and where: for hosts that draw over the picture or ask what
/// is under the pointer.
///
/// Places are fractions of a picture from its top left corner. Eye 0 is the left or only one, eye 1
/// the right one.
///
/// ```
/// # use foveal::{Output, Settings, ShownEyes, Stereo};
/// # use foveal::{foveal_scene::Camera, glam::Vec3};
/// let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
/// let settings = Settings::default().with(|s| {
///     s.stereo.mode = Stereo::Auto;
///     s.stereo.output = Output::SideBySide;
/// });
/// let eyes = ShownEyes::new(&settings, &camera)?;
/// assert_eq!(eyes.seen([0.75, 0.25]), (1, [0.5, 0.25]));
/// # Ok::<(), foveal::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ShownEyes {
    output: Output,
    eyes: [Eye; 2],
    lenses: Option<[LensFit; 2]>,
    /// Where the right eye's picture begins. Of an odd width the left one has a column more.
    cut: f32,
}

impl ShownEyes {
    /// The eyes of a camera.
    ///
    /// # Errors
    /// [`Error::Setting`] where the camera makes no sense, where two eyes should see in parallel
    /// projection, and where the lens cannot show a frustum.
    pub fn new(settings: &Settings, camera: &Camera) -> Result<Self, Error> {
        let eyes = eyes(settings, camera)?;
        let output = if settings.is_stereo() {
            settings.stereo.output
        } else {
            Output::Flat
        };
        Ok(Self {
            output,
            eyes,
            lenses: LensFit::of(settings, &eyes)?,
            cut: match output {
                Output::SideBySideHalf => {
                    let across = settings.picture.width.max(1);
                    across.div_ceil(2) as f32 / across as f32
                }
                _ => 0.5,
            },
        })
    }

    /// Number of eyes that have a part of the picture to themselves. Where it is 1, that is eye 0:
    /// in an anaglyph the right eye's picture lies over it.
    #[must_use]
    pub fn count(&self) -> usize {
        self.output.pictures_beside()
    }

    /// Whether straight lines are shown bent, by a headset's lens.
    #[must_use]
    pub fn bends_lines(&self) -> bool {
        self.lenses.is_some()
    }

    /// Clip space of an eye's own picture from world space; depth is reversed.
    #[must_use]
    pub fn clip_from_world(&self, eye: usize) -> Mat4 {
        self.eyes[eye.min(1)].clip_from_world()
    }

    /// The eye that a place of the shown picture belongs to, and the place in its own picture.
    /// Outside of 0 to 1 the eye sees nothing there: a headset's corners are black.
    #[must_use]
    pub fn seen(&self, place: [f32; 2]) -> (usize, [f32; 2]) {
        let [x, y] = place;
        if self.count() == 1 {
            return (0, place);
        }
        let eye = usize::from(x >= self.cut);
        let half = [2.0 * (x - eye as f32 * self.cut), y];
        let Some(lenses) = &self.lenses else {
            return (eye, half);
        };
        let fit = &lenses[eye];
        let screen = tangents(fit.screen, half);
        let radius = screen.length();
        let bent = if radius > 0.0 {
            screen * (fit.lens.seen(radius) / radius)
        } else {
            screen
        };
        (eye, place_of(self.eyes[eye].borders(), bent))
    }

    /// Where the shown picture has a place of an eye's picture: the inverse of
    /// [`ShownEyes::seen`]. `None` where the lens shows it nowhere.
    #[must_use]
    pub fn shown(&self, eye: usize, place: [f32; 2]) -> Option<[f32; 2]> {
        if self.count() == 1 {
            return Some(place);
        }
        let eye = eye.min(1);
        let mut half = place;
        if let Some(lenses) = &self.lenses {
            let seen = tangents(self.eyes[eye].borders(), place);
            let radius = seen.length();
            let screen = if radius > 0.0 {
                seen * (lenses[eye].lens.screen(radius)? / radius)
            } else {
                seen
            };
            half = place_of(lenses[eye].screen, screen);
        }
        Some([0.5 * half[0] + eye as f32 * self.cut, half[1]])
    }
}

/// The tangents at a place between borders: left, right, bottom and top.
fn tangents([left, right, bottom, top]: [f32; 4], [x, y]: [f32; 2]) -> Vec2 {
    Vec2::new(left + (right - left) * x, top + (bottom - top) * y)
}

/// The inverse of [`tangents`].
fn place_of([left, right, bottom, top]: [f32; 4], at: Vec2) -> [f32; 2] {
    [
        (at.x - left) / (right - left),
        (top - at.y) / (top - bottom),
    ]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::Stereo;

    const OUTPUTS: [Output; 6] = [
        Output::Flat,
        Output::SideBySide,
        Output::SideBySideHalf,
        Output::Anaglyph,
        Output::AnaglyphDubois,
        Output::Headset,
    ];

    fn shown_eyes(output: Output) -> ShownEyes {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
        let settings = Settings::default().with(|s| {
            s.stereo.mode = Stereo::Auto;
            s.stereo.output = output;
        });
        ShownEyes::new(&settings, &camera).expect("sound eyes")
    }

    #[test]
    fn what_is_shown_at_a_place_is_seen_there() {
        for output in OUTPUTS {
            let eyes = shown_eyes(output);
            for eye in 0..eyes.count() {
                for place in [[0.5, 0.5], [0.1, 0.3], [0.7, 0.99], [0.02, 0.02]] {
                    let at = eyes.shown(eye, place).expect("within the lens");
                    let (again, seen) = eyes.seen(at);
                    assert_eq!(again, eye, "{output:?}");
                    let off = (Vec2::from(seen) - Vec2::from(place)).length();
                    assert!(off < 1e-4, "{output:?}: {place:?}, {seen:?}");
                }
            }
        }
    }

    #[test]
    fn a_point_ahead_at_the_convergence_is_amid_each_half() {
        let ahead = Vec3::new(0.0, 0.0, -Settings::default().stereo.convergence_m);
        for output in OUTPUTS {
            let eyes = shown_eyes(output);
            for eye in 0..eyes.count() {
                let at = eyes.clip_from_world(eye).project_point3(ahead);
                let at = eyes.shown(eye, [0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y]);
                let [x, y] = at.expect("within the lens");
                let amid = (eye as f32 + 0.5) / eyes.count() as f32;
                // A frustum that is shifted is bent unevenly.
                assert!((x - amid).abs() < 0.01, "{output:?}: {x}");
                assert!((y - 0.5).abs() < 1e-5, "{output:?}: {y}");
            }
        }
    }

    #[test]
    fn a_headset_s_corners_show_nothing() {
        let eyes = shown_eyes(Output::Headset);
        let (eye, [x, y]) = eyes.seen([0.001, 0.001]);
        assert!(eye == 0 && x < 0.0 && y < 0.0, "{x} {y}");
    }
}
