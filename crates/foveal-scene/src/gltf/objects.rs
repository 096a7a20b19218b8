//! Objects and instances: nodes with meshes, GPU instancing, and their exact boxes.

use std::sync::Arc;

use glam::{Mat4, Quat, Vec3};

use super::nodes::{Hierarchy, Instancing, NodeDef, rotation};
use super::reader::Reader;
use crate::cloud::Cloud;
use crate::error::{Flaw, Limit, Parsed};
use crate::{Aabb, Code, Instance, LoadOptions, Mesh, Object, Warning, threads};

/// An object takes hundreds of bytes: a file that stores none of them does not get many.
const MAX_UNBACKED_INSTANCES: usize = 1 << 16;

/// Memory that an instance takes: its object, itself, and what renderer and culler keep of it.
pub(crate) const INSTANCE_BYTES: u64 = 600;

/// A mesh with a material, as one primitive of a glTF mesh gives it.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) mesh: u32,
    pub(crate) material: u32,
    /// Its number among the primitives of the glTF mesh.
    pub(crate) primitive: u32,
    /// Its vertices are in world space already.
    pub(crate) skinned: bool,
}

/// A node that shows geometry.
pub(crate) struct Shown {
    pub(crate) node: u32,
    pub(crate) parts: Vec<Part>,
    /// Transforms of its instancing elements, or one identity.
    pub(crate) elements: Vec<Mat4>,
}

/// How many elements there are, by the shortest attribute and by the longest; `None` without
/// instancing.
fn element_counts(instancing: Option<Instancing>, reader: Reader<'_>) -> Option<(usize, usize)> {
    let instancing = instancing?;
    let counts = || instancing.accessors().map(|a| reader.accessor(a).count);
    counts().min().zip(counts().max())
}

/// Counts the memory of all elements before any is read.
pub(crate) fn check_elements(shown: &[Shown], reader: Reader<'_>) -> Parsed<()> {
    let bytes = shown.iter().map(|one| {
        let node = &reader.document.nodes[one.node as usize];
        let elements = element_counts(node.instancing, reader).map_or(0, |(least, _)| least as u64);
        let mesh = node
            .mesh
            .and_then(|m| reader.document.meshes[m as usize].name.as_ref());
        let names = [node.name.as_ref(), mesh, node.set.as_ref()];
        let names: usize = names.into_iter().flatten().map(String::len).sum();
        elements.saturating_mul(one.parts.len() as u64 * INSTANCE_BYTES + names as u64)
    });
    let bytes = bytes.fold(0, u64::saturating_add);
    let budget = &reader.buffers.budget;
    budget
        .take(bytes, "instances")
        .map_err(|e| e.under("nodes"))
}

/// The place of a fault in a node's instancing.
pub(crate) fn in_instancing(flaw: Flaw, node: u32) -> Flaw {
    flaw.under("extensions.EXT_mesh_gpu_instancing.attributes")
        .under(format_args!("nodes[{node}]"))
}

/// Elements of EXT_mesh_gpu_instancing; one identity without. `notes` takes what is odd about them.
pub(crate) fn elements(
    instancing: Option<Instancing>,
    reader: Reader<'_>,
    left: &mut u64,
    options: &LoadOptions,
    notes: &mut Vec<Flaw>,
) -> Parsed<Vec<Mat4>> {
    let Some(found) = instancing else {
        return Ok(vec![Mat4::IDENTITY]);
    };
    let Some((count, most)) = element_counts(instancing, reader) else {
        return Ok(vec![Mat4::IDENTITY]);
    };
    if count < most {
        let text = format!("have {count} to {most} elements; {count} instances are made");
        notes.push(Flaw::new(Code::AccessorCount, text));
    }
    let mut used = found.accessors();
    if count > MAX_UNBACKED_INSTANCES && used.all(|a| reader.accessor(a).unbacked() > 0) {
        return Err(Flaw::too_large(format!(
            "{count} instances without stored values, the limit is {MAX_UNBACKED_INSTANCES}"
        )));
    }
    *left = left
        .checked_sub(count as u64)
        .ok_or_else(|| too_many(count as u64, options))?;
    let vectors = |accessor: Option<u32>, name: &str| -> Parsed<Option<Vec<[f32; 3]>>> {
        let read = |a| reader.floats::<3>(a).map_err(|e| e.under(name));
        accessor.map(read).transpose()
    };
    let translations = vectors(found.translation, "TRANSLATION")?;
    let scales = vectors(found.scale, "SCALE")?;
    let rotations = match found.rotation {
        Some(a) => Some(reader.floats::<4>(a).map_err(|e| e.under("ROTATION"))?),
        None => None,
    };
    let vector = |list: &Option<Vec<[f32; 3]>>, i: usize, default: Vec3| {
        list.as_ref().map_or(default, |l| Vec3::from(l[i]))
    };
    Ok((0..count)
        .map(|i| {
            let turn = rotations
                .as_ref()
                .map_or(Quat::IDENTITY, |l| rotation(l[i]));
            let scale = vector(&scales, i, Vec3::ONE);
            Mat4::from_scale_rotation_translation(scale, turn, vector(&translations, i, Vec3::ZERO))
        })
        .collect())
}

pub(crate) fn too_many(count: u64, options: &LoadOptions) -> Flaw {
    Flaw::beyond(
        Limit::Instances,
        format!(
            "wants {count} instances, more than the limit of {} in all leaves",
            options.max_instances
        ),
    )
}

/// Objects with their instances, and the clouds of all meshes that they show.
#[derive(Default)]
pub(crate) struct Placed {
    pub(crate) objects: Vec<Object>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) clouds: Vec<Option<Arc<Cloud>>>,
}

/// Places every shown node's elements. What lies beyond the range of numbers is left out with a
/// warning.
pub(crate) fn place(
    shown: &[Shown],
    nodes: &[NodeDef],
    world: &[Mat4],
    meshes: &[Mesh],
    options: &LoadOptions,
    warn: &mut Vec<Warning>,
) -> Parsed<Placed> {
    let uses = count_uses(shown, meshes, options)?;
    let numbers: Vec<u32> = (0..meshes.len() as u32).collect();
    let clouds = threads::map(options.parallel, &numbers, |&i| {
        let uses = uses[i as usize];
        (uses > 0).then(|| Arc::new(Cloud::of(&meshes[i as usize], uses)))
    });
    let spots: Vec<(&Shown, usize)> = shown
        .iter()
        .flat_map(|s| (0..s.elements.len()).map(move |e| (s, e)))
        .collect();
    let places = threads::map(options.parallel, &spots, |&(shown, element)| {
        let own = shown.elements[element];
        let at_node = world[shown.node as usize] * own;
        let place = |part: &Part| {
            let matrix = if part.skinned { own } else { at_node };
            let bounds = match &clouds[part.mesh as usize] {
                Some(cloud) => cloud.bounds(matrix),
                None => Aabb::EMPTY,
            };
            (matrix, bounds)
        };
        shown.parts.iter().map(place).collect::<Vec<(Mat4, Aabb)>>()
    });
    let mut placed = Placed::default();
    for ((shown, element), places) in spots.into_iter().zip(places) {
        let usable = |(matrix, b): &(Mat4, Aabb)| {
            matrix.is_finite() && (b.is_empty() || (b.min.is_finite() && b.max.is_finite()))
        };
        if !places.iter().all(usable) {
            let note = "lies beyond the range of 32-bit numbers and is left out";
            warn.push(Warning::new(
                Code::NodeBeyondRange,
                format!("nodes[{}]: {note}", shown.node),
            ));
            continue;
        }
        let node = &nodes[shown.node as usize];
        let object = placed.objects.len() as u32;
        let first = placed.instances.len() as u32;
        let mut bounds = Aabb::EMPTY;
        for (part, (world_from_object, part_bounds)) in shown.parts.iter().zip(places) {
            bounds = bounds.union(part_bounds);
            placed.instances.push(Instance {
                mesh: part.mesh,
                material: part.material,
                object,
                world_from_object,
                bounds: part_bounds,
            });
        }
        placed.objects.push(Object {
            name: node.name.clone().unwrap_or_default(),
            node: shown.node,
            element: element as u32,
            visible: true,
            occluder: node.occluder,
            set: node.set.clone(),
            bounds,
            instances: first..placed.instances.len() as u32,
        });
    }
    placed.clouds = clouds;
    Ok(placed)
}

/// Instances per mesh, checked against the limits before anything of their number is allocated.
fn count_uses(shown: &[Shown], meshes: &[Mesh], options: &LoadOptions) -> Parsed<Vec<u64>> {
    let mut uses = vec![0u64; meshes.len()];
    let (mut instances, mut triangles) = (0u64, 0u64);
    for one in shown {
        let elements = one.elements.len() as u64;
        for part in &one.parts {
            uses[part.mesh as usize] += elements;
            instances += elements;
            let mesh = &meshes[part.mesh as usize];
            triangles += elements * (mesh.triangle_count() + mesh.stroke_count()) as u64;
        }
    }
    if instances > options.max_instances {
        return Err(too_many(instances, options).under("nodes"));
    }
    if triangles > options.max_triangles {
        return Err(Flaw::beyond(
            Limit::Triangles,
            format!(
                "wants {triangles} triangles, lines and points in all instances; the limit is {}",
                options.max_triangles
            ),
        )
        .under("nodes"));
    }
    Ok(uses)
}

/// Nodes that the scene shows and that have a mesh, in the file's order.
pub(crate) fn nodes_with_meshes<'a>(
    nodes: &'a [NodeDef],
    hierarchy: &'a Hierarchy,
) -> impl Iterator<Item = (u32, &'a NodeDef, u32)> {
    nodes
        .iter()
        .enumerate()
        .filter(|(i, _)| hierarchy.shown[*i])
        .filter_map(|(i, node)| Some((i as u32, node, node.mesh?)))
}
