//! Morph targets and joint influences of one primitive.

use glam::Vec3;

use super::accessor::Component;
use super::meshes::PrimitiveDef;
use super::reader::Reader;
use crate::error::{Flaw, Parsed};
use crate::pose::{Influences, MorphTarget, Shape};
use crate::{Code, Warning};

/// Reads what deforms a primitive; `None` for rigid ones. `source` names each vertex's number in
/// the file.
pub(crate) fn read_shape(
    def: &PrimitiveDef,
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
            let list = reader.floats::<3>(accessor).map_err(|e| place(e, name))?;
            let pick = |&i: &u32| {
                let delta = list.get(i as usize).copied().map(Vec3::from)?;
                Some(if delta.is_finite() { delta } else { Vec3::ZERO })
            };
            source
                .iter()
                .map(pick)
                .collect::<Option<_>>()
                .ok_or_else(|| {
                    place(
                        Flaw::new(
                            Code::AccessorCount,
                            format!("has only {} elements", list.len()),
                        ),
                        name,
                    )
                })
        };
        if !target.uv.is_empty() || target.color.is_some() {
            notes.push(Warning::new(
                Code::MorphIgnored,
                format!(
                    "targets[{i}] morphs texture coordinates or colours, which stay as they are"
                ),
            ));
        }
        targets.push(MorphTarget {
            positions: deltas(target.position, "POSITION")?,
            normals: deltas(target.normal, "NORMAL")?,
            tangents: deltas(target.tangent, "TANGENT")?,
        });
    }
    Ok(Some(Shape {
        targets,
        influences,
        ..Shape::default()
    }))
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
