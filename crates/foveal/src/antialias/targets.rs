//! What anti-aliasing keeps: the band of sub-samples, what becomes of it per pixel, and the list of edge pixels.

use crate::Settings;
use crate::geometry::GBuffer;
use crate::gpu::Gpu;
use crate::shading::RADIANCE_FORMAT;

use super::pattern::{BYTES_PER_SAMPLE, Band, BandUniform, Pattern};

/// How often each pixel is shaded, and how many sub-samples its G-buffer texel stands for.
pub(super) const TALLY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg8Uint;

/// Bytes per pixel besides the sub-samples: tally, ordinary radiance, sums.
const BYTES_PER_PIXEL: u64 = 2 + 8 + 8;

/// The targets of anti-aliasing for one frame size.
#[derive(Debug)]
pub(crate) struct SampleTargets {
    pub(super) pattern: Pattern,
    /// The bands, top to bottom, each with its uniform block.
    pub(super) bands: Vec<(Band, wgpu::Buffer)>,
    /// The sub-samples of one band.
    pub(crate) samples: GBuffer,
    pub(crate) tally_view: wgpu::TextureView,
    /// What the ordinary path shades.
    pub(crate) ordinary_view: wgpu::TextureView,
    /// What is shaded besides: weighted radiance and weights.
    pub(super) sums_view: wgpu::TextureView,
    /// Edge pixels of one band, `x | y << 16`.
    pub(super) list: wgpu::Buffer,
    /// Workgroups in x, y, z and the length of the list.
    pub(super) dispatch: wgpu::Buffer,
    /// What `dispatch` is before a band.
    pub(super) empty_dispatch: wgpu::Buffer,
    /// Edge pixels of the frame, and lighting evaluations there.
    pub(super) counters: wgpu::Buffer,
    bytes: u64,
}

impl SampleTargets {
    /// The targets for settings that were found valid and have anti-aliasing.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let pattern = Pattern::of(settings);
        let rows = pattern.rows_per_band(settings.width, settings.height, most);
        Self::in_bands(gpu, settings, rows)
    }

    /// The targets for bands of `rows` rows.
    pub(crate) fn in_bands(gpu: &Gpu, settings: &Settings, rows: u32) -> Self {
        let (width, height) = (settings.width, settings.height);
        let pattern = Pattern::of(settings);
        let (texels_x, texels_y) = pattern.texels(width, rows);
        let target = |label, format, usage| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let bands = Band::all(height, rows).map(|band| {
            let size = size_of::<BandUniform>() as u64;
            let uniform = buffer("band", size, wgpu::BufferUsages::UNIFORM);
            let value = BandUniform::new(&pattern, band);
            gpu.queue
                .write_buffer(&uniform, 0, bytemuck::bytes_of(&value));
            (band, uniform)
        });
        let list_bytes = u64::from(width) * u64::from(rows) * 4;
        let empty_dispatch = buffer("empty dispatch", 16, wgpu::BufferUsages::empty());
        let start = [0_u32, 1, 1, 0];
        gpu.queue
            .write_buffer(&empty_dispatch, 0, bytemuck::bytes_of(&start));
        Self {
            bands: bands.collect(),
            samples: GBuffer::new(gpu, texels_x, texels_y),
            tally_view: target("tally", TALLY_FORMAT, drawn),
            ordinary_view: target("ordinary radiance", RADIANCE_FORMAT, drawn | written),
            sums_view: target("edge sums", RADIANCE_FORMAT, written),
            list: buffer("edge pixels", list_bytes, storage),
            dispatch: buffer("edge dispatch", 16, storage | wgpu::BufferUsages::INDIRECT),
            empty_dispatch,
            counters: buffer("edge counters", 8, storage),
            bytes: u64::from(texels_x) * u64::from(texels_y) * BYTES_PER_SAMPLE
                + u64::from(width) * u64::from(height) * BYTES_PER_PIXEL
                + list_bytes,
            pattern,
        }
    }

    /// Bytes of all that depends on the frame's size.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }
}
