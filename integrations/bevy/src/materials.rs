//! What materials say about who may occlude.

use bevy_ecs::entity::{Entity, EntityHashMap, EntityHashSet};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::ResMut;

/// Flags of one entity's material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Verdict(u8);

impl Verdict {
    /// It does not cover all that its triangles cover, or is not drawn yet.
    pub(crate) const NEVER: Self = Self(1);
    /// One side of faces is not drawn.
    pub(crate) const ONE_SIDED: Self = Self(2);
    /// It is not drawn into shadow maps.
    pub(crate) const NO_SHADOW: Self = Self(4);
    /// Front faces are not drawn, as Bevy's glTF loader has it for what is mirrored.
    pub(crate) const FRONT_CULLED: Self = Self(8);
    /// It draws the same side of faces where a camera inverts culling.
    pub(crate) const NOT_INVERTED: Self = Self(16);

    pub(crate) fn contains(self, flag: Self) -> bool {
        self.0 & flag.0 != 0
    }

    #[cfg(feature = "bevy_pbr")]
    fn with(self, flag: Self, on: bool) -> Self {
        Self(self.0 | if on { flag.0 } else { 0 })
    }
}

/// What is known of an occluder's material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Judgment {
    pub(crate) verdict: Verdict,
    /// Another number where another pipeline or other textures may draw it.
    pub(crate) look: u64,
}

/// Judgments of this frame.
#[derive(Resource, Default)]
pub(crate) struct MaterialVerdicts {
    occluders: EntityHashMap<Judgment>,
    /// Entities that are drawn in front of what is nearer.
    pub(crate) in_front: EntityHashSet,
}

impl MaterialVerdicts {
    /// `None` where no material that is known was found.
    pub(crate) fn of(&self, entity: Entity) -> Option<Judgment> {
        self.occluders.get(&entity).copied()
    }
}

pub(crate) fn clear(mut verdicts: ResMut<MaterialVerdicts>) {
    verdicts.occluders.clear();
    verdicts.in_front.clear();
}

#[cfg(feature = "bevy_pbr")]
pub use of_pbr::OccluderMaterialPlugin;
#[cfg(feature = "bevy_pbr")]
pub(crate) use of_pbr::{judge_standard, verdict};

/// Verdicts on Bevy's materials.
#[cfg(feature = "bevy_pbr")]
mod of_pbr {
    use super::{Judgment, MaterialVerdicts, Verdict};
    use crate::components::Occluder;
    use crate::plugin::MaterialSteps;
    use bevy_app::{App, Plugin, PostUpdate};
    use bevy_asset::{AssetId, Assets, VisitAssetDependencies};
    use bevy_ecs::change_detection::{Res, ResMut};
    use bevy_ecs::entity::Entity;
    use bevy_ecs::query::With;
    use bevy_ecs::schedule::IntoScheduleConfigs;
    use bevy_ecs::system::{Local, Query};
    use bevy_image::Image;
    use bevy_material::AlphaMode;
    use bevy_pbr::{Material, MeshMaterial3d, StandardMaterial};
    use bevy_platform::collections::HashMap;
    use bevy_platform::hash::FixedHasher;
    use bevy_render::render_resource::Face;
    use core::hash::{BuildHasher, Hash, Hasher};

    /// Finds the `StandardMaterial` in another material.
    type Base<M> = fn(&M) -> Option<&StandardMaterial>;

    /// Lets a material of your own decide whether its entities may occlude: those that are not
    /// opaque, or read what was drawn behind them, do not. Without it, meshes with a material of your
    /// own never occlude. `StandardMaterial` needs no such plugin.
    ///
    /// It is taken to draw front faces alone, as Bevy's materials do unless they say otherwise. For
    /// an `ExtendedMaterial` of a `StandardMaterial` say where that is, for its `cull_mode` and its
    /// textures:
    ///
    /// ```
    /// # use bevy_app::App;
    /// # use bevy_foveal_cull::OccluderMaterialPlugin;
    /// # use bevy_pbr::{ExtendedMaterial, MaterialExtension, StandardMaterial};
    /// # fn add<Moss: MaterialExtension>(app: &mut App) {
    /// type Mossy<E> = ExtendedMaterial<StandardMaterial, E>;
    /// app.add_plugins(OccluderMaterialPlugin::<Mossy<Moss>>::based_on(|m| Some(&m.base)));
    /// # }
    /// ```
    ///
    /// An entity does not occlude before the textures of its material are loaded. They are known
    /// where the material marks them with `#[dependency]`; those of a `MaterialExtension` are not.
    pub struct OccluderMaterialPlugin<M>(Base<M>);

    impl<M> OccluderMaterialPlugin<M> {
        /// For a material that is drawn as a `StandardMaterial` in it says.
        #[must_use]
        pub fn based_on(base: fn(&M) -> Option<&StandardMaterial>) -> Self {
            Self(base)
        }
    }

    impl<M> Default for OccluderMaterialPlugin<M> {
        fn default() -> Self {
            Self(|_| None)
        }
    }

    impl<M: Material> Plugin for OccluderMaterialPlugin<M> {
        fn build(&self, app: &mut App) {
            let base = self.0;
            let judge_all = move |verdicts: ResMut<MaterialVerdicts>,
                                  materials: Option<Res<Assets<M>>>,
                                  images: Option<Res<Assets<Image>>>,
                                  judged: Local<HashMap<AssetId<M>, Judgment>>,
                                  occluders: Query<
                (Entity, &MeshMaterial3d<M>),
                With<Occluder>,
            >| {
                judge(base, verdicts, materials, images, judged, occluders)
            };
            app.add_systems(
                PostUpdate,
                (judge_all, find_in_front::<M>).in_set(MaterialSteps::Judge),
            );
        }
    }

    pub(crate) fn judge_standard(
        verdicts: ResMut<MaterialVerdicts>,
        materials: Option<Res<Assets<StandardMaterial>>>,
        images: Option<Res<Assets<Image>>>,
        judged: Local<HashMap<AssetId<StandardMaterial>, Judgment>>,
        occluders: Query<(Entity, &MeshMaterial3d<StandardMaterial>), With<Occluder>>,
    ) {
        judge(|m| Some(m), verdicts, materials, images, judged, occluders);
    }

    fn judge<M: Material>(
        base: Base<M>,
        mut verdicts: ResMut<MaterialVerdicts>,
        materials: Option<Res<Assets<M>>>,
        images: Option<Res<Assets<Image>>>,
        mut judged: Local<HashMap<AssetId<M>, Judgment>>,
        occluders: Query<(Entity, &MeshMaterial3d<M>), With<Occluder>>,
    ) {
        let Some(materials) = materials else { return };
        judged.clear();
        for (entity, material) in &occluders {
            let id = material.id();
            let one = *judged
                .entry(id)
                .or_insert_with(|| judgment(id, &materials, base, images.as_deref()));
            let of_all = verdicts.occluders.entry(entity).or_default();
            of_all.verdict.0 |= one.verdict.0;
            of_all.look ^= one.look;
        }
    }

    fn find_in_front<M: Material>(
        mut verdicts: ResMut<MaterialVerdicts>,
        materials: Option<Res<Assets<M>>>,
        entities: Query<(Entity, &MeshMaterial3d<M>)>,
    ) {
        let Some(materials) = materials else { return };
        for (entity, material) in &entities {
            if materials
                .get(&material.0)
                .is_some_and(|material| material.depth_bias() > 0.0)
            {
                verdicts.in_front.insert(entity);
            }
        }
    }

    fn judgment<M: Material>(
        id: AssetId<M>,
        materials: &Assets<M>,
        base: Base<M>,
        images: Option<&Assets<Image>>,
    ) -> Judgment {
        let mut look = FixedHasher.build_hasher();
        id.hash(&mut look);
        // An entity is not drawn before its material is there, nor before all of its textures are.
        let Some(material) = materials.get(id) else {
            return Judgment {
                verdict: Verdict::NEVER,
                look: look.finish(),
            };
        };
        let mut loaded = true;
        let mut texture = |id: bevy_asset::UntypedAssetId| {
            id.hash(&mut look);
            if let Ok(id) = id.try_typed::<Image>() {
                loaded &= images.is_some_and(|images| images.contains(id));
            }
        };
        material.visit_dependencies(&mut texture);
        let base = base(material);
        if let Some(base) = base {
            base.visit_dependencies(&mut texture);
        }
        let verdict = verdict(material, base).with(Verdict::NEVER, !loaded);
        verdict.hash(&mut look);
        Judgment {
            verdict,
            look: look.finish(),
        }
    }

    pub(crate) fn verdict<M: Material>(
        material: &M,
        standard: Option<&StandardMaterial>,
    ) -> Verdict {
        let see_through = material.alpha_mode() != AlphaMode::Opaque
            || material.reads_view_transmission_texture();
        let culled = standard.map_or(Some(Face::Back), |m| m.cull_mode);
        // It is drawn at another depth than it lies.
        let biased = material.depth_bias() != 0.0;
        Verdict::default()
            .with(Verdict::NEVER, see_through || biased)
            .with(Verdict::ONE_SIDED, culled.is_some())
            .with(Verdict::FRONT_CULLED, culled == Some(Face::Front))
            .with(Verdict::NOT_INVERTED, standard.is_none())
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
                verdict(&material, Some(&material))
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

        #[test]
        fn materials_of_which_nothing_more_is_known_draw_front_faces_alone() {
            let material = StandardMaterial {
                cull_mode: None,
                ..Default::default()
            };
            let unknown = verdict(&material, None);
            assert!(unknown.contains(Verdict::ONE_SIDED));
            assert!(unknown.contains(Verdict::NOT_INVERTED));
        }
    }
}
