//! Results that hold around the eye: a cluster and its ring as one sheet.
//!
//! Take all triangles of a cluster, and of the ring around it, that surely face the eye in the middle, m. Let a
//! point q lie behind one of them as seen from m, and let another eye e be near. In the plane through m, e and q
//! the sheet is a line that begins between m and q, and as every triangle faces m it never turns back: seen from m, it
//! goes on in the direction in which e lies, until it crosses the ray from e to q, and q is hidden there too, or ends at
//! the sheet's border. From m that part of the plane appears as a piece of a straight line that begins at q and, for
//! what lies at depth d, is no longer than the shift of depth d. So a pixel is safe unless a border comes
//! within its own shift of it; such pixels are erased: the cluster covers nothing there. (Wonka et
//! al. 2000 shrink occluders by as much; that inner edges need none of it is what keeps tessellated surfaces closed.)
//!
//! A border is an edge with the sheet on one side only: of the mesh, of a silhouette, of triangles too thin or too steep
//! to say anything about. The ring's outer border needs no look: of the ring, only triangles count that are higher than
//! the shift, from their corner on the cluster to the opposite edge (or the other way round). A function that is 0 on
//! the cluster and 1 on the outer border changes by at most one per height, so that no way within the sheet
//! from the one to the other is shorter.
//!
//! How a border erases is in [`super::border`].
//!
//! Between samples the sheet may be another triangle than at the nearest of them, half a sample away in each axis;
//! depths are lowered by what the steepest triangle of the sheet changes there.

use super::extent::{area, highest, lowest};
use super::facing::Radius;
use super::margin::{self, AROUND_SAMPLE, Reach};
use super::open::{Corners, Open};
use super::points::{Points, transform};
use crate::depth::band::Band;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::occluder::one_ring::{NUMBERS, RING, Ring, SECOND};
use crate::simd::{Kernel, Lanes, four, larger, smaller};

/// A triangle surely faces the eye if it is higher than this over the sum of its quad's sides, samples: corners are
/// rounded by 1/512 at most.
const LEAST_HEIGHT: f32 = 0.125;
/// Steeper triangles, by their nearest depth per sample, do not count: they lie within 32 samples of the line where their
/// plane is seen from its side.
const STEEPEST: f32 = 32.0;
/// What belongs to the sheet of the cluster that is being drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sheet {
    /// Above zero for triangles that belong to it and may be seen: by group the first and the second of each quad.
    pub(crate) kept: [[[f32; 8]; 2]; 8],
    /// Its corners, by group.
    corners: [Corners; 8],
    /// By how much depths are lowered.
    pub(crate) slack: f32,
    /// Edges that are its borders, by their vertices, and room for all.
    borders: Vec<[u8; 2]>,
    /// Blocks with erased pixels.
    erased: Vec<u32>,
}

impl Sheet {
    /// Forgets what was erased.
    pub(super) fn restore(&mut self, band: &mut Band<'_>) {
        for i in self.erased.drain(..) {
            band.erased[i as usize] = 0;
        }
        band.erases = false;
    }
}

/// What has to be done before a cluster is drawn for a result that holds around the eye: finds its quads that may be
/// seen, and if there are any, its sheet, and erases what is too near to the sheet's border within their blocks.
pub(super) struct Prepare<'a, 'b, 'c> {
    pub(super) band: &'a mut Band<'b>,
    pub(super) points: &'a mut Points,
    pub(super) sheet: &'a mut Sheet,
    pub(super) mesh: &'c OccluderMesh,
    pub(super) cluster: &'c Cluster,
    pub(super) ring: &'c Ring,
    /// Clip rows of the instance.
    pub(super) rows: &'c [[f64; 4]; 4],
    pub(super) mirrored: bool,
    pub(super) radius: Radius,
}

impl Kernel for Prepare<'_, '_, '_> {
    type Output = Open;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Open {
        let Self {
            band,
            points,
            sheet,
            mesh,
            cluster,
            ring,
            rows,
            mirrored,
            radius,
        } = self;
        let open = Open::of(l, band, points, mesh, cluster, mirrored, &mut sheet.corners);
        if !open.is_empty() {
            let own = usize::from(cluster.vertex_count).next_multiple_of(8);
            let around = (
                &mesh.rings.vertices,
                ring.first_vertex as usize,
                usize::from(ring.vertex_count),
            );
            transform(points, own, around, rows);
            prepare(
                l,
                band,
                sheet,
                points,
                mesh,
                (cluster, ring),
                (mirrored, open.blocks, radius),
            );
        }
        open
    }
}

#[inline(always)]
fn prepare<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    sheet: &mut Sheet,
    points: &Points,
    mesh: &OccluderMesh,
    (cluster, ring): (&Cluster, &Ring),
    (mirrored, blocks, radius): (bool, [u32; 4], Radius),
) {
    let quads = usize::from(cluster.quad_count);
    let around = usize::from(ring.triangle_count);
    let groups = &mesh.rings.triangles[ring.first_group as usize..][..around.div_ceil(8)];
    let (zero, one) = (l.splat(0.0), l.splat(1.0));
    let mut steepest = zero;
    let mut nearest = zero;
    // By number: all ones for triangles of the sheet. That of no triangle is none.
    let mut members = [[0; 8]; NUMBERS / 8];
    let own = sheet.corners.iter().zip(&mut sheet.kept);
    for (g, (corners, kept)) in own.take(quads.div_ceil(8)).enumerate() {
        let x = four!(c => l.load(&corners.x[c]));
        let y = four!(c => l.load(&corners.y[c]));
        let z = four!(c => l.load(&corners.depth[c]));
        let w = l.sub(highest(l, &x), lowest(l, &x));
        let h = l.sub(highest(l, &y), lowest(l, &y));
        let (sides, z_hi) = (l.add(w, h), highest(l, &z));
        let sum = l.add(l.add(x[0], x[1]), l.add(x[2], x[3]));
        // Without corners for the clipper.
        let whole = l.lt(l.sub(sum, sum), one);
        nearest = l.select(whole, l.max(nearest, z_hi), nearest);
        for (second, kept) in kept.iter_mut().enumerate() {
            let (b, c) = (1 + second, 2 + second);
            let triangle = [(x[0], y[0], z[0]), (x[b], y[b], z[b]), (x[c], y[c], z[c])];
            let (steepness, member) = judge(l, triangle, sides, z_hi);
            let member = l.iand(member, whole);
            steepest = l.max(steepest, l.select(member, steepness, zero));
            let open = l.iand(member, l.iload(&corners.open));
            l.store(l.select(open, one, zero), kept);
            // Numbers are those of triangles that are not mirrored.
            let second = second ^ usize::from(mirrored);
            l.istore(member, &mut members[g % 8 + second * (SECOND / 8)]);
        }
    }
    let base = usize::from(cluster.vertex_count).next_multiple_of(8);
    let (eights, _) = points.depth[base..][..usize::from(ring.vertex_count)].as_chunks::<8>();
    for depths in eights {
        nearest = l.max(l.load(depths), nearest);
    }
    let mut at = [0.0; 8];
    l.store(nearest, &mut at);
    let nearest = smaller(greatest(at), 1.0);
    let [shift_x, shift_y] = radius.shifts;
    let height =
        l.splat(AROUND_SAMPLE + nearest * (shift_x * shift_x + shift_y * shift_y).sqrt() * 1.001);
    for (g, group) in groups.iter().enumerate() {
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let a = corner(l, points, &group[order[0]]);
        let b = corner(l, points, &group[order[1]]);
        let c = corner(l, points, &group[order[2]]);
        let (dx, dy) = (l.sub(c.0, b.0), l.sub(c.1, b.1));
        let sides = l.add(l.add(l.abs(dx), l.abs(dy)), {
            let (dx, dy) = (l.sub(c.0, a.0), l.sub(c.1, a.1));
            l.add(l.abs(dx), l.abs(dy))
        });
        let z_hi = l.max(a.2, l.max(b.2, c.2));
        let (steepness, member) = judge(l, [a, b, c], sides, z_hi);
        let f = area(l, &[a.0, b.0, c.0, c.0], &[a.1, b.1, c.1, c.1], 0, 1, 2);
        let base = l.add(l.mul(dx, dx), l.mul(dy, dy));
        let high = l.lt(l.mul(l.mul(height, height), base), l.mul(f, f));
        let member = l.iand(member, high);
        steepest = l.max(steepest, l.select(member, steepness, zero));
        l.istore(member, &mut members[(RING / 8 + g) % (NUMBERS / 8)]);
    }
    // Lanes after the last triangle have no area.
    l.store(steepest, &mut at);
    let steepest = greatest(at);
    // Half a sample along each axis, and the rounding of gradients.
    sheet.slack = steepest * 0.6;
    let reach = Reach {
        shifts: radius.shifts,
        steepness: steepest * 1.2,
        blocks,
    };
    let edges = &mesh.rings.edges[ring.first_edge as usize..][..usize::from(ring.edges)];
    let most = edges.len().max(sheet.borders.len());
    sheet.borders.resize(most, [0; 2]);
    // Few edges are borders, and which ones cannot be foreseen: each is written, and the next one over it if it is none.
    let members = members.as_flattened();
    let mut count = 0;
    for edge in edges {
        sheet.borders[count] = edge.vertices;
        let [a, b] = edge.triangles.map(|t| members[usize::from(t) % NUMBERS]);
        count += usize::from(a != b);
    }
    for eight in sheet.borders[..count].chunks(8) {
        let mut ends = [[0; 8]; 2];
        for (i, [a, b]) in eight.iter().enumerate() {
            (ends[0][i], ends[1][i]) = (*a, *b);
        }
        let [from, to] = &ends;
        let erased = &mut sheet.erased;
        margin::erase_eight(l, band, erased, points, [from, to], eight.len(), &reach);
    }
}

#[inline(always)]
fn corner<L: Lanes>(l: L, points: &Points, index: &[u8; 8]) -> (L::F, L::F, L::F) {
    (
        l.gather(&points.x, index),
        l.gather(&points.y, index),
        l.gather(&points.depth, index),
    )
}

/// How steep a triangle is (change of depth per sample along x plus along y), and whether it may belong to a sheet.
#[inline(always)]
fn judge<L: Lanes>(
    l: L,
    [a, b, c]: [(L::F, L::F, L::F); 3],
    sides: L::F,
    z_hi: L::F,
) -> (L::F, L::I) {
    let (bx, by, bz) = (l.sub(b.0, a.0), l.sub(b.1, a.1), l.sub(b.2, a.2));
    let (cx, cy, cz) = (l.sub(c.0, a.0), l.sub(c.1, a.1), l.sub(c.2, a.2));
    // Positive where it faces the eye (y points down).
    let f = l.sub(l.mul(cx, by), l.mul(bx, cy));
    let change = l.add(
        l.abs(l.sub(l.mul(cz, by), l.mul(bz, cy))),
        l.abs(l.sub(l.mul(bz, cx), l.mul(cz, bx))),
    );
    let faces = l.lt(l.mul(sides, l.splat(LEAST_HEIGHT)), f);
    let flat = l.lt(l.mul(change, l.splat(STEEPEST)), l.mul(z_hi, f));
    (l.div(change, f), l.iand(faces, flat))
}

#[inline(always)]
fn greatest([a, b, c, d, e, f, g, h]: [f32; 8]) -> f32 {
    let (low, high) = (
        larger(larger(a, b), larger(c, d)),
        larger(larger(e, f), larger(g, h)),
    );
    larger(low, high)
}
