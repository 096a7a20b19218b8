//! The pass that draws tiles.

use bytemuck::{Pod, Zeroable};

use super::atlas::Tile;
use super::patch::Patch;
use super::volume::Volume;
use crate::geometry::{
    DrawList, Faces, PipelineKey, PipelineRecipe, Pipelines, Shape, VertexSource,
};
use crate::gpu::{Gpu, Table, bind_group, bind_group_layout};
use crate::recorder::Recorder;
use crate::scene::{LobeClass, SceneOnGpu};
use crate::shader::{self, Screen};
use crate::stereo::Drawn;

/// Bits of a material's class that decide where it has holes: `shared/material.wgsl`.
const HAS_BASE_COLOR: u32 = 1;
const HAS_UV_MAP: u32 = 128;

/// A tile to draw, and what it shows.
#[derive(Clone, Debug)]
pub(super) struct TileDraw {
    tile: Tile,
    clip_from_world: glam::Mat4,
    pub(super) casters: DrawList,
    /// What is emptied before, and drawn alone; `None` where the casters are added to all that the
    /// tile holds.
    pub(super) emptied: Option<Patch>,
}

impl TileDraw {
    /// Draws these instances.
    pub(super) fn new(
        scene: &SceneOnGpu,
        (tile, volume): (Tile, &Volume),
        casters: Vec<u32>,
        emptied: Option<Patch>,
    ) -> Self {
        Self {
            tile,
            clip_from_world: volume.clip_from_world(tile.side() as f32),
            casters: DrawList::of_casters(scene, casters.into_iter(), CasterPass::key),
            emptied,
        }
    }
}

/// Mirrors `TileView` in `shadow/caster.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TileUniform {
    pub(crate) clip_from_world: [[f32; 4]; 4],
}

/// Draws depth into tiles of the atlas.
#[derive(Debug)]
pub(super) struct CasterPass {
    casters: Pipelines,
    clear: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Which instance each drawn one is, for all tiles of the frame.
    drawn: Table,
}

impl CasterPass {
    pub(super) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let layout = bind_group_layout(
            gpu,
            "shadow tile",
            wgpu::ShaderStages::VERTEX,
            &[wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: wgpu::BufferSize::new(size_of::<TileUniform>() as u64),
            }],
        );
        let casters = Pipelines::new(PipelineRecipe {
            label: "shadow casters",
            module: shader::module(gpu, "shadow casters", shader::SHADOW_CASTER),
            layout: gpu
                .pipeline_layout("shadow casters", &[frame_layout, material_layout, &layout]),
            vertex: VertexSource::Buffers("vertex_of_caster"),
            fragment: "cast_shadow",
            targets: Vec::new(),
            writes_depth: true,
            depth_compare: wgpu::CompareFunction::Greater,
            constants: Vec::new(),
            has_mask: true,
            multiview_mask: None,
        });
        let clear = shader::module(gpu, "shadow tiles, empty", shader::SHADOW_CLEAR);
        let clear = shader::screen(
            gpu,
            &Screen {
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: crate::formats::DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Always),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                ..Screen::of("shadow tiles, empty", &clear, "clear")
            },
        );
        Self {
            casters,
            clear,
            layout,
            drawn: Table::new(gpu, "drawn casters"),
        }
    }

    /// The pipeline of what casts a shadow, whichever side of it the light sees; of a material only
    /// what cuts holes matters.
    fn key(class: u32, masked: bool) -> PipelineKey {
        PipelineKey {
            class: if masked {
                class & (HAS_BASE_COLOR | HAS_UV_MAP)
            } else {
                0
            },
            masked,
            mirrored: false,
            faces: Faces::Both,
            lobes: LobeClass::default(),
            shape: Shape::Triangles,
        }
    }

    /// Encodes the drawing of tiles.
    pub(super) fn draw(
        &mut self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        atlas: &wgpu::TextureView,
        draws: &[TileDraw],
    ) {
        if draws.is_empty() {
            return;
        }
        let gpu = recorder.gpu;
        for batch in draws.iter().flat_map(|draw| &draw.casters.solid) {
            self.casters.prepare(gpu, batch.key);
        }
        let instances: Vec<u32> = draws
            .iter()
            .flat_map(|draw| draw.casters.drawn.iter().copied())
            .collect();
        self.drawn.write(gpu, bytemuck::cast_slice(&instances));
        let frame = recorder.frame.group_of(gpu, &self.drawn);
        let (views, stride) = self.views(gpu, draws);
        let mut pass = recorder.render_pass(
            "shadows",
            &[],
            Some(wgpu::RenderPassDepthStencilAttachment {
                view: atlas,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
        );
        let mut first = 0;
        for (number, draw) in (0..).zip(draws) {
            let Tile { x, y, .. } = draw.tile;
            let side = draw.tile.side();
            pass.set_viewport(x as f32, y as f32, side as f32, side as f32, 0.0, 1.0);
            let Patch { low, high } = draw.emptied.unwrap_or(Patch::whole(side));
            let [width, height] = [0, 1].map(|i| high[i] - low[i]);
            pass.set_scissor_rect(x + low[0], y + low[1], width, height);
            if draw.emptied.is_some() {
                pass.set_pipeline(&self.clear);
                pass.draw(0..3, 0..1);
            }
            pass.set_bind_group(0, &frame, &[]);
            pass.set_bind_group(2, &views, &[number * stride]);
            scene.geometry.bind(&mut pass);
            let batches = draw
                .casters
                .solid
                .iter()
                .map(|batch| crate::geometry::Batch {
                    first: batch.first + first,
                    ..*batch
                });
            let batches: Vec<_> = batches.collect();
            DrawList::issue(&batches, &mut pass, scene, &self.casters, Drawn::Once);
            first += draw.casters.drawn.len() as u32;
        }
    }

    /// The tiles' matrices, and the distance in bytes from one to the next.
    fn views(&self, gpu: &Gpu, draws: &[TileDraw]) -> (wgpu::BindGroup, u32) {
        let stride = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let stride = stride.max(size_of::<TileUniform>() as u32);
        let mut bytes = vec![0; stride as usize * draws.len()];
        for (draw, to) in draws.iter().zip(bytes.chunks_mut(stride as usize)) {
            let uniform = TileUniform {
                clip_from_world: draw.clip_from_world.to_cols_array_2d(),
            };
            to[..size_of::<TileUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow tiles"),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&buffer, 0, &bytes);
        let view = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &buffer,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<TileUniform>() as u64),
        });
        let group = bind_group(&gpu.device, "shadow tiles", &self.layout, &[view]);
        (group, stride)
    }
}
