//! The pass that evaluates materials at the pixels that show them.

use std::collections::BTreeMap;

use bytemuck::{Pod, Zeroable};

use super::{Listed, Rates, ResolveAt, VisibilityTargets, with_mask};
use crate::geometry::{Draws, FaceNormals, GBuffer, SURFACE_FORMAT, Window};
use crate::gpu::{
    Gpu, bind_group, bind_group_layout, sampled, sampled_layers, storage_read, uniform,
    written_layers,
};

use crate::recorder::Recorder;
use crate::scene::{FAMILY_BYTES, MaterialDispatch};
use crate::shader;

/// Most windows that a frame is drawn into at once.
const MOST_WINDOWS: usize = 8;

/// Mirrors `Windows` in `resolve.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct WindowsUniform {
    pub(crate) frames: [[f32; 4]; MOST_WINDOWS],
    pub(crate) parts: [[u32; 4]; MOST_WINDOWS],
}

impl WindowsUniform {
    fn new(windows: &[Window]) -> Self {
        let mut uniform = Self::zeroed();
        for (i, window) in windows.iter().take(MOST_WINDOWS).enumerate() {
            uniform.frames[i] = window.frame;
            uniform.parts[i] = window.part;
        }
        uniform
    }
}

/// Evaluates materials, one dispatch for each family or for each of them.
#[derive(Debug)]
pub(super) struct ResolvePass {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    group_layout: wgpu::BindGroupLayout,
    constants: Vec<(&'static str, f64)>,
    /// By material class.
    pipelines: BTreeMap<u32, wgpu::ComputePipeline>,
    by: MaterialDispatch,
}

fn shader_of(listed: Listed, by: MaterialDispatch) -> shader::Shader {
    shader::GEOMETRY_VISIBILITY_RESOLVE.variant(match (by, listed) {
        (MaterialDispatch::Family, Listed::Every) => &["BY_FAMILY", "EVERY"],
        (MaterialDispatch::Family, Listed::Rated) => &["BY_FAMILY", "RATED"],
        (MaterialDispatch::Family, Listed::Tiled) => &["BY_FAMILY", "TILED"],
        (MaterialDispatch::Family, Listed::Further) => &["BY_FAMILY", "FURTHER"],
        (MaterialDispatch::Material, Listed::Every) => &["BY_MATERIAL", "EVERY"],
        (MaterialDispatch::Material, Listed::Rated) => &["BY_MATERIAL", "RATED"],
        (MaterialDispatch::Material, Listed::Tiled) => &["BY_MATERIAL", "TILED"],
        (MaterialDispatch::Material, Listed::Further) => &["BY_MATERIAL", "FURTHER"],
    })
}

impl ResolvePass {
    pub(super) fn new(
        gpu: &Gpu,
        (listed, by): (Listed, MaterialDispatch),
        [frame, material, geometry]: [&wgpu::BindGroupLayout; 3],
        face_normals: FaceNormals,
        (windows, black): (u32, bool),
        footprint: f64,
        rates: Option<Rates>,
    ) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let mut types = vec![
            words,
            words,
            storage_read(),
            storage_read(),
            uniform(),
            written_layers(SURFACE_FORMAT),
        ];
        if rates.is_some() {
            types.push(uint);
        }
        let group_layout = bind_group_layout(
            gpu,
            "materials of triangles",
            wgpu::ShaderStages::COMPUTE,
            &types,
        );
        let written = u8::from(face_normals == FaceNormals::Written);
        Self {
            module: shader::module(gpu, "materials of triangles", shader_of(listed, by)),
            layout: gpu.pipeline_layout(
                "materials of triangles",
                &[frame, material, geometry, &group_layout],
            ),
            group_layout,
            constants: [
                ("FACE_NORMAL", f64::from(written)),
                ("BLACK_BELOW_LOBES", f64::from(u8::from(black))),
                ("WINDOWS", f64::from(windows)),
                ("FOOTPRINT", footprint),
            ]
            .into_iter()
            .chain(rates.and_then(Rates::constant))
            .collect(),
            pipelines: BTreeMap::new(),
            by,
        }
    }

    /// Makes the pipeline for materials of `class` unless it is there.
    pub(super) fn prepare(&mut self, gpu: &Gpu, class: u32) {
        self.pipelines.entry(class).or_insert_with(|| {
            let mut constants = self.constants.clone();
            constants.push(("MATERIAL_CLASS", f64::from(class)));
            gpu.compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("materials of triangles"),
                layout: Some(&self.layout),
                module: &self.module,
                entry_point: Some("resolve"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: None,
            })
        });
    }

    /// Encodes the pass.
    pub(super) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        visibility: &VisibilityTargets,
        windows: &[Window],
        at: &ResolveAt<'_>,
    ) {
        let Draws { scene, list } = draws;
        // A scene that this geometry could not draw has none.
        let Some(families) = scene.materials.family_bindings() else {
            return;
        };
        let gpu = recorder.gpu;
        let uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("windows"),
            size: size_of::<WindowsUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let value = WindowsUniform::new(windows);
        gpu.queue
            .write_buffer(&uniform, 0, bytemuck::bytes_of(&value));
        let group = bind_group(
            &gpu.device,
            "materials of triangles",
            &self.group_layout,
            &with_mask(
                at,
                &[
                    wgpu::BindingResource::TextureView(&target.identity_layers),
                    wgpu::BindingResource::TextureView(&visibility.triangle_layers),
                    families.dispatches(self.by).as_entire_binding(),
                    visibility.pixels.as_entire_binding(),
                    uniform.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&target.surface_layers),
                ],
            ),
        );
        let mut pass = recorder.compute_pass(at.material_label);
        pass.set_bind_group(2, scene.geometry.group(), &[]);
        pass.set_bind_group(3, &group, &[]);
        let evaluated = match self.by {
            MaterialDispatch::Family => list.solid_families(scene),
            MaterialDispatch::Material => list.solid_materials(),
        };
        for (number, class) in evaluated {
            let group = match self.by {
                MaterialDispatch::Family => families.group(number),
                MaterialDispatch::Material => scene.materials.group(number),
            };
            pass.set_pipeline(&self.pipelines[&class]);
            pass.set_bind_group(1, group, &[]);
            let offset = u64::from(number) * FAMILY_BYTES;
            pass.dispatch_workgroups_indirect(families.dispatches(self.by), offset);
        }
    }
}
