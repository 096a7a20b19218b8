//! Settings of the request pass as its shader reads them, and the pass's twin on the CPU.

use bytemuck::{Pod, Zeroable};

#[cfg(test)]
use super::RateImage;
use super::acuity::{self, Blocks};
use crate::stereo::{Eye, EyeLayout, LensFit};
use crate::{Composite, RateCombine, RateSource, RefineEdges, Settings, Shading};

/// Mirrors `Request` in `rate/request.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct RequestUniform {
    pub(crate) gaze: [[f32; 4]; 2],
    pub(crate) squared_radii: [[f32; 4]; 2],
    pub(crate) lens_squared_radii: [[[f32; 4]; 2]; 2],
    pub(crate) eye_width: f32,
    pub(crate) coarsest: u32,
    pub(crate) constant_level: u32,
    pub(crate) refine_up_to: u32,
    pub(crate) edges_up_to: u32,
    pub(crate) refine_by: u32,
    pub(crate) block_at_gaze: f32,
    pub(crate) block_growth: f32,
    pub(crate) display_from_ndc: [[f32; 4]; 2],
    pub(crate) gaze_direction: [[f32; 4]; 2],
}

/// Levels by which [`RefineEdges::Graded`] refines where samples hold colours. Where they hold
/// light one does: what a pixel shows beyond an edge is its own surface all the same.
const GRADED_BY: u8 = 2;

/// Levels by which [`RefineEdges::Graded`] refines bumpy surfaces, where samples hold light (`rate/crease_of_surface.wgsl`).
pub(super) const BUMPY_BY: u8 = 2;

/// Pixels per unit of the tangent, of the denser of two eyes.
pub(super) fn densest(width: f32, display_from_ndc: [[f32; 4]; 2]) -> f32 {
    let [left, right] = display_from_ndc.map(|d| d[0]);
    width / (2.0 * left.min(right))
}

impl RequestUniform {
    /// The uniform for these settings and eyes; `lenses` are both eyes' where the output has them.
    pub(crate) fn new(s: &Settings, eyes: &[Eye; 2], lenses: Option<&[LensFit; 2]>) -> Self {
        let blocks = if s.is_rated_for_kept_light() {
            Blocks::OfKeptLight
        } else {
            Blocks::OfOneFrame
        };
        Self::with_blocks(s, eyes, lenses, blocks)
    }

    /// That of a frame by itself, whether or not settings keep light.
    pub(crate) fn of_one_frame(
        s: &Settings,
        eyes: &[Eye; 2],
        lenses: Option<&[LensFit; 2]>,
    ) -> Self {
        Self::with_blocks(s, eyes, lenses, Blocks::OfOneFrame)
    }

    fn with_blocks(
        s: &Settings,
        eyes: &[Eye; 2],
        lenses: Option<&[LensFit; 2]>,
        blocks: Blocks,
    ) -> Self {
        let (width, height) = (s.picture.width as f32, s.picture.height as f32);
        let layout = EyeLayout::of(s);
        let right = [0, 1].map(|axis| s.eye.gaze[axis] + s.stereo.gaze_shift[axis]);
        let displays = [0, 1].map(|eye| acuity::display_from_ndc(s, &eyes[eye]));
        let density = densest(width, displays);
        let blocks = if refines_bumps(s) {
            blocks
        } else {
            Blocks::WithEvenBumps
        };
        let side = blocks.side(s.eye.quality_jod, density);
        let gaze = |eye: u32, [x, y]: [f32; 2]| {
            let first = (eye * layout.stride) as f32;
            [first + x * width, y * height, 0.0, 0.0]
        };
        let refine_up_to = match s.coarse.refine_edges {
            RefineEdges::Inner => s.coarse.coarsest_level / 2,
            RefineEdges::Graded | RefineEdges::Everywhere => s.coarse.coarsest_level,
            RefineEdges::Off => 0,
        };
        Self {
            gaze: [gaze(0, s.eye.gaze), gaze(1, right)],
            squared_radii: squared_radii(s),
            lens_squared_radii: lenses.map_or([[[f32::MAX; 4]; 2]; 2], |lenses| {
                lenses.map(|lens| halves(lens.squared_radii()))
            }),
            eye_width: layout.stride as f32,
            coarsest: u32::from(s.coarse.coarsest_level),
            constant_level: u32::from(s.coarse.constant_level),
            refine_up_to: u32::from(refine_up_to),
            edges_up_to: u32::from(match s.coarse.composite {
                Composite::Smooth => s.coarse.coarsest_level,
                Composite::Light | Composite::Nearest | Composite::Paper => refine_up_to,
            }),
            refine_by: u32::from(match s.coarse.refine_edges {
                RefineEdges::Graded => match s.coarse.composite {
                    Composite::Light => 1,
                    _ => GRADED_BY,
                },
                _ => crate::COARSEST_LEVEL,
            }),
            block_at_gaze: side.at_gaze,
            block_growth: side.growth,
            display_from_ndc: displays,
            gaze_direction: [
                acuity::direction(displays[0], s.eye.gaze),
                acuity::direction(displays[1], right),
            ],
        }
    }

    /// The level that the eye allows at a position in pixels of the left or only eye's picture.
    #[cfg(test)]
    pub(crate) fn foveated(&self, s: &Settings, pixel: [f32; 2]) -> u32 {
        acuity::level(self, s, pixel)
    }

    /// The level that the pixel at (x, y) of a picture without a lens requests, edges aside.
    #[cfg(test)]
    pub(crate) fn level(&self, s: &Settings, x: u32, y: u32, image: Option<&RateImage>) -> u8 {
        let from = |source| match source {
            RateSource::Foveated => self.foveated(s, [x as f32 + 0.5, y as f32 + 0.5]),
            RateSource::Radii => {
                let eye = usize::from(x as f32 + 0.5 >= self.eye_width);
                let dx = x as f32 + 0.5 - self.gaze[eye][0];
                let dy = y as f32 + 0.5 - self.gaze[eye][1];
                let squared = dx * dx + dy * dy;
                let radii = self.squared_radii.as_flattened();
                radii.iter().filter(|&&r| squared >= r).count() as u32
            }
            RateSource::Constant => self.constant_level,
            RateSource::Lens => 0,
            RateSource::Image | RateSource::Content => image.map_or(0, |i| {
                let (w, h) = i.size();
                let texel = y * h / s.picture.height * w + x * w / s.picture.width;
                u32::from(i.levels()[texel as usize])
            }),
        };
        let first = from(s.coarse.source);
        let level = match s.coarse.combine {
            RateCombine::First => first,
            RateCombine::Coarser => first.max(from(s.coarse.other_source)),
            RateCombine::Finer => first.min(from(s.coarse.other_source)),
        };
        level.min(self.coarsest) as u8
    }
}

/// Whether bumpy surfaces request finer levels than others do.
pub(super) fn refines_bumps(s: &Settings) -> bool {
    s.shading.mode == Shading::Coarse
        && s.coarse.composite == Composite::Light
        && s.coarse.refine_edges == RefineEdges::Graded
}

/// Overrides of the request pass's shader.
pub(super) fn request_constants(s: &Settings) -> [(&'static str, f64); 4] {
    let number = |source| match source {
        RateSource::Foveated => 0.0,
        RateSource::Constant => 1.0,
        // Content is refused by the settings' check.
        RateSource::Image | RateSource::Content => 2.0,
        RateSource::Lens => 3.0,
        RateSource::Radii => 4.0,
    };
    let combine = match s.coarse.combine {
        RateCombine::First => 0.0,
        RateCombine::Coarser => 1.0,
        RateCombine::Finer => 2.0,
    };
    [
        ("SOURCE", number(s.coarse.source)),
        ("OTHER", number(s.coarse.other_source)),
        ("COMBINE", combine),
        (
            "BUMPY_BY",
            f64::from(if refines_bumps(s) { BUMPY_BY } else { 0 }),
        ),
    ]
}

/// Squared radii in pixels from which on levels 1, 2, ... are requested; out of reach beyond the
/// coarsest. They come from the CPU once a frame, so that no device's power function decides over a
/// pixel's level.
fn squared_radii(s: &Settings) -> [[f32; 4]; 2] {
    let height = s.picture.height as f32;
    let (inner, outer) = (s.coarse.fovea_inner * height, s.coarse.fovea_outer * height);
    let steps = f32::from(s.coarse.coarsest_level.max(2) - 1);
    let mut radii = [f32::MAX; 8];
    for (step, radius) in radii
        .iter_mut()
        .take(s.coarse.coarsest_level.into())
        .enumerate()
    {
        let along = (step as f32 / steps).powf(s.coarse.fovea_curve);
        let r = inner + (outer - inner).max(0.0) * along;
        *radius = r * r;
    }
    halves(radii)
}

fn halves([a, b, c, d, e, f, g, h]: [f32; 8]) -> [[f32; 4]; 2] {
    [[a, b, c, d], [e, f, g, h]]
}

#[cfg(test)]
mod tests {
    use foveal_scene::Camera;
    use glam::Vec3;

    use super::*;

    fn eyes_of(s: &Settings) -> [Eye; 2] {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
        crate::stereo::eyes(s, &camera).unwrap()
    }

    #[test]
    fn foveated_blocks_are_as_large_as_the_smallest_angle_that_the_eye_resolves() {
        // 60 degrees across: 1108.5 pixels before the plane of 1280 pixels.
        let s = Settings::default().with(|s| {
            s.picture.width = 1280;
            s.picture.height = 720;
            s.eye.display = "60".parse().expect("it can be read");
        });
        let uniform = RequestUniform::new(&s, &eyes_of(&s), None);
        let factor = uniform.block_growth / 0.0275;
        let plane = 640.0 / 30f32.to_radians().tan();
        for x in [640, 700, 800, 900, 1000, 1100, 1279] {
            let angle = ((x as f32 + 0.5 - 640.0) / plane).atan();
            let degrees = factor * (1.0 / 48.0 + 0.0275 * angle.to_degrees());
            let pixel = (1.0 / plane * angle.cos()).to_degrees();
            let block = degrees / pixel;
            let level = uniform.level(&s, x, 360, None);
            let side = f32::from(1u16 << level);
            // Near the gaze a block is never smaller than a pixel; the angle's series is good to
            // half a per cent.
            assert!(side <= (block * 1.01).max(1.0), "{x}: {side} {block}");
            assert!(block < side * 2.02, "{x}: {side} {block}");
        }
    }

    #[test]
    fn better_quality_and_closer_displays_ask_for_smaller_blocks() {
        let level = |quality, display: &str, x| {
            let s = Settings::default().with(|s| {
                s.picture.width = 1280;
                s.picture.height = 720;
                s.eye.display = display.parse().expect("it can be read");
                s.eye.quality_jod = quality;
            });
            RequestUniform::new(&s, &eyes_of(&s), None).level(&s, x, 360, None)
        };
        for x in [640, 760, 900, 1270] {
            let levels =
                [10.0, 9.8, 9.6, 9.4, 9.2, 9.0, 8.0].map(|quality| level(quality, "60", x));
            assert!(levels.is_sorted(), "{x}: {levels:?}");
        }
        assert!(level(10.0, "60", 1270) < level(9.0, "60", 1270));
        // The same picture far away: more pixels to a degree.
        assert!(level(8.0, "1", 640) > level(8.0, "60", 640));
    }

    #[test]
    fn blocks_are_larger_where_bumps_are_refined_at_every_quality() {
        let growth = |quality, edges, history| {
            let s = Settings::default().with(|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.history = history;
                s.picture.width = 1280;
                s.picture.height = 720;
                s.eye.display = "60".parse().expect("it can be read");
                s.eye.quality_jod = quality;
                s.coarse.refine_edges = edges;
            });
            RequestUniform::new(&s, &eyes_of(&s), None).block_growth / 0.0275
        };
        let mut smaller = f32::MAX;
        for step in 0..=150 {
            let quality = 8.5 + 0.01 * step as f32;
            let refined = growth(quality, RefineEdges::Graded, false);
            assert!(refined <= smaller, "{quality}");
            assert!(
                refined >= growth(quality, RefineEdges::Off, false),
                "{quality}"
            );
            assert!(
                refined > growth(quality, RefineEdges::Graded, true),
                "{quality}"
            );
            smaller = refined;
        }
        let default = growth(9.5, RefineEdges::Graded, false);
        assert!((default - 1.4).abs() < 1e-3, "{default}");
    }

    #[test]
    fn denser_displays_get_finer_blocks() {
        let growth = |width, display: &str| {
            let s = Settings::default().with(|s| {
                s.picture.width = width;
                s.picture.height = width * 9 / 16;
                s.eye.display = display.parse().expect("it can be read");
            });
            RequestUniform::new(&s, &eyes_of(&s), None).block_growth
        };
        let measured = growth(1280, "60");
        assert!((measured / 0.0275 - 0.42).abs() < 1e-4);
        // Fewer pixels to a degree than were measured: the same angles.
        assert_eq!(growth(640, "60"), measured);
        assert_eq!(growth(1920, "91.5"), measured);
        let twice = growth(2560, "60") / measured;
        assert!((twice - 0.5_f32.powf(0.75)).abs() < 1e-3, "{twice}");
        assert!(growth(1920, "fhd-24") < 0.65 * measured);
    }

    #[test]
    fn levels_grow_from_the_inner_to_the_outer_radius() {
        let s = Settings::default().with(|s| {
            s.coarse.source = RateSource::Radii;
            s.picture.width = 1000;
            s.picture.height = 1000;
            s.eye.gaze = [0.0, 0.0];
            s.coarse.fovea_inner = 0.1;
            s.coarse.fovea_outer = 0.8;
        });
        let uniform = RequestUniform::new(&s, &eyes_of(&s), None);
        let along: Vec<u8> = (0..1000).map(|x| uniform.level(&s, x, 0, None)).collect();
        assert!(along[..100].iter().all(|&l| l == 0));
        assert!(along[101..].iter().all(|&l| l > 0));
        assert!(along[801..].iter().all(|&l| l == 8));
        assert!(along.is_sorted());
        assert!((1..8).all(|l| along.contains(&l)));
    }

    #[test]
    fn two_sources_combine_to_the_coarser_or_the_finer_wish() {
        let image = RateImage::new(2, 1, vec![0, 255]);
        let level = |combine| {
            let s = Settings::default().with(|s| {
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = 3;
                s.coarse.other_source = RateSource::Image;
                s.coarse.combine = combine;
                s.picture.width = 10;
                s.picture.height = 1;
            });
            [0, 9].map(|x| {
                RequestUniform::new(&s, &eyes_of(&s), None).level(&s, x, 0, image.as_ref())
            })
        };
        assert_eq!(level(RateCombine::First), [3, 3]);
        assert_eq!(level(RateCombine::Coarser), [3, 8]);
        assert_eq!(level(RateCombine::Finer), [0, 3]);
    }

    #[test]
    fn the_denser_eye_decides_whichever_it_is() {
        let growth = |frusta: &str| {
            let s = Settings::default().with(|s| {
                s.stereo.mode = crate::Stereo::TwoPass;
                s.stereo.frusta = frusta.parse().expect("it can be read");
            });
            RequestUniform::new(&s, &eyes_of(&s), None).block_growth
        };
        let [wide, dense] = ["-2,2,-1,1", "-0.5,0.5,-0.25,0.25"];
        let expected = growth(&format!("{dense},{dense}"));
        assert_eq!(growth(&format!("{wide},{dense}")), expected);
        assert_eq!(growth(&format!("{dense},{wide}")), expected);
        assert!(growth(&format!("{wide},{wide}")) > expected);
    }
}
