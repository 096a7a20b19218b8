//! Pictures with and without culling are equal byte for byte, along walks through a house.
//!
//! Needs a Vulkan driver; Mesa's lavapipe, which draws on the processor, will do.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

#[path = "../examples/shared/mod.rs"]
mod shared;

use bevy::prelude::*;
use bevy_foveal_cull::CpuOcclusionStats;
use shared::headless::{Headless, pixels_that_differ};
use shared::house::{Door, House};
use shared::modes::Mode;

/// A house drawn twice, and what was hidden on the way.
fn walk(house: House, size: UVec2, msaa: Msaa, frames: usize) -> CpuOcclusionStats {
    let [mut plain, mut culled] = [Mode::Frustum, Mode::All].map(|mode| {
        Headless::new(size, msaa, |world| {
            house.spawn(world);
            mode.set(world);
        })
    });
    let mut sum = CpuOcclusionStats::default();
    for frame in 0..frames {
        let rooms = frame as f32 * (house.side * house.side - 1) as f32 / frames as f32;
        for app in [&mut plain, &mut culled] {
            let camera = app.camera;
            let world = app.world();
            *world.get_mut::<Transform>(camera).unwrap() = house.walker(rooms);
            let mut doors = world.query::<(&Door, &mut Transform)>();
            for (door, mut leaf) in doors.iter_mut(world) {
                *leaf = door.at(frame as f32 * 0.7);
            }
            // The first frame uploads meshes and finds their bounds.
            for _ in 0..if frame == 0 { 3 } else { 1 } {
                app.frame();
            }
        }
        let (a, b) = (plain.picture(), culled.picture());
        assert!(a.iter().any(|&byte| byte != a[0]), "there is a picture");
        assert_eq!(pixels_that_differ(&a, &b), 0, "frame {frame}, {msaa:?}");
        let stats = culled.world().resource::<CpuOcclusionStats>();
        sum.meshes += stats.meshes;
        sum.meshes_hidden += stats.meshes_hidden;
        sum.casters += stats.casters;
        sum.casters_hidden += stats.casters_hidden;
        sum.refused_views += stats.refused_views;
    }
    sum
}

#[test]
fn pictures_of_a_walk_are_the_same_with_and_without_culling() {
    let house = House {
        side: 5,
        furniture: 20,
        doors: true,
        lights: 0,
    };
    // A size that is no multiple of the buffer's, and a sample per pixel.
    let odd = walk(house, UVec2::new(317, 179), Msaa::Off, 60);
    let sampled = walk(house, UVec2::new(200, 120), Msaa::Sample4, 24);
    for sum in [odd, sampled] {
        assert_eq!(sum.refused_views, 0);
        assert!(sum.meshes_hidden * 2 > sum.meshes, "{sum:?}");
    }
    let lit = House {
        lights: 2,
        side: 4,
        ..house
    };
    let sum = walk(lit, UVec2::new(200, 120), Msaa::Off, 16);
    assert!(sum.casters_hidden * 2 > sum.casters, "{sum:?}");
}
