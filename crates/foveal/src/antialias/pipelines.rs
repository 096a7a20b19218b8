//! The pipelines of anti-aliasing.

use crate::environment::environment_constants;
use crate::geometry::{DEPTH_FORMAT, IDENTITY_FORMAT, SURFACE_FORMAT};
use crate::gpu::{Gpu, bind_group_layout, sampled, storage_read, storage_write, uniform};
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::{Antialiasing, EdgeTest, Settings, shader};

use super::choice::averages_all;
use super::pattern::Pattern;
use super::targets::TALLY_FORMAT;

/// Which pixels are shaded more than once; the numbers are those of `merge.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edges {
    None = 0,
    All = 1,
    ByDepth = 2,
    BySurface = 3,
}

impl Edges {
    pub(super) fn of(settings: &Settings) -> Self {
        match (settings.antialiasing.mode, settings.antialiasing.edge_test) {
            (Antialiasing::Ssaa, _) => Self::All,
            (_, EdgeTest::Surface) => Self::BySurface,
            (_, EdgeTest::Paper) => Self::ByDepth,
            (_, EdgeTest::Never) => Self::None,
        }
    }

    /// All sub-samples of an edge pixel are shaded, whatever they see.
    pub(super) fn shade_all(self) -> bool {
        self != Self::BySurface
    }
}

/// Pipelines and the layouts of their bind groups.
#[derive(Debug)]
pub(super) struct AntialiasPipelines {
    pub(super) merge: wgpu::RenderPipeline,
    pub(super) merge_layout: wgpu::BindGroupLayout,
    pub(super) shade: wgpu::ComputePipeline,
    pub(super) shade_layout: wgpu::BindGroupLayout,
    pub(super) combine: wgpu::ComputePipeline,
    pub(super) combine_layout: wgpu::BindGroupLayout,
    pub(super) store: wgpu::ComputePipeline,
    pub(super) store_layout: wgpu::BindGroupLayout,
}

impl AntialiasPipelines {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame: &wgpu::BindGroupLayout,
        shading_input: &wgpu::BindGroupLayout,
    ) -> Self {
        let edges = Edges::of(settings);
        let all = f64::from(u8::from(edges.shade_all()));
        let [count, side] = Pattern::of(settings).constants();
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let layout = |label, stages, types: &[_]| bind_group_layout(gpu, label, stages, types);
        let compute = wgpu::ShaderStages::COMPUTE;
        let fragment = wgpu::ShaderStages::FRAGMENT;

        let (read, write) = (storage_read(), storage_write());
        let merge_layout = layout("merge", fragment, &[uniform(), uint, write, write]);
        let shade_layout = layout(
            "edge shading",
            compute,
            &[uniform(), uint, read, read, write],
        );
        let combine_layout = layout(
            "combination",
            compute,
            &[read, read, write, float, uint, write],
        );
        let coarse = f64::from(u8::from(!averages_all(settings)));
        let radiance = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: RADIANCE_FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let store_layout = layout(
            "combination, store",
            compute,
            &[read, read, write, radiance],
        );
        let combination = shader::module(gpu, "combination", shader::ANTIALIAS_COMBINE);

        let lighting = lighting_constants(settings);
        // Views of the G-buffer show averages.
        let mirror = (
            "MIRROR",
            f64::from(u8::from(settings.picture.view.is_lit())),
        );
        Self {
            merge: merge(
                gpu,
                &[frame, shading_input, &merge_layout],
                &[
                    &environment_constants(settings)[..],
                    &[count, side, mirror, ("EDGES", f64::from(edges as u8))],
                ]
                .concat(),
            ),
            shade: shader::compute(
                gpu,
                "edge shading",
                &shader::module(gpu, "edge shading", shader::ANTIALIAS_SHADE),
                "shade_entries",
                &[frame, shading_input, &shade_layout],
                &[&lighting[..], &[count, side, mirror, ("ALL", all)]].concat(),
            ),
            combine: shader::compute(
                gpu,
                "combination",
                &combination,
                "combine",
                &[frame, &combine_layout],
                &[count, ("ALL", all), ("COARSE", coarse)],
            ),
            store: shader::compute(
                gpu,
                "combination, store",
                &shader::module(gpu, "combination, store", shader::ANTIALIAS_STORE),
                "store",
                &[frame, &store_layout],
                &[],
            ),
            merge_layout,
            shade_layout,
            combine_layout,
            store_layout,
        }
    }
}

fn merge(
    gpu: &Gpu,
    groups: &[&wgpu::BindGroupLayout],
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let module = shader::module(gpu, "merge", shader::ANTIALIAS_MERGE);
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants,
        ..Default::default()
    };
    let targets = [SURFACE_FORMAT, IDENTITY_FORMAT, TALLY_FORMAT].map(|f| Some(f.into()));
    gpu.render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("merge"),
        layout: Some(&gpu.pipeline_layout("merge", groups)),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("full_screen"),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("merge"),
            compilation_options,
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
