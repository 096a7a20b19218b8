//! A picture that is larger than what was drawn for it.

use super::{PICTURE_FORMAT, PresentPass};
use crate::gpu::{Gpu, target};
use crate::recorder::Recorder;
use crate::{Settings, Target};

/// Stretches what was drawn, bilinearly, to the size that the settings ask for.
#[derive(Debug)]
pub(crate) struct Upscale {
    pass: PresentPass,
    /// Side by side in what is drawn.
    pictures: usize,
    picture_view: wgpu::TextureView,
}

impl Upscale {
    /// `None` where the frame is drawn at its size.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let size = settings.picture_size();
        let none = wgpu::TextureUsages::empty();
        (settings.drawn().picture_size() != size).then(|| Self {
            pass: PresentPass::new(gpu),
            pictures: settings.pictures_beside(),
            picture_view: target(gpu, "upscaled picture", size, PICTURE_FORMAT, none),
        })
    }

    /// Encodes the pass.
    pub(crate) fn stretch(&mut self, recorder: &mut Recorder<'_>, drawn: &wgpu::TextureView) {
        let target = Target {
            view: &self.picture_view,
            format: PICTURE_FORMAT,
        };
        self.pass.present(recorder, drawn, target, self.pictures);
    }

    /// The picture.
    pub(crate) fn picture_view(&self) -> &wgpu::TextureView {
        &self.picture_view
    }

    /// Bytes of the picture.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.picture_view.texture().size();
        4 * u64::from(size.width) * u64::from(size.height)
    }
}

#[cfg(test)]
mod tests {
    use foveal_generate as generate;

    use crate::testing::{picture, rendered, small};
    use crate::{Geometry, Output, RateSource, Shading};

    /// A picture of `from`'s size, stretched as a sampler does that clamps to the border.
    fn stretched(bytes: &[u8], from: (u32, u32), to: (u32, u32)) -> Vec<f32> {
        let along = |i: u32, from: u32, to: u32| {
            let at = (i as f32 + 0.5) * from as f32 / to as f32 - 0.5;
            let low = at.floor();
            let clamped = |texel: f32| texel.clamp(0.0, from as f32 - 1.0) as u32;
            (clamped(low), clamped(low + 1.0), at - low)
        };
        let mut out = Vec::new();
        for y in 0..to.1 {
            let (y0, y1, fy) = along(y, from.1, to.1);
            for x in 0..to.0 {
                let (x0, x1, fx) = along(x, from.0, to.0);
                for c in 0..4 {
                    let at = |x: u32, y: u32| f32::from(bytes[((y * from.0 + x) * 4 + c) as usize]);
                    let upper = at(x0, y0) * (1.0 - fx) + at(x1, y0) * fx;
                    let lower = at(x0, y1) * (1.0 - fx) + at(x1, y1) * fx;
                    out.push(upper * (1.0 - fy) + lower * fy);
                }
            }
        }
        out
    }

    #[test]
    fn a_scaled_frame_is_the_smaller_one_stretched_with_its_rates() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        for (size, scale, shading) in [
            ((160, 90), 0.5, Shading::Variable),
            ((121, 67), 0.75, Shading::Variable),
            ((121, 67), 0.6, Shading::Coarse),
        ] {
            let scaled = small(size.0, size.1).with(|s| {
                s.picture.render_scale = scale;
                s.geometry.path = Geometry::Visibility;
                s.shading.mode = shading;
                s.coarse.source = match shading {
                    Shading::Variable => RateSource::Content,
                    _ => RateSource::Foveated,
                };
                s.rate.force = true;
            });
            let drawn = scaled.drawn();
            let mut large = rendered(&scene, camera, &scaled);
            let mut own = rendered(&scene, camera, &drawn);
            for _ in 0..3 {
                let (a, b) = (large.redraw(camera), own.redraw(camera));
                assert_eq!((a.width, a.height), size);
                assert_eq!(
                    (b.width, b.height),
                    (drawn.picture.width, drawn.picture.height)
                );
                // The mask is that of what is drawn, whatever size it is shown in.
                assert_eq!(a.shaded_samples, b.shaded_samples);
            }
            let expected = stretched(
                &picture(&own),
                (drawn.picture.width, drawn.picture.height),
                size,
            );
            let bytes = picture(&large);
            assert_eq!(bytes.len(), expected.len());
            let off = bytes.iter().zip(&expected);
            let off = off
                .map(|(&a, b)| (f32::from(a) - b).abs())
                .fold(0.0, f32::max);
            // Samplers weigh in steps of 1/256.
            assert!(off <= 2.0, "{size:?}, {scale}: {off}");
        }
    }

    #[test]
    fn each_eyes_picture_is_stretched_by_itself() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        for (output, width) in [(Output::SideBySide, 61), (Output::SideBySideHalf, 124)] {
            let scaled = small(width, 40).with(|s| {
                s.picture.render_scale = 0.5;
                s.stereo.mode = crate::Stereo::TwoPass;
                s.stereo.ipd_m = 0.8;
                s.stereo.output = output;
            });
            let drawn = scaled.drawn();
            let [large, own] = [&scaled, &drawn].map(|s| picture(&rendered(&scene, camera, s)));
            let (from, to) = (drawn.picture_size(), scaled.picture_size());
            let half = |bytes: &[u8], width: u32, eye: u32| -> Vec<u8> {
                let rows = bytes.chunks_exact(4 * width as usize);
                let half = 2 * width as usize;
                let at = half * eye as usize;
                rows.flat_map(|row| row[at..at + half].to_vec()).collect()
            };
            for eye in 0..2 {
                let [a, b] = [half(&large, to.0, eye), half(&own, from.0, eye)];
                let expected = stretched(&b, (from.0 / 2, from.1), (to.0 / 2, to.1));
                let off = a
                    .iter()
                    .zip(&expected)
                    .map(|(&a, b)| (f32::from(a) - b).abs());
                let off = off.fold(0.0, f32::max);
                assert!(off <= 2.0, "{output:?}, eye {eye}: {off}");
            }
        }
    }
}
