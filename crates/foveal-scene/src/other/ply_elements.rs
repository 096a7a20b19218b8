//! Elements of PLY files: vertices, faces, triangle strips, edges.

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::linear;

/// Names of texture coordinates.
pub(super) const UVS: [[&str; 2]; 4] = [
    ["u", "v"],
    ["s", "t"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
];

/// A vertex, or a corner of a face with texture coordinates of its own.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    pub(super) position: [f32; 3],
    pub(super) normal: [f32; 3],
    /// Linear.
    pub(super) color: [f32; 3],
    /// The same by short names, which may mean something else: a radius.
    pub(super) rgb: [f32; 3],
    pub(super) uv: [f32; 2],
}

impl PropertyAccess for Corner {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = property.to_f32_lossy() else {
            return PropertyAccessResult::Ignored;
        };
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "red" | "diffuse_red" => return set_color(&mut self.color[0], &property, value),
            "green" | "diffuse_green" => return set_color(&mut self.color[1], &property, value),
            "blue" | "diffuse_blue" => return set_color(&mut self.color[2], &property, value),
            "r" => return set_color(&mut self.rgb[0], &property, value),
            "g" => return set_color(&mut self.rgb[1], &property, value),
            "b" => return set_color(&mut self.rgb[2], &property, value),
            _ => {
                let at = UVS
                    .iter()
                    .find_map(|pair| pair.iter().position(|n| *n == name));
                // Rows are counted from below.
                match at {
                    Some(0) => self.uv[0] = value,
                    Some(_) => self.uv[1] = 1.0 - value,
                    None => return PropertyAccessResult::Ignored,
                }
                return PropertyAccessResult::Set;
            }
        };
        *slot = value;
        PropertyAccessResult::Set
    }
}

/// Sets a colour's channel.
fn set_color(slot: &mut f32, property: &Property, value: f32) -> PropertyAccessResult {
    *slot = linear(channel(property, value));
    PropertyAccessResult::Set
}

/// A colour's channel from 0 to 1.
fn channel(property: &Property, value: f32) -> f32 {
    match property {
        Property::Float(_) | Property::Double(_) => value,
        Property::UShort(_) | Property::Short(_) => value / 65535.0,
        _ => value / 255.0,
    }
}

/// A polygon.
#[derive(Default)]
pub(super) struct Face {
    /// Numbers of vertices.
    pub(super) corners: Vec<u32>,
    /// u and v of each corner, where it has its own; rows are counted from below.
    pub(super) uvs: Vec<f32>,
    /// Number of the texture.
    pub(super) texture: u32,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            // Negative numbers name no vertex.
            "vertex_indices" | "vertex_index" => {
                self.corners = property.to_u32_list().unwrap_or_default();
            }
            "texcoord" => {
                self.uvs = match property {
                    Property::ListFloat(list) => list,
                    Property::ListDouble(list) => list.into_iter().map(|x| x as f32).collect(),
                    _ => Vec::new(),
                };
            }
            "texnumber" => self.texture = number_of(&property),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl Face {
    pub(super) fn has_own_uvs(&self) -> bool {
        self.uvs.len() == 2 * self.corners.len()
    }
}

/// Vertices of triangle strips.
#[derive(Default)]
pub(super) struct Strip {
    pub(super) corners: Vec<u32>,
}

impl Strip {
    /// The end of a strip: -1 in the file.
    pub(super) const END: u32 = u32::MAX;
}

impl PropertyAccess for Strip {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match property {
            Property::ListInt(list) => list.into_iter().map(|i| i as u32).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| i32::from(i) as u32).collect(),
            Property::ListChar(list) => list.into_iter().map(|i| i32::from(i) as u32).collect(),
            other => other.to_u32_list().unwrap_or_default(),
        };
        PropertyAccessResult::Set
    }
}

pub(super) struct Edge {
    pub(super) ends: [u32; 2],
}

impl PropertyAccess for Edge {
    fn new() -> Self {
        Self {
            ends: [u32::MAX; 2],
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let end = match name {
            "vertex1" => 0,
            "vertex2" => 1,
            _ => return PropertyAccessResult::Ignored,
        };
        self.ends[end] = number_of(&property);
        PropertyAccessResult::Set
    }
}

/// The number of a vertex or texture. Negative numbers, and what is none, name nothing.
fn number_of(property: &Property) -> u32 {
    let number = match *property {
        Property::Char(n) => u32::try_from(n).ok(),
        Property::Short(n) => u32::try_from(n).ok(),
        Property::Int(n) => u32::try_from(n).ok(),
        Property::UChar(n) => Some(n.into()),
        Property::UShort(n) => Some(n.into()),
        Property::UInt(n) => Some(n),
        _ => None,
    };
    number.unwrap_or(u32::MAX)
}

/// An element that is read and forgotten.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
