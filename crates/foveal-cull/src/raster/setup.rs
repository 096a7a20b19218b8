//! Set-up: a cluster's vertices to the screen, then eight quads at once.
//!
//! A quad is drawn whole where both triangles face the eye and the outline is convex on the screen;
//! otherwise triangle by triangle. Its depth is the plane of its larger triangle, lowered by how far the
//! fourth vertex lies behind it, by half a pixel of slope, and by a bound on the rounding of the gradient.

use super::block::Plane;
use super::clip;
use super::polygon::{self, Polygon};
use crate::depth::{BLOCK_SAMPLES, Band, encode};
use crate::occluder::{Cluster, OccluderMesh};
use crate::simd::Lanes;

/// Coordinates beyond this many samples go to the clipper: float keeps 1/256 of a sample below it.
pub(crate) const GUARD: f32 = 32768.0;

/// Working memory of one thread.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) x: [f32; 256],
    pub(crate) y: [f32; 256],
    pub(crate) d: [f32; 256],
    /// Polygons that were set up, for the statistics.
    pub(crate) polygons: u64,
    /// Clusters drawn.
    pub(crate) clusters: u64,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            x: [0.0; 256],
            y: [0.0; 256],
            d: [0.0; 256],
            polygons: 0,
            clusters: 0,
        }
    }
}

/// How an instance is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// The transform mirrors, so winding is reversed.
    pub(crate) mirrored: bool,
    pub(crate) two_sided: bool,
}

#[inline(always)]
pub(crate) fn draw_cluster<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    scratch: &mut Scratch,
    mesh: &OccluderMesh,
    cluster: &Cluster,
    rows: &[[f32; 4]; 4],
    facing: Facing,
) {
    scratch.clusters += 1;
    let clipped = transform(l, scratch, mesh, cluster, rows);
    let groups = usize::from(cluster.quad_count).div_ceil(8);
    let first = cluster.first_group as usize;
    for group in &mesh.quads[first..first + groups] {
        let (i1, i3) = if facing.mirrored { (3, 1) } else { (1, 3) };
        let order = [0, i1, 2, i3];
        let x = order.map(|c| l.gather(&scratch.x, &group[c]));
        let y = order.map(|c| l.gather(&scratch.y, &group[c]));
        let depths = &scratch.d;
        scratch.polygons += draw_eight(
            l,
            band,
            x,
            y,
            || order.map(|c| l.gather(depths, &group[c])),
            facing.two_sided,
        );
    }
    if clipped {
        clip::draw_clipped(l, band, scratch, mesh, cluster, rows, facing);
    }
}

/// Fills `scratch`; vertices for the clipper get NaN, which no test accepts. True if there are any.
#[inline(always)]
fn transform<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    mesh: &OccluderMesh,
    cluster: &Cluster,
    rows: &[[f32; 4]; 4],
) -> bool {
    let first = cluster.first_vertex as usize;
    let n = usize::from(cluster.vertex_count).next_multiple_of(8);
    let v = &mesh.vertices;
    let r = rows.map(|row| row.map(|v| l.splat(v)));
    let (xs, _) = v.x[first..first + n].as_chunks::<8>();
    let (ys, _) = v.y[first..first + n].as_chunks::<8>();
    let (zs, _) = v.z[first..first + n].as_chunks::<8>();
    let (out_x, _) = scratch.x.as_chunks_mut::<8>();
    let (out_y, _) = scratch.y.as_chunks_mut::<8>();
    let (out_d, _) = scratch.d.as_chunks_mut::<8>();
    let (one, guard, nan) = (l.splat(1.0), l.splat(GUARD), l.splat(f32::NAN));
    let mut inside_all = l.isplat(-1);
    for ((((x, y), z), ox), (oy, od)) in xs
        .iter()
        .zip(ys)
        .zip(zs)
        .zip(out_x)
        .zip(out_y.iter_mut().zip(out_d))
    {
        let (x, y, z) = (l.load(x), l.load(y), l.load(z));
        let dot = |r: [L::F; 4]| {
            l.add(
                l.add(l.mul(x, r[0]), l.mul(y, r[1])),
                l.add(l.mul(z, r[2]), r[3]),
            )
        };
        let (cx, cy, cz, cw) = (dot(r[0]), dot(r[1]), dot(r[2]), dot(r[3]));
        let inv = l.div(one, cw);
        let (sx, sy, d) = (l.mul(cx, inv), l.mul(cy, inv), l.mul(cz, inv));
        // Beyond the near plane (Z < W, W above zero with it) and within the guard band.
        let inside = l.iand(
            l.lt(cz, cw),
            l.iand(l.lt(l.abs(sx), guard), l.lt(l.abs(sy), guard)),
        );
        inside_all = l.iand(inside_all, inside);
        l.store(l.select(inside, sx, nan), ox);
        l.store(sy, oy);
        l.store(d, od);
    }
    l.movemask(inside_all) != 0xff
}

/// Sets up and draws eight quads from screen positions; gives the number of polygons drawn.
#[inline(always)]
pub(crate) fn draw_eight<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    mut x: [L::F; 4],
    mut y: [L::F; 4],
    depths: impl FnOnce() -> [L::F; 4],
    two_sided: bool,
) -> u64 {
    let zero = l.splat(0.0);
    // Twice the signed area, positive when facing the eye (y points down).
    let area = |x: &[L::F; 4], y: &[L::F; 4], a: usize, b: usize, c: usize| {
        l.sub(
            l.mul(l.sub(x[c], x[a]), l.sub(y[b], y[a])),
            l.mul(l.sub(x[b], x[a]), l.sub(y[c], y[a])),
        )
    };
    let mut f0 = area(&x, &y, 0, 1, 2);
    let mut f1 = area(&x, &y, 0, 2, 3);
    let mut reversed = l.isplat(0);
    if two_sided {
        // The larger triangle decides the side; its partner on the other side, if any, is dropped.
        reversed = l.lt(l.add(f0, f1), zero);
        let swap = |v: &mut [L::F; 4]| {
            let (a, b) = (v[1], v[3]);
            v[1] = l.select(reversed, b, a);
            v[3] = l.select(reversed, a, b);
        };
        swap(&mut x);
        swap(&mut y);
        f0 = area(&x, &y, 0, 1, 2);
        f1 = area(&x, &y, 0, 2, 3);
    }
    let front0 = l.lt(zero, f0);
    let front1 = l.lt(zero, f1);
    let front = l.ior(front0, front1);
    if l.movemask(front) == 0 {
        return 0;
    }
    let lowest = |v: &[L::F; 4]| l.min(l.min(v[0], v[1]), l.min(v[2], v[3]));
    let highest = |v: &[L::F; 4]| l.max(l.max(v[0], v[1]), l.max(v[2], v[3]));
    let (x_lo, x_hi, y_lo, y_hi) = (lowest(&x), highest(&x), lowest(&y), highest(&y));
    // Half-sample steps strictly above the minimum and up to the maximum: every sample and pixel centre lies
    // on one. Clamping to the band drops what is outside.
    let size = BLOCK_SAMPLES as f32;
    let right = band.blocks_x as f32 * size;
    let (top, bottom) = (
        band.first_row as f32 * size,
        (band.first_row + band.rows) as f32 * size,
    );
    let steps = |v: L::F, lo: f32, hi: f32| {
        let c = l.min(l.max(v, l.splat(lo)), l.splat(hi));
        l.trunc(l.add(c, c))
    };
    let (nx0, nx1) = (steps(x_lo, 0.0, right), steps(x_hi, 0.0, right));
    let (ny0, ny1) = (steps(y_lo, top, bottom), steps(y_hi, top, bottom));
    // `a - b` is negative where a < b.
    let live = l.iand(front, l.iand(l.isub(nx0, nx1), l.isub(ny0, ny1)));
    let mut live = l.movemask(live);
    if live == 0 {
        return 0;
    }
    let f3 = area(&x, &y, 0, 1, 3);
    let f2 = l.sub(l.add(f0, f1), f3);
    let convex = l.movemask(l.iand(
        l.iand(front0, front1),
        l.iand(l.lt(zero, f2), l.lt(zero, f3)),
    ));
    let (front0, front1, reversed) = (front0, front1, reversed);

    let mut z = depths();
    if two_sided {
        let (a, b) = (z[1], z[3]);
        z[1] = l.select(reversed, b, a);
        z[3] = l.select(reversed, a, b);
    }
    let (z_lo, z_hi) = (lowest(&z), highest(&z));
    // The plane through v0 and the larger (or only) front triangle.
    let second = l.ior(
        l.iandnot(front0, l.isplat(-1)),
        l.iand(front1, l.lt(f0, f1)),
    );
    let pick = |v: &[L::F; 4]| {
        (
            l.select(second, v[2], v[1]),
            l.select(second, v[3], v[2]),
            l.select(second, v[1], v[3]),
        )
    };
    let (bx, cx, ox) = pick(&x);
    let (by, cy, oy) = pick(&y);
    let (bz, cz, oz) = pick(&z);
    let f = l.select(second, f1, f0);
    let (bx, by, bz) = (l.sub(bx, x[0]), l.sub(by, y[0]), l.sub(bz, z[0]));
    let (cx, cy, cz) = (l.sub(cx, x[0]), l.sub(cy, y[0]), l.sub(cz, z[0]));
    let inv = l.div(l.splat(1.0), f);
    let gx = l.mul(l.sub(l.mul(cz, by), l.mul(bz, cy)), inv);
    let gy = l.mul(l.sub(l.mul(bz, cx), l.mul(cz, bx)), inv);
    let at_other = l.add(
        z[0],
        l.add(l.mul(gx, l.sub(ox, x[0])), l.mul(gy, l.sub(oy, y[0]))),
    );
    let both = l.iand(front0, front1);
    let fold = l.select(both, l.max(l.sub(at_other, oz), zero), zero);
    let (w, h) = (l.sub(x_hi, x_lo), l.sub(y_hi, y_lo));
    let (ax, ay) = (l.abs(gx), l.abs(gy));
    let relative = l.add(
        l.splat(1.0 / 262_144.0),
        l.mul(l.mul(l.splat(1.0 / 256.0), l.add(w, h)), inv),
    );
    let variation = l.add(
        l.mul(ax, l.add(w, l.splat(4.0))),
        l.mul(ay, l.add(h, l.splat(4.0))),
    );
    let rounding = l.add(
        l.mul(relative, variation),
        l.mul(z_hi, l.splat(1.0 / 1_048_576.0)),
    );
    let slack = l.add(l.add(fold, rounding), l.mul(l.splat(2.0), l.add(ax, ay)));
    let base = l.sub(z[0], slack);

    let slope = |a: usize, b: usize| l.div(l.sub(x[b], x[a]), l.sub(y[b], y[a]));
    let slopes = [
        slope(0, 1),
        slope(1, 2),
        slope(2, 3),
        slope(3, 0),
        slope(2, 0),
    ];

    // One at a time from here.
    let out = |v: L::F| {
        let mut a = [0.0; 8];
        l.store(v, &mut a);
        a
    };
    let (xs, ys, slopes) = (x.map(out), y.map(out), slopes.map(out));
    let (base, gx, gy, z_lo, z_hi, y_lo, y_hi, x_lo, x_hi) = (
        out(base),
        out(gx),
        out(gy),
        out(z_lo),
        out(z_hi),
        out(y_lo),
        out(y_hi),
        out(x_lo),
        out(x_hi),
    );
    let (front0, front1) = (l.movemask(front0), l.movemask(front1));
    let mut drawn = 0;
    while live != 0 {
        let i = live.trailing_zeros() as usize;
        live &= live - 1;
        let bit = 1u32 << i;
        let plane = Plane {
            x: xs[0][i],
            y: ys[0][i],
            depth: base[i],
            dx: gx[i],
            dy: gy[i],
            min: z_lo[i].max(0.0),
            max_code: encode(z_hi[i]),
        };
        // Blocks that hold a half-sample step.
        let block =
            |v: f32, last: u32| (((v * 2.0).max(0.0) as u32) / (2 * BLOCK_SAMPLES)).min(last);
        let blocks = [
            block(x_lo[i], band.blocks_x - 1),
            block(y_lo[i], band.first_row + band.rows - 1).max(band.first_row),
            block(x_hi[i], band.blocks_x - 1),
            block(y_hi[i], band.first_row + band.rows - 1).max(band.first_row),
        ];
        let mut draw = |corners: &[usize], edges: &[usize]| {
            let mut polygon = Polygon::new(plane, blocks);
            let mut flat = false;
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                flat |= polygon.edge(xs[a][i], ys[a][i], xs[b][i], ys[b][i], slopes[edges[k]][i]);
            }
            if flat {
                let (lo, hi) = corners
                    .iter()
                    .fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), &c| {
                        (lo.min(ys[c][i]), hi.max(ys[c][i]))
                    });
                polygon.rows = Some((lo, hi));
            }
            polygon::draw(l, band, &polygon);
            drawn += 1;
        };
        if convex & bit != 0 {
            draw(&[0, 1, 2, 3], &[0, 1, 2, 3]);
        } else {
            if front0 & bit != 0 {
                draw(&[0, 1, 2], &[0, 1, 4]);
            }
            if front1 & bit != 0 {
                draw(&[0, 2, 3], &[4, 2, 3]);
            }
        }
    }
    drawn
}
