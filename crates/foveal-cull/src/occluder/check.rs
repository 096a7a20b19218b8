//! Whether what was read is a mesh: everything that drawing relies on, so that numbers from
//! elsewhere can cause no panic, and no wrong result.
//!
//! Positions may be any finite numbers: another surface is not a wrong one. Cones, fills and hashes
//! decide what is drawn and in which order, never what a polygon hides. Adjacency does: an edge that
//! is not listed is no silhouette edge for a view region, and a triangle of a one-ring counts as
//! surface. So every edge of every triangle with a vertex of the cluster must be listed once for each
//! of its triangles, and every triangle of a one-ring must be one of the mesh.

use super::mesh::{Cluster, OccluderMesh};
use super::one_ring::{FIRST_OF_RING, FIRST_OF_SECOND, NO_TRIANGLE, OneRing};
use super::surface::Home;
use super::vertices::Vertices;

const MAX_QUADS: u8 = 64;
const MAX_VERTICES: usize = 256;
const MAX_RING_TRIANGLES: u16 = 255;

type Checked = Result<(), &'static str>;

fn expect(good: bool, what: &'static str) -> Checked {
    if good { Ok(()) } else { Err(what) }
}

/// Checks a mesh whose parts fill their lists. `homes`: where the triangles of one-rings are among
/// those of clusters, one after the other. An error says what is wrong.
pub(super) fn check(mesh: &OccluderMesh, homes: &[Home]) -> Checked {
    let finite = |v: &Vertices| {
        let lists = [&v.x, &v.y, &v.z];
        lists.iter().all(|list| list.iter().all(|n| n.is_finite()))
    };
    let rings = &mesh.one_rings;
    expect(
        finite(&mesh.vertices) && finite(&rings.vertices) && mesh.center.is_finite(),
        "a position is not finite",
    )?;
    expect(
        !mesh.two_sided || rings.clusters.is_empty(),
        "a two-sided mesh has no adjacency",
    )?;
    for cluster in &mesh.clusters {
        check_cluster(mesh, cluster)?;
    }
    if rings.clusters.is_empty() {
        return Ok(());
    }
    let mut homes = homes;
    for (cluster, ring) in mesh.clusters.iter().zip(&rings.clusters) {
        let (own, rest) = homes
            .split_at_checked(usize::from(ring.triangle_count))
            .ok_or("a one-ring's triangle is none of the mesh")?;
        homes = rest;
        check_ring(mesh, own, cluster, ring)?;
    }
    Ok(())
}

/// Checks the bounds of the mesh that an inner shape is inside: finite, and around the shape. A
/// mesh whose near planes are looked for elsewhere would hide what an eye within it sees.
pub(super) fn check_solid(mesh: &OccluderMesh) -> Checked {
    let Some(solid) = mesh.solid else {
        return Ok(());
    };
    expect(!mesh.two_sided, "an inner shape has no other side")?;
    let v = &mesh.vertices;
    let within = |list: &[f32], axis: usize| {
        let mut list = list.iter();
        list.all(|p| (solid.min[axis]..=solid.max[axis]).contains(p))
    };
    let around = within(&v.x, 0) && within(&v.y, 1) && within(&v.z, 2);
    expect(
        solid.is_valid() && around,
        "an inner shape is outside of its mesh",
    )
}

/// Checks the numbers of a cluster's vertices and quads.
pub(super) fn check_counts(c: &Cluster) -> Checked {
    let vertices = usize::from(c.vertex_count);
    expect(
        (1..=MAX_VERTICES).contains(&vertices) && (1..=MAX_QUADS).contains(&c.quad_count),
        "a cluster has none or too many vertices or quads",
    )
}

fn check_cluster(mesh: &OccluderMesh, c: &Cluster) -> Checked {
    let vertices = usize::from(c.vertex_count);
    let unit = |v: f32| v.abs() <= 1.001;
    let [x, y, z] = c.cone_axis.to_array();
    let part = |v: f32| (0.0..=1.0).contains(&v);
    expect(
        [x, y, z, c.cone_sin, c.cone_cos].into_iter().all(unit) && part(c.fill) && part(c.creased),
        "a cluster's cone or fill is out of range",
    )?;
    let first = c.first_vertex as usize;
    for list in [&mesh.vertices.x, &mesh.vertices.y, &mesh.vertices.z] {
        let list = &list[first..first + vertices.next_multiple_of(8)];
        let last = list[vertices - 1].to_bits();
        let padded = list[vertices..].iter().all(|v| v.to_bits() == last);
        expect(padded, "a list of vertices is not padded by its last")?;
    }
    let mut triangles = 0;
    for quad in quads(mesh, c) {
        let [v0, v1, v2, v3] = quad;
        let distinct = v0 != v1 && v1 != v2 && v2 != v0 && v3 != v0 && v3 != v1;
        let known = quad.iter().all(|&v| usize::from(v) < vertices);
        expect(distinct && known, "a quad has no four vertices")?;
        triangles += if v2 == v3 { 1 } else { 2 };
    }
    expect(
        triangles == c.triangle_count,
        "a cluster has another number of triangles",
    )?;
    let groups = &mesh.quads[c.first_group as usize..][..usize::from(c.quad_count.div_ceil(8))];
    expect(
        padded(groups.as_flattened(), 4, usize::from(c.quad_count)),
        "a list of quads is not padded by zeros",
    )
}

/// Local numbers of the corners of a cluster's quads.
fn quads<'a>(mesh: &'a OccluderMesh, c: &Cluster) -> impl Iterator<Item = [u8; 4]> + 'a {
    let first = c.first_group as usize;
    (0..usize::from(c.quad_count)).map(move |q| {
        let group = &mesh.quads[first + q / 8];
        core::array::from_fn(|corner| group[corner][q % 8])
    })
}

/// Whether all lanes from `count` on are zero, in groups of `corners` rows of eight.
fn padded(rows: &[[u8; 8]], corners: usize, count: usize) -> bool {
    let last = count / 8 * corners;
    let rest = rows.get(last..).unwrap_or_default();
    rest.iter()
        .all(|row| row[count % 8..].iter().all(|v| *v == 0))
}

/// The corners of a cluster's triangles and its one-ring's, by number, and which of their edges are
/// listed, one bit each.
struct Triangles {
    corners: [Option<[u8; 3]>; NO_TRIANGLE as usize],
    listed: [u8; NO_TRIANGLE as usize],
}

impl Triangles {
    /// Notes the edge from `a` to `b` of a triangle; false if it has none, or not for the first
    /// time.
    fn list(&mut self, number: u16, a: u8, b: u8) -> bool {
        let n = usize::from(number);
        let Some(corners) = self.corners.get(n).copied().flatten() else {
            return false;
        };
        let edge = (0..3).find(|&k| corners[k] == a && corners[(k + 1) % 3] == b);
        let bit = edge.map_or(0, |k| 1 << k);
        let new = bit != 0 && self.listed[n] & bit == 0;
        self.listed[n] |= bit;
        new
    }
}

fn check_ring(mesh: &OccluderMesh, homes: &[Home], c: &Cluster, ring: &OneRing) -> Checked {
    let rings = &mesh.one_rings;
    let own = usize::from(c.vertex_count);
    let base = own.next_multiple_of(8);
    let vertices = usize::from(ring.vertex_count);
    expect(
        vertices.is_multiple_of(8)
            && base + vertices <= MAX_VERTICES
            && ring.triangle_count <= MAX_RING_TRIANGLES,
        "a one-ring has too many vertices or triangles",
    )?;
    let mut all = Triangles {
        corners: [None; NO_TRIANGLE as usize],
        listed: [0; NO_TRIANGLE as usize],
    };
    for (n, [v0, v1, v2, v3]) in quads(mesh, c).enumerate() {
        all.corners[n] = Some([v0, v1, v2]);
        all.corners[FIRST_OF_SECOND + n] = (v2 != v3).then_some([v0, v2, v3]);
    }
    let count = usize::from(ring.triangle_count);
    let groups = &rings.triangles[ring.first_group as usize..][..count.div_ceil(8)];
    for (n, home) in homes.iter().enumerate() {
        let t = ring.corners(mesh, n);
        let on = t.map(|v| usize::from(v) < own);
        let known = t
            .iter()
            .all(|&v| usize::from(v) < own || (base..base + vertices).contains(&usize::from(v)));
        // The first corner is the one that is alone on its side.
        let alone = on[1] == on[2] && (on[0] || on[1]);
        let distinct = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        expect(known && alone && distinct, "a one-ring's triangle is none")?;
        expect(
            home.is_of(mesh, &ring.points(mesh, c, n)),
            "a one-ring's triangle is none of the mesh",
        )?;
        all.corners[FIRST_OF_RING + n] = Some(t);
    }
    expect(
        padded(groups.as_flattened(), 3, count),
        "a one-ring's triangles are not padded by zeros",
    )?;
    let first = ring.first_edge as usize;
    for edge in &rings.edges[first..first + usize::from(ring.edges)] {
        let ([n, other], [a, b]) = (edge.triangles, edge.vertices);
        let joins = other == NO_TRIANGLE || all.list(other, b, a);
        let touches = usize::from(a) < own || usize::from(b) < own;
        expect(
            n < other && joins && touches && all.list(n, a, b),
            "an edge does not belong to its triangles",
        )?;
    }
    for (corners, listed) in all.corners.iter().zip(&all.listed) {
        let Some(t) = corners else { continue };
        let whole = (0..3).all(|k| {
            let touches = usize::from(t[k]) < own || usize::from(t[(k + 1) % 3]) < own;
            !touches || listed & (1 << k) != 0
        });
        expect(whole, "an edge is missing")?;
    }
    Ok(())
}
