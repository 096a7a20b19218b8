//! What coarse shading works on, for one frame size.

use super::LEVELS;
use crate::composite::{LightTargets, PatchTargets};
use crate::formats::STENCIL_FORMAT;
use crate::gpu::{Gpu, MipChain};
use crate::rate::RateTargets;
use crate::shading::{HistoryTargets, RADIANCE_FORMAT};
use crate::stereo::EyeLayout;
use crate::{CoarseBackend, Composite, Settings};

/// The rate map, its tiles' samples, and what either backend needs to find the tiles.
#[derive(Debug)]
pub(crate) struct CoarseTargets {
    pub(crate) rate: RateTargets,
    /// Mip l holds the samples of level l: linear radiance, and 1 + the sample's candidate in
    /// alpha.
    pub(crate) samples: MipChain,
    /// For the smooth composite.
    pub(crate) patches: Option<PatchTargets>,
    /// For the composite that puts surfaces into the samples' light.
    pub(crate) light: Option<LightTargets>,
    /// Where light is kept from frame to frame.
    pub(crate) history: Option<HistoryTargets>,
    /// Nonzero where a level has a tile; for the stencil backend.
    pub(super) stencil: Option<MipChain>,
    /// Tiles of each level as x | y << 16; for the compute backend and the smooth composite.
    pub(crate) lists: Vec<wgpu::Buffer>,
    /// Number of tiles of each level.
    pub(crate) counts: wgpu::Buffer,
    /// Workgroups in x, y, z and number of tiles of each level.
    pub(crate) dispatches: wgpu::Buffer,
}

impl CoarseTargets {
    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let buffers = self.lists.iter().chain([&self.counts, &self.dispatches]);
        self.rate.bytes()
            + self.samples.bytes()
            + self.patches.as_ref().map_or(0, PatchTargets::bytes)
            + self.light.as_ref().map_or(0, LightTargets::bytes)
            + self.history.as_ref().map_or(0, HistoryTargets::bytes)
            + self.stencil.as_ref().map_or(0, MipChain::bytes)
            + buffers.map(wgpu::Buffer::size).sum::<u64>()
    }

    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let history = HistoryTargets::new(gpu, settings);
        let size = sample_size(settings, history.is_some());
        let levels = 0..=u32::from(settings.coarse.coarsest_level);
        let buffer = |label, bytes: u64, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: usage | wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let list = |level: u32| {
            let blocks =
                u64::from(size.0.div_ceil(1 << level)) * u64::from(size.1.div_ceil(1 << level));
            buffer("tiles", blocks * 4, wgpu::BufferUsages::empty())
        };
        Self {
            rate: RateTargets::new(gpu, settings),
            samples: MipChain::new(
                gpu,
                "coarse samples",
                size,
                levels.clone(),
                RADIANCE_FORMAT,
                wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
            ),
            patches: match settings.coarse.composite {
                Composite::Smooth => PatchTargets::new(gpu, settings),
                Composite::Light | Composite::Nearest | Composite::Paper => None,
            },
            light: (settings.coarse.composite == Composite::Light)
                .then(|| LightTargets::new(gpu, settings, size)),
            history,
            stencil: (settings.coarse.backend != CoarseBackend::Compute).then(|| {
                MipChain::new(
                    gpu,
                    "tile stencil",
                    size,
                    levels.clone(),
                    STENCIL_FORMAT,
                    wgpu::TextureUsages::empty(),
                )
            }),
            lists: if super::levels::needs_lists(settings) {
                levels.map(list).collect()
            } else {
                Vec::new()
            },
            counts: buffer(
                "tile counts",
                u64::from(LEVELS) * 4,
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            dispatches: buffer(
                "tile dispatches",
                u64::from(LEVELS) * 16,
                wgpu::BufferUsages::INDIRECT,
            ),
        }
    }
}

/// Size in pixels of what the samples of blocks cover. Where light is kept from frame to frame there
/// are none, and their targets are as small as can be bound.
fn sample_size(settings: &Settings, keeps_light: bool) -> (u32, u32) {
    let (width, height) = EyeLayout::of(settings).target_size();
    if keeps_light {
        let block = 1 << settings.coarse.coarsest_level;
        (width.min(block), height.min(block))
    } else {
        (width, height)
    }
}
