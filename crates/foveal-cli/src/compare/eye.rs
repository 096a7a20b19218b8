//! The difference that an eye sees which looks at one point of a display: FovVideoVDP, in JOD.

use std::path::{Path, PathBuf};

use foveal_vdp::{Display, Gaze, HeatMap, Metric};
use serde::Serialize;

use foveal_host::difference::{magma, pixels};
use foveal_host::picture::{self, Picture};
use foveal_host::values;

/// JOD at which the heat map is brightest.
const BRIGHTEST_JOD: f32 = 8.0;

/// How the pictures are looked at.
#[derive(Debug, clap::Args)]
pub(super) struct EyeArgs {
    /// Display that the pictures fill; adds the quality in JOD at the gaze. hmd (one eye of a
    /// headset, 91.5 degrees across), h60 (60 degrees across), fhd and fhd-24 (a 24-inch monitor at
    /// 0.6 m), uhd-27, quest-3, vision-pro, phone, degrees across, or WIDTHxDISTANCE in metres
    #[arg(long, value_name = "WHICH", value_parser = display, help_heading = "Eye")]
    display: Option<Display>,

    /// Luminance of the display's white in cd/m²
    #[arg(long, value_name = "CD", value_parser = values::positive, help_heading = "Eye")]
    peak: Option<f32>,

    /// Ambient light on the display in lux
    #[arg(long, value_name = "LUX", value_parser = values::non_negative, help_heading = "Eye")]
    ambient: Option<f32>,

    /// Gaze as fractions of the picture from its top left corner [default: 0.5,0.5]
    #[arg(long, value_name = "X,Y", value_parser = values::vec2, help_heading = "Eye")]
    #[arg(allow_hyphen_values = true)]
    gaze: Option<[f32; 2]>,

    /// Frames per second of a video, which is a folder, 5 to 1000 [default: 30]
    #[arg(long, value_name = "N", value_parser = values::metric_rate, help_heading = "Eye")]
    pub(super) fps: Option<f32>,

    /// Write a map of visible differences: black for none, through magenta to yellow for 8 JOD lost
    /// and more
    #[arg(long, value_name = "FILE.png", help_heading = "Eye")]
    heat_map: Option<PathBuf>,
}

/// What an eye sees at a display.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Verdict {
    /// 10: no visible difference; 9: three quarters of observers take the reference for the better
    /// one.
    pub(super) jod: f32,
    /// In the display's middle.
    pub(super) pixels_per_degree: f32,
    /// As fractions of the picture.
    pub(super) gaze: [f32; 2],
    /// What the picture fills.
    pub(super) display: Seen,
}

/// A display with its light, whatever name it was asked for by.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Seen {
    degrees_across: f32,
    /// Luminance of white without reflected light, and by that of black.
    peak_cd_m2: f32,
    contrast: f32,
    ambient_lux: f32,
    /// The part of that light which is reflected.
    reflectivity: f32,
}

impl From<&Display> for Seen {
    fn from(display: &Display) -> Self {
        Self {
            degrees_across: display.degrees_across(),
            peak_cd_m2: display.peak,
            contrast: display.contrast,
            ambient_lux: display.ambient_lux,
            reflectivity: display.reflectivity,
        }
    }
}

impl EyeArgs {
    /// The display that was asked for; `wanted` asks for `h60` where none was named.
    pub(super) fn display(&self, wanted: bool) -> Option<Display> {
        let changed = self.peak.is_some()
            || self.ambient.is_some()
            || self.gaze.is_some()
            || self.heat_map.is_some();
        let base = self
            .display
            .or_else(|| (wanted || changed).then_some(Display::DEGREES_60))?;
        Some(Display {
            peak: self.peak.unwrap_or(base.peak),
            ambient_lux: self.ambient.unwrap_or(base.ambient_lux),
            ..base
        })
    }

    /// Where the eye looks.
    fn gaze(&self) -> [f32; 2] {
        self.gaze.unwrap_or([0.5, 0.5])
    }

    /// The file for the heat map.
    pub(super) fn heat_map(&self) -> Option<&Path> {
        self.heat_map.as_deref()
    }

    /// The metric for pictures of one size.
    pub(super) fn metric(&self, display: &Display, picture: &Picture) -> anyhow::Result<Metric> {
        let [x, y] = self.gaze();
        let (width, height) = (picture.width as usize, picture.height as usize);
        Ok(Metric::new(display, width, height, Gaze { x, y })?)
    }

    /// What is said of a quality.
    pub(super) fn verdict(&self, display: &Display, metric: &Metric, jod: f32) -> Verdict {
        Verdict {
            jod,
            pixels_per_degree: metric.pixels_per_degree(),
            gaze: self.gaze(),
            display: display.into(),
        }
    }

    /// Compares two pictures and writes the heat map.
    pub(super) fn compare(
        &self,
        display: &Display,
        a: &Picture,
        b: &Picture,
    ) -> anyhow::Result<Verdict> {
        let metric = self.metric(display, a)?;
        let comparison = metric.compare(pixels(a), pixels(b))?;
        self.write_heat_map(&comparison.heat_map)?;
        Ok(self.verdict(display, &metric, comparison.jod))
    }

    /// Writes the heat map where one was asked for.
    pub(super) fn write_heat_map(&self, map: &HeatMap) -> anyhow::Result<()> {
        match &self.heat_map {
            Some(file) => write_heat_map(file, map),
            None => Ok(()),
        }
    }
}

impl Verdict {
    /// Lines for the terminal.
    pub(super) fn text(&self) -> String {
        let [x, y] = self.gaze;
        let Seen {
            degrees_across,
            peak_cd_m2,
            ambient_lux,
            ..
        } = self.display;
        format!(
            "JOD         {:.3} at {:.1} pixels per degree, gaze {x},{y}\n\
             display     {degrees_across:.1} degrees across, {peak_cd_m2} cd/m², in {ambient_lux} lux\n",
            self.jod, self.pixels_per_degree
        )
    }
}

fn write_heat_map(file: &Path, map: &HeatMap) -> anyhow::Result<()> {
    let shares = map.jod_lost.iter().map(|&lost| lost / BRIGHTEST_JOD);
    let (width, height) = (map.width as u32, map.height as u32);
    picture::write_rgb(file, width, height, &magma(shares))
}

/// Reads `--display`.
fn display(text: &str) -> Result<Display, String> {
    Display::parse(text).ok_or_else(|| {
        let names = Display::NAMED.map(|(name, _)| name).join(", ");
        format!(
            "a display is {names}, degrees across between 1 and 170, or WIDTHxDISTANCE in metres"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_for_a_display_is_compared_at_the_same_one() {
        for (name, display) in Display::NAMED {
            let drawn: foveal::Display = name.parse().expect(name);
            let radians = drawn.across().expect(name);
            let degrees = display.degrees_across();
            assert!((radians.to_degrees() - degrees).abs() < 0.2, "{name}");
        }
        assert!(display("sofa").unwrap_err().contains("uhd-27"));
    }
}
