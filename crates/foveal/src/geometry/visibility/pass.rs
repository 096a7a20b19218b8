//! The passes of a visibility buffer.

use super::bins::{BinPass, Bins};
use super::raster::VisiblePass;
use super::resolve::ResolvePass;
use super::targets::{Listed, Rates, ResolveAt};
use crate::geometry::{DrawList, Draws, FaceNormals, GBuffer, Motion, Window};
use crate::gpu::Gpu;
use crate::recorder::Recorder;
use crate::scene::{MaterialDispatch, SceneOnGpu, family_layout};
use crate::stereo::{EyeLayout, Submission};

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
    /// Where materials are resolved at a rate.
    rated: Option<Materials>,
    /// For the further surfaces of pixels at edges.
    further: Option<ResolvePass>,
    pub(super) bins: Bins,
    by: MaterialDispatch,
}

impl VisibilityPass {
    /// `windows`: as many as a frame is drawn into at once, 1 to 8; `black`: surfaces with
    /// lobes are.
    /// `further`: the footprint of a
    /// pixel's textures, in pixels, where [`VisibilityPass::resolve_further`] will be called;
    /// `rates`: materials will be evaluated there.
    pub(crate) fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        (by, material_layout): (MaterialDispatch, &wgpu::BindGroupLayout),
        (face_normals, motion): (FaceNormals, Motion),
        (windows, black): (u32, bool),
        (further, rates): (Option<f64>, Option<Rates>),
        eyes: (Submission, EyeLayout),
    ) -> Self {
        let geometry_layout = crate::scene::geometry_layout(gpu);
        let raster = VisiblePass::new(
            gpu,
            [frame_layout, material_layout, &geometry_layout],
            eyes,
            motion,
        );
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
                    (windows, black),
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
                    (1, black),
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

    /// Encodes the first pass: identity, triangle and depth, for the frame drawn once into each of
    /// `windows`.
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

    /// Encodes the passes after that: from identity and triangle to surfaces, at the pixels of
    /// `at`.
    pub(crate) fn resolve(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
        at: &ResolveAt<'_>,
    ) {
        let materials = match (at.mask, &self.rated) {
            (Some(_), rated) => rated.as_ref(),
            (None, _) => Some(&self.full),
        };
        if let Some(Materials { bin, resolve }) = materials {
            self.resolve_by((bin, resolve), recorder, draws, target, windows, at);
        }
    }

    /// Sorts pixels again, by subgroups or by a hash table.
    #[cfg(test)]
    pub(crate) fn sort_again(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        target: &GBuffer,
        at: &ResolveAt<'_>,
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

    /// The same for a target whose texels lie anywhere in the picture: identity's second word
    /// tells, as `antialias/quarters.wgsl` has it.
    pub(crate) fn resolve_further(
        &self,
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        whole: Window,
    ) {
        if let Some(further) = &self.further {
            let passes = (&self.full.bin, further);
            let at = &ResolveAt::FULL;
            self.resolve_by(passes, recorder, draws, target, &[whole], at);
        }
    }

    fn resolve_by(
        &self,
        (bin, resolve): (&BinPass, &ResolvePass),
        recorder: &mut Recorder<'_>,
        draws: Draws<'_>,
        target: &GBuffer,
        windows: &[Window],
        at: &ResolveAt<'_>,
    ) {
        let Some(visibility) = &target.visibility else {
            return;
        };
        let bins = (&self.bins, self.by);
        bin.sort(recorder, draws.scene, target, visibility, bins, at);
        resolve.draw(recorder, draws, target, visibility, windows, at);
    }
}
