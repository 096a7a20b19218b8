//! The cells inside a closed mesh.
//!
//! Cells side by side that no triangle comes near have the same winding number: the way from one
//! centre to the other crosses nothing. So one number is enough for all that hang together. It is
//! the sum of the solid angles of all triangles, which has no special cases, in contrast to rays
//! that may go through edges. Centres lie at least half a cell away from every triangle, so the sum
//! is a whole number but for rounding, and anything else is not trusted.

use super::grid::{CELLS, Grid, Lattice};
use glam::DVec3;

/// Parts with fewer cells are left out: they would be no large boxes.
const LEAST_CELLS: u32 = 512;
/// Most parts that are looked at, the largest first, since each looks at all triangles.
const MOST_PARTS: usize = 8;
/// Farthest from a whole number that a winding number may be.
const NOT_WHOLE: f64 = 1e-3;

/// The cells inside, of those that are not touched. Corners are in mesh space.
pub(super) fn inside<I: Iterator<Item = [DVec3; 3]>>(
    lattice: &Lattice,
    touched: &Grid,
    triangles: impl Fn() -> I,
) -> Grid {
    let mut free = touched.inverse();
    let mut parts = Vec::new();
    // Cells at the border are outside, and all that hang together with the first are no candidates.
    take_part(&mut free, [0; 3]);
    for z in 0..CELLS {
        for y in 0..CELLS {
            while free.row(y, z) != 0 {
                let seed = [free.row(y, z).trailing_zeros() as usize, y, z];
                let found = take_part(&mut free, seed);
                let count: u32 = found.iter().map(|(.., bits)| bits.count_ones()).sum();
                if count >= LEAST_CELLS {
                    parts.push((count, seed, found));
                }
            }
        }
    }
    parts.sort_by_key(|(count, seed, _)| (core::cmp::Reverse(*count), *seed));
    let mut solid = Grid::empty();
    for (_, seed, found) in parts.iter().take(MOST_PARTS) {
        let center = DVec3::from_array(seed.map(|c| c as f64 + 0.5));
        let number = winding_number(center, triangles().map(|t| t.map(|p| lattice.cells_of(p))));
        if number > 0.5 && (number - number.round()).abs() < NOT_WHOLE {
            for &(y, z, bits) in found {
                *solid.row_mut(y, z) |= bits;
            }
        }
    }
    solid
}

/// Takes the cells out that hang together with one, side by side: bits of rows, by y and z.
fn take_part(free: &mut Grid, seed: [usize; 3]) -> Vec<(usize, usize, u64)> {
    let mut found = Vec::new();
    let mut open = vec![(seed[1], seed[2], 1u64 << seed[0])];
    while let Some((y, z, bits)) = open.pop() {
        let row = free.row_mut(y, z);
        let new = spread(bits & *row, *row);
        if new == 0 {
            continue;
        }
        *row &= !new;
        found.push((y, z, new));
        let beside = [
            (y.wrapping_sub(1), z),
            (y + 1, z),
            (y, z.wrapping_sub(1)),
            (y, z + 1),
        ];
        for (y, z) in beside {
            if y < CELLS && z < CELLS && new & free.row(y, z) != 0 {
                open.push((y, z, new));
            }
        }
    }
    found
}

/// The bits of a row that hang together with some of them.
fn spread(mut bits: u64, row: u64) -> u64 {
    loop {
        let wider = (bits | bits << 1 | bits >> 1) & row;
        if wider == bits {
            return bits;
        }
        bits = wider;
    }
}

/// How often triangles wind around a point: the sum of their solid angles, in whole spheres (van
/// Oosterom and Strackee 1983, *The solid angle of a plane triangle*).
fn winding_number(point: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    let angle = |t: [DVec3; 3]| {
        let [a, b, c] = t.map(|p| p - point);
        let [la, lb, lc] = [a, b, c].map(DVec3::length);
        let volume = a.dot(b.cross(c));
        volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    triangles.map(angle).sum::<f64>() / core::f64::consts::TAU
}
