//! The demo: an arcaded night market, walled, with a square, side lanes and courts.
//!
//! A `Kit` holds all things that can be placed (few meshes, many materials). The plan says
//! where lanes and houses lie, the `build_*` files place things on it, and the `market` leaves
//! out the least important ones until the number of instances is the wanted one.

mod arches;
mod build_houses;
mod build_quarter;
mod build_ropes;
mod build_square;
mod build_stalls;
mod build_walls;
mod cameras;
mod goods;
mod houses;
mod kit;
mod lanterns;
mod lots;
mod market;
mod materials;
mod openings;
mod options;
mod plan;
mod square;
mod stalls;
mod things;
mod walls;

use glam::Vec3;

use crate::build::SceneBuilder;
use crate::error::GenerateError;
use crate::lights::point;
use foveal_scene::{Environment, Light, LightKind, Scene};
use plan::Plan;

pub use cameras::demo_path;
pub use options::DemoOptions;
use things::Kit;

/// Generates the demo scene: a walled market quarter at night, lit by lanterns.
///
/// Walls, houses, gates and the ground are marked as occluders (`Object::occluder`), everything
/// else as not; `Object::set` names the part of the quarter. Cameras: `alley` (the default),
/// `square`, `overview`, `arcade`, `lanterns`. The last light is the moon; all others are point
/// lights.
///
/// # Errors
/// [`GenerateError`] when the options ask for too many or too few instances or lights.
pub fn demo(options: &DemoOptions) -> Result<Scene, GenerateError> {
    let &DemoOptions {
        instances, lights, ..
    } = options;
    if !(1_000..=100_000).contains(&instances) {
        return Err(GenerateError::InstanceCount { instances });
    }
    let most = instances / 5;
    if lights > most {
        return Err(GenerateError::LightCount {
            lights,
            most,
            instances,
        });
    }
    let mut scene = SceneBuilder::new("demo");
    let kit = Kit::new(&mut scene);
    let mut market = fitting_quarter(&kit, options);
    for light in market.light(lights as usize) {
        scene.light(light);
    }
    for (number, item) in market.keep(instances as usize).into_iter().enumerate() {
        let thing = item.thing;
        scene.object(
            format!("{} {number}", thing.name),
            Some(thing.set),
            Some(thing.occluder),
            &thing.parts,
            item.place,
        );
    }
    scene.light(moonlight());
    for camera in cameras::views() {
        scene.camera(camera);
    }
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec3::new(0.022, 0.042, 0.125),
        horizon: Vec3::new(0.130, 0.110, 0.150),
        nadir: Vec3::new(0.052, 0.046, 0.052),
    };
    Ok(scene)
}

/// The smallest quarter with at least the wanted number of instances.
fn fitting_quarter<'a>(kit: &'a Kit, options: &DemoOptions) -> market::Market<'a> {
    /// A house with its stalls has more instances than this, so the first guess is too small.
    const MOST_PER_LOT: u32 = 110;
    let (wanted, lights) = (options.instances as usize, options.lights as usize);
    let mut plan = Plan::with_lots(options.instances / MOST_PER_LOT);
    loop {
        let market = build_quarter::quarter(kit, plan, lights, options.seed);
        if market.instance_count() >= wanted {
            return market;
        }
        plan.houses += 1;
    }
}

/// Cool, weak and slanting.
fn moonlight() -> Light {
    Light {
        kind: LightKind::Directional,
        direction: Vec3::new(-0.32, -0.72, 0.61).normalize(),
        range_m: None,
        ..point(Vec3::ZERO, Vec3::new(0.45, 0.62, 1.0), 1.3, 0.0)
    }
}

#[cfg(test)]
mod tests;
