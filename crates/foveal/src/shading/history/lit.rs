//! What a frame does with the light history.

use crate::Settings;
use crate::gpu::Gpu;
use crate::stereo::EyeLayout;

/// Frames at rest until each pixel was shaded by itself.
pub(crate) const ROUND: u32 = 16;

/// Whether these settings keep a light history on this device.
pub(super) fn is_used(gpu: &Gpu, settings: &Settings) -> bool {
    settings.keeps_light() && !gpu.is_reduced() && fits(&gpu.device.limits(), settings)
}

/// A sentence where the picture is too large for the light history that these settings ask for;
/// else empty.
pub(super) fn notice(limits: &wgpu::Limits, settings: &Settings) -> String {
    if !settings.keeps_light() || fits(limits, settings) {
        return String::new();
    }
    let pixels = limits.max_storage_buffer_binding_size / SAMPLE_BYTES;
    format!(
        "no light is kept from frame to frame (--history), and every sample is reshaded: this device keeps that of \
         pictures of up to {pixels} pixels, {LARGEST_SIDE} a side"
    )
}

/// What a frame does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lit {
    /// Which of the targets are this frame's.
    pub(super) even: bool,
    /// At rest: whose turn it is.
    pub(super) turn: Option<u32>,
}

/// Texels that a listed sample can name along each side.
const LARGEST_SIDE: u32 = 1 << 14;
/// Bytes of a listed sample.
pub(super) const SAMPLE_BYTES: u64 = 8;

/// Whether the lists of a frame of this size can be bound.
fn fits(limits: &wgpu::Limits, settings: &Settings) -> bool {
    let (width, height) = EyeLayout::of(settings).target_size();
    if width.max(height) > LARGEST_SIDE {
        return false;
    }
    let bytes = u64::from(width) * u64::from(height) * SAMPLE_BYTES;
    bytes <= limits.max_storage_buffer_binding_size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shading;

    #[test]
    fn a_picture_too_large_for_the_device_is_said() {
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: 128 << 20,
            ..wgpu::Limits::default()
        };
        let notice = |width, height, history| {
            let settings = Settings::default().with(|s| {
                (s.picture.width, s.picture.height) = (width, height);
                s.shading.mode = Shading::Coarse;
                s.coarse.history = history;
            });
            notice(&limits, &settings)
        };
        assert_eq!(notice(4096, 4096, true), "");
        assert_eq!(notice(4096, 4097, false), "");
        for (width, height) in [(4096, 4097), (16_385, 16)] {
            let said = notice(width, height, true);
            assert!(said.contains("16777216 pixels, 16384 a side"), "{said}");
        }
    }
}
