//! What materials say about who may occlude.
//!
//! Only exceptions are kept: an entity without a verdict may occlude, from both sides and in shadow
//! maps.

use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::ResMut;

/// Flags of one entity's material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Verdict(u8);

impl Verdict {
    /// It does not cover all that its triangles cover.
    pub(crate) const NEVER: Self = Self(1);
    /// One side of faces is not drawn.
    pub(crate) const ONE_SIDED: Self = Self(2);
    /// It is not drawn into shadow maps.
    pub(crate) const NO_SHADOW: Self = Self(4);
    /// Front faces are not drawn, as Bevy's glTF loader has it for what is mirrored.
    pub(crate) const FRONT_CULLED: Self = Self(8);

    pub(crate) fn contains(self, flag: Self) -> bool {
        self.0 & flag.0 != 0
    }

    #[cfg(feature = "bevy_pbr")]
    fn with(self, flag: Self, on: bool) -> Self {
        Self(self.0 | if on { flag.0 } else { 0 })
    }
}

/// Verdicts of this frame.
#[derive(Resource, Default)]
pub(crate) struct MaterialVerdicts(EntityHashMap<Verdict>);

impl MaterialVerdicts {
    pub(crate) fn of(&self, entity: Entity) -> Verdict {
        self.0.get(&entity).copied().unwrap_or_default()
    }
}

pub(crate) fn clear(mut verdicts: ResMut<MaterialVerdicts>) {
    verdicts.0.clear();
}

#[cfg(feature = "bevy_pbr")]
pub use of_pbr::OccluderMaterialPlugin;
#[cfg(feature = "bevy_pbr")]
pub(crate) use of_pbr::{judge, verdict};

/// Verdicts on Bevy's materials.
#[cfg(feature = "bevy_pbr")]
mod of_pbr {
    use super::{MaterialVerdicts, Verdict};
    use crate::components::Occluder;
    use crate::plugin::MaterialSteps;
    use bevy_app::{App, Plugin, PostUpdate};
    use bevy_asset::Assets;
    use bevy_ecs::change_detection::{Res, ResMut};
    use bevy_ecs::entity::Entity;
    use bevy_ecs::query::With;
    use bevy_ecs::schedule::IntoScheduleConfigs;
    use bevy_ecs::system::Query;
    use bevy_material::AlphaMode;
    use bevy_pbr::{Material, MeshMaterial3d, StandardMaterial};
    use bevy_render::render_resource::Face;
    use core::any::Any;
    use core::marker::PhantomData;

    /// Lets a material of your own decide whether its entities may occlude: those that are not
    /// opaque, or read what was drawn behind them, do not. `StandardMaterial` needs no such plugin.
    pub struct OccluderMaterialPlugin<M>(PhantomData<M>);

    impl<M> Default for OccluderMaterialPlugin<M> {
        fn default() -> Self {
            Self(PhantomData)
        }
    }

    impl<M: Material> Plugin for OccluderMaterialPlugin<M> {
        fn build(&self, app: &mut App) {
            app.add_systems(PostUpdate, judge::<M>.in_set(MaterialSteps::Judge));
        }
    }

    pub(crate) fn judge<M: Material>(
        mut verdicts: ResMut<MaterialVerdicts>,
        materials: Option<Res<Assets<M>>>,
        occluders: Query<(Entity, &MeshMaterial3d<M>), With<Occluder>>,
    ) {
        let Some(materials) = materials else { return };
        for (entity, material) in &occluders {
            // An entity is not drawn before its material is there.
            let verdict = materials.get(&material.0).map_or(Verdict::NEVER, verdict);
            if verdict != Verdict::default() {
                verdicts.0.entry(entity).or_default().0 |= verdict.0;
            }
        }
    }

    pub(crate) fn verdict<M: Material>(material: &M) -> Verdict {
        let see_through = material.alpha_mode() != AlphaMode::Opaque
            || material.reads_view_transmission_texture();
        let standard = (material as &dyn Any).downcast_ref::<StandardMaterial>();
        let culled = standard.and_then(|m| m.cull_mode);
        // It is drawn at another depth than it lies.
        let biased = material.depth_bias() != 0.0;
        Verdict::default()
            .with(Verdict::NEVER, see_through || biased)
            .with(Verdict::ONE_SIDED, culled.is_some())
            .with(Verdict::FRONT_CULLED, culled == Some(Face::Front))
            .with(Verdict::NO_SHADOW, !M::enable_shadows())
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn only_opaque_materials_may_occlude() {
            let of = |change: fn(&mut StandardMaterial)| {
                let mut material = StandardMaterial::default();
                change(&mut material);
                verdict(&material)
            };
            let never = |change| of(change).contains(Verdict::NEVER);
            assert!(!never(|_| ()));
            assert!(never(|m| m.alpha_mode = AlphaMode::Blend));
            assert!(never(|m| m.alpha_mode = AlphaMode::Mask(0.5)));
            assert!(never(|m| m.specular_transmission = 0.5));
            assert!(never(|m| m.depth_bias = 3.0));
            assert!(of(|_| ()).contains(Verdict::ONE_SIDED));
            assert!(of(|m| m.cull_mode = Some(Face::Front)).contains(Verdict::FRONT_CULLED));
            assert_eq!(of(|m| m.cull_mode = None), Verdict::default());
        }
    }
}
