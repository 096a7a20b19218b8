//! KHR_draco_mesh_compression: a primitive's attributes and indices out of one compressed view.

use std::borrow::Cow;

use draco_core::{DecodeLimits, DecoderBuffer, FaceIndex, Mesh, MeshDecoder};

use super::accessor::{Accessor, Component};
use super::json::Obj;
use super::meshes::Attributes;
use crate::Code;
use crate::error::{Flaw, Parsed};

/// The extension's object of one primitive.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DracoDef {
    pub(crate) view: u32,
    /// (accessor, the attribute's id in the stream).
    pub(crate) attributes: Vec<(u32, u32)>,
    pub(crate) indices: Option<u32>,
}

/// An accessor's elements, without gaps.
pub(crate) struct Dense {
    pub(crate) accessor: u32,
    pub(crate) bytes: Vec<u8>,
}

impl DracoDef {
    /// Reads the extension's object; `names` are the primitive's attributes.
    pub(crate) fn parse(
        o: Obj<'_>,
        views: usize,
        names: Obj<'_>,
        attributes: &Attributes,
        indices: Option<u32>,
    ) -> Parsed<Self> {
        let ids = o.need("attributes", o.object("attributes")?)?;
        let read = attributes.read();
        let mut pairs = Vec::new();
        for (name, _) in ids.entries() {
            let id = ids.index(name, u32::MAX as usize);
            let accessor = names.uint(name)?;
            if let (Some(id), Some(accessor)) = (id.map_err(|e| e.under("attributes"))?, accessor) {
                // Only what is read is worth decoding; the others may be of any type.
                if read.contains(&accessor) {
                    pairs.push((accessor as u32, id));
                }
            }
        }
        pairs.sort_unstable();
        Ok(Self {
            view: o.need("bufferView", o.index("bufferView", views)?)?,
            attributes: pairs,
            indices,
        })
    }

    /// All accessors that it fills.
    pub(crate) fn accessors(&self) -> impl Iterator<Item = u32> {
        let attributes = self.attributes.iter().map(|(accessor, _)| *accessor);
        attributes.chain(self.indices)
    }

    /// How many points and triangles the accessors promise.
    fn promised(&self, accessors: &[Accessor]) -> (u64, u64) {
        let count = |a: u32| accessors[a as usize].count as u64;
        let points = self.attributes.iter().map(|(a, _)| count(*a)).max();
        let corners = self.indices.map_or(0, count);
        (points.unwrap_or(0), corners / 3)
    }

    /// Memory that decoding takes: the elements, and what the decoder keeps of each point and
    /// triangle.
    pub(crate) fn decoding_bytes(&self, accessors: &[Accessor]) -> u64 {
        let (points, triangles) = self.promised(accessors);
        let width = |(a, _): &(u32, u32)| 8 * accessors[*a as usize].width as u64;
        let per_point = 32 + self.attributes.iter().map(width).sum::<u64>();
        points
            .saturating_mul(per_point)
            .saturating_add(triangles.saturating_mul(128))
    }

    /// The elements of all its accessors.
    pub(crate) fn decode(&self, bytes: &[u8], accessors: &[Accessor]) -> Parsed<Vec<Dense>> {
        let broken =
            |e: draco_core::DracoError| Flaw::new(Code::CompressedData, format!("is broken: {e}"));
        let (points, triangles) = self.promised(accessors);
        let limits = DecodeLimits::default()
            .with_max_points(points)
            .with_max_faces(triangles)
            .with_max_decoded_bytes(self.decoding_bytes(accessors).max(1 << 20));
        let bytes = with_points(bytes);
        let mut stream = DecoderBuffer::new(&bytes).with_limits(limits);
        let mut mesh = Mesh::new();
        MeshDecoder::new()
            .decode(&mut stream, &mut mesh)
            .map_err(broken)?;
        let mut all = Vec::new();
        for &(accessor, id) in &self.attributes {
            let def = &accessors[accessor as usize];
            let Some(attribute) = mesh.attribute_by_unique_id(id) else {
                return Err(
                    Flaw::new(Code::CompressedData, format!("has no attribute {id}"))
                        .under("attributes"),
                );
            };
            let (own, width) = (usize::from(attribute.num_components()), def.width);
            if own != width || mesh.num_points() < def.count {
                return Err(Flaw::new(
                    Code::CompressedData,
                    format!(
                        "attribute {id} has {} elements of {own} components, accessors[{accessor}] {} of {width}",
                        mesh.num_points(),
                        def.count
                    ),
                ));
            }
            let values = attribute.read_f32s(def.count, width);
            let bytes = encode(def.component, values.into_iter());
            all.push(Dense { accessor, bytes });
        }
        if let Some(accessor) = self.indices {
            let def = &accessors[accessor as usize];
            if mesh.num_faces() * 3 < def.count || def.component == Component::F32 {
                return Err(Flaw::new(
                    Code::CompressedData,
                    format!(
                        "has {} triangles, accessors[{accessor}] {} indices",
                        mesh.num_faces(),
                        def.count
                    ),
                ));
            }
            let corners = (0..mesh.num_faces() as u32)
                .flat_map(|i| mesh.face(FaceIndex(i)))
                .take(def.count);
            let bytes = match def.component {
                Component::I8 | Component::U8 => corners.map(|i| i.0 as u8).collect(),
                Component::I16 | Component::U16 => {
                    corners.flat_map(|i| (i.0 as u16).to_le_bytes()).collect()
                }
                Component::U32 | Component::F32 => {
                    corners.flat_map(|i| i.0.to_le_bytes()).collect()
                }
            };
            all.push(Dense { accessor, bytes });
        }
        Ok(all)
    }
}

/// Writers that leave all attributes outside the stream, as for sparse accessors, store indices of
/// a mesh without points. The decoder wants points for them; indices are a byte each then, as they
/// are for up to 255 points.
fn with_points(bytes: &[u8]) -> Cow<'_, [u8]> {
    const HEADER: usize = 11;
    const SEQUENTIAL: u8 = 0;
    let is_sequential = bytes.get(8) == Some(&SEQUENTIAL);
    let faces = bytes.get(HEADER..).unwrap_or_default();
    let points = HEADER + faces.iter().take_while(|b| **b >= 128).count() + 1;
    if !is_sequential || bytes.get(points) != Some(&0) {
        return Cow::Borrowed(bytes);
    }
    let (head, rest) = bytes.split_at(points);
    Cow::Owned([head, &[0xFF, 0x01], &rest[1..]].concat())
}

/// Numbers as a view would store them.
fn encode(component: Component, values: impl Iterator<Item = f32>) -> Vec<u8> {
    match component {
        Component::I8 => values.map(|v| v as i8 as u8).collect(),
        Component::U8 => values.map(|v| v as u8).collect(),
        Component::I16 => values.flat_map(|v| (v as i16).to_le_bytes()).collect(),
        Component::U16 => values.flat_map(|v| (v as u16).to_le_bytes()).collect(),
        Component::U32 => values.flat_map(|v| (v as u32).to_le_bytes()).collect(),
        Component::F32 => values.flat_map(f32::to_le_bytes).collect(),
    }
}
