//! The stencil backend: per level one draw that marks the tiles, and one that shades where it is
//! marked.
//!
//! The source writes levels through stencil export, which few devices have. Here the marking shader
//! discards what is no tile and the stencil operation does the writing; the shading draw is then
//! rejected before its shader runs wherever the test fails.

use super::{CoarseTargets, STENCIL_FORMAT, by_size};
use crate::composite::LIGHT_FORMAT;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shader::Screen;
use crate::shading::RADIANCE_FORMAT;
use crate::{Composite, Settings, shader};

/// Shades tiles by draws behind a stencil test.
#[derive(Debug)]
pub(crate) struct StencilBackend {
    mark: wgpu::RenderPipeline,
    /// Of larger blocks, and of single pixels.
    shade: [wgpu::RenderPipeline; 2],
    cells_layout: wgpu::BindGroupLayout,
}

/// Stencil as its only test and its only effect, on both faces.
pub(crate) fn stencil_state(
    compare: wgpu::CompareFunction,
    pass_op: wgpu::StencilOperation,
) -> wgpu::DepthStencilState {
    let face = wgpu::StencilFaceState {
        compare,
        pass_op,
        ..Default::default()
    };
    wgpu::DepthStencilState {
        format: STENCIL_FORMAT,
        depth_write_enabled: None,
        depth_compare: None,
        stencil: wgpu::StencilState {
            front: face,
            back: face,
            read_mask: 0xff,
            // What only tests must not look as if it wrote: drivers then test before they shade.
            write_mask: if pass_op == wgpu::StencilOperation::Keep {
                0
            } else {
                0xff
            },
        },
        bias: wgpu::DepthBiasState::default(),
    }
}

impl StencilBackend {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        input_layout: &wgpu::BindGroupLayout,
        shader: shader::Shader,
    ) -> Self {
        let cells_layout = bind_group_layout(
            gpu,
            "tile marks",
            wgpu::ShaderStages::FRAGMENT,
            &[sampled(wgpu::TextureSampleType::Uint)],
        );
        let formats: &[_] = if settings.coarse.composite == Composite::Light {
            &[RADIANCE_FORMAT, LIGHT_FORMAT]
        } else {
            &[RADIANCE_FORMAT]
        };
        let targets = |write_mask| -> Vec<_> {
            let target = |&format| {
                Some(wgpu::ColorTargetState {
                    format,
                    blend: None,
                    write_mask,
                })
            };
            formats.iter().map(target).collect()
        };
        let marks = shader::module(gpu, "tile marks", shader::SHADING_COARSE_MARK);
        let mark = shader::screen(
            gpu,
            &Screen {
                groups: &[frame_layout, &cells_layout],
                // The pass has colour targets; the marking leaves them alone.
                targets: &targets(wgpu::ColorWrites::empty()),
                depth_stencil: Some(stencil_state(
                    wgpu::CompareFunction::Always,
                    wgpu::StencilOperation::Replace,
                )),
                constants: &[("COARSEST", f64::from(settings.coarse.coarsest_level))],
                ..Screen::of_level("tile marks", &marks, "mark")
            },
        );
        let blocks = shader::module(gpu, "coarse shading, draw", shader);
        let shade = by_size(settings, |constants| {
            let screen = Screen {
                groups: &[frame_layout, input_layout],
                targets: &targets(wgpu::ColorWrites::ALL),
                depth_stencil: Some(stencil_state(
                    wgpu::CompareFunction::Equal,
                    wgpu::StencilOperation::Keep,
                )),
                constants,
                ..Screen::of_level("coarse shading", &blocks, "shade_blocks")
            };
            shader::screen(gpu, &screen)
        });
        Self {
            mark,
            shade,
            cells_layout,
        }
    }

    /// Encodes one pass per level.
    pub(super) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &CoarseTargets,
    ) {
        let gpu = recorder.gpu;
        let Some(stencil) = &target.stencil else {
            return;
        };
        let cells = bind_group(
            &gpu.device,
            "tile marks",
            &self.cells_layout,
            &[wgpu::BindingResource::TextureView(
                &target.rate.pyramid.whole,
            )],
        );
        for level in target.samples.range() {
            let light = target.light.as_ref();
            let colors: Vec<_> = std::iter::once(&target.samples)
                .chain(light.map(|light| &light.samples))
                .map(|chain| overwritten(chain.level(level)))
                .collect();
            let marks = wgpu::RenderPassDepthStencilAttachment {
                view: stencil.level(level),
                depth_ops: None,
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Discard,
                }),
            };
            let mut pass = recorder.render_pass("shading", &colors, Some(marks));
            pass.set_stencil_reference(1);
            pass.set_pipeline(&self.mark);
            pass.set_bind_group(1, &cells, &[]);
            target.samples.draw(&mut pass, level);
            pass.set_pipeline(&self.shade[usize::from(level == 0)]);
            pass.set_bind_group(1, input, &[]);
            target.samples.draw(&mut pass, level);
        }
    }
}
