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
#[derive(Clone, Debug)]
pub(crate) struct Table {
    label: &'static str,
    held: Held,
}

#[derive(Clone, Debug)]
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

    /// The words of `buffer`, whose size is a multiple of 16: itself where tables are buffers, else
    /// a copy, which [`Table::copy`] writes.
    pub(crate) fn of_buffer(gpu: &Gpu, label: &'static str, buffer: &wgpu::Buffer) -> Self {
        let held = if gpu.has_texture_tables() {
            Held::with_room(gpu, label, buffer.size() as usize)
        } else {
            Held::Buffer(buffer.clone())
        };
        Self { label, held }
    }

    /// Copies what the buffer of [`Table::of_buffer`] holds now, where the table is a copy.
    pub(crate) fn copy(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer) {
        let Held::Texture(view) = &self.held else {
            return;
        };
        for part in Part::of(buffer.size() as usize) {
            encoder.copy_buffer_to_texture(
                wgpu::TexelCopyBufferInfo {
                    buffer,
                    layout: part.layout(part.first_row as u64 * ROW_BYTES as u64),
                },
                part.place(view.texture()),
                part.size(),
            );
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
    pub(crate) fn limit(gpu: &Gpu) -> u64 {
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
        Error::if_above(Self::limit(gpu) / item_bytes as u64, what, count)
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
    for part in Part::of(bytes.len()) {
        let bytes = &bytes[part.first_row as usize * ROW_BYTES..];
        let all = part.bytes();
        // The last texel may be written in part.
        let padded = (bytes.len() < all).then(|| {
            let mut padded = bytes.to_vec();
            padded.resize(all, 0);
            padded
        });
        gpu.queue.write_texture(
            part.place(texture),
            padded.as_deref().unwrap_or(&bytes[..all.min(bytes.len())]),
            part.layout(0),
            part.size(),
        );
    }
}

/// Texels of a table that are written at once: whole rows, or the beginning of one.
struct Part {
    first_row: u32,
    rows: u32,
    width: u32,
}

impl Part {
    /// The parts of a table's first bytes.
    fn of(bytes: usize) -> impl Iterator<Item = Self> {
        let texels = bytes.div_ceil(TEXEL_BYTES) as u32;
        let (rows, rest) = (texels / WIDTH, texels % WIDTH);
        let whole = Self {
            first_row: 0,
            rows,
            width: WIDTH,
        };
        let beginning = Self {
            first_row: rows,
            rows: 1,
            width: rest,
        };
        [whole, beginning]
            .into_iter()
            .filter(|part| part.rows * part.width > 0)
    }

    fn bytes(&self) -> usize {
        (self.rows * self.width) as usize * TEXEL_BYTES
    }

    fn place<'a>(&self, texture: &'a wgpu::Texture) -> wgpu::TexelCopyTextureInfo<'a> {
        wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d {
                x: 0,
                y: self.first_row,
                z: 0,
            },
            ..texture.as_image_copy()
        }
    }

    fn layout(&self, offset: u64) -> wgpu::TexelCopyBufferLayout {
        wgpu::TexelCopyBufferLayout {
            offset,
            // One row needs none, and a copy from a buffer wants multiples of 256 bytes.
            bytes_per_row: (self.rows > 1).then_some(self.width * TEXEL_BYTES as u32),
            rows_per_image: None,
        }
    }

    fn size(&self) -> wgpu::Extent3d {
        wgpu::Extent3d {
            width: self.width,
            height: self.rows,
            depth_or_array_layers: 1,
        }
    }
}
