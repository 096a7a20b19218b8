//! One view: its list of entities is tested against its occlusion buffer.

use crate::components::NoOcclusionCulling;
use crate::materials::MaterialVerdicts;
use crate::ready::Listed;
use crate::stats::CpuOcclusionStats;
use bevy_asset::Assets;
use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{DynamicSkinnedMeshBounds, NoCpuCulling, NoFrustumCulling};
use bevy_ecs::change_detection::Res;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, Without};
use bevy_ecs::system::{Query, SystemParam};
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::{
    SkinnedMesh, SkinnedMeshInverseBindposes, entity_aabb_from_skinned_mesh_bounds,
};
use bevy_mesh::{Mesh, Mesh3d};
use bevy_transform::components::GlobalTransform;
use foveal_cull::{Aabb, CullError, Culler, FrameOptions, OccluderSet, Threads, View, Visibility};
use std::sync::Once;
use tracing::warn;

/// More than the relative rounding of a vertex on its way to the world, in `f32`.
const ROUNDING: f32 = 1e-6;

/// What tells whether bounds of skinned meshes are known.
#[derive(SystemParam)]
pub(crate) struct Skins<'w, 's> {
    joints: Query<'w, 's, &'static GlobalTransform>,
    meshes: Res<'w, Assets<Mesh>>,
    bindposes: Option<Res<'w, Assets<SkinnedMeshInverseBindposes>>>,
}

impl Skins<'_, '_> {
    /// Whether the `Aabb` of an entity is that of its joints. Where Bevy cannot find the bounds of
    /// the joints it leaves old ones.
    pub(crate) fn bound(
        &self,
        skinned: &SkinnedMesh,
        mesh: &Mesh3d,
        follows_joints: bool,
        transform: &GlobalTransform,
    ) -> bool {
        let bindposes = self.bindposes.as_ref();
        let bindposes = bindposes.and_then(|all| all.get(&skinned.inverse_bindposes));
        let (Some(bindposes), Some(mesh)) = (bindposes, self.meshes.get(&mesh.0)) else {
            return false;
        };
        follows_joints
            && entity_aabb_from_skinned_mesh_bounds(
                &self.joints,
                mesh,
                skinned,
                bindposes,
                Some(transform),
            )
            .is_ok()
    }
}

/// The boxes of entities that may be hidden.
#[derive(SystemParam)]
pub(crate) struct Boxes<'w, 's> {
    entities: Query<
        'w,
        's,
        (
            &'static MeshBounds,
            &'static GlobalTransform,
            Option<&'static Mesh3d>,
            Option<&'static SkinnedMesh>,
            Has<DynamicSkinnedMeshBounds>,
            Material,
        ),
        (
            Without<NoOcclusionCulling>,
            Without<NoFrustumCulling>,
            Without<NoCpuCulling>,
            Without<MeshMorphWeights>,
            NotDrawnOnTop,
        ),
    >,
    skins: Skins<'w, 's>,
    verdicts: Res<'w, MaterialVerdicts>,
    #[cfg(feature = "bevy_pbr")]
    materials: Option<Res<'w, Assets<bevy_pbr::StandardMaterial>>>,
    #[cfg(feature = "bevy_pbr")]
    wireframes: Option<Res<'w, bevy_pbr::wireframe::WireframeConfig>>,
}

#[cfg(feature = "bevy_pbr")]
pub(crate) type Material = Option<&'static bevy_pbr::MeshMaterial3d<bevy_pbr::StandardMaterial>>;
#[cfg(not(feature = "bevy_pbr"))]
pub(crate) type Material = ();

/// Decals are drawn whatever their depth, and lines of wireframes in front of faces.
#[cfg(feature = "bevy_pbr")]
type NotDrawnOnTop = (
    Without<bevy_pbr::decal::ForwardDecal>,
    Without<bevy_pbr::wireframe::Wireframe>,
);
#[cfg(not(feature = "bevy_pbr"))]
type NotDrawnOnTop = ();

impl Boxes<'_, '_> {
    /// The box in the world; `None` where nothing is known of where the entity is.
    pub(crate) fn of(&self, entity: Entity) -> Option<Aabb> {
        let (bounds, transform, mesh, skinned, follows_joints, material) =
            self.entities.get(entity).ok()?;
        if let Some(skinned) = skinned
            && !self.skins.bound(skinned, mesh?, follows_joints, transform)
        {
            return None;
        }
        // A depth bias draws it in front of what is nearer.
        if self.verdicts.in_front.contains(&entity) || self.in_front(material) {
            return None;
        }
        Some(world_box(bounds, transform))
    }

    /// Whether a material may show light that falls on its back, for which Bevy looks up no shadow.
    /// So may all that is not known.
    #[cfg(feature = "bevy_pbr")]
    pub(crate) fn may_transmit(
        &self,
        material: Option<&bevy_pbr::MeshMaterial3d<bevy_pbr::StandardMaterial>>,
    ) -> bool {
        let known = material
            .zip(self.materials.as_ref())
            .and_then(|(material, materials)| materials.get(&material.0));
        known.is_none_or(|material| material.diffuse_transmission != 0.0)
    }

    #[cfg(all(feature = "bevy_light", not(feature = "bevy_pbr")))]
    pub(crate) fn may_transmit(&self, (): ()) -> bool {
        true
    }

    #[cfg(feature = "bevy_pbr")]
    fn in_front(
        &self,
        material: Option<&bevy_pbr::MeshMaterial3d<bevy_pbr::StandardMaterial>>,
    ) -> bool {
        let biased = material
            .zip(self.materials.as_ref())
            .and_then(|(material, materials)| materials.get(&material.0))
            .is_some_and(|material| material.depth_bias > 0.0);
        biased || self.wireframes.as_ref().is_some_and(|w| w.global)
    }

    #[cfg(not(feature = "bevy_pbr"))]
    fn in_front(&self, (): ()) -> bool {
        false
    }
}

/// The box in the world of a box in an entity's space.
pub(crate) fn world_box(bounds: &MeshBounds, transform: &GlobalTransform) -> Aabb {
    let map = transform.affine();
    let (axes, half) = (map.matrix3, bounds.half_extents);
    let center = map.transform_point3a(bounds.center);
    let half = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
    let half = half + (center.abs() + half) * ROUNDING;
    Aabb::new(center - half, center + half)
}

/// What became of a view's list.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) listed: usize,
    pub(crate) hidden: usize,
    /// Casters besides whose shadow nobody sees.
    pub(crate) unseen: usize,
    pub(crate) refused: bool,
    pub(crate) waiting: bool,
    pub(crate) coarse: bool,
}

impl Outcome {
    pub(crate) fn add_to(self, stats: &mut CpuOcclusionStats, of_light: bool) {
        stats.refused_views += usize::from(self.refused);
        stats.waiting_views += usize::from(self.waiting);
        stats.coarse_views += usize::from(self.coarse);
        if of_light {
            stats.light_views += 1;
            stats.casters += self.listed;
            stats.casters_hidden += self.hidden;
            stats.casters_unseen += self.unseen;
        } else {
            stats.cameras += 1;
            stats.meshes += self.listed;
            stats.meshes_hidden += self.hidden;
        }
    }
}

/// A culler of one buffer size, with its lists.
pub(crate) struct ViewCuller {
    culler: Culler,
    boxes: Vec<Aabb>,
    /// Where in the view's list each box belongs, ascending.
    places: Vec<u32>,
    results: Vec<Visibility>,
    is_current: bool,
}

impl ViewCuller {
    pub(crate) fn new(size: (u32, u32)) -> Result<Self, CullError> {
        Ok(Self {
            culler: Culler::new(size.0, size.1)?,
            boxes: Vec::new(),
            places: Vec::new(),
            results: Vec::new(),
            is_current: false,
        })
    }

    pub(crate) fn size(&self) -> (u32, u32) {
        self.culler.size()
    }

    /// Removes what is hidden from `list`, in place and in order. `view` is asked for once the boxes
    /// of the list are known.
    pub(crate) fn cull(
        &mut self,
        list: &mut Vec<Entity>,
        boxes: &Boxes<'_, '_>,
        listed: &Listed,
        occluders: &OccluderSet,
        threads: &dyn Threads,
        view: impl FnOnce(&[Aabb]) -> Result<View, CullError>,
    ) -> Outcome {
        let count = list.len();
        self.take(list, boxes, listed, |_| true);
        let refused = !self.test(occluders, threads, view);
        Outcome {
            listed: count,
            hidden: self.remove(list),
            refused,
            ..Outcome::default()
        }
    }

    /// Takes in the entities of a list that may leave it. Those whose box `condition` does not hold for
    /// leave it at once; returns how many.
    pub(crate) fn take(
        &mut self,
        list: &mut Vec<Entity>,
        boxes: &Boxes<'_, '_>,
        listed: &Listed,
        condition: impl Fn(&Aabb) -> bool,
    ) -> usize {
        self.is_current = false;
        self.boxes.clear();
        self.places.clear();
        let before = list.len();
        let mut place = 0;
        list.retain(|&entity| {
            let bounds = listed.settled(entity).then(|| boxes.of(entity)).flatten();
            if bounds.as_ref().is_some_and(|bounds| !condition(bounds)) {
                return false;
            }
            if let Some(bounds) = bounds {
                self.boxes.push(bounds);
                self.places.push(place);
            }
            place += 1;
            true
        });
        self.results.clear();
        self.results.resize(self.boxes.len(), Visibility::Visible);
        before - list.len()
    }

    /// How many entities of the list may leave it.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn removable(&self) -> usize {
        self.boxes.len()
    }

    /// Tests what was taken in; returns whether that was possible.
    pub(crate) fn test(
        &mut self,
        occluders: &OccluderSet,
        threads: &dyn Threads,
        view: impl FnOnce(&[Aabb]) -> Result<View, CullError>,
    ) -> bool {
        if self.boxes.is_empty() {
            return true;
        }
        let tested = view(&self.boxes).and_then(|view| {
            let options = FrameOptions::default();
            self.culler.rasterize(&view, occluders, &options, threads)?;
            self.culler.query(&self.boxes, [0.0; 3], &mut self.results)
        });
        if let Err(error) = tested {
            static SAID: Once = Once::new();
            SAID.call_once(|| warn!("a view is not culled for occlusion: {error} ({error:?})"));
            return false;
        }
        self.is_current = true;
        true
    }

    /// Marks further results as hidden: those whose entity in `list` and box `condition` does not
    /// hold for. Returns how many it has marked.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn keep(
        &mut self,
        list: &[Entity],
        condition: impl Fn(Entity, &Aabb) -> bool,
    ) -> usize {
        let mut left_out = 0;
        for ((result, &place), bounds) in self.results.iter_mut().zip(&self.places).zip(&self.boxes)
        {
            if *result != Visibility::Occluded && !condition(list[place as usize], bounds) {
                *result = Visibility::Occluded;
                left_out += 1;
            }
        }
        left_out
    }

    /// Removes what was found to be hidden; returns how many.
    pub(crate) fn remove(&mut self, list: &mut Vec<Entity>) -> usize {
        remove_hidden(list, &self.places, &self.results)
    }

    /// Looks for boxes in the buffer of this frame.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn look(&self, boxes: &[Aabb], results: &mut [Visibility]) {
        if !self.is_current || self.culler.query(boxes, [0.0; 3], results).is_err() {
            results.fill(Visibility::Visible);
        }
    }

    /// The boxes of the last list that are hidden.
    #[cfg(feature = "overlay")]
    pub(crate) fn hidden(&self) -> impl Iterator<Item = &Aabb> {
        let tested = self.boxes.iter().zip(&self.results);
        tested
            .filter(|(_, result)| **result == Visibility::Occluded)
            .map(|(bounds, _)| bounds)
    }

    /// The depth in the buffer, row by row from the top left.
    #[cfg(feature = "overlay")]
    pub(crate) fn read_depth(&self, texels: &mut [f32]) {
        if self.culler.read_depth(texels).is_err() {
            texels.fill(0.0);
        }
    }

    /// Whether the buffer is that of the last list taken in.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn is_current(&self) -> bool {
        self.is_current
    }

    /// Nothing is in the buffer any more.
    pub(crate) fn forget(&mut self) {
        self.is_current = false;
        self.boxes.clear();
        self.results.clear();
    }
}

/// Removes entities whose result is that they are hidden. Whether a box lies in the frustum is for
/// Bevy to say.
fn remove_hidden(list: &mut Vec<Entity>, places: &[u32], results: &[Visibility]) -> usize {
    let before = list.len();
    let mut tested = places.iter().zip(results).peekable();
    let mut place = 0;
    list.retain(|_| {
        let result = tested
            .next_if(|(at, _)| **at == place)
            .map(|(_, result)| *result);
        place += 1;
        result != Some(Visibility::Occluded)
    });
    before - list.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_hidden_entities_leave_and_the_order_stays() {
        use Visibility::{Occluded, Outside, Visible};
        let all: Vec<Entity> = (0..6).map(|i| Entity::from_raw_u32(i).unwrap()).collect();
        let mut list = all.clone();
        // Entity 1 and 4 were not tested.
        let hidden = remove_hidden(
            &mut list,
            &[0, 2, 3, 5],
            &[Occluded, Outside, Visible, Occluded],
        );
        assert_eq!((hidden, list), (2, all[1..5].to_vec()));
    }
}
