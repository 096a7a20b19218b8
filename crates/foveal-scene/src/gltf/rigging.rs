//! From nodes, skins, morph targets and animations to the rig that
//! [`Scene::pose`](crate::Scene::pose) plays.

use std::collections::HashSet;
use std::sync::Arc;

use glam::Mat4;

use super::Carriers;
use super::animations::AnimationDef;
use super::document::Document;
use super::nodes::Hierarchy;
use super::objects::Shown;
use super::parts::bytes_of_stroke;
use super::reader::Reader;
use super::unused::NOT_SHOWN;
use crate::cloud::Cloud;
use crate::error::{Flaw, Parsed};
use crate::pose::{
    Binding, Deformer, Local, MaterialPart, MaterialState, Node, Rig, RigData, Shape, Skin, Target,
    world_from_nodes,
};
use crate::{Code, LoadOptions, Material, Scene, Warning};

/// Each pose writes all of these anew, and each node has its own: more would not move in real time.
const MAX_DEFORMING: u64 = 16 << 20;

/// The rig while the scene is being put together.
pub(crate) struct Rigging {
    data: RigData,
    /// Nodes that an animation moves, or one above them.
    moving: Vec<bool>,
}

impl Rigging {
    /// Reads animations, and the skins of the shown nodes.
    pub(crate) fn begin(
        reader: Reader<'_>,
        hierarchy: &Hierarchy,
        shown: &[Shown],
        options: &LoadOptions,
        warn: &mut Vec<Warning>,
    ) -> Parsed<Self> {
        let document = reader.document;
        let nodes = document
            .nodes
            .iter()
            .zip(&hierarchy.parent)
            .map(|(node, parent)| Node {
                parent: *parent,
                local: node.local,
                weights: Vec::new(),
            })
            .collect();
        let mut animations = Vec::new();
        for (i, def) in document.animations.iter().enumerate() {
            let mut notes = Vec::new();
            let targets = |node: u32| target_count(document, node);
            let animation = def.read(reader, targets, &mut notes);
            warn.extend(
                notes
                    .into_iter()
                    .map(|note| note.within(format_args!("animations[{i}]"))),
            );
            animations.push(animation);
        }
        let mut data = RigData {
            nodes,
            order: hierarchy.order.clone(),
            animations,
            parallel: options.parallel,
            ..RigData::default()
        };
        let skins = shown.iter().map(|s| document.nodes[s.node as usize].skin);
        let needed: HashSet<u32> = skins.flatten().collect();
        for (i, def) in document.skins.iter().enumerate() {
            let place = |flaw: Flaw| flaw.under(format_args!("skins[{i}]"));
            let skin = if needed.contains(&(i as u32)) {
                def.read(reader).map_err(place)?
            } else {
                let check = def.check(reader).map_err(place);
                warn.extend(check.err().map(|flaw| flaw.warning().and(NOT_SHOWN)));
                Skin::default()
            };
            data.skins.push(skin);
        }
        let moving = moving_nodes(&mut data, document, warn);
        // Where a channel cannot be read too: the hierarchy has kept what it would show.
        let mut targets = document.animations.iter().flat_map(AnimationDef::targets);
        if targets.any(|pointed| pointed.target == Target::Visible) {
            data.visible = Some(document.nodes.iter().map(|n| n.visible).collect());
        }
        Ok(Self { data, moving })
    }

    /// Gives each node with a deforming mesh a mesh of its own.
    pub(crate) fn give_own_meshes(
        &mut self,
        shown: &mut [Shown],
        shapes: &[Option<Shape>],
        scene: &mut Scene,
        reader: Reader<'_>,
        options: &LoadOptions,
        warn: &mut Vec<Warning>,
    ) -> Parsed<()> {
        let document = reader.document;
        let weights = shown.iter().map(|s| target_count(document, s.node) as u64);
        let budget = &reader.buffers.budget;
        budget
            .take(4 * weights.sum::<u64>(), "morph weights")
            .map_err(|e| e.under("nodes"))?;
        let shapes: Vec<Option<Arc<Shape>>> =
            shapes.iter().map(|s| s.clone().map(Arc::new)).collect();
        // A mesh that a rigid node shows too stays as it is for that one.
        let mut taken = vec![false; shapes.len()];
        for one in shown.iter() {
            let skinned = document.nodes[one.node as usize].skin.is_some();
            for part in &one.parts {
                let rigid = |s: &Arc<Shape>| s.targets.is_empty() && !skinned;
                taken[part.mesh as usize] |= shapes[part.mesh as usize].as_ref().is_some_and(rigid);
            }
        }
        let mut vertices = 0u64;
        for one in shown {
            let node = one.node;
            let def = &document.nodes[node as usize];
            let skin = def.skin;
            self.data.nodes[node as usize].weights = weights_at_rest(document, node, warn);
            for part in &mut one.parts {
                let shape = shapes[part.mesh as usize].as_ref();
                let has_joints = shape.is_some_and(|shape| shape.influences.is_some());
                if skin.is_some() && !has_joints {
                    let primitive = part.primitive;
                    let note = format!(
                        "nodes[{node}]: has a skin, but primitive {primitive} of its mesh has no joints; it stays rigid"
                    );
                    warn.push(Warning::new(Code::Skin, note));
                }
                let Some(shape) = shape else {
                    continue;
                };
                let skin = skin.filter(|_| has_joints);
                if shape.targets.is_empty() && skin.is_none() {
                    if has_joints {
                        let note = "has joints in its mesh but no skin; it stays rigid";
                        warn.push(Warning::new(Code::Skin, format!("nodes[{node}]: {note}")));
                    }
                    continue;
                }
                vertices += shape.rest.len() as u64;
                if vertices > options.max_vertices.min(MAX_DEFORMING) {
                    let cause = "the deforming meshes have more vertices than the limit allows";
                    return Err(Flaw::too_large(cause).under(format_args!("nodes[{node}]")));
                }
                self.check_joints(shape, skin, node, warn);
                part.skinned = skin.is_some();
                let first = !std::mem::replace(&mut taken[part.mesh as usize], true);
                if !first {
                    let mesh = &scene.meshes[part.mesh as usize];
                    let bytes = size_of_val(mesh.vertices.as_slice()) * 2 + 4 * mesh.used().count();
                    let strokes = mesh.stroke_count() as u64 * bytes_of_stroke(true);
                    let budget = &reader.buffers.budget;
                    budget
                        .take(bytes as u64 + strokes, "a deforming mesh of its own")
                        .map_err(|e| e.under(format_args!("nodes[{node}]")))?;
                    let copy = scene.meshes[part.mesh as usize].clone();
                    scene.meshes.push(copy);
                    part.mesh = scene.meshes.len() as u32 - 1;
                }
                if part.skinned {
                    self.data.skinned.insert(part.mesh);
                }
                scene.meshes[part.mesh as usize].deforms = true;
                self.data.deformers.push(Deformer {
                    mesh: part.mesh,
                    node,
                    shape: Arc::clone(shape),
                    skin,
                });
            }
        }
        Ok(())
    }

    fn check_joints(&self, shape: &Shape, skin: Option<u32>, node: u32, warn: &mut Vec<Warning>) {
        let (Some(skin), Some(influences)) = (skin, &shape.influences) else {
            return;
        };
        let joints = self.data.skins[skin as usize].joints.len();
        let lists = influences.joints.iter().zip(&influences.weights);
        let mut pairs = lists.flat_map(|(j, w)| j.iter().zip(w));
        if pairs.any(|(&j, &w)| w > 0.0 && j as usize >= joints) {
            warn.push(Warning::new(Code::Skin, format!(
                "nodes[{node}]: its mesh names joints that skins[{skin}] does not have; they are ignored"
            )));
        }
    }

    /// World transforms of all nodes without any animation.
    pub(crate) fn world_at_rest(&self) -> Vec<Mat4> {
        let locals: Vec<Local> = self.data.nodes.iter().map(|n| n.local).collect();
        world_from_nodes(|i| self.data.nodes[i].parent, &self.data.order, &locals)
    }

    /// Binds what moves to the finished scene. A scene that never moves keeps no rig.
    pub(crate) fn finish(
        mut self,
        scene: &mut Scene,
        document: &Document,
        shown: &[Shown],
        clouds: &[Option<Arc<Cloud>>],
        carriers: &Carriers,
    ) {
        if self.data.deformers.is_empty() && !self.data.plays() {
            return;
        }
        let deforming: HashSet<u32> = self.data.deformers.iter().map(|d| d.node).collect();
        let by_node: std::collections::HashMap<u32, &Shown> =
            shown.iter().map(|s| (s.node, s)).collect();
        for (i, object) in scene.objects.iter().enumerate() {
            let moves = self.moving[object.node as usize] || deforming.contains(&object.node);
            let Some(shown) = by_node.get(&object.node).filter(|_| moves) else {
                continue;
            };
            self.data.bindings.push(Binding {
                object: i as u32,
                node: object.node,
                element: shown.elements[object.element as usize],
            });
            for part in &shown.parts {
                if !scene.meshes[part.mesh as usize].deforms
                    && let Some(Some(cloud)) = clouds.get(part.mesh as usize)
                {
                    self.data.clouds.insert(part.mesh, Arc::clone(cloud));
                }
            }
        }
        for (i, &(node, _)) in carriers.cameras.iter().enumerate() {
            if self.moving[node as usize] {
                self.data.cameras.push((i as u32, node));
            }
        }
        for (i, light) in scene.lights.iter().enumerate() {
            if let Some(node) = light.node
                && self.moving[node as usize]
            {
                self.data.lights.push((i as u32, node));
            }
        }
        self.keep_at_rest(scene, document, carriers);
        scene.rig = Rig {
            data: Some(Arc::new(self.data)),
            played: 0..0,
            ..Rig::default()
        };
    }
}

impl Rigging {
    /// Keeps the values at rest of what animations change besides nodes.
    fn keep_at_rest(&mut self, scene: &Scene, document: &Document, carriers: &Carriers) {
        let data = &mut self.data;
        let (mut cameras, mut lights) = (HashSet::new(), HashSet::new());
        let channels = data.animations.iter().flat_map(|a| &a.channels);
        for channel in channels {
            match channel.target {
                Target::Camera(_) => {
                    cameras.insert(channel.number);
                }
                Target::Light(_) => {
                    lights.insert(channel.number);
                }
                Target::Material(_) => {
                    let number = channel.number as usize;
                    let Some(material) = scene.materials.get(number) else {
                        continue;
                    };
                    let def = &document.materials[number];
                    let at_rest = || MaterialState {
                        // The scene's own name stays.
                        material: Material {
                            name: String::new(),
                            ..material.clone()
                        },
                        emissive: def.emissive_factor,
                        emissive_strength: def.emissive_strength,
                        transforms: Vec::new(),
                        tangents: None,
                    };
                    data.materials.entry(channel.number).or_insert_with(at_rest);
                }
                _ => {}
            }
        }
        for pointed in document.animations.iter().flat_map(AnimationDef::targets) {
            if let Target::Material(MaterialPart::Uv(slot, _)) = pointed.target
                && let Some(transform) = pointed.at_rest
                && let Some(state) = data.materials.get_mut(&pointed.number)
                && state.transforms.iter().all(|(known, _)| *known != slot)
            {
                state.transforms.push((slot, transform));
            }
        }
        let turning = document.turning_materials();
        for (number, state) in &mut data.materials {
            let slot = document.materials[*number as usize].tangent_slot();
            let moved = slot.filter(|_| turning.contains(number));
            let moved = moved.and_then(|slot| state.transforms.iter().find(|(s, _)| *s == slot));
            state.tangents = moved.map(|(slot, transform)| (*slot, *transform));
        }
        data.copies.clone_from(&carriers.materials);
        for (i, (_, number)) in carriers.cameras.iter().enumerate() {
            if let Some(camera) = scene.cameras.get(i).filter(|_| cameras.contains(number)) {
                data.zooming.push((i as u32, *number));
                data.projections.insert(*number, camera.projection);
            }
        }
        let all = data.visible.is_some();
        for (i, number) in carriers.lights.iter().enumerate() {
            let changes = all || lights.contains(number);
            if let Some(light) = scene.lights.get(i).filter(|_| changes) {
                data.shining.push((i as u32, *number));
                data.emission.insert(*number, light.clone());
            }
        }
    }
}

/// Marks animated nodes and everything below them. Rotation and scale of nodes with a matrix cannot
/// be animated.
fn moving_nodes(data: &mut RigData, document: &Document, warn: &mut Vec<Warning>) -> Vec<bool> {
    let mut moving = vec![false; data.nodes.len()];
    for channel in data.animations.iter().flat_map(|a| &a.channels) {
        if !channel.target.is_transform() && !channel.target.is_weight() {
            continue;
        }
        let node = channel.number as usize;
        if matches!(document.nodes[node].local, Local::Matrix(_))
            && matches!(channel.target, Target::Rotation | Target::Scale)
        {
            warn.push(Warning::new(
                Code::AnimationUnsupported,
                format!("nodes[{node}]: has a matrix: its rotation and scale are not animated"),
            ));
        }
        moving[node] = true;
    }
    for &i in &data.order {
        let above = data.nodes[i as usize].parent;
        moving[i as usize] |= above.is_some_and(|p| moving[p as usize]);
    }
    moving
}

/// Number of morph targets of a node's mesh.
fn target_count(document: &Document, node: u32) -> usize {
    let mesh = document.nodes[node as usize].mesh;
    mesh.map_or(0, |mesh| document.meshes[mesh as usize].target_count)
}

/// The node's own weights, else its mesh's, else zeros.
fn weights_at_rest(document: &Document, node: u32, warn: &mut Vec<Warning>) -> Vec<f32> {
    let def = &document.nodes[node as usize];
    let of_mesh = def.mesh.map(|m| &document.meshes[m as usize].weights);
    let given = match of_mesh {
        Some(of_mesh) if def.weights.is_empty() => of_mesh,
        _ => &def.weights,
    };
    let count = target_count(document, node);
    if !given.is_empty() && given.len() != count {
        warn.push(Warning::new(
            Code::MorphWeights,
            format!(
                "nodes[{node}]: has {} weights for {count} morph targets",
                given.len()
            ),
        ));
    }
    // No more than the budget has counted: each node may show a mesh with a long list.
    let mut weights = vec![0.0; count];
    let kept = given.len().min(count);
    weights[..kept].copy_from_slice(&given[..kept]);
    weights
}
