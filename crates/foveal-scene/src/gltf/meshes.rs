//! Definitions of meshes and their primitives.

use super::document::Counts;
use super::json::Obj;
use crate::error::{Flaw, Parsed};

/// What the vertices of a primitive make, as far as triangles can express it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Mode {
    Triangles,
    Strip,
    Fan,
    /// Points or lines.
    NoTriangles,
}

/// Attribute accessors that are read; all others are left alone.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub(crate) struct Attributes {
    pub(crate) position: Option<u32>,
    pub(crate) normal: Option<u32>,
    pub(crate) tangent: Option<u32>,
    pub(crate) color: Option<u32>,
    /// (set, accessor) pairs.
    pub(crate) uv: Vec<(u32, u32)>,
    pub(crate) joints: [Option<u32>; 2],
    pub(crate) weights: [Option<u32>; 2],
    /// JOINTS_2 or more: influences beyond the eighth.
    pub(crate) more_joints: bool,
}

/// One primitive.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct PrimitiveDef {
    pub(crate) attributes: Attributes,
    pub(crate) indices: Option<u32>,
    pub(crate) mode: Mode,
    pub(crate) targets: Vec<Attributes>,
}

/// A mesh as the file has it.
pub(crate) struct MeshDef {
    pub(crate) name: Option<String>,
    pub(crate) primitives: Vec<PrimitiveDef>,
    /// Per primitive.
    pub(crate) materials: Vec<Option<u32>>,
    pub(crate) weights: Vec<f32>,
}

impl MeshDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let mut materials = Vec::new();
        let primitives = o.objects("primitives", |p| {
            materials.push(p.index("material", counts.materials)?);
            parse_primitive(p, counts)
        })?;
        Ok(Self {
            name: o.string("name")?.map(str::to_owned),
            primitives,
            materials,
            weights: o.float_list("weights")?,
        })
    }

    /// The name of a primitive's mesh.
    pub(crate) fn label(&self, mesh: u32, primitive: usize) -> String {
        let name = self
            .name
            .clone()
            .filter(|n| !n.is_empty())
            .unwrap_or_else(|| format!("mesh {mesh}"));
        if self.primitives.len() > 1 {
            format!("{name}.{primitive}")
        } else {
            name
        }
    }
}

fn parse_primitive(o: Obj<'_>, counts: &Counts) -> Parsed<PrimitiveDef> {
    let attributes = o.need("attributes", o.object("attributes")?)?;
    Ok(PrimitiveDef {
        attributes: parse_attributes(attributes, counts).map_err(|e| e.under("attributes"))?,
        indices: o.index("indices", counts.accessors)?,
        mode: match o.uint("mode")? {
            Some(0..=3) => Mode::NoTriangles,
            None | Some(4) => Mode::Triangles,
            Some(5) => Mode::Strip,
            Some(6) => Mode::Fan,
            Some(other) => {
                return Err(Flaw::new(format!("is {other}, not a mode")).under("mode"));
            }
        },
        targets: o.objects("targets", |t| parse_attributes(t, counts))?,
    })
}

fn parse_attributes(o: Obj<'_>, counts: &Counts) -> Parsed<Attributes> {
    let mut found = Attributes::default();
    for (name, _) in o.entries() {
        let accessor = || o.index(name, counts.accessors);
        match name.as_str() {
            "POSITION" => found.position = accessor()?,
            "NORMAL" => found.normal = accessor()?,
            "TANGENT" => found.tangent = accessor()?,
            "COLOR_0" => found.color = accessor()?,
            "JOINTS_0" => found.joints[0] = accessor()?,
            "JOINTS_1" => found.joints[1] = accessor()?,
            "WEIGHTS_0" => found.weights[0] = accessor()?,
            "WEIGHTS_1" => found.weights[1] = accessor()?,
            other => {
                if let Some(set) = other.strip_prefix("TEXCOORD_") {
                    // `TEXCOORD_x` and the like are the author's own attributes.
                    if let (Ok(set), Some(accessor)) = (set.parse(), accessor()?) {
                        found.uv.push((set, accessor));
                    }
                }
                found.more_joints |= other.starts_with("JOINTS_");
            }
        }
    }
    found.uv.sort_unstable();
    Ok(found)
}
