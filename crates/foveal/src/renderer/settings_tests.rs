//! Settings that change while frames are drawn: what follows is what a new renderer draws.

use foveal_cull::Visibility;
use foveal_generate as generate;
use glam::Mat4;
use pollster::block_on;

use crate::testing::{Film, add, gpu, picture, rendered, small};
use crate::{Culling, Error, Geometry, Output, RateImage, RateSource, Settings, Shading, Stereo};

#[test]
fn eyes_that_begin_and_end_to_look_apart_have_their_own_pictures() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let alike = small(64, 48).with(|s| {
        s.stereo.mode = Stereo::Instanced;
        s.stereo.output = Output::SideBySide;
        s.stereo.ipd_m = 0.0;
        s.shading.mode = Shading::Coarse;
    });
    let apart = alike.clone().with(|s| s.stereo.gaze_shift = [0.05, 0.0]);
    for (before, now) in [(&alike, &apart), (&apart, &alike)] {
        let mut renderer = rendered(&scene, camera, before);
        block_on(renderer.set_settings(now)).expect("they fit");
        renderer.redraw(camera);
        let expected = rendered(&scene, camera, now);
        assert!(picture(&renderer) == picture(&expected));
        let [ours, theirs] = [&renderer, &expected].map(|r| block_on(r.read_radiance()).unwrap());
        assert_eq!(
            (ours.width, ours.rgb.len()),
            (theirs.width, theirs.rgb.len())
        );
    }
}

#[test]
fn pictures_are_opaque_black_before_a_frame() {
    let ways: [&dyn Fn(&mut Settings); 3] = [&|_| (), &|s| s.picture.render_scale = 0.5, &|s| {
        s.stereo.mode = Stereo::Instanced;
        s.stereo.output = Output::SideBySide;
    }];
    let scene = generate::cornell();
    for way in ways {
        let settings = small(64, 48).with(|s| way(s));
        let mut renderer = rendered(&scene, &scene.cameras[0], &settings);
        let resized = settings.with(|s| s.picture.width = 60);
        block_on(renderer.set_settings(&resized)).expect("they fit");
        let (width, height) = resized.picture_size();
        let black = [0, 0, 0, 255].repeat((width * height) as usize);
        assert!(picture(&renderer) == black);
    }
}

#[test]
fn a_picture_of_rates_that_no_texture_holds_is_refused_and_costs_nothing() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let settings = small(64, 48).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Image;
    });
    let mut renderer = rendered(&scene, camera, &settings);
    let before = picture(&renderer);
    let wide = gpu().device.limits().max_texture_dimension_2d + 1;
    let image = RateImage::new(wide, 1, vec![255; wide as usize]).expect("a row");
    let refused = renderer.set_rate_image(image);
    assert!(matches!(refused, Err(Error::Limit { .. })), "{refused:?}");
    renderer.redraw(camera);
    assert!(picture(&renderer) == before);
}

#[test]
fn pictures_whose_pixels_no_buffer_lists_are_refused() {
    let limits = wgpu::Limits {
        max_storage_buffer_binding_size: 128 << 20,
        max_texture_dimension_2d: 8192,
        ..crate::Gpu::required_limits()
    };
    let of = |height: u32, change: &dyn Fn(&mut Settings)| {
        small(8192, height).with(|s| change(s)).validate(&limits)
    };
    let ways: [&dyn Fn(&mut Settings); 3] = [
        &|s| s.shading.mode = Shading::Coarse,
        &|s| s.shading.mode = Shading::Variable,
        &|s| s.geometry.path = Geometry::Visibility,
    ];
    for way in ways {
        assert!(of(4096, way).is_ok());
        assert!(matches!(of(4097, way), Err(Error::Limit { .. })));
    }
    assert!(of(8192, &|_| ()).is_ok());
}

#[test]
fn culling_that_is_frozen_stays_so_through_other_settings() {
    let scene = generate::by_name("demo:1000").expect("a generated scene");
    let settings = small(96, 64).with(|s| s.culling.mode = Culling::Frustum);
    let camera = scene.cameras[0].clone();
    let mut turned = camera.clone();
    turned.world_from_view *= Mat4::from_rotation_y(2.0);
    let mut film = Film::new(&scene, &settings);
    let found = |film: &Film| -> Vec<Visibility> {
        let culling = film.renderer.stages.culling.as_ref().expect("culls");
        culling.visibility().to_vec()
    };
    let drawn = film.draw(&camera);
    let expected = found(&film);
    film.renderer.freeze_culling(true);
    for change in [
        &(|s: &mut Settings| s.picture.exposure_stops = 1.0) as &dyn Fn(&mut Settings),
        &|s| s.picture.width = 80,
    ] {
        let settings = film.renderer.settings().clone().with(|s| change(s));
        block_on(film.renderer.set_settings(&settings)).expect("they fit");
        let stats = film.draw(&turned);
        assert!(found(&film) == expected);
        assert_eq!(stats.objects_visible, drawn.objects_visible);
    }
    film.renderer.freeze_culling(false);
    film.draw(&turned);
    assert!(found(&film) != expected);
}

/// Wider lines have other contrasts around them.
#[test]
fn rates_follow_the_width_of_lines() {
    let mut scene = generate::cornell();
    let (strokes, _) = crate::forward::strokes_tests::strokes();
    let camera = scene.cameras[0].clone();
    let ahead = camera.world_from_view * Mat4::from_translation(glam::Vec3::new(0.0, 0.0, -2.0));
    for mesh in strokes.meshes {
        add(&mut scene, mesh, strokes.materials[0].clone(), ahead);
    }
    let thin = small(96, 64).with(|s| {
        s.shading.mode = Shading::Variable;
        s.coarse.source = RateSource::Content;
    });
    let wide = thin.clone().with(|s| s.geometry.line_width_px = 9.0);
    let at_rest = |film: &mut Film| {
        (0..8).for_each(|_| drop(film.draw(&camera)));
        picture(&film.renderer)
    };
    let mut film = Film::new(&scene, &thin);
    let before = at_rest(&mut film);
    block_on(film.renderer.set_settings(&wide)).expect("they fit");
    let after = at_rest(&mut film);
    assert!(before != after);
    assert!(after == at_rest(&mut Film::new(&scene, &wide)));
}

/// What makes a renderer holds it on the stack several times, without optimization.
#[test]
fn a_renderer_takes_little_stack() {
    let size = size_of::<crate::Renderer>();
    assert!(size < 8 << 10, "{size} bytes");
}
