//! The few pipelines that a geometry or forward pass needs, made when first asked for.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use crate::gpu::Gpu;
use crate::scene::{LobeClass, VERTEX_LAYOUTS};

/// Which sides of a triangle are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Faces {
    Front,
    Back,
    Both,
}

/// What a draw is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    #[default]
    Triangles,
    /// Points and lines of which some have normals.
    LitStrokes,
    /// Points and lines without.
    UnlitStrokes,
}

/// What makes one pipeline of a pass differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PipelineKey {
    /// What the material has: `MATERIAL_CLASS` in `shared/material.wgsl`.
    pub(crate) class: u32,
    /// Alpha cuts holes.
    pub(crate) masked: bool,
    /// The instance's transform turns the winding around.
    pub(crate) mirrored: bool,
    pub(crate) faces: Faces,
    /// Lobes that are shaded besides; none in the G-buffer.
    pub(crate) lobes: LobeClass,
    /// Triangles everywhere but in the forward pass.
    pub(crate) shape: Shape,
}

/// Where vertices come from, with the vertex shader's entry point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum VertexSource {
    /// The device fetches them.
    Buffers(&'static str),
    /// The shader fetches them.
    Shader(&'static str),
}

/// What all pipelines of a pass share.
#[derive(Debug)]
pub(crate) struct PipelineRecipe {
    pub(crate) label: &'static str,
    pub(crate) module: wgpu::ShaderModule,
    pub(crate) layout: wgpu::PipelineLayout,
    pub(crate) vertex: VertexSource,
    /// Entry point of the fragment shader.
    pub(crate) fragment: &'static str,
    pub(crate) targets: Vec<Option<wgpu::ColorTargetState>>,
    pub(crate) writes_depth: bool,
    /// Of a fragment's depth and the one that is there, which is reversed.
    pub(crate) depth_compare: wgpu::CompareFunction,
    pub(crate) constants: Vec<(&'static str, f64)>,
    /// The shader has the override `MASKED`.
    pub(crate) has_mask: bool,
    /// The layers that a pass draws to at once.
    pub(crate) multiview_mask: Option<NonZeroU32>,
}

/// A pass's pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    recipe: PipelineRecipe,
    made: BTreeMap<PipelineKey, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub(crate) fn new(recipe: PipelineRecipe) -> Self {
        Self {
            recipe,
            made: BTreeMap::new(),
        }
    }

    /// Makes the pipeline for `key` unless it is there.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, key: PipelineKey) {
        let recipe = &self.recipe;
        self.made
            .entry(key)
            .or_insert_with(|| make(gpu, recipe, key));
    }

    /// The pipeline for a key that was prepared.
    pub(crate) fn get(&self, key: PipelineKey) -> &wgpu::RenderPipeline {
        &self.made[&key]
    }
}

fn make(gpu: &Gpu, recipe: &PipelineRecipe, key: PipelineKey) -> wgpu::RenderPipeline {
    let mut constants = recipe.constants.clone();
    let class = key.class | key.lobes.flags;
    constants.push(("MATERIAL_CLASS", f64::from(class)));
    if key.lobes.flags != 0 {
        constants.push(("LOBE_TEXTURES", f64::from(key.lobes.textures)));
    }
    if key.shape != Shape::Triangles {
        let lit = key.shape == Shape::LitStrokes;
        constants.push(("LIT", f64::from(u8::from(lit))));
    }
    if recipe.has_mask {
        constants.push(("MASKED", f64::from(u8::from(key.masked))));
    }
    let (vertex, buffers) = match recipe.vertex {
        VertexSource::Buffers(entry) => (entry, &VERTEX_LAYOUTS[..]),
        VertexSource::Shader(entry) => (entry, &[][..]),
    };
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants: &constants,
        ..Default::default()
    };
    gpu.render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(&recipe.layout),
        vertex: wgpu::VertexState {
            module: &recipe.module,
            entry_point: Some(vertex),
            compilation_options: compilation_options.clone(),
            buffers,
        },
        primitive: wgpu::PrimitiveState {
            front_face: if key.mirrored {
                wgpu::FrontFace::Cw
            } else {
                wgpu::FrontFace::Ccw
            },
            cull_mode: match key.faces {
                Faces::Front => Some(wgpu::Face::Back),
                Faces::Back => Some(wgpu::Face::Front),
                Faces::Both => None,
            },
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: crate::formats::DEPTH_FORMAT,
            depth_write_enabled: Some(recipe.writes_depth),
            depth_compare: Some(recipe.depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &recipe.module,
            entry_point: Some(recipe.fragment),
            compilation_options,
            targets: &recipe.targets,
        }),
        multiview_mask: recipe.multiview_mask,
        cache: None,
    })
}
