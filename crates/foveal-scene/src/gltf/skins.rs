//! Skins: joints and inverse bind matrices.

use glam::Mat4;

use super::accessor::Component;
use super::document::Counts;
use super::json::Obj;
use super::reader::Reader;
use crate::Code;
use crate::error::{Flaw, Parsed};
use crate::pose::Skin;

/// A skin as the file has it.
pub(crate) struct SkinDef {
    /// Or why it cannot be used.
    parts: Parsed<Parts>,
}

/// What a skin names. `skeleton` is a hint that nothing here needs.
struct Parts {
    joints: Vec<u32>,
    inverse_bind: Option<u32>,
}

impl SkinDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Self {
        let parts = || {
            Ok(Parts {
                joints: o.indices("joints", counts.nodes)?,
                inverse_bind: o.index("inverseBindMatrices", counts.accessors)?,
            })
        };
        Self { parts: parts() }
    }

    /// Fails where it cannot be used, as far as can be told without its matrices.
    pub(crate) fn check(&self, reader: Reader<'_>) -> Parsed<()> {
        self.checked(reader).map(|_| ())
    }

    fn checked(&self, reader: Reader<'_>) -> Parsed<&Parts> {
        let parts = self.parts.as_ref().map_err(Flaw::clone)?;
        let joints = parts.joints.len();
        if joints == 0 {
            return Err(Flaw::new(Code::Skin, "is empty").under("joints"));
        }
        let Some(accessor) = parts.inverse_bind.map(|a| reader.accessor(a)) else {
            return Ok(parts);
        };
        let flaw = |code, cause: String| Err(Flaw::new(code, cause).under("inverseBindMatrices"));
        if accessor.component != Component::F32 {
            return flaw(Code::AccessorType, "is not of 32-bit floats".to_owned());
        }
        if accessor.count < joints {
            let cause = format!("has {} matrices for {joints} joints", accessor.count);
            return flaw(Code::Skin, cause);
        }
        Ok(parts)
    }

    /// The skin with its matrices; identity matrices where the file gives none.
    pub(crate) fn read(&self, reader: Reader<'_>) -> Parsed<Skin> {
        let parts = self.checked(reader)?;
        let count = parts.inverse_bind.map_or(0, |a| reader.accessor(a).count);
        let bytes = 128 * count.max(parts.joints.len()) as u64;
        reader.buffers.budget.take(bytes, "joints")?;
        let inverse_bind: Vec<Mat4> = match parts.inverse_bind {
            Some(accessor) => reader
                .floats::<16>(accessor)
                .map_err(|e| e.under("inverseBindMatrices"))?
                .iter()
                .map(Mat4::from_cols_array)
                .collect(),
            None => vec![Mat4::IDENTITY; parts.joints.len()],
        };
        if !inverse_bind.iter().all(|m| m.is_finite()) {
            return Err(Flaw::new(Code::Skin, "has a matrix that is not finite")
                .under("inverseBindMatrices"));
        }
        Ok(Skin {
            joints: parts.joints.clone(),
            inverse_bind,
        })
    }
}
