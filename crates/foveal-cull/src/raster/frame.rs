//! One frame: which clusters are drawn, and in which order.
//!
//! Clusters are rejected by frustum, normal cone, size and detail before any vertex is transformed, then sorted
//! front to back by a key that belongs to their content (nearest distance, then a hash), so that the result
//! does not depend on the order in which occluders were added. Just before a cluster is drawn, its rectangle
//! is tested against the depth so far; one that is hidden there could not have changed anything.

use super::setup::{Facing, Radius, Scratch, draw_cluster};
use crate::depth::{BLOCK_SAMPLES, Band, SAMPLES, encode};
use crate::occluder::{Instance, OccluderSet};
use crate::query::project::{Projected8, Screen, project};
use crate::simd::{Kernel, Lanes};
use crate::view::Camera;
use crate::{Budget, CullStats};

/// A cluster that may be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Order: distance bits, then content hash.
    key: u64,
    instance: u32,
    cluster: u32,
    /// First and last block, inclusive.
    blocks: [u16; 4],
    code: i16,
    /// Not beyond the near plane everywhere: no depth test.
    crossing: bool,
}

/// What the frame keeps between its two steps, and from frame to frame (so nothing is allocated).
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameScratch {
    pub(crate) candidates: Vec<Candidate>,
    /// Clip rows per instance.
    pub(crate) rows: Vec<[[f32; 4]; 4]>,
}

/// Finds and sorts the candidates.
pub(crate) struct Select<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) set: &'a OccluderSet,
    pub(crate) scratch: &'a mut FrameScratch,
    pub(crate) stats: &'a mut CullStats,
    pub(crate) width: f32,
    pub(crate) height: f32,
    pub(crate) size_threshold: f32,
    pub(crate) pixels_per_quad: f32,
}

impl Kernel for Select<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self {
            camera,
            set,
            scratch,
            stats,
            width,
            height,
            size_threshold,
            pixels_per_quad,
        } = self;
        let samples_per_quad = pixels_per_quad * (SAMPLES * SAMPLES) as f32;
        scratch.candidates.clear();
        scratch.rows.resize(set.instances.len(), [[0.0; 4]; 4]);
        let small = f64::from(size_threshold) * f64::from(size_threshold) * camera.tan_half_fov_y;
        for (index, instance) in set.instances.iter().enumerate() {
            let Some(mesh) = instance.mesh.as_deref().filter(|_| instance.enabled) else {
                continue;
            };
            stats.occluder_models += 1;
            stats.occluder_triangles += mesh.triangle_count() as u64;
            stats.clusters += mesh.clusters.len() as u64;
            if outside(camera, instance, small, f64::from(width), f64::from(height)) {
                continue;
            }
            let rows = camera.object_rows(&instance.world_from_mesh, mesh.center);
            scratch.rows[index] = rows;
            let screen = Screen {
                rows,
                width,
                height,
                far_depth: camera.far_depth as f32 * 0.999_99,
                dilate: 0.0,
                grow: 0.0,
                coarse: None,
            };
            let eye = instance.mesh_from_world.transform_point3(camera.eye) - mesh.center;
            let forward = instance.mesh_from_world.transform_vector3(camera.forward);
            let (eye, forward) = (eye.as_vec3(), forward.as_vec3());
            for (g, bounds) in mesh.bounds8.iter().enumerate() {
                let p = project(l, &screen, bounds);
                let first = g * 8;
                let clusters = &mesh.clusters[first..mesh.clusters.len().min(first + 8)];
                for (i, cluster) in clusters.iter().enumerate() {
                    if p.outside >> i & 1 != 0 {
                        continue;
                    }
                    if !mesh.two_sided && cluster.faces_away(eye, forward, camera.orthographic) {
                        continue;
                    }
                    let Some(c) = candidate(&p, i, width, height) else {
                        continue;
                    };
                    let area = (p.x1[i] - p.x0[i]) * (p.y1[i] - p.y0[i]);
                    if !c.crossing && area < samples_per_quad * f32::from(cluster.quad_count) {
                        continue;
                    }
                    scratch.candidates.push(Candidate {
                        key: c.key | u64::from(cluster.hash ^ instance.hash),
                        instance: index as u32,
                        cluster: (first + i) as u32,
                        ..c
                    });
                }
            }
        }
        scratch.candidates.sort_unstable_by_key(|c| c.key);
    }
}

#[inline(always)]
fn candidate(p: &Projected8, i: usize, width: f32, height: f32) -> Option<Candidate> {
    let size = BLOCK_SAMPLES as f32;
    let crossing = p.crossing >> i & 1 != 0;
    let (bx, by) = (
        ((width - 1.0) / size) as u16,
        ((height - 1.0) / size) as u16,
    );
    let blocks = if crossing {
        [0, 0, bx, by]
    } else {
        // Nothing between two half-sample steps: no sample can be covered.
        if ((p.x0[i] * 2.0).floor() == (p.x1[i] * 2.0).floor())
            | ((p.y0[i] * 2.0).floor() == (p.y1[i] * 2.0).floor())
        {
            return None;
        }
        [
            ((p.x0[i] / size) as u16).min(bx),
            ((p.y0[i] / size) as u16).min(by),
            ((p.x1[i] / size) as u16).min(bx),
            ((p.y1[i] / size) as u16).min(by),
        ]
    };
    // Perspective: nearest distance; orthographic W is 1, so that the depth decides.
    let near = if crossing {
        0.0
    } else {
        (1.0 / p.depth[i]).max(0.0)
    };
    let code = if crossing {
        i16::MAX
    } else {
        encode(p.depth[i])
    };
    Some(Candidate {
        key: u64::from(near.to_bits()) << 32,
        instance: 0,
        cluster: 0,
        blocks,
        code,
        crossing,
    })
}

/// Whole-instance test: sphere against the frustum, and size.
fn outside(camera: &Camera, instance: &Instance, small: f64, width: f64, height: f64) -> bool {
    let c = instance.center - camera.eye;
    let r = instance.radius;
    let [x, y, z, w] = camera.rows.map(|row| row.truncate().dot(c) + row.w);
    let beyond = |value: f64, row: glam::DVec4| value < -r * row.truncate().length();
    let [rx, ry, rz, rw] = camera.rows;
    if beyond(x, rx)
        || beyond(width * w - x, rw * width - rx)
        || beyond(y, ry)
        || beyond(height * w - y, rw * height - ry)
    {
        return true;
    }
    // In front of the near plane, or beyond the far plane.
    if beyond(w - z, rw - rz) || beyond(z - w * camera.far_depth, rz - rw * camera.far_depth) {
        return true;
    }
    w > 1.0 && r * r < w * small
}

/// Draws the candidates into one band.
pub(crate) struct Draw<'a, 'b> {
    pub(crate) set: &'a OccluderSet,
    pub(crate) frame: &'a FrameScratch,
    pub(crate) band: Band<'b>,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) drawn: Option<&'a mut Vec<u32>>,
    pub(crate) budget: Option<Budget<'a>>,
    pub(crate) radius: Option<Radius>,
}

impl Kernel for Draw<'_, '_> {
    type Output = u64;

    /// Gives the number of clusters that the budget left out.
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> u64 {
        let Self {
            set,
            frame,
            mut band,
            scratch,
            mut drawn,
            budget,
            radius,
        } = self;
        let (row0, row1) = (
            band.first_row as u16,
            (band.first_row + band.rows - 1) as u16,
        );
        for (n, c) in frame.candidates.iter().enumerate() {
            if let Some(b) = budget
                && n % 16 == 0
                && (b.clock)() >= b.deadline_ns
            {
                return (frame.candidates.len() - n) as u64;
            }
            let [x0, y0, x1, y1] = c.blocks;
            let (y0, y1) = (y0.max(row0), y1.min(row1));
            if y0 > y1 || (!c.crossing && hidden(&band, [x0, y0, x1, y1], c.code)) {
                continue;
            }
            let instance = &set.instances[c.instance as usize];
            let Some(mesh) = instance.mesh.as_deref() else {
                continue;
            };
            if let Some(drawn) = drawn.as_deref_mut() {
                drawn.push(n as u32);
            }
            let facing = Facing {
                mirrored: instance.mirrored,
                two_sided: mesh.two_sided,
                radius,
            };
            draw_cluster(
                l,
                &mut band,
                scratch,
                mesh,
                &mesh.clusters[c.cluster as usize],
                &frame.rows[c.instance as usize],
                facing,
            );
        }
        0
    }
}

impl Candidate {
    pub(crate) fn place(&self) -> (u32, u32) {
        (self.instance, self.cluster)
    }
}

#[inline(always)]
fn hidden(band: &Band<'_>, [x0, y0, x1, y1]: [u16; 4], code: i16) -> bool {
    for y in y0..=y1 {
        let row = (u32::from(y) - band.first_row) * band.blocks_x;
        let row = &band.min[(row + u32::from(x0)) as usize..=(row + u32::from(x1)) as usize];
        if row.iter().any(|&m| code > m) {
            return false;
        }
    }
    true
}
