//! The reference: what is really visible, sample by sample. Slow and exact, for tests and checks.
//!
//! Occluders are rasterized in `f64` with one sample per point and without any shortcut: no
//! welding, no quads, no order, no quantized depth. A box is visible if at any sample the ray
//! through it enters the box before it meets an occluder. Use the culler's own size, or several
//! times that size per axis.
//!
//! Needs the feature `reference`. Rasterizing takes seconds for large scenes.

use crate::bounds::Aabb;
use crate::camera::Camera;
use crate::error::CullError;
use crate::limits::MAX_SIDE_PX;
use crate::projection::clip::{ClipPolygon, NEAR};
use crate::transform::Affine;
use crate::view::{Eye, View};
use glam::{DVec3, DVec4, Vec3};

/// The reference's result for a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// No sample's ray meets the box between the near and the far plane.
    Outside,
    /// Rays meet the box, all behind occluders.
    Hidden,
    /// At least one sample sees the box.
    Visible,
}

/// Exact depth of one eye.
#[derive(Clone, Debug)]
pub struct Reference {
    width: usize,
    height: usize,
    /// Nearest occluder depth per sample (near / distance, or linear); 0 where there is none.
    depth: Vec<f32>,
    /// Farthest depth per tile.
    tiles: Vec<f32>,
    camera: Camera,
}

/// The largest width and height of a reference, samples: those of the largest culler. Its depth
/// takes 1 GiB.
pub const MAX_SIDE_SAMPLES: u32 = 4 * MAX_SIDE_PX;

const TILE: usize = 16;

impl Reference {
    /// An empty reference of `width` x `height` samples. For n times the resolution of a culler,
    /// pass n times its size. It takes 4 bytes a sample.
    ///
    /// # Errors
    /// [`CullError::BadReference`] for a side of 0 or of more than [`MAX_SIDE_SAMPLES`],
    /// [`CullError::BadView`] or [`CullError::NotFinite`] for a bad view.
    pub fn new(eye: &Eye, width: u32, height: u32) -> Result<Self, CullError> {
        let is_side = |side| (1..=MAX_SIDE_SAMPLES).contains(&side);
        if !is_side(width) || !is_side(height) {
            return Err(CullError::BadReference { width, height });
        }
        let (w, h) = (width as usize, height as usize);
        let camera = Camera::new(&View::mono(*eye), f64::from(width), f64::from(height))?;
        Ok(Self {
            width: w,
            height: h,
            depth: vec![0.0; w * h],
            tiles: Vec::new(),
            camera,
        })
    }

    /// Adds occluder triangles: positions in mesh space (metres), counter-clockwise from outside,
    /// and their placement in the world. Both sides occlude if `two_sided`. Triangles with an index
    /// out of range are left out.
    pub fn add<P: Copy + Into<[f32; 3]>>(
        &mut self,
        positions: &[P],
        indices: &[u32],
        world_from_mesh: impl Into<Affine>,
        two_sided: bool,
    ) {
        let world_from_mesh = world_from_mesh.into().to_glam();
        self.tiles.clear();
        let mirrored = world_from_mesh.matrix3.determinant() < 0.0;
        let clip: Vec<DVec4> = positions
            .iter()
            .map(|&p| {
                let p = Vec3::from(p.into()).as_dvec3();
                let p = (world_from_mesh.transform_point3(p) - self.camera.eye).extend(1.0);
                DVec4::from_array(self.camera.rows.map(|r| r.dot(p)))
            })
            .collect();
        for t in indices.chunks_exact(3) {
            let Some([a, b, c]) = [t[0], t[1], t[2]]
                .map(|i| clip.get(i as usize).copied())
                .into_iter()
                .collect::<Option<Vec<_>>>()
                .and_then(|v| <[DVec4; 3]>::try_from(v).ok())
            else {
                continue;
            };
            let mut polygon = ClipPolygon::new(&[a, b, c]);
            polygon.clip(NEAR);
            let corners: Vec<[f64; 3]> = polygon.corners[..polygon.count]
                .iter()
                .map(|c| [c.x / c.w, c.y / c.w, c.z / c.w])
                .collect();
            self.polygon(&corners, mirrored, two_sided);
        }
    }

    fn polygon(&mut self, p: &[[f64; 3]], mirrored: bool, two_sided: bool) {
        if p.len() < 3 {
            return;
        }
        // Twice the area, positive where it faces the eye (y points down).
        let area: f64 = (0..p.len())
            .map(|i| {
                let (a, b) = (p[i], p[(i + 1) % p.len()]);
                (a[1] - p[0][1]) * (b[0] - p[0][0]) - (a[0] - p[0][0]) * (b[1] - p[0][1])
            })
            .sum();
        let front = if mirrored { area < 0.0 } else { area > 0.0 };
        if area == 0.0 || !(front || two_sided) {
            return;
        }
        // The plane of the largest triangle of the fan.
        let mut best = (0.0f64, 1);
        for i in 1..p.len() - 1 {
            let e = (p[i][0] - p[0][0]) * (p[i + 1][1] - p[0][1])
                - (p[i + 1][0] - p[0][0]) * (p[i][1] - p[0][1]);
            if e.abs() > best.0.abs() {
                best = (e, i);
            }
        }
        let (e, i) = best;
        if e == 0.0 {
            return;
        }
        let sub = |k: usize| [p[k][0] - p[0][0], p[k][1] - p[0][1], p[k][2] - p[0][2]];
        let (b, c) = (sub(i), sub(i + 1));
        let gx = (b[2] * c[1] - c[2] * b[1]) / e;
        let gy = (b[0] * c[2] - c[0] * b[2]) / e;
        let (lo, hi) = p
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
                (lo.min(v[2]), hi.max(v[2]))
            });
        let (top, bottom) = p
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
                (lo.min(v[1]), hi.max(v[1]))
            });
        let first = (top - 0.5).ceil().max(0.0) as usize;
        let last = (bottom - 0.5).floor().min(self.height as f64 - 1.0);
        if last < 0.0 {
            return;
        }
        for row in first..=last as usize {
            let y = row as f64 + 0.5;
            // The polygon's span on this row, from the edges that meet it.
            let (mut x0, mut x1) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..p.len() {
                let (a, b) = (p[k], p[(k + 1) % p.len()]);
                let (a, b) = if a[1] <= b[1] { (a, b) } else { (b, a) };
                if a[1] > y || b[1] < y {
                    continue;
                }
                let xs = if a[1] == b[1] {
                    [a[0], b[0]]
                } else {
                    [a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1])); 2]
                };
                x0 = x0.min(xs[0]).min(xs[1]);
                x1 = x1.max(xs[0]).max(xs[1]);
            }
            let start = (x0 - 0.5).ceil().max(0.0);
            let end = (x1 - 0.5).floor().min(self.width as f64 - 1.0);
            if start > end {
                continue;
            }
            for column in start as usize..=end as usize {
                let d = p[0][2] + gx * (column as f64 + 0.5 - p[0][0]) + gy * (y - p[0][1]);
                let d = d.clamp(lo, hi) as f32;
                let at = &mut self.depth[row * self.width + column];
                *at = at.max(d);
            }
        }
    }

    /// Finishes the depth after the last [`Reference::add`]. Queries are right without it, only
    /// slower.
    pub fn finish(&mut self) {
        let tw = self.width.div_ceil(TILE);
        let mut tiles = vec![f32::INFINITY; tw * self.height.div_ceil(TILE)];
        for (y, row) in self.depth.chunks_exact(self.width).enumerate() {
            for (x, &d) in row.iter().enumerate() {
                let t = &mut tiles[y / TILE * tw + x / TILE];
                *t = t.min(d);
            }
        }
        self.tiles = tiles;
    }

    /// Depth of the nearest occluder per sample, row by row from the top left; 0 where there is
    /// none.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }

    /// Classifies one box, in metres relative to `origin` (world). O(samples of its screen
    /// rectangle).
    #[must_use]
    pub fn seen(&self, bounds: &Aabb, origin: impl Into<[f64; 3]>) -> Seen {
        self.seen_from(bounds, DVec3::from(origin.into()))
    }

    fn seen_from(&self, bounds: &Aabb, origin: DVec3) -> Seen {
        if !bounds.is_valid() {
            return Seen::Visible;
        }
        let lo = Vec3::from(bounds.min).as_dvec3() + origin - self.camera.eye;
        let hi = Vec3::from(bounds.max).as_dvec3() + origin - self.camera.eye;
        let corners: [DVec4; 8] = core::array::from_fn(|i| {
            let pick = |bit: usize, a: f64, b: f64| if i & bit == 0 { a } else { b };
            let p = DVec3::new(
                pick(1, lo.x, hi.x),
                pick(2, lo.y, hi.y),
                pick(4, lo.z, hi.z),
            )
            .extend(1.0);
            DVec4::from_array(self.camera.rows.map(|r| r.dot(p)))
        });
        // Wholly behind one frustum plane. All are linear, so the corners decide.
        let (w, h) = (self.width as f64, self.height as f64);
        if corners.iter().all(|c| c.z > c.w)
            || corners.iter().all(|c| c.x < 0.0)
            || corners.iter().all(|c| c.x > w * c.w)
            || corners.iter().all(|c| c.y < 0.0)
            || corners.iter().all(|c| c.y > h * c.w)
        {
            return Seen::Outside;
        }
        let (mut rect, mut nearest) = ([0.0, 0.0, w - 1.0, h - 1.0], 1.0);
        if corners.iter().all(|c| c.z < c.w) {
            rect = [
                f64::INFINITY,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::NEG_INFINITY,
            ];
            nearest = 0.0f64;
            for c in corners {
                let (x, y) = (c.x / c.w - 0.5, c.y / c.w - 0.5);
                rect = [
                    rect[0].min(x),
                    rect[1].min(y),
                    rect[2].max(x),
                    rect[3].max(y),
                ];
                nearest = nearest.max(c.z / c.w);
            }
            rect = [
                rect[0].ceil().max(0.0),
                rect[1].ceil().max(0.0),
                rect[2].floor().min(w - 1.0),
                rect[3].floor().min(h - 1.0),
            ];
        }
        if rect[0] > rect[2] || rect[1] > rect[3] {
            return Seen::Outside;
        }
        let [x0, y0, x1, y1] = rect.map(|v| v as usize);
        let tw = self.width.div_ceil(TILE);
        let mut met = false;
        for ty in y0 / TILE..=y1 / TILE {
            for tx in x0 / TILE..=x1 / TILE {
                let closed = self
                    .tiles
                    .get(ty * tw + tx)
                    .is_some_and(|&t| f64::from(t) > nearest);
                if closed {
                    // Whether the box meets this tile decides between hidden and outside only.
                    met = true;
                    continue;
                }
                for y in y0.max(ty * TILE)..=y1.min(ty * TILE + TILE - 1) {
                    for x in x0.max(tx * TILE)..=x1.min(tx * TILE + TILE - 1) {
                        let d = self.depth[y * self.width + x];
                        // Nothing of the box is as near as the occluder here.
                        if f64::from(d) > nearest {
                            met = true;
                            continue;
                        }
                        let Some(entry) = self.entry(x, y, lo, hi) else {
                            continue;
                        };
                        met = true;
                        if d == 0.0 || entry > f64::from(d) {
                            return Seen::Visible;
                        }
                    }
                }
            }
        }
        if met { Seen::Hidden } else { Seen::Outside }
    }

    /// Depth at which the ray through a sample enters the box (relative to the eye), between near
    /// and far.
    fn entry(&self, x: usize, y: usize, lo: DVec3, hi: DVec3) -> Option<f64> {
        let [rx, ry, rz, rw] = self.camera.rows;
        let (sx, sy) = (x as f64 + 0.5, y as f64 + 0.5);
        // Points with X = sx W and Y = sy W, as start + t * direction, where t grows away from the
        // eye.
        let a = rx - rw * sx;
        let b = ry - rw * sy;
        let direction = a.truncate().cross(b.truncate());
        let direction = direction * direction.dot(self.camera.forward).signum();
        let start = if self.camera.orthographic {
            // The point of the line that is nearest to the eye.
            let (n0, n1) = (a.truncate(), b.truncate());
            let (g00, g01, g11) = (n0.dot(n0), n0.dot(n1), n1.dot(n1));
            let det = g00 * g11 - g01 * g01;
            n0 * ((-a.w * g11 + b.w * g01) / det) + n1 * ((-b.w * g00 + a.w * g01) / det)
        } else {
            DVec3::ZERO
        };
        // The slab test.
        let (mut t0, mut t1) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (s, d) = (start[axis], direction[axis]);
            if d == 0.0 {
                if s < lo[axis] || s > hi[axis] {
                    return None;
                }
                continue;
            }
            let (u, v) = ((lo[axis] - s) / d, (hi[axis] - s) / d);
            t0 = t0.max(u.min(v));
            t1 = t1.min(u.max(v));
        }
        // Distance along the view direction is linear in t; cut at near and far.
        let depth = |t: f64| {
            let p = (start + direction * t).extend(1.0);
            rz.dot(p) / rw.dot(p)
        };
        let along = self.camera.forward.dot(direction);
        let s0 = self.camera.forward.dot(start);
        let t_near = (self.camera.near - s0) / along;
        t0 = t0.max(t_near);
        if t0 > t1 {
            return None;
        }
        let d = depth(t0).min(1.0);
        (d >= self.camera.far_depth).then_some(d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Projection;

    #[test]
    fn a_reference_without_samples_or_of_too_many_is_refused() {
        let lens = Projection::perspective(1.0, 1.0, 0.1, 9.0);
        let eye = Eye::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], lens);
        for side in [0, MAX_SIDE_SAMPLES + 1, u32::MAX] {
            for (width, height) in [(side, 3), (3, side)] {
                let error = Reference::new(&eye, width, height).err().unwrap();
                assert_eq!(error, CullError::BadReference { width, height });
                let limit = format!("1 to {MAX_SIDE_SAMPLES} samples");
                assert!(error.to_string().contains(&limit), "{error}");
            }
        }
        for (width, height) in [(1, 1), (MAX_SIDE_SAMPLES, 1), (1, MAX_SIDE_SAMPLES)] {
            let mut reference = Reference::new(&eye, width, height).unwrap();
            reference.finish();
            assert_eq!(reference.depth().len(), (width * height) as usize);
        }
    }
}
