//! What can go wrong between a scene and its picture.

/// An error of the renderer. Each message is one sentence that names the place and the cause.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No adapter matches; the text lists what there is.
    #[error("no graphics adapter {wanted}; available: {available}")]
    NoAdapter {
        /// What was asked for, as in «matches 'nvidia'».
        wanted: String,
        /// The adapters' names, or a hint what to install.
        available: String,
    },
    /// The adapter refused to open a device.
    #[error("the adapter '{adapter}' cannot open a device: {source}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        source: wgpu::RequestDeviceError,
    },
    /// A size, count or setting lies outside what this device or this program can do.
    #[error("{what} is {value}, the limit is {limit}{hint}")]
    Limit {
        /// What is too large or too small.
        what: String,
        /// How large it is.
        value: u64,
        /// The largest that fits.
        limit: u64,
        /// A way out, or empty; begins with «: ».
        hint: String,
    },
    /// A setting has a value that makes no sense.
    #[error("the setting {name} is {value}; it must be {expected}")]
    Setting {
        /// The setting's name as in the TOML file.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        expected: &'static str,
    },
    /// A scene is set again whose textures were freed, or has textures without levels.
    #[error(
        "the texture '{texture}' has no texels: where they were freed with the scene's upload, load the scene again"
    )]
    NoTexels {
        /// The texture's name.
        texture: String,
    },
    /// An instance, material or mesh of a scene has an index of something that is not there, a number
    /// is not finite, or a texture or the scene's own environment has other texels than its size
    /// says.
    #[error("the scene cannot be drawn: {cause}")]
    Scene {
        /// The place, its index, and how many there are.
        cause: String,
    },
    /// A pose of another scene than the one that was set.
    #[error("the pose is of another scene: {difference}; set the scene again")]
    OtherScene {
        /// What is otherwise.
        difference: String,
    },
    /// A picture that is no environment.
    #[error("the environment cannot be used: {cause}")]
    Environment {
        /// What is wrong with it.
        cause: String,
    },
    /// The device ran out of memory.
    #[error("the graphics device ran out of memory while {doing}")]
    OutOfMemory {
        /// The stage.
        doing: String,
    },
    /// The device is gone.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
    /// The graphics API refused a call: a defect of this program or of the driver.
    #[error("the graphics API reported an error while {doing}: {cause}")]
    Validation {
        /// The stage.
        doing: String,
        /// What the API said.
        cause: String,
    },
}

impl Error {
    /// [`Error::Limit`] where there are more than fit.
    pub(crate) fn if_above(limit: u64, what: &str, count: usize) -> Result<(), Self> {
        if count as u64 <= limit {
            return Ok(());
        }
        Err(Self::Limit {
            what: what.to_owned(),
            value: count as u64,
            limit,
            hint: String::new(),
        })
    }
}
