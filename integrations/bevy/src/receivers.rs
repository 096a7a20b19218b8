//! What cameras see in this frame, as boxes that shadows may fall on.

use crate::cameras::CameraCullers;
use crate::components::{CpuOcclusionCulling, NoOcclusionCulling};
use crate::cull::{Boxes, Material, world_box};
use crate::left_out::{LeftOut, Lights};
use crate::stats::CpuOcclusionStats;
use bevy_camera::Camera;
use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{NoCpuCulling, NoFrustumCulling, ViewVisibility, VisibleEntities};
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, Or, With};
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
/// Most cells of a camera: beyond them boxes stay whole.
const MOST_IN_VIEW: usize = 10_000;

/// A box of which a camera may see something.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) bounds: Aabb,
    /// Whether shadows fall on it.
    pub(crate) shadowed: bool,
    /// Whether it may be lit, in part at least, where it is in shadow.
    pub(crate) lit_anyway: bool,
}

/// What the cameras of this frame see.
#[derive(Resource, Default)]
pub(crate) struct Receivers {
    pub(crate) seen: Vec<Receiver>,
    /// Whether something is seen of which it is not known where it is.
    pub(crate) anywhere: bool,
    /// Whether something is lit without shadows of which it is not known where it is.
    pub(crate) lit_anywhere: bool,
    /// Which lights may be left out.
    pub(crate) left_out: LeftOut,
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
    all_lights: Lights,
    lights: Query<(&CpuOcclusionCulling, &ViewVisibility), Light>,
    cameras: Query<(Entity, &Camera, &VisibleEntities)>,
    meshes: Query<(
        Option<&MeshBounds>,
        &GlobalTransform,
        Has<NotShadowReceiver>,
        Has<TransmittedShadowReceiver>,
        IsDecal,
        Material,
        (
            Has<NoFrustumCulling>,
            Has<NoOcclusionCulling>,
            Has<SkinnedMesh>,
            Has<MeshMorphWeights>,
        ),
    )>,
    unlisted: Query<Has<NotShadowReceiver>, (With<Mesh3d>, With<NoCpuCulling>)>,
    mut cells: Local<Vec<Receiver>>,
    mut cell_boxes: Local<Vec<Aabb>>,
    mut results: Local<Vec<Visibility>>,
) {
    receivers.seen.clear();
    receivers.anywhere = unlisted.iter().any(|not_shadowed| !not_shadowed);
    receivers.lit_anywhere = !unlisted.is_empty();
    receivers.known = lights
        .iter()
        .any(|(culling, visibility)| visibility.get() && !culling.keep_unseen_shadows);
    if !receivers.known || receivers.anywhere {
        return;
    }
    let begin = Instant::now();
    receivers.left_out = all_lights.may_be_left_out();
    for (camera, settings, visible) in &cameras {
        if !settings.is_active {
            continue;
        }
        let culler = cullers.current(camera);
        cells.clear();
        for &entity in visible.get(TypeId::of::<Mesh3d>()) {
            let Ok((bounds, transform, not_shadowed, transmits, decal, material, moves)) =
                meshes.get(entity)
            else {
                receivers.anywhere = true;
                receivers.lit_anywhere = true;
                continue;
            };
            let lit_anyway = not_shadowed || boxes.may_transmit(material);
            // A decal is lit beside itself, by a material of which nothing is known.
            if cfg!(feature = "bevy_pbr") && decal {
                receivers.anywhere |= !not_shadowed;
                receivers.lit_anywhere = true;
                continue;
            }
            let receiver = |bounds| Receiver {
                bounds,
                shadowed: !not_shadowed,
                lit_anyway,
            };
            let known = |bounds: &Aabb| bounds.is_valid() && (!transmits || not_shadowed);
            if let Some(bounds) = boxes.of(entity).filter(known) {
                cut(receiver(bounds), culler.is_some(), &mut cells);
                continue;
            }
            // What may be drawn in front of occluders is seen. Bias and wireframes move nothing in
            // the world.
            let unknown = moves.0 || moves.1 || moves.2 || moves.3;
            let bounds = bounds
                .filter(|_| !unknown)
                .map(|bounds| world_box(bounds, transform));
            match bounds.filter(known) {
                Some(bounds) => receivers.seen.push(receiver(bounds)),
                None => {
                    receivers.anywhere |= !not_shadowed;
                    receivers.lit_anywhere |= lit_anyway;
                }
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
    let count = counts.iter().product::<f32>() as usize;
    if !into_cells || count == 1 || cells.len() + count > MOST_IN_VIEW {
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
            lit_anyway: false,
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
        // Not without end.
        for _ in 0..1_000 {
            cut(receiver(Vec3::ZERO, Vec3::splat(1e4)), true, &mut cells);
        }
        let whole = cells
            .iter()
            .filter(|c| c.bounds.max == [1e4; 3] && c.bounds.min == [0.0; 3]);
        let cut_in_cells = MOST_IN_VIEW / 512;
        assert_eq!(whole.count(), 1_001 - cut_in_cells);
        assert_eq!(cells.len(), 1_001 - cut_in_cells + 512 * cut_in_cells);
    }
}
