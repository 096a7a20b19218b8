//! Definitions of meshes and their primitives.

use std::collections::HashSet;

use super::document::Counts;
use super::draco::DracoDef;
use super::json::Obj;
use crate::Code;
use crate::error::{Flaw, Parsed};

/// What the vertices of a primitive make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Mode {
    Points,
    Lines,
    LineLoop,
    LineStrip,
    Triangles,
    Strip,
    Fan,
}

impl Mode {
    /// Corners of each of its things: 1 of a point, 2 of a line, 3 of a triangle.
    pub(crate) fn corners(self) -> usize {
        match self {
            Self::Points => 1,
            Self::Lines | Self::LineLoop | Self::LineStrip => 2,
            Self::Triangles | Self::Strip | Self::Fan => 3,
        }
    }

    pub(crate) fn makes_triangles(self) -> bool {
        self.corners() == 3
    }

    /// The most corners that lists of it have for this many corners of the file.
    pub(crate) fn corners_in_lists(self, named: u64) -> u64 {
        match self {
            Self::Points | Self::Lines | Self::Triangles => named,
            Self::LineLoop | Self::LineStrip => named.saturating_mul(2),
            Self::Strip | Self::Fan => named.saturating_mul(3),
        }
    }
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

impl Attributes {
    /// The accessors of all of them.
    pub(crate) fn read(&self) -> HashSet<u64> {
        let mut copy = self.clone();
        copy.accessors()
            .map(|accessor| u64::from(*accessor))
            .collect()
    }

    fn accessors(&mut self) -> impl Iterator<Item = &mut u32> {
        let single = [
            &mut self.position,
            &mut self.normal,
            &mut self.tangent,
            &mut self.color,
        ];
        single
            .into_iter()
            .chain(&mut self.joints)
            .chain(&mut self.weights)
            .flatten()
            .chain(self.uv.iter_mut().map(|(_, accessor)| accessor))
    }
}

/// One primitive.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct PrimitiveDef {
    pub(crate) attributes: Attributes,
    pub(crate) indices: Option<u32>,
    pub(crate) mode: Mode,
    pub(crate) targets: Vec<Attributes>,
    /// Where attributes and indices without stored values come from.
    pub(crate) draco: Option<DracoDef>,
}

impl PrimitiveDef {
    /// Whether its tangents are the file's: they belong to normals of the file.
    pub(crate) fn has_tangents(&self) -> bool {
        self.attributes.tangent.is_some() && self.attributes.normal.is_some()
    }

    /// Whether it has morph targets or joints.
    pub(crate) fn deforms(&self) -> bool {
        !self.targets.is_empty() || self.attributes.joints.iter().flatten().count() > 0
    }
}

/// A mesh as the file has it.
pub(crate) struct MeshDef {
    pub(crate) name: Option<String>,
    pub(crate) primitives: Vec<PrimitiveDef>,
    /// Per primitive.
    pub(crate) materials: Vec<Option<u32>>,
    /// Per primitive, (variant, material).
    variants: Vec<Vec<(u32, u32)>>,
    pub(crate) weights: Vec<f32>,
    /// The most morph targets that one of its primitives has.
    pub(crate) target_count: usize,
}

impl MeshDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let mut materials = Vec::new();
        let mut variants = Vec::new();
        let primitives = o.objects("primitives", |p| {
            materials.push(p.index("material", counts.materials)?);
            variants.push(parse_variants(p, counts)?);
            parse_primitive(p, counts)
        })?;
        Ok(Self {
            name: o.name("name")?,
            target_count: primitives
                .iter()
                .map(|p| p.targets.len())
                .max()
                .unwrap_or(0),
            primitives,
            materials,
            variants,
            weights: o.float_list("weights")?,
        })
    }

    /// Gives each primitive the material of a variant, where it has one.
    pub(crate) fn choose_variant(&mut self, variant: u32) {
        for (material, variants) in self.materials.iter_mut().zip(&self.variants) {
            let found = variants.iter().find(|(number, _)| *number == variant);
            *material = found.map(|(_, material)| *material).or(*material);
        }
    }

    /// Replaces each accessor by the one that `first` names for it.
    pub(crate) fn renumber_accessors(&mut self, first: &[u32]) {
        let renumber = |accessor: &mut u32| *accessor = first[*accessor as usize];
        for primitive in &mut self.primitives {
            primitive.indices.iter_mut().for_each(renumber);
            let own = std::iter::once(&mut primitive.attributes);
            for attributes in own.chain(&mut primitive.targets) {
                attributes.accessors().for_each(renumber);
            }
        }
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

/// KHR_materials_variants: the material of each variant that has its own.
fn parse_variants(o: Obj<'_>, counts: &Counts) -> Parsed<Vec<(u32, u32)>> {
    let Some(extension) = o.extension("KHR_materials_variants")? else {
        return Ok(Vec::new());
    };
    let pairs = extension.objects("mappings", |m| {
        let material = m.need("material", m.index("material", counts.materials)?)?;
        let variants = m.indices("variants", counts.variants)?;
        Ok(variants.into_iter().map(move |variant| (variant, material)))
    });
    let pairs = pairs.map_err(|e| e.under("extensions.KHR_materials_variants"))?;
    Ok(pairs.into_iter().flatten().collect())
}

fn parse_primitive(o: Obj<'_>, counts: &Counts) -> Parsed<PrimitiveDef> {
    let names = o.need("attributes", o.object("attributes")?)?;
    let attributes = parse_attributes(names, counts).map_err(|e| e.under("attributes"))?;
    let indices = o.index("indices", counts.accessors)?;
    let draco = match o.extension("KHR_draco_mesh_compression")? {
        Some(e) => {
            let def = DracoDef::parse(e, counts.views, names, &attributes, indices);
            Some(def.map_err(|e| e.under("extensions.KHR_draco_mesh_compression"))?)
        }
        None => None,
    };
    Ok(PrimitiveDef {
        attributes,
        indices,
        draco,
        mode: match o.uint("mode")? {
            Some(0) => Mode::Points,
            Some(1) => Mode::Lines,
            Some(2) => Mode::LineLoop,
            Some(3) => Mode::LineStrip,
            None | Some(4) => Mode::Triangles,
            Some(5) => Mode::Strip,
            Some(6) => Mode::Fan,
            Some(other) => {
                return Err(
                    Flaw::new(Code::ValueUnknown, format!("is {other}, not a mode")).under("mode"),
                );
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
