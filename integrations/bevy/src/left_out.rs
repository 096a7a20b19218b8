//! Which lights may be left out as a whole.
//!
//! A light is left out by hiding its entity. That must hide nothing else, and the light must be drawn
//! with shadows: Bevy draws those beyond its limit without, and they shine through walls.

use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{ViewVisibility, VisibilityClass};
use bevy_ecs::change_detection::Res;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::system::{Query, SystemParam};
use bevy_light::cluster::{ClusterVisibilityClass, GlobalClusterSettings};
use bevy_light::{DirectionalLight, PointLight, RectLight, SpotLight};
use bevy_mesh::Mesh3d;
use core::any::TypeId;

/// Layers of textures where the device is not known: four cube maps.
const FEW_LAYERS: usize = 24;
/// Bevy's `MAX_CASCADES_PER_LIGHT`.
const MOST_CASCADES: usize = 4;

/// The kinds of lights that may be left out in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LeftOut {
    pub(crate) point_lights: bool,
    pub(crate) spot_lights: bool,
}

/// What decides on it.
#[derive(SystemParam)]
pub(crate) struct Lights<'w, 's> {
    clusters: Option<Res<'w, GlobalClusterSettings>>,
    #[cfg(feature = "bevy_pbr")]
    device: Option<Res<'w, bevy_render::renderer::RenderDevice>>,
    point_lights: Query<'w, 's, (&'static PointLight, &'static ViewVisibility)>,
    spot_lights: Query<'w, 's, (&'static SpotLight, &'static ViewVisibility)>,
    directional_lights: Query<'w, 's, &'static DirectionalLight>,
}

impl Lights<'_, '_> {
    /// To be asked before any light is left out.
    pub(crate) fn may_be_left_out(&self) -> LeftOut {
        // Clusters that the processor fills have named their lights by now.
        let filled_later = self.clusters.as_ref();
        if filled_later.is_none_or(|clusters| clusters.gpu_clustering.is_none()) {
            return LeftOut::default();
        }
        let points = self.point_lights.iter();
        let points = points.filter(|(light, seen)| light.shadow_maps_enabled && seen.get());
        let spots = self.spot_lights.iter();
        let spots = spots.filter(|(light, seen)| light.shadow_maps_enabled && seen.get());
        let suns = self.directional_lights.iter();
        let suns = suns.filter(|light| light.shadow_maps_enabled);
        within_limits(self.layers(), points.count(), spots.count(), suns.count())
    }

    /// Layers that a texture may have.
    fn layers(&self) -> usize {
        // Bevy takes one for WebGL2, which may be chosen at run time.
        if cfg!(target_arch = "wasm32") {
            return 1;
        }
        #[cfg(feature = "bevy_pbr")]
        if let Some(device) = &self.device {
            return device.limits().max_texture_array_layers as usize;
        }
        FEW_LAYERS
    }
}

/// Mirrors `prepare_lights` of Bevy 0.19. Its one cube map on WebGL2 counts as none.
fn within_limits(layers: usize, points: usize, spots: usize, suns: usize) -> LeftOut {
    LeftOut {
        point_lights: points <= layers / 6,
        spot_lights: spots <= layers.saturating_sub(suns * MOST_CASCADES),
    }
}

/// Entities with nothing visible but one light.
#[derive(SystemParam)]
pub(crate) struct LightsAlone<'w, 's> {
    entities: Query<
        'w,
        's,
        &'static VisibilityClass,
        // `Aabb`: gizmos draw it where the entity is visible.
        (Without<Mesh3d>, Without<RectLight>, Without<MeshBounds>),
    >,
}

impl LightsAlone<'_, '_> {
    pub(crate) fn contains(&self, entity: Entity) -> bool {
        // Another light, a decal or a probe adds its class once more.
        let class = TypeId::of::<ClusterVisibilityClass>();
        self.entities
            .get(entity)
            .is_ok_and(|classes| classes.0[..] == [class])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_is_left_out_where_some_are_drawn_without_shadows() {
        let of = |points, spots, suns| {
            let left_out = within_limits(24, points, spots, suns);
            (left_out.point_lights, left_out.spot_lights)
        };
        assert_eq!(of(4, 24, 0), (true, true));
        assert_eq!(of(5, 25, 0), (false, false));
        assert_eq!(of(0, 16, 2), (true, true));
        assert_eq!(of(0, 17, 2), (true, false));
        assert_eq!(of(0, 1, 7), (true, false));
    }
}
