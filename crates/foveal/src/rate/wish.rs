//! Settings of the wish pass as its shader reads them, and the pass's twin on the CPU.

use bytemuck::{Pod, Zeroable};

#[cfg(test)]
use super::RateImage;
use crate::{RateCombine, RateSource, RefineEdges, Settings};

/// Mirrors `Wish` in `rate/wish.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct WishUniform {
    pub(crate) gaze: [[f32; 4]; 2],
    pub(crate) squared_radii: [[f32; 4]; 2],
    pub(crate) eye_width: f32,
    pub(crate) coarsest: u32,
    pub(crate) constant_level: u32,
    pub(crate) source: u32,
    pub(crate) other: u32,
    pub(crate) combine: u32,
    pub(crate) refine_up_to: u32,
    pub(crate) find_edges: u32,
}

impl WishUniform {
    /// The uniform for one eye that fills the target.
    pub(crate) fn new(s: &Settings) -> Self {
        let (width, height) = (s.width as f32, s.height as f32);
        let gaze = [s.gaze[0] * width, s.gaze[1] * height, 0.0, 0.0];
        let refine_up_to = match s.refine_edges {
            RefineEdges::Inner => s.coarsest_level / 2,
            RefineEdges::Everywhere => s.coarsest_level,
            RefineEdges::Off => 0,
        };
        Self {
            gaze: [gaze; 2],
            squared_radii: squared_radii(s),
            eye_width: width,
            coarsest: u32::from(s.coarsest_level),
            constant_level: u32::from(s.rate_level),
            source: source_number(s.rate),
            other: source_number(s.rate_other),
            combine: match s.rate_combine {
                RateCombine::First => 0,
                RateCombine::Coarser => 1,
                RateCombine::Finer => 2,
            },
            refine_up_to: u32::from(refine_up_to),
            find_edges: u32::from(finds_edges(s)),
        }
    }

    /// The level that the pixel at (x, y) wishes, edges aside.
    #[cfg(test)]
    pub(crate) fn level(&self, x: u32, y: u32, size: (u32, u32), image: Option<&RateImage>) -> u8 {
        let from = |source: u32| match source {
            0 => {
                let eye = usize::from(x as f32 + 0.5 >= self.eye_width);
                let dx = x as f32 + 0.5 - self.gaze[eye][0];
                let dy = y as f32 + 0.5 - self.gaze[eye][1];
                let squared = dx * dx + dy * dy;
                let radii = self.squared_radii.as_flattened();
                radii.iter().filter(|&&r| squared >= r).count() as u32
            }
            1 => self.constant_level,
            _ => image.map_or(0, |i| {
                let (w, h) = i.size();
                let texel = y * h / size.1 * w + x * w / size.0;
                u32::from(i.levels()[texel as usize])
            }),
        };
        let first = from(self.source);
        let level = match self.combine {
            0 => first,
            1 => first.max(from(self.other)),
            _ => first.min(from(self.other)),
        };
        level.min(self.coarsest) as u8
    }
}

/// Whether some later pass asks where surfaces end.
fn finds_edges(s: &Settings) -> bool {
    s.refine_edges != RefineEdges::Off || s.composite == crate::Composite::Smooth
}

fn source_number(source: RateSource) -> u32 {
    match source {
        RateSource::Foveated => 0,
        RateSource::Constant => 1,
        RateSource::Image => 2,
    }
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
    let [a, b, c, d, e, f, g, h] = radii;
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
        let uniform = WishUniform::new(&s);
        let along: Vec<u8> = (0..1000)
            .map(|x| uniform.level(x, 0, (1000, 1000), None))
            .collect();
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
                ..Settings::default()
            };
            [0, 9].map(|x| WishUniform::new(&s).level(x, 0, (10, 1), image.as_ref()))
        };
        assert_eq!(level(RateCombine::First), [3, 3]);
        assert_eq!(level(RateCombine::Coarser), [3, 8]);
        assert_eq!(level(RateCombine::Finer), [0, 3]);
    }
}
