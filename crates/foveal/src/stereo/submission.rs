//! How both eyes' geometry gets into the target.

use std::num::NonZeroU32;

use super::Trials;
use super::trial::Verdict;
use crate::gpu::Gpu;
use crate::{Antialiasing, Clock, Error, EyeClipping, Geometry, Settings, Stereo, StereoStats};

/// The way in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Submission {
    /// One eye.
    Mono,
    /// Every draw once per eye, each within a scissor, or clipped at the middle besides as instancing would.
    TwoPass { clips: bool },
    /// Every draw once with twice the instances, clipped at the middle by the rasterizer, or by discarding.
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
    /// The way that the settings ask for, on this device, and why it is this one.
    ///
    /// # Errors
    /// [`Error::Setting`] where multiview is asked for and the device lacks it or draws it wrong; as [`Trials::of`].
    pub(crate) async fn choose(
        gpu: &Gpu,
        settings: &Settings,
        trials: &mut Trials,
        clock: Option<Clock>,
    ) -> Result<(Self, String), Error> {
        let has_clip = gpu
            .device
            .features()
            .contains(wgpu::Features::CLIP_DISTANCES)
            && !gpu.is_reduced();
        // The visibility buffer's fragments are so small that a plane would save nothing.
        let clips = has_clip
            && settings.stereo.clipping != EyeClipping::Discard
            && settings.geometry.path == Geometry::Gbuffer;
        let instanced = Self::Instanced { clips };
        let lacks = if settings.stereo.clipping == EyeClipping::Clip && !has_clip {
            "; discards, as the device has no clip distances"
        } else {
            ""
        };
        let this = match settings.stereo.mode {
            Stereo::Off => Self::Mono,
            _ if settings.is_seen_alike() => {
                let why = "both eyes see the same: drawn once, shown to both";
                return Ok((Self::Mono, why.to_owned()));
            }
            Stereo::TwoPass => Self::TwoPass {
                // Scissors do without, unless it is to be compared.
                clips: clips && settings.stereo.clipping == EyeClipping::Clip,
            },
            Stereo::Instanced => instanced,
            Stereo::Multiview => {
                Self::check_multiview(gpu, trials, clock).await?;
                Self::Multiview
            }
            Stereo::Auto if gpu.is_reduced() => {
                return Ok((instanced, "the device has no other".to_owned()));
            }
            Stereo::Auto => {
                let mut ways = vec![instanced, Self::TwoPass { clips: false }];
                if gpu.has_multiview() && settings.antialiasing.mode == Antialiasing::None {
                    ways.insert(0, Self::Multiview);
                }
                return Self::fastest(gpu, &ways, trials, clock).await;
            }
        };
        Ok((this, format!("asked for{lacks}")))
    }

    async fn check_multiview(
        gpu: &Gpu,
        trials: &mut Trials,
        clock: Option<Clock>,
    ) -> Result<(), Error> {
        let why = if gpu.has_multiview() {
            let verdict = trials.of(gpu, Self::Multiview, clock).await?;
            if verdict.is_right() {
                return Ok(());
            }
            let (wrong, of) = (verdict.wrong, Verdict::TEXELS);
            format!("the driver draws it wrong: {wrong} of {of} texels of a trial")
        } else {
            "the device does not have it".to_owned()
        };
        Err(Error::Setting {
            name: "stereo",
            value: format!("multiview ({why})"),
            expected: "auto, instanced or two-pass on this device",
        })
    }

    /// Of the ways that are right, the first one that none after it undercuts by a tenth; the first without a clock.
    async fn fastest(
        gpu: &Gpu,
        ways: &[Self],
        trials: &mut Trials,
        clock: Option<Clock>,
    ) -> Result<(Self, String), Error> {
        let (mut right, mut wrong) = (Vec::new(), Vec::new());
        for &way in ways {
            let verdict = trials.of(gpu, way, clock).await?;
            if verdict.is_right() {
                right.push((way, verdict.ms));
            } else {
                let (texels, of) = (verdict.wrong, Verdict::TEXELS);
                wrong.push(format!("{} ({texels} of {of} texels)", way.name()));
            }
        }
        // Fewer draws come first, and a moment's noise does not decide. Two passes are what the others are held to.
        let best = right
            .iter()
            .copied()
            .reduce(|best, way| if way.1 < 0.9 * best.1 { way } else { best });
        let best = best.map_or(Self::TwoPass { clips: false }, |(way, _)| way);
        let times: Vec<String> = right
            .iter()
            .map(|(way, ms)| format!("{} {ms:.2} ms", way.name()))
            .collect();
        let mut why = match clock {
            Some(_) => format!("fastest in a trial: {}", times.join(", ")),
            None => "right in a trial; nothing was timed without a clock".to_owned(),
        };
        if !wrong.is_empty() {
            why += &format!("; wrong: {}", wrong.join(", "));
        }
        Ok((best, why))
    }

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

    /// Whether the rasterizer clips at the middle: shaders then have a plane.
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
