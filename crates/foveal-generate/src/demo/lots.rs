//! From a lot of the plan to its place in the world and its own chance.

use glam::{Mat4, Vec3};

use super::plan::Lot;
use crate::hash::{Rng, mix};
use crate::trig::stand;

/// World from the lot's space: x along the front, z out of it towards the lane.
pub(super) fn lot_place(lot: &Lot) -> Mat4 {
    stand(Vec3::new(lot.front_x, 0.0, lot.z), -0.25 * lot.side)
}

/// The lot's own stream of chance for a `purpose`: it does not depend on the quarter's size.
pub(super) fn lot_rng(seed: u64, lot: &Lot, purpose: u64) -> Rng {
    let key = [
        lot.lane as u64,
        lot.side.to_bits().into(),
        lot.z.to_bits().into(),
        purpose,
    ]
    .into_iter()
    .fold(0, |key, part| mix(key ^ part));
    Rng::new(seed, key)
}
