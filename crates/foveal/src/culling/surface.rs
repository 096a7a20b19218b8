//! Where in its box a mesh has anything: the parts of a grid that its triangles, lines and points
//! touch, each cut down to what it holds of them.

use foveal_scene::{Aabb, Mesh};
use glam::{UVec3, Vec3};

/// Parts overlap by this share of a cell, so that what lies on a border lies within both.
const OVERLAP: f32 = 1e-3;
/// Most looks into cells beyond one for each triangle; a coarser grid is taken where there would be
/// more.
const MOST_LOOKS: f32 = (1 << 22) as f32;

/// Boxes in object space that hold all of a mesh, in the grid's order, at most one for each cell;
/// `None` for a mesh with numbers that make no sense. `left`: how many looks all meshes together
/// have left.
pub(super) fn parts(mesh: &Mesh, mut grid: UVec3, left: &mut f32) -> Option<Vec<Aabb>> {
    if !mesh.bounds.is_valid() {
        return mesh.is_empty().then(Vec::new);
    }
    if grid == UVec3::ONE {
        return Some(vec![mesh.bounds]);
    }
    let grid = loop {
        let looks = Grid::new(&mesh.bounds, grid).looks_beyond_one(mesh)?;
        let looks = looks + grid.element_product() as f32;
        if looks <= MOST_LOOKS.min(*left) || grid == UVec3::ONE {
            *left -= looks;
            break Grid::new(&mesh.bounds, grid);
        }
        grid = (grid / 2).max(UVec3::ONE);
    };
    let mut found = vec![Aabb::EMPTY; grid.count.element_product() as usize];
    let mut room: [Vec<Vec3>; 6] = Default::default();
    for corners in corners(mesh) {
        grid.cut(&corners?, 0, 0, &mut room, &mut found);
    }
    found.retain(|b| !b.is_empty());
    found.shrink_to_fit();
    Some(found)
}

/// Corners of the triangles, lines and points; ends of lines and points are there more than once.
fn corners(mesh: &Mesh) -> impl Iterator<Item = Option<[Vec3; 3]>> {
    let triangles = mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
    let lines = mesh.lines.iter().map(|&[a, b]| [a, b, b]);
    let points = mesh.points.iter().map(|&p| [p; 3]);
    triangles.chain(lines).chain(points).map(|numbers| {
        let at = |i: u32| Some(Vec3::from(mesh.vertices.get(i as usize)?.position));
        let [a, b, c] = numbers.map(at);
        let corners = [a?, b?, c?];
        corners.iter().all(|p| p.is_finite()).then_some(corners)
    })
}

/// A box cut into equal cells.
struct Grid {
    low: Vec3,
    cell: Vec3,
    count: UVec3,
}

impl Grid {
    fn new(b: &Aabb, count: UVec3) -> Self {
        Self {
            low: b.min,
            cell: b.size() / count.as_vec3(),
            count,
        }
    }

    /// The cells along an axis that something between two places touches.
    fn touched(&self, axis: usize, low: f32, high: f32) -> std::ops::RangeInclusive<u32> {
        let most = (self.count[axis] - 1) as f32;
        let of = |at: f32, by: f32| {
            let cell = (at - self.low[axis]) / self.cell[axis] + by;
            // A box without extent has one cell, which no division finds.
            if cell.is_nan() {
                0
            } else {
                cell.clamp(0.0, most) as u32
            }
        };
        of(low, -OVERLAP)..=of(high, OVERLAP)
    }

    fn looks_beyond_one(&self, mesh: &Mesh) -> Option<f32> {
        let mut looks = 0.0;
        for corners in corners(mesh) {
            let b = Aabb::of_points(corners?);
            let along = |axis: usize| self.touched(axis, b.min[axis], b.max[axis]).count() as f32;
            looks += along(0) * along(1) * along(2) - 1.0;
        }
        Some(looks)
    }

    /// Adds the parts of a convex polygon to the boxes of the cells that it touches. `first`: the
    /// number of the first cell of the slab that it lies in, by the axes before `axis`.
    fn cut(
        &self,
        polygon: &[Vec3],
        axis: usize,
        first: usize,
        room: &mut [Vec<Vec3>],
        found: &mut [Aabb],
    ) {
        if axis == 3 {
            found[first] = found[first].union(Aabb::of_points(polygon.iter().copied()));
            return;
        }
        let b = Aabb::of_points(polygon.iter().copied());
        let cells = self.touched(axis, b.min[axis], b.max[axis]);
        let step = self.count.to_array()[..axis].iter().product::<u32>() as usize;
        if cells.start() == cells.end() {
            let first = first + step * *cells.start() as usize;
            return self.cut(polygon, axis + 1, first, room, found);
        }
        let Some(([above, piece], rest)) = room.split_first_chunk_mut::<2>() else {
            return;
        };
        for cell in cells {
            let border = |number: f32| self.low[axis] + self.cell[axis] * number;
            let (low, high) = (cell as f32 - OVERLAP, (cell + 1) as f32 + OVERLAP);
            // What lies beyond the outermost cells is theirs.
            let low = if cell == 0 {
                f32::NEG_INFINITY
            } else {
                border(low)
            };
            let is_last = cell + 1 == self.count[axis];
            let high = if is_last { f32::INFINITY } else { border(high) };
            clip(polygon, |p| p[axis] - low, above);
            clip(above, |p| high - p[axis], piece);
            if !piece.is_empty() {
                self.cut(piece, axis + 1, first + step * cell as usize, rest, found);
            }
        }
    }
}

/// The part of a convex polygon that lies within a half-space (Sutherland and Hodgman 1974).
fn clip(polygon: &[Vec3], within: impl Fn(Vec3) -> f32, to: &mut Vec<Vec3>) {
    to.clear();
    let Some(mut before) = polygon.last().copied() else {
        return;
    };
    for &corner in polygon {
        let (a, b) = (within(before), within(corner));
        if (a < 0.0) != (b < 0.0) {
            to.push(before.lerp(corner, a / (a - b)));
        }
        if b >= 0.0 {
            to.push(corner);
        }
        before = corner;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::random;
    use foveal_scene::Vertex;

    fn mesh(places: &[Vec3]) -> Mesh {
        let vertex = |p: &Vec3| Vertex {
            position: p.to_array(),
            ..bytemuck::Zeroable::zeroed()
        };
        Mesh {
            vertices: places.iter().map(vertex).collect(),
            indices: (0..places.len() as u32).collect(),
            bounds: Aabb::of_points(places.iter().copied()),
            ..Mesh::default()
        }
    }

    fn all_parts(mesh: &Mesh, grid: UVec3) -> Option<Vec<Aabb>> {
        parts(mesh, grid, &mut 1e9)
    }

    #[test]
    fn every_place_of_a_triangle_lies_in_a_part() {
        let mut random = random(5);
        for grid in [1, 3, 8, 64] {
            for _ in 0..20 {
                let mut place = || Vec3::new(random() * 9.0 - 4.0, random(), random() * 3.0);
                let corners: [Vec3; 6] = std::array::from_fn(|_| place());
                let parts =
                    all_parts(&mesh(&corners), UVec3::new(grid, grid.min(4), grid)).unwrap();
                for _ in 0..200 {
                    let (mut u, mut v) = (random(), random());
                    if u + v > 1.0 {
                        (u, v) = (1.0 - u, 1.0 - v);
                    }
                    let first = if u < v { 0 } else { 3 };
                    let [a, b, c] = [0, 1, 2].map(|i| corners[first + i]);
                    let p = a + (b - a) * u + (c - a) * v;
                    let near = |b: &&Aabb| p.clamp(b.min, b.max).distance(p) < 1e-6;
                    assert!(parts.iter().any(|b| near(&b)), "{p} of {corners:?}");
                }
            }
        }
    }

    #[test]
    fn air_has_no_parts_and_parts_are_as_flat_as_what_they_hold() {
        // The sides of a box, four units wide.
        let corners = Aabb::new(Vec3::ZERO, Vec3::splat(4.0)).corners();
        let sides = [
            [0, 1, 3, 2],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 3, 7, 5],
        ];
        let halves = sides.map(|[a, b, c, d]| [a, b, c, a, c, d]);
        let places: Vec<Vec3> = halves.as_flattened().iter().map(|&i| corners[i]).collect();
        let found = all_parts(&mesh(&places), UVec3::splat(8)).unwrap();
        assert_eq!(found.len(), 8 * 8 * 8 - 6 * 6 * 6);
        // One side alone.
        let found = all_parts(&mesh(&places[..6]), UVec3::new(8, 8, 1)).unwrap();
        assert_eq!(found.len(), 64);
        assert!(found.iter().all(|b| b.size().z == 0.0 && b.size().x < 0.51));
    }

    #[test]
    fn lines_and_points_have_parts() {
        // Where the line passes a corner of cells, all of them have it.
        let mut mesh = mesh(&[Vec3::ZERO, Vec3::splat(4.0), Vec3::new(0.0, 4.0, 0.0)]);
        mesh.indices.clear();
        mesh.lines = vec![[0, 1]];
        mesh.points = vec![2];
        assert_eq!(
            all_parts(&mesh, UVec3::splat(4)).unwrap().len(),
            4 + 3 * 6 + 1
        );
    }

    #[test]
    fn what_makes_no_sense_has_no_parts_and_many_large_triangles_have_large_ones() {
        let corners = [Vec3::ZERO, Vec3::ONE, Vec3::X];
        let mut bad = mesh(&corners);
        bad.vertices[1].position[2] = f32::NAN;
        assert!(all_parts(&bad, UVec3::splat(4)).is_none());
        bad = mesh(&corners);
        bad.indices[1] = 9;
        assert!(all_parts(&bad, UVec3::splat(4)).is_none());
        assert_eq!(all_parts(&Mesh::default(), UVec3::ONE).unwrap().len(), 0);
        let many: Vec<Vec3> = std::iter::repeat_n(corners, 200).flatten().collect();
        let found = all_parts(&mesh(&many), UVec3::splat(64)).unwrap();
        assert!(!found.is_empty() && found.len() < 64 * 64);
        let mut left = 9000.0;
        let few = parts(&mesh(&corners), UVec3::splat(16), &mut left).unwrap();
        assert_eq!(
            few.len(),
            all_parts(&mesh(&corners), UVec3::splat(16)).unwrap().len()
        );
        assert!((0.0..1000.0).contains(&left), "{left}");
        // Too few looks are left for as many.
        let fewer = parts(&mesh(&corners), UVec3::splat(16), &mut left).unwrap();
        assert!(fewer.len() < few.len() && left >= 0.0);
    }
}
