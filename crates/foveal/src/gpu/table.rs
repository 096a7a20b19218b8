//! What shaders look up: a storage buffer, or a texture of the same words. A texture where the device
//! has no storage buffers, and on lavapipe, which loads a buffer word by word, for each of eight
//! lanes behind a branch, and a texel's four words at once.

use super::{Gpu, sampled, storage_read};
use crate::Error;

/// Texels in a row of a table that is a texture: `TABLE_WIDTH` in `gpu/table.wgsl`.
const WIDTH: u32 = 1024;
/// Four words.
const TEXEL_BYTES: usize = 16;
const ROW_BYTES: usize = WIDTH as usize * TEXEL_BYTES;

/// Words that the device reads and the CPU writes.
#[derive(Debug)]
pub(crate) struct Table {
    label: &'static str,
    held: Held,
}

#[derive(Debug)]
enum Held {
    Buffer(wgpu::Buffer),
    Texture(wgpu::TextureView),
}

impl Table {
    /// An empty table.
    pub(crate) fn new(gpu: &Gpu, label: &'static str) -> Self {
        Self {
            label,
            held: Held::with_room(gpu, label, TEXEL_BYTES),
        }
    }

    /// What a layout says of it.
    pub(crate) fn binding_type(gpu: &Gpu) -> wgpu::BindingType {
        if gpu.has_texture_tables() {
            sampled(wgpu::TextureSampleType::Uint)
        } else {
            storage_read()
        }
    }

    /// Bytes that a table may hold on this device.
    fn limit(gpu: &Gpu) -> u64 {
        let limits = gpu.device.limits();
        if gpu.has_texture_tables() {
            u64::from(limits.max_texture_dimension_2d) * ROW_BYTES as u64
        } else {
            limits.max_storage_buffer_binding_size
        }
    }

    /// What a bind group binds.
    pub(crate) fn resource(&self) -> wgpu::BindingResource<'_> {
        match &self.held {
            Held::Buffer(buffer) => buffer.as_entire_binding(),
            Held::Texture(view) => wgpu::BindingResource::TextureView(view),
        }
    }

    /// Writes `bytes` from the beginning; true where that took a new resource, which must be bound
    /// again.
    pub(crate) fn write(&mut self, gpu: &Gpu, bytes: &[u8]) -> bool {
        let grows = self.held.room() < bytes.len();
        if grows {
            self.held = Held::with_room(gpu, self.label, bytes.len().next_power_of_two());
        }
        match &self.held {
            Held::Buffer(buffer) => gpu.queue.write_buffer(buffer, 0, bytes),
            Held::Texture(view) => write_rows(gpu, view.texture(), bytes),
        }
        grows
    }

    /// [`Error::Limit`] where `count` items of `item_bytes` are more than the device can bind.
    pub(crate) fn check(
        gpu: &Gpu,
        what: &str,
        count: usize,
        item_bytes: usize,
    ) -> Result<(), Error> {
        let limit = Self::limit(gpu);
        if (count * item_bytes) as u64 <= limit {
            return Ok(());
        }
        Err(Error::Limit {
            what: what.to_owned(),
            value: count as u64,
            limit: limit / item_bytes as u64,
            hint: String::new(),
        })
    }
}

impl Held {
    fn with_room(gpu: &Gpu, label: &str, bytes: usize) -> Self {
        if !gpu.has_texture_tables() {
            return Self::Buffer(gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                // An empty buffer cannot be bound.
                size: bytes.max(TEXEL_BYTES) as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        let most = gpu.device.limits().max_texture_dimension_2d;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: WIDTH,
                height: (bytes.div_ceil(ROW_BYTES).max(1) as u32).min(most),
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self::Texture(texture.create_view(&Default::default()))
    }

    fn room(&self) -> usize {
        match self {
            Self::Buffer(buffer) => buffer.size() as usize,
            Self::Texture(view) => view.texture().height() as usize * ROW_BYTES,
        }
    }
}

/// Writes whole rows, then the rest of the last one.
fn write_rows(gpu: &Gpu, texture: &wgpu::Texture, bytes: &[u8]) {
    let rows = bytes.len() / ROW_BYTES;
    let (whole, rest) = bytes.split_at(rows * ROW_BYTES);
    let mut padded = rest.to_vec();
    padded.resize(rest.len().next_multiple_of(TEXEL_BYTES), 0);
    let parts = [
        (0, rows, WIDTH, whole),
        (
            rows,
            usize::from(!rest.is_empty()),
            (padded.len() / TEXEL_BYTES) as u32,
            &padded,
        ),
    ];
    for (first, rows, width, bytes) in parts {
        if rows == 0 {
            continue;
        }
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d {
                    x: 0,
                    y: first as u32,
                    z: 0,
                },
                ..texture.as_image_copy()
            },
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * TEXEL_BYTES as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width,
                height: rows as u32,
                depth_or_array_layers: 1,
            },
        );
    }
}
