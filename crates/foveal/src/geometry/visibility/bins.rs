//! The passes that sort the seen pixels by material.

use super::{Rates, ResolveAt, VisibilityTargets, with_mask};
use crate::geometry::{GBuffer, SURFACE_FORMAT};
use crate::gpu::{
    Gpu, Table, bind_group, bind_group_layout, sampled, sampled_layers, storage_write,
    written_layers,
};

use crate::recorder::Recorder;
use crate::scene::{MaterialDispatch, SceneOnGpu};
use crate::shader;

/// Bytes of `Bin` in `bins.wgsl`.
pub(super) const BIN_BYTES: u64 = 16;
/// Pixels a side that one workgroup looks at.
const TILE: u32 = 16;

/// Where each material's pixels lie.
#[derive(Debug)]
pub(super) struct Bins(pub(super) wgpu::Buffer);

impl Bins {
    pub(super) fn new(gpu: &Gpu, materials: u32) -> Self {
        Self(gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("material bins"),
            size: u64::from(materials.max(1)) * BIN_BYTES,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        }))
    }

    /// Number of bins.
    pub(super) fn count(&self) -> u32 {
        (self.0.size() / BIN_BYTES) as u32
    }
}

/// Whether subgroups do the counting: no browser offers them yet through the graphics library.
fn asks_subgroups(gpu: &Gpu) -> bool {
    gpu.device.features().contains(wgpu::Features::SUBGROUP)
}

/// Counts, sums up and scatters.
#[derive(Debug)]
pub(super) struct BinPass {
    count: wgpu::ComputePipeline,
    sum: wgpu::ComputePipeline,
    scatter: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl BinPass {
    /// `rates`: only pixels that stand for a sample are sorted.
    pub(super) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        rates: Option<Rates>,
    ) -> Self {
        Self::with(gpu, frame_layout, rates, asks_subgroups(gpu))
    }

    /// The same by `subgroups` or by a hash table.
    pub(super) fn with(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        rates: Option<Rates>,
        subgroups: bool,
    ) -> Self {
        let uint = sampled(wgpu::TextureSampleType::Uint);
        let words = sampled_layers(wgpu::TextureSampleType::Uint);
        let mut types = vec![
            words,
            Table::binding_type(gpu),
            storage_write(),
            storage_write(),
            written_layers(SURFACE_FORMAT),
            storage_write(),
        ];
        if rates.is_some() {
            types.push(uint);
        }
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = bind_group_layout(gpu, "binning", compute, &types);
        let shader = if subgroups {
            shader::GEOMETRY_VISIBILITY_BINS_SUBGROUPS
        } else {
            shader::GEOMETRY_VISIBILITY_BINS_TABLE
        };
        let shader = shader.variant(match rates {
            None => &["EVERY"],
            Some(Rates::Samples) => &["RATED"],
            Some(Rates::Tiles(_)) => &["TILED"],
        });
        let module = shader::module(gpu, "binning", shader);
        let constant = rates.and_then(Rates::constant);
        let pipeline = |entry, constants: &[_]| {
            let groups = [frame_layout, &layout];
            shader::compute(gpu, "binning", &module, entry, &groups, constants)
        };
        Self {
            count: pipeline("count_pixels", constant.as_slice()),
            sum: pipeline("sum_bins", constant.as_slice()),
            scatter: pipeline("scatter_pixels", constant.as_slice()),
            layout,
        }
    }

    /// Encodes the passes: fills `bins`, the families' dispatches and the list of pixels, and
    /// empties the surfaces where nothing is seen.
    pub(super) fn sort(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        target: &GBuffer,
        visibility: &VisibilityTargets,
        (bins, by): (&Bins, MaterialDispatch),
        at: &ResolveAt<'_>,
    ) {
        let Some(families) = scene.materials.family_bindings() else {
            return;
        };
        recorder.encoder.clear_buffer(&bins.0, 0, None);
        let group = bind_group(
            &recorder.gpu.device,
            "binning",
            &self.layout,
            &with_mask(
                at,
                &[
                    wgpu::BindingResource::TextureView(&target.identity_layers),
                    scene.geometry.places().resource(),
                    bins.0.as_entire_binding(),
                    visibility.pixels.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&target.surface_layers),
                    families.dispatches(by).as_entire_binding(),
                ],
            ),
        );
        let size = target.identity_view.texture().size();
        let across = size.width * size.depth_or_array_layers;
        let tiles = (across.div_ceil(TILE), size.height.div_ceil(TILE));
        let mut pass = recorder.compute_pass(at.binning_label);
        pass.set_bind_group(1, &group, &[]);
        for (pipeline, (x, y)) in [
            (&self.count, tiles),
            (&self.sum, (1, 1)),
            (&self.scatter, tiles),
        ] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}
