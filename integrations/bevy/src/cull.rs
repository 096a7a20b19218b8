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
    joints: Query<'w, 's, &'static GlobalTransform>,
    meshes: Res<'w, Assets<Mesh>>,
    bindposes: Option<Res<'w, Assets<SkinnedMeshInverseBindposes>>>,
    verdicts: Res<'w, MaterialVerdicts>,
    #[cfg(feature = "bevy_pbr")]
    materials: Option<Res<'w, Assets<bevy_pbr::StandardMaterial>>>,
    #[cfg(feature = "bevy_pbr")]
    wireframes: Option<Res<'w, bevy_pbr::wireframe::WireframeConfig>>,
}

#[cfg(feature = "bevy_pbr")]
type Material = Option<&'static bevy_pbr::MeshMaterial3d<bevy_pbr::StandardMaterial>>;
#[cfg(not(feature = "bevy_pbr"))]
type Material = ();

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
    fn of(&self, entity: Entity) -> Option<Aabb> {
        let (bounds, transform, mesh, skinned, follows_joints, material) =
            self.entities.get(entity).ok()?;
        if let Some(skinned) = skinned {
            // Where Bevy cannot find the bounds of the joints it leaves old ones.
            let bindposes = self.bindposes.as_ref()?.get(&skinned.inverse_bindposes)?;
            let mesh = self.meshes.get(&mesh?.0)?;
            if !follows_joints
                || entity_aabb_from_skinned_mesh_bounds(
                    &self.joints,
                    mesh,
                    skinned,
                    bindposes,
                    Some(transform),
                )
                .is_err()
            {
                return None;
            }
        }
        // A depth bias draws it in front of what is nearer.
        if self.verdicts.in_front.contains(&entity) || self.in_front(material) {
            return None;
        }
        let map = transform.affine();
        let (axes, half) = (map.matrix3, bounds.half_extents);
        let center = map.transform_point3a(bounds.center);
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        let half = half + (center.abs() + half) * ROUNDING;
        Some(Aabb::new(center - half, center + half))
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

/// What became of a view's list.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) listed: usize,
    pub(crate) hidden: usize,
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
}

impl ViewCuller {
    pub(crate) fn new(size: (u32, u32)) -> Result<Self, CullError> {
        Ok(Self {
            culler: Culler::new(size.0, size.1)?,
            boxes: Vec::new(),
            places: Vec::new(),
            results: Vec::new(),
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
        let mut outcome = Outcome {
            listed: list.len(),
            ..Outcome::default()
        };
        self.boxes.clear();
        self.places.clear();
        for (place, &entity) in (0..).zip(list.iter()) {
            if listed.settled(entity)
                && let Some(bounds) = boxes.of(entity)
            {
                self.boxes.push(bounds);
                self.places.push(place);
            }
        }
        if self.boxes.is_empty() {
            return outcome;
        }
        let tested = view(&self.boxes).and_then(|view| {
            let options = FrameOptions::default();
            self.culler.rasterize(&view, occluders, &options, threads)?;
            self.results.clear();
            self.results.resize(self.boxes.len(), Visibility::Visible);
            self.culler.query(&self.boxes, [0.0; 3], &mut self.results)
        });
        if let Err(error) = tested {
            static SAID: Once = Once::new();
            SAID.call_once(|| warn!("a view is not culled for occlusion: {error} ({error:?})"));
            outcome.refused = true;
            return outcome;
        }
        outcome.hidden = remove_hidden(list, &self.places, &self.results);
        outcome
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
