//! The sizes of shadow maps as Bevy draws them.

use bevy_ecs::change_detection::Res;
use bevy_ecs::system::SystemParam;
use bevy_light::{DirectionalLightShadowMap, PointLightShadowMap};

/// What decides on the sizes.
#[derive(SystemParam)]
pub(crate) struct MapSizes<'w> {
    points: Option<Res<'w, PointLightShadowMap>>,
    others: Option<Res<'w, DirectionalLightShadowMap>>,
    #[cfg(feature = "bevy_pbr")]
    device: Option<Res<'w, bevy_render::renderer::RenderDevice>>,
}

/// Square shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapSize {
    /// Texels along each side.
    pub(crate) side: usize,
    /// How many times as wide a texel is as Bevy has it, which goes by the side that is asked for.
    pub(crate) coarser: f32,
}

impl MapSizes<'_> {
    /// Texels along each side of a face of a point light's cube map.
    pub(crate) fn point_side(&self) -> Option<usize> {
        self.points.as_ref().map(|map| map.size)
    }

    /// The maps of spot and directional lights.
    pub(crate) fn others(&self) -> Option<MapSize> {
        let asked = self.others.as_ref()?.size;
        Some(MapSize::within(asked, self.largest()))
    }

    /// The largest side of a texture.
    fn largest(&self) -> usize {
        #[cfg(feature = "bevy_pbr")]
        if let Some(device) = &self.device {
            return device.limits().max_texture_dimension_2d as usize;
        }
        usize::MAX
    }
}

impl MapSize {
    /// Mirrors `prepare_lights` of Bevy 0.19: what is larger than the device's textures is as large as
    /// they are.
    fn within(asked: usize, largest: usize) -> Self {
        let side = asked.min(largest);
        Self {
            side,
            coarser: asked.max(1) as f32 / side.max(1) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_beyond_the_devices_limit_are_as_large_as_it_and_have_wider_texels() {
        let of = |asked, largest| {
            let size = MapSize::within(asked, largest);
            (size.side, size.coarser.to_bits())
        };
        assert_eq!(of(2048, 2048), (2048, 1.0_f32.to_bits()));
        assert_eq!(of(4096, usize::MAX), (4096, 1.0_f32.to_bits()));
        assert_eq!(of(8192, 2048), (2048, 4.0_f32.to_bits()));
        assert_eq!(of(0, 2048).0, 0);
    }
}
