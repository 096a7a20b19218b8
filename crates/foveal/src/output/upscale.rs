//! A picture that is larger than what was drawn for it.

use super::{PICTURE_FORMAT, PresentPass};
use crate::gpu::{Gpu, target};
use crate::recorder::Recorder;
use crate::{Settings, Target};

/// Stretches what was drawn, bilinearly, to the size that the settings ask for.
#[derive(Debug)]
pub(crate) struct Upscale {
    pass: PresentPass,
    picture_view: wgpu::TextureView,
}

impl Upscale {
    /// `None` where the frame is drawn at its size.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        let size = settings.picture_size();
        let none = wgpu::TextureUsages::empty();
        (settings.drawn().picture_size() != size).then(|| Self {
            pass: PresentPass::new(gpu),
            picture_view: target(gpu, "upscaled picture", size, PICTURE_FORMAT, none),
        })
    }

    /// Encodes the pass. `pictures`: side by side in what is drawn, each stretched by itself.
    pub(crate) fn stretch(
        &mut self,
        recorder: &mut Recorder<'_>,
        drawn: &wgpu::TextureView,
        pictures: usize,
    ) {
        let target = Target {
            view: &self.picture_view,
            format: PICTURE_FORMAT,
        };
        self.pass.present(recorder, drawn, target, pictures);
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

    use super::*;
    use crate::testing::{gpu, picture, rendered, small, texels};
    use crate::{Frame, Geometry, Output, RateSource, Shading};

    /// Pictures' widths and heights: of what is stretched and of what it becomes, each with what
    /// lies beside it.
    type Sizes = [(u32, u32); 2];

    /// A picture of `has`'s size, stretched as a sampler does that clamps to the border.
    fn stretched(bytes: &[u8], has: (u32, u32), to: (u32, u32), [from, into]: Sizes) -> Vec<f32> {
        let along = |i: u32, texels: u32, (from, into): (u32, u32)| {
            let at = (i as f32 + 0.5) * from as f32 / into as f32 - 0.5;
            let low = at.floor();
            let clamped = |texel: f32| texel.clamp(0.0, texels as f32 - 1.0) as u32;
            (clamped(low), clamped(low + 1.0), at - low)
        };
        let mut out = Vec::new();
        for y in 0..to.1 {
            let (y0, y1, fy) = along(y, has.1, (from.1, into.1));
            for x in 0..to.0 {
                let (x0, x1, fx) = along(x, has.0, (from.0, into.0));
                for c in 0..4 {
                    let at = |x: u32, y: u32| f32::from(bytes[((y * has.0 + x) * 4 + c) as usize]);
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
            let from = (drawn.picture.width, drawn.picture.height);
            let expected = stretched(&picture(&own), from, size, [from, size]);
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

    /// Both eyes side by side, half as large as they are shown.
    fn beside(output: Output, width: u32) -> Settings {
        small(width, 40).with(|s| {
            s.picture.render_scale = 0.5;
            s.stereo.mode = crate::Stereo::TwoPass;
            s.stereo.ipd_m = 0.8;
            s.stereo.output = output;
        })
    }

    /// Columns of a picture of two eyes that show one of them.
    fn columns(width: u32, eye: u32) -> std::ops::Range<u32> {
        let first = width.div_ceil(2);
        [0..first, first..width][eye as usize].clone()
    }

    #[test]
    fn each_eyes_picture_is_stretched_by_itself() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        let half = [124, 125, 126, 127].map(|width| (Output::SideBySideHalf, width));
        for (output, width) in [(Output::SideBySide, 61)].into_iter().chain(half) {
            let scaled = beside(output, width);
            let drawn = scaled.drawn();
            let [large, own] = [&scaled, &drawn].map(|s| picture(&rendered(&scene, camera, s)));
            let sizes = [drawn.picture_size(), scaled.picture_size()];
            for eye in 0..2 {
                let [from, to] = sizes.map(|(width, _)| columns(width, eye));
                let cut = |bytes: &[u8], (width, _): (u32, u32), of: &std::ops::Range<u32>| {
                    let of = 4 * of.start as usize..4 * of.end as usize;
                    let rows = bytes.chunks_exact(4 * width as usize);
                    rows.flat_map(|row| row[of.clone()].to_vec())
                        .collect::<Vec<u8>>()
                };
                let [shown, seen] = [cut(&large, sizes[1], &to), cut(&own, sizes[0], &from)];
                let [has, to] = [(from, 0), (to, 1)].map(|(of, i)| (of.len() as u32, sizes[i].1));
                let expected = stretched(&seen, has, to, sizes);
                let off = (shown.iter().zip(&expected)).map(|(&a, b)| (f32::from(a) - b).abs());
                let off = off.fold(0.0, f32::max);
                assert!(off <= 2.0, "{output:?} of {width}, eye {eye}: {off}");
            }
        }
    }

    #[test]
    fn an_odd_picture_of_both_eyes_is_presented_as_it_is() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        let settings = beside(Output::SideBySideHalf, 61).with(|s| s.picture.render_scale = 1.0);
        let mut renderer = rendered(&scene, camera, &settings);
        let (size, usage) = ((61, 40), wgpu::TextureUsages::COPY_SRC);
        let view = target(gpu(), "shown", size, PICTURE_FORMAT, usage);
        let shown = Target {
            view: &view,
            format: PICTURE_FORMAT,
        };
        let frame = Frame::new(camera);
        pollster::block_on(renderer.render_to(&frame, shown)).expect("the frame is drawn");
        let (shown, picture) = (texels::<[u8; 4]>(&view), picture(&renderer));
        let mut pairs = shown.as_flattened().iter().zip(&picture);
        // Samplers weigh in steps of 1/256.
        assert!(pairs.all(|(a, b)| a.abs_diff(*b) <= 1));
    }

    #[test]
    fn a_stretched_picture_follows_the_output() {
        let scene = generate::cornell();
        let camera = &scene.cameras[0];
        let both = [Output::SideBySideHalf, Output::Flat].map(|output| beside(output, 124));
        let alone = beside(Output::Flat, 124).with(|s| s.stereo.mode = crate::Stereo::Off);
        for [before, now] in [
            [&both[0], &both[1]],
            [&both[1], &both[0]],
            [&both[0], &alone],
        ] {
            let mut renderer = rendered(&scene, camera, before);
            pollster::block_on(renderer.set_settings(now)).expect("settings fit");
            renderer.redraw(camera);
            let fresh = rendered(&scene, camera, now);
            let output = now.stereo.output;
            assert!(picture(&renderer) == picture(&fresh), "{output:?}");
        }
    }
}
