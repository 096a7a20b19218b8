//! The cells that a surface may meet.

use super::grid::{CELLS, Grid, Lattice};
use glam::{DVec2, DVec3};

/// Columns of cells that may be looked at and cells that may be marked, one with the other, so that
/// triangles that all go through the whole mesh take no more than some seconds.
const MOST_STEPS: u64 = 1 << 28;

/// A triangle whose doubled area is this small beside its longest edge squared has no plane that
/// can be relied on: rounding of 2^-52 is up to 1e-6 cells otherwise, far below the margin.
const SLIVER: f64 = 1e-8;

/// Every cell that a triangle meets or comes within the margin of, and some beside. Corners are in
/// mesh space. None if that takes too long.
pub(super) fn touched<'a>(
    lattice: &Lattice,
    triangles: impl Iterator<Item = [DVec3; 3]> + 'a,
) -> Option<Grid> {
    let mut grid = Grid::empty();
    let mut steps = 0;
    for corners in triangles {
        let corners = corners.map(|p| lattice.cells_of(p));
        steps += touch(&mut grid, lattice.margin, corners);
        if steps > MOST_STEPS {
            return None;
        }
    }
    Some(grid)
}

/// Adds the cells of one triangle, in cells; returns how many columns were looked at and cells
/// marked, in sum.
fn touch(grid: &mut Grid, margin: DVec3, p: [DVec3; 3]) -> u64 {
    let cell = |v: f64| (v.max(0.0) as usize).min(CELLS - 1);
    let lo = p[0].min(p[1]).min(p[2]) - margin;
    let hi = p[0].max(p[1]).max(p[2]) + margin;
    let (first, last) = (lo.to_array().map(cell), hi.to_array().map(cell));
    let (e, f) = (p[1] - p[0], p[2] - p[0]);
    let normal = e.cross(f);
    let size = normal.abs();
    // The axis along which the triangle is a function of the other two, of a slope of at most 1.
    let w = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    let flat = |q: DVec3| DVec2::new(q[u], q[v]);
    let longest = e.length_squared().max(f.length_squared());
    let sliver = size[w].is_nan() || size[w] <= SLIVER * longest;
    let slope = -flat(normal) / normal[w];
    let half = DVec2::splat(0.5) + flat(margin);
    // How far the plane moves within a cell, and the margin.
    let reach = slope.abs().dot(half) + margin[w];
    let edges = [0, 1, 2].map(|k| Edge::new(flat(p[k]), flat(p[(k + 1) % 3]), normal[w], half));
    let mut steps = 0;
    for j in first[v]..=last[v] {
        for i in first[u]..=last[u] {
            steps += 1;
            let mut ends = [first[w], last[w]];
            if !sliver {
                let center = DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
                if edges.iter().any(|edge| edge.is_beside(center)) {
                    continue;
                }
                let at = p[0][w] + slope.dot(center - flat(p[0]));
                ends = [ends[0].max(cell(at - reach)), ends[1].min(cell(at + reach))];
            }
            let mut place = [0; 3];
            (place[u], place[v]) = (i, j);
            for k in ends[0]..=ends[1] {
                steps += 1;
                place[w] = k;
                grid.set(place);
            }
        }
    }
    steps
}

/// An edge of a triangle seen along an axis.
struct Edge {
    from: DVec2,
    inwards: DVec2,
    /// How far inwards the corner of a cell lies from its centre.
    reach: f64,
}

impl Edge {
    fn new(from: DVec2, to: DVec2, turn: f64, half: DVec2) -> Self {
        let inwards = (to - from).perp() * turn.signum();
        Self {
            from,
            inwards,
            reach: inwards.abs().dot(half),
        }
    }

    /// Whether a whole cell around a centre lies outside.
    fn is_beside(&self, center: DVec2) -> bool {
        self.inwards.dot(center - self.from) + self.reach < 0.0
    }
}
