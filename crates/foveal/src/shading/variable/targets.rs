//! What variable shading keeps and writes.

use crate::Contrast;
use crate::gpu::{self, Gpu};
use crate::output::PICTURE_FORMAT;
use crate::stereo::EyeLayout;
use crate::{DebugView, Settings};

/// What is known of a quad: `reproject.wgsl`.
pub(super) const KNOWN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// A quad's rate: `rates.wgsl`.
pub(super) const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Bytes of `Listed` in `mask.wgsl`.
const LISTED_BYTES: u64 = 64;

/// The targets of one frame size.
#[derive(Debug)]
pub(crate) struct VariableTargets {
    /// What is known of each quad: of even and of odd frames.
    pub(super) known: [wgpu::TextureView; 2],
    /// The same between reprojection and mask, where these are two passes.
    pub(super) reprojected: Option<wgpu::TextureView>,
    /// Each quad's rate.
    pub(crate) mask: wgpu::TextureView,
    /// The samples, packed as in `rates.wgsl`.
    pub(super) samples: wgpu::Buffer,
    /// The dispatch that covers them, and their numbers.
    pub(crate) listed: wgpu::Buffer,
    /// The finished frame, where the picture shows rates over it.
    pub(crate) finished: Option<wgpu::TextureView>,
    bytes: u64,
}

impl VariableTargets {
    pub(crate) fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let size = EyeLayout::of(settings).target_size();
        let quads = (size.0.div_ceil(2), size.1.div_ceil(2));
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let known = |label| gpu::target(gpu, label, quads, KNOWN_FORMAT, written);
        let pixels = u64::from(size.0) * u64::from(size.1);
        let buffer = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage
                    | wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let shows_rates = matches!(
            settings.picture.view,
            DebugView::Rate | DebugView::Shaded | DebugView::Unknown
        );
        let finished = shows_rates.then(|| {
            let none = wgpu::TextureUsages::empty();
            gpu::target(gpu, "finished frame", size, PICTURE_FORMAT, none)
        });
        let reprojected = looks_around(settings).then(|| known("known of quads, reprojected"));
        let histories = 2 + u64::from(reprojected.is_some());
        let quads_bytes = u64::from(quads.0) * u64::from(quads.1) * (histories * 8 + 4);
        Self {
            known: [known("known of quads, even"), known("known of quads, odd")],
            reprojected,
            mask: gpu::target(gpu, "rate mask", quads, MASK_FORMAT, written),
            samples: buffer("rate samples", pixels * 4, wgpu::BufferUsages::empty()),
            listed: buffer("listed samples", LISTED_BYTES, wgpu::BufferUsages::INDIRECT),
            bytes: quads_bytes + pixels * (4 + 4 * u64::from(finished.is_some())),
            finished,
        }
    }

    /// Bytes of all of them.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Whether contrast is looked for beyond the quad.
pub(super) fn looks_around(s: &Settings) -> bool {
    s.variable.contrast != Contrast::Quad
}
