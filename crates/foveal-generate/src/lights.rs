//! Lights for scenes that come without: the benches' '200 point lights'.

use glam::Vec3;

use super::hash::Rng;
use foveal_scene::{Light, LightKind, Scene};

/// Warm ones mostly, a few coloured ones: linear RGB.
const COLORS: [[f32; 3]; 8] = [
    [1.0, 0.62, 0.28],
    [1.0, 0.72, 0.42],
    [1.0, 0.52, 0.20],
    [1.0, 0.80, 0.58],
    [0.25, 0.85, 1.0],
    [1.0, 0.25, 0.65],
    [0.35, 1.0, 0.45],
    [0.45, 0.45, 1.0],
];

/// A point light without a node.
pub(super) fn point(position: Vec3, color: Vec3, intensity: f32, range_m: f32) -> Light {
    Light {
        kind: LightKind::Point,
        color,
        intensity,
        position,
        direction: Vec3::NEG_Y,
        range_m: Some(range_m),
        node: None,
    }
}

/// Adds `count` coloured point lights beside the scene's instances, the same ones for the same
/// scene and `seed`.
///
/// Each stands in a little enlarged bounds of an instance drawn at random; ranges are a few
/// percent of the scene's diagonal, and intensities grow with the range's square, so that every
/// scene is as bright whatever its size. A scene without geometry gets them around the origin.
pub fn add_point_lights(scene: &mut Scene, count: u32, seed: u64) {
    let bounds = scene.bounds();
    let diagonal_m = bounds.size().length().max(1e-3);
    // Density shall not depend on the count: more lights reach less far.
    let range_m = diagonal_m * 0.55 / (count.max(8) as f32).sqrt();
    for index in 0..count {
        let mut rng = Rng::new(seed, u64::from(index));
        let near = match scene.instances.len() {
            0 => foveal_scene::Aabb {
                min: Vec3::splat(-0.5),
                max: Vec3::splat(0.5),
            },
            n => scene.instances[rng.below(n)].bounds,
        };
        if near.is_empty() {
            continue;
        }
        let place = Vec3::new(rng.unit(), rng.unit(), rng.unit());
        let margin = 0.15 * range_m;
        let position = near.min - margin + (near.size() + 2.0 * margin) * place;
        let range_m = range_m * rng.range(0.7, 1.3);
        let color = Vec3::from(rng.pick(COLORS));
        // At a quarter of the range the light gives about 4 lux.
        let intensity = 0.25 * range_m * range_m * rng.range(0.7, 1.3);
        scene
            .lights
            .push(point(position, color, intensity, range_m));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_repeat_and_lie_near_the_scene() {
        let lit = || {
            let mut scene = crate::cornell();
            scene.lights.clear();
            add_point_lights(&mut scene, 200, 3);
            scene
        };
        let scene = lit();
        assert_eq!(scene.lights.len(), 200);
        assert_eq!(scene.lights, lit().lights);
        let (b, size) = (scene.bounds(), scene.bounds().size());
        for light in &scene.lights {
            assert!(light.position.cmpge(b.min - size).all());
            assert!(light.position.cmple(b.max + size).all());
            assert!(light.range_m.unwrap() > 0.0 && light.intensity > 0.0);
        }
    }

    #[test]
    fn an_empty_scene_takes_lights_too() {
        let mut scene = Scene::default();
        add_point_lights(&mut scene, 5, 0);
        assert_eq!(scene.lights.len(), 5);
    }
}
