//! An eye that the culler looks from, by name.

use foveal_cull::Eye;

/// An eye with a name.
#[derive(Debug, Clone)]
pub struct NamedEye {
    /// The camera's name, or what stands for it.
    pub name: String,
    /// Pose and projection.
    pub eye: Eye,
}
