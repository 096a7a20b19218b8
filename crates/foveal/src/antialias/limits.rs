//! Which anti-aliasing settings make sense, and which fit a device.

use super::targets::most_entries;
use crate::stereo::EyeLayout;
use crate::{Antialiasing, DebugView, Error, SamplePattern, Settings};

/// Largest side of a grid.
const MAX_SIDE: u32 = 16;
/// Sub-samples whose surfaces are told apart: a pixel's are the bits of one word, and few are ever
/// needed.
const MAX_MSAA: u32 = 16;

/// Checks the anti-aliasing settings.
///
/// # Errors
/// [`Error::Setting`] and [`Error::Limit`].
pub(crate) fn validate(settings: &Settings, limits: &wgpu::Limits) -> Result<(), Error> {
    if settings.antialiasing.mode == Antialiasing::None {
        return match settings.picture.view {
            DebugView::Edges | DebugView::Samples => Err(Error::Setting {
                name: "view",
                value: "a view of anti-aliasing".to_owned(),
                expected: "another one where aa is none",
            }),
            _ => Ok(()),
        };
    }
    let samples = settings.antialiasing.samples;
    let wrong = |expected| {
        Err(Error::Setting {
            name: "samples",
            value: samples.to_string(),
            expected,
        })
    };
    match settings.antialiasing.pattern {
        SamplePattern::Rotated if samples == 4 || samples == 8 => {
            return fits_buffers(settings, limits);
        }
        SamplePattern::Rotated => return wrong("4 or 8 with the rotated pattern"),
        SamplePattern::Grid => {}
    }
    let side = samples.isqrt();
    if side * side != samples || !(2..=MAX_SIDE).contains(&side) {
        return wrong("a square from 4 to 256 (4, 9, 16, ...) with the grid pattern");
    }
    if settings.antialiasing.mode == Antialiasing::Msaa && samples > MAX_MSAA {
        return wrong("at most 16 with msaa");
    }
    let (width, height) = EyeLayout::of(settings).target_size();
    let longest = u64::from(width.max(height));
    let limit = u64::from(limits.max_texture_dimension_2d);
    if longest * u64::from(side) > limit {
        let fits = (limit / longest).min(u64::from(MAX_SIDE));
        return Err(Error::Limit {
            what: format!("the picture's longer side in sub-samples ({longest} pixels x {side})"),
            value: longest * u64::from(side),
            limit,
            hint: if fits >= 2 {
                format!(
                    ": at this size the device takes samples up to {}",
                    fits * fits
                )
            } else {
                ": at this size the device takes the rotated pattern only".to_owned()
            },
        });
    }
    fits_buffers(settings, limits)
}

/// Shading every sub-sample lists every pixel.
fn fits_buffers(settings: &Settings, limits: &wgpu::Limits) -> Result<(), Error> {
    let (width, height) = EyeLayout::of(settings).target_size();
    let pixels = u64::from(width) * u64::from(height);
    let most = most_entries(limits);
    if settings.antialiasing.mode == Antialiasing::Ssaa && pixels > most {
        return Err(Error::Limit {
            what: "the picture's number of pixels with ssaa".to_owned(),
            value: pixels,
            limit: most,
            hint: ": that is the device's largest storage buffer; msaa takes larger pictures"
                .to_owned(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(settings: &Settings) -> String {
        let limits = wgpu::Limits {
            max_texture_dimension_2d: 16_384,
            max_storage_buffer_binding_size: 1 << 30,
            max_buffer_size: 1 << 30,
            ..wgpu::Limits::default()
        };
        match settings.validate(&limits) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        }
    }

    fn with(aa: Antialiasing, pattern: SamplePattern, samples: u32) -> Settings {
        Settings::default().with(|s| {
            s.antialiasing.mode = aa;
            s.antialiasing.pattern = pattern;
            s.antialiasing.samples = samples;
        })
    }

    #[test]
    fn sample_counts_that_a_pattern_does_not_have_are_refused() {
        use Antialiasing::{Msaa, None, Ssaa};
        use SamplePattern::{Grid, Rotated};
        for (aa, pattern, samples) in [
            (Msaa, Grid, 4),
            (Msaa, Grid, 9),
            (Msaa, Grid, 16),
            (Ssaa, Grid, 64),
            (Msaa, Rotated, 4),
            (Ssaa, Rotated, 8),
            (None, Grid, 5),
        ] {
            assert_eq!(message(&with(aa, pattern, samples)), "");
        }
        for (aa, pattern, samples, says) in [
            (Msaa, Grid, 5, "samples is 5"),
            (Ssaa, Grid, 0, "a square from 4 to 256"),
            (Ssaa, Grid, 1, "a square"),
            (Ssaa, Grid, 289, "a square from 4 to 256"),
            (Ssaa, Grid, u32::MAX, "a square"),
            (Msaa, Grid, 25, "at most 16 with msaa"),
            (Msaa, Rotated, 16, "4 or 8"),
        ] {
            let message = message(&with(aa, pattern, samples));
            assert!(message.contains(says), "{message}");
        }
    }

    #[test]
    fn what_exceeds_the_device_names_the_limit_and_the_largest_that_fits() {
        let settings = with(Antialiasing::Ssaa, SamplePattern::Grid, 256).with(|s| {
            s.picture.width = 7680;
            s.picture.height = 4320;
        });
        let text = message(&settings);
        for part in ["7680 pixels x 16", "122880", "16384", "samples up to 4"] {
            assert!(text.contains(part), "{text}");
        }
        let settings = settings.with(|s| {
            s.picture.width = 10_000;
            s.antialiasing.samples = 4;
        });
        assert!(message(&settings).contains("rotated pattern only"));
    }

    #[test]
    fn ssaa_of_more_pixels_than_a_buffer_holds_is_refused() {
        let settings = Settings::default().with(|s| {
            s.picture.width = 7680;
            s.picture.height = 4320;
            s.antialiasing.mode = Antialiasing::Ssaa;
        });
        // 2 x 2 fits the texture: the buffer is the limit.
        let error = validate(
            &settings,
            &wgpu::Limits {
                max_texture_dimension_2d: 16_384,
                ..wgpu::Limits::default()
            },
        );
        let text = error.unwrap_err().to_string();
        assert!(
            text.contains("33177600") && text.contains("16777216"),
            "{text}"
        );
    }

    #[test]
    fn views_of_antialiasing_need_antialiasing() {
        for view in [DebugView::Edges, DebugView::Samples] {
            let mut settings = Settings::default().with(|s| s.picture.view = view);
            assert!(message(&settings).contains("aa is none"));
            settings.antialiasing.mode = Antialiasing::Msaa;
            assert_eq!(message(&settings), "");
        }
    }
}
