//! Settings of the wish pass as its shader reads them, and the pass's twin on the CPU.

use bytemuck::{Pod, Zeroable};

#[cfg(test)]
use super::RateImage;
use crate::stereo::{EyeLayout, LensFit};
use crate::{Composite, RateCombine, RateSource, RefineEdges, Settings};

/// Mirrors `Wish` in `rate/wish.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct WishUniform {
    pub(crate) gaze: [[f32; 4]; 2],
    pub(crate) squared_radii: [[f32; 4]; 2],
    pub(crate) lens_squared_radii: [[[f32; 4]; 2]; 2],
    pub(crate) eye_width: f32,
    pub(crate) coarsest: u32,
    pub(crate) constant_level: u32,
    pub(crate) refine_up_to: u32,
    pub(crate) edges_up_to: u32,
    pub(crate) refine_by: u32,
    pub(crate) reserved_1: u32,
    pub(crate) reserved_2: u32,
}

/// Levels by which [`RefineEdges::Graded`] refines.
const GRADED_BY: u8 = 2;

impl WishUniform {
    /// The uniform for these settings; `lenses` are both eyes' where the output has them.
    pub(crate) fn new(s: &Settings, lenses: Option<&[LensFit; 2]>) -> Self {
        let (width, height) = (s.width as f32, s.height as f32);
        let layout = EyeLayout::of(s);
        let right = [0, 1].map(|axis| s.gaze[axis] + s.gaze_shift[axis]);
        let gaze = |eye: u32, [x, y]: [f32; 2]| {
            let first = (eye * layout.stride) as f32;
            [first + x * width, y * height, 0.0, 0.0]
        };
        let refine_up_to = match s.refine_edges {
            RefineEdges::Inner => s.coarsest_level / 2,
            RefineEdges::Graded | RefineEdges::Everywhere => s.coarsest_level,
            RefineEdges::Off => 0,
        };
        Self {
            gaze: [gaze(0, s.gaze), gaze(1, right)],
            squared_radii: squared_radii(s),
            lens_squared_radii: lenses.map_or([[[f32::MAX; 4]; 2]; 2], |lenses| {
                lenses.map(|lens| halves(lens.squared_radii()))
            }),
            eye_width: layout.stride as f32,
            coarsest: u32::from(s.coarsest_level),
            constant_level: u32::from(s.rate_level),
            refine_up_to: u32::from(refine_up_to),
            edges_up_to: u32::from(match s.composite {
                Composite::Smooth => s.coarsest_level,
                Composite::Nearest | Composite::Paper => refine_up_to,
            }),
            refine_by: u32::from(match s.refine_edges {
                RefineEdges::Graded => GRADED_BY,
                _ => crate::COARSEST_LEVEL,
            }),
            reserved_1: 0,
            reserved_2: 0,
        }
    }

    /// The level that the pixel at (x, y) of a picture without a lens wishes, edges aside.
    #[cfg(test)]
    pub(crate) fn level(&self, s: &Settings, x: u32, y: u32, image: Option<&RateImage>) -> u8 {
        let from = |source| match source {
            RateSource::Foveated => {
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
                let texel = y * h / s.height * w + x * w / s.width;
                u32::from(i.levels()[texel as usize])
            }),
        };
        let first = from(s.rate);
        let level = match s.rate_combine {
            RateCombine::First => first,
            RateCombine::Coarser => first.max(from(s.rate_other)),
            RateCombine::Finer => first.min(from(s.rate_other)),
        };
        level.min(self.coarsest) as u8
    }
}

/// Overrides of the wish pass's shader.
pub(super) fn wish_constants(s: &Settings) -> [(&'static str, f64); 3] {
    let number = |source| match source {
        RateSource::Foveated => 0.0,
        RateSource::Constant => 1.0,
        // Content is refused by the settings' check.
        RateSource::Image | RateSource::Content => 2.0,
        RateSource::Lens => 3.0,
    };
    let combine = match s.rate_combine {
        RateCombine::First => 0.0,
        RateCombine::Coarser => 1.0,
        RateCombine::Finer => 2.0,
    };
    [
        ("SOURCE", number(s.rate)),
        ("OTHER", number(s.rate_other)),
        ("COMBINE", combine),
    ]
}

/// Squared radii in pixels from which on levels 1, 2, ... are wished; out of reach beyond the coarsest. They come
/// from the CPU once a frame, so that no device's power function decides over a pixel's level.
fn squared_radii(s: &Settings) -> [[f32; 4]; 2] {
    let height = s.height as f32;
    let (inner, outer) = (s.fovea_inner * height, s.fovea_outer * height);
    let steps = f32::from(s.coarsest_level.max(2) - 1);
    let mut radii = [f32::MAX; 8];
    for (step, radius) in radii.iter_mut().take(s.coarsest_level.into()).enumerate() {
        let along = (step as f32 / steps).powf(s.fovea_curve);
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
    use super::*;

    #[test]
    fn foveated_levels_grow_from_the_inner_to_the_outer_radius() {
        let s = Settings {
            width: 1000,
            height: 1000,
            gaze: [0.0, 0.0],
            fovea_inner: 0.1,
            fovea_outer: 0.8,
            ..Settings::default()
        };
        let uniform = WishUniform::new(&s, None);
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
            let s = Settings {
                rate: RateSource::Constant,
                rate_level: 3,
                rate_other: RateSource::Image,
                rate_combine: combine,
                width: 10,
                height: 1,
                ..Settings::default()
            };
            [0, 9].map(|x| WishUniform::new(&s, None).level(&s, x, 0, image.as_ref()))
        };
        assert_eq!(level(RateCombine::First), [3, 3]);
        assert_eq!(level(RateCombine::Coarser), [3, 8]);
        assert_eq!(level(RateCombine::Finer), [0, 3]);
    }
}
