//! Tiles in which something moves: what is drawn again of them is what all of them would be.

use std::collections::BTreeMap;

use foveal_generate as generate;
use glam::Vec3;

use super::atlas::Tile;
use super::culling_tests::{market, shift, walked};
use super::tests::shadowed;
use crate::testing::{Film, picture, texels};
use crate::{Culling, Settings, ShadowStats, Shadows};

/// What the atlas holds in the tiles that the last frame looked into.
fn held(film: &Film) -> Vec<(Tile, Vec<f32>)> {
    let stage = film.renderer.shadows();
    let side = stage.atlas().texture().width();
    let atlas: Vec<f32> = texels(stage.atlas());
    let of = |tile: Tile| {
        let rows = tile.y..tile.y + tile.side();
        let texels = rows.flat_map(|y| {
            let first = (y * side + tile.x) as usize;
            atlas[first..first + tile.side() as usize].iter().copied()
        });
        (tile, texels.collect())
    };
    stage.tiles().into_iter().map(of).collect()
}

fn settings(culling: Culling) -> Settings {
    shadowed(Shadows::Soft).with(|s| s.culling.mode = culling)
}

/// Draws the market from a walk and a turn, with a few things on the move, in two films: the second
/// draws whole tiles in each frame. Gives what shadows did in the frames of the first.
fn films(culling: Culling, compare: impl Fn(&Film, &Film)) -> Vec<ShadowStats> {
    let mut scene = market();
    let [mut patched, mut whole] = [(); 2].map(|()| Film::new(&scene, &settings(culling)));
    let mut stats = Vec::new();
    for (frame, step) in [0, 0, 0, 1, 1, 5, 5, 1, 1].into_iter().enumerate() {
        let instances = scene.instances.len();
        // There and back, so that things enter and leave what tiles see.
        let by = Vec3::new((frame as f32).sin(), 0.1 * (frame as f32).cos(), 0.3);
        shift(&mut scene, (7..instances).step_by(97), by);
        if frame % 3 == 2 {
            let object = &mut scene.objects[40 + frame];
            object.visible = !object.visible;
        }
        let camera = walked(&scene, step);
        whole.renderer.shadows_mut().draw_whole(true);
        for film in [&mut patched, &mut whole] {
            pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
            stats.push(film.draw(&camera).shadows.unwrap());
        }
        assert_eq!(stats.pop().unwrap().casters_beside, 0);
        compare(&patched, &whole);
    }
    stats
}

#[test]
fn patches_of_tiles_give_the_atlas_that_whole_tiles_give() {
    let stats = films(Culling::Off, |patched, whole| {
        let patched: BTreeMap<_, _> = held(patched).into_iter().collect();
        let whole = held(whole);
        assert!(whole.len() > 20, "{}", whole.len());
        for (tile, texels) in whole {
            assert!(patched[&tile] == texels, "{tile:?}");
        }
    });
    let sum = |of: fn(&ShadowStats) -> u64| stats[1..].iter().map(of).sum::<u64>();
    let (beside, in_reach) = (sum(|s| s.casters_beside), sum(|s| s.casters_in_reach));
    assert!(beside * 5 > in_reach, "{beside} of {in_reach}");
}

#[test]
fn patches_of_tiles_give_the_picture_that_whole_tiles_give() {
    let stats = films(Culling::Occlusion, |patched, whole| {
        assert!(picture(&patched.renderer) == picture(&whole.renderer));
    });
    assert!(stats[1..].iter().any(|s| s.casters_beside > 0));
    assert!(stats[1..].iter().any(|s| s.casters_unneeded > 0));
}

/// The figures of docs/decisions/0257-patches-of-tiles.md.
#[test]
#[ignore = "takes a minute, and measures"]
fn a_thing_beside_a_lantern_takes_whole_tiles_or_patches() {
    let scene = generate::by_name("demo").unwrap();
    let camera = &scene.cameras[0];
    let nearest = |at: Vec3, places: &mut dyn Iterator<Item = (usize, Vec3)>| {
        let distance = |place: &(usize, Vec3)| place.1.distance(at);
        places.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let [_, _, back, eye] = [0, 1, 2, 3].map(|i| camera.world_from_view.col(i).truncate());
    let lamps = scene.lights.iter().filter(|light| light.range_m.is_some());
    let mut lamps = lamps.map(|light| light.position).enumerate();
    let (_, lamp) = nearest(eye - 6.0 * back, &mut lamps).unwrap();
    let small = scene.instances.iter().enumerate().filter(|(_, instance)| {
        let size = instance.bounds.size().max_element();
        size > 0.2 && size < 1.0
    });
    let mut small = small.map(|(i, instance)| (i, instance.bounds.center()));
    let (thing, _) = nearest(lamp - Vec3::Y, &mut small).unwrap();
    for whole in [true, false, true, false] {
        let mut scene = scene.clone();
        let settings = settings(Culling::Occlusion).with(|s| {
            (s.picture.width, s.picture.height) = (480, 270);
            s.lighting.shadow_atlas = 4096;
        });
        let mut film = Film::new(&scene, &settings);
        film.draw(camera);
        let mut frame = |angle: f32| {
            let by = 0.05 * Vec3::new(angle.sin(), 0.0, angle.cos());
            shift(&mut scene, [thing].into_iter(), by);
            pollster::block_on(film.renderer.update_pose(&scene)).unwrap();
            if whole {
                film.renderer.shadows_mut().draw_whole(false);
            }
            let stats = film.draw(camera);
            let pass = stats.gpu_ms.iter().find(|pass| pass.name == "shadows");
            (pass.map_or(0.0, |pass| pass.ms), stats.shadows.unwrap())
        };
        let mut frames: Vec<_> = (0..14).map(|i| frame(i as f32)).collect();
        frames.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (ms, s) = &frames[7];
        println!(
            "{}: {ms:.1} ms, {} tiles, {} casters, {} triangles",
            if whole { "whole tiles" } else { "patches" },
            s.tiles_drawn,
            s.casters,
            s.triangles
        );
    }
}
