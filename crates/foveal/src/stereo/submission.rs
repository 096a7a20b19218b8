//! How both eyes' geometry gets into the target.

use crate::gpu::Gpu;
use crate::{EyeClipping, Geometry, Settings, Stereo, StereoStats};

/// The way in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Submission {
    /// One eye.
    Mono,
    /// Every draw once per eye, each within a scissor.
    TwoPass,
    /// Every draw once with twice the instances, clipped at the middle by the rasterizer, or by discarding.
    Instanced { clips: bool },
}

/// Which instances a draw issues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawn {
    /// Each once.
    Once,
    /// Each for this eye: the number's highest bit tells the shader.
    ForEye(u32),
    /// Each twice, the eyes in turn.
    Twice,
}

impl Drawn {
    /// The instance numbers of the instances `first..first + count`.
    pub(crate) fn range(self, first: u32, count: u32) -> std::ops::Range<u32> {
        match self {
            Self::Once => first..first + count,
            Self::ForEye(eye) => (first | eye << 31)..((first + count) | eye << 31),
            Self::Twice => 2 * first..2 * (first + count),
        }
    }
}

impl Submission {
    /// The way that the settings ask for, on this device, and why it is this one.
    pub(crate) fn choose(gpu: &Gpu, settings: &Settings) -> (Self, String) {
        let has_clip = gpu
            .device
            .features()
            .contains(wgpu::Features::CLIP_DISTANCES);
        // The visibility buffer's fragments are so small that a plane would save nothing.
        let clips = has_clip
            && settings.eye_clipping != EyeClipping::Discard
            && settings.geometry == Geometry::Gbuffer;
        let asked = match settings.stereo {
            Stereo::Auto => "works everywhere",
            _ => "asked for",
        };
        let lacks = if settings.eye_clipping == EyeClipping::Clip && !has_clip {
            "; discards, as the device has no clip distances"
        } else {
            ""
        };
        let this = match settings.stereo {
            Stereo::Off => Self::Mono,
            Stereo::TwoPass => Self::TwoPass,
            Stereo::Auto | Stereo::Instanced => Self::Instanced { clips },
        };
        (this, format!("{asked}{lacks}"))
    }

    /// The stats' entry; none with one eye.
    pub(crate) fn stats(self, reason: &str) -> Option<StereoStats> {
        let mode = match self {
            Self::Mono => return None,
            Self::TwoPass => "two-pass",
            Self::Instanced { clips: true } => "instanced-clip",
            Self::Instanced { clips: false } => "instanced-discard",
        };
        Some(StereoStats {
            mode: mode.to_owned(),
            reason: reason.to_owned(),
        })
    }

    /// How often each draw is issued.
    pub(crate) fn passes(self) -> u64 {
        1 + u64::from(self == Self::TwoPass)
    }

    /// What draws issue, per viewport.
    pub(crate) fn drawn(self) -> &'static [Drawn] {
        match self {
            Self::Mono => &[Drawn::Once],
            Self::TwoPass => &[Drawn::ForEye(0), Drawn::ForEye(1)],
            Self::Instanced { .. } => &[Drawn::Twice],
        }
    }

    /// Overrides of `shared/vertex.wgsl`.
    pub(crate) fn constants(self) -> [(&'static str, f64); 2] {
        let eyes = match self {
            Self::Mono => 0.0,
            Self::TwoPass => 1.0,
            Self::Instanced { .. } => 2.0,
        };
        let discards = self == Self::Instanced { clips: false };
        [
            ("EYES", eyes),
            ("DISCARD_BEYOND", f64::from(u8::from(discards))),
        ]
    }

    /// The shaders' vertex entry point.
    pub(crate) fn vertex_entry(self) -> &'static str {
        match self {
            Self::Instanced { clips: true } => "vertex_clipped",
            _ => "vertex",
        }
    }
}
