//! What is culled and what hides it: a scene's boxes and its occluders.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use foveal_cull::{BakeOptions, OccludeeTree, OccluderId, OccluderMesh, OccluderSet};
use foveal_scene::{Aabb, Instance, Scene};
use glam::{DAffine3, DVec3, Mat4, Vec3};
use rayon::prelude::*;

use super::cells::Cells;
use crate::Settings;

/// A scene's occluders and boxes.
#[derive(Debug, Default)]
pub(crate) struct CullingScene {
    pub(super) occluders: OccluderSet,
    placed: Vec<Placed>,
    /// Where in `placed` each instance is that occludes.
    placed_of: HashMap<u32, usize>,
    pub(super) boxes: Vec<foveal_cull::Aabb>,
    /// Objects that are not drawn in this pose, whatever is seen of them.
    hidden: Vec<bool>,
    /// Per object.
    pub(super) triangles: Vec<u32>,
    /// Over the boxes.
    pub(super) objects: OccludeeTree,
    /// What may receive shadows; `None` without occlusion culling or shadows.
    pub(super) cells: Option<Cells>,
    /// No other scene, and no other pose, has this number.
    pub(super) pose: u64,
}

/// An instance that occludes.
#[derive(Debug)]
struct Placed {
    id: OccluderId,
    instance: u32,
    mesh: Arc<OccluderMesh>,
    world_from_mesh: DAffine3,
}

fn new_pose() -> u64 {
    static POSES: AtomicU64 = AtomicU64::new(1);
    POSES.fetch_add(1, Ordering::Relaxed)
}

impl CullingScene {
    /// A scene's boxes and, for occlusion culling, its occluders: the opaque instances of the
    /// objects that are marked as occluders, or of all objects where none is marked; with shadows,
    /// what may receive them too.
    pub(crate) fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut this = Self {
            pose: new_pose(),
            ..Self::default()
        };
        if settings.culling.mode.has_occluders() {
            this.bake(scene);
        }
        if settings.finds_receivers() {
            this.cells = Cells::new(scene);
        }
        this.take_boxes(scene);
        this.triangles = vec![0; scene.objects.len()];
        for instance in &scene.instances {
            let triangles = scene.meshes[instance.mesh as usize].triangle_count() as u32;
            if let Some(sum) = this.triangles.get_mut(instance.object as usize) {
                *sum = sum.saturating_add(triangles);
            }
        }
        this.objects = OccludeeTree::build(&this.boxes, DVec3::ZERO);
        this
    }

    fn bake(&mut self, scene: &Scene) {
        let marked = scene.marks_occluders();
        let occludes = |instance: &Instance| {
            let wanted = !marked || scene.objects[instance.object as usize].occluder == Some(true);
            wanted && scene.can_occlude(instance)
        };
        let shape = |instance: &Instance| {
            let material = &scene.materials[instance.material as usize];
            (instance.mesh, material.double_sided)
        };
        let occluding = scene.instances.iter().filter(|i| occludes(i));
        let shapes: BTreeSet<(u32, bool)> = occluding.map(shape).collect();
        // A mesh that cannot be baked only hides nothing.
        let baked: HashMap<(u32, bool), Arc<OccluderMesh>> = (shapes.into_par_iter())
            .filter_map(|shape| Some((shape, Arc::new(bake(scene, shape)?))))
            .collect();
        for (index, instance) in (0..).zip(&scene.instances) {
            let world_from_mesh = affine(instance.world_from_object);
            if occludes(instance)
                && let Some(mesh) = baked.get(&shape(instance))
                && let Ok(id) = self.occluders.add(Arc::clone(mesh), world_from_mesh)
            {
                let _ = self.occluders.set_enabled(id, scene.is_visible(instance));
                self.placed_of.insert(index, self.placed.len());
                self.placed.push(Placed {
                    id,
                    instance: index,
                    mesh: Arc::clone(mesh),
                    world_from_mesh,
                });
            }
        }
    }

    /// Takes over a new pose of the same scene.
    pub(crate) fn update_pose(&mut self, scene: &Scene) {
        self.pose = new_pose();
        for placed in &mut self.placed {
            let instance = &scene.instances[placed.instance as usize];
            placed.world_from_mesh = affine(instance.world_from_object);
            let moved = (self.occluders).set_transform(placed.id, placed.world_from_mesh);
            // A transform that is no transform: better no occluder than a wrong one.
            let is_there = moved.is_ok() && scene.is_visible(instance);
            let _ = self.occluders.set_enabled(placed.id, is_there);
        }
        self.take_boxes(scene);
        if self.objects.refit(&self.boxes).is_err() {
            self.objects = OccludeeTree::build(&self.boxes, DVec3::ZERO);
        }
    }

    /// Brings the cells that may receive shadows to the pose, where they are not: `instances` gives
    /// the boxes and places of all instances.
    pub(crate) fn place_cells(&mut self, instances: impl Iterator<Item = (Aabb, Mat4)>) {
        if let Some(cells) = &mut self.cells {
            cells.place(self.pose, instances);
        }
    }

    /// Whether an object is drawn in this pose where it is seen.
    pub(super) fn is_shown(&self, object: u32) -> bool {
        self.hidden
            .get(object as usize)
            .is_none_or(|hidden| !hidden)
    }

    /// The objects that are not drawn in this pose.
    pub(crate) fn hidden_objects(&self) -> impl Iterator<Item = u32> {
        (0..)
            .zip(&self.hidden)
            .filter(|(_, hidden)| **hidden)
            .map(|(object, _)| object)
    }

    /// The boxes of these cells, world space; none before they are placed.
    pub(crate) fn cells(&self) -> &[Aabb] {
        self.cells.as_ref().map_or(&[], Cells::boxes)
    }

    /// Those of some instances that occlude, as a set of their own.
    pub(crate) fn occluders_of(&self, instances: &[u32]) -> OccluderSet {
        let mut set = OccluderSet::new();
        let placed = instances.iter().filter_map(|i| self.placed_of.get(i));
        for placed in placed.map(|&number| &self.placed[number]) {
            // One without a place occludes nothing.
            let _ = set.add(Arc::clone(&placed.mesh), placed.world_from_mesh);
        }
        set
    }

    fn take_boxes(&mut self, scene: &Scene) {
        self.boxes.clear();
        let boxes = scene.objects.iter().map(|o| o.bounds);
        let boxes = boxes.map(|b| foveal_cull::Aabb::new(b.min, b.max));
        self.boxes.extend(boxes);
        self.hidden.clear();
        self.hidden.extend(scene.objects.iter().map(|o| !o.visible));
    }
}

/// The occluder that a mesh is, seen from one side or both.
fn bake(scene: &Scene, (mesh, two_sided): (u32, bool)) -> Option<OccluderMesh> {
    let mesh = &scene.meshes[mesh as usize];
    let positions: Vec<Vec3> = mesh.vertices.iter().map(|v| v.position.into()).collect();
    let options = BakeOptions::default().with_two_sided(two_sided);
    OccluderMesh::bake(&positions, &mesh.indices, options).ok()
}

pub(crate) fn affine(m: Mat4) -> DAffine3 {
    DAffine3::from_mat4(m.as_dmat4())
}
