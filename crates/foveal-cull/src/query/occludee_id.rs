//! Names of occludees in a set.

use core::num::NonZeroU32;

/// The id of one occludee of an [`OccludeeSet`](crate::OccludeeSet).
///
/// Generational, as [`OccluderId`](crate::OccluderId): the id of a removed occludee never names
/// another one. An id is valid only in the set that gave it out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OccludeeId {
    pub(super) slot: u32,
    pub(super) generation: NonZeroU32,
}

impl OccludeeId {
    /// The place of its result in the results of
    /// [`Culler::query_set`](crate::Culler::query_set). It does not change.
    #[must_use]
    pub fn index(self) -> usize {
        self.slot as usize
    }

    /// The id as one number, never zero, for engines that keep ids of their own.
    #[must_use]
    pub fn to_bits(self) -> u64 {
        u64::from(self.generation.get()) << 32 | u64::from(self.slot)
    }

    /// The id of [`to_bits`](Self::to_bits). Numbers that come from elsewhere name no occludee, or
    /// another one.
    #[must_use]
    pub fn from_bits(bits: u64) -> Option<Self> {
        Some(Self {
            slot: bits as u32,
            generation: NonZeroU32::new((bits >> 32) as u32)?,
        })
    }
}
