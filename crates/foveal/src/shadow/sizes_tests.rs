//! Tiles as coarse as the samples that show them: against the twin and uniform ones.

use foveal_generate as generate;

use super::tests::{compared_with_twin, room, shadowed};
use crate::testing::{Film, picture, rendered};
use crate::{RateSource, Settings, Shading, ShadowSizes, Shadows};

/// Coarse shading whose sample of 2 x 2 pixels is the lower right one, left as it is.
fn coarse_by_eye(shadows: Shadows, sizes: ShadowSizes) -> Settings {
    shadowed(shadows).with(|s| {
        s.lighting.shadow_sizes = sizes;
        s.shading.mode = Shading::Coarse;
        s.rate.force = true;
        s.coarse.history = false;
        s.coarse.composite = crate::Composite::Nearest;
        s.coarse.coarsest_level = 1;
        s.coarse.refine_edges = crate::RefineEdges::Off;
        s.eye.quality_jod = 8.0;
        s.eye.display = "120".parse().unwrap();
        s.eye.gaze = [0.1, 0.1];
    })
}

#[test]
fn tiles_as_coarse_as_the_samples_equal_the_twin() {
    let mut scene = room();
    generate::add_point_lights(&mut scene, 12, 3);
    for light in &mut scene.lights {
        light.range_m = light.range_m.map(|range| 0.4 * range);
    }
    for shadows in [Shadows::Hard, Shadows::Soft] {
        let settings = coarse_by_eye(shadows, ShadowSizes::Rate).with(|s| {
            s.picture.width = 300;
            s.picture.height = 200;
        });
        let (renderer, [compared, off, dark]) =
            compared_with_twin(&scene, &settings, |[x, y]| x % 2 == 1 && y % 2 == 1);
        let words = renderer.shadows().rows().iter().flatten();
        let narrow = words.filter(|&word| word >> 24 == 0x82).count();
        assert!(narrow > 5, "{narrow} tiles that are coarser");
        assert!(compared > 5_000 && dark > 500, "{compared}, {dark}");
        assert!(
            off * 200 < compared,
            "{shadows:?}: {off} of {compared} differ"
        );
    }
}

#[test]
fn only_coarse_shading_by_the_eye_makes_tiles_coarser() {
    let scene = room();
    let camera = &scene.cameras[0];
    let drawn = |change: &dyn Fn(&mut Settings)| {
        let settings = coarse_by_eye(Shadows::Soft, ShadowSizes::Rate);
        let mut renderer = rendered(&scene, camera, &settings.with(|s| change(s)));
        (
            renderer.redraw(camera).shadows.unwrap().texels,
            picture(&renderer),
        )
    };
    let by_view = |change: &dyn Fn(&mut Settings)| {
        drawn(&|s| {
            change(s);
            s.lighting.shadow_sizes = ShadowSizes::View;
        })
    };
    let coarser = drawn(&|_| ());
    assert!(coarser.0 < by_view(&|_| ()).0);
    let full = |s: &mut Settings| s.shading.mode = Shading::Full;
    let variable = |s: &mut Settings| {
        s.shading.mode = Shading::Variable;
        s.coarse.source = RateSource::Content;
    };
    let radii = |s: &mut Settings| s.coarse.source = RateSource::Radii;
    for change in [&full as &dyn Fn(&mut Settings), &variable, &radii] {
        assert_eq!(drawn(change), by_view(change));
    }
}

#[test]
fn what_is_seen_at_full_rate_has_the_shadows_of_uniform_tiles() {
    let mut scene = room();
    generate::add_point_lights(&mut scene, 12, 3);
    for light in &mut scene.lights {
        light.range_m = light.range_m.map(|range| 0.4 * range);
    }
    let camera = &scene.cameras[0];
    let sizes = |sizes| {
        let settings = coarse_by_eye(Shadows::Soft, sizes).with(|s| {
            s.picture.width = 300;
            s.picture.height = 200;
        });
        (picture(&rendered(&scene, camera, &settings)), settings)
    };
    let ((view, settings), (rate, _)) = (sizes(ShadowSizes::View), sizes(ShadowSizes::Rate));
    let eyes = crate::stereo::eyes(&settings, camera).unwrap();
    let request = crate::rate::RequestUniform::new(&settings, &eyes, None);
    let (mut fine, mut differ_there, mut differ_elsewhere) = (0, 0, 0);
    for (i, (a, b)) in view.chunks_exact(4).zip(rate.chunks_exact(4)).enumerate() {
        let (x, y) = (i as u32 % 300, i as u32 / 300);
        let is_fine = request.level(&settings, x, y, None) == 0;
        fine += u32::from(is_fine);
        differ_there += u32::from(is_fine && a != b);
        differ_elsewhere += u32::from(!is_fine && a != b);
    }
    // Tiles may lie elsewhere in the atlas.
    assert!(
        fine > 150 && differ_there * 200 <= fine,
        "{differ_there} of {fine}"
    );
    assert!(differ_elsewhere > 20, "{differ_elsewhere}");
}

#[test]
fn a_gaze_that_comes_back_finds_its_tiles() {
    let mut scene = room();
    generate::add_point_lights(&mut scene, 12, 3);
    let camera = scene.cameras[0].clone();
    let at = |gaze| coarse_by_eye(Shadows::Soft, ShadowSizes::Rate).with(|s| s.eye.gaze = gaze);
    let mut film = Film::new(&scene, &at([0.1, 0.1]));
    let mut look = |gaze| {
        pollster::block_on(film.renderer.set_settings(&at(gaze))).unwrap();
        let stats = film.draw(&camera).shadows.unwrap();
        (stats.tiles_drawn, stats.texels, picture(&film.renderer))
    };
    let first = look([0.1, 0.1]);
    let (drawn, texels, _) = look([0.9, 0.9]);
    assert!(drawn > 0 && texels != first.1);
    let back = look([0.1, 0.1]);
    assert_eq!((back.0, back.1), (0, first.1));
    assert_eq!(back.2, first.2);
}
