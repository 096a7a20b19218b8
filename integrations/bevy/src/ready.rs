//! What is ready to be drawn: Bevy draws no entity before its pipeline is compiled, and compiles
//! pipelines only for what a view lists.
//!
//! An entity is relied on, as an occluder or by leaving a list, once a view has listed it in some
//! frames. By then its pipelines have been asked for, and whether any are still compiled is known.

use bevy_ecs::change_detection::{DetectChanges, Ref};
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::Query;
use bevy_mesh::Mesh3d;

/// Frames for which an entity must have been drawn, in the view and since its mesh or material
/// changed. One for assets that are added after their events were sent, two until the main world
/// knows which pipelines are compiled.
pub(crate) const SETTLED: u8 = 3;

/// Frames after which what is unused is forgotten.
const FORGET: u32 = 600;

/// The state of Bevy's pipelines.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct Pipelines {
    /// Whether some are being compiled: what they draw is not drawn yet.
    pub(crate) waiting: bool,
}

#[cfg(feature = "bevy_pbr")]
type Material = Option<Ref<'static, bevy_pbr::MeshMaterial3d<bevy_pbr::StandardMaterial>>>;
#[cfg(not(feature = "bevy_pbr"))]
type Material = ();

/// Meshes and materials of entities.
pub(crate) type Looks<'w, 's> = Query<'w, 's, (Option<Ref<'static, Mesh3d>>, Material)>;

/// When an entity got its mesh and its material, as change ticks.
type Look = (u32, u32);

fn look(looks: &Looks<'_, '_>, entity: Entity) -> Look {
    let Ok((mesh, material)) = looks.get(entity) else {
        return (0, 0);
    };
    #[cfg(feature = "bevy_pbr")]
    let material = material.map_or(0, |material| material.last_changed().get());
    #[cfg(not(feature = "bevy_pbr"))]
    let material = {
        let () = material;
        0
    };
    (mesh.map_or(0, |mesh| mesh.last_changed().get()), material)
}

/// For how long a view has listed its entities.
#[derive(Default)]
pub(crate) struct Listed {
    entities: EntityHashMap<Record>,
    frame: u32,
    after_sweep: usize,
}

#[derive(Clone, Copy)]
struct Record {
    look: Look,
    /// Earlier frames in which the entity was listed, up to `SETTLED`.
    frames: u8,
    /// The last one.
    frame: u32,
}

impl Listed {
    /// Takes in the lists of a new frame.
    pub(crate) fn note<'a>(
        &mut self,
        lists: impl IntoIterator<Item = &'a Vec<Entity>>,
        looks: &Looks<'_, '_>,
    ) {
        self.frame = self.frame.wrapping_add(1);
        let frame = self.frame;
        for &entity in lists.into_iter().flatten() {
            let look = look(looks, entity);
            let new = Record {
                look,
                frames: 0,
                frame,
            };
            let record = self.entities.entry(entity).or_insert(new);
            if record.look != look {
                *record = new;
            } else if record.frame != frame {
                record.frames = (record.frames + 1).min(SETTLED);
                record.frame = frame;
            }
        }
        if self.entities.len() > 1024 + 2 * self.after_sweep {
            self.entities
                .retain(|_, record| frame.wrapping_sub(record.frame) < FORGET);
            self.after_sweep = self.entities.len();
        }
    }

    /// Whether the entity is listed now, and has been for long enough.
    pub(crate) fn settled(&self, entity: Entity) -> bool {
        self.entities
            .get(&entity)
            .is_some_and(|record| record.frame == self.frame && record.frames >= SETTLED)
    }
}

/// The lists of all views.
#[derive(Default)]
pub(crate) struct ListedByView {
    views: EntityHashMap<(Listed, u32)>,
    frame: u32,
}

impl ListedByView {
    pub(crate) fn begin_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        let frame = self.frame;
        self.views
            .retain(|_, (_, used)| frame.wrapping_sub(*used) < FORGET);
    }

    pub(crate) fn of(&mut self, view: Entity) -> &mut Listed {
        let (listed, used) = self.views.entry(view).or_default();
        *used = self.frame;
        listed
    }
}

/// Tells the main world, in every frame, whether pipelines were waiting at the end of the last one.
#[cfg(feature = "bevy_pbr")]
pub(crate) fn watch_pipelines(app: &mut bevy_app::App) {
    use bevy_ecs::change_detection::{Res, ResMut};
    use bevy_render::render_resource::{PipelineCache, PipelineDescriptor};
    use bevy_render::renderer::RenderDevice;
    use bevy_render::{ExtractSchedule, MainWorld, RenderApp};

    /// Whether anything waits for a pipeline. Without compute shaders (WebGL 2) those that Bevy asks for
    /// all the same wait for ever, and draw nothing.
    fn is_waiting(cache: &PipelineCache, device: Option<&RenderDevice>) -> bool {
        let computes = device.is_none_or(|d| d.limits().max_compute_workgroups_per_dimension > 0);
        let draws = |id| {
            let pipeline = cache.pipelines().nth(id).map(|p| &p.descriptor);
            let is_compute = |p| matches!(p, &PipelineDescriptor::ComputePipelineDescriptor(_));
            !pipeline.is_some_and(is_compute)
        };
        cache.waiting_pipelines().any(|id| computes || draws(id))
    }

    fn extract(
        mut main: ResMut<MainWorld>,
        cache: Option<Res<PipelineCache>>,
        device: Option<Res<RenderDevice>>,
    ) {
        let waiting = cache.is_some_and(|cache| is_waiting(&cache, device.as_deref()));
        main.insert_resource(Pipelines { waiting });
    }
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        render.add_systems(ExtractSchedule, extract);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_asset::Handle;
    use bevy_ecs::system::SystemState;
    use bevy_ecs::world::World;

    #[test]
    fn entities_settle_while_they_are_listed_and_start_again_with_another_mesh() {
        let mut world = World::new();
        let [a, b] = [(); 2].map(|()| world.spawn(Mesh3d(Handle::default())).id());
        let mut listed = Listed::default();
        let mut note = |world: &mut World, list: Vec<Entity>| {
            let mut state = SystemState::<Looks>::new(world);
            // Two faces of a light list it: one frame all the same.
            listed.note([&list, &list], &state.get(world).unwrap());
            [a, b].map(|entity| listed.settled(entity))
        };
        for _ in 0..SETTLED {
            assert_eq!(note(&mut world, vec![a, b]), [false, false]);
        }
        assert_eq!(note(&mut world, vec![a]), [true, false], "b is not listed");
        assert_eq!(note(&mut world, vec![a, b]), [true, true]);
        world.increment_change_tick();
        world.entity_mut(a).insert(Mesh3d(Handle::default()));
        for _ in 0..SETTLED {
            assert_eq!(note(&mut world, vec![a, b]), [false, true]);
        }
        assert_eq!(note(&mut world, vec![a, b]), [true, true]);
    }
}
