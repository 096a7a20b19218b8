//! What the pipelines of the forward pass differ in.

use crate::geometry::{Motion, PipelineKey, PipelineRecipe, Pipelines, Shape, VertexSource};
use crate::gpu::{Gpu, bind_group_layout};
use crate::lights::SceneLights;
use crate::scene::{LobeClass, lobes_layout};
use crate::shading::{RADIANCE_FORMAT, lighting_constants};
use crate::stereo::Submission;
use crate::{Antialiasing, Settings, shader};

/// What a pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Blended,
    LobedOpaque,
    LobedBlended,
    Transmissive,
    /// Opaque or masked points and lines.
    Strokes,
    BlendedStrokes,
    /// The depth of [`Kind::Strokes`] at the picture's own pixels.
    StrokesDepth,
}

impl Kind {
    pub(super) fn of_blended(key: PipelineKey) -> Self {
        if key.shape != Shape::Triangles {
            Self::BlendedStrokes
        } else if key.lobes == LobeClass::default() {
            Self::Blended
        } else {
            Self::LobedBlended
        }
    }

    fn has_lobes(self) -> bool {
        matches!(
            self,
            Self::LobedOpaque | Self::LobedBlended | Self::Transmissive
        )
    }

    fn draws_strokes(self) -> bool {
        matches!(
            self,
            Self::Strokes | Self::BlendedStrokes | Self::StrokesDepth
        )
    }

    fn variant(self, gpu: &Gpu, submission: Submission) -> &'static [&'static str] {
        match (self, submission) {
            (Self::Blended, _) if submission.clips() => &["CLIPPED"],
            (Self::Blended, Submission::Multiview) => &["LAYERED"],
            (Self::Blended, _) if gpu.is_reduced() => &["REDUCED"],
            (Self::Blended, _) => &[],
            (kind, _) if kind.draws_strokes() && submission.clips() => &["STROKES", "CLIPPED"],
            (kind, Submission::Multiview) if kind.draws_strokes() => &["STROKES", "LAYERED"],
            (kind, _) if kind.draws_strokes() && gpu.is_reduced() => &["STROKES", "REDUCED"],
            (kind, _) if kind.draws_strokes() => &["STROKES"],
            (Self::Transmissive, _) if submission.clips() => &["LOBES", "TRANSMISSION", "CLIPPED"],
            (Self::Transmissive, Submission::Multiview) => &["LOBES", "TRANSMISSION", "LAYERED"],
            (Self::Transmissive, _) if gpu.is_reduced() => &["LOBES", "TRANSMISSION", "REDUCED"],
            (Self::Transmissive, _) => &["LOBES", "TRANSMISSION"],
            _ if submission.clips() => &["LOBES", "CLIPPED"],
            (_, Submission::Multiview) => &["LOBES", "LAYERED"],
            _ if gpu.is_reduced() => &["LOBES", "REDUCED"],
            _ => &["LOBES"],
        }
    }
}

/// What all kinds are made from.
#[derive(Debug)]
pub(super) struct Recipes {
    submission: Submission,
    adds_lobes: bool,
    /// What is drawn goes to sub-samples, except what light passes.
    pub(super) is_sampled: bool,
    constants: Vec<(&'static str, f64)>,
    /// Layouts of bind groups 0, 1 and 2.
    pub(super) frame: wgpu::BindGroupLayout,
    /// Of bind group 0 for what light passes: it has no place for another texture.
    open_frame: wgpu::BindGroupLayout,
    material: wgpu::BindGroupLayout,
    pub(super) lights: wgpu::BindGroupLayout,
}

impl Recipes {
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        submission: Submission,
        (frame, open_frame): (&wgpu::BindGroupLayout, &wgpu::BindGroupLayout),
        material: &wgpu::BindGroupLayout,
    ) -> Self {
        let mut constants = lighting_constants(settings);
        constants.extend(submission.constants());
        constants.push(Motion::Omitted.constant());
        let layered = submission == Submission::Multiview;
        constants.push(("LAYERED", f64::from(u8::from(layered))));
        let sampled = settings.antialiasing.mode != Antialiasing::None;
        constants.push(("SAMPLED", f64::from(u8::from(sampled))));
        Self {
            submission,
            adds_lobes: crate::antialias::adds_lobes(settings),
            is_sampled: sampled,
            constants,
            frame: frame.clone(),
            open_frame: open_frame.clone(),
            material: material.clone(),
            lights: bind_group_layout(
                gpu,
                "forward lights",
                wgpu::ShaderStages::FRAGMENT,
                &SceneLights::binding_types(gpu),
            ),
        }
    }

    /// The pipelines of a kind, none of them made yet; `behind`: the layout of bind group 3, for
    /// what light passes.
    pub(super) fn pipelines(
        &self,
        gpu: &Gpu,
        kind: Kind,
        behind: Option<&wgpu::BindGroupLayout>,
    ) -> Pipelines {
        let submission = self.submission;
        let opaque = matches!(
            kind,
            Kind::LobedOpaque | Kind::Transmissive | Kind::Strokes | Kind::StrokesDepth
        );
        let transmissive = kind == Kind::Transmissive;
        let depth_alone = kind == Kind::StrokesDepth;
        let mut constants = self.constants.clone();
        if kind != Kind::Blended {
            constants.push(("OPAQUE", f64::from(u8::from(opaque))));
        }
        if kind.has_lobes() {
            let added = kind == Kind::LobedOpaque && self.adds_lobes;
            constants.push(("ADDED", f64::from(u8::from(added))));
        }
        if transmissive || depth_alone {
            // Drawn to the picture's own texels.
            constants.retain(|(name, _)| *name != "SAMPLED");
        }
        let with_lobes = kind.has_lobes().then(|| lobes_layout(gpu));
        let material = with_lobes.as_ref().unwrap_or(&self.material);
        let frame = if transmissive {
            &self.open_frame
        } else {
            &self.frame
        };
        let mut layouts = vec![frame, material, &self.lights];
        layouts.extend(behind.filter(|_| transmissive));
        let shader = shader::FORWARD_FORWARD.variant(kind.variant(gpu, submission));
        Pipelines::new(PipelineRecipe {
            label: "forward",
            module: shader::module(gpu, "forward", shader),
            layout: gpu.pipeline_layout("forward", &layouts),
            vertex: VertexSource::Buffers(submission.vertex_entry()),
            fragment: "fragment",
            targets: vec![(!depth_alone).then_some(wgpu::ColorTargetState {
                format: RADIANCE_FORMAT,
                blend: (!opaque).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
            writes_depth: transmissive || depth_alone || kind == Kind::Strokes,
            depth_compare: if kind == Kind::LobedOpaque {
                wgpu::CompareFunction::Equal
            } else {
                wgpu::CompareFunction::Greater
            },
            constants,
            has_mask: transmissive || kind.draws_strokes(),
            multiview_mask: submission.multiview_mask(),
        })
    }
}
