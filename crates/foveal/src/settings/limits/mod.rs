//! Checks of the settings, alone and beside each other, and what follows from them.

mod coarse;
mod eye;
mod reduced;
mod stereo;
mod variable;

use super::{Composite, Geometry, Settings, Shading, Shadows};
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
                return Err(Error::Setting {
                    name,
                    value: "0".to_owned(),
                    expected: "at least 1",
                });
            }
            if value > most {
                return Err(Error::Limit {
                    what: format!("the picture's {name} in pixels"),
                    value: u64::from(value),
                    limit: u64::from(most),
                    hint: String::new(),
                });
            }
        }
        if !self.picture.exposure_stops.is_finite() || self.picture.exposure_stops.abs() > 64.0 {
            let value = self.picture.exposure_stops.to_string();
            return Err(Error::Setting {
                name: "exposure",
                value,
                expected: "between -64 and 64",
            });
        }
        if !(0.5..=1.0).contains(&self.picture.render_scale) {
            return Err(Error::Setting {
                name: "render-scale",
                value: self.picture.render_scale.to_string(),
                expected: "between 0.5 and 1",
            });
        }
        for (name, value) in [
            ("point-size", self.geometry.point_size_px),
            ("line-width", self.geometry.line_width_px),
        ] {
            if !(1.0..=64.0).contains(&value) {
                return Err(Error::Setting {
                    name,
                    value: value.to_string(),
                    expected: "between 1 and 64",
                });
            }
        }
        if !(1..=16).contains(&self.lighting.anisotropy) {
            let value = self.lighting.anisotropy.to_string();
            return Err(Error::Setting {
                name: "anisotropy",
                value,
                expected: "between 1 and 16",
            });
        }
        let atlas = self.lighting.shadow_atlas;
        if !(256..=8192).contains(&atlas) {
            return Err(Error::Setting {
                name: "shadow-atlas",
                value: atlas.to_string(),
                expected: "between 256 and 8192",
            });
        }
        if self.lighting.shadows != Shadows::Off && atlas > most {
            return Err(Error::Limit {
                what: "the side of the shadow atlas in texels".to_owned(),
                value: u64::from(atlas),
                limit: u64::from(most),
                hint: String::new(),
            });
        }
        if !(0.125..=64.0).contains(&self.lighting.shadow_texel_px) {
            return Err(Error::Setting {
                name: "shadow-texel",
                value: self.lighting.shadow_texel_px.to_string(),
                expected: "between 0.125 and 64",
            });
        }
        if !(0.0..=8.0).contains(&self.lighting.shadow_bias) {
            return Err(Error::Setting {
                name: "shadow-bias",
                value: self.lighting.shadow_bias.to_string(),
                expected: "between 0 and 8",
            });
        }
        let lighting = &self.lighting;
        if !(0.0..=100.0).contains(&lighting.light_radius_m) {
            return Err(Error::Setting {
                name: "light-radius",
                value: lighting.light_radius_m.to_string(),
                expected: "between 0 and 100",
            });
        }
        if !(0.0..=90.0).contains(&lighting.sun_angle_deg) {
            return Err(Error::Setting {
                name: "sun-angle",
                value: lighting.sun_angle_deg.to_string(),
                expected: "between 0 and 90",
            });
        }
        if !(0.0..=1e6).contains(&lighting.ambient_occlusion_radius_m) {
            return Err(Error::Setting {
                name: "ambient-occlusion-radius",
                value: lighting.ambient_occlusion_radius_m.to_string(),
                expected: "between 0 and 1000000",
            });
        }
        if !(0.0..=1e4).contains(&lighting.environment_intensity) {
            return Err(Error::Setting {
                name: "environment-intensity",
                value: lighting.environment_intensity.to_string(),
                expected: "between 0 and 10000",
            });
        }
        if !(-360.0..=360.0).contains(&lighting.environment_rotation_deg) {
            return Err(Error::Setting {
                name: "environment-rotation",
                value: lighting.environment_rotation_deg.to_string(),
                expected: "between -360 and 360",
            });
        }
        for (name, value) in [
            ("occluder-size", self.culling.occluder_size),
            ("occludee-size", self.culling.occludee_size),
            ("culling-radius", self.culling.radius_m),
            ("culling-budget", self.culling.budget_ms),
        ] {
            if !(0.0..=1e6).contains(&value) {
                return Err(Error::Setting {
                    name,
                    value: value.to_string(),
                    expected: "between 0 and 1000000",
                });
            }
        }
        for (name, value, range, expected) in [
            (
                "occlusion-scale",
                self.culling.buffer_scale,
                1..=16,
                "between 1 and 16",
            ),
            (
                "culling-threads",
                self.culling.threads,
                0..=32,
                "between 0 and 32",
            ),
        ] {
            if !range.contains(&value) {
                return Err(Error::Setting {
                    name,
                    value: value.to_string(),
                    expected,
                });
            }
        }
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
