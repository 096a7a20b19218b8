//! The occluders of a scene: meshes placed in the world, static or moving.

use super::mesh::{OccluderMesh, hash_words};
use crate::error::CullError;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Names one occluder of an [`OccluderSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OccluderId(pub(crate) u32);

/// Placed occluders. Moving one costs nothing beyond the new transform: there is no structure to refit.
#[derive(Clone, Debug, Default)]
pub struct OccluderSet {
    pub(crate) instances: Vec<Instance>,
    free: Vec<u32>,
}

#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) mesh: Option<Arc<OccluderMesh>>,
    pub(crate) world_from_mesh: DAffine3,
    /// Bounding sphere in the world.
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) mirrored: bool,
    /// Takes the eye to the mesh, where cones are tested; NaN for a singular transform.
    pub(crate) mesh_from_world: DAffine3,
    pub(crate) hash: u32,
    pub(crate) enabled: bool,
}

impl OccluderSet {
    /// An empty set.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Places a mesh. Any affine transform will do: non-uniform or mirroring scales too.
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for a transform with NaN or infinity.
    pub fn add(
        &mut self,
        mesh: Arc<OccluderMesh>,
        world_from_mesh: DAffine3,
    ) -> Result<OccluderId, CullError> {
        let instance = Instance::new(mesh, world_from_mesh)?;
        if let Some(slot) = self.free.pop() {
            self.instances[slot as usize] = instance;
            return Ok(OccluderId(slot));
        }
        self.instances.push(instance);
        Ok(OccluderId((self.instances.len() - 1) as u32))
    }

    /// Moves an occluder.
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`], [`CullError::NotFinite`].
    pub fn set_transform(
        &mut self,
        id: OccluderId,
        world_from_mesh: DAffine3,
    ) -> Result<(), CullError> {
        let slot = self.slot(id)?;
        let mesh = slot.mesh.clone().ok_or(CullError::UnknownOccluder)?;
        let enabled = slot.enabled;
        *slot = Instance {
            enabled,
            ..Instance::new(mesh, world_from_mesh)?
        };
        Ok(())
    }

    /// Switches an occluder off or on again.
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`].
    pub fn set_enabled(&mut self, id: OccluderId, enabled: bool) -> Result<(), CullError> {
        self.slot(id)?.enabled = enabled;
        Ok(())
    }

    /// Takes an occluder out; its id may be given out again.
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`].
    pub fn remove(&mut self, id: OccluderId) -> Result<(), CullError> {
        let slot = self.slot(id)?;
        slot.mesh = None;
        self.free.push(id.0);
        Ok(())
    }

    /// How many occluders there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.instances.len() - self.free.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Triangles of all occluders together.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.instances
            .iter()
            .filter_map(|i| i.mesh.as_ref())
            .map(|m| m.triangle_count())
            .sum()
    }

    fn slot(&mut self, id: OccluderId) -> Result<&mut Instance, CullError> {
        self.instances
            .get_mut(id.0 as usize)
            .filter(|i| i.mesh.is_some())
            .ok_or(CullError::UnknownOccluder)
    }
}

impl Instance {
    fn new(mesh: Arc<OccluderMesh>, world_from_mesh: DAffine3) -> Result<Self, CullError> {
        if !world_from_mesh.is_finite() {
            return Err(CullError::NotFinite);
        }
        let m = world_from_mesh.matrix3;
        let center = world_from_mesh.transform_point3(mesh.center);
        let half = mesh.half.as_dvec3();
        let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        let hash = hash_words(
            mesh.hash,
            world_from_mesh
                .to_cols_array()
                .iter()
                .flat_map(|v| [v.to_bits() as u32, (v.to_bits() >> 32) as u32]),
        );
        Ok(Self {
            radius: extent.length(),
            center,
            mirrored: m.determinant() < 0.0,
            mesh_from_world: world_from_mesh.inverse(),
            hash,
            mesh: Some(mesh),
            world_from_mesh,
            enabled: true,
        })
    }
}
