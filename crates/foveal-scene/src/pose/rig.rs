//! The rig of a scene and how it poses it.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use glam::{Mat4, Vec4};

use super::deform::MIRROR;
use super::properties::{finish_light, is_usable, set_light, set_projection};
use super::{Animation, Channel, Clip, Deformer, Local, MaterialState, Skin, Target};
use crate::cloud::Cloud;
use crate::{Aabb, Light, Projection, Scene, Vertex, gltf, threads};

/// How a scene moves: node hierarchy, animations, skins, morph targets. Opaque; the default does
/// not move.
#[derive(Clone, Debug, Default)]
pub struct Rig {
    pub(crate) data: Option<Arc<RigData>>,
    /// Which of its animations play.
    pub(crate) played: Range<usize>,
    /// The box around what the file shows before anything plays, without skinned meshes, whose joints
    /// place them.
    pub(crate) at_rest: Aabb,
}

/// Part of its size at rest by which a scene is next to nothing.
const NEXT_TO_NOTHING: f32 = 0.01;

/// A node at rest.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) parent: Option<u32>,
    pub(crate) local: Local,
    /// Morph weights, as many as its mesh has targets.
    pub(crate) weights: Vec<f32>,
}

/// An object that moves or deforms.
#[derive(Clone, Debug)]
pub(crate) struct Binding {
    pub(crate) object: u32,
    pub(crate) node: u32,
    /// Transform of its EXT_mesh_gpu_instancing element.
    pub(crate) element: Mat4,
}

/// Everything a rig knows.
#[derive(Clone, Debug, Default)]
pub(crate) struct RigData {
    pub(crate) nodes: Vec<Node>,
    /// Parents first.
    pub(crate) order: Vec<u32>,
    pub(crate) animations: Vec<Animation>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) deformers: Vec<Deformer>,
    /// Meshes whose vertices are in world space already: their nodes' transforms do not apply.
    pub(crate) skinned: HashSet<u32>,
    pub(crate) bindings: Vec<Binding>,
    /// (camera, node).
    pub(crate) cameras: Vec<(u32, u32)>,
    /// (light, node).
    pub(crate) lights: Vec<(u32, u32)>,
    /// Cameras whose projection changes: number in the scene, and in the file.
    pub(crate) zooming: Vec<(u32, u32)>,
    /// Their projections at rest, by number in the file.
    pub(crate) projections: BTreeMap<u32, Projection>,
    /// Lights that change or may be hidden: number in the scene, and in the file.
    pub(crate) shining: Vec<(u32, u32)>,
    /// The lights at rest, by number in the file; their places mean nothing.
    pub(crate) emission: BTreeMap<u32, Light>,
    /// Materials that change, at rest, by their number.
    pub(crate) materials: BTreeMap<u32, MaterialState>,
    /// Of some of them, by their number: a copy that differs in that its tangents do not turn.
    pub(crate) copies: HashMap<u32, u32>,
    /// Of each node whether it is visible at rest, itself; `None` where that never changes.
    pub(crate) visible: Option<Vec<bool>>,
    /// Bounding points of rigid meshes that move, by mesh.
    pub(crate) clouds: HashMap<u32, Arc<Cloud>>,
    pub(crate) parallel: bool,
}

/// World transforms of all nodes, from their local ones.
pub(crate) fn world_from_nodes(
    parent: impl Fn(usize) -> Option<u32>,
    order: &[u32],
    locals: &[Local],
) -> Vec<Mat4> {
    let mut world = vec![Mat4::IDENTITY; locals.len()];
    for &i in order {
        let i = i as usize;
        let local = locals[i].matrix();
        world[i] = match parent(i) {
            Some(p) => world[p as usize] * local,
            None => local,
        };
    }
    world
}

impl RigData {
    /// Whether any animation moves anything.
    pub(crate) fn plays(&self) -> bool {
        self.animations.iter().any(|a| !a.channels.is_empty())
    }

    /// The channels that play, each with its animation's own time.
    fn channels(&self, played: Range<usize>, time_s: f32) -> impl Iterator<Item = (&Channel, f32)> {
        let played = self.animations.get(played).unwrap_or_default().iter();
        played.flat_map(move |animation| {
            let time = animation.looped(time_s);
            animation
                .channels
                .iter()
                .map(move |channel| (channel, time))
        })
    }

    /// Local transforms and morph weights at a time of the animations that play.
    fn sample(&self, played: Range<usize>, time_s: f32) -> (Vec<Local>, HashMap<u32, Vec<f32>>) {
        let mut locals: Vec<Local> = self.nodes.iter().map(|n| n.local).collect();
        let mut weights: HashMap<u32, Vec<f32>> = HashMap::new();
        for (channel, time) in self.channels(played, time_s) {
            let target = channel.target;
            if target == Target::Weights {
                let mut list = vec![0.0; channel.width];
                channel.sample(time, &mut list);
                weights.insert(channel.number, list);
                continue;
            }
            let (Some(value), Some(local)) = (
                channel
                    .at(time)
                    .filter(|_| target.is_transform() || target.is_weight()),
                locals.get_mut(channel.number as usize),
            ) else {
                continue;
            };
            let [x, y, z, _] = value;
            match (target, local) {
                (Target::Weight(number), _) => {
                    let at_rest = || self.nodes[channel.number as usize].weights.clone();
                    let list = weights.entry(channel.number).or_insert_with(at_rest);
                    list.iter_mut()
                        .skip(number as usize)
                        .take(1)
                        .for_each(|w| *w = x);
                }
                (Target::Translation, Local::Trs { translation, .. }) => {
                    *translation = [x, y, z].into();
                }
                (Target::Scale, Local::Trs { scale, .. }) => *scale = [x, y, z].into(),
                (Target::Rotation, Local::Trs { rotation, .. }) => {
                    *rotation = gltf::rotation(value)
                }
                (Target::Translation, Local::Matrix(matrix)) => {
                    matrix.w_axis = Vec4::new(x, y, z, 1.0);
                }
                _ => {}
            }
        }
        (locals, weights)
    }

    fn pose(&self, scene: &mut Scene, time_s: f32) {
        let (locals, weights) = self.sample(scene.rig.played.clone(), time_s);
        let world = world_from_nodes(|i| self.nodes[i].parent, &self.order, &locals);
        let mirrored = self.deform(scene, &world, &weights);
        self.place_objects(scene, &world, &mirrored);
        for &(camera, node) in &self.cameras {
            if let Some(camera) = scene.cameras.get_mut(camera as usize) {
                camera.world_from_view = gltf::rigid(world[node as usize]);
            }
        }
        for &(light, node) in &self.lights {
            if let Some(light) = scene.lights.get_mut(light as usize) {
                gltf::place_light(light, world[node as usize]);
            }
        }
        self.change(scene, time_s);
    }

    /// Changes materials, lights, projections of cameras, and what is visible.
    fn change(&self, scene: &mut Scene, time_s: f32) {
        let mut materials = self.materials.clone();
        let mut emission = self.emission.clone();
        let mut projections = self.projections.clone();
        let mut visible = self.visible.clone();
        for (channel, time) in self.channels(scene.rig.played.clone(), time_s) {
            let target = channel.target;
            if target.is_transform() || target.is_weight() {
                continue;
            }
            let Some(value) = channel.at(time) else {
                continue;
            };
            match target {
                Target::Material(part) => {
                    if let Some(state) = materials.get_mut(&channel.number) {
                        state.set(part, value);
                    }
                }
                Target::Light(part) => {
                    if let Some(light) = emission.get_mut(&channel.number) {
                        set_light(light, part, value);
                    }
                }
                Target::Camera(part) => {
                    if let Some(projection) = projections.get_mut(&channel.number) {
                        set_projection(projection, part, value[0]);
                    }
                }
                Target::Visible => {
                    let of_it = visible.as_mut();
                    let of_it = of_it.and_then(|v| v.get_mut(channel.number as usize));
                    of_it.into_iter().for_each(|v| *v = value[0] != 0.0);
                }
                _ => {}
            }
        }
        for (number, state) in materials {
            let copy = self.copies.get(&number).map(|copy| {
                let tangents = None;
                (
                    *copy,
                    MaterialState {
                        tangents,
                        ..state.clone()
                    },
                )
            });
            for (number, state) in copy.into_iter().chain([(number, state)]) {
                if let Some(material) = scene.materials.get_mut(number as usize) {
                    let name = std::mem::take(&mut material.name);
                    *material = state.finish();
                    material.name = name;
                }
            }
        }
        emission.values_mut().for_each(finish_light);
        for (number, in_file) in &self.shining {
            if let (Some(light), Some(now)) = (
                scene.lights.get_mut(*number as usize),
                emission.get(in_file),
            ) {
                light.kind = now.kind;
                light.color = now.color;
                light.intensity = now.intensity;
                light.range_m = now.range_m;
            }
        }
        for (number, in_file) in &self.zooming {
            // What no picture can be drawn by stays as it is at rest.
            let now = projections.get(in_file).filter(|p| is_usable(p));
            if let (Some(camera), Some(now)) = (
                scene.cameras.get_mut(*number as usize),
                now.or_else(|| self.projections.get(in_file)),
            ) {
                camera.projection = *now;
            }
        }
        if let Some(own) = visible {
            let parent: Vec<Option<u32>> = self.nodes.iter().map(|n| n.parent).collect();
            let visible = gltf::all_the_way_up(&self.order, &parent, |i| own[i]);
            scene.show(&visible);
        }
    }

    /// Deforms the vertices of all deforming meshes; gives the meshes that their joints mirror.
    fn deform(
        &self,
        scene: &mut Scene,
        world: &[Mat4],
        weights: &HashMap<u32, Vec<f32>>,
    ) -> HashSet<u32> {
        let joints: Vec<Vec<Mat4>> = self
            .skins
            .iter()
            .map(|skin| {
                let joints = skin.joints.iter().zip(&skin.inverse_bind);
                joints.map(|(&j, bind)| world[j as usize] * *bind).collect()
            })
            .collect();
        let posed: Vec<(Vec<Vertex>, Aabb, bool)> =
            threads::map(self.parallel, &self.deformers, |deformer| {
                let mut vertices = deformer.shape.rest.clone();
                let weights = weights
                    .get(&deformer.node)
                    .unwrap_or(&self.nodes[deformer.node as usize].weights);
                let matrices = deformer.skin.map(|s| joints[s as usize].as_slice());
                let is_mirrored = deformer.shape.deform(weights, matrices, &mut vertices);
                let bounds = match scene.meshes.get(deformer.mesh as usize) {
                    Some(mesh) => mesh.bounds_of(&vertices),
                    None => Aabb::EMPTY,
                };
                (vertices, bounds, is_mirrored)
            });
        let mut mirrored = HashSet::new();
        for (deformer, (vertices, bounds, is_mirrored)) in self.deformers.iter().zip(posed) {
            if is_mirrored {
                mirrored.insert(deformer.mesh);
            }
            if let Some(mesh) = scene.meshes.get_mut(deformer.mesh as usize) {
                mesh.vertices = vertices;
                mesh.bounds = bounds;
            }
        }
        mirrored
    }

    /// Places the instances of all objects that move. The vertices of `mirrored` meshes are in
    /// [`MIRROR`]'s image of world space.
    fn place_objects(&self, scene: &mut Scene, world: &[Mat4], mirrored: &HashSet<u32>) {
        let shown: &Scene = scene;
        let placed = threads::map(self.parallel, &self.bindings, |binding| {
            let at_node = world[binding.node as usize] * binding.element;
            let instances = shown
                .objects
                .get(binding.object as usize)
                .map_or(0..0, |o| o.instances.clone());
            let of_instance = |i: u32| {
                let Some(instance) = shown.instances.get(i as usize) else {
                    return (at_node, Aabb::EMPTY);
                };
                let matrix = if self.skinned.contains(&instance.mesh) {
                    binding.element
                } else {
                    at_node
                };
                let matrix = if mirrored.contains(&instance.mesh) {
                    matrix * MIRROR
                } else {
                    matrix
                };
                let bounds = match (
                    self.clouds.get(&instance.mesh),
                    shown.meshes.get(instance.mesh as usize),
                ) {
                    (Some(cloud), _) => cloud.bounds(matrix),
                    (None, Some(mesh)) => Cloud::of(mesh, 1).bounds(matrix),
                    (None, None) => Aabb::EMPTY,
                };
                (matrix, bounds)
            };
            instances.map(of_instance).collect::<Vec<_>>()
        });
        for (binding, placed) in self.bindings.iter().zip(placed) {
            // Key frames may lead beyond the range of numbers; what goes there stays where it was.
            let finite = |(matrix, b): &(Mat4, Aabb)| {
                matrix.is_finite() && (b.is_empty() || (b.min.is_finite() && b.max.is_finite()))
            };
            if !placed.iter().all(finite) {
                continue;
            }
            let Some(object) = scene.objects.get_mut(binding.object as usize) else {
                continue;
            };
            object.bounds = placed.iter().fold(Aabb::EMPTY, |all, (_, b)| all.union(*b));
            for (i, (matrix, bounds)) in object.instances.clone().zip(placed) {
                if let Some(instance) = scene.instances.get_mut(i as usize) {
                    instance.world_from_object = matrix;
                    instance.bounds = bounds;
                }
            }
        }
    }
}

impl Scene {
    /// Shows the objects and lights of the nodes that are visible, and hides the others: a hidden
    /// light has no intensity.
    pub(crate) fn show(&mut self, visible: &[bool]) {
        for object in &mut self.objects {
            object.visible = visible.get(object.node as usize).is_none_or(|v| *v);
        }
        for light in &mut self.lights {
            let node = light.node.and_then(|node| visible.get(node as usize));
            if node.is_some_and(|visible| !visible) {
                light.intensity = 0.0;
            }
        }
    }

    /// Keeps where things are at rest, before the first pose.
    pub(crate) fn keep_rest(&mut self) {
        let Some(rig) = &self.rig.data else { return };
        let placed = self.instances.iter();
        let placed = placed.filter(|instance| !rig.skinned.contains(&instance.mesh));
        self.rig.at_rest = placed.fold(Aabb::EMPTY, |all, instance| all.union(instance.bounds));
    }

    /// The box to show as a whole: around all objects, and where they are next to nothing in this pose,
    /// as a clip may begin that makes things grow, around what is there at rest.
    pub(crate) fn overview_bounds(&self) -> Aabb {
        let (now, rest) = (self.bounds(), self.rig.at_rest);
        let size = |bounds: Aabb| bounds.size().length();
        if now.is_empty() || rest.is_empty() || size(now) > NEXT_TO_NOTHING * size(rest) {
            return now;
        }
        now.union(rest)
    }

    /// True when [`Scene::pose`] at different times gives different scenes.
    #[must_use]
    pub fn is_animated(&self) -> bool {
        self.animation_duration_s() > 0.0
    }

    /// Length in seconds of the clip that plays, or of the longest one where several do; 0 without
    /// any. Each one loops over its own length.
    #[must_use]
    pub fn animation_duration_s(&self) -> f32 {
        let played = self.animations().get(self.rig.played.clone());
        let lengths = played.unwrap_or_default().iter().map(|a| a.duration_s);
        lengths.fold(0.0, f32::max)
    }

    fn animations(&self) -> &[Animation] {
        self.rig.data.as_ref().map_or(&[], |rig| &rig.animations)
    }

    /// The name and length in seconds of each clip, in the file's order. Names may be empty or
    /// equal.
    pub fn clips(&self) -> impl ExactSizeIterator<Item = (&str, f32)> {
        let animations = self.animations().iter();
        animations.map(|a| (a.name.as_str(), a.duration_s))
    }

    /// The same clip by its number, or all of them; `None` if there is no such clip. A scene without
    /// clips has its first.
    #[must_use]
    pub fn find_clip(&self, clip: &Clip) -> Option<Clip> {
        let clips = self.animations();
        let number = match clip {
            Clip::All => return Some(Clip::All),
            Clip::Number(number) => *number,
            Clip::Named(name) => match clips.iter().position(|c| c.name == *name) {
                Some(number) => u32::try_from(number).ok()?,
                None => name.parse().ok()?,
            },
        };
        let count = clips.len().max(1);
        ((number as usize) < count).then_some(Clip::Number(number))
    }

    /// Chooses what [`Scene::pose`] plays from now on; false, and nothing changes, if there is no
    /// such clip. A scene without clips has its first.
    pub fn play(&mut self, clip: &Clip) -> bool {
        let count = self.animations().len();
        self.rig.played = match self.find_clip(clip) {
            None => return false,
            Some(Clip::Number(number)) if count > 0 => number as usize..number as usize + 1,
            Some(_) => 0..count,
        };
        true
    }

    /// Moves everything that moves to where it is at `time_s` seconds: instance matrices, boxes of
    /// instances and objects, vertices of deforming meshes, lights and cameras; and gives materials,
    /// lights, cameras and [`Object::visible`](crate::Object::visible) the values that they have
    /// then. The clip that [`Scene::play`] chose plays, the first without. Does nothing for a scene
    /// that does not move.
    pub fn pose(&mut self, time_s: f32) {
        if let Some(rig) = self.rig.data.clone() {
            rig.pose(self, time_s);
        }
    }
}
