//! The display: from pixel values to light, from pixels to degrees.

use crate::VdpError;

/// How far the display reaches across the eye's view.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Extent {
    /// Horizontal field of view in degrees, 1 to 170.
    FieldOfView(f32),
    /// A flat display of a width at a distance, both in metres.
    Flat {
        /// Width of the picture in metres.
        width_m: f32,
        /// Distance from the eye to the middle of the picture in metres.
        distance_m: f32,
    },
}

/// A flat sRGB display, seen from straight ahead of its middle. A picture fills it, whatever its
/// number of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Its size.
    pub extent: Extent,
    /// Luminance of white in cd/m², without reflected light.
    pub peak: f32,
    /// Luminance of white by that of black, without reflected light.
    pub contrast: f32,
    /// Light that falls onto the display, in lux.
    pub ambient_lux: f32,
    /// The part of that light which the display reflects, 0 to 1; 0.005 for most screens.
    pub reflectivity: f32,
}

impl Display {
    /// A headset's eye: 91.5 degrees across, 100 cd/m², no light but its own.
    pub const HEADSET: Self = Self::named_model(91.5, 100.0, 0.0);
    /// A window of 60 degrees across, 100 cd/m², in the dark.
    pub const DEGREES_60: Self = Self::named_model(60.0, 100.0, 0.0);
    /// A 24-inch full-HD monitor at 0.6 m: 47.8 degrees across, 200 cd/m², in a lit office of 250
    /// lux.
    pub const MONITOR_24: Self = Self::named_model(47.8, 200.0, 250.0);

    const fn named_model(fov_horizontal_deg: f32, peak: f32, ambient_lux: f32) -> Self {
        Self {
            extent: Extent::FieldOfView(fov_horizontal_deg),
            peak,
            contrast: 1000.0,
            ambient_lux,
            reflectivity: 0.005,
        }
    }

    const fn flat(width_m: f32, distance_m: f32, like: Self) -> Self {
        Self {
            extent: Extent::Flat {
                width_m,
                distance_m,
            },
            ..like
        }
    }

    /// Names that [`Display::named`] knows, and their displays. Headsets and the phone are seen in
    /// the dark at 100 cd/m², monitors in an office at 200.
    pub const NAMED: [(&'static str, Self); 8] = [
        ("hmd", Self::HEADSET),
        ("h60", Self::DEGREES_60),
        ("fhd", Self::MONITOR_24),
        // 24 inches at 0.6 m, again: 47.8 degrees by the width.
        ("fhd-24", Self::flat(0.531, 0.6, Self::MONITOR_24)),
        // 27 inches at 0.6 m: 53 degrees.
        ("uhd-27", Self::flat(0.598, 0.6, Self::MONITOR_24)),
        // 110 degrees across an eye.
        ("quest-3", Self::flat(2.856, 1.0, Self::HEADSET)),
        // 100 degrees across an eye.
        ("vision-pro", Self::flat(2.384, 1.0, Self::HEADSET)),
        // 6.1 inches on its side at 0.3 m: 26 degrees.
        ("phone", Self::flat(0.141, 0.3, Self::HEADSET)),
    ];

    /// The display of a name in [`Display::NAMED`].
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let found = Self::NAMED.iter().find(|(known, _)| *known == name);
        found.map(|&(_, display)| display)
    }

    /// A display by its name, its degrees across, or `WIDTHxDISTANCE` in metres; those without a
    /// name have the light of [`Display::DEGREES_60`]. `None` where the text is none of these, or
    /// the display cannot be.
    ///
    /// ```
    /// # use foveal_vdp::Display;
    /// assert_eq!(Display::parse("fhd"), Some(Display::MONITOR_24));
    /// assert!(Display::parse("90").is_some() && Display::parse("0.5x0.6").is_some());
    /// assert_eq!(Display::parse("sofa"), None);
    /// ```
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        if let Some(display) = Self::named(text) {
            return Some(display);
        }
        let extent = match text.split_once(['x', 'X']) {
            Some((width, distance)) => Extent::Flat {
                width_m: width.parse().ok()?,
                distance_m: distance.parse().ok()?,
            },
            None => Extent::FieldOfView(text.parse().ok()?),
        };
        let display = Self {
            extent,
            ..Self::DEGREES_60
        };
        display.check().is_ok().then_some(display)
    }

    /// The same display, of which only `part` of the width is there, around the middle: with as
    /// many of its pixels, the same pixels per degree.
    ///
    /// ```
    /// # use foveal_vdp::Display;
    /// let (whole, part) = (Display::HEADSET, Display::HEADSET.cut(0.25));
    /// let (a, b) = (whole.pixels_per_degree(2560), part.pixels_per_degree(640));
    /// assert!((a / b - 1.0).abs() < 1e-5);
    /// ```
    #[must_use]
    pub fn cut(&self, part: f32) -> Self {
        let extent = match self.extent {
            Extent::FieldOfView(degrees) => {
                let half = f64::from(part) * (f64::from(degrees) / 2.0).to_radians().tan();
                Extent::FieldOfView(2.0 * half.atan().to_degrees() as f32)
            }
            Extent::Flat {
                width_m,
                distance_m,
            } => Extent::Flat {
                width_m: part * width_m,
                distance_m,
            },
        };
        Self { extent, ..*self }
    }

    /// Degrees from its left to its right border.
    #[must_use]
    pub fn degrees_across(&self) -> f32 {
        match self.extent {
            Extent::FieldOfView(degrees) => degrees,
            Extent::Flat {
                width_m,
                distance_m,
            } => 2.0 * (0.5 * width_m / distance_m).atan().to_degrees(),
        }
    }

    /// Pixels per degree in the middle, for a picture `width` pixels wide.
    ///
    /// ```
    /// # use foveal_vdp::Display;
    /// assert!((Display::DEGREES_60.pixels_per_degree(1280) - 19.35).abs() < 0.01);
    /// ```
    #[must_use]
    pub fn pixels_per_degree(&self, width: usize) -> f32 {
        let half_pixel = 0.5 / self.distance_in_pixels(width);
        (1.0 / (2.0 * half_pixel.atan()).to_degrees()) as f32
    }

    /// The eye's distance by the width of a pixel.
    pub(crate) fn distance_in_pixels(&self, width: usize) -> f64 {
        let widths = match self.extent {
            Extent::FieldOfView(degrees) => 0.5 / (f64::from(degrees) / 2.0).to_radians().tan(),
            Extent::Flat {
                width_m,
                distance_m,
            } => f64::from(distance_m) / f64::from(width_m),
        };
        widths * width as f64
    }

    /// Luminance in cd/m² that a fully lit channel adds to black (red, green, blue), and that of
    /// black.
    fn light(&self) -> ([f32; 3], f32) {
        let black = self.peak / self.contrast;
        let reflected = self.ambient_lux * self.reflectivity / core::f32::consts::PI;
        // Rec. 709's weights, which are sRGB's.
        let weights = [0.2126, 0.7152, 0.0722];
        (weights.map(|w| w * (self.peak - black)), black + reflected)
    }

    pub(crate) fn check(&self) -> Result<(), VdpError> {
        let within = |what, value: f32, low: f32, high: f32, range| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(VdpError::Display { what, value, range })
            }
        };
        match self.extent {
            Extent::FieldOfView(degrees) => {
                within("field of view in degrees", degrees, 1.0, 170.0, "1 to 170")?;
            }
            Extent::Flat {
                width_m,
                distance_m,
            } => {
                within("width in metres", width_m, 1e-3, 1e3, "0.001 to 1000")?;
                within("distance in metres", distance_m, 1e-3, 1e3, "0.001 to 1000")?;
            }
        }
        within(
            "peak luminance in cd/m²",
            self.peak,
            0.1,
            1e5,
            "0.1 to 100000",
        )?;
        within("contrast", self.contrast, 1.0, 1e9, "1 to 1000000000")?;
        within(
            "ambient light in lux",
            self.ambient_lux,
            0.0,
            1e5,
            "0 to 100000",
        )?;
        within("reflectivity", self.reflectivity, 0.0, 1.0, "0 to 1")
    }
}

/// Luminance of 8-bit sRGB pixels, by tables.
#[derive(Clone, Debug)]
pub(crate) struct Photometry {
    channels: [[f32; 256]; 3],
}

impl Photometry {
    pub(crate) fn new(display: &Display) -> Self {
        let (weights, black) = display.light();
        let channels = weights.map(|weight| {
            core::array::from_fn(|code| weight * linear(code as f32 / 255.0) + black / 3.0)
        });
        Self { channels }
    }

    /// In cd/m².
    pub(crate) fn luminance(&self, rgb: [u8; 3]) -> f32 {
        let [r, g, b] = rgb.map(usize::from);
        self.channels[0][r] + self.channels[1][g] + self.channels[2][b]
    }
}

/// sRGB's transfer function (IEC 61966-2-1).
fn linear(value: f32) -> f32 {
    if value > 0.04045 {
        ((value + 0.055) / 1.055).powf(2.4)
    } else {
        value / 12.92
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_the_peak_and_black_what_contrast_and_the_room_leave() {
        let photometry = Photometry::new(&Display::MONITOR_24);
        let reflected = 250.0 * 0.005 / core::f32::consts::PI;
        assert!((photometry.luminance([255; 3]) - (200.0 + reflected)).abs() < 1e-3);
        assert!((photometry.luminance([0; 3]) - (0.2 + reflected)).abs() < 1e-4);
    }

    #[test]
    fn a_flat_display_and_its_field_of_view_are_the_same() {
        let flat = Display {
            extent: Extent::Flat {
                width_m: 0.531,
                distance_m: 0.6,
            },
            ..Display::MONITOR_24
        };
        let (a, b) = (
            flat.pixels_per_degree(1920),
            Display::MONITOR_24.pixels_per_degree(1920),
        );
        assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
    }

    #[test]
    fn what_cannot_be_is_refused() {
        for peak in [0.0, f32::NAN, f32::INFINITY] {
            let display = Display {
                peak,
                ..Display::HEADSET
            };
            assert!(display.check().is_err());
        }
        for (name, display) in Display::NAMED {
            assert_eq!(display.check(), Ok(()), "{name}");
        }
        for text in ["", "quest", "-5", "0", "1x", "1x0", "nan", "171"] {
            assert_eq!(Display::parse(text), None, "{text}");
        }
    }
}
