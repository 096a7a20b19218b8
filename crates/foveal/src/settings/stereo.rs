//! Settings of stereo: the way both eyes are drawn, their poses and frusta, and the presentation of
//! their pictures.

use std::fmt;
use std::str::FromStr;

#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

#[cfg(feature = "serde")]
use super::define::as_text;
use crate::Error;

/// Number of eyes, and submission of their geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Stereo {
    /// One eye.
    #[default]
    Off,
    /// Two eyes, drawn in the fastest way that works on this device.
    Auto,
    /// Two eyes; each draw is submitted once with twice the instances, into one target of twice the
    /// width.
    Instanced,
    /// Two eyes; each draw is submitted once, and the device repeats it into a layer for each eye.
    Multiview,
    /// Two eyes; each draw is submitted once per eye: the reference.
    TwoPass,
}

/// Method that keeps one eye's geometry out of the other eye's half of the target with
/// [`Stereo::Instanced`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum EyeClipping {
    /// Clip distances where the device has them, else discard.
    #[default]
    Auto,
    /// A clip plane between the halves, also with [`Stereo::TwoPass`], which otherwise uses
    /// scissors alone. Clipped triangles are other polygons, so their last bits differ.
    Clip,
    /// Fragments in the other half are discarded.
    Discard,
}

/// Presentation of both eyes' pictures. With one eye its picture is shown unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Output {
    /// The picture of the left or only eye.
    #[default]
    Flat,
    /// Left beside right, each at full width: twice the width.
    SideBySide,
    /// Left beside right, each at half its width.
    SideBySideHalf,
    /// For red-cyan glasses: the left eye's luma in red, the right eye's in green and blue.
    Anaglyph,
    /// For red-cyan glasses: colours by Dubois' least-squares projection.
    AnaglyphDubois,
    /// Left beside right, each distorted against a headset's lens.
    Headset,
}

impl Output {
    /// Pictures side by side.
    pub(crate) fn pictures_beside(self) -> usize {
        match self {
            Self::Flat | Self::Anaglyph | Self::AnaglyphDubois => 1,
            Self::SideBySide | Self::SideBySideHalf | Self::Headset => 2,
        }
    }
}

/// A headset's lens as a radial polynomial. Radii are tangents of the angle to the lens's axis. A
/// point that the screen shows at radius `p` appears to the eye at `p (1 + k1 p² + k2 p⁴ + k3 p⁶)`,
/// times a factor per colour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(Serialize, Deserialize),
    serde(deny_unknown_fields, rename_all = "kebab-case")
)]
pub struct LensProfile {
    /// Coefficients k1, k2, k3.
    pub distortion: [f32; 3],
    /// Factors c0, c1 of red: it is seen at c0 + c1 p² times the radius of green.
    #[cfg_attr(feature = "serde", serde(default = "no_fringe"))]
    pub red: [f32; 2],
    /// Factors c0, c1 of blue.
    #[cfg_attr(feature = "serde", serde(default = "no_fringe"))]
    pub blue: [f32; 2],
}

impl LensProfile {
    /// A lens that bends all colours alike.
    #[must_use]
    pub const fn without_fringe(distortion: [f32; 3]) -> Self {
        Self {
            distortion,
            red: NO_FRINGE,
            blue: NO_FRINGE,
        }
    }
}

const NO_FRINGE: [f32; 2] = [1.0, 0.0];

#[cfg(feature = "serde")]
fn no_fringe() -> [f32; 2] {
    NO_FRINGE
}

/// Lens of the headset output. As text a name, or coefficients with commas between: k1, k2, k3,
/// optionally followed by c0 and c1 of red and of blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Lens {
    /// `cardboard-v2`.
    #[default]
    CardboardV2,
    /// `cardboard-v1`.
    CardboardV1,
    /// `dk1`: the first Oculus development kit.
    Dk1,
    /// `ideal`: a lens that bends nothing.
    Ideal,
    /// Any other.
    Custom(LensProfile),
}

/// The lenses with names.
const LENSES: [(&str, Lens, LensProfile); 4] = [
    // The viewers' own parameters:
    // https://support.google.com/cardboard/manufacturers/answer/6324808
    (
        "cardboard-v2",
        Lens::CardboardV2,
        LensProfile::without_fringe([0.34, 0.55, 0.0]),
    ),
    (
        "cardboard-v1",
        Lens::CardboardV1,
        LensProfile::without_fringe([0.441, 0.156, 0.0]),
    ),
    // The SDK's 1, 0.22, 0.24 and 0.996, -0.004, 1.014, 0 are of radii in halves of an eye's
    // 74.88 mm wide half of the screen, which is 41 mm away: 0.9132 as a tangent.
    (
        "dk1",
        Lens::Dk1,
        LensProfile {
            distortion: [0.2638, 0.3451, 0.0],
            red: [0.996, -0.0048],
            blue: [1.014, 0.0],
        },
    ),
    ("ideal", Lens::Ideal, LensProfile::without_fringe([0.0; 3])),
];

impl Lens {
    /// The polynomial.
    #[must_use]
    pub fn profile(self) -> LensProfile {
        if let Self::Custom(profile) = self {
            return profile;
        }
        let named = LENSES.iter().find(|(_, lens, _)| *lens == self);
        named.map_or(LensProfile::without_fringe([0.0; 3]), |l| l.2)
    }
}

impl FromStr for Lens {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if let Some((_, lens, _)) = LENSES.iter().find(|(name, ..)| *name == text) {
            return Ok(*lens);
        }
        match numbers(text).as_deref() {
            Some(&[k1, k2, k3]) => Ok(Self::Custom(LensProfile::without_fringe([k1, k2, k3]))),
            Some(&[k1, k2, k3, r0, r1, b0, b1]) => Ok(Self::Custom(LensProfile {
                distortion: [k1, k2, k3],
                red: [r0, r1],
                blue: [b0, b1],
            })),
            _ => Err(Error::Setting {
                name: "lens",
                value: text.to_owned(),
                expected: "cardboard-v2, cardboard-v1, dk1, ideal, or 3 or 7 numbers",
            }),
        }
    }
}

impl fmt::Display for Lens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, ..)) = LENSES.iter().find(|(_, lens, _)| lens == self) {
            return f.write_str(name);
        }
        let LensProfile {
            distortion,
            red,
            blue,
        } = self.profile();
        if [red, blue] == [NO_FRINGE; 2] {
            write_numbers(f, &distortion)
        } else {
            write_numbers(f, &[&distortion[..], &red, &blue].concat())
        }
    }
}

#[cfg(feature = "serde")]
as_text!(Lens);

/// Frusta of both eyes. As text nothing, or eight tangents with commas between: left, right, bottom
/// and top of the left eye, then of the right eye.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum EyeFrusta {
    /// The camera's frustum, shifted by the convergence.
    #[default]
    Camera,
    /// Tangents of the angles to the view axis: left, right, bottom and top of each eye.
    Tangents([[f32; 4]; 2]),
}

impl FromStr for EyeFrusta {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if text.is_empty() {
            return Ok(Self::Camera);
        }
        match numbers(text).as_deref() {
            Some(&[a, b, c, d, e, f, g, h]) => Ok(Self::Tangents([[a, b, c, d], [e, f, g, h]])),
            _ => Err(Error::Setting {
                name: "eye-tangents",
                value: text.to_owned(),
                expected: TANGENTS,
            }),
        }
    }
}

impl fmt::Display for EyeFrusta {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Camera => Ok(()),
            Self::Tangents(eyes) => write_numbers(f, eyes.as_flattened()),
        }
    }
}

#[cfg(feature = "serde")]
as_text!(EyeFrusta);

fn write_numbers(f: &mut fmt::Formatter<'_>, numbers: &[f32]) -> fmt::Result {
    for (i, number) in numbers.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        write!(f, "{comma}{number}")?;
    }
    Ok(())
}

fn numbers(text: &str) -> Option<Vec<f32>> {
    text.split(',').map(|n| n.trim().parse().ok()).collect()
}

pub(super) const TANGENTS: &str = "eight numbers between -100 and 100: left < right and bottom < top of the left \
                                   eye, then of the right, by 0.001 and more";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lenses_and_frusta_are_read_as_they_are_written() {
        for text in [
            "cardboard-v2",
            "dk1",
            "ideal",
            "0.1,0.2,0",
            "0.1,0.2,0,1,0.01,1,0.02",
        ] {
            assert_eq!(text.parse::<Lens>().expect(text).to_string(), text);
        }
        for text in ["", "-1,1,-0.5,0.5,-1,1,-0.5,0.25"] {
            assert_eq!(text.parse::<EyeFrusta>().expect(text).to_string(), text);
        }
        for wrong in ["cardboard", "1,2", "1,2,3,4", "a,b,c"] {
            let cause = wrong.parse::<Lens>().expect_err(wrong).to_string();
            assert!(cause.contains("lens"), "{wrong}: {cause}");
        }
        for wrong in ["-1,1,-1,1", "x", "-1,1,-1,1,-1,1,-1,1,0"] {
            let cause = wrong.parse::<EyeFrusta>().expect_err(wrong).to_string();
            assert!(cause.contains("eye-tangents"), "{wrong}: {cause}");
        }
    }
}
