//! Tiles in which something moves: what is drawn again of them is what all of them would be.

use std::collections::BTreeMap;

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
        whole.renderer.shadows_mut().draw_again();
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
