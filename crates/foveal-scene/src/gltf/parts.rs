//! Which primitives the shown nodes need, each built once however many ask for it.

use std::collections::HashMap;

use glam::Mat4;

use super::document::Document;
use super::geometry::{self, Built, Request};
use super::materials::{DEFAULT_UV_SETS, MaterialDef, UvSets};
use super::meshes::{Attributes, PrimitiveDef};
use super::nodes::Hierarchy;
use super::objects::{self, Part, Shown};
use super::reader::Reader;
use super::tangents::TangentUvs;
use crate::error::{Flaw, Limit, Parsed};
use crate::pose::Shape;
use crate::{LoadOptions, Material, MissingNormals, Scene, Vertex, Warning, threads};

/// A mesh to build.
struct Asked {
    request: Request,
    /// Of the first primitive that asks for it.
    place: String,
    name: String,
    /// Of the first primitive whose material reads texture coordinates.
    reads_uvs: Option<String>,
}

/// The meshes to build, each once however many primitives ask for it.
#[derive(Default)]
pub(crate) struct Geometry {
    asked: Vec<Asked>,
    numbers: HashMap<Request, u32>,
    /// Of materials whose generated tangents turn in poses, by their numbers: copies for meshes whose
    /// tangents are the file's.
    pub(crate) copies: HashMap<u32, u32>,
}

/// Adds a material to the scene and gives its number.
fn add(scene: &mut Scene, material: Material) -> u32 {
    scene.materials.push(material);
    scene.materials.len() as u32 - 1
}

impl Geometry {
    /// Collects what the shown nodes need. Adds a default material when a primitive has none.
    pub(crate) fn request(
        &mut self,
        reader: Reader<'_>,
        hierarchy: &Hierarchy,
        options: &LoadOptions,
        scene: &mut Scene,
    ) -> Parsed<Vec<Shown>> {
        let document = reader.document;
        let turning = document.turning_materials();
        let mut default_material = None;
        let mut parts_of: HashMap<u32, Vec<Part>> = HashMap::new();
        let mut shown = Vec::new();
        let mut instances = 0u64;
        for (node, _, mesh) in objects::nodes_with_meshes(&document.nodes, hierarchy) {
            let parts = parts_of.entry(mesh).or_insert_with(|| {
                let def = &document.meshes[mesh as usize];
                (0..def.primitives.len())
                    .map(|p| Part {
                        primitive: p as u32,
                        skinned: false,
                        mesh: self.number(document, mesh, p),
                        material: match def.materials[p] {
                            Some(m) if def.primitives[p].has_tangents() && turning.contains(&m) => {
                                self.copy_of(m, scene)
                            }
                            Some(material) => material,
                            None => *default_material
                                .get_or_insert_with(|| add(scene, Material::default())),
                        },
                    })
                    .collect()
            });
            // Before the list is copied: few bytes can name many primitives in many nodes.
            instances += parts.len() as u64;
            if instances > options.max_instances {
                return Err(objects::too_many(instances, options).under("nodes"));
            }
            shown.push(Shown {
                node,
                parts: parts.clone(),
                elements: vec![Mat4::IDENTITY],
            });
        }
        let bytes = instances.saturating_mul(objects::INSTANCE_BYTES);
        let budget = &reader.buffers.budget;
        budget
            .take(bytes, "the meshes of its nodes")
            .map_err(|e| e.under("nodes"))?;
        Ok(shown)
    }

    fn copy_of(&mut self, material: u32, scene: &mut Scene) -> u32 {
        let copy = || add(scene, scene.materials[material as usize].clone());
        *self.copies.entry(material).or_insert_with(copy)
    }

    /// Asks for all primitives of a mesh.
    pub(crate) fn request_mesh(&mut self, document: &Document, mesh: u32) {
        for primitive in 0..document.meshes[mesh as usize].primitives.len() {
            self.number(document, mesh, primitive);
        }
    }

    fn number(&mut self, document: &Document, mesh: u32, primitive: usize) -> u32 {
        let def = &document.meshes[mesh as usize];
        let material = def.materials[primitive].map(|m| &document.materials[m as usize]);
        let uv_sets: UvSets = material.map_or(DEFAULT_UV_SETS, |m| m.uv_sets().0);
        let tangents_for = material
            .and_then(MaterialDef::tangent_uvs)
            .map(|(set, transform)| {
                TangentUvs::new(usize::from(uv_sets[1] == Some(set)), transform)
            });
        let request = Request {
            primitive: def.primitives[primitive].clone(),
            uv_sets,
            tangents_for,
        };
        let place = || format!("meshes[{mesh}].primitives[{primitive}]");
        let asked = &mut self.asked;
        let number = *self.numbers.entry(request.clone()).or_insert_with(|| {
            asked.push(Asked {
                request,
                place: place(),
                name: def.label(mesh, primitive),
                reads_uvs: None,
            });
            asked.len() as u32 - 1
        });
        if material.is_some_and(MaterialDef::reads_uvs) {
            let reads_uvs = &mut self.asked[number as usize].reads_uvs;
            reads_uvs.get_or_insert_with(place);
        }
        number
    }

    /// Builds all meshes into the scene and returns their shapes, as many as meshes.
    pub(crate) fn build(
        &mut self,
        reader: Reader<'_>,
        options: &LoadOptions,
        scene: &mut Scene,
        warn: &mut Vec<Warning>,
    ) -> Parsed<Vec<Option<Shape>>> {
        self.check_size(reader, options)?;
        let built = threads::map(options.parallel, &self.asked, |asked| {
            geometry::build(&asked.request, reader, options.missing_normals)
                .map_err(|e| e.under(&asked.place))
        });
        let mut shapes = Vec::with_capacity(built.len());
        for (built, asked) in built.into_iter().zip(&self.asked) {
            let Built {
                mut mesh,
                shape,
                notes,
            } = built?;
            warn.extend(notes.into_iter().map(|note| note.at(&asked.place)));
            if let Some(place) = asked.reads_uvs.as_ref().filter(|_| !mesh.is_empty()) {
                warn.extend(geometry::missing_uvs(&asked.request).map(|note| note.at(place)));
            }
            mesh.name.clone_from(&asked.name);
            scene.meshes.push(mesh);
            shapes.push(shape);
        }
        Ok(shapes)
    }

    /// Adds up the vertices and corners that will come of it before anything is allocated.
    fn check_size(&self, reader: Reader<'_>, options: &LoadOptions) -> Parsed<()> {
        let (mut vertices, mut corners, mut bytes) = (0u64, 0u64, 0u64);
        for Asked { request, place, .. } in &self.asked {
            let def = &request.primitive;
            let count = |a: u32| reader.accessor(a).count as u64;
            let positions = def.attributes.position.map_or(0, count);
            let named = def.indices.map_or(positions, count);
            let made_corners = def.mode.corners_in_lists(named);
            // Flat shading gives every corner a vertex of its own.
            let flat = def.mode.makes_triangles()
                && def.attributes.normal.is_none()
                && options.missing_normals == MissingNormals::Flat;
            let made = if flat {
                made_corners
            } else {
                positions.min(made_corners)
            };
            let morphs = 1 + def.targets.len() as u64;
            vertices = vertices.saturating_add(made.saturating_mul(morphs));
            corners = corners.saturating_add(made_corners);
            bytes = bytes
                .saturating_add(made.saturating_mul(vertex_bytes(request)))
                .saturating_add(made_corners.saturating_mul(INDEX_BYTES))
                .saturating_add(stroke_bytes(def, made_corners));
            let (limit, most) = (options.max_vertices, vertices.max(corners / 6));
            if most > limit {
                return Err(Flaw::beyond(
                    Limit::Vertices,
                    format!(
                        "wants {vertices} vertices with morph targets and {corners} indices up to here; \
                         the limit is {limit} vertices and six times as many indices"
                    ),
                )
                .under(place));
            }
        }
        let budget = &reader.buffers.budget;
        budget
            .take(bytes, "vertices and indices")
            .map_err(|e| e.under("meshes"))
    }
}

/// Memory per corner while a mesh is built: as read, and as kept.
const INDEX_BYTES: u64 = 8;

/// Memory of a point or line where it is drawn: four vertices, in the pose before too where it
/// deforms, and six indices.
pub(crate) fn bytes_of_stroke(deforms: bool) -> u64 {
    let vertices = if deforms { 8 } else { 4 };
    vertices * size_of::<Vertex>() as u64 + 6 * 4
}

/// Memory that the points and lines of a primitive take where they are drawn.
fn stroke_bytes(def: &PrimitiveDef, corners: u64) -> u64 {
    if def.mode.makes_triangles() {
        return 0;
    }
    let strokes = corners / def.mode.corners() as u64;
    strokes.saturating_mul(bytes_of_stroke(def.deforms()))
}

/// Memory per vertex while a mesh is built: the vertex, its position as read and in its cloud, what
/// deforms it.
fn vertex_bytes(request: &Request) -> u64 {
    let def = &request.primitive;
    let vertex = size_of::<Vertex>() as u64;
    let joints = def.attributes.joints.iter().flatten().count() as u64;
    let generates = request.generated_tangents().is_some();
    let deltas = |t: &Attributes| {
        let given = [t.position, t.normal, t.tangent];
        let made = usize::from(generates && t.tangent.is_none());
        given.iter().flatten().count() + made
    };
    let targets = def.targets.iter().map(|t| {
        let further = 8 * t.uv.len().min(2) + 16 * usize::from(t.color.is_some());
        (12 * deltas(t) + further) as u64
    });
    let deforms = if def.deforms() {
        // At rest and as posed.
        2 * vertex
    } else {
        0
    };
    vertex + 28 + deforms + 48 * joints + targets.sum::<u64>()
}

/// Forgets empty meshes: they have been noted, and there is nothing to draw.
pub(crate) fn drop_empty_meshes(
    shown: &mut Vec<Shown>,
    shapes: Vec<Option<Shape>>,
    scene: &mut Scene,
) -> Vec<Option<Shape>> {
    let meshes = std::mem::take(&mut scene.meshes);
    let mut kept = Vec::new();
    let mut number: Vec<Option<u32>> = Vec::with_capacity(meshes.len());
    for (mesh, shape) in meshes.into_iter().zip(shapes) {
        number.push((!mesh.is_empty()).then_some(kept.len() as u32));
        if !mesh.is_empty() {
            scene.meshes.push(mesh);
            kept.push(shape);
        }
    }
    for one in shown.iter_mut() {
        let renumber = |part: &Part| {
            let mesh = number[part.mesh as usize]?;
            Some(Part { mesh, ..*part })
        };
        one.parts = one.parts.iter().filter_map(renumber).collect();
    }
    shown.retain(|s| !s.parts.is_empty());
    kept
}
