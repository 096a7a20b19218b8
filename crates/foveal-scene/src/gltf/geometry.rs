//! Vertices and indices of one primitive.

use bytemuck::Zeroable;

use super::accessor::Component;
use super::materials::UvSets;
use super::meshes::{Mode, PrimitiveDef};
use super::reader::Reader;
use super::tangents::TangentUvs;
use super::{morphs, normals, tangents, topology};
use crate::error::{Flaw, Parsed};
use crate::load::MissingNormals;
use crate::pose::Shape;
use crate::{Code, Mesh, Vertex, Warning};

/// What a primitive's geometry depends on; equal requests share one mesh.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct Request {
    pub(crate) primitive: PrimitiveDef,
    pub(crate) uv_sets: UvSets,
    /// Where the normal texture is read, where there is one.
    pub(crate) tangents_for: Option<TangentUvs>,
}

impl Request {
    /// Where the normal texture is read, where tangents are generated for it.
    pub(crate) fn generated_tangents(&self) -> Option<TangentUvs> {
        let def = &self.primitive;
        let generates = def.mode.makes_triangles() && !def.has_tangents();
        self.tangents_for.filter(|_| generates)
    }
}

/// A finished primitive.
#[derive(Default)]
pub(crate) struct Built {
    pub(crate) mesh: Mesh,
    /// What morph targets or joints need; `None` for rigid geometry.
    pub(crate) shape: Option<Shape>,
    pub(crate) notes: Vec<Warning>,
}

/// Builds the mesh of a primitive; empty for one that makes nothing.
pub(crate) fn build(
    request: &Request,
    reader: Reader<'_>,
    missing_normals: MissingNormals,
) -> Parsed<Built> {
    let def = &request.primitive;
    let mut notes = Vec::new();
    let Some(position) = def.attributes.position else {
        notes.push(Warning::new(
            Code::PrimitivePositions,
            "has no POSITION and is not drawn",
        ));
        return Ok(Built {
            notes,
            ..Built::default()
        });
    };
    let positions = reader
        .floats::<3>(position)
        .map_err(|e| e.under("attributes.POSITION"))?;
    let indices = match def.indices {
        Some(accessor) => Some(
            reader
                .uints::<1>(accessor)
                .map_err(|e| e.under("indices"))?
                .into_flattened(),
        ),
        None => None,
    };
    let mut indices = topology::lists(def.mode, indices, positions.len());
    drop_unusable(&mut indices, def.mode, &positions, &mut notes);

    let mut source = compact(&mut indices, positions.len());
    let mut vertices = assemble(request, reader, &positions, &source)?;
    drop(positions);

    let makes_triangles = def.mode.makes_triangles();
    let mut flat = false;
    if def.attributes.normal.is_some() {
        let triangles = makes_triangles.then_some(indices.as_slice());
        repair_normals(&mut vertices, triangles, &mut notes);
    } else if !makes_triangles {
        // Unlit: their normals stay zero.
    } else if missing_normals == MissingNormals::Flat {
        let corners = normals::unweld(&mut vertices, &mut indices);
        source = corners.iter().map(|&i| source[i as usize]).collect();
        normals::flat(&mut vertices);
        flat = true;
    } else {
        normals::smooth(&mut vertices, &indices, |_| true);
    }
    let generated = request.generated_tangents();
    if let Some(uvs) = generated
        && let Some(split) = tangents::generate(&mut vertices, &mut indices, uvs)
    {
        source = split.iter().map(|&i| source[i as usize]).collect();
    }
    let mut shape = morphs::read_shape(def, request.uv_sets, reader, &source, &mut notes)?;
    if let Some(shape) = &mut shape {
        if let Some(uvs) = generated {
            tangents::add_to_targets(&mut shape.targets, &vertices, &indices, uvs, flat);
        }
        shape.rest.clone_from(&vertices);
        shape.flat = flat;
    }
    let mut mesh = Mesh {
        vertices,
        ..Mesh::default()
    };
    match def.mode.corners() {
        1 => mesh.points = indices,
        2 => mesh.lines = indices.as_chunks::<2>().0.to_vec(),
        _ => mesh.indices = indices,
    }
    mesh.bounds = mesh.bounds_of(&mesh.vertices);
    Ok(Built { mesh, shape, notes })
}

/// Leaves out triangles, lines and points that name missing vertices or vertices at no place.
fn drop_unusable(
    indices: &mut Vec<u32>,
    mode: Mode,
    positions: &[[f32; 3]],
    notes: &mut Vec<Warning>,
) {
    let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    let all_finite = positions.iter().all(finite);
    let all_there = indices.iter().all(|&i| (i as usize) < positions.len());
    if all_finite && all_there {
        return;
    }
    let before = indices.len();
    let usable = |i: &u32| positions.get(*i as usize).is_some_and(finite);
    *indices = indices
        .chunks_exact(mode.corners())
        .filter(|t| t.iter().all(usable))
        .flatten()
        .copied()
        .collect();
    let dropped = (before - indices.len()) / mode.corners();
    if dropped > 0 {
        let what = match mode.corners() {
            1 => "points",
            2 => "lines",
            _ => "triangles",
        };
        notes.push(Warning::new(Code::TrianglesUnusable, format!(
            "{dropped} of {} {what} name vertices that do not exist or lie at no finite place, and are left out",
            before / mode.corners()
        )));
    }
}

/// Renumbers the indices when they use only a part of the vertices; returns each vertex's number in
/// the file.
///
/// Exporters like to cut one large vertex buffer into many primitives: without this each of them
/// would carry all of it.
fn compact(indices: &mut [u32], vertex_count: usize) -> Vec<u32> {
    if indices.len() >= vertex_count {
        return (0..vertex_count as u32).collect();
    }
    let mut source: Vec<u32> = indices.to_vec();
    source.sort_unstable();
    source.dedup();
    for index in indices {
        // Every index is in `source`.
        *index = source.partition_point(|s| s < index) as u32;
    }
    source
}

/// Which texture coordinates a material reads in vain.
pub(crate) fn missing_uvs(request: &Request) -> impl Iterator<Item = Warning> {
    let given = &request.primitive.attributes.uv;
    let sets = request.uv_sets.into_iter().flatten();
    let missing = sets.filter(|set| given.iter().all(|(number, _)| number != set));
    missing.map(|set| {
        let text = format!("has no TEXCOORD_{set} although its material reads it; (0, 0) is used");
        Warning::new(Code::TexcoordsMissing, text)
    })
}

/// Vertices with every attribute that the file gives.
fn assemble(
    request: &Request,
    reader: Reader<'_>,
    positions: &[[f32; 3]],
    source: &[u32],
) -> Parsed<Vec<Vertex>> {
    let attributes = &request.primitive.attributes;
    let mut vertices: Vec<Vertex> = source
        .iter()
        .map(|&i| Vertex {
            position: positions[i as usize],
            color: [u16::MAX; 4],
            ..Vertex::zeroed()
        })
        .collect();
    // Vertices that no triangle uses may still be anywhere.
    for vertex in &mut vertices {
        if !vertex.position.iter().all(|x| x.is_finite()) {
            vertex.position = [0.0; 3];
        }
    }
    let mut fill = Fill {
        vertices: &mut vertices,
        source,
        count: positions.len(),
    };
    if let Some(accessor) = attributes.normal {
        let list = reader.floats::<3>(accessor);
        fill.with(list, "NORMAL", |v, n| v.normal = n)?;
    }
    if let Some(accessor) = attributes.tangent {
        let list = reader.floats::<4>(accessor);
        fill.with(list, "TANGENT", |v, t| v.tangent = unit_tangent(t))?;
    }
    for (slot, set) in request.uv_sets.iter().enumerate() {
        let Some(set) = *set else { continue };
        if let Some(&(_, accessor)) = attributes.uv.iter().find(|(number, _)| *number == set) {
            let list = reader.floats::<2>(accessor);
            fill.with(list, &format!("TEXCOORD_{set}"), |v, uv| {
                v.uv[slot] = uv.map(|x| if x.is_finite() { x } else { 0.0 });
            })?;
        }
    }
    if let Some(accessor) = attributes.color {
        let list = colors(reader, accessor);
        fill.with(list, "COLOR_0", |v, c| v.color = c)?;
    }
    Ok(vertices)
}

/// Writes one attribute into the vertices.
struct Fill<'a> {
    vertices: &'a mut [Vertex],
    source: &'a [u32],
    count: usize,
}

impl Fill<'_> {
    fn with<T: Copy>(
        &mut self,
        list: Parsed<Vec<T>>,
        name: &str,
        set: impl Fn(&mut Vertex, T),
    ) -> Parsed<()> {
        let place = |e: Flaw| e.under(format_args!("attributes.{name}"));
        let list = list.map_err(place)?;
        if list.len() < self.count {
            return Err(place(Flaw::new(
                Code::AccessorCount,
                format!("has {} elements for {} positions", list.len(), self.count),
            )));
        }
        for (vertex, &i) in self.vertices.iter_mut().zip(self.source) {
            set(vertex, list[i as usize]);
        }
        Ok(())
    }
}

/// Linear RGBA in 16 bits from any of glTF's colour formats.
fn colors(reader: Reader<'_>, accessor: u32) -> Parsed<Vec<[u16; 4]>> {
    let found = reader.accessor(accessor);
    // Integers that forgot to say so are meant as fractions: colours have no other use for them.
    let unit = match found.component {
        _ if found.normalized => 1.0,
        Component::U8 => 1.0 / 255.0,
        Component::U16 => 1.0 / 65535.0,
        _ => 1.0,
    };
    let whole = |x: f32| (x * unit * 65535.0).round() as u16;
    if found.width == 3 {
        let list = reader.floats::<3>(accessor)?;
        Ok(list
            .into_iter()
            .map(|c| {
                let [r, g, b] = c.map(whole);
                [r, g, b, u16::MAX]
            })
            .collect())
    } else {
        let list = reader.floats::<4>(accessor)?;
        Ok(list.into_iter().map(|c| c.map(whole)).collect())
    }
}

fn unit_tangent([x, y, z, w]: [f32; 4]) -> [f32; 4] {
    let direction = glam::Vec3::new(x, y, z)
        .try_normalize()
        .unwrap_or(glam::Vec3::X);
    direction
        .extend(if w < 0.0 { -1.0 } else { 1.0 })
        .to_array()
}

/// Makes normals unit vectors; those without a direction become those of the triangles, or zero for
/// points and lines, which have no surface.
fn repair_normals(vertices: &mut [Vertex], triangles: Option<&[u32]>, notes: &mut Vec<Warning>) {
    let mut bad = Vec::new();
    for (i, vertex) in vertices.iter_mut().enumerate() {
        match glam::Vec3::from(vertex.normal).try_normalize() {
            Some(normal) => vertex.normal = normal.to_array(),
            None => bad.push(i),
        }
    }
    if bad.is_empty() {
        return;
    }
    let then = match triangles {
        Some(_) => " and are made anew",
        None => ": the points and lines there are not lit",
    };
    notes.push(Warning::new(
        Code::Normals,
        format!(
            "{} of {} normals have no direction{then}",
            bad.len(),
            vertices.len()
        ),
    ));
    match triangles {
        Some(triangles) => {
            normals::smooth(vertices, triangles, |i| bad.binary_search(&i).is_ok());
        }
        None => (bad.iter()).for_each(|&i| vertices[i].normal = [0.0; 3]),
    }
}
