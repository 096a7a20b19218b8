//! The tiling of coarse shading made visible over the finished frame.

use super::PICTURE_FORMAT;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, drawn_over};
use crate::shader::Screen;
use crate::shading::CoarseTargets;
use crate::{DebugView, shader};

/// Draws levels, tile borders or samples over the picture.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl OverlayPass {
    /// `None` for views that do not show the tiling.
    pub(crate) fn new(
        gpu: &Gpu,
        view: DebugView,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        let number = match view {
            DebugView::Rate => 1,
            DebugView::Blocks => 2,
            DebugView::Shaded => 3,
            _ => return None,
        };
        let layout = bind_group_layout(
            gpu,
            "overlay",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Uint),
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
            ],
        );
        let module = shader::module(gpu, "overlay", shader::OUTPUT_OVERLAY);
        let pipeline = shader::screen(
            gpu,
            &Screen {
                groups: &[frame_layout, &layout],
                targets: &[Some(wgpu::ColorTargetState {
                    format: PICTURE_FORMAT,
                    blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::COLOR,
                })],
                constants: &[("VIEW", f64::from(number))],
                ..Screen::of_level("overlay", &module, "overlay")
            },
        );
        Some(Self { pipeline, layout })
    }

    /// Encodes the pass.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        tiles: &CoarseTargets,
        picture: &wgpu::TextureView,
    ) {
        let group = bind_group(
            &recorder.gpu.device,
            "overlay",
            &self.layout,
            &[&tiles.rate.owner.whole, &tiles.samples.whole]
                .map(wgpu::BindingResource::TextureView),
        );
        let mut pass = recorder.render_pass("overlay", &[drawn_over(picture)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

#[cfg(test)]
mod tests {
    use foveal_generate as generate;
    use glam::Vec3;

    use crate::shading::sample_texel;
    use crate::testing::{picture, rate_cells, rendered, small};
    use crate::{Composite, DebugView, RateSource, Settings, Shading};

    const SIZE: (u32, u32) = (101, 77);

    fn settings(view: DebugView) -> Settings {
        small(SIZE.0, SIZE.1).with(|s| {
            s.picture.view = view;
            s.shading.mode = Shading::Coarse;
            s.coarse.composite = Composite::Nearest;
            s.coarse.source = RateSource::Radii;
            s.coarse.fovea_inner = 0.1;
            s.coarse.fovea_outer = 0.8;
        })
    }

    /// `level_color` in `output/overlay.wgsl`.
    fn level_color(level: u32) -> Vec3 {
        if level == 0 {
            return Vec3::ONE;
        }
        let hue = 0.36 + level as f32 * 0.1;
        let wheel = |part: f32| ((hue + part / 3.0).fract() * 6.0 - 3.0).abs() - 1.0;
        Vec3::new(wheel(0.0), wheel(2.0), wheel(1.0)).clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// The colour over a texel, and how much of it.
    fn shown(view: DebugView, texel: [u32; 2], level: u32) -> (Vec3, f32) {
        let block = texel.map(|v| v >> level);
        let last = block.map(|v| ((v + 1) << level) - 1);
        match view {
            DebugView::Rate => (level_color(level), 0.6),
            DebugView::Blocks => {
                let is_border = level > 0 && (texel[0] == last[0] || texel[1] == last[1]);
                (level_color(level), if is_border { 0.7 } else { 0.0 })
            }
            _ => {
                let sampled = sample_texel(block.into(), level, 0, SIZE);
                let is_sampled = sampled == texel.into();
                (Vec3::ZERO, if is_sampled { 0.0 } else { 0.9 })
            }
        }
    }

    #[test]
    fn levels_borders_and_samples_are_shown_over_the_picture() {
        let scene = generate::cornell();
        let drawn = |view| rendered(&scene, &scene.cameras[0], &settings(view));
        let plain = picture(&drawn(DebugView::Final));
        for view in [DebugView::Rate, DebugView::Blocks, DebugView::Shaded] {
            let renderer = drawn(view);
            let rate = &renderer.targets().coarse.as_ref().expect("coarse").rate;
            let owners = rate_cells(&rate.owner, 1);
            let (mut levels, mut over) = ([0; 16], [0; 2]);
            let pairs =
                (plain.as_chunks::<4>().0.iter()).zip(picture(&renderer).as_chunks().0.to_vec());
            for (i, (below, found)) in (0..).zip(pairs) {
                let (x, y) = (i % SIZE.0, i / SIZE.0);
                let found: [u8; 4] = found;
                let level = owners[(y / 2 * SIZE.0.div_ceil(2) + x / 2) as usize] & 15;
                let (color, alpha) = shown(view, [x, y], level.into());
                levels[usize::from(level)] += 1;
                over[usize::from(alpha > 0.0)] += 1;
                for c in 0..3 {
                    let below = f32::from(below[c]) / 255.0;
                    let expected = 255.0 * (alpha * color[c] + (1.0 - alpha) * below);
                    let off = (f32::from(found[c]) - expected).abs();
                    assert!(off <= 2.0, "{view:?} at {x}, {y}: {found:?}, {expected}");
                }
            }
            let kinds = levels.iter().filter(|&&n| n > 0).count();
            assert!(kinds > 3 && over[1] > 100, "{view:?}: {levels:?} {over:?}");
        }
    }
}
