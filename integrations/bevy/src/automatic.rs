//! Occluders that nobody marks: large, opaque things that stand still.

use crate::components::{NoOcclusionCulling, Occluder};
use crate::materials::{Verdict, verdict};
use bevy_asset::Assets;
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{NoCpuCulling, VisibilityRange};
use bevy_ecs::change_detection::{DetectChanges, Ref, Res};
use bevy_ecs::component::Component;
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::lifecycle::RemovedComponents;
use bevy_ecs::query::{Changed, Or, With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Commands, Local, Query, SystemParam};
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_transform::components::GlobalTransform;

/// Makes large, opaque meshes with `StandardMaterial` that stand still into occluders. Without this
/// resource only entities with an [`Occluder`] of yours occlude.
///
/// Chosen entities get an [`Occluder`] and [`AutomaticOccluder`]; they lose both when they move, or
/// when their mesh or material changes, and get them again once they stand still. Entities with
/// [`NoOcclusionCulling`] are not chosen. An [`Occluder`] of yours is left as it is, also on what
/// was chosen, which then loses [`AutomaticOccluder`]. What was chosen stays when the resource is
/// removed.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct AutomaticOccluders {
    /// Least length of the second longest side of the entity's box; 1.5 by default.
    pub min_side: f32,
    /// Most vertices or indices of the mesh, whichever it has; 6,000 by default.
    pub max_corners: usize,
    /// Frames that the entity must have stood still; 10 by default.
    pub still_frames: u32,
}

impl Default for AutomaticOccluders {
    fn default() -> Self {
        Self {
            min_side: 1.5,
            max_corners: 6000,
            still_frames: 10,
        }
    }
}

/// On entities whose [`Occluder`] was put there by [`AutomaticOccluders`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AutomaticOccluder;

type Candidate = (
    Without<Occluder>,
    Without<NoOcclusionCulling>,
    Without<NoCpuCulling>,
    Without<SkinnedMesh>,
    Without<MeshMorphWeights>,
    Without<VisibilityRange>,
);

/// What an entity gets that is chosen. Whether it is one-sided is for the material to say, in every
/// frame anew.
fn chosen() -> Occluder {
    Occluder::two_sided()
}

/// Whether an `Occluder` on what was chosen is a user's: another one, or written since.
fn is_theirs(occluder: &Ref<'_, Occluder>, mark: &Ref<'_, AutomaticOccluder>) -> bool {
    **occluder != chosen() || occluder.last_changed() != mark.last_changed()
}

/// What has lost something that kept it from being chosen.
#[derive(SystemParam)]
pub(crate) struct Freed<'w, 's> {
    occluder: RemovedComponents<'w, 's, Occluder>,
    not_culled: RemovedComponents<'w, 's, NoOcclusionCulling>,
    not_listed: RemovedComponents<'w, 's, NoCpuCulling>,
    skinned: RemovedComponents<'w, 's, SkinnedMesh>,
    morphing: RemovedComponents<'w, 's, MeshMorphWeights>,
    range: RemovedComponents<'w, 's, VisibilityRange>,
}

impl Freed<'_, '_> {
    fn read(&mut self) -> impl Iterator<Item = Entity> {
        let moves = self.skinned.read().chain(self.morphing.read());
        let marks = self.not_culled.read().chain(self.not_listed.read());
        let others = self.occluder.read().chain(self.range.read());
        moves.chain(marks).chain(others)
    }
}

pub(crate) fn choose(
    mut commands: Commands,
    settings: Option<Res<AutomaticOccluders>>,
    meshes: Res<Assets<Mesh>>,
    materials: Option<Res<Assets<StandardMaterial>>>,
    mut waiting: Local<EntityHashMap<u32>>,
    changed: Query<
        Entity,
        (
            Candidate,
            With<MeshMaterial3d<StandardMaterial>>,
            Or<(
                Changed<GlobalTransform>,
                Changed<Aabb>,
                Changed<Mesh3d>,
                Changed<MeshMaterial3d<StandardMaterial>>,
            )>,
        ),
    >,
    candidates: Query<
        (
            Entity,
            &Mesh3d,
            &MeshMaterial3d<StandardMaterial>,
            &Aabb,
            &GlobalTransform,
        ),
        Candidate,
    >,
    mut freed: Freed,
    taken_over: Query<(Entity, Ref<Occluder>, Ref<AutomaticOccluder>), Changed<Occluder>>,
    no_longer: Query<
        (Entity, Option<Ref<Occluder>>, Ref<AutomaticOccluder>),
        (
            Or<(
                Changed<GlobalTransform>,
                Changed<Mesh3d>,
                Changed<MeshMaterial3d<StandardMaterial>>,
                Without<Occluder>,
                Without<Mesh3d>,
                Without<MeshMaterial3d<StandardMaterial>>,
                With<NoOcclusionCulling>,
                With<NoCpuCulling>,
                With<SkinnedMesh>,
                With<MeshMorphWeights>,
                With<VisibilityRange>,
            )>,
        ),
    >,
) {
    // Also without the settings: what was chosen stays only as long as it holds.
    for (entity, occluder, mark) in &no_longer {
        if !occluder.is_some_and(|occluder| is_theirs(&occluder, &mark)) {
            commands
                .entity(entity)
                .try_remove::<(Occluder, AutomaticOccluder)>();
            waiting.insert(entity, 0);
        }
    }
    for (entity, occluder, mark) in &taken_over {
        if is_theirs(&occluder, &mark) {
            commands.entity(entity).try_remove::<AutomaticOccluder>();
        }
    }
    for entity in freed.read() {
        waiting.entry(entity).or_insert(0);
    }
    let (Some(settings), Some(materials)) = (settings, materials) else {
        waiting.clear();
        return;
    };
    waiting.extend(changed.iter().map(|entity| (entity, 0)));
    if settings.is_changed() {
        waiting.extend(candidates.iter().map(|(entity, ..)| (entity, 0)));
    }
    waiting.retain(|&entity, still| {
        *still += 1;
        if *still <= settings.still_frames {
            return true;
        }
        let Ok((_, mesh, material, bounds, transform)) = candidates.get(entity) else {
            return false;
        };
        let (Some(mesh), Some(material)) = (meshes.get(&mesh.0), materials.get(&material.0)) else {
            // Not loaded yet.
            return true;
        };
        let small = second_side(bounds, transform) < settings.min_side;
        let detailed = corners(mesh).is_none_or(|corners| corners > settings.max_corners);
        if !(small || detailed || verdict(material, Some(material)).contains(Verdict::NEVER)) {
            // One that a user puts there in this very frame stays.
            commands
                .entity(entity)
                .try_insert_if_new((chosen(), AutomaticOccluder));
        }
        false
    });
}

/// The length of the second longest side of a box in the world.
fn second_side(bounds: &Aabb, transform: &GlobalTransform) -> f32 {
    let axes = transform.affine().matrix3;
    let half = bounds.half_extents;
    let mut sides = [
        axes.x_axis.length() * half.x,
        axes.y_axis.length() * half.y,
        axes.z_axis.length() * half.z,
    ];
    sides.sort_by(f32::total_cmp);
    2.0 * sides[1]
}

/// Indices or vertices; `None` where the vertices are not in the main world.
fn corners(mesh: &Mesh) -> Option<usize> {
    let positions = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).ok()?;
    let indices = mesh.try_indices_option().ok()?;
    Some(indices.map_or(positions.len(), |indices| indices.len()))
}
