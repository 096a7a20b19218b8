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

/// Above all numbers of instances, and low enough for devices with multiview: what they take as a
/// number is below 2^27 (Vulkan, `maxMultiviewInstanceIndex`), and validation layers hold every draw
/// to that. `EYE_BIT` in `shared/vertex.wgsl` and `stereo/trial.wgsl`.
const EYE_BIT: u32 = 26;

/// Which instances a draw issues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawn {
    /// Each once.
    Once,
    /// Each for this eye: [`EYE_BIT`] of the number tells the shader.
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
            Self::ForEye(eye) => (first | eye << EYE_BIT)..((first + count) | eye << EYE_BIT),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_instances_are_below_what_multiview_allows() {
        // As many instances of 96 bytes as fit a binding of 4 GiB.
        let most = u32::MAX / 96;
        for eye in [0, 1] {
            let range = Drawn::ForEye(eye).range(most - 3, 3);
            assert!(range.end < 1 << 27 && range.len() == 3, "{range:?}");
            assert_eq!(range.start >> EYE_BIT, eye);
        }
        assert!(Drawn::Twice.range(most - 3, 3).end < 1 << 27);
    }

    #[test]
    fn shaders_look_for_the_eye_at_the_same_bit() {
        let line = format!("const EYE_BIT: u32 = {EYE_BIT}u;");
        let shaders = [
            include_str!("../shared/vertex.wgsl"),
            include_str!("trial.wgsl"),
        ];
        assert!(shaders.iter().all(|text| text.contains(&line)));
    }
}
