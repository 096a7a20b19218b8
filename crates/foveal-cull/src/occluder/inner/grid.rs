//! A grid of cells over a mesh, one bit per cell.

use glam::DVec3;

/// Cells along each axis, as many as a row has bits.
pub(super) const CELLS: usize = 64;

/// Cells on each side that the mesh does not reach.
const BORDER: f64 = 2.0;

/// Least distance between the surface and what counts as inside, cells.
const MARGIN: f64 = 1.0 / 64.0;

/// The same of the largest coordinate: 16 roundings of `f32`, for renderers that transform
/// vertices in `f32`.
const MARGIN_OF_COORDINATES: f64 = 1.0 / (1 << 20) as f64;

/// Where the cells of a grid lie. They are as wide, high and deep as the mesh's bounds ask for, so
/// that a flat mesh has as many across as along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// Corner of the first cell, mesh space.
    pub(super) origin: DVec3,
    /// Size of a cell, mesh space.
    pub(super) cell: DVec3,
    /// Distance from the surface within which nothing counts as inside, cells along each axis.
    pub(super) margin: DVec3,
}

impl Lattice {
    /// A grid over bounds in mesh space. None if they are flat, or so far from zero that rounding
    /// is larger than half a cell.
    pub(super) fn over(lo: DVec3, hi: DVec3) -> Option<Self> {
        let cell = (hi - lo) / (CELLS as f64 - 2.0 * BORDER);
        let rounding = lo.abs().max(hi.abs()).max_element() * MARGIN_OF_COORDINATES;
        let margin = (DVec3::splat(rounding) / cell).max(DVec3::splat(MARGIN));
        // Not finite where the bounds are flat.
        (cell.cmpgt(DVec3::ZERO).all() && margin.max_element() <= 0.5).then(|| Self {
            origin: lo - cell * BORDER,
            cell,
            margin,
        })
    }

    /// A place in mesh space, in cells from the first.
    pub(super) fn cells_of(&self, position: DVec3) -> DVec3 {
        (position - self.origin) / self.cell
    }

    /// The lower corner of a cell, mesh space.
    pub(super) fn corner(&self, cell: [usize; 3]) -> DVec3 {
        self.origin + DVec3::from_array(cell.map(|c| c as f64)) * self.cell
    }
}

/// One bit per cell: x along the bits of a row, then y, then z.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    rows: Vec<u64>,
}

impl Grid {
    pub(super) fn empty() -> Self {
        Self {
            rows: vec![0; CELLS * CELLS],
        }
    }

    pub(super) fn row(&self, y: usize, z: usize) -> u64 {
        self.rows[z * CELLS + y]
    }

    pub(super) fn row_mut(&mut self, y: usize, z: usize) -> &mut u64 {
        &mut self.rows[z * CELLS + y]
    }

    pub(super) fn set(&mut self, [x, y, z]: [usize; 3]) {
        *self.row_mut(y, z) |= 1 << x;
    }

    pub(super) fn inverse(&self) -> Self {
        Self {
            rows: self.rows.iter().map(|row| !row).collect(),
        }
    }

    /// All cells, one after the other.
    pub(super) fn cells(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.rows.iter().enumerate().flat_map(|(i, &row)| {
            let mut left = row;
            core::iter::from_fn(move || {
                let x = (left != 0).then(|| left.trailing_zeros() as usize)?;
                left &= left - 1;
                Some([x, i % CELLS, i / CELLS])
            })
        })
    }

    /// Whether all cells between two corners, the second excluded, are there.
    pub(super) fn has_all(&self, lo: [usize; 3], hi: [usize; 3]) -> bool {
        let bits = span(lo[0], hi[0]);
        (lo[2]..hi[2]).all(|z| (lo[1]..hi[1]).all(|y| self.row(y, z) & bits == bits))
    }
}

/// The bits from one to another, the second excluded.
pub(super) fn span(from: usize, to: usize) -> u64 {
    let below = |n: usize| if n >= CELLS { u64::MAX } else { (1 << n) - 1 };
    below(to) & !below(from)
}
