//! What a switch or a setting needs from the others before it does anything.

use foveal::{
    AmbientOcclusion, Antialiasing, CoarseBackend, CoarseSample, Composite, Culling, DebugView,
    EnvironmentSource, EyeFrusta, Geometry, Gpu, Output, RateCombine, RateSource, Setting,
    Settings, Shading, Shadows, Stereo,
};
use toml::{Table, Value};

const BEYOND_OPENGL: &str =
    "Needs a device with Vulkan, Metal or Direct3D 12; this one has OpenGL alone";

/// What of the device settings may ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Abilities {
    pub(crate) clip_distances: bool,
    /// The reduced renderer draws.
    pub(crate) is_reduced: bool,
}

/// Why the setting `key` has no effect beside these settings; `None` where it has one.
/// `compares`: whether the reference is drawn beside.
pub(crate) fn missing(
    key: &str,
    s: &Settings,
    abilities: Abilities,
    compares: bool,
) -> Option<&'static str> {
    let unless = |has_effect: bool, why| (!has_effect).then_some(why);
    if abilities.is_reduced && is_beyond_reduced(key, s) {
        return Some(BEYOND_OPENGL);
    }
    let shading = s.shading.mode;
    let (coarse, variable) = (shading == Shading::Coarse, shading == Shading::Variable);
    let stereo = s.is_stereo();
    let occlusion = s.culling.mode.has_occluders();
    match key {
        "occluder-size" | "occlusion-scale" | "culling-threads" | "culling-budget" => {
            unless(occlusion, "Needs Culling: auto or occlusion")
        }
        "occludee-size" | "culling-radius" => unless(
            s.culling.mode != Culling::Off,
            "Needs Culling: auto, frustum or occlusion",
        ),
        "culling-eyes" => unless(occlusion, "Needs Culling: auto or occlusion")
            .or(unless(stereo, "Needs Stereo, Eyes: other than off")),
        "environment-image" => unless(
            s.lighting.environment == EnvironmentSource::Image,
            "Needs Environment: image",
        ),
        "environment-rotation" => unless(
            matches!(
                s.lighting.environment,
                EnvironmentSource::Image | EnvironmentSource::Scene
            ),
            "Needs Environment: image or scene; the others look the same from all sides",
        ),
        "ambient-occlusion" => unless(
            s.lighting.environment != EnvironmentSource::None,
            "Needs Environment: other than none",
        ),
        "ambient-occlusion-radius" => unless(
            s.lighting.environment != EnvironmentSource::None,
            "Needs Environment: other than none",
        )
        .or(unless(
            s.lighting.ambient_occlusion != AmbientOcclusion::Off,
            "Needs Ambient occlusion: screen",
        )),
        "environment-intensity" | "background" => unless(
            s.lighting.environment != EnvironmentSource::None,
            "Needs Environment: other than none",
        ),
        "light-radius" | "sun-angle" => unless(
            s.lighting.shadows == Shadows::Contact,
            "Needs Shadows: contact",
        ),
        "shadow-atlas" | "shadow-texel" | "shadow-bias" | "shadow-budget" => unless(
            s.lighting.shadows != Shadows::Off,
            "Needs Shadows: other than off",
        ),
        "shadow-sizes" => unless(
            s.lighting.shadows != Shadows::Off,
            "Needs Shadows: other than off",
        )
        .or(unless(coarse, "Needs Shading: coarse"))
        .or(unless(
            uses(s, RateSource::Foveated),
            "Needs Rate from: foveated",
        )),
        "material-dispatch" => unless(
            s.geometry.path == Geometry::Visibility,
            "Needs Geometry, Path: visibility",
        ),
        "samples" | "pattern" => unless(
            s.antialiasing.mode != Antialiasing::None,
            "Needs Anti-aliasing, Mode: ssaa or msaa",
        ),
        "edge-test" => unless(
            s.antialiasing.mode == Antialiasing::Msaa,
            "Needs Anti-aliasing, Mode: msaa",
        ),
        "display" => unless(coarse || variable || compares, EYE),
        "gaze" => unless(coarse || variable || compares, EYE),
        "quality" => unless(
            shading != Shading::Full,
            "Needs Shading: coarse or variable",
        )
        .or(unless(
            uses(s, RateSource::Foveated) || s.keeps_light(),
            "Needs Rate from: foveated",
        )),
        "gaze-shift" => unless(stereo, EYES).or(unless(
            shading != Shading::Full,
            "Needs Shading: coarse or variable",
        )),
        "backend" | "coarsest-level" | "rate-balance" | "refine-edges" | "coarse-sample"
        | "composite" => unless(coarse, "Needs Shading: coarse"),
        "history" => unless(coarse, "Needs Shading: coarse").or(history(s)),
        "rate" | "rate-other" | "rate-combine" | "rate-level" | "rate-image" | "fovea-inner"
        | "fovea-outer" | "fovea-curve" => unless(
            shading != Shading::Full,
            "Needs Shading: coarse or variable",
        )
        .or(rate(key, s)),
        "rate-stage" | "force-rate" => unless(
            shading != Shading::Full,
            "Needs Shading: coarse or variable",
        ),
        "contrast" | "contrast-threshold" | "velocity-gain" => {
            unless(variable, "Needs Shading: variable").or(unless(
                uses(s, RateSource::Content),
                "Needs Coarse shading, Rate from: content",
            ))
        }
        "rate-4x4" => unless(variable, "Needs Shading: variable"),
        "ipd" | "eye-tangents" | "show" => unless(stereo, EYES),
        "eye-clipping" => unless(stereo, EYES).or(clipping(s, abilities)),
        "convergence" => unless(stereo, EYES).or(unless(
            s.stereo.frusta == EyeFrusta::Camera,
            "Needs empty Frusta: they have their own convergence",
        )),
        "lens" => unless(stereo, EYES).or(unless(
            s.stereo.output == Output::Headset,
            "Needs Output: headset",
        )),
        _ => None,
    }
}

const EYES: &str = "Needs Stereo, Eyes: other than off";
const EYE: &str = "Needs Shading: coarse or variable, or a comparison (X)";

/// Whether one of the sources of the rate is this one.
fn uses(s: &Settings, source: RateSource) -> bool {
    s.coarse.source == source
        || s.coarse.combine != RateCombine::First && s.coarse.other_source == source
}

fn rate(key: &str, s: &Settings) -> Option<&'static str> {
    let (has_effect, why) = match key {
        "rate-other" => (
            s.coarse.combine != RateCombine::First,
            "Needs Combine: coarser or finer",
        ),
        "rate-level" => (uses(s, RateSource::Constant), "Needs Rate from: constant"),
        "rate-image" => (uses(s, RateSource::Image), "Needs Rate from: image"),
        "fovea-inner" | "fovea-outer" | "fovea-curve" => {
            (uses(s, RateSource::Radii), "Needs Rate from: radii")
        }
        _ => (true, ""),
    };
    (!has_effect).then_some(why)
}

fn history(s: &Settings) -> Option<&'static str> {
    if s.coarse.composite != Composite::Light {
        Some("Needs Composite: light")
    } else if s.coarse.sample != CoarseSample::Center {
        Some("Needs Sample: center")
    } else if s.coarse.backend == CoarseBackend::Stencil {
        Some("Needs Backend: other than stencil")
    } else if s.picture.view != DebugView::Final {
        Some("Needs View: final")
    } else {
        None
    }
}

/// Whether the reduced renderer lacks a setting. One that is refused there as it is can be changed.
fn is_beyond_reduced(key: &str, s: &Settings) -> bool {
    let setting = Settings::ALL.iter().find(|setting| setting.key == key);
    let is_refused = || {
        let refused = s.validate(&wgpu::Limits {
            max_texture_dimension_2d: u32::MAX,
            ..Gpu::reduced_limits()
        });
        matches!(refused, Err(foveal::Error::Setting { name, .. }) if name == key)
    };
    setting.is_some_and(|setting| !setting.is_in_reduced_set()) && !is_refused()
}

fn clipping(s: &Settings, abilities: Abilities) -> Option<&'static str> {
    if !abilities.clip_distances {
        Some("Needs a device with clip distances; this one has none, and discards")
    } else if s.geometry.path != Geometry::Gbuffer {
        Some("Needs Geometry, Path: gbuffer")
    } else if s.stereo.mode == Stereo::Multiview {
        Some("Needs Eyes: other than multiview")
    } else {
        None
    }
}

/// Why a choice is impossible for a setting beside the others of `draft`, or on this device.
pub(crate) fn refused(
    (setting, choice): (&Setting, &str),
    draft: &Table,
    abilities: Abilities,
) -> Option<String> {
    if abilities.is_reduced && !setting.has_name_in_reduced_set(choice) {
        return Some(BEYOND_OPENGL.to_owned());
    }
    let mut table = draft.clone();
    table.insert(setting.key.to_owned(), Value::from(choice));
    match checked(&table) {
        Ok(_) => None,
        // What is wrong already is no fault of this value.
        Err(_) if checked(draft).is_err() => None,
        Err(cause) => Some(cause),
    }
}

/// The settings of a draft, where they make sense.
pub(crate) fn checked(draft: &Table) -> Result<Settings, String> {
    let settings = draft.clone().try_into::<Settings>();
    sound(settings.map_err(|error| error.message().to_owned())?)
}

/// Settings that make sense on some device.
pub(crate) fn sound(settings: Settings) -> Result<Settings, String> {
    let limits = wgpu::Limits {
        max_texture_dimension_2d: 16384,
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        ..wgpu::Limits::default()
    };
    match settings.validate(&limits) {
        Ok(()) => Ok(settings),
        Err(error) => Err(error.to_string()),
    }
}

/// The reference as it is drawn beside the chosen settings: at their size and exposure, and for
/// the same eyes. Where both have two, the reference keeps its own way to draw them.
///
/// # Errors
/// Why it cannot be drawn so.
pub(crate) fn beside(reference: &Settings, chosen: &Settings) -> Result<Settings, String> {
    sound(reference.clone().with(|s| {
        s.picture.width = chosen.picture.width;
        s.picture.height = chosen.picture.height;
        s.picture.exposure_stops = chosen.picture.exposure_stops;
        if s.is_stereo() != chosen.is_stereo() {
            s.stereo.mode = chosen.stereo.mode;
        }
        s.stereo.ipd_m = chosen.stereo.ipd_m;
        s.stereo.convergence_m = chosen.stereo.convergence_m;
        s.stereo.frusta = chosen.stereo.frusta;
        s.stereo.output = chosen.stereo.output;
        s.stereo.lens = chosen.stereo.lens;
    }))
}

/// What boxes, depth and a culling that is kept need.
pub(crate) fn of_culling(switch: Switch, s: &Settings) -> Option<&'static str> {
    match (switch, s.culling.mode) {
        (Switch::Boxes | Switch::Freeze, Culling::Off) => {
            Some("Needs Culling: auto, frustum or occlusion")
        }
        // Frames of auto need not have one.
        (Switch::Depth, Culling::Auto | Culling::Off | Culling::Frustum) => {
            Some("Needs Culling: occlusion")
        }
        _ => None,
    }
}

/// A switch of the culling card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Switch {
    Boxes,
    Depth,
    Freeze,
}

#[cfg(test)]
mod tests {
    use foveal::EyeClipping;

    use super::*;

    const CLIPS: Abilities = Abilities {
        clip_distances: true,
        is_reduced: false,
    };

    fn none(key: &str, s: &Settings) -> Option<&'static str> {
        missing(key, s, CLIPS, false)
    }

    #[test]
    fn every_rule_is_of_a_setting_and_can_be_met() {
        let (rules, _) = include_str!("needs.rs").split_once("#[cfg(test)]").unwrap();
        let is_key = |text: &&str| {
            let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            !text.is_empty() && text.chars().all(fits)
        };
        let keys: Vec<&str> = rules.split('"').skip(1).step_by(2).filter(is_key).collect();
        assert!(keys.len() > 50, "{keys:?}");
        for key in keys {
            assert!(Settings::ALL.iter().any(|s| s.key == key), "{key}");
        }
        let s = Settings::default();
        let noted: Vec<&str> = (Settings::ALL.iter())
            .map(|setting| setting.key)
            .filter(|key| none(key, &s).is_some())
            .collect();
        // Most settings of stages that are switched off by default.
        assert!(noted.len() > 25, "{noted:?}");
        let all_on = [
            Settings::default().with(|s| {
                s.culling.mode = Culling::Occlusion;
                s.antialiasing.mode = Antialiasing::Msaa;
                s.shading.mode = Shading::Coarse;
                s.coarse.source = RateSource::Radii;
                s.coarse.combine = RateCombine::Finer;
                s.stereo.mode = Stereo::Instanced;
                s.stereo.output = Output::Headset;
            }),
            Settings::default().with(|s| {
                s.geometry.path = Geometry::Visibility;
                s.shading.mode = Shading::Variable;
                s.coarse.source = RateSource::Content;
            }),
            Settings::default().with(|s| {
                s.shading.mode = Shading::Coarse;
                s.coarse.source = RateSource::Image;
                s.lighting.environment = EnvironmentSource::Image;
                s.lighting.ambient_occlusion = AmbientOcclusion::Screen;
            }),
            Settings::default().with(|s| {
                s.shading.mode = Shading::Coarse;
                s.lighting.shadows = Shadows::Contact;
            }),
        ];
        for key in noted {
            let met = all_on.iter().any(|s| none(key, s).is_none());
            assert!(met, "{key}");
        }
    }

    #[test]
    fn notes_name_settings_and_stages_as_the_panel_does() {
        let names: Vec<&str> = (Settings::ALL.iter())
            .flat_map(|setting| [setting.label, setting.stage])
            .collect();
        for setting in Settings::ALL {
            let Some(note) = none(setting.key, &Settings::default()) else {
                continue;
            };
            let name = note
                .strip_prefix("Needs ")
                .and_then(|n| n.split([':', ',']).next());
            assert!(name.is_some_and(|n| names.contains(&n)), "{note}");
        }
    }

    #[test]
    fn views_of_what_is_switched_off_are_refused_with_the_reason() {
        let refused = |key, name, settings: &Settings| {
            let draft = Table::try_from(settings).unwrap();
            refused(choice(key, name), &draft, Abilities::default())
        };
        let full = Settings::default();
        for view in ["rate", "blocks", "shaded", "unknown", "edges", "samples"] {
            assert!(refused("view", view, &full).is_some(), "{view}");
        }
        assert_eq!(refused("view", "depth", &full), None);
        let coarse = full.with(|s| s.shading.mode = Shading::Coarse);
        assert_eq!(refused("view", "rate", &coarse), None);
        assert!(refused("rate", "content", &coarse).is_some());
    }

    fn choice<'a>(key: &str, name: &'a str) -> (&'static Setting, &'a str) {
        let setting = Settings::ALL.iter().find(|setting| setting.key == key);
        (setting.unwrap(), name)
    }

    #[test]
    fn clip_planes_are_noted_where_the_device_has_none() {
        let s = Settings::default().with(|s| s.stereo.mode = Stereo::Instanced);
        assert_eq!(none("eye-clipping", &s), None);
        let note = missing("eye-clipping", &s, Abilities::default(), false);
        assert!(
            note.is_some_and(|n| n.contains("clip distances")),
            "{note:?}"
        );
        let discards = s.with(|s| s.stereo.clipping = EyeClipping::Discard);
        assert!(missing("eye-clipping", &discards, Abilities::default(), false).is_some());
    }

    #[test]
    fn the_reduced_renderer_has_what_its_set_has_and_lets_what_it_refuses_be_changed() {
        let reduced = Abilities {
            is_reduced: true,
            ..Abilities::default()
        };
        let note = |key: &str, s: &Settings| missing(key, s, reduced, false);
        let s = Settings::default();
        for key in [
            "aa",
            "shading",
            "light-radius",
            "view",
            "display",
            "samples",
        ] {
            assert!(note(key, &s).is_some_and(|n| n.contains("OpenGL")), "{key}");
        }
        for key in ["exposure", "culling", "stereo", "environment", "shadows"] {
            assert_eq!(note(key, &s), None, "{key}");
        }
        let coarse = s.with(|s| s.shading.mode = Shading::Coarse);
        assert_eq!(note("shading", &coarse), None);
        assert!(note("aa", &coarse).is_some());
        let draft = Table::try_from(Settings::default()).unwrap();
        let refused = |choice| refused(choice, &draft, reduced);
        let why = refused(choice("shadows", "contact"));
        assert!(why.is_some_and(|why| why.contains("OpenGL")));
        assert_eq!(refused(choice("shadows", "soft")), None);
    }

    #[test]
    fn depth_needs_occlusion_culling_and_boxes_any() {
        let s = Settings::default();
        assert_eq!(s.culling.mode, Culling::Auto);
        assert!(of_culling(Switch::Depth, &s).is_some());
        assert_eq!(of_culling(Switch::Boxes, &s), None);
        let occlusion = s.clone().with(|s| s.culling.mode = Culling::Occlusion);
        assert_eq!(of_culling(Switch::Depth, &occlusion), None);
        let off = s.with(|s| s.culling.mode = Culling::Off);
        assert!(of_culling(Switch::Boxes, &off).is_some());
        assert!(of_culling(Switch::Freeze, &off).is_some());
    }

    #[test]
    fn the_reference_has_the_picture_of_the_chosen_side() {
        let chosen = Settings::default().with(|s| {
            s.picture.exposure_stops = 2.0;
            s.stereo.mode = Stereo::Instanced;
            s.stereo.ipd_m = 0.1;
            s.stereo.convergence_m = 5.0;
            s.stereo.lens = foveal::Lens::Dk1;
            s.shading.mode = Shading::Coarse;
        });
        for output in [Output::SideBySide, Output::Anaglyph, Output::Headset] {
            let chosen = chosen.clone().with(|s| s.stereo.output = output);
            let drawn = beside(&Settings::default(), &chosen).unwrap();
            assert_eq!(drawn.picture_size(), chosen.picture_size());
            assert_eq!(drawn.stereo, chosen.stereo);
            assert_eq!(drawn.picture, chosen.picture);
            assert_eq!(drawn.shading.mode, Shading::Full);
            // A way to draw two eyes can be compared with another.
            let two = Settings::default().with(|s| s.stereo.mode = Stereo::TwoPass);
            assert_eq!(beside(&two, &chosen).unwrap().stereo.mode, Stereo::TwoPass);
            let flat = beside(&chosen, &Settings::default()).unwrap();
            assert_eq!(flat.picture_size(), Settings::default().picture_size());
        }
    }

    #[test]
    fn a_reference_that_cannot_have_the_same_eyes_is_refused_with_the_reason() {
        let lens = Settings::default().with(|s| {
            s.stereo.mode = Stereo::Instanced;
            s.stereo.output = Output::Headset;
            s.shading.mode = Shading::Coarse;
            s.coarse.source = RateSource::Lens;
        });
        let why = beside(&lens, &Settings::default()).unwrap_err();
        assert!(why.contains("lens"), "{why}");
    }

    #[test]
    fn the_eye_counts_while_sides_are_compared() {
        let s = Settings::default();
        assert!(missing("display", &s, CLIPS, false).is_some());
        assert_eq!(missing("display", &s, CLIPS, true), None);
    }
}
