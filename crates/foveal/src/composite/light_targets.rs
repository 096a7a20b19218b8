//! What the composite of light reads and lists.

use crate::Settings;
use crate::formats::LIGHT_FORMAT;
use crate::gpu::{Gpu, MipChain};

/// The samples' light, and the pixels without, of one frame size.
#[derive(Debug)]
pub(crate) struct LightTargets {
    /// Mip l holds the light of the samples of level l.
    pub(crate) samples: MipChain,
    /// Pixels to be shaded where no sample speaks for them; from the end back those that take their
    /// leader's light.
    pub(crate) unlit: wgpu::Buffer,
    /// The numbers of both, with room for the counts of nine levels, as the pass that sizes
    /// dispatches has them.
    pub(crate) unlit_counts: wgpu::Buffer,
    /// Workgroups in x, y, z and length of either list.
    pub(crate) unlit_dispatches: wgpu::Buffer,
    /// A bit for each pixel that is to be shaded.
    pub(super) wanted: wgpu::Buffer,
}

impl LightTargets {
    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let buffers = [
            &self.unlit,
            &self.unlit_counts,
            &self.unlit_dispatches,
            &self.wanted,
        ];
        self.samples.bytes() + buffers.map(wgpu::Buffer::size).iter().sum::<u64>()
    }

    /// `size`: of what the samples of level 0 cover, in pixels.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings, size: (u32, u32)) -> Self {
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let pixels = u64::from(size.0) * u64::from(size.1);
        let levels = u64::from(crate::shading::LEVELS);
        Self {
            samples: MipChain::new(
                gpu,
                "coarse light",
                size,
                0..=u32::from(settings.coarse.coarsest_level),
                LIGHT_FORMAT,
                wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
            ),
            unlit: buffer("unlit pixels", pixels * 4, wgpu::BufferUsages::empty()),
            unlit_counts: buffer(
                "unlit counts",
                levels * 4,
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            unlit_dispatches: buffer(
                "unlit dispatches",
                levels * 16,
                wgpu::BufferUsages::INDIRECT,
            ),
            wanted: buffer(
                "wanted pixels",
                pixels.div_ceil(32) * 4,
                wgpu::BufferUsages::COPY_DST,
            ),
        }
    }
}
