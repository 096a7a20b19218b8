//! Geometry by a visibility buffer: the rasterizer says which triangle is seen at each pixel, and materials are
//! evaluated afterwards, once per pixel, whatever the overdraw.
//!
//! After Burns and Hunt 2013, 'The visibility buffer'. Passes: [`VisiblePass`] draws instance, motion, triangle and
//! depth; [`BinPass`] sorts the seen pixels by material; [`ResolvePass`] evaluates each material at its pixels, with
//! analytic barycentric coordinates and derivatives (`shared/attributes.wgsl`), and writes the surfaces of the
//! ordinary G-buffer, so that every later stage sees an ordinary G-buffer. There is one indirect dispatch for each
//! family of materials (`scene/families.rs`), whose bins lie side by side.

mod bins;
#[cfg(test)]
mod bins_twin;
#[cfg(test)]
mod dispatches;
mod raster;
mod resolve;
#[cfg(test)]
mod tests;

use super::{DrawList, Draws, FaceNormals, GBuffer, Window};
use crate::gpu::{Gpu, layered_target, layers_of};
use crate::recorder::Recorder;
use crate::scene::{MaterialDispatch, SceneOnGpu, family_layout};
use crate::stereo::{EyeLayout, Submission};
use crate::{CoarseSample, Settings, Shading};
use bins::{BinPass, Bins};
use raster::VisiblePass;
use resolve::ResolvePass;
#[cfg(test)]
pub(crate) use resolve::WindowsUniform;
#[cfg(test)]
pub(crate) use tests::level_scene;

pub(crate) const TRIANGLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

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

/// At which pixels materials are evaluated, and what the passes are timed under.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evaluation<'a> {
    /// Once per sample of this mask (`shading/variable`), or per tile of these owner levels (`rate/`); `None`: at every
    /// pixel.
    pub(crate) mask: Option<&'a wgpu::TextureView>,
    binning_label: &'static str,
    material_label: &'static str,
}

impl<'a> Evaluation<'a> {
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
fn with_mask<'a>(
    at: &Evaluation<'a>,
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

/// Which pixels' materials are evaluated: a variant of `listed.wgsl`.
#[derive(Clone, Copy, Debug)]
enum Listed {
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

    fn listed(self) -> Listed {
        match self {
            Self::Samples => Listed::Rated,
            Self::Tiles(_) => Listed::Tiled,
        }
    }

    /// Of both shaders.
    fn constant(self) -> Option<(&'static str, f64)> {
        match self {
            Self::Samples => None,
            Self::Tiles(sample) => {
                let typical = sample == CoarseSample::Typical;
                Some(("TYPICAL", f64::from(u8::from(typical))))
            }
        }
    }
}

/// Sorts and evaluates.
#[derive(Debug)]
struct Materials {
    bin: BinPass,
    resolve: ResolvePass,
}

/// Draws triangles, and evaluates their materials afterwards.
#[derive(Debug)]
pub(crate) struct VisibilityPass {
    raster: VisiblePass,
    full: Materials,
    /// Where materials are evaluated at a rate.
    rated: Option<Materials>,
    /// For the further surfaces of pixels at edges.
    further: Option<ResolvePass>,
    bins: Bins,
    by: MaterialDispatch,
}

impl VisibilityPass {
    /// `windows`: as many as a frame is drawn into at once, 1 to 8. `further`: the footprint of a pixel's textures, in
    /// pixels, where [`VisibilityPass::evaluate_further`] will be called; `rates`: materials will be evaluated there.
    pub(crate) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        (by, material_layout): (MaterialDispatch, &wgpu::BindGroupLayout),
        face_normals: FaceNormals,
        windows: u32,
        (further, rates): (Option<f64>, Option<Rates>),
        eyes: (Submission, EyeLayout),
    ) -> Self {
        let geometry_layout = crate::scene::geometry_layout(gpu);
        let raster = VisiblePass::new(gpu, frame_layout, material_layout, &geometry_layout, eyes);
        let family_layout = family_layout(gpu);
        let layout = match by {
            MaterialDispatch::Family => &family_layout,
            MaterialDispatch::Material => material_layout,
        };
        let layouts = [frame_layout, layout, &geometry_layout];
        let materials = |rates: Option<Rates>| {
            let listed = rates.map_or(Listed::Every, Rates::listed);
            Materials {
                bin: BinPass::new(gpu, frame_layout, rates),
                resolve: ResolvePass::new(
                    gpu,
                    (listed, by),
                    layouts,
                    face_normals,
                    windows,
                    further.unwrap_or(1.0),
                    rates,
                ),
            }
        };
        let none = FaceNormals::Omitted;
        Self {
            raster,
            full: materials(None),
            rated: rates.map(|rates| materials(Some(rates))),
            further: further.map(|footprint| {
                ResolvePass::new(
                    gpu,
                    (Listed::Further, by),
                    layouts,
                    none,
                    1,
                    footprint,
                    None,
                )
            }),
            bins: Bins::new(gpu, 1),
            by,
        }
    }

    /// Takes over another size of the picture.
    pub(crate) fn resize(&mut self, layout: EyeLayout) {
        self.raster.resize(layout);
    }

    /// Makes the pipelines and the bins that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, scene: &SceneOnGpu, list: &DrawList) {
        self.raster.prepare(gpu, list);
        for batch in &list.solid {
            self.full.resolve.prepare(gpu, batch.key.class);
            if let Some(rated) = &mut self.rated {
                rated.resolve.prepare(gpu, batch.key.class);
            }
            if let Some(further) = &mut self.further {
                further.prepare(gpu, batch.key.class);
            }
        }
        let materials = scene.stats.materials as u32;
        if materials > self.bins.count() {
            self.bins = Bins::new(gpu, materials);
        }
    }

    /// Encodes the first pass: identity, triangle and depth, for the frame drawn once into each of `windows`.
    pub(crate) fn draw_triangles(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
    ) {
        // Targets and passes are made for the same settings.
        if let Some(visibility) = &target.visibility {
            self.raster
                .draw(recorder, draws, target, visibility, windows);
        }
    }

    /// Encodes the passes after that: from identity and triangle to surfaces, at the pixels of `at`.
    pub(crate) fn evaluate(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
        at: &Evaluation<'_>,
    ) {
        let materials = match (at.mask, &self.rated) {
            (Some(_), rated) => rated.as_ref(),
            (None, _) => Some(&self.full),
        };
        if let Some(Materials { bin, resolve }) = materials {
            self.evaluate_by((bin, resolve), recorder, draws, target, windows, at);
        }
    }

    /// Sorts pixels again, by subgroups or by a hash table.
    #[cfg(test)]
    pub(crate) fn sort_again(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        target: &GBuffer,
        at: &Evaluation<'_>,
        subgroups: bool,
    ) {
        let rates = at.mask.map(|_| Rates::Samples);
        let layout = recorder.frame.layout();
        let pass = BinPass::with(recorder.gpu, layout, rates, subgroups);
        if let Some(visibility) = &target.visibility {
            let bins = (&self.bins, self.by);
            pass.sort(recorder, scene, target, visibility, bins, at);
        }
    }

    /// The same for a target whose texels lie anywhere in the picture: identity's second word tells, as
    /// `antialias/quarters.wgsl` has it.
    pub(crate) fn evaluate_further(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        whole: Window,
    ) {
        if let Some(further) = &self.further {
            let passes = (&self.full.bin, further);
            let at = &Evaluation::FULL;
            self.evaluate_by(passes, recorder, draws, target, &[whole], at);
        }
    }

    fn evaluate_by(
        &self,
        (bin, resolve): (&BinPass, &ResolvePass),
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
        at: &Evaluation<'_>,
    ) {
        let Some(visibility) = &target.visibility else {
            return;
        };
        let bins = (&self.bins, self.by);
        bin.sort(recorder, draws.scene, target, visibility, bins, at);
        resolve.draw(recorder, draws, target, visibility, windows, at);
    }
}
