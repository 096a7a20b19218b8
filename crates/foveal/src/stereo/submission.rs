//! How both eyes' geometry gets into the target.

use std::num::NonZeroU32;

use crate::StereoStats;

/// The way in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Submission {
    /// One eye.
    Mono,
    /// Every draw once per eye, each within a scissor, or clipped at the centre besides as
    /// instancing would.
    TwoPass { clips: bool },
    /// Every draw once with twice the instances, clipped at the centre by the rasterizer, or by
    /// discarding.
    Instanced { clips: bool },
    /// Every draw once, to a layer for each eye.
    Multiview,
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
    /// Each once, which the device repeats for each layer.
    ForEachLayer,
}

impl Drawn {
    /// The instance numbers of the instances `first..first + count`.
    pub(crate) fn range(self, first: u32, count: u32) -> std::ops::Range<u32> {
        match self {
            Self::Once | Self::ForEachLayer => first..first + count,
            Self::ForEye(eye) => (first | eye << 31)..((first + count) | eye << 31),
            Self::Twice => 2 * first..2 * (first + count),
        }
    }
}

impl Submission {
    /// The name of the way.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Mono => "once",
            Self::TwoPass { .. } => "two-pass",
            Self::Instanced { clips: true } => "instanced-clip",
            Self::Instanced { clips: false } => "instanced-discard",
            Self::Multiview => "multiview",
        }
    }

    /// The stats' entry of two eyes.
    pub(crate) fn stats(self, reason: &str) -> StereoStats {
        StereoStats {
            mode: self.name().to_owned(),
            reason: reason.to_owned(),
        }
    }

    /// The layers that a pass over geometry draws to at once, where there are several.
    pub(crate) fn multiview_mask(self) -> Option<NonZeroU32> {
        NonZeroU32::new(0b11).filter(|_| self == Self::Multiview)
    }

    /// Whether the rasterizer clips at the centre: shaders then have a plane.
    pub(crate) fn clips(self) -> bool {
        matches!(
            self,
            Self::TwoPass { clips: true } | Self::Instanced { clips: true }
        )
    }

    /// How often each draw is issued.
    pub(crate) fn passes(self) -> u64 {
        1 + u64::from(matches!(self, Self::TwoPass { .. }))
    }

    /// What draws issue, per viewport.
    pub(crate) fn drawn(self) -> &'static [Drawn] {
        match self {
            Self::Mono => &[Drawn::Once],
            Self::TwoPass { .. } => &[Drawn::ForEye(0), Drawn::ForEye(1)],
            Self::Instanced { .. } => &[Drawn::Twice],
            Self::Multiview => &[Drawn::ForEachLayer],
        }
    }

    /// Overrides of `shared/vertex.wgsl`.
    pub(crate) fn constants(self) -> [(&'static str, f64); 2] {
        let eyes = match self {
            Self::Mono | Self::Multiview => 0.0,
            Self::TwoPass { .. } => 1.0,
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
            _ if self.clips() => "vertex_clipped",
            Self::Multiview => "vertex_layered",
            _ => "vertex",
        }
    }
}
