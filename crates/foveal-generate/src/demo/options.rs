//! Options of the demo scene.

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
