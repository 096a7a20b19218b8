//! What moves: the node hierarchy, animations, skins and morph targets behind
//! [`Scene::pose`](crate::Scene::pose).

mod animation;
mod clip;
mod deform;
mod properties;
mod rig;

pub(crate) use animation::{Animation, Channel, Interpolation, Target};
pub use clip::Clip;
pub(crate) use deform::{Deformer, Influences, MorphTarget, Shape, Skin};
pub(crate) use properties::{
    CameraPart, Factor, LightPart, MaterialPart, MaterialState, TextureSlot, UvPart, UvTransform,
    emission, turn_of_uvs,
};
pub use rig::Rig;
pub(crate) use rig::{Binding, Node, RigData, world_from_nodes};

use glam::{Mat4, Quat, Vec3};

/// A node's transform relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Local {
    /// Not to be animated.
    Matrix(Mat4),
    /// Scaled, then rotated, then moved.
    Trs {
        translation: Vec3,
        rotation: Quat,
        scale: Vec3,
    },
}

impl Local {
    pub(crate) fn matrix(&self) -> Mat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Trs {
                translation,
                rotation,
                scale,
            } => Mat4::from_scale_rotation_translation(scale, rotation, translation),
        }
    }
}
