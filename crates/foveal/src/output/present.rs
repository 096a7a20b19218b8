//! The picture into a texture of the host's.

use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shader;

/// Draws the picture into targets of any size and of any format that can be drawn to.
#[derive(Debug)]
pub(crate) struct PresentPass {
    layout: wgpu::BindGroupLayout,
    bilinear: wgpu::Sampler,
    /// For the format of the last target, and the pictures side by side.
    pipeline: Option<((wgpu::TextureFormat, usize), wgpu::RenderPipeline)>,
}

impl PresentPass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = bind_group_layout(
            gpu,
            "present",
            wgpu::ShaderStages::FRAGMENT,
            &[
                sampled(wgpu::TextureSampleType::Float { filterable: true }),
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            ],
        );
        let bilinear = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("present"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            layout,
            bilinear,
            pipeline: None,
        }
    }

    /// Encodes the pass. `pictures`: side by side, each stretched by itself.
    pub(crate) fn present(
        &mut self,
        recorder: &mut Recorder<'_>,
        picture: &wgpu::TextureView,
        target: Target<'_>,
        pictures: usize,
    ) {
        let gpu = recorder.gpu;
        let format = target.format;
        let key = (format, pictures);
        if self.pipeline.as_ref().is_none_or(|(k, _)| *k != key) {
            let pipeline = shader::full_screen(
                gpu,
                "present",
                &shader::module(gpu, "present", shader::OUTPUT_PRESENT),
                "present",
                &[recorder.frame.layout(), &self.layout],
                format,
                &[
                    ("ENCODED_BY_TARGET", f64::from(u8::from(format.is_srgb()))),
                    ("PICTURES", pictures as f64),
                ],
            );
            self.pipeline = Some((key, pipeline));
        }
        let Some((_, pipeline)) = &self.pipeline else {
            return;
        };
        let group = bind_group(
            &gpu.device,
            "present",
            &self.layout,
            &[
                wgpu::BindingResource::TextureView(picture),
                wgpu::BindingResource::Sampler(&self.bilinear),
            ],
        );
        let mut pass = recorder.render_pass("present", &[overwritten(target.view)], None);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A texture of the host's, drawn to with the format of the view: an sRGB one encodes by itself,
/// into any other the renderer writes sRGB values.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// One layer of one mip of a texture with [`wgpu::TextureUsages::RENDER_ATTACHMENT`], of the
    /// renderer's own device: wgpu panics where it gets a view of another instance.
    pub view: &'a wgpu::TextureView,
    /// The format of the view.
    pub format: wgpu::TextureFormat,
}
