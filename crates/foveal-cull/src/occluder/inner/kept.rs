//! How much of a mesh's outline boxes fill, in the mean over many directions. An estimate, on
//! pictures of 64 x 64 points: it decides which shape is cheaper, never what is hidden.

use super::grid::{CELLS, Grid, Lattice};
use glam::DVec3;

const DIRECTIONS: usize = 32;

/// The outlines of a mesh from some dozens of directions, and what boxes have filled of them.
pub(super) struct Outlines {
    pictures: Vec<Picture>,
    all: u32,
}

/// A picture along one direction, one bit per point.
struct Picture {
    /// Right, up and along, unit length.
    axes: [DVec3; 3],
    center: DVec3,
    /// Distance between points, mesh space.
    step: f64,
    /// Where the mesh is, and no box yet.
    open: [u64; CELLS],
}

impl Outlines {
    /// The outlines of a mesh, of the cells that its surface may meet.
    pub(super) fn new(lattice: &Lattice, touched: &Grid) -> Self {
        let size = lattice.cell * CELLS as f64;
        let center = lattice.origin + size * 0.5;
        // A point per diagonal of a cell: so far apart, cells leave no gaps.
        let step = lattice.cell.length();
        let half_cell = lattice.cell * 0.5;
        let mut pictures: Vec<Picture> = (0..DIRECTIONS)
            .map(|i| Picture {
                axes: axes(i),
                center,
                step,
                open: [0; CELLS],
            })
            .collect();
        for cell in touched.cells() {
            let at = lattice.corner(cell) + half_cell;
            for picture in &mut pictures {
                picture.mark(at);
            }
        }
        let all = pictures.iter().map(Picture::count).sum();
        Self { pictures, all }
    }

    /// The part of the outlines that a box would add to the others, 0 to 1.
    pub(super) fn added_by(&self, lo: DVec3, hi: DVec3) -> f64 {
        let added: u32 = (self.pictures.iter())
            .flat_map(|p| (0..CELLS).map(move |v| p.met(v, lo, hi).count_ones()))
            .sum();
        f64::from(added) / f64::from(self.all.max(1))
    }

    /// Adds a box.
    pub(super) fn add(&mut self, lo: DVec3, hi: DVec3) {
        for picture in &mut self.pictures {
            for v in 0..CELLS {
                picture.open[v] &= !picture.met(v, lo, hi);
            }
        }
    }
}

impl Picture {
    fn count(&self) -> u32 {
        self.open.iter().map(|row| row.count_ones()).sum()
    }

    fn mark(&mut self, at: DVec3) {
        let from = (at - self.center) / self.step;
        let place = |axis: DVec3| from.dot(axis) + CELLS as f64 * 0.5;
        let (u, v) = (place(self.axes[0]), place(self.axes[1]));
        let point = |v: f64| (v.max(0.0) as usize).min(CELLS - 1);
        self.open[point(v)] |= 1 << point(u);
    }

    /// The open points of a row whose lines meet a box.
    fn met(&self, v: usize, lo: DVec3, hi: DVec3) -> u64 {
        let [right, up, along] = self.axes;
        let place = |i: f64| (i + 0.5 - CELLS as f64 * 0.5) * self.step;
        let row = self.center + up * place(v as f64);
        let (mut left, mut met) = (self.open[v], 0);
        while left != 0 {
            let u = left.trailing_zeros();
            left &= left - 1;
            let start = row + right * place(f64::from(u));
            met |= u64::from(meets(start, along.recip(), lo, hi)) << u;
        }
        met
    }
}

/// Whether a line meets a box.
fn meets(start: DVec3, per_along: DVec3, lo: DVec3, hi: DVec3) -> bool {
    let (a, b) = ((lo - start) * per_along, (hi - start) * per_along);
    a.min(b).max_element() <= a.max(b).min_element()
}

/// Right, up and along of a direction: points of a spiral over a half-sphere, evenly spread
/// (Fibonacci's lattice). Opposite directions have the same outlines.
fn axes(i: usize) -> [DVec3; 3] {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let z = 1.0 - (i as f64 + 0.5) / DIRECTIONS as f64;
    let (sin, cos) = (i as f64 * GOLDEN_ANGLE).sin_cos();
    let side = (1.0 - z * z).sqrt();
    let along = DVec3::new(cos * side, sin * side, z);
    let right = along.any_orthonormal_vector();
    [right, along.cross(right), along]
}
