//! Coarse shading by either backend.

use super::levels::needs_lists;
use super::{
    BackendChoice, CoarseTargets, ComputeBackend, CountPass, StencilBackend, TileListing,
    UsedBackend,
};

use crate::composite::LightTargets;
use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::{CoarseBackend, CoarseStats, Composite, Settings, Timing, shader};

/// Shades the tiles of a rate map.
#[derive(Debug)]
pub(crate) struct CoarseShading {
    stencil: Option<StencilBackend>,
    compute: Option<ComputeBackend>,
    /// For the compute backend and for the smooth composite.
    listing: Option<TileListing>,
    count: CountPass,
    /// The smooth composite needs lists, whatever the backend.
    composite: Composite,
    choice: BackendChoice,
}

impl CoarseShading {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        input_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let shaders = if settings.coarse.composite == Composite::Light {
            [
                shader::SHADING_COARSE_SHADE_DRAW.variant(&["LIGHT"]),
                shader::SHADING_COARSE_SHADE_LIST.variant(&["LIGHT"]),
            ]
        } else {
            [
                shader::SHADING_COARSE_SHADE_DRAW,
                shader::SHADING_COARSE_SHADE_LIST,
            ]
        };
        Self::with_shaders(gpu, settings, frame_layout, input_layout, shaders)
    }

    /// With other shaders for the draw and the list than those that light surfaces.
    pub(crate) fn with_shaders(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        input_layout: &wgpu::BindGroupLayout,
        [draw, list]: [shader::Shader; 2],
    ) -> Self {
        let backend = settings.coarse.backend;
        // Pixels that no sample speaks for come in a list, whatever the backend.
        let lists_pixels = settings.coarse.composite == Composite::Light;
        Self {
            stencil: (backend != CoarseBackend::Compute)
                .then(|| StencilBackend::new(gpu, settings, frame_layout, input_layout, draw)),
            compute: (backend != CoarseBackend::Stencil || lists_pixels)
                .then(|| ComputeBackend::new(gpu, settings, frame_layout, input_layout, list)),
            listing: needs_lists(settings).then(|| TileListing::new(gpu, settings, frame_layout)),
            count: CountPass::new(gpu, settings, frame_layout),
            composite: settings.coarse.composite,
            choice: BackendChoice::new(backend, gpu),
        }
    }

    /// Encodes the passes: shades the tiles of `target.rate` into `target.samples`, and counts them
    /// into `target.counts`.
    pub(crate) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        target: &CoarseTargets,
    ) {
        // `new` makes the backends that the choice can fall on.
        let compute = match self.choice.now() {
            UsedBackend::Compute => self.compute.as_ref(),
            UsedBackend::Stencil => None,
        };
        let needs_lists = compute.is_some() || self.composite == Composite::Smooth;
        match &self.listing {
            Some(listing) if needs_lists => listing.list(recorder, target),
            _ => self.count.draw(recorder, target),
        }
        if let Some(compute) = compute {
            compute.shade(recorder, input, target);
        } else if let Some(stencil) = &self.stencil {
            stencil.shade(recorder, input, target);
        }
    }

    /// Encodes the shading of the pixels that no sample of `light` speaks for into `radiance`.
    pub(crate) fn shade_unlit(
        &self,
        recorder: &mut Recorder<'_>,
        input: &wgpu::BindGroup,
        light: &LightTargets,
        radiance: &wgpu::TextureView,
    ) {
        if let Some(compute) = &self.compute {
            compute.shade_unlit(recorder, input, light, radiance);
        }
    }

    /// Has the backend chosen again, where it was chosen by its time.
    pub(crate) fn choose_again(&mut self) {
        self.choice.start_again();
    }

    /// Whether the backend is no longer being chosen.
    pub(crate) fn has_chosen(&self) -> bool {
        self.choice.is_made()
    }

    /// The last frame's stats, for the `tiles` of each level and the pixels that none speaks for;
    /// lets the choice of the backend know how long the passes took.
    pub(crate) fn stats(
        &mut self,
        tiles: Vec<u64>,
        unlit: u64,
        pixels: u64,
        gpu_ms: &[Timing],
    ) -> CoarseStats {
        let shading_ms = gpu_ms
            .iter()
            .filter(|t| matches!(t.name.as_str(), "shading" | "tile listing"))
            .map(|t| t.ms)
            .sum();
        let stats = CoarseStats {
            shaded_fraction: (tiles.iter().sum::<u64>() + unlit) as f64 / pixels as f64,
            samples_per_level: tiles,
            unlit_pixels: unlit,
            backend: self.choice.now().name().to_owned(),
            backend_reason: self.choice.reason(),
            active: true,
            ..CoarseStats::default()
        };
        self.choice.observe(shading_ms);
        stats
    }
}
