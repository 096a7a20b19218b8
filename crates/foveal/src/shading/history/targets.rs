//! What is kept from frame to frame, and the lists of a frame.

use super::lit::SAMPLE_BYTES;
use crate::gpu::{self, Gpu};
use crate::recorder::Recorder;
use crate::shading::RADIANCE_FORMAT;
use crate::stereo::EyeLayout;
use crate::{Settings, composite::LIGHT_FORMAT};

/// What a pixel keeps besides its light: `layout.wgsl`.
pub(super) const SEEN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// What is known of a tile: `TileHistory` there.
pub(super) const TILE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// Bytes of `Listed` in `layout.wgsl`.
pub(super) const LISTED_BYTES: u64 = 40;
/// Bytes of `Dispatch` there: the step between bindings.
const LIST_STEP: u64 = 256;

/// A list of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum List {
    Samples = 0,
    Bare = 1,
    Unlit = 2,
    Chosen = 3,
    Single = 4,
    Led = 5,
}

/// Lists of a frame.
const LISTS: u64 = 6;

impl List {
    /// Where its `Dispatch` begins.
    pub(super) const fn offset(self) -> u64 {
        self as u64 * LIST_STEP
    }

    /// The same in rows of four words.
    pub(super) const fn row(self) -> f64 {
        (self.offset() / 16) as f64
    }
}

/// The targets of one frame size.
#[derive(Debug)]
pub(crate) struct HistoryTargets {
    /// Each pixel's light, of even and of odd frames.
    pub(super) light: [wgpu::TextureView; 2],
    /// What else each pixel keeps.
    pub(super) seen: [wgpu::TextureView; 2],
    /// Radiance of solid surfaces, without what is blended over it.
    pub(super) radiance: wgpu::TextureView,
    /// `Listed` of each list.
    pub(crate) listed: wgpu::Buffer,
    /// `Dispatch` of each list.
    pub(super) dispatches: wgpu::Buffer,
    /// Samples to be shaded: pixels from the beginning on, blocks from the end back; then unlit pixels.
    pub(super) samples: wgpu::Buffer,
    /// Pixels that ask for a sample; then, from the end back, those that take their leader's light.
    pub(super) chosen: wgpu::Buffer,
    /// Pixels that have no history.
    pub(super) bare: wgpu::Buffer,
    /// A bit for each pixel that is a block's sample.
    pub(super) wanted: wgpu::Buffer,
    /// A bit for each pixel that is to be shaded because no sample speaks for it or for one that it
    /// leads.
    pub(super) wanted_unlit: wgpu::Buffer,
    /// What samples say of each tile.
    pub(super) measured: wgpu::Buffer,
    /// What they said of late.
    pub(super) kept: wgpu::Buffer,
    /// What follows from it: a texel for each tile.
    pub(super) tiles: wgpu::TextureView,
}

impl HistoryTargets {
    /// `None` where light is not reprojected.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        if !super::lit::is_used(gpu, settings) {
            return None;
        }
        let size = EyeLayout::of(settings).target_size();
        let stored = wgpu::TextureUsages::STORAGE_BINDING;
        let target = |label, format| gpu::target(gpu, label, size, format, stored);
        let seen = |label| target(label, SEEN_FORMAT);
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage
                    | wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let none = wgpu::BufferUsages::empty();
        let pixels = u64::from(size.0) * u64::from(size.1);
        let across_and_down = (size.0.div_ceil(8), size.1.div_ceil(8));
        let tiles = u64::from(across_and_down.0) * u64::from(across_and_down.1);
        Some(Self {
            light: ["light, even", "light, odd"].map(|label| target(label, LIGHT_FORMAT)),
            seen: ["seen, even", "seen, odd"].map(seen),
            radiance: target("radiance of solid surfaces", RADIANCE_FORMAT),
            listed: buffer("lists", LISTS * LISTED_BYTES, none),
            dispatches: buffer(
                "list dispatches",
                LISTS * LIST_STEP,
                wgpu::BufferUsages::INDIRECT,
            ),
            samples: buffer("samples", pixels * SAMPLE_BYTES, none),
            chosen: buffer("chosen pixels", pixels * 4, none),
            bare: buffer("bare pixels", pixels * 4, none),
            wanted: buffer("wanted samples", pixels.div_ceil(32) * 4, none),
            wanted_unlit: buffer("wanted pixels", pixels.div_ceil(32) * 4, none),
            measured: buffer("measured tiles", tiles * 8, none),
            kept: buffer("kept tiles", tiles * 8, none),
            tiles: gpu::target(gpu, "tiles", across_and_down, TILE_FORMAT, stored),
        })
    }

    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.radiance.texture().size();
        let buffers = [
            &self.listed,
            &self.dispatches,
            &self.samples,
            &self.chosen,
            &self.bare,
            &self.wanted,
            &self.wanted_unlit,
            &self.measured,
            &self.kept,
        ];
        // A tile's texel takes what is kept of it in a buffer.
        let tiles = self.kept.size();
        u64::from(size.width) * u64::from(size.height) * (2 * 16 + 2 * 4 + 8)
            + tiles
            + buffers.map(wgpu::Buffer::size).iter().sum::<u64>()
    }

    /// Copies the radiance of solid surfaces to where blended ones are drawn over it.
    pub(super) fn show(&self, recorder: &mut Recorder<'_>, to: &wgpu::TextureView) {
        let radiance = self.radiance.texture();
        recorder.encoder.copy_texture_to_texture(
            radiance.as_image_copy(),
            to.texture().as_image_copy(),
            radiance.size(),
        );
    }

    /// The binding of one list's `Dispatch`.
    pub(super) fn dispatch(&self, list: List) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.dispatches,
            offset: list.offset(),
            size: std::num::NonZeroU64::new(LIST_STEP),
        })
    }
}
