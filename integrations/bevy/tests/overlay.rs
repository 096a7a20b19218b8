//! The overlay in a picture.
//!
//! Needs a Vulkan driver; Mesa's lavapipe, which draws on the processor, will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

#[path = "../examples/shared/mod.rs"]
mod shared;

use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionOverlay, CpuOcclusionOverlayCamera};
use shared::headless::Headless;
use shared::house::House;
use shared::modes::Mode;
use shared::twice::pixels_that_differ;

#[test]
fn the_overlay_shows_boxes_and_depth_while_its_resource_exists() {
    let size = UVec2::new(200, 120);
    let house = House {
        side: 3,
        furniture: 10,
        doors: false,
        lights: 0,
        range: 15.0,
    };
    let mut app = Headless::new(size, Msaa::Off, |world| {
        house.spawn(world);
        Mode::All.set(world);
    });
    let camera = app.camera;
    *app.world().get_mut::<Transform>(camera).unwrap() = house.walker(0.3);
    let draw = |app: &mut Headless, overlay: Option<CpuOcclusionOverlay>| {
        match overlay {
            Some(overlay) => app.world().insert_resource(overlay),
            None => {
                app.world().remove_resource::<CpuOcclusionOverlay>();
            }
        }
        for _ in 0..8 {
            app.frame();
        }
        app.picture()
    };
    let none = CpuOcclusionOverlay {
        occluders: false,
        hidden: false,
        depth_share: 0.0,
        ..default()
    };
    let plain = draw(&mut app, None);
    let count = |picture: &[u8], is: fn(&[u8; 4]) -> bool| {
        picture.as_chunks::<4>().0.iter().filter(|p| is(p)).count()
    };
    let green = |p: &[u8; 4]| p[1] > 120 && p[1] > p[0] + 60 && p[1] > p[2] + 40;
    let red = |p: &[u8; 4]| p[0] > 120 && p[0] > p[1] + 60 && p[0] > p[2] + 60;

    let occluders = CpuOcclusionOverlay {
        occluders: true,
        ..none
    };
    let shown = draw(&mut app, Some(occluders));
    assert!(count(&shown, green) > count(&plain, green) + 50);
    let hidden = CpuOcclusionOverlay {
        hidden: true,
        ..none
    };
    let shown = draw(&mut app, Some(hidden));
    assert!(count(&shown, red) > count(&plain, red) + 50);

    let depth = CpuOcclusionOverlay {
        depth_share: 0.25,
        ..none
    };
    let shown = draw(&mut app, Some(depth));
    let cameras = |app: &mut Headless| {
        let world = app.world();
        world.query::<&Camera>().iter(world).count()
    };
    assert_eq!(cameras(&mut app), 2);
    let world = app.world();
    let mut theirs =
        world.query_filtered::<Entity, (With<Camera3d>, Without<CpuOcclusionOverlayCamera>)>();
    assert_eq!(theirs.single(world).unwrap(), camera);
    let differs = |x: usize, y: usize| {
        let at = (y * size.x as usize + x) * 4;
        plain[at..at + 4] != shown[at..at + 4]
    };
    let (mut inside, mut outside) = (0, 0);
    for (x, y) in (0..120).flat_map(|y| (0..200).map(move |x| (x, y))) {
        let in_corner = x < 50 && y >= 90;
        *if in_corner { &mut inside } else { &mut outside } += usize::from(differs(x, y));
    }
    assert!(inside > 1_000, "{inside}");
    assert_eq!(outside, 0);

    let after = draw(&mut app, None);
    assert_eq!(pixels_that_differ(&plain, &after), 0);
    assert_eq!(cameras(&mut app), 1);
}
