//! Which way both eyes are submitted.

use super::Submission;
use super::Trials;
use super::trial::Verdict;
use crate::gpu::Gpu;
use crate::{Antialiasing, Clock, Error, EyeClipping, Geometry, Settings, Stereo};

impl Submission {
    /// The way that the settings ask for, on this device, and why it is this one.
    ///
    /// # Errors
    /// [`Error::Setting`] where multiview is asked for and the device lacks it or draws it wrong;
    /// as [`Trials::of`].
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
        let lacks = match settings.stereo.clipping {
            EyeClipping::Clip if !has_clip => "; discards, as the device has no clip distances",
            EyeClipping::Clip if !clips => {
                "; without the plane, which a visibility buffer does not need"
            }
            _ => "",
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

    /// Of the ways that are right, the first one that none after it undercuts by a tenth; the first
    /// without a clock.
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
        // Fewer draws come first, and a moment's noise does not decide. Two passes are what the
        // others are held to.
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
}
