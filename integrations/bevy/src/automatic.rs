//! Occluders that nobody marks: large, opaque things that stand still.

use crate::components::{NoOcclusionCulling, Occluder};
use crate::materials::{Verdict, verdict};
use bevy_asset::Assets;
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::VisibilityRange;
use bevy_ecs::change_detection::{DetectChanges, Res};
use bevy_ecs::component::Component;
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::query::{Changed, Or, With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Commands, Local, Query};
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_transform::components::GlobalTransform;

/// Makes large, opaque meshes with `StandardMaterial` that stand still into occluders. Without this
/// resource only entities with an [`Occluder`] of yours occlude.
///
/// Chosen entities get an [`Occluder`] and [`AutomaticOccluder`]; they lose both when they move,
/// or when their mesh or material changes, and get them again once they stand still. Entities with [`NoOcclusionCulling`] are not chosen. What
/// was chosen stays when the resource is removed.
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
    Without<SkinnedMesh>,
    Without<MeshMorphWeights>,
    Without<VisibilityRange>,
);

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
    no_longer: Query<
        Entity,
        (
            With<AutomaticOccluder>,
            Or<(
                Changed<GlobalTransform>,
                Changed<Mesh3d>,
                Changed<MeshMaterial3d<StandardMaterial>>,
                Without<Mesh3d>,
                Without<MeshMaterial3d<StandardMaterial>>,
                With<NoOcclusionCulling>,
                With<SkinnedMesh>,
                With<MeshMorphWeights>,
                With<VisibilityRange>,
            )>,
        ),
    >,
) {
    // Also without the settings: what was chosen stays only as long as it holds.
    for entity in &no_longer {
        commands
            .entity(entity)
            .try_remove::<(Occluder, AutomaticOccluder)>();
        waiting.insert(entity, 0);
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
            // Whether it is one-sided is for the material to say, in every frame anew.
            commands
                .entity(entity)
                .try_insert((Occluder::two_sided(), AutomaticOccluder));
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
