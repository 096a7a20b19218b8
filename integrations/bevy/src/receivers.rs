//! What cameras see in this frame, as boxes that shadows may fall on.

use crate::cameras::CameraCullers;
use crate::components::{CpuOcclusionCulling, NoOcclusionCulling};
use crate::cull::{Boxes, world_box};
use crate::stats::CpuOcclusionStats;
use bevy_camera::Camera;
use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{NoCpuCulling, NoFrustumCulling, ViewVisibility, VisibleEntities};
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, Or, With, Without};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Local, Query};
use bevy_light::{
    DirectionalLight, NotShadowReceiver, PointLight, SpotLight, TransmittedShadowReceiver,
};
use bevy_mesh::Mesh3d;
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::SkinnedMesh;
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use core::any::TypeId;
use foveal_cull::{Aabb, Visibility};

/// Boxes are cut into cells of this side, metres, so that what reaches from the seen into the unseen
/// counts where it is seen.
const CELL_M: f32 = 2.0;
/// Most cells along each axis of a box.
const MOST_CELLS: f32 = 8.0;

/// A box of which a camera may see something.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) bounds: Aabb,
    /// Whether shadows fall on it; without them it is lit all the same.
    pub(crate) shadowed: bool,
}

/// What the cameras of this frame see.
#[derive(Resource, Default)]
pub(crate) struct Receivers {
    pub(crate) seen: Vec<Receiver>,
    /// Whether something is seen of which it is not known where it is.
    pub(crate) anywhere: bool,
    /// Whether they were looked for.
    pub(crate) known: bool,
}

#[cfg(feature = "bevy_pbr")]
type IsDecal = Has<bevy_pbr::decal::ForwardDecal>;
#[cfg(not(feature = "bevy_pbr"))]
type IsDecal = Has<NotShadowReceiver>;

type Light = Or<(With<PointLight>, With<SpotLight>, With<DirectionalLight>)>;

pub(crate) fn gather(
    mut receivers: ResMut<Receivers>,
    mut stats: ResMut<CpuOcclusionStats>,
    cullers: Res<CameraCullers>,
    boxes: Boxes,
    lights: Query<(&CpuOcclusionCulling, &ViewVisibility), Light>,
    cameras: Query<(Entity, &Camera, &VisibleEntities)>,
    meshes: Query<(
        Option<&MeshBounds>,
        &GlobalTransform,
        Has<NotShadowReceiver>,
        Has<TransmittedShadowReceiver>,
        IsDecal,
        (
            Has<NoFrustumCulling>,
            Has<NoOcclusionCulling>,
            Has<SkinnedMesh>,
            Has<MeshMorphWeights>,
        ),
    )>,
    unlisted: Query<(), (With<Mesh3d>, With<NoCpuCulling>, Without<NotShadowReceiver>)>,
    mut cells: Local<Vec<Receiver>>,
    mut cell_boxes: Local<Vec<Aabb>>,
    mut results: Local<Vec<Visibility>>,
) {
    receivers.seen.clear();
    receivers.anywhere = !unlisted.is_empty();
    receivers.known = lights
        .iter()
        .any(|(culling, visibility)| visibility.get() && !culling.keep_unseen_shadows);
    if !receivers.known || receivers.anywhere {
        return;
    }
    let begin = Instant::now();
    for (camera, settings, visible) in &cameras {
        if !settings.is_active {
            continue;
        }
        let culler = cullers.current(camera);
        cells.clear();
        for &entity in visible.get(TypeId::of::<Mesh3d>()) {
            let Ok((bounds, transform, not_shadowed, transmits, decal, moves)) = meshes.get(entity)
            else {
                receivers.anywhere = true;
                continue;
            };
            // A decal is lit where the surface below it is.
            if cfg!(feature = "bevy_pbr") && decal {
                continue;
            }
            let known = boxes.of(entity).or_else(|| {
                // Bias and wireframes move nothing in the world.
                let unknown = moves.0 || moves.1 || moves.2 || moves.3;
                let bounds = bounds.filter(|_| !unknown)?;
                Some(world_box(bounds, transform))
            });
            let known = known.filter(|_| !transmits || not_shadowed);
            match known.filter(|bounds| bounds.is_valid()) {
                Some(bounds) => cut(
                    Receiver {
                        bounds,
                        shadowed: !not_shadowed,
                    },
                    culler.is_some(),
                    &mut cells,
                ),
                None => receivers.anywhere = true,
            }
        }
        let Some(culler) = culler else {
            receivers.seen.append(&mut cells);
            continue;
        };
        cell_boxes.clear();
        cell_boxes.extend(cells.iter().map(|cell| cell.bounds));
        results.clear();
        results.resize(cells.len(), Visibility::Visible);
        culler.look(&cell_boxes, &mut results);
        let seen = cells.iter().zip(results.iter());
        receivers
            .seen
            .extend(seen.filter(|(_, r)| r.is_visible()).map(|(cell, _)| *cell));
    }
    stats.light_time += begin.elapsed();
}

/// Adds a receiver, cut into cells where it is large.
fn cut(receiver: Receiver, into_cells: bool, cells: &mut Vec<Receiver>) {
    let Aabb { min, max } = receiver.bounds;
    let counts: [f32; 3] = core::array::from_fn(|axis| {
        let side = max[axis] - min[axis];
        (side / CELL_M).ceil().clamp(1.0, MOST_CELLS)
    });
    if !into_cells || counts == [1.0; 3] {
        cells.push(receiver);
        return;
    }
    let edge = |axis: usize, i: f32| {
        let side = max[axis] - min[axis];
        // The last edge is the box's own, without rounding.
        if i < counts[axis] {
            min[axis] + side * (i / counts[axis])
        } else {
            max[axis]
        }
    };
    let steps = |axis: usize| (0..counts[axis] as u8).map(f32::from);
    for x in steps(0) {
        for y in steps(1) {
            for z in steps(2) {
                let low = [edge(0, x), edge(1, y), edge(2, z)];
                let high = [edge(0, x + 1.0), edge(1, y + 1.0), edge(2, z + 1.0)];
                let bounds = Aabb::new(low, high);
                cells.push(Receiver { bounds, ..receiver });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_math::Vec3;

    #[test]
    fn large_boxes_are_cut_into_cells_that_fill_them() {
        let receiver = |min, max| Receiver {
            bounds: Aabb::new(min, max),
            shadowed: true,
        };
        let mut cells = Vec::new();
        let floor = receiver(Vec3::new(-3.0, 0.0, 10.0), Vec3::new(3.5, 0.2, 13.0));
        cut(floor, true, &mut cells);
        assert_eq!(cells.len(), 4 * 2);
        let volume = |r: &Receiver| -> f32 {
            let side = |axis: usize| r.bounds.max[axis] - r.bounds.min[axis];
            side(0) * side(1) * side(2)
        };
        let sum: f32 = cells.iter().map(volume).sum();
        assert!((sum - volume(&floor)).abs() < 1e-3);
        assert!(cells.iter().all(|c| c.bounds.min[0] >= -3.0));
        assert!(
            cells
                .iter()
                .any(|c| c.bounds.max[0].to_bits() == 3.5_f32.to_bits())
        );

        cells.clear();
        cut(floor, false, &mut cells);
        cut(receiver(Vec3::ZERO, Vec3::ONE), true, &mut cells);
        assert_eq!(cells.len(), 2);
        cells.clear();
        cut(receiver(Vec3::ZERO, Vec3::splat(1e4)), true, &mut cells);
        assert_eq!(cells.len(), 512);
    }
}
