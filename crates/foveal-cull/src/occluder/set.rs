//! The occluders of a scene.

use super::mesh::OccluderMesh;
use crate::error::{CullError, Quantity};
use crate::transform::Affine;
use core::num::NonZeroU32;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// The id of one occluder of an [`OccluderSet`].
///
/// Ids are generational: the id of a removed occluder never names another one, even if its slot is
/// used again. An id is valid only in the set that gave it out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OccluderId {
    slot: u32,
    generation: NonZeroU32,
}

impl OccluderId {
    /// The id as one number, never zero, for engines that keep ids of their own.
    #[must_use]
    pub fn to_bits(self) -> u64 {
        u64::from(self.generation.get()) << 32 | u64::from(self.slot)
    }

    /// The id of [`to_bits`](Self::to_bits). Numbers that come from elsewhere name no occluder, or
    /// another one.
    #[must_use]
    pub fn from_bits(bits: u64) -> Option<Self> {
        Some(Self {
            slot: bits as u32,
            generation: NonZeroU32::new((bits >> 32) as u32)?,
        })
    }
}

/// The occluders of a scene: baked meshes placed in the world.
///
/// There is no hierarchy over occluders: moving one costs its new transform and nothing else, and
/// every frame looks at each enabled occluder once.
#[derive(Clone, Debug, Default)]
pub struct OccluderSet {
    pub(crate) instances: Vec<Instance>,
    /// Slots that can be used again.
    free: Vec<u32>,
    len: usize,
}

/// A slot of the set: an occluder, or free.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    /// None in a free slot.
    pub(crate) mesh: Option<Arc<OccluderMesh>>,
    pub(crate) world_from_mesh: DAffine3,
    /// Bounding sphere, world.
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) mirrored: bool,
    /// Triangles and clusters of the mesh, for stats: most meshes are not touched in a frame.
    pub(crate) triangles: u32,
    pub(crate) clusters: u32,
    /// Takes the eye to mesh space, where normal cones are tested; NaN for a singular transform.
    pub(crate) mesh_from_world: DAffine3,
    /// Content hash.
    pub(crate) hash: u32,
    pub(crate) enabled: bool,
    /// Rises with every occluder that leaves this slot.
    generation: NonZeroU32,
}

impl OccluderSet {
    /// An empty set.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Places a mesh in the world (metres). Any affine transform will do, non-uniform and mirroring
    /// scales too. O(1).
    ///
    /// # Errors
    /// [`CullError::NotFinite`] for a transform with NaN or infinity.
    pub fn add(
        &mut self,
        mesh: Arc<OccluderMesh>,
        world_from_mesh: impl Into<Affine>,
    ) -> Result<OccluderId, CullError> {
        let instance = Instance::new(mesh, &world_from_mesh.into().to_glam())?;
        self.len += 1;
        if let Some(slot) = self.free.pop() {
            let to = &mut self.instances[slot as usize];
            let generation = to.generation;
            *to = Instance {
                generation,
                ..instance
            };
            return Ok(OccluderId { slot, generation });
        }
        let id = OccluderId {
            slot: self.instances.len() as u32,
            generation: instance.generation,
        };
        self.instances.push(instance);
        Ok(id)
    }

    /// Moves an occluder. O(1).
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`], or [`CullError::NotFinite`] for a transform with NaN or
    /// infinity.
    pub fn set_transform(
        &mut self,
        id: OccluderId,
        world_from_mesh: impl Into<Affine>,
    ) -> Result<(), CullError> {
        self.slot(id)?.place(&world_from_mesh.into().to_glam())
    }

    /// Gives an occluder whose mesh was baked
    /// [`deformable`](crate::BakeOptions::deformable) another shape, as
    /// [`OccluderMesh::set_positions`] does. Where other occluders or the caller share the mesh,
    /// this one gets a copy of its own first, once.
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`], or as [`OccluderMesh::set_positions`]. Then the occluder
    /// keeps its shape.
    pub fn set_positions<P: Copy + Into<[f32; 3]>>(
        &mut self,
        id: OccluderId,
        positions: &[P],
    ) -> Result<(), CullError> {
        let slot = self.slot(id)?;
        let mesh = slot.mesh.as_mut().ok_or(CullError::UnknownOccluder)?;
        mesh.check_positions(positions)?;
        Arc::make_mut(mesh).set_positions(positions)?;
        let place = slot.world_from_mesh;
        slot.place(&place)
    }

    /// Switches an occluder off, or on again. A new one is on. O(1).
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`].
    pub fn set_enabled(&mut self, id: OccluderId, enabled: bool) -> Result<(), CullError> {
        self.slot(id)?.enabled = enabled;
        Ok(())
    }

    /// Removes an occluder. Its id names nothing from then on. O(1).
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`].
    pub fn remove(&mut self, id: OccluderId) -> Result<(), CullError> {
        let slot = self.slot(id)?;
        slot.mesh = None;
        // A slot that has used up all generations stays empty.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(id.slot);
        }
        self.len -= 1;
        Ok(())
    }

    /// Whether an id names an occluder of this set. O(1).
    #[must_use]
    pub fn contains(&self, id: OccluderId) -> bool {
        self.mesh(id).is_ok()
    }

    /// The mesh of an occluder.
    ///
    /// # Errors
    /// [`CullError::UnknownOccluder`].
    pub fn mesh(&self, id: OccluderId) -> Result<&Arc<OccluderMesh>, CullError> {
        let slot = self.instances.get(id.slot as usize);
        slot.filter(|i| i.generation == id.generation)
            .and_then(|i| i.mesh.as_ref())
            .ok_or(CullError::UnknownOccluder)
    }

    /// Number of occluders, whether on or off.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no occluders.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Triangles of all occluders together. O(n).
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.instances
            .iter()
            .filter_map(|i| i.mesh.as_ref())
            .map(|m| m.triangle_count())
            .sum()
    }

    fn slot(&mut self, id: OccluderId) -> Result<&mut Instance, CullError> {
        let slot = self.instances.get_mut(id.slot as usize);
        slot.filter(|i| i.generation == id.generation && i.mesh.is_some())
            .ok_or(CullError::UnknownOccluder)
    }
}

impl Instance {
    /// The generation of the slot.
    pub(crate) fn generation(&self) -> NonZeroU32 {
        self.generation
    }

    fn new(mesh: Arc<OccluderMesh>, world_from_mesh: &DAffine3) -> Result<Self, CullError> {
        let mut instance = Self {
            mesh: Some(mesh),
            world_from_mesh: DAffine3::IDENTITY,
            center: DVec3::ZERO,
            radius: 0.0,
            mirrored: false,
            triangles: 0,
            clusters: 0,
            mesh_from_world: DAffine3::IDENTITY,
            hash: 0,
            enabled: true,
            generation: NonZeroU32::MIN,
        };
        instance.place(world_from_mesh)?;
        Ok(instance)
    }

    /// Sets the place, and all that follows from it and from the mesh. After an error nothing has
    /// changed. Many occluders move in every frame.
    #[inline]
    fn place(&mut self, world_from_mesh: &DAffine3) -> Result<(), CullError> {
        let mesh = self.mesh.as_deref().ok_or(CullError::UnknownOccluder)?;
        if !world_from_mesh.is_finite() {
            return Err(CullError::NotFinite(Quantity::Transform));
        }
        let m = &world_from_mesh.matrix3;
        let half = mesh.half.as_dvec3();
        let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        self.center = world_from_mesh.transform_point3(mesh.center);
        self.radius = extent.length();
        self.mirrored = m.determinant() < 0.0;
        self.mesh_from_world = world_from_mesh.inverse();
        self.triangles = mesh.triangle_count() as u32;
        self.clusters = mesh.clusters.len() as u32;
        self.hash = hash_of_place(mesh.hash, world_from_mesh);
        self.world_from_mesh = *world_from_mesh;
        Ok(())
    }
}

/// Hash of a mesh at a place. Four chains of three words each: one chain of all words takes longer
/// than the rest of a move.
#[inline(always)]
fn hash_of_place(mesh: u32, place: &DAffine3) -> u32 {
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    let words = place.to_cols_array().map(f64::to_bits);
    let mut chains = [u64::from(mesh), 1, 2, 3];
    for four in words.as_chunks::<4>().0 {
        for (chain, word) in chains.iter_mut().zip(four) {
            *chain = (*chain ^ word).wrapping_mul(FACTOR).rotate_left(29);
        }
    }
    let joined = chains.iter().fold(0u64, |all, chain| {
        (all ^ chain).wrapping_mul(FACTOR).rotate_left(29)
    });
    (joined ^ (joined >> 32)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Aabb;
    use glam::Vec3;

    fn mesh() -> Arc<OccluderMesh> {
        Arc::new(OccluderMesh::from_box(Aabb::new(Vec3::ZERO, Vec3::ONE)).unwrap())
    }

    #[test]
    fn the_id_of_a_removed_occluder_names_no_other() {
        let mut set = OccluderSet::new();
        let first = set.add(mesh(), DAffine3::IDENTITY).unwrap();
        set.remove(first).unwrap();
        let second = set.add(mesh(), DAffine3::IDENTITY).unwrap();
        assert_eq!(first.slot, second.slot, "the slot is used again");
        assert_ne!(first, second);
        assert_eq!(OccluderId::from_bits(second.to_bits()), Some(second));
        assert_eq!(OccluderId::from_bits(7), None);
        assert!(!set.contains(first) && set.contains(second));
        let unknown = Err(CullError::UnknownOccluder);
        let moved = DAffine3::from_translation(DVec3::ONE);
        assert_eq!(set.remove(first), unknown);
        assert_eq!(set.set_enabled(first, false), unknown);
        assert_eq!(set.set_transform(first, moved), unknown);
        // Moving keeps the id.
        set.set_transform(second, moved).unwrap();
        assert!(set.contains(second));
        assert_eq!((set.len(), set.triangle_count()), (1, 12));
    }

    #[test]
    fn a_transform_that_is_refused_changes_nothing() {
        let mut set = OccluderSet::new();
        let id = set
            .add(mesh(), DAffine3::from_translation(DVec3::ONE))
            .unwrap();
        let before = format!("{:?}", set.instances[0]);
        for bad in [f64::NAN, f64::INFINITY] {
            let moved = DAffine3::from_translation(DVec3::new(0.0, bad, 0.0));
            let error = Err(CullError::NotFinite(Quantity::Transform));
            assert_eq!(set.set_transform(id, moved), error);
        }
        assert_eq!(format!("{:?}", set.instances[0]), before);
    }

    #[test]
    fn an_occluder_that_has_moved_is_one_that_was_added_there() {
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, -1.0, 0.5),
            glam::DQuat::from_rotation_y(0.7),
            DVec3::new(3.0, 4.0, 5.0),
        );
        let mut set = OccluderSet::new();
        let moved = set.add(mesh(), DAffine3::IDENTITY).unwrap();
        set.set_transform(moved, place).unwrap();
        set.add(mesh(), place).unwrap();
        let [a, b] = [0, 1].map(|i| format!("{:?}", set.instances[i]));
        assert_eq!(a, b);
    }

    #[test]
    fn hashes_of_places_differ() {
        let mut all = std::collections::HashSet::new();
        for i in 0..20_000u32 {
            let at = [i % 32, i / 32 % 32, i / 1024].map(|v| f64::from(v) * 0.5);
            let turn = DAffine3::from_rotation_y(f64::from(i % 7));
            all.insert(hash_of_place(
                9,
                &(DAffine3::from_translation(at.into()) * turn),
            ));
            let scale = DVec3::new(at[0], at[1], at[2] + 1.0);
            all.insert(hash_of_place(9, &DAffine3::from_scale(scale)));
        }
        // Of 40,000 random numbers of 32 bits, one in six sets has a pair that is equal.
        assert!(all.len() > 39_990, "{}", all.len());
        assert_ne!(
            hash_of_place(1, &DAffine3::IDENTITY),
            hash_of_place(2, &DAffine3::IDENTITY)
        );
    }

    #[test]
    fn a_slot_that_has_used_up_all_generations_stays_empty() {
        let mut set = OccluderSet::new();
        let mut id = set.add(mesh(), DAffine3::IDENTITY).unwrap();
        id.generation = NonZeroU32::MAX;
        set.instances[0].generation = NonZeroU32::MAX;
        set.remove(id).unwrap();
        assert!(set.is_empty());
        let next = set.add(mesh(), DAffine3::IDENTITY).unwrap();
        assert_eq!((next.slot, set.len()), (1, 1));
        assert!(!set.contains(id) && set.contains(next));
    }
}
