//! Large boxes of cells, one after the other.
//!
//! Candidates are the boxes that add most to what all boxes so far cover of the mesh seen along its
//! three axes. For the first box that is half its surface, twice its mean outline over all
//! directions (Cauchy's formula). Every box of cells of twice the size is looked at; the best few
//! then grow by single cells.

use super::grid::{CELLS, Grid, Lattice, span};

/// Cells of twice the size along each axis.
const COARSE: usize = CELLS / 2;

/// Most candidates for the next box.
const CANDIDATES: usize = 8;

/// A box of cells, from its first along each axis to the first beyond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CellBox {
    pub(super) lo: [usize; 3],
    pub(super) hi: [usize; 3],
}

/// Boxes of the cells of a solid.
pub(super) struct Greedy<'a> {
    solid: &'a Grid,
    /// Rows of cells of twice the size that are solid as a whole.
    coarse: Vec<u32>,
    /// What no box covers yet, seen along each axis.
    open: [Silhouette; 3],
    /// Area of a cell seen along each axis.
    areas: [f64; 3],
}

impl<'a> Greedy<'a> {
    pub(super) fn new(solid: &'a Grid, lattice: &Lattice) -> Self {
        let row = |y: usize, z: usize| {
            let all = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .iter()
                .fold(u64::MAX, |all, (dy, dz)| {
                    all & solid.row(2 * y + dy, 2 * z + dz)
                });
            (0..COARSE).fold(0u32, |row, x| row | u32::from(all >> (2 * x) & 3 == 3) << x)
        };
        let c = lattice.cell;
        Self {
            solid,
            coarse: (0..COARSE * COARSE)
                .map(|i| row(i % COARSE, i / COARSE))
                .collect(),
            open: [const { Silhouette::OPEN }; 3],
            areas: [c.y * c.z, c.z * c.x, c.x * c.y],
        }
    }

    /// Candidates for the next box, none if no box adds anything.
    pub(super) fn candidates(&self) -> Vec<CellBox> {
        let mut candidates = Vec::new();
        for (_, mut candidate) in self.ranked() {
            self.grow(&mut candidate);
            if !candidates.contains(&candidate) {
                candidates.push(candidate);
            }
            if candidates.len() == CANDIDATES {
                break;
            }
        }
        candidates
    }

    /// Takes a box, which other boxes need not cover any more.
    pub(super) fn take(&mut self, taken: CellBox) {
        for (axis, open) in self.open.iter_mut().enumerate() {
            open.cover(taken.seen_along(axis));
        }
    }

    /// Of all ranges along z, the box of cells of twice the size that adds most, and how much; the
    /// best first.
    fn ranked(&self) -> Vec<(f64, CellBox)> {
        let sums = [0, 1, 2].map(|axis| self.open[axis].sums());
        let mut ranked = Vec::new();
        for z0 in 0..COARSE {
            let mut rows = [u32::MAX; COARSE];
            for z1 in z0..COARSE {
                for (row, solid) in rows.iter_mut().zip(&self.coarse[z1 * COARSE..]) {
                    *row &= solid;
                }
                // Not `all`: LLVM 22 has no instruction for what it makes of that for WebAssembly.
                if rows.iter().fold(0, |any, row| any | row) == 0 {
                    break;
                }
                ranked.extend(self.best_in(&sums, &rows, [2 * z0, 2 * z1 + 2]));
            }
        }
        ranked.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        ranked
    }

    /// The box that adds most of those that go from one z to another. `rows`: cells that are solid
    /// over all of that range.
    fn best_in(&self, sums: &[Sums; 3], rows: &[u32], z: [usize; 2]) -> Option<(f64, CellBox)> {
        let (mut most, mut best) = (0.0, None);
        for y0 in 0..COARSE {
            let mut all = u32::MAX;
            for (y1, row) in rows.iter().enumerate().skip(y0) {
                all &= row;
                if all == 0 {
                    break;
                }
                for x in runs(all) {
                    let candidate = CellBox {
                        lo: [x[0] * 2, y0 * 2, z[0]],
                        hi: [x[1] * 2, y1 * 2 + 2, z[1]],
                    };
                    let adds: f64 = [0, 1, 2]
                        .iter()
                        .map(|&axis| {
                            let new = sums[axis].within(candidate.seen_along(axis));
                            f64::from(new) * self.areas[axis]
                        })
                        .sum();
                    if adds > most {
                        (most, best) = (adds, Some((adds, candidate)));
                    }
                }
            }
        }
        best
    }

    /// Moves the sides of a box outwards, in turn, as long as all cells are solid.
    fn grow(&self, found: &mut CellBox) {
        let mut grown = true;
        while grown {
            grown = false;
            for axis in 0..3 {
                // No solid cell lies at the border of the grid.
                let mut layer = *found;
                (layer.lo[axis], layer.hi[axis]) = (found.lo[axis] - 1, found.lo[axis]);
                if self.solid.has_all(layer.lo, layer.hi) {
                    found.lo[axis] -= 1;
                    grown = true;
                }
                (layer.lo[axis], layer.hi[axis]) = (found.hi[axis], found.hi[axis] + 1);
                if self.solid.has_all(layer.lo, layer.hi) {
                    found.hi[axis] += 1;
                    grown = true;
                }
            }
        }
    }
}

/// The runs of bits that are set, each from its first to the first beyond.
fn runs(mut left: u32) -> impl Iterator<Item = [usize; 2]> {
    core::iter::from_fn(move || {
        let from = (left != 0).then(|| left.trailing_zeros())?;
        let to = from + (left >> from).trailing_ones();
        left = left.checked_shr(to).map_or(0, |rest| rest << to);
        Some([from as usize, to as usize])
    })
}

impl CellBox {
    /// Its rectangle along an axis: first and last of the next axis, then of the one after.
    fn seen_along(&self, axis: usize) -> [usize; 4] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        [self.lo[u], self.hi[u], self.lo[v], self.hi[v]]
    }
}

/// Cells seen along an axis, one bit each.
struct Silhouette([u64; CELLS]);

impl Silhouette {
    const OPEN: Self = Self([u64::MAX; CELLS]);

    fn cover(&mut self, [u0, u1, v0, v1]: [usize; 4]) {
        for row in &mut self.0[v0..v1] {
            *row &= !span(u0, u1);
        }
    }

    fn sums(&self) -> Sums {
        let mut sums = vec![0u32; (CELLS + 1) * (CELLS + 1)];
        for (v, row) in self.0.iter().enumerate() {
            let mut along = 0;
            for u in 0..CELLS {
                along += (row >> u & 1) as u32;
                sums[(v + 1) * (CELLS + 1) + u + 1] = sums[v * (CELLS + 1) + u + 1] + along;
            }
        }
        Sums(sums)
    }
}

/// Numbers of cells between the first and any other (a summed-area table).
struct Sums(Vec<u32>);

impl Sums {
    fn within(&self, [u0, u1, v0, v1]: [usize; 4]) -> u32 {
        let at = |u: usize, v: usize| self.0[v * (CELLS + 1) + u];
        at(u1, v1) + at(u0, v0) - at(u0, v1) - at(u1, v0)
    }
}
