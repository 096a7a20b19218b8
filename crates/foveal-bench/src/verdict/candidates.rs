//! Which settings are tried, and how those that help are put together.

use foveal::{LightingPass, Settings};

use crate::changes::{Changes, changed};
use foveal_host::difference::BENCH_DISPLAY;

/// What a candidate is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// Less time.
    Faster,
    /// A better picture.
    Better,
}

/// Settings that are tried.
#[derive(Debug)]
pub(super) struct Candidate {
    pub(super) name: &'static str,
    pub(super) aim: Aim,
    /// What they change in the defaults.
    changes: Changes,
    /// Of candidates with the same of this only the fastest is taken.
    family: &'static str,
}

const fn faster(name: &'static str, family: &'static str, changes: Changes) -> Candidate {
    Candidate {
        name,
        aim: Aim::Faster,
        changes,
        family,
    }
}

/// In the order of the frame.
const ALL: &[Candidate] = &[
    // The plain picture has occlusion culling where that is worth its time, and with shadows.
    faster(
        "Culling by the frustum alone",
        "culling",
        &[("culling", "frustum")],
    ),
    faster(
        "Visibility buffer",
        "geometry",
        &[("geometry", "visibility")],
    ),
    // Of these two one is what the plain picture has, and no candidate.
    faster(
        "Lighting by fragments",
        "lighting pass",
        &[("lighting-pass", "fragment")],
    ),
    faster(
        "Lighting by compute",
        "lighting pass",
        &[("lighting-pass", "compute")],
    ),
    faster(
        "Variable shading by content",
        "shading",
        &[("shading", "variable"), ("rate", "content")],
    ),
    faster(
        "Coarse shading around the gaze",
        "shading",
        // At the display where JOD is measured.
        &[
            ("shading", "coarse"),
            ("display", BENCH_DISPLAY),
            ("quality", "9.3"),
        ],
    ),
    faster(
        "Coarse shading over a visibility buffer",
        "shading",
        &[
            ("geometry", "visibility"),
            ("shading", "coarse"),
            ("composite", "smooth"),
            ("display", BENCH_DISPLAY),
        ],
    ),
    faster(
        "Three quarters of the size",
        "size",
        &[("render-scale", "0.75")],
    ),
    Candidate {
        name: "Anti-aliasing by MSAA",
        aim: Aim::Better,
        changes: &[("aa", "msaa")],
        family: "antialiasing",
    },
];

impl Candidate {
    /// The settings that are tried.
    fn settings(&self, plain: &Settings) -> anyhow::Result<Settings> {
        changed(plain, self.changes)
    }
}

/// The candidates and their settings, without those that change nothing in the plain ones. `pass` is
/// the kind of lighting pass that the device has for each.
pub(super) fn candidates_of(
    plain: &Settings,
    pass: impl Fn(LightingPass) -> LightingPass,
) -> anyhow::Result<Vec<(&'static Candidate, Settings)>> {
    let drawn = |settings: &Settings| {
        settings
            .clone()
            .with(|s| s.lighting.pass = pass(s.lighting.pass))
    };
    let mut candidates = Vec::new();
    for candidate in ALL {
        let settings = candidate.settings(plain)?;
        if drawn(&settings) != drawn(plain) {
            candidates.push((candidate, settings));
        }
    }
    Ok(candidates)
}

/// The settings of these candidates as one: of each family the one with the largest ratio. `None`
/// where that leaves fewer than two.
pub(super) fn together(
    plain: &Settings,
    adopted: &[(&Candidate, f64)],
) -> anyhow::Result<Option<Settings>> {
    let (mut settings, mut count) = (plain.clone(), 0);
    for (candidate, ratio) in adopted {
        let mut family = adopted.iter().filter(|(c, _)| c.family == candidate.family);
        if family.all(|(_, other)| other <= ratio) {
            settings = candidate.settings(&settings)?;
            count += 1;
        }
    }
    Ok((count > 1).then_some(settings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal::{Culling, Geometry, Shading};

    #[test]
    fn each_candidate_changes_something_that_is_possible() {
        let plain = Settings::default();
        let candidates = candidates_of(&plain, |pass| pass).unwrap();
        assert_eq!(candidates.len(), ALL.len());
        for (candidate, settings) in candidates {
            let checked = settings.validate(&wgpu::Limits::default());
            assert!(checked.is_ok(), "{}: {checked:?}", candidate.name);
        }
    }

    #[test]
    fn what_the_plain_frame_has_is_no_candidate() {
        let plain = changed(&Settings::default(), &[("aa", "msaa")]).unwrap();
        let candidates = candidates_of(&plain, |pass| pass).unwrap();
        assert_eq!(candidates.len(), ALL.len() - 1);
        assert!(candidates.iter().all(|(c, _)| c.aim == Aim::Faster));
    }

    #[test]
    fn the_lighting_pass_that_the_device_has_anyway_is_no_candidate() {
        use LightingPass::{Auto, Compute, Fragment};
        for (auto, left) in [
            (Fragment, "Lighting by compute"),
            (Compute, "Lighting by fragments"),
        ] {
            let pass = |pass| if pass == Auto { auto } else { pass };
            let candidates = candidates_of(&Settings::default(), pass).unwrap();
            let names: Vec<&str> = candidates.iter().map(|(c, _)| c.name).collect();
            assert_eq!(candidates.len(), ALL.len() - 1);
            assert!(names.contains(&left), "{names:?}");
        }
    }

    #[test]
    fn the_fastest_of_a_family_is_taken() {
        let named = |name: &str| ALL.iter().find(|c| c.name.starts_with(name)).unwrap();
        let adopted = [
            (named("Culling"), 1.2),
            (named("Variable"), 1.3),
            (named("Coarse shading over"), 3.0),
            (named("Coarse shading around"), 2.0),
        ];
        let of = |adopted: &[(&Candidate, f64)]| {
            let settings = together(&Settings::default(), adopted);
            settings.unwrap()
        };
        let settings = of(&adopted).unwrap();
        assert_eq!(settings.culling.mode, Culling::Frustum);
        assert_eq!(settings.shading.mode, Shading::Coarse);
        assert_eq!(settings.geometry.path, Geometry::Visibility);
        let checked = settings.validate(&wgpu::Limits::default());
        assert!(checked.is_ok(), "{checked:?}");
        // One of a family is what was measured already.
        assert_eq!(of(&adopted[1..]), None);
        assert_eq!(of(&[]), None);
    }
}
