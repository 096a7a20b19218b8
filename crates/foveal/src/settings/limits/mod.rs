//! Checks of the settings, alone and beside each other, and what follows from them.

mod coarse;
mod eye;
mod reduced;
mod refusal;
mod stereo;
mod variable;

use self::refusal::{check_limit, within, wrong};
use super::{Composite, CullingSettings, Geometry, LightingSettings, Settings, Shading, Shadows};
use crate::Error;
use crate::stereo::EyeLayout;

impl Settings {
    /// Checks that the settings make sense and that a device with these limits can draw them.
    ///
    /// # Errors
    /// [`Error::Setting`] for a value that makes no sense, alone or beside the others;
    /// [`Error::Limit`] for one that the device cannot draw.
    pub fn validate(&self, limits: &wgpu::Limits) -> Result<(), Error> {
        let most = limits.max_texture_dimension_2d;
        for (name, value) in [
            ("width", self.picture.width),
            ("height", self.picture.height),
        ] {
            if value == 0 {
                return wrong(name, value, "at least 1");
            }
            check_limit(format!("the picture's {name} in pixels"), value, most)?;
        }
        let stops = self.picture.exposure_stops;
        within("exposure", stops, -64.0..=64.0, "between -64 and 64")?;
        let scale = self.picture.render_scale;
        within("render-scale", scale, 0.5..=1.0, "between 0.5 and 1")?;
        for (name, value) in [
            ("point-size", self.geometry.point_size_px),
            ("line-width", self.geometry.line_width_px),
        ] {
            within(name, value, 1.0..=64.0, "between 1 and 64")?;
        }
        self.lighting.validate(most)?;
        self.culling.validate()?;
        if crate::gpu::is_reduced(limits) {
            reduced::validate(self)?;
        }
        coarse::validate(self)?;
        eye::validate(self)?;
        variable::validate(self)?;
        stereo::validate(self, limits)?;
        let drawn = self.drawn();
        drawn.check_lists(limits)?;
        if self.shading.mode == Shading::Coarse && self.coarse.composite == Composite::Smooth {
            crate::composite::check_limits(&drawn, limits)?;
        }
        crate::antialias::validate(&drawn, limits)
    }

    /// Whether a buffer holds a number for each pixel, where pixels are listed, at the size at which
    /// the frame is drawn.
    fn check_lists(&self, limits: &wgpu::Limits) -> Result<(), Error> {
        let lists_pixels =
            self.shading.mode != Shading::Full || self.geometry.path == Geometry::Visibility;
        let (width, height) = EyeLayout::of(self).target_size();
        let pixels = u64::from(width) * u64::from(height);
        let most = limits.max_storage_buffer_binding_size / 4;
        if lists_pixels && pixels > most && !crate::gpu::is_reduced(limits) {
            return Err(Error::Limit {
                what:
                    "the pixels of a picture with a visibility buffer, or with coarse or variable \
                       shading"
                        .to_owned(),
                value: pixels,
                limit: most,
                hint: String::new(),
            });
        }
        Ok(())
    }
}

impl LightingSettings {
    /// `most`: the largest side of a texture, in texels.
    fn validate(&self, most: u32) -> Result<(), Error> {
        within("anisotropy", self.anisotropy, 1..=16, "between 1 and 16")?;
        let atlas = self.shadow_atlas;
        within("shadow-atlas", atlas, 256..=8192, "between 256 and 8192")?;
        if self.shadows != Shadows::Off {
            let what = "the side of the shadow atlas in texels".to_owned();
            check_limit(what, atlas, most)?;
        }
        for (name, value, range, expected) in [
            (
                "shadow-texel",
                self.shadow_texel_px,
                0.125..=64.0,
                "between 0.125 and 64",
            ),
            (
                "shadow-bias",
                self.shadow_bias,
                0.0..=8.0,
                "between 0 and 8",
            ),
            (
                "light-radius",
                self.light_radius_m,
                0.0..=100.0,
                "between 0 and 100",
            ),
            (
                "sun-angle",
                self.sun_angle_deg,
                0.0..=90.0,
                "between 0 and 90",
            ),
            (
                "ambient-occlusion-radius",
                self.ambient_occlusion_radius_m,
                0.0..=1e6,
                "between 0 and 1000000",
            ),
            (
                "environment-intensity",
                self.environment_intensity,
                0.0..=1e4,
                "between 0 and 10000",
            ),
            (
                "environment-rotation",
                self.environment_rotation_deg,
                -360.0..=360.0,
                "between -360 and 360",
            ),
        ] {
            within(name, value, range, expected)?;
        }
        Ok(())
    }
}

impl CullingSettings {
    fn validate(&self) -> Result<(), Error> {
        for (name, value) in [
            ("occluder-size", self.occluder_size),
            ("occludee-size", self.occludee_size),
            ("culling-radius", self.radius_m),
            ("culling-budget", self.budget_ms),
        ] {
            within(name, value, 0.0..=1e6, "between 0 and 1000000")?;
        }
        let scale = self.buffer_scale;
        within("occlusion-scale", scale, 1..=16, "between 1 and 16")?;
        within("culling-threads", self.threads, 0..=32, "between 0 and 32")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Antialiasing, Output, Stereo};

    #[test]
    fn targets_must_fit_at_the_size_at_which_the_frame_is_drawn() {
        let limits = wgpu::Limits::default();
        assert_eq!(limits.max_texture_dimension_2d, 8192);
        let changes: [fn(&mut Settings); 4] = [
            |s| {
                s.picture.width = 8192;
                s.antialiasing.mode = Antialiasing::Msaa;
            },
            |s| {
                s.picture.width = 4096;
                s.stereo.mode = Stereo::TwoPass;
                s.stereo.output = Output::SideBySide;
                s.antialiasing.mode = Antialiasing::Ssaa;
            },
            |s| {
                s.picture.width = 8192;
                s.stereo.mode = Stereo::TwoPass;
            },
            |s| {
                (s.picture.width, s.picture.height) = (4096, 3584);
                s.shading.mode = Shading::Coarse;
                s.coarse.composite = Composite::Smooth;
            },
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let at = |scale| {
                let settings = Settings::default().with(change);
                settings.with(|s| s.picture.render_scale = scale)
            };
            assert!(at(1.0).validate(&limits).is_err(), "case {number}");
            let half = at(0.5).validate(&limits);
            half.unwrap_or_else(|cause| panic!("case {number}: {cause}"));
        }
        // What is shown must fit too.
        let shown = Settings::default().with(|s| {
            s.picture.width = 4097;
            s.picture.render_scale = 0.5;
            s.stereo.mode = Stereo::TwoPass;
            s.stereo.output = Output::SideBySide;
        });
        let cause = shown
            .validate(&limits)
            .expect_err("8194 pixels side by side");
        assert!(cause.to_string().contains("side by side"), "{cause}");
    }
}
