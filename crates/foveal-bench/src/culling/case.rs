//! One view of one scene.

use foveal_cull::Aabb;

use foveal_host::culling::{CullingArgs, NamedEye, Occluders};

/// What is measured.
pub(super) struct Case<'a> {
    pub(super) scene: &'a str,
    pub(super) eye: &'a NamedEye,
    pub(super) size: (u32, u32),
    pub(super) occluders: &'a Occluders,
    pub(super) boxes: &'a [Aabb],
    pub(super) culling: &'a CullingArgs,
    /// The scene's own, world space.
    pub(super) objects: &'a [Aabb],
    /// Whether it is measured what learning gains.
    pub(super) learn: bool,
}
