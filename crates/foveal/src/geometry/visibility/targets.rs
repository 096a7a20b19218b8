//! What a visibility buffer holds, and at which pixels its materials are resolved.

use crate::geometry::TRIANGLE_FORMAT;
use crate::gpu::{Gpu, layered_target, layers_of};
use crate::{CoarseSample, Settings, Shading};

/// What a visibility buffer holds besides the G-buffer's identity and depth; 8 bytes a pixel.
#[derive(Debug)]
pub(crate) struct VisibilityTargets {
    /// The triangle's number within its mesh.
    pub(crate) triangle_view: wgpu::TextureView,
    pub(crate) triangle_layers: wgpu::TextureView,
    /// The seen pixels, `x | y << 16`, material by material.
    pub(crate) pixels: wgpu::Buffer,
}

impl VisibilityTargets {
    /// Bytes of both.
    pub(crate) fn bytes(&self) -> u64 {
        2 * self.pixels.size()
    }

    /// `layers` of this size each.
    pub(crate) fn new(gpu: &Gpu, size: (u32, u32), layers: u32) -> Self {
        let none = wgpu::TextureUsages::empty();
        let triangle_view = layered_target(gpu, "triangles", size, layers, TRIANGLE_FORMAT, none);
        Self {
            triangle_layers: layers_of(&triangle_view),
            triangle_view,
            pixels: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("binned pixels"),
                size: u64::from(size.0) * u64::from(size.1) * u64::from(layers) * 4,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        }
    }

    /// The same with another target for triangles.
    pub(crate) fn with_triangles(self, triangle_view: wgpu::TextureView) -> Self {
        Self {
            triangle_layers: layers_of(&triangle_view),
            triangle_view,
            ..self
        }
    }
}

/// At which pixels materials are resolved, and what the passes are timed under.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResolveAt<'a> {
    /// Once per sample of this mask (`shading/variable`), or per tile of these owner levels
    /// (`rate/`); `None`: at every pixel.
    pub(crate) mask: Option<&'a wgpu::TextureView>,
    pub(super) binning_label: &'static str,
    pub(super) material_label: &'static str,
}

impl<'a> ResolveAt<'a> {
    /// At every pixel.
    pub(crate) const FULL: Self = Self {
        mask: None,
        binning_label: "binning",
        material_label: "material",
    };

    /// At every pixel, for comparison alone.
    pub(crate) const COMPARED: Self = Self {
        mask: None,
        binning_label: "full binning",
        material_label: "full material",
    };

    /// Once per sample of a mask, or per tile of owner levels, whichever the pass was made for.
    pub(crate) fn at_rates(mask: &'a wgpu::TextureView) -> Self {
        Self {
            mask: Some(mask),
            ..Self::FULL
        }
    }
}

/// `resources`, and the mask where there is one.
pub(super) fn with_mask<'a>(
    at: &ResolveAt<'a>,
    resources: &[wgpu::BindingResource<'a>],
) -> Vec<wgpu::BindingResource<'a>> {
    let mask = at.mask.map(wgpu::BindingResource::TextureView);
    resources.iter().cloned().chain(mask).collect()
}

/// Where materials may be evaluated other than at every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rates {
    /// At the samples of a mask of rates: each stands for a rectangle of pixels.
    Samples,
    /// Where the tiles of a rate map are sampled.
    Tiles(CoarseSample),
}

/// Which pixels' materials are resolved: a variant of `listed.wgsl`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Listed {
    Every,
    Rated,
    Tiled,
    /// Further surfaces of pixels at edges.
    Further,
}

impl Rates {
    /// What these settings need.
    pub(crate) fn wanted_by(settings: &Settings) -> Option<Self> {
        match settings.shading.mode {
            _ if !settings.stage().has_material() => None,
            Shading::Coarse => Some(Self::Tiles(settings.coarse.sample)),
            _ => Some(Self::Samples),
        }
    }

    pub(super) fn listed(self) -> Listed {
        match self {
            Self::Samples => Listed::Rated,
            Self::Tiles(_) => Listed::Tiled,
        }
    }

    /// Of both shaders.
    pub(super) fn constant(self) -> Option<(&'static str, f64)> {
        match self {
            Self::Samples => None,
            Self::Tiles(sample) => {
                let typical = sample == CoarseSample::Typical;
                Some(("TYPICAL", f64::from(u8::from(typical))))
            }
        }
    }
}
