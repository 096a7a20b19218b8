//! The G-buffer and the pass that fills it.

use super::{
    DrawList, Evaluation, PipelineKey, PipelineRecipe, Pipelines, VertexSource, VisibilityPass,
    VisibilityTargets,
};
use crate::gpu::{self, Gpu};
use crate::recorder::{Recorder, overwritten};
use crate::scene::SceneOnGpu;
use crate::{Antialiasing, EdgeTest, Geometry, SamplePattern, Settings, Shading, shader};

/// Reversed: 1 at the near plane, 0 where nothing is.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub(crate) const SURFACE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
pub(crate) const IDENTITY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// What is seen at each pixel; 28 bytes a pixel.
#[derive(Debug)]
pub(crate) struct GBuffer {
    /// Base colour and occlusion, normal, emissive, metallic and roughness: `pack_surface` in
    /// `shared/surface.wgsl`.
    pub(crate) surface_view: wgpu::TextureView,
    /// Instance number + 1, and motion in pixels as two halves.
    pub(crate) identity_view: wgpu::TextureView,
    /// Reversed depth.
    pub(crate) depth_view: wgpu::TextureView,
    /// Where surfaces are evaluated after the rasterizer.
    pub(crate) visibility: Option<VisibilityTargets>,
}

impl GBuffer {
    pub(crate) fn new(gpu: &Gpu, geometry: Geometry, width: u32, height: u32) -> Self {
        let by_triangles = geometry == Geometry::Visibility;
        let drawn = wgpu::TextureUsages::empty();
        let written = if by_triangles {
            wgpu::TextureUsages::STORAGE_BINDING
        } else {
            drawn
        };
        let target = |label, format, usage| gpu::target(gpu, label, (width, height), format, usage);
        Self {
            surface_view: target("G-buffer surface", SURFACE_FORMAT, written),
            identity_view: target("G-buffer identity", IDENTITY_FORMAT, drawn),
            depth_view: target("G-buffer depth", DEPTH_FORMAT, drawn),
            visibility: by_triangles.then(|| VisibilityTargets::new(gpu, width, height)),
        }
    }
}

/// A part of a G-buffer, and where the frame lies relative to it; all in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Left, top, width, height of the whole frame; it may reach beyond the G-buffer, and fractions of a
    /// texel move the sample positions.
    pub(crate) frame: [f32; 4],
    /// Left, top, width, height of what is drawn.
    pub(crate) part: [u32; 4],
}

impl Window {
    /// The frame fills the target.
    fn whole(target: &GBuffer) -> Self {
        let size = target.depth_view.texture().size();
        Self {
            frame: [0.0, 0.0, size.width as f32, size.height as f32],
            part: [0, 0, size.width, size.height],
        }
    }
}

/// What the geometry pass writes besides the surfaces as they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceNormals {
    Omitted,
    /// The triangles' own normals, for telling planes apart.
    Written,
}

impl FaceNormals {
    /// What these settings need.
    pub(crate) fn wanted_by(settings: &Settings) -> Self {
        match (settings.aa, settings.edge_test) {
            // Triangles are asked for theirs where they matter.
            _ if crate::antialias::by_triangles(settings) => Self::Omitted,
            (Antialiasing::Msaa, EdgeTest::Surface) => Self::Written,
            _ => Self::Omitted,
        }
    }
}

/// Fills the G-buffer with opaque and masked surfaces.
#[derive(Debug)]
pub(crate) enum GeometryPass {
    /// The rasterizer's fragments are surfaces.
    Surfaces(Pipelines),
    /// The rasterizer's fragments are triangles, evaluated afterwards.
    Triangles(Box<VisibilityPass>),
}

impl GeometryPass {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let face_normals = FaceNormals::wanted_by(settings);
        if settings.geometry == Geometry::Visibility {
            // A rotated pattern draws the frame once per sample; there are at most 8.
            let rotated =
                settings.aa != Antialiasing::None && settings.pattern == SamplePattern::Rotated;
            let windows = if rotated { settings.samples } else { 1 };
            let further = crate::antialias::by_triangles(settings);
            let rated = settings.shading == Shading::Variable && settings.rate_stage.has_material();
            return Self::Triangles(Box::new(VisibilityPass::new(
                gpu,
                frame_layout,
                material_layout,
                face_normals,
                windows,
                [further, rated],
            )));
        }
        let face_normal = f64::from(u8::from(face_normals == FaceNormals::Written));
        Self::Surfaces(Pipelines::new(PipelineRecipe {
            label: "geometry",
            module: shader::module(gpu, "geometry", shader::GBUFFER),
            layout: shader::pipeline_layout(gpu, "geometry", &[frame_layout, material_layout]),
            vertex: VertexSource::Buffers("vertex"),
            fragment: "fragment",
            targets: vec![Some(SURFACE_FORMAT.into()), Some(IDENTITY_FORMAT.into())],
            writes_depth: true,
            constants: vec![("FACE_NORMAL", face_normal)],
            has_mask: true,
        }))
    }

    /// Makes the pipelines that `list` needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, scene: &SceneOnGpu, list: &DrawList) {
        match self {
            Self::Surfaces(pipelines) => {
                let mut keys: Vec<PipelineKey> = list.solid.iter().map(|b| b.key).collect();
                keys.dedup();
                for key in keys {
                    pipelines.prepare(gpu, key);
                }
            }
            Self::Triangles(pass) => pass.prepare(gpu, scene, list),
        }
    }

    /// Encodes the pass.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
    ) {
        self.draw_windows(recorder, scene, list, target, &[Window::whole(target)]);
    }

    /// Encodes what of [`GeometryPass::draw`] does not depend on materials; `false` where all of it does.
    pub(crate) fn draw_triangles(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
    ) -> bool {
        let Self::Triangles(pass) = self else {
            return false;
        };
        pass.draw_triangles(recorder, scene, list, target, &[Window::whole(target)]);
        true
    }

    /// Encodes the rest of it.
    pub(crate) fn evaluate(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        at: &Evaluation<'_>,
    ) {
        if let Self::Triangles(pass) = self {
            pass.evaluate_at(recorder, scene, list, target, &[Window::whole(target)], at);
        }
    }

    /// Encodes the pass, drawing the frame once into each of `windows`.
    pub(crate) fn draw_windows(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneOnGpu,
        list: &DrawList,
        target: &GBuffer,
        windows: &[Window],
    ) {
        let pipelines = match self {
            Self::Surfaces(pipelines) => pipelines,
            Self::Triangles(pass) => {
                return pass.draw_windows(recorder, scene, list, target, windows);
            }
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        let colors = [
            overwritten(&target.surface_view),
            overwritten(&target.identity_view),
        ];
        let mut pass = recorder.render_pass("geometry", &colors, Some(depth));
        scene.geometry.bind(&mut pass);
        for &Window { frame, part } in windows {
            pass.set_viewport(frame[0], frame[1], frame[2], frame[3], 0.0, 1.0);
            pass.set_scissor_rect(part[0], part[1], part[2], part[3]);
            DrawList::issue(&list.solid, &mut pass, scene, pipelines);
        }
    }
}
