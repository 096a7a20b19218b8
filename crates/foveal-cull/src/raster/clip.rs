//! The slow path: triangles that cross the near plane or leave the guard band.
//!
//! They are clipped and then set up as usual. A renderer does not draw what is nearer than the near
//! plane, so it occludes nothing.

use super::facing::Facing;
use super::points::GUARD;
use super::scratch::Scratch;
use super::setup::draw_eight;
use crate::depth::band::Band;
use crate::format::BLOCK_SAMPLES;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::projection::clip::{ClipPolygon, NEAR};
use crate::simd::Lanes;
use glam::DVec4;

/// The near plane and the guard band.
const CLIP_PLANES: [DVec4; 5] = {
    let g = GUARD * 0.999;
    [
        NEAR,
        DVec4::new(1.0, 0.0, 0.0, g),
        DVec4::new(-1.0, 0.0, 0.0, g),
        DVec4::new(0.0, 1.0, 0.0, g),
        DVec4::new(0.0, -1.0, 0.0, g),
    ]
};

/// Draws the triangles of a cluster with a vertex that `transform` refused.
#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn draw_clipped<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    scratch: &mut Scratch,
    mesh: &OccluderMesh,
    cluster: &Cluster,
    rows: &[[f64; 4]; 4],
    facing: Facing,
) {
    let rows = rows.map(DVec4::from_array);
    let corner = |v: u8| {
        let i = cluster.first_vertex as usize + usize::from(v);
        let p = DVec4::new(
            f64::from(mesh.vertices.x[i]),
            f64::from(mesh.vertices.y[i]),
            f64::from(mesh.vertices.z[i]),
            1.0,
        );
        DVec4::new(
            rows[0].dot(p),
            rows[1].dot(p),
            rows[2].dot(p),
            rows[3].dot(p),
        )
    };
    // Screen edges that a corner lies beyond: near, left, right, top, bottom.
    let right = f64::from(band.blocks_x * BLOCK_SAMPLES);
    let (top, bottom) = (
        f64::from(band.first_row * BLOCK_SAMPLES),
        f64::from((band.first_row + band.rows) * BLOCK_SAMPLES),
    );
    for v in 0..cluster.vertex_count {
        let c = corner(v as u8);
        let beyond = [
            c.z > c.w,
            c.x < 0.0,
            c.x > right * c.w,
            c.y < top * c.w,
            c.y > bottom * c.w,
        ];
        scratch.beyond[usize::from(v)] = beyond
            .iter()
            .enumerate()
            .fold(0, |m, (i, &b)| m | (u8::from(b) << i));
    }
    for q in 0..usize::from(cluster.quad_count) {
        let group = &mesh.quads[cluster.first_group as usize + q / 8];
        let v: [u8; 4] = core::array::from_fn(|c| group[c][q % 8]);
        if v.iter()
            .fold(0xff, |m, &v| m & scratch.beyond[usize::from(v)])
            != 0
            || !v.iter().any(|&v| scratch.points.x[usize::from(v)].is_nan())
        {
            continue;
        }
        for [a, b, c] in [[v[0], v[1], v[2]], [v[0], v[2], v[3]]] {
            if a == b || b == c || a == c {
                continue;
            }
            let (b, c) = if facing.mirrored { (c, b) } else { (b, c) };
            if [a, b, c]
                .iter()
                .fold(0xff, |m, &v| m & scratch.beyond[usize::from(v)])
                != 0
            {
                continue;
            }
            let mut polygon = ClipPolygon::new(&[corner(a), corner(b), corner(c)]);
            for plane in CLIP_PLANES {
                polygon.clip(plane);
            }
            draw_fan(l, band, scratch, &polygon, facing);
        }
    }
}

#[cfg_attr(not(unoptimized), inline(always))]
fn draw_fan<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    scratch: &mut Scratch,
    polygon: &ClipPolygon,
    facing: Facing,
) {
    if polygon.count < 3 {
        return;
    }
    let points = &mut scratch.clipped;
    for (i, c) in polygon.corners[..polygon.count].iter().enumerate() {
        let inv = 1.0 / c.w;
        let d = (c.z * inv) as f32;
        points.set(i, c.x * inv, c.y * inv, d.min(1.0));
    }
    // A fan. Unused lanes repeat one point and have no area.
    let mut index = [[0u8; 8]; 4];
    for i in 1..polygon.count - 1 {
        for (corner, point) in index.iter_mut().zip([0, i, i + 1, i + 1]) {
            corner[(i - 1) % 8] = point as u8;
        }
    }
    let [i0, i1, i2, i3] = &index;
    scratch.polygons += draw_eight(l, band, points, [i0, i1, i2, i3], None, facing);
}
