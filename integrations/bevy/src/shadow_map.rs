//! Shadow maps of a light: casters that change nothing that is seen leave their lists.

use crate::cull::{Boxes, Outcome, ViewCuller};
use crate::mask::Projector;
use crate::occluders::Occluders;
use crate::reach::{SeenByLight, SeenOnMap};
use crate::ready::Listed;
use crate::tasks::for_each;
use crate::view::Fit;
use bevy_camera::visibility::VisibleMeshEntities;
use bevy_ecs::entity::Entity;
use bevy_math::{DMat4, DVec3};
use bevy_platform::collections::HashMap;
use foveal_cull::{Aabb, SingleThread};

/// So many casters, of those that may leave a list, are drawn sooner than tested.
const FEW: usize = 4;

/// Cullers by the size of their buffers.
#[derive(Default)]
pub(crate) struct Cullers(HashMap<(u32, u32), OfSize>);

#[derive(Default)]
struct OfSize {
    cullers: Vec<ViewCuller>,
    /// Frames since the last use.
    idle: u32,
}

impl Cullers {
    /// Forgets what has long been unused.
    pub(crate) fn begin_frame(&mut self) {
        self.0.retain(|_, of_size| {
            of_size.idle += 1;
            of_size.idle < 120
        });
    }

    /// So many cullers of a size; fewer where there cannot be any.
    pub(crate) fn of(&mut self, size: (u32, u32), count: usize) -> &mut [ViewCuller] {
        let of_size = self.0.entry(size).or_default();
        of_size.idle = 0;
        while of_size.cullers.len() < count {
            match ViewCuller::new(size) {
                Ok(culler) => of_size.cullers.push(culler),
                Err(_) => break,
            }
        }
        &mut of_size.cullers
    }
}

/// A shadow map of a light.
pub(crate) struct Face<'a> {
    pub(crate) clip_from_world: DMat4,
    /// Casters before the near plane are drawn onto it.
    pub(crate) casters_before_near: bool,
    pub(crate) list: &'a mut Vec<Entity>,
    pub(crate) outcome: Outcome,
    /// Whether the light may light something that a camera sees here.
    pub(crate) lights_seen: bool,
}

impl<'a> Face<'a> {
    pub(crate) fn new(clip_from_world: DMat4, casters: &'a mut VisibleMeshEntities) -> Self {
        Self {
            clip_from_world,
            casters_before_near: false,
            list: &mut casters.entities,
            outcome: Outcome::default(),
            lights_seen: true,
        }
    }
}

/// What the shadow maps of a light have in common.
pub(crate) struct Faces<'w, 's, 'a> {
    pub(crate) fit: &'a Fit,
    pub(crate) boxes: &'a Boxes<'w, 's>,
    pub(crate) listed: &'a Listed,
    /// Those that are switched on, and whether a view draws them only if it lists them.
    pub(crate) occluders: Option<(&'a Occluders, bool)>,
    /// `None` where all shadows are drawn.
    pub(crate) seen: Option<&'a SeenByLight>,
}

/// A shadow map that is being culled.
struct Work<'a, 'f> {
    face: &'a mut Face<'f>,
    culler: &'a mut ViewCuller,
    seen: Option<SeenOnMap>,
}

impl Faces<'_, '_, '_> {
    /// Culls the shadow maps, each with a culler of its own.
    pub(crate) fn cull(&self, faces: &mut [Face<'_>], cullers: &mut [ViewCuller]) {
        refuse_from(cullers.len(), faces);
        let with_cullers = faces.iter_mut().zip(cullers);
        let mut work: Vec<_> = with_cullers
            .map(|(face, culler)| Work {
                face,
                culler,
                seen: None,
            })
            .collect();
        for_each(work.iter_mut(), |work| self.leave_out_unseen(work));
        let has_few = |work: &Work<'_, '_>| work.culler.removable() <= FEW;
        work.sort_by_key(has_few);
        let first_of_few = work.partition_point(|work| !has_few(work));
        let (many, few) = work.split_at_mut(first_of_few);
        for_each(many.iter_mut(), |work| self.test(work, true));
        // A test of few casters pays only where it may tell that the light lights nothing, or where no
        // face has more.
        let lit = many.iter().any(|work| work.face.lights_seen);
        for_each(few.iter_mut(), |work| self.test(work, !lit));
    }

    /// Removes casters whose shadow falls on nothing that is seen, whether it is lit or not.
    fn leave_out_unseen(&self, work: &mut Work<'_, '_>) {
        let Work { face, culler, seen } = work;
        let projector = Projector::new(face.clip_from_world);
        *seen = self.seen.map(|seen| seen.on_map(projector));
        face.outcome.unseen = culler.take(face.list, self.boxes, self.listed, |bounds| {
            seen.as_ref().is_none_or(|seen| seen.may_show(bounds))
        });
    }

    /// Removes casters that are hidden, if `by_occluders`, and those whose shadow then falls on nothing
    /// that is seen.
    fn test(&self, work: &mut Work<'_, '_>, by_occluders: bool) {
        let Work { face, culler, seen } = work;
        let sees_nothing = seen.as_ref().is_some_and(SeenOnMap::is_nothing);
        if let Some((occluders, _)) = self.occluders.filter(|_| by_occluders && !sees_nothing) {
            let matrix = face.clip_from_world;
            face.outcome.refused = !culler.test(&occluders.set, &SingleThread, |casters| {
                self.fit.view(if face.casters_before_near {
                    with_near_before(matrix, casters)
                } else {
                    matrix
                })
            });
        }
        let mut unseen = 0;
        if let Some(seen) = seen.as_mut().filter(|_| !face.outcome.refused) {
            let lit = seen.light(|boxes, results| {
                // What is drawn in place of other occluders may be left out.
                if self.occluders.is_some_and(|(_, all_listed)| all_listed) {
                    culler.look(boxes, results);
                }
            });
            // What is new must be drawn for a while, and the light with it.
            let settled = |&entity: &Entity| self.listed.settled(entity);
            face.lights_seen = lit || !face.list.iter().all(settled);
            unseen = culler.keep(face.list, |entity, bounds| {
                let occludes = self.occluders.is_some_and(|(o, _)| o.is_on(entity));
                seen.shows(bounds, occludes)
            });
        }
        face.outcome.hidden = culler.remove(face.list) - unseen;
        face.outcome.unseen += unseen;
    }
}

/// Faces for which there is no culler keep everything.
fn refuse_from(first: usize, faces: &mut [Face<'_>]) {
    for face in faces.iter_mut().skip(first) {
        face.outcome.refused = true;
    }
}

/// An orthographic matrix of reversed depth whose near plane lies before all casters.
fn with_near_before(clip_from_world: DMat4, casters: &[Aabb]) -> DMat4 {
    let depth = clip_from_world.row(2);
    let (along, offset) = (depth.truncate(), depth.w);
    let nearest = casters
        .iter()
        .filter(|bounds| bounds.is_valid())
        .map(|bounds| {
            let (min, max) = (bounds.min.map(f64::from), bounds.max.map(f64::from));
            let (min, max) = (DVec3::from(min), DVec3::from(max));
            along.dot((min + max) * 0.5) + along.abs().dot((max - min) * 0.5) + offset
        })
        .fold(1.0, f64::max);
    // Depth 1 moves there, and 0, the far plane, stays.
    let scale = 1.0 / (nearest * 1.001);
    DMat4::from_cols(
        bevy_math::DVec4::X,
        bevy_math::DVec4::Y,
        bevy_math::DVec4::Z * scale,
        bevy_math::DVec4::W,
    ) * clip_from_world
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::OcclusionBufferSize;
    use bevy_math::{DVec4, Mat4, Vec3};

    #[test]
    fn cullers_that_cannot_be_made_are_refused_views_and_unused_ones_are_forgotten() {
        let mut cullers = Cullers::default();
        assert_eq!(cullers.of((16, 16), 6).len(), 6);
        assert_eq!(cullers.of((0, 16), 1).len(), 0);
        let mut lists = [(); 2].map(|()| VisibleMeshEntities::default());
        let mut faces: Vec<Face> = lists
            .iter_mut()
            .map(|list| Face::new(DMat4::IDENTITY, list))
            .collect();
        refuse_from(1, &mut faces);
        let refused = |face: &Face| face.outcome.refused;
        assert!(!refused(&faces[0]) && refused(&faces[1]));
        for _ in 0..200 {
            cullers.begin_frame();
            cullers.of((16, 16), 1);
        }
        assert!(cullers.0.contains_key(&(16, 16)) && !cullers.0.contains_key(&(0, 16)));
    }

    #[test]
    fn the_near_plane_of_a_cascade_moves_before_its_casters() {
        // 20 m wide, from z = 0 down to -100, with reversed depth.
        let clip = Mat4::orthographic_rh(-10.0, 10.0, -10.0, 10.0, 100.0, 0.0).as_dmat4();
        let depth = |m: DMat4, z: f64| (m * DVec4::new(0.0, 0.0, z, 1.0)).z;
        assert!((depth(clip, 0.0) - 1.0).abs() < 1e-6 && depth(clip, -100.0).abs() < 1e-6);
        let casters = [
            Aabb::new(Vec3::splat(-1.0), Vec3::new(1.0, 1.0, 50.0)),
            Aabb::EMPTY,
        ];
        let moved = with_near_before(clip, &casters);
        assert!(depth(moved, 50.0) < 1.0 && depth(moved, 51.0) > 1.0);
        assert!(depth(moved, -100.0).abs() < 1e-6);
        let fit = Fit::of_shadow_map(OcclusionBufferSize::Exact, 1024).unwrap();
        assert!(fit.view(moved).unwrap().eye.projection.is_orthographic());
        // Nothing before it: it stays.
        let behind = [Aabb::new(Vec3::splat(-50.0), Vec3::splat(-40.0))];
        assert!((depth(with_near_before(clip, &behind), 0.0) - 1.0).abs() < 2e-3);
    }
}
