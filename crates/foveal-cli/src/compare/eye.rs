//! The difference that an eye sees which looks at one point of a display: FovVideoVDP, in JOD.

use std::path::{Path, PathBuf};

use foveal_vdp::{Display, Extent, Gaze, HeatMap, Metric, Pixels};
use serde::Serialize;

use super::flip;
use crate::picture::{self, Picture};
use crate::values;

/// JOD at which the heat map is brightest.
const BRIGHTEST_JOD: f32 = 8.0;

/// How the pictures are looked at.
#[derive(Debug, clap::Args)]
pub(super) struct EyeArgs {
    /// The display that the pictures fill, which adds the quality in JOD at the gaze: hmd (a headset's eye, 91.5 degrees
    /// across), h60 (60 degrees across), fhd (a 24-inch monitor at 0.6 m), one that foveal render --display names, degrees
    /// across, or WIDTHxDISTANCE in metres
    #[arg(long, value_name = "WHICH", value_parser = display, help_heading = "Eye")]
    display: Option<Display>,

    /// Luminance of the display's white in cd/m²
    #[arg(long, value_name = "CD", value_parser = values::positive, help_heading = "Eye")]
    peak: Option<f32>,

    /// Light that falls onto the display, in lux
    #[arg(long, value_name = "LUX", value_parser = values::non_negative, help_heading = "Eye")]
    ambient: Option<f32>,

    /// Where the eye looks, as fractions of the picture from its top left corner
    #[arg(long, value_name = "X,Y", value_parser = values::vec2, default_value = "0.5,0.5", help_heading = "Eye")]
    gaze: [f32; 2],

    /// Frames per second, for folders
    #[arg(long, value_name = "N", value_parser = values::positive, default_value_t = 30.0, help_heading = "Eye")]
    pub(super) fps: f32,

    /// Write where the eye sees differences: black for none, through magenta to yellow for 8 JOD lost and more
    #[arg(long, value_name = "FILE.png", help_heading = "Eye")]
    heat_map: Option<PathBuf>,
}

/// What an eye sees at a display.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Verdict {
    /// 10: no visible difference; 9: three quarters of observers take the reference for the better one.
    pub(super) jod: f32,
    /// In the display's middle.
    pub(super) pixels_per_degree: f32,
    /// As fractions of the picture.
    pub(super) gaze: [f32; 2],
}

impl EyeArgs {
    /// The display that was asked for; `wanted` asks for `h60` where none was named.
    pub(super) fn display(&self, wanted: bool) -> Option<Display> {
        let changed = self.peak.is_some() || self.ambient.is_some() || self.heat_map.is_some();
        let base = self
            .display
            .or_else(|| (wanted || changed).then_some(Display::DEGREES_60))?;
        Some(Display {
            peak: self.peak.unwrap_or(base.peak),
            ambient_lux: self.ambient.unwrap_or(base.ambient_lux),
            ..base
        })
    }

    /// The file for the heat map.
    pub(super) fn heat_map(&self) -> Option<&PathBuf> {
        self.heat_map.as_ref()
    }

    /// The metric for pictures of one size.
    pub(super) fn metric(&self, display: &Display, picture: &Picture) -> anyhow::Result<Metric> {
        let [x, y] = self.gaze;
        let (width, height) = (picture.width as usize, picture.height as usize);
        Ok(Metric::new(display, width, height, Gaze { x, y })?)
    }

    /// What is said of a quality.
    pub(super) fn verdict(&self, metric: &Metric, jod: f32) -> Verdict {
        Verdict {
            jod,
            pixels_per_degree: metric.pixels_per_degree(),
            gaze: self.gaze,
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
        Ok(self.verdict(&metric, comparison.jod))
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
        format!(
            "JOD         {:.3} at {:.1} pixels per degree, gaze {x},{y}\n",
            self.jod, self.pixels_per_degree
        )
    }
}

/// A picture as the metric takes it.
pub(super) fn pixels(picture: &Picture) -> Pixels<'_> {
    Pixels::Rgba(&picture.pixels)
}

fn write_heat_map(file: &Path, map: &HeatMap) -> anyhow::Result<()> {
    let shares = map.jod_lost.iter().map(|&lost| lost / BRIGHTEST_JOD);
    let (width, height) = (map.width as u32, map.height as u32);
    picture::write_rgb(file, width, height, &flip::magma(shares))
}

/// Reads `--display`.
fn display(text: &str) -> Result<Display, String> {
    if let Some(display) = Display::named(text) {
        return Ok(display);
    }
    // Those that rates are made for have the same names here.
    if text.starts_with(char::is_alphabetic)
        && let Some(foveal::Display::Across(radians)) = foveal::Display::parse(text)
    {
        let like = if text.ends_with(char::is_numeric) && text.contains("hd") {
            Display::MONITOR_24
        } else {
            Display::HEADSET
        };
        return Ok(Display {
            extent: Extent::FieldOfView(radians.to_degrees()),
            ..like
        });
    }
    let extent = match text.split_once(['x', 'X']) {
        Some((width, distance)) => Extent::Flat {
            width_m: values::positive(width)?,
            distance_m: values::positive(distance)?,
        },
        None => Extent::FieldOfView(values::positive(text).map_err(|_| {
            format!(
                "a display is {}, degrees across, or WIDTHxDISTANCE in metres",
                Display::NAMES.join(", ")
            )
        })?),
    };
    Ok(Display {
        extent,
        ..Display::DEGREES_60
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displays_are_names_degrees_or_metres() {
        assert_eq!(display("fhd"), Ok(Display::MONITOR_24));
        assert_eq!(display("60"), Ok(Display::DEGREES_60));
        assert_eq!(display("uhd-27").unwrap().peak, Display::MONITOR_24.peak);
        assert_eq!(display("quest-3").unwrap().peak, Display::HEADSET.peak);
        // The metric's names are names of displays to render for, and mean the same.
        for name in Display::NAMES {
            let Some(foveal::Display::Across(radians)) = foveal::Display::parse(name) else {
                panic!("{name}");
            };
            let Extent::FieldOfView(degrees) = display(name).unwrap().extent else {
                panic!("{name}");
            };
            assert!((radians.to_degrees() - degrees).abs() < 0.2, "{name}");
        }
        let desk = display("0.53x0.6").unwrap();
        assert_eq!(
            desk.extent,
            Extent::Flat {
                width_m: 0.53,
                distance_m: 0.6
            }
        );
        for text in ["", "quest", "-5", "0", "1x", "1x0", "nan"] {
            assert!(display(text).is_err(), "{text}");
        }
    }
}
