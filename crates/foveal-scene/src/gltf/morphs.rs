//! Morph targets and joint influences of one primitive.

use glam::{Vec2, Vec3, Vec4};

use super::accessor::Component;
use super::materials::UvSets;
use super::meshes::PrimitiveDef;
use super::reader::Reader;
use crate::error::{Flaw, Parsed};
use crate::pose::{Influences, MorphTarget, Shape};
use crate::{Code, Warning};

/// Reads what deforms a primitive; `None` for rigid ones. `source` names each vertex's number in
/// the file, `uv_sets` the sets of texture coordinates that vertices have.
pub(crate) fn read_shape(
    def: &PrimitiveDef,
    uv_sets: UvSets,
    reader: Reader<'_>,
    source: &[u32],
    notes: &mut Vec<Warning>,
) -> Parsed<Option<Shape>> {
    let influences = read_influences(def, reader, source, notes)?;
    if influences.is_none() && def.targets.is_empty() {
        return Ok(None);
    }
    let mut targets = Vec::with_capacity(def.targets.len());
    for (i, target) in def.targets.iter().enumerate() {
        let place = |e: Flaw, name: &str| e.under(format_args!("targets[{i}].{name}"));
        let deltas = |accessor: Option<u32>, name: &str| -> Parsed<Vec<Vec3>> {
            let Some(accessor) = accessor else {
                return Ok(Vec::new());
            };
            let list = reader.floats::<3>(accessor);
            let list = list.and_then(|list| pick(&list, source));
            list.map(|l| l.into_iter().map(Vec3::from).collect())
                .map_err(|e| place(e, name))
        };
        // Sorted: a file may have as many sets as it likes.
        let sets = &def.attributes.uv;
        let has_base = |set: &u32| sets.binary_search_by_key(set, |(base, _)| *base).is_ok();
        let lacks_base = target.uv.iter().any(|(set, _)| !has_base(set))
            || target.color.is_some() && def.attributes.color.is_none();
        if lacks_base {
            notes.push(Warning::new(
                Code::MorphIgnored,
                format!(
                    "targets[{i}] morphs texture coordinates or colours that the primitive does not have"
                ),
            ));
        }
        let mut uvs = [Vec::new(), Vec::new()];
        for (uvs, set) in uvs.iter_mut().zip(uv_sets) {
            let of_set = |(number, _): &&(u32, u32)| Some(*number) == set;
            let Some(&(set, accessor)) = target.uv.iter().find(of_set) else {
                continue;
            };
            if has_base(&set) {
                let list = reader.floats::<2>(accessor);
                let list = list.and_then(|list| pick(&list, source));
                *uvs = list
                    .map(|l| l.into_iter().map(Vec2::from).collect())
                    .map_err(|e| place(e, &format!("TEXCOORD_{set}")))?;
            }
        }
        let colors = match target.color.filter(|_| def.attributes.color.is_some()) {
            Some(accessor) => color_deltas(reader, accessor)
                .and_then(|list| pick(&list, source))
                .map(|l| l.into_iter().map(Vec4::from).collect())
                .map_err(|e| place(e, "COLOR_0"))?,
            None => Vec::new(),
        };
        targets.push(MorphTarget {
            positions: deltas(target.position, "POSITION")?,
            normals: deltas(target.normal, "NORMAL")?,
            tangents: deltas(target.tangent, "TANGENT")?,
            uvs,
            colors,
        });
    }
    Ok(Some(Shape {
        targets,
        influences,
        ..Shape::default()
    }))
}

/// The differences of the vertices that are kept; those that are no numbers are none.
fn pick<const N: usize>(list: &[[f32; N]], source: &[u32]) -> Parsed<Vec<[f32; N]>> {
    let one = |&i: &u32| {
        let delta = *list.get(i as usize)?;
        let finite = delta.iter().all(|x| x.is_finite());
        Some(if finite { delta } else { [0.0; N] })
    };
    let picked: Option<_> = source.iter().map(one).collect();
    picked.ok_or_else(|| {
        Flaw::new(
            Code::AccessorCount,
            format!("has only {} elements", list.len()),
        )
    })
}

/// Differences of linear RGBA; of RGB alpha stays.
fn color_deltas(reader: Reader<'_>, accessor: u32) -> Parsed<Vec<[f32; 4]>> {
    if reader.accessor(accessor).width == 3 {
        let list = reader.floats::<3>(accessor)?;
        Ok(list.into_iter().map(|[r, g, b]| [r, g, b, 0.0]).collect())
    } else {
        reader.floats::<4>(accessor)
    }
}

fn read_influences(
    def: &PrimitiveDef,
    reader: Reader<'_>,
    source: &[u32],
    notes: &mut Vec<Warning>,
) -> Parsed<Option<Influences>> {
    let attributes = &def.attributes;
    for set in 0..2 {
        if attributes.joints[set].is_some() != attributes.weights[set].is_some() {
            notes.push(Warning::new(
                Code::Skin,
                format!("has only one of JOINTS_{set} and WEIGHTS_{set}, which is ignored"),
            ));
        }
    }
    if attributes.joints[0].is_none() || attributes.weights[0].is_none() {
        return Ok(None);
    }
    if attributes.more_joints {
        notes.push(Warning::new(
            Code::Skin,
            "has more than eight joint influences per vertex; the first eight are used",
        ));
    }
    let mut joints = vec![[0u16; 8]; source.len()];
    let mut weights = vec![[0f32; 8]; source.len()];
    for set in 0..2 {
        let (Some(j), Some(w)) = (attributes.joints[set], attributes.weights[set]) else {
            continue;
        };
        let place = |e: Flaw, name: &str| e.under(format_args!("attributes.{name}_{set}"));
        if reader.accessor(j).component == Component::U32 {
            return Err(place(
                Flaw::new(Code::AccessorType, "is not of 8- or 16-bit integers"),
                "JOINTS",
            ));
        }
        let j = reader.uints::<4>(j).map_err(|e| place(e, "JOINTS"))?;
        let w = reader.floats::<4>(w).map_err(|e| place(e, "WEIGHTS"))?;
        for (i, &from) in source.iter().enumerate() {
            let (Some(j), Some(w)) = (j.get(from as usize), w.get(from as usize)) else {
                return Err(place(
                    Flaw::new(
                        Code::AccessorCount,
                        format!("has only {} elements", j.len().min(w.len())),
                    ),
                    "JOINTS",
                ));
            };
            for k in 0..4 {
                joints[i][set * 4 + k] = j[k] as u16;
                weights[i][set * 4 + k] = if w[k].is_finite() { w[k].max(0.0) } else { 0.0 };
            }
        }
    }
    for list in &mut weights {
        let sum: f32 = list.iter().sum();
        if sum > 0.0 && sum.is_finite() {
            list.iter_mut().for_each(|w| *w /= sum);
        } else {
            *list = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        }
    }
    Ok(Some(Influences { joints, weights }))
}
