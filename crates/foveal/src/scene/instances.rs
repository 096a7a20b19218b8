//! Instances as the vertex shader reads them.

use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// Mirrors `Instance` in `shared/vertex.wgsl`: the upper three rows of two affine matrices.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct InstanceUniform {
    pub(crate) world_x: [f32; 4],
    pub(crate) world_y: [f32; 4],
    pub(crate) world_z: [f32; 4],
    pub(crate) previous_x: [f32; 4],
    pub(crate) previous_y: [f32; 4],
    pub(crate) previous_z: [f32; 4],
}

impl InstanceUniform {
    /// An instance that was in the same place a frame ago.
    pub(crate) fn still(world_from_object: Mat4) -> Self {
        let [x, y, z] = [0, 1, 2].map(|row| world_from_object.row(row).to_array());
        Self {
            world_x: x,
            world_y: y,
            world_z: z,
            previous_x: x,
            previous_y: y,
            previous_z: z,
        }
    }

    /// The same instance, one pose later.
    pub(crate) fn moved_to(self, world_from_object: Mat4) -> Self {
        Self {
            previous_x: self.world_x,
            previous_y: self.world_y,
            previous_z: self.world_z,
            ..Self::still(world_from_object)
        }
    }

    /// Its place.
    pub(crate) fn world_from_object(&self) -> Mat4 {
        let rows = [
            self.world_x,
            self.world_y,
            self.world_z,
            [0.0, 0.0, 0.0, 1.0],
        ];
        Mat4::from_cols_array_2d(&rows).transpose()
    }

    /// Whether it is elsewhere than a frame ago.
    pub(crate) fn is_elsewhere(&self) -> bool {
        let (now, before) = (
            [self.world_x, self.world_y, self.world_z],
            [self.previous_x, self.previous_y, self.previous_z],
        );
        now != before
    }
}
