//! What ambient occlusion writes.

use crate::gpu::{self, Gpu};
use crate::stereo::EyeLayout;
use crate::{COARSEST_LEVEL, Settings, Shading};

/// Visibility at the places that were looked from, where shaders write it.
pub(super) const FOUND_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Visibility of each pixel, and the distance of its surface, where shaders write them.
pub(super) const VISIBILITY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;

/// [`FOUND_FORMAT`], or for the reduced renderer its bits: WebGL 2 draws to no floats of 32 bits.
pub(super) fn found_format(gpu: &Gpu) -> wgpu::TextureFormat {
    if gpu.is_reduced() {
        wgpu::TextureFormat::R32Uint
    } else {
        FOUND_FORMAT
    }
}

/// [`VISIBILITY_FORMAT`], or likewise its bits.
pub(crate) fn visibility_format(gpu: &Gpu) -> wgpu::TextureFormat {
    if gpu.is_reduced() {
        wgpu::TextureFormat::Rg32Uint
    } else {
        VISIBILITY_FORMAT
    }
}

/// The targets of one frame size.
#[derive(Debug)]
pub(crate) struct AmbientTargets {
    pub(super) found: wgpu::TextureView,
    pub(crate) resolved: wgpu::TextureView,
    /// With coarse shading: the places to look from.
    pub(super) listed: Option<Listed>,
    /// What was resolved is that of a view that has not changed since, at every pixel.
    pub(super) rests: bool,
}

/// Texels to look from, their number, and the dispatch over them.
#[derive(Debug)]
pub(super) struct Listed {
    pub(super) texels: wgpu::Buffer,
    pub(super) counts: wgpu::Buffer,
    pub(super) dispatch: wgpu::Buffer,
}

impl AmbientTargets {
    /// The targets for settings that were found valid, where they ask for some.
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Option<Self> {
        if !settings.occludes_ambient() {
            return None;
        }
        let size = EyeLayout::of(settings).target_size();
        let usage = if gpu.is_reduced() {
            wgpu::TextureUsages::empty()
        } else {
            wgpu::TextureUsages::STORAGE_BINDING
        };
        let target = |label, format| gpu::target(gpu, label, size, format, usage);
        let is_coarse = settings.shading.mode == Shading::Coarse;
        Some(Self {
            found: target("ambient samples", found_format(gpu)),
            resolved: target("ambient visibility", visibility_format(gpu)),
            // Where a list of all pixels does not fit, every pixel is looked at.
            listed: (is_coarse && Listed::fits(gpu, size)).then(|| Listed::new(gpu, size)),
            rests: false,
        })
    }

    /// Bytes of everything.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.found.texture().size();
        let listed = self
            .listed
            .as_ref()
            .map_or(0, |l| l.texels.size() + l.counts.size() + l.dispatch.size());
        u64::from(size.width) * u64::from(size.height) * (4 + 8) + listed
    }
}

impl Listed {
    fn fits(gpu: &Gpu, (width, height): (u32, u32)) -> bool {
        // Places are listed by two numbers of 14 bits.
        let can_be_named = width.max(height) <= 1 << 14;
        can_be_named
            && u64::from(width) * u64::from(height) * 4
                <= gpu.device.limits().max_storage_buffer_binding_size
    }

    fn new(gpu: &Gpu, (width, height): (u32, u32)) -> Self {
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let levels = u64::from(COARSEST_LEVEL) + 1;
        let pixels = u64::from(width) * u64::from(height);
        Self {
            texels: buffer("ambient places", pixels * 4, wgpu::BufferUsages::empty()),
            counts: buffer(
                "ambient count",
                levels * 4,
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            dispatch: buffer(
                "ambient dispatch",
                levels * 16,
                wgpu::BufferUsages::INDIRECT,
            ),
        }
    }
}
