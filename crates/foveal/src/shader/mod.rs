//! Shaders: composed from files that import each other (`compose.rs`), compiled, and made into pipelines.

mod compose;

pub(crate) use compose::*;

use crate::gpu::Gpu;

/// Compiles a shader.
pub(crate) fn module(gpu: &Gpu, label: &str, shader: Shader) -> wgpu::ShaderModule {
    gpu.device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(shader.source().into()),
        })
}

/// The layout of a pipeline whose bind groups are `groups` in order.
pub(crate) fn pipeline_layout(
    gpu: &Gpu,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|&g| Some(g)).collect();
    gpu.device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        })
}

/// A compute pipeline; `constants` sets the module's overrides.
pub(crate) fn compute(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    gpu.device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(gpu, label, groups)),
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                ..Default::default()
            },
            cache: None,
        })
}

/// A pipeline that draws one level of a mip chain (`shared/level.wgsl`).
#[expect(
    clippy::too_many_arguments,
    reason = "what a pipeline differs in, by name"
)]
pub(crate) fn level_screen(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    targets: &[Option<wgpu::ColorTargetState>],
    depth_stencil: Option<wgpu::DepthStencilState>,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let entry_points = ("level_screen", entry_point);
    screen(
        gpu,
        label,
        module,
        entry_points,
        wgpu::PrimitiveTopology::TriangleList,
        groups,
        targets,
        depth_stencil,
        constants,
    )
}

/// A pipeline that draws one full-screen triangle into one target.
pub(crate) fn full_screen(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    target: wgpu::TextureFormat,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let entry_points = ("full_screen", entry_point);
    let targets = [Some(target.into())];
    screen(
        gpu,
        label,
        module,
        entry_points,
        wgpu::PrimitiveTopology::TriangleList,
        groups,
        &targets,
        None,
        constants,
    )
}

/// A pipeline of any vertex and fragment entry points, without vertex buffers.
#[expect(
    clippy::too_many_arguments,
    reason = "what a pipeline differs in, by name"
)]
pub(crate) fn screen(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    (vertex, fragment): (&str, &str),
    topology: wgpu::PrimitiveTopology,
    groups: &[&wgpu::BindGroupLayout],
    targets: &[Option<wgpu::ColorTargetState>],
    depth_stencil: Option<wgpu::DepthStencilState>,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants,
        ..Default::default()
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(gpu, label, groups)),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                topology,
                ..Default::default()
            },
            depth_stencil,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options,
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
}

#[cfg(test)]
mod tests;
