//! Settings of the eye: the display that it looks at and the difference that it may see.

use std::fmt;
use std::str::FromStr;

#[cfg(feature = "serde")]
use super::define::as_text;
use crate::Error;

/// Display on which the picture is seen: a plane in front of the eye. As text a name, a field of
/// view in degrees from left to right (`60`), or `WIDTHxDISTANCE` in metres (`0.531x0.6`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Display {
    /// `camera`: a display that fills the camera's own field of view: the picture has its true
    /// perspective, as in a headset.
    #[default]
    Camera,
    /// `hmd`: an eye of a headset as the metric has it, 91.5 degrees across.
    Hmd,
    /// `h60`: 60 degrees across.
    H60,
    /// `fhd-24` (or `fhd`): a 24-inch monitor at 0.6 m, 48 degrees across, 38 pixels a degree at
    /// 1920.
    Fhd24,
    /// `uhd-27`: a 27-inch monitor at 0.6 m, 53 degrees across, 67 pixels a degree at 3840.
    Uhd27,
    /// `quest-3`: 110 degrees across an eye.
    Quest3,
    /// `vision-pro`: 100 degrees across an eye.
    VisionPro,
    /// `phone`: 6.1 inches on its side at 0.3 m, 26 degrees across.
    Phone,
    /// Field of view from left to right in degrees, 1 to 170.
    Degrees(f32),
    /// Width and distance in metres, of which the field of view follows.
    Plane {
        /// Width of the display.
        width_m: f32,
        /// Distance of the eye.
        distance_m: f32,
    },
}

/// Name, display, width and distance in the same unit.
const NAMED: [(&str, Display, f32, f32); 8] = [
    ("hmd", Display::Hmd, 2.053, 1.0),
    ("h60", Display::H60, 1.1547, 1.0),
    ("fhd-24", Display::Fhd24, 0.531, 0.6),
    ("fhd", Display::Fhd24, 0.531, 0.6),
    ("uhd-27", Display::Uhd27, 0.598, 0.6),
    ("quest-3", Display::Quest3, 2.856, 1.0),
    ("vision-pro", Display::VisionPro, 2.384, 1.0),
    ("phone", Display::Phone, 0.141, 0.3),
];

const EXPECTED: &str = "camera, hmd, h60, fhd-24, uhd-27, quest-3, vision-pro, phone, degrees across between 1 and 170, or \
                        WIDTHxDISTANCE in metres";

impl Display {
    /// Field of view from left to right in radians; `None` for the camera's own.
    #[must_use]
    pub fn across(self) -> Option<f32> {
        let (width, distance) = match self {
            Self::Camera => return None,
            Self::Degrees(degrees) => (2.0 * (0.5 * degrees.to_radians()).tan(), 1.0),
            Self::Plane {
                width_m,
                distance_m,
            } => (width_m, distance_m),
            named => {
                let &(_, _, width, distance) = NAMED.iter().find(|(_, d, ..)| *d == named)?;
                (width, distance)
            }
        };
        Some(2.0 * (0.5 * width / distance).atan())
    }

    pub(super) fn is_possible(self) -> bool {
        let is_positive = match self {
            Self::Plane {
                width_m,
                distance_m,
            } => width_m > 0.0 && distance_m > 0.0,
            // Beyond 180 the tangent comes round again.
            Self::Degrees(degrees) => degrees <= 171.0,
            _ => true,
        };
        let degrees = self.across().map(f32::to_degrees);
        is_positive && degrees.is_none_or(|d| (0.99..=170.01).contains(&d))
    }
}

impl FromStr for Display {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let of_numbers = || match text.split_once('x') {
            Some((width, distance)) => Some(Self::Plane {
                width_m: width.parse().ok()?,
                distance_m: distance.parse().ok()?,
            }),
            None => text.parse().ok().map(Self::Degrees),
        };
        let named = NAMED.iter().find(|(name, ..)| *name == text);
        match named {
            _ if text == "camera" => Some(Self::Camera),
            Some(&(_, display, ..)) => Some(display),
            None => of_numbers().filter(|display| display.is_possible()),
        }
        .ok_or_else(|| wrong(text.to_owned()))
    }
}

pub(super) fn wrong(value: String) -> Error {
    Error::Setting {
        name: "display",
        value,
        expected: EXPECTED,
    }
}

impl fmt::Display for Display {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Camera => f.write_str("camera"),
            Self::Degrees(degrees) => write!(f, "{degrees}"),
            Self::Plane {
                width_m,
                distance_m,
            } => write!(f, "{width_m}x{distance_m}"),
            named => {
                let found = NAMED.iter().find(|(_, display, ..)| display == named);
                f.write_str(found.map_or("", |(name, ..)| name))
            }
        }
    }
}

#[cfg(feature = "serde")]
as_text!(Display);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displays_are_told_by_name_by_degrees_and_by_width_and_distance() {
        let degrees = |text: &str| {
            let display: Display = text.parse().expect(text);
            let name = if text == "fhd" { "fhd-24" } else { text };
            assert_eq!(display.to_string(), name);
            display.across().expect(text).to_degrees()
        };
        assert_eq!("camera".parse::<Display>().ok(), Some(Display::Camera));
        assert!((degrees("hmd") - 91.5).abs() < 0.1);
        assert!((degrees("h60") - 60.0).abs() < 0.1);
        assert!((degrees("fhd") - 47.8).abs() < 0.2);
        assert!((degrees("fhd-24") - 47.8).abs() < 0.2);
        assert!((degrees("uhd-27") - 53.0).abs() < 0.3);
        assert!((degrees("quest-3") - 110.0).abs() < 0.1);
        assert!((degrees("vision-pro") - 100.0).abs() < 0.1);
        assert!((degrees("60") - 60.0).abs() < 1e-3);
        assert!((degrees("2x1") - 90.0).abs() < 1e-3);
        for wrong in [
            "", "tv", "0", "-60", "171", "400", "nan", "inf", "0x1", "1x0", "1x", "x1", "1x2x3",
            "-1x-1",
        ] {
            let cause = wrong.parse::<Display>().expect_err(wrong).to_string();
            assert!(cause.contains("display"), "{wrong}: {cause}");
        }
    }
}
