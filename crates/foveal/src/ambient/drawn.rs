//! The passes of ambient occlusion where no shader writes textures: the reduced renderer draws them.

use super::targets::{AmbientTargets, found_format, visibility_format};
use crate::geometry::GBuffer;
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, uniform};
use crate::recorder::{Recorder, overwritten};
use crate::shader::{self, Screen, Shader};

/// Looks around at every pixel, and joins what was found.
#[derive(Debug)]
pub(super) struct DrawnPasses {
    every: Pass,
    resolve: Pass,
}

#[derive(Debug)]
struct Pass {
    label: &'static str,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl Pass {
    fn new(
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        (label, shader, fragment): (&'static str, Shader, &str),
        types: &[wgpu::BindingType],
        target: wgpu::TextureFormat,
    ) -> Self {
        let layout = bind_group_layout(gpu, label, wgpu::ShaderStages::FRAGMENT, types);
        let module = shader::module(gpu, label, shader.variant(&["REDUCED"]));
        let pipeline = shader::screen(
            gpu,
            &Screen {
                groups: &[frame, &layout],
                targets: &[Some(target.into())],
                ..Screen::of(label, &module, fragment)
            },
        );
        Self {
            label,
            pipeline,
            layout,
        }
    }

    fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        frame: &wgpu::BindGroup,
        resources: &[wgpu::BindingResource<'_>],
        to: &wgpu::TextureView,
    ) {
        let group = bind_group(&recorder.gpu.device, self.label, &self.layout, resources);
        let target = [overwritten(to)];
        let mut pass = recorder.open_pass(self.label, &target, frame);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl DrawnPasses {
    pub(super) fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout) -> Self {
        let word = sampled(wgpu::TextureSampleType::Uint);
        let every = ("ambient occlusion", shader::AMBIENT_EVERY, "find_every");
        let resolve = ("ambient resolve", shader::AMBIENT_RESOLVE, "resolve");
        Self {
            every: Pass::new(gpu, frame, every, &[word, uniform()], found_format(gpu)),
            resolve: Pass::new(
                gpu,
                frame,
                resolve,
                &[word, uniform(), word],
                visibility_format(gpu),
            ),
        }
    }

    /// Encodes both; `frame`: the group without what is written.
    pub(super) fn find(
        &self,
        recorder: &mut Recorder<'_>,
        (uniform, gbuffer): (&wgpu::Buffer, &GBuffer),
        to: &AmbientTargets,
        frame: &wgpu::BindGroup,
    ) {
        let view = wgpu::BindingResource::TextureView;
        // The reduced G-buffer holds depth where others hold identity.
        let inputs = [
            view(&gbuffer.identity_view),
            uniform.as_entire_binding(),
            view(&to.found),
        ];
        self.every.draw(recorder, frame, &inputs[..2], &to.found);
        self.resolve.draw(recorder, frame, &inputs, &to.resolved);
    }
}
