//! Every pixel by a dispatch, held to every pixel by a draw.

use foveal_generate as generate;

use super::kind::dispatches;
use crate::testing::{Film, gpu, picture, rate_cells, rendered, rounds_alike, shifted, small};
use crate::{
    AmbientOcclusion, Antialiasing, Composite, EnvironmentSource, Geometry, LightingPass,
    RateSource, RateStage, Settings, Shading, Shadows, Stereo,
};

/// The same settings by each pass.
fn both(settings: &Settings) -> [Settings; 2] {
    [LightingPass::Fragment, LightingPass::Compute]
        .map(|pass| settings.clone().with(|s| s.lighting.pass = pass))
}

/// Equal to the byte; where the driver rounds as it likes, nearly.
fn assert_alike(a: &[u8], b: &[u8], what: &str) {
    let off = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let (most, by) = (off.clone().filter(|d| *d > 0).count(), off.max());
    let is_near = !rounds_alike() && most <= a.len() / 100 && by <= Some(2);
    assert!(most == 0 || is_near, "{what}: {most} bytes by {by:?}");
}

#[test]
fn a_dispatch_shades_every_pixel_as_the_draw_does() {
    type Way = fn(&mut Settings);
    let ways: [(&str, Way); 7] = [
        ("plain", |_| {}),
        ("shadows", |s| s.lighting.shadows = Shadows::Soft),
        ("sky, ambient occlusion", |s| {
            s.lighting.environment = EnvironmentSource::Sky;
            s.lighting.ambient_occlusion = AmbientOcclusion::Screen;
        }),
        ("visibility", |s| s.geometry.path = Geometry::Visibility),
        ("msaa", |s| s.antialiasing.mode = Antialiasing::Msaa),
        ("ssaa", |s| s.antialiasing.mode = Antialiasing::Ssaa),
        ("two eyes", |s| s.stereo.mode = Stereo::Instanced),
    ];
    // No multiples of a workgroup's sides.
    let settings = small(157, 101);
    for scene in [generate::cornell(), generate::alpha()] {
        for (name, way) in ways {
            let [draw, dispatch] = both(&settings.clone().with(way))
                .map(|settings| picture(&rendered(&scene, &scene.cameras[0], &settings)));
            assert_alike(&draw, &dispatch, &format!("{}, {name}", scene.name));
        }
    }
}

#[test]
fn the_pass_is_the_one_asked_for_and_on_graphics_cards_the_dispatch() {
    let [draw, dispatch] = both(&small(64, 48));
    assert!(!dispatches(gpu(), &draw) && dispatches(gpu(), &dispatch));
    let discrete = gpu().adapter_stats().kind == "discrete-gpu";
    assert_eq!(dispatches(gpu(), &small(64, 48)), discrete);
}

#[test]
fn a_dispatch_reprojects_kept_light_as_the_draw_does() {
    let scene = generate::by_name("demo:1000").expect("a scene of that name");
    let camera = &scene.cameras[0];
    for stereo in [Stereo::Off, Stereo::Instanced] {
        let settings = small(157, 101).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.stereo.mode = stereo;
            s.rate.force = true;
        });
        let mut films = both(&settings).map(|settings| Film::new(&scene, &settings));
        // In motion, and then at rest.
        for frame in 0..12 {
            let there = shifted(camera, 0.03 * frame.min(6) as f32);
            let pictures = films.each_mut().map(|film| {
                film.draw(&there);
                picture(&film.renderer)
            });
            let [draw, dispatch] = &pictures;
            assert_alike(draw, dispatch, &format!("{stereo:?}, frame {frame}"));
        }
    }
}

#[test]
fn a_dispatch_finds_the_same_rates_as_the_draw() {
    let scene = generate::by_name("demo:1000").expect("a scene of that name");
    type Way = fn(&mut Settings);
    let ways: [(&str, Way); 4] = [
        ("gbuffer", |_| {}),
        ("seen by depth", |s| {
            s.geometry.path = Geometry::Visibility;
            s.coarse.composite = Composite::Smooth;
            s.rate.stage = RateStage::Both;
        }),
        ("unbalanced", |s| s.coarse.balance = false),
        ("two eyes", |s| s.stereo.mode = Stereo::Instanced),
    ];
    for (name, way) in ways {
        let settings = small(157, 101).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = false;
            s.coarse.source = RateSource::Radii;
            s.coarse.fovea_inner = 0.1;
            s.eye.gaze = [0.3, 0.6];
            s.rate.force = true;
            way(s);
        });
        let [draw, dispatch] = both(&settings).map(|settings| {
            let renderer = rendered(&scene, &scene.cameras[0], &settings);
            let coarse = renderer.targets().coarse.as_ref().expect("coarse shading");
            let rate = &coarse.rate;
            let levels: Vec<_> = (rate.pyramid.range())
                .map(|level| rate_cells(&rate.pyramid, level))
                .collect();
            (levels, rate_cells(&rate.owner, 1))
        });
        let owners: std::collections::BTreeSet<u8> = draw.1.iter().copied().collect();
        assert!(owners.len() > 5, "{name}: {owners:?}");
        if rounds_alike() {
            assert!(draw == dispatch, "{name}");
        } else {
            let off = draw.1.iter().zip(&dispatch.1).filter(|(a, b)| a != b);
            assert!(off.count() * 100 <= draw.1.len(), "{name}");
        }
    }
}
