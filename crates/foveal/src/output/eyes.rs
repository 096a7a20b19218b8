//! Presentation of two eyes' pictures: one of them, side by side, as an anaglyph, or against a
//! headset's lenses.

use bytemuck::{Pod, Zeroable};

use super::PICTURE_FORMAT;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, uniform};
use crate::recorder::{Recorder, overwritten};
use crate::stereo::LensFit;
use crate::targets::Targets;
use crate::{Output, Settings, shader};

/// Mirrors `Shown` in `output/eyes.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ShownUniform {
    pub(crate) screen: [[f32; 4]; 2],
    pub(crate) distortion: [f32; 4],
    pub(crate) fringe: [f32; 4],
}

impl ShownUniform {
    pub(crate) fn new(lenses: &[LensFit; 2]) -> Self {
        let lens = lenses[0].lens;
        let [k1, k2, k3] = lens.distortion;
        Self {
            screen: lenses.map(|fit| fit.screen),
            distortion: [k1, k2, k3, 0.0],
            fringe: [lens.red[0], lens.red[1], lens.blue[0], lens.blue[1]],
        }
    }
}

/// Makes the shown picture from the eyes' ones.
#[derive(Debug)]
pub(crate) struct EyesPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
}

impl EyesPass {
    /// `None` with one eye, whose picture is shown as it is.
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
    ) -> Option<Self> {
        if !settings.is_stereo() {
            return None;
        }
        let number = match settings.stereo.output {
            Output::Flat => 0,
            Output::SideBySide => 1,
            Output::SideBySideHalf => 2,
            Output::Anaglyph => 3,
            Output::AnaglyphDubois => 4,
            Output::Headset => 5,
        };
        let layout = bind_group_layout(
            gpu,
            "eyes",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Float { filterable: false }),
                uniform(),
            ],
        );
        Some(Self {
            pipeline: shader::full_screen(
                gpu,
                "eyes",
                &shader::module(gpu, "eyes", shader::OUTPUT_EYES),
                "show_eyes",
                &[frame_layout, &layout],
                PICTURE_FORMAT,
                &[("OUTPUT", f64::from(number))],
            ),
            layout,
            uniform: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("eyes"),
                size: size_of::<ShownUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        })
    }

    /// Encodes the pass.
    pub(crate) fn show(
        &self,
        recorder: &mut Recorder<'_>,
        lenses: Option<&[LensFit; 2]>,
        targets: &Targets,
    ) {
        let Some(shown) = &targets.shown_view else {
            return;
        };
        let gpu = recorder.gpu;
        if let Some(lenses) = lenses {
            let uniform = ShownUniform::new(lenses);
            gpu.queue
                .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        }
        let group = bind_group(
            &gpu.device,
            "eyes",
            &self.layout,
            &[
                wgpu::BindingResource::TextureView(&targets.picture_view),
                self.uniform.as_entire_binding(),
            ],
        );
        let mut pass = recorder.render_pass("eyes", &[overwritten(shown)], None);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
