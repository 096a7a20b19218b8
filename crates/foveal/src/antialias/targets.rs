//! What anti-aliasing keeps: the band of sub-samples, the tally of each pixel, and the queue of
//! what is shaded besides the ordinary path.

use bytemuck::{Pod, Zeroable};

use crate::Settings;
use crate::geometry::{GBuffer, VisibilityTargets, Window};
use crate::gpu::{Gpu, target};
use crate::stereo::EyeLayout;

use super::blended::{self, BlendedTargets};
use super::choice::by_triangles;
use super::further::{FurtherTargets, band_of_triangles};
use super::pattern::{Band, BandUniform, Pattern};

/// How often each pixel is shaded, and how many sub-samples its G-buffer texel stands for.
pub(super) const TALLY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg8Uint;

/// Bytes per pixel of the tally.
const TALLY_BYTES: u64 = 2;
/// Bytes of an entry of the queue, and of what it comes to.
const ENTRY_BYTES: u64 = 8;

/// Mirrors `Queue` in `antialias/queue.wgsl`, where the fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct QueueUniform {
    pub(crate) band_groups: [u32; 3],
    pub(crate) start: u32,
    pub(crate) all_groups: [u32; 3],
    pub(crate) total: u32,
    pub(crate) edge_pixels: u32,
    pub(crate) evaluations: u32,
    pub(crate) reserved: [u32; 2],
}

/// Where the queue holds the workgroups of all entries.
pub(super) const ALL_GROUPS: u64 = std::mem::offset_of!(QueueUniform, all_groups) as u64;

impl QueueUniform {
    /// Of a frame that has drawn nothing yet.
    const EMPTY: Self = Self {
        band_groups: [0, 1, 1],
        start: 0,
        all_groups: [0, 1, 1],
        total: 0,
        edge_pixels: 0,
        evaluations: 0,
        reserved: [0; 2],
    };
}

/// The targets of anti-aliasing for one frame size.
#[derive(Debug)]
pub(crate) struct SampleTargets {
    pub(super) pattern: Pattern,
    /// The bands, top to bottom, each with its uniform block.
    pub(super) bands: Vec<(Band, wgpu::Buffer)>,
    /// The sub-samples of one band; without surfaces where triangles are sorted.
    pub(crate) samples: GBuffer,
    /// Where triangles are sorted.
    pub(super) further: Option<FurtherTargets>,
    /// Where blended surfaces are seen.
    pub(super) blended: Option<BlendedTargets>,
    pub(crate) tally_view: wgpu::TextureView,
    /// [`QueueUniform`].
    pub(crate) queue: wgpu::Buffer,
    pub(super) entries: wgpu::Buffer,
    pub(super) sums: wgpu::Buffer,
    /// An empty queue, and room for a number.
    empty_queue: wgpu::Buffer,
    pub(super) number: wgpu::Buffer,
    bytes: u64,
    /// Rows of a band.
    rows: u32,
    /// Entries that a frame wanted and had no room for; 0: none.
    wanted: u64,
    /// The least room that the device had no memory for.
    refused: u64,
}

impl SampleTargets {
    /// The targets for settings that were found valid and have anti-aliasing.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let pattern = Pattern::of(settings);
        let size = EyeLayout::of(settings).target_size();
        let rows = pattern.rows_per_band(size, bytes_per_sample(settings), most);
        Self::in_bands(gpu, settings, rows)
    }

    /// The targets for bands of `rows` rows.
    pub(crate) fn in_bands(gpu: &Gpu, settings: &Settings, rows: u32) -> Self {
        let (width, height) = EyeLayout::of(settings).target_size();
        let pixels = u64::from(width) * u64::from(height);
        let room = if by_triangles(settings) {
            FurtherTargets::usual_room(width, height)
        } else {
            // One further surface per pixel on average is more than most frames show.
            pixels
        };
        Self::with_room(gpu, settings, rows, room)
    }

    /// The frame's bands of rows, and what shaders are told of each.
    pub(crate) fn bands(&self) -> &[(Band, wgpu::Buffer)] {
        &self.bands
    }

    /// How the frame is drawn to fill a band's sub-samples.
    pub(crate) fn windows(&self, band: Band) -> Vec<Window> {
        let size = self.tally_view.texture().size();
        band.windows(&self.pattern, size.width, size.height)
    }

    /// The G-buffer of the sub-samples of a band.
    pub(crate) fn gbuffer(&self) -> &GBuffer {
        &self.samples
    }

    /// The G-buffer of further surfaces, where triangles are sorted.
    pub(crate) fn further_gbuffer(&self) -> Option<&GBuffer> {
        self.further.as_ref().map(|further| &further.gbuffer)
    }

    /// Where blended surfaces are drawn, if any were.
    pub(crate) fn blended(&self) -> Option<&BlendedTargets> {
        self.blended.as_ref()
    }

    /// Entries that there is room for.
    pub(crate) fn room(&self) -> u64 {
        self.entries.size() / ENTRY_BYTES
    }

    /// Notes how many entries a frame wanted; gives how many of them had no room.
    pub(crate) fn note_wanted(&mut self, entries: u64) -> u64 {
        let left_out = entries.saturating_sub(self.room());
        self.wanted = if left_out > 0 { entries } else { 0 };
        left_out
    }

    /// The room to make for the entries that were wanted and some more, where the device can have
    /// it. That is asked once.
    pub(crate) fn room_to_make(&mut self, gpu: &Gpu, settings: &Settings) -> Option<u64> {
        let wanted = std::mem::take(&mut self.wanted);
        let room = possible_room(&gpu.device.limits(), settings, wanted + wanted / 4);
        (wanted > 0 && room > self.room() && room < self.refused).then_some(room)
    }

    /// The device has no memory for so much room.
    pub(crate) fn refuse(&mut self, room: u64) {
        self.refused = room;
    }

    /// The same targets with more room.
    pub(crate) fn grown(&self, gpu: &Gpu, settings: &Settings, room: u64) -> Self {
        let grown = Self::with_room(gpu, settings, self.rows, room);
        grown.with_blended_as(self, gpu)
    }

    /// Targets that blended surfaces have a place in too, if these have none.
    pub(crate) fn blending(&self, gpu: &Gpu, settings: &Settings) -> Option<Self> {
        if self.blended.is_some() {
            return None;
        }
        let most = gpu.device.limits().max_texture_dimension_2d;
        let size = EyeLayout::of(settings).target_size();
        let bytes = bytes_per_sample(settings) + blended::TEXEL_BYTES;
        let rows = self.pattern.rows_per_band(size, bytes, most).min(self.rows);
        let mut targets = Self::with_room(gpu, settings, rows, self.room());
        let texels = targets.pattern.texels(size.0, rows);
        targets.blended = Some(BlendedTargets::new(gpu, texels, size));
        Some(targets)
    }

    /// The same, with a place for blended surfaces if `other` has one.
    fn with_blended_as(self, other: &Self, gpu: &Gpu) -> Self {
        let size = self.tally_view.texture().size();
        let texels = self.pattern.texels(size.width, self.rows);
        let new = |_: &BlendedTargets| BlendedTargets::new(gpu, texels, (size.width, size.height));
        let blended = other.blended.as_ref().map(new);
        Self { blended, ..self }
    }

    /// The targets for bands of `rows` rows and at least `room` entries, as far as the device can
    /// have them.
    pub(crate) fn with_room(gpu: &Gpu, settings: &Settings, rows: u32, room: u64) -> Self {
        let (width, height) = EyeLayout::of(settings).target_size();
        let pattern = Pattern::of(settings);
        let (texels_x, texels_y) = pattern.texels(width, rows);
        let tally_view = target(
            gpu,
            "tally",
            (width, height),
            TALLY_FORMAT,
            wgpu::TextureUsages::empty(),
        );
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let bands = Band::all(height, rows).map(|band| {
            let size = size_of::<BandUniform>() as u64;
            let uniform = buffer("band", size, wgpu::BufferUsages::UNIFORM);
            let value = BandUniform::new(&pattern, band);
            gpu.queue
                .write_buffer(&uniform, 0, bytemuck::bytes_of(&value));
            (band, uniform)
        });
        let queue_bytes = size_of::<QueueUniform>() as u64;
        let empty_queue = buffer("empty queue", queue_bytes, wgpu::BufferUsages::empty());
        gpu.queue
            .write_buffer(&empty_queue, 0, bytemuck::bytes_of(&QueueUniform::EMPTY));
        let pixels = u64::from(width) * u64::from(height);
        let further = by_triangles(settings).then(|| FurtherTargets::new(gpu, width, height, room));
        let room = possible_room(&gpu.device.limits(), settings, room);
        let entry_bytes = ENTRY_BYTES * room;
        Self {
            bands: bands.collect(),
            samples: match further {
                Some(_) => band_of_triangles(gpu, (texels_x, texels_y)),
                None => GBuffer::new(gpu, settings.geometry.path, (texels_x, texels_y), 1),
            },
            tally_view,
            queue: buffer("queue", queue_bytes, storage | wgpu::BufferUsages::INDIRECT),
            entries: buffer("queue entries", entry_bytes, storage),
            sums: buffer("queue sums", entry_bytes, storage),
            empty_queue,
            number: buffer("number", 4, storage),
            bytes: u64::from(texels_x) * u64::from(texels_y) * bytes_per_sample(settings)
                + pixels * TALLY_BYTES
                + entry_bytes * 2
                + further.as_ref().map_or(0, FurtherTargets::bytes),
            further,
            blended: None,
            pattern,
            rows,
            wanted: 0,
            refused: u64::MAX,
        }
    }

    /// Empties the queue for a new frame.
    pub(super) fn begin_frame(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.empty_queue, 0, &self.queue, 0, self.queue.size());
    }

    /// Lets the next band's entries follow those of the bands before.
    pub(super) fn begin_band(&self, encoder: &mut wgpu::CommandEncoder) {
        let total = std::mem::offset_of!(QueueUniform, total) as u64;
        let start = std::mem::offset_of!(QueueUniform, start) as u64;
        // A buffer cannot be copied into itself.
        encoder.copy_buffer_to_buffer(&self.queue, total, &self.number, 0, 4);
        encoder.copy_buffer_to_buffer(&self.number, 0, &self.queue, start, 4);
        encoder.copy_buffer_to_buffer(&self.empty_queue, 0, &self.queue, 0, 4);
    }

    /// Takes the number for the evaluations of the queue's entries.
    pub(super) fn take_evaluations(&self, encoder: &mut wgpu::CommandEncoder) {
        let evaluations = std::mem::offset_of!(QueueUniform, evaluations) as u64;
        encoder.copy_buffer_to_buffer(&self.number, 0, &self.queue, evaluations, 4);
    }

    /// Bytes of all that depends on the frame's size.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
            + self
                .samples
                .visibility
                .as_ref()
                .map_or(0, VisibilityTargets::bytes)
            + self.blended.as_ref().map_or(0, BlendedTargets::bytes)
    }
}

/// Bytes of a sub-sample in the band: its surface, identity, triangle and depth, as far as they are
/// kept.
fn bytes_per_sample(settings: &Settings) -> u64 {
    if by_triangles(settings) { 16 } else { 28 }
}

/// Entries that there is room for where at least `room` are asked for, as far as a device goes.
fn possible_room(limits: &wgpu::Limits, settings: &Settings, room: u64) -> u64 {
    let (width, _) = EyeLayout::of(settings).target_size();
    let room = if by_triangles(settings) {
        u64::from(width) * u64::from(FurtherTargets::rows(limits, width, room))
    } else {
        room
    };
    room.min(most_entries(limits))
}

/// Entries that a queue can have on a device.
pub(super) fn most_entries(limits: &wgpu::Limits) -> u64 {
    limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size)
        / ENTRY_BYTES
}
