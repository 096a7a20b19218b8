//! What can be wrong with a request for a generated scene.

/// Why a scene could not be generated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GenerateError {
    /// There is no generated scene of this name.
    #[error("no generated scene is named '{name}'; there are: {}", crate::names::NAMES.join(", "))]
    UnknownScene {
        /// The name asked for.
        name: String,
    },
    /// What follows the colon is not a whole number.
    #[error("'{text}' in '{name}' is not a number of instances")]
    BadSize {
        /// The whole name asked for.
        name: String,
        /// What follows the colon.
        text: String,
    },
    /// The scene has one size only.
    #[error("the scene '{name}' has one size: leave out ':{text}'")]
    FixedSize {
        /// The name before the colon.
        name: String,
        /// What follows the colon.
        text: String,
    },
    /// The demo scene cannot have so many or so few instances.
    #[error("the demo scene can have 1000 to 100000 instances, not {instances}")]
    InstanceCount {
        /// The number asked for.
        instances: u32,
    },
    /// Too many lights for the number of instances: each light is a lantern and needs room.
    #[error("a demo scene of {instances} instances has room for {most} lights, not {lights}")]
    LightCount {
        /// The number asked for.
        lights: u32,
        /// The largest number possible.
        most: u32,
        /// Instances of the scene.
        instances: u32,
    },
}
