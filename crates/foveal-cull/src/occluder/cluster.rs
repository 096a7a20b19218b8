//! Clusters: quads that lie together and face the same way.
//!
//! Quads are split recursively by the surface-area heuristic over six coordinates, position and
//! normal, so that clusters are compact, large quads lie apart from small ones, and normal cones
//! are narrow. Each cluster has its own vertex list, whose numbers fit a byte.

use super::mesh::{Cluster, OccluderMesh, bounds_of, hash_words};
use super::neighbors::{self, LocalNumbers, Neighbors};
use super::quads::Quad;
use super::sah::{Cut, Item, Part, cut, is_lopsided, quad_normals};
use super::vertices::Points;
use glam::{DVec3, Vec3};

const MAX_QUADS: usize = 64;

/// What clusters are built from.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) points: Points<'a>,
    pub(super) near: Option<&'a Neighbors<'a>>,
}

/// Appends the clusters of some quads to a mesh.
pub(super) fn build(mesh: &mut OccluderMesh, source: Source<'_>, quads: Vec<Quad>) {
    let mut items: Vec<Item> = (quads.iter())
        .map(|&quad| Item::new(source.points.points, quad))
        .collect();
    drop(quads);
    split(mesh, source, &mut items);
}

/// Quads to be split.
struct Range<'a> {
    items: &'a mut [Item],
    /// How many cuts that led here were lopsided.
    lopsided: u32,
}

impl Range<'_> {
    /// The first `at` quads and the others.
    fn halves(self, at: usize) -> [Self; 2] {
        let lopsided = self.lopsided + u32::from(is_lopsided(at, self.items.len()));
        let (left, right) = self.items.split_at_mut(at);
        [left, right].map(|items| Self { items, lopsided })
    }
}

/// Appends the clusters of quads, in order.
fn split(mesh: &mut OccluderMesh, source: Source<'_>, items: &mut [Item]) {
    let mut local = LocalNumbers::new();
    // A list and no recursion: it may become long.
    let mut rest = vec![Range { items, lopsided: 0 }];
    while let Some(range) = rest.pop() {
        let items = &mut *range.items;
        if items.is_empty() {
            continue;
        }
        let cut = cut(items, range.lopsided);
        let cheaper = cut.cost < WORTH_A_CUT * Part::of(items).cost();
        if items.len() <= MAX_QUADS && !cheaper && emit(mesh, source, &mut local, items) {
            continue;
        }
        let at = part(items, cut);
        let [left, right] = range.halves(at);
        rest.extend([right, left]);
    }
}

/// Brings the quads of a cut's first part to the front; returns their number.
fn part(items: &mut [Item], cut: Cut) -> usize {
    items.select_nth_unstable_by(cut.at, |a, b| {
        (a.key(cut.axis).total_cmp(&b.key(cut.axis))).then_with(|| a.quad.cmp(&b.quad))
    });
    cut.at
}

/// Quads that fit one cluster are split only if that costs less than this part of it: mostly where
/// large quads leave small ones.
const WORTH_A_CUT: f32 = 0.5;

/// The part of its box's outline that a cluster can fill. The outline of a convex body is a fourth
/// of its surface in the mean over all directions (Cauchy's formula), and triangles that face one
/// way fill up to half their area. A flat wall and a closed body fill everything, bars and leaves
/// next to nothing.
fn fill(quads: impl Iterator<Item = [Vec3; 4]>, size: Vec3) -> f32 {
    let surface: f32 = quads
        .map(|[a, b, c, d]| {
            let twice = (b - a).cross(c - a).length() + (c - a).cross(d - a).length();
            twice * 0.5
        })
        .sum();
    let fill = surface / size.dot(Vec3::new(size.y, size.z, size.x));
    // Too small or too large for `f32`: not known.
    if fill.is_finite() && surface > 0.0 {
        fill.min(1.0)
    } else {
        1.0
    }
}

/// The part of all edges of a cluster's quads, by length, where the mesh ends or bends. 1 without
/// adjacency.
fn creased(
    points: &[Vec3],
    near: Option<&Neighbors<'_>>,
    quads: impl Iterator<Item = Quad>,
) -> f32 {
    let Some(near) = near else {
        return 1.0;
    };
    let (mut all, mut creased) = (0.0, 0.0);
    for [a, b, c, d] in quads {
        for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
            let length = points[from as usize].distance(points[to as usize]);
            all += length;
            if length > 0.0 && !near.is_smooth(from, to) {
                creased += length;
            }
        }
    }
    let part = creased / all;
    if part.is_finite() { part } else { 1.0 }
}

/// Appends one cluster; false if it has more than 256 vertices.
fn emit(
    mesh: &mut OccluderMesh,
    source: Source<'_>,
    local: &mut LocalNumbers,
    items: &[Item],
) -> bool {
    let Source { points, near } = source;
    let mut used: Vec<u32> = items.iter().flat_map(|i| i.quad).collect();
    used.sort_unstable();
    used.dedup();
    if used.len() > 256 {
        return false;
    }
    local.next_cluster();
    for (n, &v) in (0..=u8::MAX).zip(&used) {
        local.set(v, n);
    }
    let first_vertex = mesh.vertices.x.len() as u32;
    let first_group = mesh.quads.len() as u32;
    for &v in &used {
        points.push(&mut mesh.vertices, v);
    }
    mesh.vertices.pad();
    let mut triangles = 0u8;
    // Whole groups of eight for the set-up. Padding repeats a vertex and has no area.
    mesh.quads
        .extend(core::iter::repeat_n([[0u8; 8]; 4], items.len().div_ceil(8)));
    for (i, item) in items.iter().enumerate() {
        for corner in 0..4 {
            let number = local.get(item.quad[corner]).unwrap_or(0);
            mesh.quads[first_group as usize + i / 8][corner][i % 8] = number;
        }
        triangles += if item.quad[2] == item.quad[3] { 1 } else { 2 };
    }
    let corners = items.iter().map(|i| i.quad.map(|v| points.at(v)));
    let shape = Shape::of(mesh.center, corners);
    mesh.clusters.push(Cluster {
        center: shape.center,
        half: shape.half,
        cone_axis: shape.cone_axis,
        cone_sin: shape.cone_sin,
        cone_cos: shape.cone_cos,
        first_vertex,
        first_group,
        vertex_count: used.len() as u16,
        quad_count: items.len() as u8,
        triangle_count: triangles,
        fill: shape.fill,
        creased: creased(points.points, near, items.iter().map(|i| i.quad)),
        hash: hash_words(
            items.len() as u32,
            used.iter()
                .flat_map(|&v| points.at(v).to_array().map(f32::to_bits))
                .chain(items.iter().flat_map(|i| i.quad)),
        ),
    });
    if let Some(near) = near {
        let quads = items.iter().map(|i| i.quad);
        neighbors::build(mesh, points, near, local, &used, quads);
    }
    true
}

/// What of a cluster follows from the positions of its quads' corners.
pub(super) struct Shape {
    pub(super) center: Vec3,
    pub(super) half: Vec3,
    pub(super) cone_axis: Vec3,
    pub(super) cone_sin: f32,
    pub(super) cone_cos: f32,
    pub(super) fill: f32,
}

impl Shape {
    pub(super) fn of(
        mesh_center: DVec3,
        quads: impl ExactSizeIterator<Item = [Vec3; 4]> + Clone,
    ) -> Self {
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut normals = Vec::with_capacity(quads.len() * 2);
        for corners in quads.clone() {
            for p in corners {
                (lo, hi) = (lo.min(p), hi.max(p));
            }
            normals.extend(quad_normals(corners).into_iter().flatten());
        }
        let axis = normals.iter().sum::<Vec3>().normalize_or_zero();
        // Normals that cancel each other out leave a sum too small for its length to be exact.
        let axis = if axis.is_normalized() {
            axis
        } else {
            Vec3::ZERO
        };
        let cos = normals.iter().fold(1.0f32, |m, n| m.min(n.dot(axis)));
        // A little wider than measured, for rounding.
        let cos = if axis == Vec3::ZERO { -1.0 } else { cos - 1e-4 };
        let (center, half) = bounds_of(mesh_center, lo, hi);
        Self {
            center,
            half,
            cone_axis: axis,
            cone_sin: (1.0 - cos * cos).max(0.0).sqrt(),
            cone_cos: cos,
            fill: fill(quads, hi - lo),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sah::MOST_LOPSIDED;
    use super::*;
    use crate::{Aabb, BakeOptions};

    fn fills(mesh: &OccluderMesh) -> Vec<f32> {
        mesh.clusters.iter().map(|c| c.fill).collect()
    }

    /// Upright strips of a width, 1 m apart.
    fn strips(width: f32) -> OccluderMesh {
        let mut points = Vec::new();
        let mut indices = Vec::new();
        for (at, x) in (0u32..).step_by(4).zip([0.0, 1.0, 2.0, 3.0]) {
            let corner = |dx: f32, y: f32| Vec3::new(x + dx, y, -0.3 * x);
            points.extend([
                corner(0.0, 0.0),
                corner(width, 0.0),
                corner(width, 4.0),
                corner(0.0, 4.0),
            ]);
            indices.extend([0, 1, 2, 0, 2, 3].map(|i| at + i));
        }
        OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap()
    }

    #[test]
    fn walls_and_closed_bodies_fill_their_outline_and_bars_do_not() {
        let solid = OccluderMesh::from_box(Aabb::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(fills(&solid.unwrap()), [1.0]);
        let (wide, thin) = (fills(&strips(1.0)), fills(&strips(0.1)));
        assert!(wide[0] > 0.6, "{wide:?}");
        assert!((0.05..0.1).contains(&thin[0]), "{thin:?}");
    }

    #[test]
    fn large_quads_lie_apart_from_small_ones() {
        let (mut points, mut indices) = (Vec::new(), Vec::new());
        let mut quad = |x: f32, z: f32, size: f32| {
            let at = points.len() as u32;
            let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)];
            points.extend(corners.map(|(dx, dz)| Vec3::new(x + dx * size, 0.0, z + dz * size)));
            indices.extend([0, 1, 2, 0, 2, 3].map(|i| at + i));
        };
        quad(0.0, 0.0, 100.0);
        (0..56).for_each(|i| quad(10.0 + (i % 8) as f32, 80.0 + (i / 8) as f32, 0.9));
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        let [one, rest] = &mesh.clusters[..] else {
            panic!("{} clusters", mesh.clusters.len());
        };
        let (large, small) = if one.half.x > 40.0 {
            (one, rest)
        } else {
            (rest, one)
        };
        // Eight quads are set up at once, so up to seven small ones may go with the large one.
        assert!(large.quad_count <= 8, "{}", large.quad_count);
        assert_eq!(large.quad_count + small.quad_count, 57);
        assert!(small.half.x < 5.0 && small.half.z < 5.0, "{:?}", small.half);
    }

    #[test]
    fn numbers_too_large_for_surfaces_are_baked_all_the_same() {
        let points: Vec<Vec3> = (0..300)
            .map(|i| Vec3::new(3e38 * [1.0, -1.0][i % 2], 0.0, 1e38 * (i % 3) as f32))
            .collect();
        let indices: Vec<u32> = (0..298).flat_map(|i| [i, i + 1, i + 2]).collect();
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert!(mesh.cluster_count() < 300);
    }

    /// Triangles over three vertices each, as quads.
    fn items(points: &[Vec3]) -> Vec<Item> {
        let quads = (0..points.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2, 3 * i + 2]);
        quads.map(|quad| Item::new(points, quad)).collect()
    }

    #[test]
    fn surfaces_too_small_for_numbers_are_halved() {
        // The costs of all cuts underflow. Quads near zero, and some in ever smaller steps.
        let (tiny, steps) = (f32::from_bits(1), 1500);
        let x = |i: i32| match i {
            i if i < steps => -0.45 * 0.968f32.powi(i),
            i => (i - steps) as f32 * 1e-42,
        };
        let at = |i: i32| {
            let width = if i < steps { x(i) * -0.01 } else { 1e-42 };
            [(0.0, 0.0), (width, 0.0), (0.0, tiny)].map(|(dx, y)| (x(i) + dx, y))
        };
        let corners = (0..6 * steps).flat_map(at);
        let points: Vec<Vec3> = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).collect();
        let all = items(&points);
        assert_eq!(cut(&all, 0).at, all.len() / 2);
        let indices: Vec<u32> = (0..points.len() as u32).collect();
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert!(mesh.triangle_count() > 8000, "{}", mesh.triangle_count());
        let least = mesh.triangle_count().div_ceil(MAX_QUADS);
        assert!(mesh.cluster_count() < 4 * least, "{}", mesh.cluster_count());
    }

    #[test]
    fn lopsided_cuts_are_few() {
        // One large triangle leaves 999 small ones.
        let at = |i: u32| {
            let (x, size) = if i == 0 { (0.0, 1000.0) } else { (900.0, 1.0) };
            let (x, z) = (x + (i % 32) as f32, (i / 32) as f32);
            [(0.0, 0.0), (size, 0.0), (0.0, size)].map(|(dx, dz)| Vec3::new(x + dx, 0.0, z + dz))
        };
        let points: Vec<Vec3> = (0..1000).flat_map(at).collect();
        let mut all = items(&points);
        for lopsided in [0, MOST_LOPSIDED - 1] {
            let at = cut(&all, lopsided).at;
            assert!(is_lopsided(at, 1000), "{at}");
            let range = Range {
                items: &mut all,
                lopsided,
            };
            let [left, right] = range.halves(at);
            assert_eq!([left.lopsided, right.lopsided], [lopsided + 1; 2]);
        }
        assert_eq!(cut(&all, MOST_LOPSIDED).at, 500);
    }

    #[test]
    fn creases_are_edges_that_end_or_bend() {
        let creased = |mesh: &OccluderMesh| mesh.clusters[0].creased;
        let solid = OccluderMesh::from_box(Aabb::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(creased(&solid.unwrap()), 1.0);
        assert_eq!(creased(&strips(0.1)), 1.0);
        // A bent surface of 6 x 6 quads of 1 m. Of 144 edges, each counted from its quads, 24 are
        // on its boundary.
        let surface = |bend: f32, adjacency: bool| {
            let point = |i: usize| {
                let (x, y) = ((i % 7) as f32, (i / 7) as f32);
                Vec3::new(x, y, bend * (x - 3.0) * (x - 3.0))
            };
            let points: Vec<Vec3> = (0..49).map(point).collect();
            let quads = (0..36).map(|q| q / 6 * 7 + q % 6);
            let indices: Vec<u32> = quads
                .flat_map(|a| [a, a + 1, a + 8, a, a + 8, a + 7])
                .collect();
            let options = BakeOptions::default().with_adjacency(adjacency);
            creased(&OccluderMesh::bake(&points, &indices, options).unwrap())
        };
        assert!((surface(0.0, true) - 24.0 / 144.0).abs() < 1e-6);
        assert!((0.15..0.2).contains(&surface(0.02, true)));
        // Three of the five lines across bend by more than 20 degrees: 67.5 of 189 m.
        assert!((0.35..0.36).contains(&surface(0.4, true)));
        assert_eq!(surface(0.0, false), 1.0);
    }
}
