//! Settings of the eye: the display that it looks at and the difference that it may see.

use super::Settings;
use crate::Error;

/// Display on which the picture is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Display {
    /// A display that fills the camera's own field of view: the picture has its true perspective,
    /// as in a headset.
    Camera,
    /// A plane in front of the eye, with this field of view from left to right in radians.
    Across(f32),
}

/// Named displays: name, width, distance, both in the same unit.
const NAMED: [(&str, f32, f32); 8] = [
    // Displays of the metric: a headset's eye of 91.5 degrees, 60 degrees, and the 24-inch monitor.
    ("hmd", 2.053, 1.0),
    ("h60", 1.1547, 1.0),
    ("fhd", 0.531, 0.6),
    // 24 inches at 0.6 m: 48 degrees, 38 pixels a degree at 1920.
    ("fhd-24", 0.531, 0.6),
    // 27 inches at 0.6 m: 53 degrees, 67 pixels a degree at 3840.
    ("uhd-27", 0.598, 0.6),
    // 110 degrees across an eye.
    ("quest-3", 2.856, 1.0),
    // 100 degrees across an eye.
    ("vision-pro", 2.384, 1.0),
    // 6.1 inches on its side at 0.3 m: 26 degrees.
    ("phone", 0.141, 0.3),
];

const EXPECTED: &str = "camera, hmd, h60, fhd-24, uhd-27, quest-3, vision-pro, phone, degrees across between 1 and 170, or \
                        WIDTHxDISTANCE in metres";

impl Display {
    /// Reads a display from a name (`camera`, `hmd`, `h60`, `fhd-24`, `uhd-27`, `quest-3`,
    /// `vision-pro`, `phone`), a field of view in degrees from left to right, or `WIDTHxDISTANCE`
    /// in metres.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        if text == "camera" {
            return Some(Self::Camera);
        }
        let (width, distance) = match NAMED.iter().find(|(name, ..)| *name == text) {
            Some(&(_, width, distance)) => (width, distance),
            None => match text.split_once('x') {
                Some((width, distance)) => (width.parse().ok()?, distance.parse().ok()?),
                None => {
                    let degrees: f32 = text.parse().ok()?;
                    (2.0 * (0.5 * degrees.to_radians()).tan(), 1.0)
                }
            },
        };
        let across = 2.0 * (0.5 * width / distance).atan();
        let possible = width > 0.0 && distance > 0.0 && across.to_degrees() >= 0.99;
        (possible && across.to_degrees() <= 170.01).then_some(Self::Across(across))
    }
}

impl Settings {
    /// The display that the settings name.
    pub(crate) fn seen_on(&self) -> Result<Display, Error> {
        Display::parse(&self.display).ok_or_else(|| Error::Setting {
            name: "display",
            value: self.display.clone(),
            expected: EXPECTED,
        })
    }
}

/// Checks the settings of the eye.
pub(super) fn validate(s: &Settings) -> Result<(), Error> {
    s.seen_on()?;
    if !(5.0..=10.0).contains(&s.quality) {
        return Err(Error::Setting {
            name: "quality",
            value: s.quality.to_string(),
            expected: "between 5 and 10",
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displays_are_told_by_name_by_degrees_and_by_width_and_distance() {
        let degrees = |text: &str| match Display::parse(text) {
            Some(Display::Across(radians)) => radians.to_degrees(),
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(Display::parse("camera"), Some(Display::Camera));
        assert!((degrees("hmd") - 91.5).abs() < 0.1);
        assert!((degrees("h60") - 60.0).abs() < 0.1);
        assert!((degrees("fhd-24") - 47.8).abs() < 0.2);
        assert!((degrees("uhd-27") - 53.0).abs() < 0.3);
        assert!((degrees("quest-3") - 110.0).abs() < 0.1);
        assert!((degrees("vision-pro") - 100.0).abs() < 0.1);
        assert!((degrees("60") - 60.0).abs() < 1e-3);
        assert!((degrees("2x1") - 90.0).abs() < 1e-3);
        for wrong in [
            "", "tv", "0", "-60", "171", "nan", "inf", "0x1", "1x0", "1x", "x1", "1x2x3", "-1x-1",
        ] {
            assert_eq!(Display::parse(wrong), None, "{wrong}");
        }
    }
}
