//! What may differ between two sides that show the same.

use foveal::{
    Antialiasing, CoarseBackend, CoarseSample, Composite, Culling, CullingEyes, EyeClipping,
    Geometry, LightAssignment, LightingPass, MaterialDispatch, RateCombine, RateSource, Settings,
    Shading, Shadows, Stereo,
};

use crate::placement::Placement;
use crate::settings::{self, Chance};

/// Two sides, how far apart a byte of their pictures may be, the share of bytes that may be farther,
/// whether the last frame alone counts, whether the second side draws no other, what it is set to in
/// the frames before the last of motion, where its world lies, and whether the reduced renderer
/// draws it.
pub(crate) struct Pair {
    pub(crate) name: &'static str,
    pub(crate) sides: [Settings; 2],
    pub(crate) tolerance: u8,
    pub(crate) beyond: f32,
    pub(crate) at_rest: bool,
    pub(crate) skips: bool,
    pub(crate) before: Option<Settings>,
    pub(crate) placement: Option<Placement>,
    pub(crate) is_reduced: bool,
}

pub(crate) fn pair(chance: &mut Chance<'_>, both: &Settings, before: &mut Chance<'_>) -> Pair {
    type Change<'a> = &'a dyn Fn(&mut Settings);
    let sides = |a: Change<'_>, b: Change<'_>| [both.clone().with(a), both.clone().with(b)];
    let of = |name, sides| Pair {
        name,
        sides,
        tolerance: 0,
        beyond: 0.0,
        at_rest: false,
        skips: false,
        before: None,
        placement: None,
        is_reduced: false,
    };
    // Tiles lie elsewhere in the atlas of shadows, so that a texel at an edge may turn.
    let has_shadows = both.lighting.shadows != Shadows::Off;
    match chance.of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]) {
        0 => {
            let eyes = chance.of(&[CullingEyes::Each, CullingEyes::Shared]);
            let scale = chance.of(&[4, 1, 2, 7]);
            let radius_m = chance.of(&[0.0, 0.3]);
            let culled = |s: &mut Settings| {
                s.culling.mode = Culling::Occlusion;
                s.culling.eyes = eyes;
                s.culling.buffer_scale = scale;
                s.culling.radius_m = radius_m;
            };
            of(
                "culling",
                sides(&|s| s.culling.mode = Culling::Off, &culled),
            )
        }
        1 => {
            let clipping = chance.of(&[EyeClipping::Discard, EyeClipping::Clip]);
            let side = |mode| {
                move |s: &mut Settings| {
                    s.stereo.mode = mode;
                    s.stereo.clipping = clipping;
                }
            };
            of(
                "eyes",
                sides(&side(Stereo::TwoPass), &side(Stereo::Instanced)),
            )
        }
        2 => {
            let side = |dispatch| {
                move |s: &mut Settings| {
                    s.geometry.path = Geometry::Visibility;
                    s.geometry.material_dispatch = dispatch;
                }
            };
            let [a, b] = [MaterialDispatch::Family, MaterialDispatch::Material];
            of("materials", sides(&side(a), &side(b)))
        }
        3 => of("draws", sides(&|s| s.geometry.merge_draws = false, &|_| ())),
        4 => of("again", sides(&|_| (), &|_| ())),
        5 => {
            let common = |s: &mut Settings| {
                s.stereo.mode = Stereo::Off;
                if s.antialiasing.mode == Antialiasing::Ssaa {
                    s.antialiasing.mode = Antialiasing::Msaa;
                }
            };
            let full = |s: &mut Settings| {
                common(s);
                s.shading.mode = Shading::Full;
            };
            let kept = |s: &mut Settings| {
                common(s);
                s.shading.mode = Shading::Coarse;
                s.coarse.backend = CoarseBackend::Compute;
                s.coarse.composite = Composite::Light;
                s.coarse.sample = CoarseSample::Center;
                s.coarse.history = true;
            };
            Pair {
                at_rest: true,
                ..of("light at rest", sides(&full, &kept))
            }
        }
        6 => {
            let every = |s: &mut Settings| {
                s.shading.mode = Shading::Variable;
                s.coarse.source = RateSource::Constant;
                s.coarse.combine = RateCombine::First;
                s.coarse.constant_level = 0;
                s.stereo.mode = Stereo::Off;
            };
            let full = |s: &mut Settings| {
                s.shading.mode = Shading::Full;
                s.stereo.mode = Stereo::Off;
            };
            Pair {
                tolerance: 1,
                ..of("every pixel", sides(&full, &every))
            }
        }
        7 => {
            let side = |pass| move |s: &mut Settings| s.lighting.pass = pass;
            let [a, b] = [LightingPass::Fragment, LightingPass::Compute];
            of("passes", sides(&side(a), &side(b)))
        }
        8 => {
            let full = |s: &mut Settings| {
                s.shading.mode = Shading::Full;
                // Else it follows the size of the scene as it was set.
                s.lighting.ambient_occlusion_radius_m = 0.4;
            };
            Pair {
                beyond: if has_shadows { 0.005 } else { 0.0 },
                at_rest: true,
                skips: true,
                ..of("afresh", sides(&full, &full))
            }
        }
        9 => {
            let side = |s: &mut Settings| {
                if s.shading.mode == Shading::Variable {
                    s.shading.mode = Shading::Full;
                }
                s.lighting.ambient_occlusion_radius_m = 0.4;
            };
            Pair {
                beyond: if has_shadows { 0.005 } else { 0.0 },
                at_rest: true,
                before: Some(settings::settings(before)),
                ..of("set", sides(&side, &side))
            }
        }
        10 => {
            let side = |path| {
                move |s: &mut Settings| {
                    s.shading.mode = Shading::Full;
                    s.geometry.path = path;
                }
            };
            let [a, b] = [Geometry::Gbuffer, Geometry::Visibility];
            // Msaa sorts what a pixel shows into surfaces by samples, or by triangles in a visibility buffer.
            let is_smoothed = both.antialiasing.mode != Antialiasing::None;
            Pair {
                tolerance: 1,
                beyond: if is_smoothed { 0.02 } else { 0.002 },
                ..of("geometry", sides(&side(a), &side(b)))
            }
        }
        11 | 12 => {
            let scale = chance.of(&[4.0, 0.25, 0.015_625]);
            let turned = chance.of(&[false, true]);
            let placement = Placement { scale, turned };
            let side = |s: &mut Settings| {
                s.lighting.ambient_occlusion_radius_m = 0.4;
                // Where it searches for casters turns with the tiles.
                if turned && s.lighting.shadows == Shadows::Contact {
                    s.lighting.shadows = Shadows::Soft;
                }
            };
            let [here, mut there] = sides(&side, &side);
            placement.settings(&mut there);
            // Lamps beyond some range draw tiles from the same distance on, so that depths are
            // rounded elsewhere; and tiles of a turned world do not turn with it.
            let has_shadows = here.lighting.shadows != Shadows::Off;
            let is_rounded = turned || has_shadows;
            let most_beyond = if turned && has_shadows { 0.06 } else { 0.02 };
            Pair {
                tolerance: if is_rounded { 2 } else { 0 },
                beyond: if is_rounded { most_beyond } else { 0.0 },
                placement: Some(placement),
                ..of("placed", [here, there])
            }
        }
        13 => {
            let side = |s: &mut Settings| {
                s.geometry.path = Geometry::Gbuffer;
                s.antialiasing.mode = Antialiasing::None;
                s.shading.mode = Shading::Full;
                s.lighting.pass = LightingPass::Fragment;
                if s.lighting.shadows == Shadows::Contact {
                    s.lighting.shadows = Shadows::Soft;
                }
            };
            Pair {
                tolerance: 2,
                beyond: 0.005,
                is_reduced: true,
                ..of("reduced", sides(&side, &side))
            }
        }
        _ => Pair {
            tolerance: 1,
            ..of(
                "lights",
                sides(&|s| s.lighting.assignment = LightAssignment::Brute, &|s| {
                    s.lighting.assignment = LightAssignment::Clustered
                }),
            )
        },
    }
}
