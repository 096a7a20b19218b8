//! Shaders: composed from files that import each other (`compose.rs`), compiled, and made into
//! pipelines.

mod compose;

pub(crate) use compose::*;

use crate::gpu::Gpu;

/// A shader's module.
pub(crate) fn module(gpu: &Gpu, label: &str, shader: Shader) -> wgpu::ShaderModule {
    gpu.module(label, shader.name(), || {
        shader.source(gpu.has_texture_tables())
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
    gpu.compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&gpu.pipeline_layout(label, groups)),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants,
            ..Default::default()
        },
        cache: None,
    })
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
    screen(
        gpu,
        &Screen {
            groups,
            targets: &[Some(target.into())],
            constants,
            ..Screen::of(label, module, entry_point)
        },
    )
}

/// A render pipeline without vertex buffers.
#[derive(Clone)]
pub(crate) struct Screen<'a> {
    pub(crate) label: &'a str,
    pub(crate) module: &'a wgpu::ShaderModule,
    pub(crate) vertex: &'a str,
    pub(crate) fragment: &'a str,
    pub(crate) topology: wgpu::PrimitiveTopology,
    pub(crate) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) depth_stencil: Option<wgpu::DepthStencilState>,
    pub(crate) constants: &'a [(&'a str, f64)],
}

impl<'a> Screen<'a> {
    /// A full-screen triangle (`shared/full_screen.wgsl`) that binds nothing and draws to nothing.
    pub(crate) fn of(label: &'a str, module: &'a wgpu::ShaderModule, fragment: &'a str) -> Self {
        Self {
            label,
            module,
            vertex: "full_screen",
            fragment,
            topology: wgpu::PrimitiveTopology::TriangleList,
            groups: &[],
            targets: &[],
            depth_stencil: None,
            constants: &[],
        }
    }

    /// The same for one level of a mip chain (`shared/level.wgsl`).
    pub(crate) fn of_level(
        label: &'a str,
        module: &'a wgpu::ShaderModule,
        fragment: &'a str,
    ) -> Self {
        Self {
            vertex: "level_screen",
            ..Self::of(label, module, fragment)
        }
    }
}

/// Makes a render pipeline without vertex buffers.
pub(crate) fn screen(gpu: &Gpu, recipe: &Screen<'_>) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants: recipe.constants,
        ..Default::default()
    };
    gpu.render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(&gpu.pipeline_layout(recipe.label, recipe.groups)),
        vertex: wgpu::VertexState {
            module: recipe.module,
            entry_point: Some(recipe.vertex),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: recipe.topology,
            ..Default::default()
        },
        depth_stencil: recipe.depth_stencil.clone(),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: recipe.module,
            entry_point: Some(recipe.fragment),
            compilation_options,
            targets: recipe.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests;
