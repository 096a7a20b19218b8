//! Surface patches: what a cluster hides from every eye of a view region (two eyes, or a validity
//! radius).
//!
//! A patch is a cluster with its one-ring, as far as its triangles surely face the centre eye. An
//! edge with the patch on one side only is a *silhouette edge*: an edge of the mesh, of the
//! outline, or of triangles that are too thin or too steep. The *silhouette margin* is the strip
//! along these edges that another eye may see past; the cluster covers nothing there.
//!
//! Proof. Let q lie behind the patch as seen from the centre eye m, and let e be another eye. In
//! the plane through m, e and q the patch is a line that begins between m and q. Every triangle
//! faces m, so the line never turns back: seen from m it continues in the direction of e until it
//! crosses the ray from e to q, and q is hidden from e too, or until it ends at a silhouette edge.
//! From m, that piece of the plane is a straight line that begins at q and is no longer than the
//! shift of the depth of q. A pixel is therefore safe unless a silhouette edge comes within its own
//! shift of it. (Wonka, Wimmer and Schmalstieg 2000 shrink every occluder by as much; tessellated
//! surfaces stay closed only because inner edges need none of it.)
//!
//! The outer edges of the one-ring need no test: of the one-ring, only triangles count that are
//! higher than the shift, from their corner on the cluster to the opposite edge (or the other way
//! round). A function that is 0 on the cluster and 1 on the outer edges changes by at most one per
//! height, so that no path within the patch from one to the other is shorter.
//!
//! Between samples the patch may be another triangle than at the nearest sample, which is half a
//! sample away in each axis. Depths are lowered by what the steepest triangle of the patch changes
//! there.

use super::extent::{area, highest, lowest};
use super::facing::ValidityRadius;
use super::margin::{self, AROUND_SAMPLE, Reach};
use super::points::{Points, transform};
use super::visible_quads::{QuadCorners, VisibleQuads};
use crate::depth::band::Band;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::occluder::one_ring::{FIRST_OF_RING, FIRST_OF_SECOND, MAX_NUMBERS, OneRing};
use crate::simd::{F8, Kernel, Lanes, M8, four, larger, smaller};

/// A triangle surely faces the eye if its height exceeds this over the sum of its quad's sides,
/// samples. Vertices are rounded by 1/512 at most.
const LEAST_HEIGHT: f32 = 0.125;
/// Triangles that change more than this part of their nearest depth per sample are too steep: they
/// lie within 32 samples of the line where their plane is seen edge-on.
const STEEPEST: f32 = 32.0;
/// The patch of the cluster that is being drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patch {
    /// Above zero for triangles of the patch that may be visible: by group, the first and the
    /// second of each quad.
    pub(crate) kept: [[[f32; 8]; 2]; 8],
    /// Vertices of the quads, by group.
    corners: [QuadCorners; 8],
    /// Distance that depths are lowered by.
    pub(crate) slack: f32,
    /// Silhouette edges, by their vertices, with room for all edges.
    silhouette: Vec<[u8; 2]>,
    /// Blocks with margin pixels.
    margin_blocks: Vec<u32>,
}

impl Patch {
    /// Clears the margins.
    pub(super) fn restore(&mut self, band: &mut Band<'_>) {
        for i in self.margin_blocks.drain(..) {
            band.margin[i as usize] = 0;
        }
        band.has_margins = false;
    }
}

/// The kernel that prepares a cluster for a view region: finds its quads that may be visible and,
/// if there are any, its patch, and marks the silhouette margins within their blocks.
pub(super) struct PreparePatch<'a, 'b, 'c> {
    pub(super) band: &'a mut Band<'b>,
    pub(super) points: &'a mut Points,
    pub(super) patch: &'a mut Patch,
    pub(super) mesh: &'c OccluderMesh,
    pub(super) cluster: &'c Cluster,
    pub(super) ring: &'c OneRing,
    /// Clip rows of the instance.
    pub(super) rows: &'c [[f64; 4]; 4],
    pub(super) mirrored: bool,
    pub(super) radius: ValidityRadius,
}

impl Kernel for PreparePatch<'_, '_, '_> {
    type Output = VisibleQuads;

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, l: L) -> VisibleQuads {
        let Self {
            band,
            points,
            patch,
            mesh,
            cluster,
            ring,
            rows,
            mirrored,
            radius,
        } = self;
        let visible =
            VisibleQuads::of(l, band, points, mesh, cluster, mirrored, &mut patch.corners);
        if !visible.is_empty() {
            let own = usize::from(cluster.vertex_count).next_multiple_of(8);
            let around = (
                &mesh.one_rings.vertices,
                ring.first_vertex as usize,
                usize::from(ring.vertex_count),
            );
            transform(points, own, around, rows);
            prepare(
                l,
                band,
                patch,
                points,
                mesh,
                (cluster, ring),
                (mirrored, visible.blocks, radius),
            );
        }
        visible
    }
}

#[cfg_attr(not(unoptimized), inline(always))]
fn prepare<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    patch: &mut Patch,
    points: &Points,
    mesh: &OccluderMesh,
    (cluster, ring): (&Cluster, &OneRing),
    (mirrored, blocks, radius): (bool, [u32; 4], ValidityRadius),
) {
    let quads = usize::from(cluster.quad_count);
    let around = usize::from(ring.triangle_count);
    let groups = &mesh.one_rings.triangles[ring.first_group as usize..][..around.div_ceil(8)];
    let (zero, one) = (l.splat(0.0), l.splat(1.0));
    let mut steepest = zero;
    let mut nearest = zero;
    // By number: all ones for triangles of the patch. The number of no triangle has none.
    let mut members = [[0; 8]; MAX_NUMBERS / 8];
    let own = patch.corners.iter().zip(&mut patch.kept);
    for (g, (corners, kept)) in own.take(quads.div_ceil(8)).enumerate() {
        let x = four!(c => l.load(&corners.x[c]));
        let y = four!(c => l.load(&corners.y[c]));
        let z = four!(c => l.load(&corners.depth[c]));
        let w = highest(&x) - lowest(&x);
        let h = highest(&y) - lowest(&y);
        let (sides, z_hi) = (w + h, highest(&z));
        let sum = x[0] + x[1] + (x[2] + x[3]);
        // Quads without a vertex for the clipper.
        let whole = sum.is_finite();
        nearest = whole.select(nearest.max(z_hi), nearest);
        for (second, kept) in kept.iter_mut().enumerate() {
            let (b, c) = (1 + second, 2 + second);
            let triangle = [(x[0], y[0], z[0]), (x[b], y[b], z[b]), (x[c], y[c], z[c])];
            let (steepness, member) = judge(triangle, sides, z_hi);
            let member = member & whole;
            steepest = steepest.max(member.select(steepness, zero));
            let visible = member & l.load_mask(&corners.visible);
            visible.select(one, zero).store(kept);
            // Numbers are those of triangles that are not mirrored.
            let second = second ^ usize::from(mirrored);
            member.store(&mut members[g % 8 + second * (FIRST_OF_SECOND / 8)]);
        }
    }
    let base = usize::from(cluster.vertex_count).next_multiple_of(8);
    let (eights, _) = points.depth[base..][..usize::from(ring.vertex_count)].as_chunks::<8>();
    for depths in eights {
        nearest = l.load(depths).max(nearest);
    }
    let mut at = [0.0; 8];
    nearest.store(&mut at);
    let nearest = smaller(greatest(at), 1.0);
    let [shift_x, shift_y] = radius.shifts;
    let height =
        l.splat(AROUND_SAMPLE + nearest * (shift_x * shift_x + shift_y * shift_y).sqrt() * 1.001);
    for (g, group) in groups.iter().enumerate() {
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let a = corner(l, points, &group[order[0]]);
        let b = corner(l, points, &group[order[1]]);
        let c = corner(l, points, &group[order[2]]);
        let (dx, dy) = (c.0 - b.0, c.1 - b.1);
        let sides = dx.abs() + dy.abs() + {
            let (dx, dy) = (c.0 - a.0, c.1 - a.1);
            dx.abs() + dy.abs()
        };
        let z_hi = a.2.max(b.2.max(c.2));
        let (steepness, member) = judge([a, b, c], sides, z_hi);
        let f = area(&[a.0, b.0, c.0, c.0], &[a.1, b.1, c.1, c.1], 0, 1, 2);
        let base = dx * dx + dy * dy;
        let high = (height * height * base).lt(f * f);
        let member = member & high;
        steepest = steepest.max(member.select(steepness, zero));
        member.store(&mut members[(FIRST_OF_RING / 8 + g) % (MAX_NUMBERS / 8)]);
    }
    // Lanes after the last triangle have no area.
    steepest.store(&mut at);
    let steepest = greatest(at);
    // Half a sample along each axis, and the rounding of gradients.
    patch.slack = steepest * 0.6;
    let reach = Reach {
        shifts: radius.shifts,
        steepness: steepest * 1.2,
        blocks,
    };
    let edges = &mesh.one_rings.edges[ring.first_edge as usize..][..usize::from(ring.edges)];
    let most = edges.len().max(patch.silhouette.len());
    patch.silhouette.resize(most, [0; 2]);
    // Branch-free: few edges are silhouette edges, and which ones is unpredictable. Each is
    // written, and overwritten by the next if it is none.
    let members = members.as_flattened();
    let mut count = 0;
    for edge in edges {
        patch.silhouette[count] = edge.vertices;
        let [a, b] = edge
            .triangles
            .map(|t| members[usize::from(t) % MAX_NUMBERS]);
        count += usize::from(a != b);
    }
    for eight in patch.silhouette[..count].chunks(8) {
        let mut ends = [[0; 8]; 2];
        for (i, [a, b]) in eight.iter().enumerate() {
            (ends[0][i], ends[1][i]) = (*a, *b);
        }
        let [from, to] = &ends;
        let margin_blocks = &mut patch.margin_blocks;
        margin::mark_margins(
            l,
            band,
            margin_blocks,
            points,
            [from, to],
            eight.len(),
            &reach,
        );
    }
}

#[cfg_attr(not(unoptimized), inline(always))]
fn corner<L: Lanes>(l: L, points: &Points, index: &[u8; 8]) -> (F8<L>, F8<L>, F8<L>) {
    (
        l.gather(&points.x, index),
        l.gather(&points.y, index),
        l.gather(&points.depth, index),
    )
}

/// Steepness of a triangle (change of depth per sample along x plus along y), and whether it may
/// belong to a patch.
#[cfg_attr(not(unoptimized), inline(always))]
fn judge<L: Lanes>(
    [a, b, c]: [(F8<L>, F8<L>, F8<L>); 3],
    sides: F8<L>,
    z_hi: F8<L>,
) -> (F8<L>, M8<L>) {
    let (bx, by, bz) = (b.0 - a.0, b.1 - a.1, b.2 - a.2);
    let (cx, cy, cz) = (c.0 - a.0, c.1 - a.1, c.2 - a.2);
    // Positive where it faces the eye (y points down).
    let f = cx * by - bx * cy;
    let change = (cz * by - bz * cy).abs() + (bz * cx - cz * bx).abs();
    let faces = (sides * LEAST_HEIGHT).lt(f);
    let flat = (change * STEEPEST).lt(z_hi * f);
    (change / f, faces & flat)
}

#[cfg_attr(not(unoptimized), inline(always))]
fn greatest([a, b, c, d, e, f, g, h]: [f32; 8]) -> f32 {
    let (low, high) = (
        larger(larger(a, b), larger(c, d)),
        larger(larger(e, f), larger(g, h)),
    );
    larger(low, high)
}
