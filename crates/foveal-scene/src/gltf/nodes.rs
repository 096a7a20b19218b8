//! Nodes: their definitions, the order that visits parents first, and world transforms.

use glam::{Mat4, Quat, Vec3};

use super::animations::AnimationDef;
use super::document::{Counts, Document};
use super::json::Obj;
use crate::error::{Flaw, Parsed};
use crate::pose::{Local, Target};
use crate::{Code, Warning};

/// EXT_mesh_gpu_instancing: the accessors of its attributes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Instancing {
    pub(crate) translation: Option<u32>,
    pub(crate) rotation: Option<u32>,
    pub(crate) scale: Option<u32>,
    /// Another attribute's accessor, for the count where none of these is there.
    pub(crate) other: Option<u32>,
}

impl Instancing {
    /// Those that say how many elements there are.
    pub(crate) fn accessors(self) -> impl Iterator<Item = u32> {
        let places = [self.translation, self.rotation, self.scale];
        let other = self.other.filter(|_| places == [None; 3]);
        places.into_iter().chain([other]).flatten()
    }
}

/// A node as the file has it.
pub(crate) struct NodeDef {
    pub(crate) name: Option<String>,
    pub(crate) children: Vec<u32>,
    pub(crate) local: Local,
    pub(crate) mesh: Option<u32>,
    pub(crate) skin: Option<u32>,
    pub(crate) camera: Option<u32>,
    pub(crate) light: Option<u32>,
    pub(crate) weights: Vec<f32>,
    pub(crate) instancing: Option<Instancing>,
    pub(crate) visible: bool,
    pub(crate) occluder: Option<bool>,
    pub(crate) set: Option<String>,
}

impl NodeDef {
    pub(crate) fn parse(
        o: Obj<'_>,
        number: usize,
        counts: &Counts,
        warn: &mut Vec<Warning>,
    ) -> Parsed<Self> {
        let name = o.name("name")?;
        let trs = ["translation", "rotation", "scale"]
            .iter()
            .any(|k| o.has(k));
        let local = match o.floats::<16>("matrix")? {
            Some(matrix) => {
                if trs {
                    warn.push(Warning::new(Code::NodeTransform, format!(
                        "nodes[{number}]: has a matrix and translation, rotation or scale; the matrix is used"
                    )));
                }
                Local::Matrix(affine(matrix))
            }
            None => Local::Trs {
                translation: o.floats("translation")?.map_or(Vec3::ZERO, Vec3::from),
                rotation: o.floats("rotation")?.map_or(Quat::IDENTITY, rotation),
                scale: o.floats("scale")?.map_or(Vec3::ONE, Vec3::from),
            },
        };
        let instancing = match o.extension("EXT_mesh_gpu_instancing")? {
            Some(e) => parse_instancing(e, counts)
                .map_err(|e| e.under("extensions.EXT_mesh_gpu_instancing"))?,
            None => None,
        };
        let light = match o.extension("KHR_lights_punctual")? {
            Some(e) => e
                .index("light", counts.lights)
                .map_err(|e| e.under("extensions.KHR_lights_punctual"))?,
            None => None,
        };
        let visible = match o.extension("KHR_node_visibility")? {
            Some(e) => e
                .boolean("visible")
                .map_err(|e| e.under("extensions.KHR_node_visibility"))?
                .unwrap_or(true),
            None => true,
        };
        // `extras` belongs to the author: of another type than expected it is not ours to judge.
        let extras = o.get("extras").and_then(|e| Obj::of(e).ok());
        Ok(Self {
            children: o.indices("children", counts.nodes)?,
            local,
            mesh: o.index("mesh", counts.meshes)?,
            skin: o.index("skin", counts.skins)?,
            camera: o.index("camera", counts.cameras)?,
            light,
            weights: o.float_list("weights")?,
            instancing,
            visible,
            occluder: extras.and_then(|e| e.boolean("occluder").ok().flatten()),
            set: extras.and_then(|e| e.name("set").ok().flatten()),
            name,
        })
    }
}

/// The bottom row of a node's matrix is (0, 0, 0, 1) by the specification; anything else would not
/// be a place.
fn affine(mut columns: [f32; 16]) -> Mat4 {
    for (i, w) in [(3, 0.0), (7, 0.0), (11, 0.0), (15, 1.0)] {
        columns[i] = w;
    }
    Mat4::from_cols_array(&columns)
}

/// A unit quaternion; the identity for zero.
pub(crate) fn rotation(xyzw: [f32; 4]) -> Quat {
    let q = Quat::from_array(xyzw);
    let length = q.length();
    if length.is_finite() && length > 1e-20 {
        Quat::from_vec4(glam::Vec4::from(q) / length)
    } else {
        Quat::IDENTITY
    }
}

fn parse_instancing(o: Obj<'_>, counts: &Counts) -> Parsed<Option<Instancing>> {
    let Some(attributes) = o.object("attributes")? else {
        return Ok(None);
    };
    let mut found = Instancing::default();
    for (name, _) in attributes.entries() {
        let accessor = attributes
            .index(name, counts.accessors)
            .map_err(|e| e.under("attributes"))?;
        match name.as_str() {
            "TRANSLATION" => found.translation = accessor,
            "ROTATION" => found.rotation = accessor,
            "SCALE" => found.scale = accessor,
            _ => found.other = accessor,
        }
    }
    Ok(Some(found))
}

/// Of each node whether this is so of itself and of all above it; `order` has parents first.
pub(crate) fn all_the_way_up(
    order: &[u32],
    parent: &[Option<u32>],
    is_so: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let mut all = vec![true; parent.len()];
    for i in order.iter().map(|&i| i as usize) {
        all[i] = is_so(i) && parent[i].is_none_or(|p| all[p as usize]);
    }
    all
}

/// The node forest: parents, and an order in which every parent precedes its children.
pub(crate) struct Hierarchy {
    pub(crate) parent: Vec<Option<u32>>,
    pub(crate) order: Vec<u32>,
    /// Nodes that the shown scene reaches: their cameras can be used, whatever is hidden.
    pub(crate) reached: Vec<bool>,
    /// Of these, the nodes that no KHR_node_visibility hides in every pose.
    pub(crate) shown: Vec<bool>,
    /// Of these, whether none hides them at rest.
    pub(crate) visible: Vec<bool>,
}

impl Hierarchy {
    /// Fails on a node with two parents and on a cycle. Iterative: depth is up to the file.
    pub(crate) fn of(document: &Document, warn: &mut Vec<Warning>) -> Parsed<Self> {
        let nodes = &document.nodes;
        let mut parent: Vec<Option<u32>> = vec![None; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            for (k, &child) in node.children.iter().enumerate() {
                let slot = &mut parent[child as usize];
                if let Some(first) = slot {
                    return Err(Flaw::new(
                        Code::NodeTwoParents,
                        format!("node {child} is already a child of node {first}"),
                    )
                    .under(format_args!("nodes[{i}].children[{k}]")));
                }
                *slot = Some(i as u32);
            }
        }
        let mut order: Vec<u32> = (0..nodes.len() as u32)
            .filter(|&i| parent[i as usize].is_none())
            .collect();
        let mut next = 0;
        while next < order.len() {
            order.extend_from_slice(&nodes[order[next] as usize].children);
            next += 1;
        }
        if order.len() < nodes.len() {
            let mut reached = vec![false; nodes.len()];
            order.iter().for_each(|&i| reached[i as usize] = true);
            let looped = reached.iter().position(|r| !r).unwrap_or(0);
            return Err(
                Flaw::new(Code::NodeCycle, "is its own ancestor or below such a node")
                    .under(format_args!("nodes[{looped}]")),
            );
        }
        let mut shown = vec![false; nodes.len()];
        for &root in &document.roots {
            if parent[root as usize].is_some() {
                warn.push(Warning::new(Code::NodeRoot, format!(
                    "scenes: node {root} is listed as a root although it has a parent; its parent's transform applies"
                )));
            }
            shown[root as usize] = true;
        }
        for &i in &order {
            let above = parent[i as usize].is_some_and(|p| shown[p as usize]);
            shown[i as usize] |= above;
        }
        let reached = shown.clone();
        // Hidden in a second pass: a root below a hidden node is hidden with it.
        let mut appears = vec![false; nodes.len()];
        let targets = document.animations.iter().flat_map(AnimationDef::targets);
        for pointed in targets.filter(|pointed| pointed.target == Target::Visible) {
            appears[pointed.number as usize] = true;
        }
        let own = |i: usize| nodes[i].visible || appears[i];
        let stays = all_the_way_up(&order, &parent, own);
        for (shown, stays) in shown.iter_mut().zip(stays) {
            *shown &= stays;
        }
        Ok(Self {
            visible: all_the_way_up(&order, &parent, |i| nodes[i].visible),
            parent,
            order,
            reached,
            shown,
        })
    }
}
