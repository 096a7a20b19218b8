//! The quads of a cluster that may still be visible.
//!
//! A cluster is drawn where its box may be visible, but in a typical scene two of five then have no
//! quad that faces the eye and is not hidden. The patch of a view region is prepared only for
//! clusters that have one, and only in the blocks of such quads.

use super::extent::{area, blocks_of, highest, lowest, out, steps_of};
use super::points::Points;
use crate::depth::band::Band;
use crate::format::encode;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::simd::{Lanes, four};

/// Eight quads on the screen, corner by corner: samples, and depths.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QuadCorners {
    pub(super) x: [[f32; 8]; 4],
    pub(super) y: [[f32; 8]; 4],
    pub(super) depth: [[f32; 8]; 4],
    /// All ones for quads that may be visible.
    pub(super) visible: [i32; 8],
}

/// The quads of a cluster that may be visible.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VisibleQuads {
    /// One bit per quad, by group of eight.
    pub(super) quads: [u8; 8],
    /// First and last block of all of them, inclusive; the first lies behind the last if there are
    /// none.
    pub(super) blocks: [u32; 4],
}

impl VisibleQuads {
    /// Every quad of a cluster, wherever it lies.
    pub(super) fn all() -> Self {
        Self {
            quads: [u8::MAX; 8],
            ..Self::default()
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.quads == [0; 8]
    }

    /// Tests the quads of a one-sided cluster, and keeps their corners. Quads with a vertex for the
    /// clipper are not among the result.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn of<L: Lanes>(
        l: L,
        band: &Band<'_>,
        points: &Points,
        mesh: &OccluderMesh,
        cluster: &Cluster,
        mirrored: bool,
        corners: &mut [QuadCorners; 8],
    ) -> Self {
        let mut visible = Self {
            quads: [0; 8],
            blocks: [u32::MAX, u32::MAX, 0, 0],
        };
        let groups = usize::from(cluster.quad_count).div_ceil(8);
        let groups = &mesh.quads[cluster.first_group as usize..][..groups];
        let order = if mirrored { [0, 3, 2, 1] } else { [0, 1, 2, 3] };
        let zero = l.splat(0.0);
        for ((group, quads), corners) in groups.iter().zip(&mut visible.quads).zip(corners) {
            let x = four!(c => l.gather(&points.x, &group[order[c]]));
            let y = four!(c => l.gather(&points.y, &group[order[c]]));
            let z = four!(c => l.gather(&points.depth, &group[order[c]]));
            *corners = QuadCorners {
                x: four!(c => out(x[c])),
                y: four!(c => out(y[c])),
                depth: four!(c => out(z[c])),
                visible: [0; 8],
            };
            let sum = x[0] + x[1] + (x[2] + x[3]);
            let whole = sum.is_finite();
            let f0 = area(&x, &y, 0, 1, 2);
            let f1 = area(&x, &y, 0, 2, 3);
            let front = whole & (zero.lt(f0) | zero.lt(f1));
            let ends = [[lowest(&x), lowest(&y)], [highest(&x), highest(&y)]];
            let steps = steps_of(l, band, ends);
            let [nx0, ny0, nx1, ny1] = steps;
            let meets = nx0.lt(nx1) & ny0.lt(ny1);
            let mut live = (front & meets).bits();
            if live == 0 {
                continue;
            }
            let nearest = out(highest(&z));
            let [bx0, by0, bx1, by1] = blocks_of(l, band, steps);
            while live != 0 {
                let i = live.trailing_zeros() as usize;
                live &= live - 1;
                let blocks = [bx0[i] as u32, by0[i] as u32, bx1[i] as u32, by1[i] as u32];
                if band.hides(blocks, encode(nearest[i])) {
                    continue;
                }
                *quads |= 1 << i;
                corners.visible[i] = -1;
                let [x0, y0, x1, y1] = visible.blocks;
                visible.blocks = [
                    x0.min(blocks[0]),
                    y0.min(blocks[1]),
                    x1.max(blocks[2]),
                    y1.max(blocks[3]),
                ];
            }
        }
        visible
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::buffer::OcclusionBuffer;
    use crate::format::BLOCK_SAMPLES;
    use crate::simd::portable::Portable;
    use crate::{BakeOptions, OccluderMesh};
    use glam::Vec3;

    /// A ball of quads around the centre of a buffer of 64 x 48 pixels, seen from far away.
    fn ball() -> (OccluderMesh, Vec<[f32; 3]>) {
        let (rings, around) = (5, 9);
        let point = |i: u32, j: u32| {
            let (a, b) = (
                core::f32::consts::TAU * (j % around) as f32 / around as f32 + 0.1,
                core::f32::consts::PI * i as f32 / rings as f32,
            );
            Vec3::new(a.cos() * b.sin(), b.cos(), a.sin() * b.sin())
        };
        let points: Vec<Vec3> = (0..=rings)
            .flat_map(|i| (0..around).map(move |j| point(i, j)))
            .collect();
        let at = |i: u32, j: u32| i * around + j % around;
        let indices: Vec<u32> = (0..rings)
            .flat_map(|i| (0..around).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let q = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                [q[0], q[1], q[2], q[0], q[2], q[3]]
            })
            .collect();
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        assert_eq!(mesh.clusters.len(), 1);
        let v = &mesh.vertices;
        let screen = (0..v.x.len())
            .map(|i| {
                [
                    128.0 + 90.0 * v.x[i],
                    96.0 - 90.0 * v.y[i],
                    0.5 + 0.1 * v.z[i],
                ]
            })
            .collect();
        (mesh, screen)
    }

    #[test]
    fn quads_that_face_the_eye_and_are_not_hidden_are_visible() {
        let (mesh, screen) = ball();
        let mut points = Points::default();
        for (i, p) in screen.iter().enumerate() {
            points.set(i, f64::from(p[0]), f64::from(p[1]), p[2]);
        }
        let cluster = &mesh.clusters[0];
        let mut buffer = OcclusionBuffer::new(64, 48);
        // Blocks to the left of the centre hide what is farther than 0.58.
        for (i, min) in buffer.min.iter_mut().enumerate() {
            *min = encode(if i % 8 < 4 { 0.58 } else { 0.0 });
        }
        let mut corners = [QuadCorners::default(); 8];
        for mirrored in [false, true] {
            let band = buffer.band();
            let visible = VisibleQuads::of(
                Portable,
                &band,
                &points,
                &mesh,
                cluster,
                mirrored,
                &mut corners,
            );
            let mut blocks = [u32::MAX, u32::MAX, 0, 0];
            let (mut here, mut hidden) = (0, 0);
            for q in 0..usize::from(cluster.quad_count) {
                let corners: [[f32; 3]; 4] =
                    core::array::from_fn(|c| screen[usize::from(mesh.quads[q / 8][c][q % 8])]);
                let turn = |a: usize, b: usize, c: usize| {
                    let [a, b, c] = [a, b, c].map(|i| corners[i].map(f64::from));
                    (c[0] - a[0]) * (b[1] - a[1]) - (b[0] - a[0]) * (c[1] - a[1])
                };
                let sign = if mirrored { -1.0 } else { 1.0 };
                let front = sign * turn(0, 1, 2) > 0.0 || sign * turn(0, 2, 3) > 0.0;
                let end = |axis: usize, pick: fn(f32, f32) -> f32| {
                    let v = corners.iter().map(|c| c[axis]).reduce(pick).unwrap();
                    (v / BLOCK_SAMPLES as f32) as u32
                };
                let mine = [
                    end(0, f32::min),
                    end(1, f32::min),
                    end(0, f32::max),
                    end(1, f32::max),
                ];
                let nearest = corners.iter().map(|c| c[2]).fold(0.0, f32::max);
                let seen = mine[2] >= 4 || encode(nearest) > encode(0.58);
                let is_visible = visible.quads[q / 8] >> (q % 8) & 1 != 0;
                assert_eq!(is_visible, front && seen, "quad {q}, mirrored {mirrored}");
                here += u32::from(is_visible);
                hidden += u32::from(front && !seen);
                if is_visible {
                    blocks = [
                        blocks[0].min(mine[0]),
                        blocks[1].min(mine[1]),
                        blocks[2].max(mine[2]),
                        blocks[3].max(mine[3]),
                    ];
                }
            }
            assert!(here > 5 && hidden > 0, "{here} {hidden}");
            assert_eq!(visible.blocks, blocks);
        }
        buffer.min.fill(encode(0.7));
        let band = buffer.band();
        let visible = VisibleQuads::of(
            Portable,
            &band,
            &points,
            &mesh,
            cluster,
            false,
            &mut corners,
        );
        assert!(visible.is_empty());
    }
}
