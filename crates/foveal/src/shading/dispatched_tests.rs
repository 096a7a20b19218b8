//! Every pixel by a dispatch, held to every pixel by a draw.

use foveal_generate as generate;

use super::every_pixel::dispatches;
use crate::testing::{Film, gpu, picture, rendered, rounds_alike, shifted, small};
use crate::{
    AmbientOcclusion, Antialiasing, EnvironmentSource, Geometry, LightingPass, Settings, Shading,
    Shadows, Stereo,
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
