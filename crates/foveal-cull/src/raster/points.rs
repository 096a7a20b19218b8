//! Vertices on the screen, and the transform that puts them there.

use crate::occluder::vertices::Vertices;

/// Vertices beyond this many samples go to the clipper. Below it `f32` keeps 1/256 of a sample.
pub(crate) const GUARD: f64 = 32768.0;

/// Vertices on the screen, samples.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    /// Rounded, for everything but coverage; NaN in x for vertices that the clipper must see.
    pub(crate) x: [f32; 256],
    pub(crate) y: [f32; 256],
    pub(crate) depth: [f32; 256],
    /// Exact, for coverage.
    pub(super) exact_x: [f64; 256],
    pub(super) exact_y: [f64; 256],
}

impl Points {
    pub(crate) fn set(&mut self, i: usize, x: f64, y: f64, depth: f32) {
        (self.x[i], self.y[i], self.depth[i]) = (x as f32, y as f32, depth);
        (self.exact_x[i], self.exact_y[i]) = (x, y);
    }
}

impl Default for Points {
    fn default() -> Self {
        Self {
            x: [0.0; 256],
            y: [0.0; 256],
            depth: [0.0; 256],
            exact_x: [0.0; 256],
            exact_y: [0.0; 256],
        }
    }
}

/// Fills `points` from `at` on. Vertices for the clipper get NaN, which no test accepts; returns
/// whether there are any.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn transform(
    points: &mut Points,
    at: usize,
    (v, first, n): (&Vertices, usize, usize),
    rows: &[[f64; 4]; 4],
) -> bool {
    let xyz = v.x[first..first + n]
        .iter()
        .zip(&v.y[first..first + n])
        .zip(&v.z[first..first + n]);
    let rounded = points.x[at..]
        .iter_mut()
        .zip(&mut points.y[at..])
        .zip(&mut points.depth[at..]);
    let exact = points.exact_x[at..]
        .iter_mut()
        .zip(&mut points.exact_y[at..]);
    let [rx, ry, rz, rw] = rows;
    let mut beyond = 0;
    for ((((x, y), z), ((ox, oy), od)), (ex, ey)) in xyz.zip(rounded).zip(exact) {
        let (x, y, z) = (f64::from(*x), f64::from(*y), f64::from(*z));
        let cx = (x * rx[0] + y * rx[1]) + (z * rx[2] + rx[3]);
        let cy = (x * ry[0] + y * ry[1]) + (z * ry[2] + ry[3]);
        let cz = (x * rz[0] + y * rz[1]) + (z * rz[2] + rz[3]);
        let cw = (x * rw[0] + y * rw[1]) + (z * rw[2] + rw[3]);
        let inv = 1.0 / cw;
        let (sx, sy) = (cx * inv, cy * inv);
        // Beyond the near plane (Z < W, where W is above zero too) and within the guard band.
        let inside = (cz < cw) & (sx.abs() < GUARD) & (sy.abs() < GUARD);
        beyond |= i32::from(!inside);
        *ox = if inside { sx as f32 } else { f32::NAN };
        *oy = sy as f32;
        *od = (cz * inv) as f32;
        (*ex, *ey) = (sx, sy);
    }
    beyond != 0
}
