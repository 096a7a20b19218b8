//! Displays with all their pixels, and what of them is drawn.

use foveal::Settings;
use foveal_host::failure::usage;
use foveal_vdp::{Display, Extent};

use super::ways::{Follows, Way};
use crate::changes::changed;

/// A display by the name that `foveal render --display` knows, and its pixels: an eye's where it is
/// a headset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Screen {
    pub(super) name: &'static str,
    width: u32,
    height: u32,
}

const fn screen(name: &'static str, width: u32, height: u32) -> Screen {
    Screen {
        name,
        width,
        height,
    }
}

/// All with a name; `hmd` and `h60` have as many pixels as docs/benchmarks/coarse.md compares them
/// with.
pub(super) const ALL: [Screen; 7] = [
    screen("h60", 1280, 720),
    screen("fhd-24", 1920, 1080),
    screen("uhd-27", 3840, 2160),
    screen("hmd", 2560, 1440),
    screen("quest-3", 2064, 2208),
    screen("vision-pro", 3660, 3200),
    screen("phone", 2556, 1179),
];

/// Reads one of `--display`.
pub(super) fn named(text: &str) -> Result<Screen, String> {
    let names = || ALL.map(|screen| screen.name).join(", ");
    let found = ALL.iter().find(|screen| screen.name == text);
    (found.copied()).ok_or_else(|| format!("the displays are {}", names()))
}

/// How much of a display is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    Whole,
    Within { width: u32, height: u32 },
}

/// Reads `--size`.
pub(super) fn fit(text: &str) -> Result<Fit, String> {
    if text == "whole" {
        return Ok(Fit::Whole);
    }
    let (width, height) = foveal_host::values::size(text)?;
    if width < 16 || height < 16 {
        return Err("no side may have fewer than 16 pixels".to_owned());
    }
    Ok(Fit::Within { width, height })
}

/// What is drawn of a display: its centre, or all of it.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    pub(super) width: u32,
    pub(super) height: u32,
    /// As `--display` of `foveal render` and `foveal compare` names it.
    pub(super) spelled: String,
    /// The same for the metric, with the light of the whole display.
    pub(super) display: Display,
}

impl Screen {
    /// Fails where the part that fits is less than a degree across: neither rates nor metric take that.
    pub(super) fn check(&self, fit: Fit) -> anyhow::Result<()> {
        let shown = self.shown(fit);
        if Display::parse(&shown.spelled).is_some() {
            return Ok(());
        }
        usage(format!(
            "--size: {} pixels of the display '{}' are {} degrees across; the least is 1",
            shown.width, self.name, shown.spelled
        ))
    }

    /// The display's centre, with as many pixels per degree as the whole has.
    pub(super) fn shown(&self, fit: Fit) -> Shown {
        let whole = Display::named(self.name).unwrap_or(Display::DEGREES_60);
        let (width, height) = match fit {
            Fit::Whole => (self.width, self.height),
            Fit::Within { width, height } => (width.min(self.width), height.min(self.height)),
        };
        if width == self.width {
            return Shown {
                width,
                height,
                spelled: self.name.to_owned(),
                display: whole,
            };
        }
        let part = whole.cut(width as f32 / self.width as f32);
        // The same digits for rates and metric, as a command has them.
        let spelled = format!("{:.3}", part.degrees_across());
        let degrees = spelled.parse().unwrap_or(part.degrees_across());
        Shown {
            width,
            height,
            spelled,
            display: Display {
                extent: Extent::FieldOfView(degrees),
                ..whole
            },
        }
    }
}

impl Shown {
    /// The settings of a way for an eye that looks at `gaze`; `plain` are those of this size that
    /// all ways share.
    pub(super) fn settings(
        &self,
        plain: &Settings,
        way: &Way,
        gaze: [f32; 2],
    ) -> anyhow::Result<Settings> {
        let mut settings = changed(plain, way.changes)?;
        // What a way does not follow stays as it is, so that equal settings are equal pictures.
        if way.follows != Follows::Nothing {
            settings.eye.gaze = gaze;
        }
        if way.follows == Follows::GazeAndDisplay {
            settings.eye.display = self.spelled.parse()?;
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ways::WAYS;
    use super::*;

    #[test]
    fn a_part_of_a_display_has_its_pixels_per_degree() {
        for screen in ALL {
            let whole = screen.shown(Fit::Whole);
            let part = screen.shown(fit("160x90").unwrap());
            assert_eq!((part.width, part.height), (160, 90));
            let [a, b] = [&whole, &part].map(|s| s.display.pixels_per_degree(s.width as usize));
            assert!((a / b - 1.0).abs() < 1e-3, "{}: {a} {b}", screen.name);
            assert_eq!(whole.display.peak, part.display.peak);
            let drawn = part.spelled.parse::<foveal::Display>();
            assert!(drawn.is_ok(), "{}", part.spelled);
        }
        assert!(fit("8x9").is_err() && named("sofa").is_err());
    }

    #[test]
    fn a_part_of_less_than_a_degree_is_refused() {
        let phone = named("phone").unwrap();
        let check = |size: &str| phone.check(fit(size).unwrap());
        assert!(check("160x90").is_ok() && check("whole").is_ok());
        let error = check("64x36").unwrap_err().to_string();
        assert!(
            error.contains("64 pixels of the display 'phone'"),
            "{error}"
        );
    }

    #[test]
    fn every_way_is_possible_and_differs_from_the_first() {
        let shown = ALL[0].shown(Fit::Whole);
        let plain = Settings::default().with(|s| {
            s.picture.width = shown.width;
            s.picture.height = shown.height;
            s.lighting.shadows = foveal::Shadows::Soft;
        });
        let full = shown.settings(&plain, &WAYS[0], [0.5, 0.5]).unwrap();
        assert_eq!(full, plain);
        for way in &WAYS[1..] {
            let settings = shown.settings(&plain, way, [0.5, 0.5]).unwrap();
            assert_eq!(settings.lighting, plain.lighting);
            assert_ne!(settings, full, "{}", way.name);
            let checked = settings.validate(&wgpu::Limits::default());
            assert!(checked.is_ok(), "{}: {checked:?}", way.name);
            let off = shown.settings(&plain, way, [0.25, 0.6]).unwrap();
            assert_eq!(off == settings, way.follows == Follows::Nothing);
        }
    }
}
