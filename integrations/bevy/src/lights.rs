//! Lights: shadow casters that are hidden from the light leave the lists of its shadow maps.
//!
//! What is hidden from the light behind other casters changes no texel of the shadow map. What casts
//! its shadow on nothing that a camera sees changes texels that nobody looks up. A point or spot
//! light that lights nothing that is seen is not drawn at all, if nothing else is on its entity.

use crate::components::CpuOcclusionCulling;
use crate::cull::Boxes;
use crate::left_out::LightsAlone;
use crate::map_sizes::MapSizes;
use crate::occluders::{Occluders, Range};
use crate::reach::{Reach, is_soft};
use crate::ready::{ListedByView, Looks, Pipelines};
use crate::receivers::Receivers;
use crate::shadow_map::{Cullers, Face, Faces};
use crate::stats::CpuOcclusionStats;
use crate::view::{Fit, NearSpace, clip_from_world};
use bevy_camera::primitives::CUBE_MAP_FACES;
use bevy_camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, NoCpuCulling, RenderLayers, ViewVisibility,
    VisibleMeshEntities,
};
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, With, Without};
use bevy_ecs::system::{Local, Query};
use bevy_light::cascade::Cascades;
use bevy_light::{
    DirectionalLight, NotShadowCaster, PointLight, SpotLight, VolumetricLight,
    spot_light_clip_from_view, spot_light_world_from_view,
};
use bevy_math::{Affine3A, Mat4};
use bevy_platform::time::Instant;
use bevy_transform::components::{GlobalTransform, Transform};
use core::f32::consts::FRAC_PI_2;

/// A light whose shadow maps are culled.
struct Light<'a> {
    entity: Entity,
    culling: &'a CpuOcclusionCulling,
    layers: Option<&'a RenderLayers>,
    /// Texels of a shadow map along each side.
    side: Option<usize>,
    /// `None` where all shadows are drawn.
    reach: Option<Reach>,
}

/// What is the same for all lights of a frame.
struct Frame<'w, 's, 'a> {
    occluders: &'a mut Occluders,
    stats: &'a mut CpuOcclusionStats,
    cullers: &'a mut Cullers,
    listed: &'a mut ListedByView,
    receivers: &'a Receivers,
    boxes: &'a Boxes<'w, 's>,
    looks: &'a Looks<'w, 's>,
    waiting: bool,
    not_casters: &'a Query<'w, 's, (), With<NotShadowCaster>>,
}

impl Frame<'_, '_, '_> {
    /// Culls the shadow maps of a light. Returns whether it lights nothing that is seen, and may be
    /// left out itself.
    fn cull(&mut self, light: &Light<'_>, faces: &mut [Face<'_>]) -> bool {
        let size = light.culling.buffer_size;
        let Some(fit) = light.side.and_then(|side| Fit::of_shadow_map(size, side)) else {
            return false;
        };
        let listed = self.listed.of(light.entity);
        listed.note(faces.iter().map(|face| &*face.list), self.looks);
        let layers = light.layers.unwrap_or_default();
        // Where casters before the near plane are drawn, it cuts nothing.
        let cutting = faces.iter().filter(|face| !face.casters_before_near);
        let near: Vec<NearSpace> = cutting
            .map(|face| NearSpace::of(face.clip_from_world))
            .collect();
        let on = self.occluders.enable(|entity, entry| {
            layers.intersects(&entry.layers)
                && (!entry.listed || listed.settled(entity))
                && entry.range == Range::None
                && entry.shadows
                && near.iter().all(|near| entry.is_closed(near))
                && !self.not_casters.contains(entity)
        });
        for face in &mut *faces {
            face.outcome.listed = face.list.len();
            face.outcome.waiting = self.waiting;
        }
        let seen = light
            .reach
            .filter(|_| self.receivers.known && !self.receivers.anywhere)
            .filter(|_| !light.culling.keep_unseen_shadows)
            .map(|reach| reach.of(&self.receivers.seen));
        if !self.waiting && (on > 0 || seen.is_some()) {
            let occluders = &*self.occluders;
            let shared = Faces {
                fit: &fit,
                boxes: self.boxes,
                listed,
                occluders: (on > 0).then(|| (occluders, occluders.are_all_listed())),
                seen: seen.as_ref(),
            };
            shared.cull(faces, self.cullers.of(fit.size, faces.len()));
        }
        let unseen = seen.is_some_and(|seen| !seen.anyway)
            && !self.receivers.lit_anywhere
            && !faces.iter().any(|face| face.lights_seen);
        for face in faces {
            face.outcome.coarse = fit.coarse;
            face.outcome.add_to(self.stats, true);
        }
        unseen
    }
}

pub(crate) fn cull(
    mut occluders: ResMut<Occluders>,
    mut stats: ResMut<CpuOcclusionStats>,
    mut cullers: Local<Cullers>,
    mut listed: Local<ListedByView>,
    receivers: Res<Receivers>,
    boxes: Boxes,
    looks: Looks,
    pipelines: Res<Pipelines>,
    not_casters: Query<(), With<NotShadowCaster>>,
    alone: LightsAlone,
    map_sizes: MapSizes,
    // Of lights with `NoCpuCulling` Bevy fills no lists, and does not show them again once they are
    // hidden. It fills those of the sun.
    mut point_lights: Query<
        (
            Entity,
            &PointLight,
            &GlobalTransform,
            &mut ViewVisibility,
            &CpuOcclusionCulling,
            &mut CubemapVisibleEntities,
            Option<&RenderLayers>,
            Has<VolumetricLight>,
        ),
        Without<NoCpuCulling>,
    >,
    mut spot_lights: Query<
        (
            Entity,
            &SpotLight,
            &GlobalTransform,
            &mut ViewVisibility,
            &CpuOcclusionCulling,
            &mut VisibleMeshEntities,
            Option<&RenderLayers>,
            Has<VolumetricLight>,
        ),
        (Without<PointLight>, Without<NoCpuCulling>),
    >,
    mut directional_lights: Query<
        (
            Entity,
            &DirectionalLight,
            &Cascades,
            &ViewVisibility,
            &CpuOcclusionCulling,
            &mut CascadesVisibleEntities,
            Option<&RenderLayers>,
            Has<VolumetricLight>,
        ),
        (Without<PointLight>, Without<SpotLight>),
    >,
) {
    let begin = Instant::now();
    cullers.begin_frame();
    listed.begin_frame();
    let (point_side, others) = (map_sizes.point_side(), map_sizes.others());
    let other_side = others.map(|map| map.side);
    let mut frame = Frame {
        occluders: &mut occluders,
        stats: &mut stats,
        cullers: &mut cullers,
        listed: &mut listed,
        receivers: &receivers,
        boxes: &boxes,
        looks: &looks,
        waiting: pipelines.waiting,
        not_casters: &not_casters,
    };

    // Bevy fills the lists of lights with shadows that a camera sees; those of others are old.
    for (entity, light, transform, mut visibility, culling, mut casters, layers, volumetric) in
        &mut point_lights
    {
        if !(light.shadow_maps_enabled && visibility.get()) {
            continue;
        }
        let near = light.shadow_map_near_z;
        let clip_from_view = Mat4::perspective_infinite_reverse_rh(FRAC_PI_2, 1.0, near);
        let place = Transform::from_translation(transform.translation());
        let mut faces: Vec<Face> = CUBE_MAP_FACES
            .iter()
            .zip(casters.iter_mut())
            .map(|(face, casters)| {
                let rotation = Transform::IDENTITY.looking_at(face.target, face.up);
                let pose: Affine3A = (place * rotation).compute_affine();
                Face::new(clip_from_world(clip_from_view, pose), casters)
            })
            .collect();
        let light = Light {
            entity,
            culling,
            layers,
            side: point_side,
            reach: (!volumetric && !is_soft(light))
                .then(|| Reach::of_point_light(light, transform, point_side)),
        };
        let unseen = frame.cull(&light, &mut faces);
        if unseen && receivers.left_out.point_lights && alone.contains(entity) {
            *visibility = ViewVisibility::HIDDEN;
            frame.stats.lights_unseen += 1;
        }
    }
    for (entity, light, transform, mut visibility, culling, mut casters, layers, volumetric) in
        &mut spot_lights
    {
        if !(light.shadow_maps_enabled && visibility.get()) {
            continue;
        }
        let angle = drawn_angle(light.outer_angle);
        let clip_from_view = spot_light_clip_from_view(angle, light.shadow_map_near_z);
        let pose = spot_light_world_from_view(transform);
        let mut face = [Face::new(
            clip_from_world(clip_from_view, pose),
            &mut casters,
        )];
        // A wider one lights more than its shadow map shows.
        let all_in_map = light.outer_angle < FRAC_PI_2;
        let light = Light {
            entity,
            culling,
            layers,
            side: other_side,
            reach: (!volumetric && !is_soft(light) && all_in_map)
                .then(|| Reach::of_spot_light(light, transform, other_side)),
        };
        let unseen = frame.cull(&light, &mut face);
        if unseen && receivers.left_out.spot_lights && alone.contains(entity) {
            *visibility = ViewVisibility::HIDDEN;
            frame.stats.lights_unseen += 1;
        }
    }
    for (entity, light, cascades, visibility, culling, mut casters, layers, volumetric) in
        &mut directional_lights
    {
        if !(light.shadow_maps_enabled && visibility.get()) {
            continue;
        }
        let mut faces: Vec<Face> = Vec::new();
        let coarser = others.map_or(1.0, |map| map.coarser);
        let mut texel = 0.0_f32;
        for (camera, lists) in &mut casters.entities {
            let of_camera = cascades.cascades.get(camera).into_iter().flatten();
            for (cascade, casters) in of_camera.zip(lists) {
                texel = texel.max(cascade.texel_size);
                faces.push(Face {
                    casters_before_near: true,
                    ..Face::new(cascade.clip_from_world.as_dmat4(), casters)
                });
            }
        }
        let light = Light {
            entity,
            culling,
            layers,
            side: other_side,
            reach: (!volumetric && !is_soft(light))
                .then(|| Reach::of_directional_light(light, texel, coarser)),
        };
        // The sun itself is left alone: it lights what no cascade reaches.
        frame.cull(&light, &mut faces);
    }
    stats.light_time += begin.elapsed();
}

/// The angle that Bevy draws a spot light's shadow map with.
fn drawn_angle(outer_angle: f32) -> f32 {
    if outer_angle >= FRAC_PI_2 {
        FRAC_PI_2 - 1e-4
    } else {
        outer_angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_spot_lights_are_culled_as_they_are_drawn() {
        assert_eq!(drawn_angle(1.0).to_bits(), 1.0_f32.to_bits());
        assert!(drawn_angle(2.0) < FRAC_PI_2);
    }
}
