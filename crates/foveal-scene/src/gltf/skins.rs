//! Skins: joints and inverse bind matrices.

use glam::Mat4;

use super::accessor::Component;
use super::document::Counts;
use super::json::Obj;
use super::reader::Reader;
use crate::Code;
use crate::error::{Flaw, Parsed};
use crate::pose::Skin;

/// A skin as the file has it. `skeleton` is a hint that nothing here needs.
pub(crate) struct SkinDef {
    pub(crate) joints: Vec<u32>,
    inverse_bind: Option<u32>,
}

impl SkinDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        Ok(Self {
            joints: o.indices("joints", counts.nodes)?,
            inverse_bind: o.index("inverseBindMatrices", counts.accessors)?,
        })
    }

    /// The skin with its matrices; identity matrices where the file gives none.
    pub(crate) fn read(&self, reader: Reader<'_>) -> Parsed<Skin> {
        if self.joints.is_empty() {
            return Err(Flaw::new(Code::Skin, "is empty").under("joints"));
        }
        let count = self.inverse_bind.map_or(0, |a| reader.accessor(a).count);
        let bytes = 128 * count.max(self.joints.len()) as u64;
        reader.buffers.budget.take(bytes, "joints")?;
        let inverse_bind = match self.inverse_bind {
            Some(accessor) => {
                if reader.accessor(accessor).component != Component::F32 {
                    return Err(Flaw::new(Code::AccessorType, "is not of 32-bit floats")
                        .under("inverseBindMatrices"));
                }
                reader
                    .floats::<16>(accessor)
                    .map_err(|e| e.under("inverseBindMatrices"))?
                    .iter()
                    .map(Mat4::from_cols_array)
                    .collect()
            }
            None => vec![Mat4::IDENTITY; self.joints.len()],
        };
        if inverse_bind.len() < self.joints.len() {
            return Err(Flaw::new(
                Code::Skin,
                format!(
                    "has {} matrices for {} joints",
                    inverse_bind.len(),
                    self.joints.len()
                ),
            )
            .under("inverseBindMatrices"));
        }
        if !inverse_bind.iter().all(|m| m.is_finite()) {
            return Err(Flaw::new(Code::Skin, "has a matrix that is not finite")
                .under("inverseBindMatrices"));
        }
        Ok(Skin {
            joints: self.joints.clone(),
            inverse_bind,
        })
    }
}
