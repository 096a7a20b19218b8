//! Wavefront OBJ.
//!
//! Read here and not by the crate `tobj` (4.0.5), which refuses what exporters write (comments after
//! faces, bytes that are not UTF-8, `usemtl` without a name), fills lines as if they were polygons,
//! and takes memory without bound for short files.
//! Lines become lists of two vertices each.

use std::collections::HashMap;
use std::num::IntErrorKind::{NegOverflow, PosOverflow};

use serde_json::json;

use super::builder::{Builder, plain_surface};
use super::libraries::{MAX_LIBRARIES, Materials, TOO_MANY_LIBRARIES};
use super::lines::{Line, as_utf8, lines, name_of, uncommented};
use super::numbers::{not_a_number, parsed};
use super::polygons::Polygons;
use super::smoothing::{Corner, Smoothing};
use super::{Converted, Refusal, check_memory, linear};
use crate::error::Limit;
use crate::gltf::Resolver;
use crate::{Code, LoadOptions, Warning};

/// What an object, and a material, takes while it is imported, in bytes.
const OBJECT_BYTES: u64 = 16 << 10;
const MATERIAL_BYTES: u64 = 8 << 10;

/// Bytes at the beginning by which text is told from what is none.
const BYTES_OF_TEXT: usize = 1 << 10;

/// Triangles, lines or points.
#[derive(Default)]
struct Shapes {
    corners: Vec<Corner>,
    number_of: HashMap<Corner, u32>,
    indices: Vec<u32>,
}

impl Shapes {
    /// The number of a corner, which is added where it is new.
    fn number(&mut self, corner: Corner) -> u32 {
        let next = self.corners.len() as u32;
        let number = *self.number_of.entry(corner).or_insert(next);
        if number == next {
            self.corners.push(corner);
        }
        number
    }
}

/// What has one name and one material.
#[derive(Default)]
struct Group {
    name: String,
    material: Option<u32>,
    triangles: Shapes,
    lines: Shapes,
    points: Shapes,
}

/// glTF's modes of primitives.
pub(super) const POINTS: u32 = 0;
pub(super) const LINES: u32 = 1;
pub(super) const TRIANGLES: u32 = 4;

#[derive(Default)]
struct File {
    positions: Vec<[f32; 3]>,
    /// As displays show them; as many as positions, where all have one.
    colors: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    smoothing: Smoothing,
    groups: Vec<Group>,
    libraries: Vec<String>,
    /// Names of materials, in the order of their first use.
    used: Vec<String>,
    /// Corners of the face that is read, their numbers in its group, and where they lie.
    face: Vec<Corner>,
    numbers: Vec<u32>,
    places: Vec<[f32; 3]>,
    /// Faces, lines and points.
    shapes: usize,
    dropped: usize,
    not_drawn: usize,
}

/// One object per group and material; polygons are cut into triangles. Of a file of vertices alone each
/// is a point.
pub(super) fn convert(
    bytes: &[u8],
    name: &str,
    options: &LoadOptions,
    resolver: &Resolver<'_>,
) -> Result<Converted, Refusal> {
    let bytes = &as_utf8(bytes)[..];
    if bytes.iter().take(BYTES_OF_TEXT).any(|&byte| byte == 0) {
        let cause = "has bytes of 0: it is no text, or UTF-16 without a byte order mark";
        return Err(cause.to_owned().into());
    }
    let mut file = File::parse(bytes, options)?;
    if file.shapes + file.not_drawn == 0 && !file.positions.is_empty() {
        file.add_cloud();
    }
    let mut notes = Vec::new();
    let mut builder = Builder::default();
    check_memory(
        "materials",
        file.used.len(),
        MATERIAL_BYTES,
        bytes.len(),
        options,
    )?;
    let materials = file.add_materials(name, resolver, &mut builder, &mut notes);
    if file.dropped > 0 {
        let text = format!(
            "{} of {} faces, lines and points have too few corners or name vertices that do not exist, \
             and are left out",
            file.dropped, file.shapes
        );
        notes.push(Warning::new(Code::TrianglesUnusable, text));
    }
    if file.not_drawn > 0 {
        let text = format!(
            "has {} free-form curves and surfaces, which are not drawn",
            file.not_drawn
        );
        notes.push(Warning::new(Code::PrimitiveMode, text));
    }
    let of_library = |group: &Group| group.material.and_then(|m| materials[m as usize]);
    let mut plain = None;
    for group in &file.groups {
        let material = of_library(group)
            .unwrap_or_else(|| *plain.get_or_insert_with(|| builder.material(&plain_surface())));
        file.add_group(group, material, &mut builder, &mut notes);
    }
    builder.finish(notes)
}

impl File {
    fn parse(bytes: &[u8], options: &LoadOptions) -> Result<Self, Refusal> {
        let mut file = Self {
            smoothing: Smoothing::of_file(bytes),
            ..Self::default()
        };
        let mut polygons = Polygons::of_file(bytes.len());
        let mut name = String::new();
        let mut material = None;
        let mut group_of: HashMap<(String, Option<u32>), usize> = HashMap::new();
        let mut number_of: HashMap<String, u32> = HashMap::new();
        let mut current: Option<usize> = None;
        for Line { text, number } in lines(bytes) {
            let (key, rest) = text.split_once(char::is_whitespace).unwrap_or((&text, ""));
            let rest = rest.trim();
            let broken = |cause: &str| Refusal::Broken(format!("line {number}: {cause}"));
            match key {
                "v" => file.add_position(rest).map_err(|e| broken(&e))?,
                "vt" => {
                    let [u, v] = floats::<2>(rest, 1).map_err(|e| broken(&e))?;
                    // Rows are counted from below.
                    file.uvs.push([u, 1.0 - v]);
                }
                "vn" => file.normals.push(floats(rest, 3).map_err(|e| broken(&e))?),
                "o" | "g" => {
                    name = name_of(rest);
                    current = None;
                }
                "usemtl" => {
                    let name = name_of(rest);
                    material = (!name.is_empty()).then(|| {
                        let known = number_of.len() as u32;
                        *number_of.entry(name).or_insert_with_key(|name| {
                            file.used.push(name.clone());
                            known
                        })
                    });
                    current = None;
                }
                "mtllib" => {
                    let line = uncommented(rest);
                    if file.libraries.iter().any(|library| library == line) {
                        continue;
                    }
                    if file.libraries.len() == MAX_LIBRARIES {
                        return Err(broken(TOO_MANY_LIBRARIES));
                    }
                    file.libraries.push(line.to_owned());
                }
                "f" | "fo" | "l" | "p" => {
                    let group = *current.get_or_insert_with(|| {
                        *group_of.entry((name.clone(), material)).or_insert_with(|| {
                            file.groups.push(Group {
                                name: name.clone(),
                                material,
                                ..Group::default()
                            });
                            file.groups.len() - 1
                        })
                    });
                    match key {
                        "l" => file.add_line(group, rest),
                        "p" => file.add_points(group, rest),
                        _ => file.add_face(group, rest, &mut polygons),
                    }
                    .map_err(|e| broken(&e))?;
                    if file.groups.len() as u64 > options.max_instances {
                        let cause = format!(
                            "wants more objects than the limit of {}",
                            options.max_instances
                        );
                        return Err(Refusal::TooLarge(Some(Limit::Instances), cause));
                    }
                }
                "s" => file.smoothing.set(rest),
                "curv" | "curv2" | "surf" => file.not_drawn += 1,
                _ => {}
            }
        }
        check_memory(
            "objects",
            file.groups.len(),
            OBJECT_BYTES,
            bytes.len(),
            options,
        )?;
        Ok(file)
    }

    fn add_position(&mut self, text: &str) -> Result<(), String> {
        let words = text.split_whitespace().take_while(|w| !w.starts_with('#'));
        let numbers: Vec<f32> = words.take(7).map(parsed).collect::<Result<_, _>>()?;
        let [x, y, z, rest @ ..] = &numbers[..] else {
            return Err("a vertex has fewer than three numbers".to_owned());
        };
        // A colour, and its opacity, follow where there are three numbers more; one is a weight.
        if let [r, g, b, ..] = rest
            && self.colors.len() == self.positions.len()
        {
            self.colors.push([*r, *g, *b]);
        }
        self.positions.push([*x, *y, *z]);
        Ok(())
    }

    /// Adds the triangles of a polygon; one that names what does not exist is counted.
    fn add_face(
        &mut self,
        group: usize,
        text: &str,
        polygons: &mut Polygons,
    ) -> Result<(), String> {
        self.shapes += 1;
        let counts = self.counts();
        self.face.clear();
        for word in text.split_whitespace().take_while(|w| !w.starts_with('#')) {
            let Some(corner) = corner(word, counts)? else {
                self.face.clear();
                break;
            };
            self.face.push(corner);
        }
        // Corners of a face that is left out would count among those without normals.
        if self.face.len() < 3 {
            self.dropped += 1;
            return Ok(());
        }
        let places = self.face.iter().map(|c| self.positions[c.0 as usize]);
        self.places.clear();
        self.places.extend(places);
        self.smoothing.add(&mut self.face, &self.places);
        let group = &mut self.groups[group].triangles;
        self.numbers.clear();
        let numbers = self.face.iter().map(|&corner| group.number(corner));
        self.numbers.extend(numbers);
        polygons.cut(&self.places, |triangle| {
            group.indices.extend(triangle.map(|i| self.numbers[i]));
        });
        Ok(())
    }

    /// Adds the segments of a line; one that names what does not exist is counted.
    fn add_line(&mut self, group: usize, text: &str) -> Result<(), String> {
        self.shapes += 1;
        let counts = self.counts();
        let lines = &mut self.groups[group].lines;
        let before = lines.indices.len();
        let mut last = None;
        for word in text.split_whitespace().take_while(|w| !w.starts_with('#')) {
            let Some((position, uv, _)) = corner(word, counts)? else {
                lines.indices.truncate(before);
                break;
            };
            let number = lines.number((position, uv, None));
            if let Some(last) = last.replace(number) {
                lines.indices.extend([last, number]);
            }
        }
        self.dropped += usize::from(lines.indices.len() == before);
        Ok(())
    }

    /// Adds points; those that do not exist are counted.
    fn add_points(&mut self, group: usize, text: &str) -> Result<(), String> {
        let counts = self.counts();
        let points = &mut self.groups[group].points;
        for word in text.split_whitespace().take_while(|w| !w.starts_with('#')) {
            self.shapes += 1;
            match corner(word, counts)? {
                Some((position, uv, _)) => {
                    let number = points.number((position, uv, None));
                    points.indices.push(number);
                }
                None => self.dropped += 1,
            }
        }
        Ok(())
    }

    /// Adds a point for each vertex.
    fn add_cloud(&mut self) {
        let numbers = 0..self.positions.len() as u32;
        let points = Shapes {
            corners: numbers.clone().map(|i| (i, None, None)).collect(),
            indices: numbers.collect(),
            ..Shapes::default()
        };
        self.groups.push(Group {
            points,
            ..Group::default()
        });
    }

    fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.uvs.len(), self.normals.len()]
    }

    /// Adds the materials that faces use; returns the number of each in the document.
    fn add_materials(
        &self,
        name: &str,
        resolver: &Resolver<'_>,
        builder: &mut Builder,
        notes: &mut Vec<Warning>,
    ) -> Vec<Option<usize>> {
        let mut materials = Materials::new(&self.used, resolver, builder, notes);
        for line in &self.libraries {
            materials.read(line);
        }
        materials.read_own(name);
        materials.finish()
    }

    fn add_group(
        &self,
        group: &Group,
        material: usize,
        builder: &mut Builder,
        notes: &mut Vec<Warning>,
    ) {
        let mut primitives = Vec::new();
        let kinds = [
            (&group.triangles, TRIANGLES),
            (&group.lines, LINES),
            (&group.points, POINTS),
        ];
        for (shapes, mode) in kinds {
            if shapes.indices.is_empty() {
                continue;
            }
            let attributes = self.attributes(&shapes.corners, &group.name, builder, notes);
            primitives.push(json!({
                "attributes": attributes, "indices": builder.indices(&shapes.indices), "mode": mode,
                "material": material
            }));
        }
        if !primitives.is_empty() {
            builder.object(&group.name, primitives);
        }
    }

    /// The attributes of these corners.
    fn attributes(
        &self,
        corners: &[Corner],
        object: &str,
        builder: &mut Builder,
        notes: &mut Vec<Warning>,
    ) -> serde_json::Value {
        let positions: Vec<[f32; 3]> = corners
            .iter()
            .map(|c| self.positions[c.0 as usize])
            .collect();
        let mut attributes = json!({ "POSITION": builder.vectors(&positions) });
        let with_normal = corners.iter().filter(|c| c.2.is_some()).count();
        if with_normal == corners.len() {
            let normal = |i| self.smoothing.normal(i, &self.normals);
            let of = |c: &Corner| c.2.map_or([0.0; 3], normal);
            let normals: Vec<[f32; 3]> = corners.iter().map(of).collect();
            attributes["NORMAL"] = json!(builder.vectors(&normals));
        } else if with_normal > 0 {
            let text = format!("object {object}: not all faces have normals; all are made anew");
            notes.push(Warning::new(Code::Normals, text));
        }
        if corners.iter().any(|c| c.1.is_some()) {
            let of = |c: &Corner| c.1.map_or([0.0; 2], |i| self.uvs[i as usize]);
            let uvs: Vec<[f32; 2]> = corners.iter().map(of).collect();
            attributes["TEXCOORD_0"] = json!(builder.vectors(&uvs));
        }
        if !self.colors.is_empty() && self.colors.len() == self.positions.len() {
            let of = |c: &Corner| self.colors[c.0 as usize].map(linear);
            let colors: Vec<[f32; 3]> = corners.iter().map(of).collect();
            attributes["COLOR_0"] = json!(builder.vectors(&colors));
        }
        attributes
    }
}

/// `N` numbers, of which `least` must be there; the others are 0.
fn floats<const N: usize>(text: &str, least: usize) -> Result<[f32; N], String> {
    let mut out = [0.0; N];
    let words = text.split_whitespace().take_while(|w| !w.starts_with('#'));
    let mut count = 0;
    for (slot, word) in out.iter_mut().zip(words) {
        *slot = parsed(word)?;
        count += 1;
    }
    if count < least {
        return Err(format!("has {count} numbers instead of {least}"));
    }
    Ok(out)
}

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; `None` where it names what does not exist. Texture
/// coordinates and normals that do not exist are left out.
fn corner(word: &str, counts: [usize; 3]) -> Result<Option<Corner>, String> {
    let mut numbers = [None; 3];
    for ((slot, part), count) in numbers.iter_mut().zip(word.split('/')).zip(counts) {
        if part.is_empty() {
            continue;
        }
        let number: i64 = match part.parse::<i64>() {
            Ok(number) => number,
            // So many there are not.
            Err(e) if matches!(e.kind(), PosOverflow | NegOverflow) => continue,
            Err(_) => return Err(not_a_number(part)),
        };
        let count = count as i64;
        // From 1 on, or backwards from the last one so far.
        let index = if number < 0 {
            count + number
        } else {
            number - 1
        };
        *slot = (0..count).contains(&index).then_some(index as u32);
    }
    Ok(numbers[0].map(|position| (position, numbers[1], numbers[2])))
}
