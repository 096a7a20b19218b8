//! Cameras: hidden meshes leave `VisibleEntities`.

use crate::components::CpuOcclusionCulling;
use crate::cull::{Boxes, Outcome, ViewCuller};
use crate::occluders::{Occluders, Range};
use crate::ready::{ListedByView, Looks, Pipelines};
use crate::stats::CpuOcclusionStats;
use crate::tasks::ComputeTasks;
use crate::view::{Fit, NearSpace, ObliquePlanes, clip_from_world};
use bevy_camera::Camera;
use bevy_camera::visibility::{RenderLayers, VisibleEntities, VisibleEntityRanges};
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Local, Query};
use bevy_mesh::Mesh3d;
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use core::any::TypeId;

#[cfg(feature = "bevy_pbr")]
type Multisampling = Option<&'static bevy_render::view::Msaa>;
/// Unknown without Bevy's renderer.
#[cfg(not(feature = "bevy_pbr"))]
type Multisampling = ();

#[cfg(feature = "bevy_pbr")]
fn samples(multisampling: Option<&bevy_render::view::Msaa>) -> u32 {
    multisampling.copied().unwrap_or_default().samples()
}

/// Bevy's default.
#[cfg(not(feature = "bevy_pbr"))]
fn samples((): ()) -> u32 {
    4
}

/// The cullers of cameras, which keep their buffers until the next frame.
#[derive(Resource, Default)]
pub(crate) struct CameraCullers(EntityHashMap<ViewCuller>);

impl CameraCullers {
    /// The culler of a camera that was culled in this frame.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn current(&self, camera: Entity) -> Option<&ViewCuller> {
        self.0.get(&camera).filter(|culler| culler.is_current())
    }

    /// All of these.
    #[cfg(feature = "overlay")]
    pub(crate) fn all(&self) -> impl Iterator<Item = (Entity, &ViewCuller)> {
        let all = self.0.iter().map(|(camera, culler)| (*camera, culler));
        all.filter(|(_, culler)| culler.is_current())
    }
}

pub(crate) fn cull(
    mut occluders: ResMut<Occluders>,
    mut stats: ResMut<CpuOcclusionStats>,
    mut cullers: ResMut<CameraCullers>,
    mut listed: Local<ListedByView>,
    boxes: Boxes,
    looks: Looks,
    pipelines: Res<Pipelines>,
    ranges: Option<Res<VisibleEntityRanges>>,
    mut cameras: Query<(
        Entity,
        &Camera,
        &GlobalTransform,
        &CpuOcclusionCulling,
        &mut VisibleEntities,
        Option<&RenderLayers>,
        Multisampling,
    )>,
) {
    let begin = Instant::now();
    let cullers = &mut cullers.0;
    cullers.retain(|camera, _| cameras.contains(*camera));
    cullers.values_mut().for_each(ViewCuller::forget);
    listed.begin_frame();
    for (entity, camera, transform, culling, mut visible, layers, multisampling) in &mut cameras {
        let picture = camera.physical_viewport_size();
        let Some(picture) = picture.filter(|_| camera.is_active) else {
            continue;
        };
        let Some(fit) = Fit::new(culling.buffer_size, picture, samples(multisampling)) else {
            continue;
        };
        let list = visible.get_mut(TypeId::of::<Mesh3d>());
        let listed = listed.of(entity);
        listed.note([&*list], &looks);
        let matrix = clip_from_world(camera.clip_from_view(), transform.affine());
        // What oblique planes cut does not occlude: it is drawn in part.
        let (oblique, matrix) = match ObliquePlanes::take_from(matrix) {
            Some((planes, matrix)) => (Some(planes), matrix),
            None => (None, matrix),
        };
        let near = NearSpace::of(matrix);
        let layers = layers.unwrap_or_default();
        let on = occluders.enable(|occluder, entry| {
            layers.intersects(&entry.layers)
                && (!entry.listed || listed.settled(occluder))
                && !(entry.not_inverted && camera.invert_culling)
                && oblique.is_none_or(|planes| planes.spare(&entry.bounds))
                && entry.is_closed(&near)
                && match entry.range {
                    Range::None => true,
                    Range::Abrupt => ranges
                        .as_ref()
                        .is_some_and(|r| r.entity_is_in_range_of_view(occluder, entity)),
                    Range::Fading => false,
                }
        });
        let mut outcome = Outcome {
            listed: list.len(),
            coarse: fit.coarse,
            ..Outcome::default()
        };
        // Faces are told by their winding in the world: a pose or a projection that mirrors needs
        // the opposite test.
        let mirrors = matrix.determinant() < 0.0;
        if mirrors != camera.invert_culling {
            outcome.refused = true;
        } else if pipelines.waiting {
            outcome.waiting = true;
        } else if on > 0 {
            if let Some(culler) = of_size(cullers, entity, fit.size) {
                let culled =
                    culler.cull(list, &boxes, listed, &occluders.set, &ComputeTasks, |_| {
                        fit.view(matrix)
                    });
                outcome = Outcome {
                    coarse: fit.coarse,
                    ..culled
                };
            } else {
                outcome.refused = true;
            }
        }
        outcome.add_to(&mut stats, false);
    }
    stats.camera_time = begin.elapsed();
}

/// The camera's culler, made anew where the size of its buffer has changed.
fn of_size(
    cullers: &mut EntityHashMap<ViewCuller>,
    camera: Entity,
    size: (u32, u32),
) -> Option<&mut ViewCuller> {
    if cullers.get(&camera).is_none_or(|c| c.size() != size) {
        cullers.insert(camera, ViewCuller::new(size).ok()?);
    }
    cullers.get_mut(&camera)
}
