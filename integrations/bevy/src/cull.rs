//! One view: its list of entities is tested against its occlusion buffer.

use crate::components::NoOcclusionCulling;
use crate::stats::CpuOcclusionStats;
use bevy_asset::Assets;
use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{DynamicSkinnedMeshBounds, NoCpuCulling, NoFrustumCulling};
use bevy_ecs::change_detection::Res;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, Without};
use bevy_ecs::system::{Query, SystemParam};
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::SkinnedMesh;
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
            Has<SkinnedMesh>,
            Has<DynamicSkinnedMeshBounds>,
        ),
        (
            Without<NoOcclusionCulling>,
            Without<NoFrustumCulling>,
            Without<NoCpuCulling>,
            Without<MeshMorphWeights>,
        ),
    >,
    meshes: Res<'w, Assets<Mesh>>,
}

impl Boxes<'_, '_> {
    /// The box in the world; `None` where nothing is known of where the entity is.
    fn of(&self, entity: Entity) -> Option<Aabb> {
        let (bounds, transform, mesh, skinned, follows_joints) = self.entities.get(entity).ok()?;
        if skinned {
            let mesh = self.meshes.get(&mesh?.0)?;
            if !(follows_joints && mesh.skinned_mesh_bounds().is_some()) {
                return None;
            }
        }
        let map = transform.affine();
        let (axes, half) = (map.matrix3, bounds.half_extents);
        let center = map.transform_point3a(bounds.center);
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        let half = half + (center.abs() + half) * ROUNDING;
        Some(Aabb::new(center - half, center + half))
    }
}

/// What became of a view's list.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) listed: usize,
    pub(crate) hidden: usize,
    pub(crate) refused: bool,
}

impl Outcome {
    pub(crate) fn add_to(self, stats: &mut CpuOcclusionStats, of_light: bool) {
        stats.refused_views += usize::from(self.refused);
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
            if let Some(bounds) = boxes.of(entity) {
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
