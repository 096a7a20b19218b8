//! The CPU twin of light assignment, and what it must guarantee.

use foveal_generate as generate;
use foveal_scene::{Camera, Projection, Scene};
use glam::{Vec2, Vec3};

use super::{ClusterGrid, LightUniform};
use crate::gpu::read_buffer;
use crate::shading::twin::position_at;
use crate::stereo::{EyeLayout, eyes};
use crate::testing::{gpu, rendered, small};

/// The cluster at a pixel position and a distance along the view axis.
fn cluster_at(grid: &ClusterGrid, pixel: Vec2, distance: f32) -> u32 {
    let slice = (distance / grid.near_m).max(1e-6).log2() * grid.slices_per_doubling + 1.0;
    let slice = slice.clamp(0.0, (grid.counts[2] - 1) as f32) as u32;
    let tile = |p: f32, count: u32| ((p / grid.tile_px as f32) as u32).min(count - 1);
    tile(pixel.x, grid.counts[0])
        + grid.counts[0] * (tile(pixel.y, grid.counts[1]) + grid.counts[1] * slice)
}

fn bit(bits: &[u32], grid: &ClusterGrid, cluster: u32, light: u32) -> bool {
    bits[(cluster * grid.light_words() + light / 32) as usize] >> (light % 32) & 1 == 1
}

/// Every place that a light reaches lies in a cluster that has the light; most clusters have not.
/// Directional lights are in none.
fn assert_assignment(scene: &Scene, camera: &Camera) {
    let settings = small(320, 200);
    let renderer = rendered(scene, camera, &settings);
    let (assigner, lights) = renderer.lights();
    let eyes = eyes(&settings, camera).expect("a camera that makes sense");
    let grid = ClusterGrid::new(&EyeLayout::of(&settings), &eyes, camera, lights);
    let bytes = pollster::block_on(read_buffer(gpu(), assigner.bits())).expect("read-back works");
    let bits: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
    let size = Vec2::new(
        settings.picture.width as f32,
        settings.picture.height as f32,
    );

    let mut reached = 0;
    for y in (0..settings.picture.height).step_by(7) {
        for x in (0..settings.picture.width).step_by(5) {
            let pixel = Vec2::new(x as f32, y as f32) + 0.5;
            for step in 0..60 {
                let distance = 0.06 * 1.15f32.powi(step);
                let depth = match camera.projection {
                    Projection::Perspective { near_m, .. } => near_m / distance,
                    Projection::Orthographic { near_m, far_m, .. } => {
                        1.0 - (distance - near_m) / (far_m - near_m)
                    }
                };
                let position = position_at(camera, size, pixel, depth);
                let cluster = cluster_at(&grid, pixel, distance);
                for (index, light) in (0..).zip(lights) {
                    // What lights everything has no bits.
                    assert!(light.kind != 0 || !bit(&bits, &grid, cluster, index));
                    if light.kind != 0
                        && Vec3::from(light.position).distance(position) < light.range
                    {
                        assert!(
                            bit(&bits, &grid, cluster, index),
                            "light {index} misses {position} at {pixel}"
                        );
                        reached += 1;
                    }
                }
            }
        }
    }
    assert!(reached > 1000, "the test must reach clusters");
    let set: u32 = bits.iter().map(|w| w.count_ones()).sum();
    let all = grid.counts.iter().product::<u32>() * grid.light_count;
    assert!(
        set < all / 2,
        "{set} of {all} bits: nothing is narrowed down"
    );
}

#[test]
fn every_cluster_has_the_lights_that_reach_it() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 70, 3);
    for light in scene.lights.iter_mut().skip(10) {
        light.range_m = Some(0.6);
    }
    let mut camera = scene.cameras[0].clone();
    assert_assignment(&scene, &camera);
    camera.projection = Projection::Orthographic {
        height_m: 5.0,
        near_m: 0.05,
        far_m: 60.0,
    };
    assert_assignment(&scene, &camera);
}

#[test]
fn a_grid_stays_small_however_many_lights_there_are() {
    let scene = generate::cornell();
    for (width, height, lights) in [
        (1, 1, 0),
        (8192, 8192, 1),
        (3840, 2160, 16_384),
        (8192, 8192, 16_384),
    ] {
        let lights = vec![
            LightUniform {
                range: 1.0,
                kind: 1,
                ..LightUniform::default()
            };
            lights
        ];
        let (settings, camera) = (small(width, height), &scene.cameras[0]);
        let eyes = eyes(&settings, camera).expect("a camera that makes sense");
        let grid = ClusterGrid::new(&EyeLayout::of(&settings), &eyes, camera, &lights);
        assert!(grid.total_words() * 4 <= 32 << 20);
        assert!(grid.counts[0] * grid.tile_px >= width && grid.counts[1] * grid.tile_px >= height);
    }
}
