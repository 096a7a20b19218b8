//! Terrains: meshes of a grid of heights, under the surface and coarser than it.
//!
//! A cell of four corners is cut along the diagonal that lies lower, so that its surface is convex.
//! Over a cell of samples the terrain is linear along some lines, whichever way it is cut, and so a
//! convex surface stands highest above it at a sample. Corners are lowered by the most that the
//! surface stands above any sample of the cells around: as much as the terrain bends there, however
//! steep it is.

use super::bake::{BakeOptions, MAX_TRIANGLES};
use super::mesh::OccluderMesh;
use crate::error::{CullError, Quantity};

impl OccluderMesh {
    /// Bakes a terrain of a grid of heights: sample `i` of row `j` lies at x = `i as f32 *
    /// spacing_m[0]`, z = `j as f32 * spacing_m[1]` and y = `heights[j * columns + i]`, all in metres
    /// and mesh space. It is seen from above (+y).
    ///
    /// Of `step` samples each way one is kept, and the surface is lowered so that it lies under the
    /// terrain everywhere: fewer triangles, which hide somewhat less. With a step of 1 it touches
    /// every sample. Steps of 4 to 8 suit terrains with a sample per metre.
    ///
    /// A height of NaN is a hole: coarse cells with such a sample are left out. The ground is solid
    /// besides: nothing is seen under the surface, neither through its sides nor, except over holes,
    /// from below. Mark the samples over a cave as holes.
    ///
    /// ```
    /// use foveal_cull::{BakeOptions, OccluderMesh};
    ///
    /// let heights: Vec<f32> = (0..65 * 65).map(|i| (i % 65) as f32 * 0.2).collect();
    /// let hill = OccluderMesh::from_heights(&heights, 65, [1.0, 1.0], 8, BakeOptions::default())?;
    /// assert_eq!(hill.triangle_count(), 2 * 8 * 8);
    /// // A slope that is even need not be lowered.
    /// assert!((hill.bounds().max[1] - 64.0 * 0.2).abs() < 1e-3);
    /// # Ok::<(), foveal_cull::CullError>(())
    /// ```
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if the heights are not whole rows, [`CullError::NotFinite`]
    /// for a spacing that is not finite, an infinite height, or a vertex beyond what `f32` holds,
    /// [`CullError::NotPositive`] for a spacing that is not above zero,
    /// [`CullError::TooManyTriangles`]. A `step` of 0 is one of 1, and fewer than two rows or
    /// columns have no triangles. `options.deformable` is not looked at.
    pub fn from_heights(
        heights: &[f32],
        columns: usize,
        spacing_m: [f32; 2],
        step: usize,
        options: BakeOptions,
    ) -> Result<Self, CullError> {
        let rows = heights.len().checked_div(columns).unwrap_or(0);
        if rows * columns != heights.len() {
            return Err(CullError::LengthMismatch {
                expected: rows.saturating_add(1).saturating_mul(columns),
                found: heights.len(),
            });
        }
        if !spacing_m.iter().all(|s| s.is_finite()) {
            return Err(CullError::NotFinite(Quantity::Spacing));
        }
        if !spacing_m.iter().all(|s| *s > 0.0) {
            return Err(CullError::NotPositive(Quantity::Spacing));
        }
        let is_extent = |count: usize, spacing: f32| place(count, spacing).is_finite();
        if !is_extent(columns, spacing_m[0])
            || !is_extent(rows, spacing_m[1])
            || heights.iter().any(|h| h.is_infinite())
        {
            return Err(CullError::NotFinite(Quantity::Position));
        }
        // Nothing bounds the one where the other is 0.
        if columns < 2 || rows < 2 {
            return Self::bake::<[f32; 3]>(&[], &[], options.with_deformable(false));
        }
        let grid = Grid {
            heights,
            columns,
            spacing_m,
            x: kept(columns, step),
            z: kept(rows, step),
        };
        let triangles = (2 * grid.cells_x()).saturating_mul(grid.cells_z());
        if triangles > MAX_TRIANGLES {
            return Err(CullError::TooManyTriangles {
                triangles,
                most: MAX_TRIANGLES,
            });
        }
        let corners = grid.lowered();
        let positions: Vec<[f32; 3]> = (grid.z.iter())
            .flat_map(|z| grid.x.iter().map(move |x| (*x, *z)))
            .zip(&corners)
            .map(|((x, z), &y)| [place(x, spacing_m[0]), y, place(z, spacing_m[1])])
            .collect();
        let indices = grid.triangles(&corners);
        Self::bake(&positions, &indices, options.with_deformable(false))
    }
}

/// The samples that are kept of `count`: every `step`th and the last.
fn kept(count: usize, step: usize) -> Vec<usize> {
    let last = count.saturating_sub(1);
    let mut kept: Vec<usize> = (0..last).step_by(step.max(1)).collect();
    kept.push(last);
    kept
}

/// Where a sample lies, rounded as the terrain's own vertices are.
fn place(sample: usize, spacing_m: f32) -> f32 {
    sample as f32 * spacing_m
}

/// The part of the way from one sample to another at which a third one lies.
fn part_of_way(sample: usize, [from, to]: [usize; 2], spacing_m: f32) -> f64 {
    let [at, from, to] = [sample, from, to].map(|s| f64::from(place(s, spacing_m)));
    (at - from) / (to - from)
}

/// The surface over a cell, by its corners at (0, 0), (0, 1), (1, 1) and (1, 0): the lower of its two
/// ways to be cut.
fn over([a, b, c, d]: [f64; 4], u: f64, v: f64) -> f64 {
    let one = if u < v {
        a * (1.0 - v) + b * (v - u) + c * u
    } else {
        a * (1.0 - u) + d * (u - v) + c * v
    };
    let other = if u + v < 1.0 {
        a * (1.0 - u - v) + b * v + d * u
    } else {
        c * (u + v - 1.0) + b * (1.0 - u) + d * (1.0 - v)
    };
    one.min(other)
}

fn rounded_down(height: f64) -> f32 {
    let near = height as f32;
    if f64::from(near) > height {
        near.next_down()
    } else {
        near
    }
}

/// Heights, and the columns and rows of samples where coarse cells meet.
struct Grid<'a> {
    heights: &'a [f32],
    columns: usize,
    spacing_m: [f32; 2],
    x: Vec<usize>,
    z: Vec<usize>,
}

impl Grid<'_> {
    fn cells_x(&self) -> usize {
        self.x.len() - 1
    }

    fn cells_z(&self) -> usize {
        self.z.len() - 1
    }

    /// The heights of corners, by row: their samples, less the largest height by which the surface
    /// over a cell around would stand above one of its samples.
    fn lowered(&self) -> Vec<f32> {
        let width = self.x.len();
        let mut lower_by = vec![0.0f64; width * self.z.len()];
        for cz in 0..self.cells_z() {
            for cx in 0..self.cells_x() {
                let excess = self.excess(cx, cz);
                for corner in [0, 1, width, width + 1] {
                    let lower_by = &mut lower_by[cz * width + cx + corner];
                    *lower_by = lower_by.max(excess);
                }
            }
        }
        let samples = (self.z.iter()).flat_map(|z| self.x.iter().map(|x| self.sample(*x, *z)));
        let corners = samples.zip(lower_by).map(|(h, by)| rounded_down(h - by));
        corners.collect()
    }

    fn sample(&self, column: usize, row: usize) -> f64 {
        f64::from(self.heights[row * self.columns + column])
    }

    /// How far the surface over a coarse cell, with corners at their samples, stands above a sample
    /// at most; 0 for a cell with a hole.
    fn excess(&self, cx: usize, cz: usize) -> f64 {
        if self.has_hole(cx, cz) {
            return 0.0;
        }
        let (x, z) = ([self.x[cx], self.x[cx + 1]], [self.z[cz], self.z[cz + 1]]);
        let ([x0, x1], [z0, z1]) = (x, z);
        let corners = [(x0, z0), (x0, z1), (x1, z1), (x1, z0)].map(|(x, z)| self.sample(x, z));
        let mut excess = 0.0f64;
        for row in z0..=z1 {
            let v = part_of_way(row, z, self.spacing_m[1]);
            for column in x0..=x1 {
                let u = part_of_way(column, x, self.spacing_m[0]);
                excess = excess.max(over(corners, u, v) - self.sample(column, row));
            }
        }
        excess
    }

    /// Whether a coarse cell has a sample that is a hole.
    fn has_hole(&self, cx: usize, cz: usize) -> bool {
        let (x, z) = (&self.x[cx..], &self.z[cz..]);
        (z[0]..=z[1]).any(|row| {
            let row = &self.heights[row * self.columns..];
            row[x[0]..=x[1]].iter().any(|h| h.is_nan())
        })
    }

    /// The triangles of cells without holes, two each, over the diagonal that lies lower.
    fn triangles(&self, corners: &[f32]) -> Vec<u32> {
        let width = self.x.len();
        let mut indices = Vec::with_capacity(6 * self.cells_x() * self.cells_z());
        for cz in 0..self.cells_z() {
            for cx in (0..self.cells_x()).filter(|&cx| !self.has_hole(cx, cz)) {
                let first = cz * width + cx;
                let cell = [first, first + width, first + width + 1, first + 1];
                let [a, b, c, d] = cell.map(|corner| f64::from(corners[corner]));
                let [i, j, k, l] = cell.map(|corner| corner as u32);
                indices.extend(if a + c <= b + d {
                    [i, j, k, i, k, l]
                } else {
                    [i, j, l, l, j, k]
                });
            }
        }
        indices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{Reference, Seen};
    use crate::{
        Aabb, Affine, Culler, Eye, FrameOptions, OccluderSet, Projection, SingleThread, View,
        Visibility,
    };
    use proptest::prelude::*;
    use std::sync::Arc;

    fn grid<'a>(heights: &'a [f32], columns: usize, step: usize) -> Grid<'a> {
        Grid {
            heights,
            columns,
            spacing_m: [1.0; 2],
            x: kept(columns, step),
            z: kept(heights.len() / columns, step),
        }
    }

    /// 21 km from the first sample places are rounded by a millimetre, and a steep surface stood some
    /// millimetres above the samples.
    #[test]
    fn samples_whose_places_are_rounded_do_not_lie_under_the_surface() {
        let (count, step, spacing) = (30_001, 10, 0.7);
        // Down and up, from coarse corner to coarse corner.
        let height = |i: usize| (i % 20).abs_diff(10) as f32 * 3.5;
        for (columns, spacing_m, stride) in [(count, [spacing, 1.0], 1), (2, [1.0, spacing], 2)] {
            let of = |k: usize| height(if stride == 1 { k % count } else { k / 2 });
            let heights: Vec<f32> = (0..2 * count).map(of).collect();
            let grid = grid(&heights, columns, step);
            let corners = Grid { spacing_m, ..grid }.lowered();
            for i in 0..count - 1 {
                let cell = [i / step, i / step + 1];
                let [a, b] = cell.map(|c| f64::from(corners[c * stride]));
                let surface = a + (b - a) * part_of_way(i, cell.map(|c| c * step), spacing);
                assert!(surface <= f64::from(height(i)) + 1e-9, "{i}: {surface}");
            }
        }
    }

    /// The height of a surface of triangles over (x, z), in samples; `None` where there is none.
    fn height_at(grid: &Grid<'_>, corners: &[f32], [x, z]: [f64; 2]) -> Option<f64> {
        let width = grid.x.len();
        let point = |i: u32| {
            let i = i as usize;
            let at = [grid.x[i % width] as f64, grid.z[i / width] as f64];
            [at[0], at[1], f64::from(corners[i])]
        };
        let indices = grid.triangles(corners);
        indices.as_chunks::<3>().0.iter().find_map(|t| {
            let [p, q, r] = t.map(point);
            let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            let [a, b, c] = [p, q, r].map(|p| [p[0], p[1]]);
            let whole = area(a, b, c);
            let at = [x, z];
            let weights = [area(at, b, c), area(a, at, c), area(a, b, at)].map(|w| w / whole);
            let inside = weights.iter().all(|w| *w >= -1e-9);
            inside.then(|| weights[0] * p[2] + weights[1] * q[2] + weights[2] * r[2])
        })
    }

    proptest! {
        #[test]
        fn surfaces_lie_under_the_terrain_whichever_way_its_cells_are_cut(
            columns in 2usize..12,
            rows in 2usize..12,
            step in 1usize..7,
            seed in any::<u64>(),
            holes in 0u64..3,
        ) {
            let mut state = seed | 1;
            let mut random = move || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                state >> 33
            };
            let heights: Vec<f32> = (0..columns * rows)
                .map(|_| match random() % 40 {
                    n if n < holes => f32::NAN,
                    _ => (random() % 1000) as f32 * 0.01,
                })
                .collect();
            let grid = grid(&heights, columns, step);
            let corners = grid.lowered();
            let mut under = 0;
            for _ in 0..60 {
                let at = [columns, rows].map(|n| {
                    (random() % 10_001) as f64 * 1e-4 * (n - 1) as f64
                });
                let cell = [at[0].floor().min(columns as f64 - 2.0), at[1].floor().min(rows as f64 - 2.0)];
                let (u, v) = (at[0] - cell[0], at[1] - cell[1]);
                let first = cell[1] as usize * columns + cell[0] as usize;
                let [a, b, c, d] = [0, columns, columns + 1, 1].map(|k| f64::from(heights[first + k]));
                // At the border of a coarse cell, the fine cell may be one of the next.
                if [a, b, c, d].iter().any(|height| height.is_nan()) {
                    continue;
                }
                // Cut along one diagonal, along the other, and bilinear.
                let one = if u < v { a * (1.0 - v) + b * (v - u) + c * u } else { a * (1.0 - u) + d * (u - v) + c * v };
                let other = if u + v < 1.0 { a * (1.0 - u - v) + b * v + d * u } else { c * (u + v - 1.0) + b * (1.0 - u) + d * (1.0 - v) };
                let smooth = (a * (1.0 - v) + b * v) * (1.0 - u) + (d * (1.0 - v) + c * v) * u;
                let Some(surface) = height_at(&grid, &corners, at) else {
                    let beside_a_hole = (0..grid.cells_z()).any(|z| {
                        (0..grid.cells_x()).any(|x| grid.has_hole(x, z))
                    });
                    prop_assert!(beside_a_hole);
                    continue;
                };
                under += 1;
                for terrain in [one, other, smooth] {
                    prop_assert!(surface <= terrain + 1e-9, "{surface} over {terrain} at {at:?}");
                }
            }
            prop_assert!(under > 0 || holes > 0);
        }
    }

    #[test]
    fn rows_without_end_that_are_none_make_an_empty_mesh() {
        let options = BakeOptions::default();
        let mesh = OccluderMesh::from_heights(&[], usize::MAX, [1.0; 2], 1, options).unwrap();
        assert_eq!(mesh.triangle_count(), 0);
    }

    #[test]
    fn steps_that_do_not_fit_keep_the_last_sample() {
        assert_eq!(kept(10, 4), [0, 4, 8, 9]);
        assert_eq!(kept(9, 4), [0, 4, 8]);
        assert_eq!(kept(3, 9), [0, 2]);
        assert_eq!(kept(1, 2), [0]);
        assert_eq!(kept(0, 0), [0]);
    }

    #[test]
    fn holes_are_left_out_with_their_cells() {
        let mut heights = vec![1.0; 81];
        heights[4 * 9 + 4] = f32::NAN;
        let triangles = |step| {
            let options = BakeOptions::default();
            let mesh = OccluderMesh::from_heights(&heights, 9, [2.0, 3.0], step, options).unwrap();
            let farthest = if step == 4 {
                [0.0; 3]
            } else {
                [16.0, 1.0, 24.0]
            };
            let max = mesh.bounds().max;
            assert!(
                (0..3).all(|k| (max[k] - farthest[k]).abs() < 1e-3),
                "{max:?}"
            );
            mesh.triangle_count()
        };
        assert_eq!(triangles(1), 2 * (64 - 4));
        // The sample is the corner of four cells, or lies within one of nine.
        assert_eq!(triangles(4), 0);
        assert_eq!(triangles(3), 2 * 8);
    }

    #[test]
    fn grids_that_are_none_are_errors() {
        let bake = |heights: &[f32], columns, spacing, step| {
            OccluderMesh::from_heights(heights, columns, spacing, step, BakeOptions::default())
                .map(|mesh| mesh.triangle_count())
        };
        let flat = [0.0; 12];
        assert_eq!(bake(&flat, 4, [1.0, 1.0], 0), Ok(12));
        assert_eq!(bake(&flat, 4, [1.0, 1.0], usize::MAX), Ok(2));
        assert_eq!(bake(&flat, 12, [1.0, 1.0], 1), Ok(0));
        assert_eq!(bake(&[], 0, [1.0, 1.0], 1), Ok(0));
        assert_eq!(bake(&[f32::NAN; 12], 4, [1.0, 1.0], 1), Ok(0));
        let mismatch = |expected, found| Err(CullError::LengthMismatch { expected, found });
        assert_eq!(bake(&flat, 5, [1.0, 1.0], 1), mismatch(15, 12));
        assert_eq!(bake(&flat, 0, [1.0, 1.0], 1), mismatch(0, 12));
        let position = CullError::NotFinite(Quantity::Position);
        for (bad, error) in [
            (0.0, CullError::NotPositive(Quantity::Spacing)),
            (-1.0, CullError::NotPositive(Quantity::Spacing)),
            (f32::NAN, CullError::NotFinite(Quantity::Spacing)),
            (f32::NEG_INFINITY, CullError::NotFinite(Quantity::Spacing)),
            // The last column or row would lie beyond what `f32` holds.
            (3e38, position),
        ] {
            assert_eq!(bake(&flat, 4, [bad, 1.0], 1), Err(error));
            assert_eq!(bake(&flat, 4, [1.0, bad], 1), Err(error));
        }
        let infinite = [0.0, 1.0, f32::NEG_INFINITY, 0.0];
        assert_eq!(bake(&infinite, 2, [1.0, 1.0], 1), Err(position));
    }

    #[test]
    fn hills_hide_what_lies_behind_them_and_nothing_that_is_visible() {
        let side = 97;
        let hill = |x: f64, z: f64| 12.0 * (x * 0.09).sin() * (z * 0.11).cos() + (x * 1.3).sin();
        let heights: Vec<f32> = (0..side * side)
            .map(|i| hill((i % side) as f64, (i / side) as f64) as f32)
            .collect();
        let fine: Vec<[f32; 3]> = (heights.iter().enumerate())
            .map(|(i, &y)| [(i % side) as f32, y, (i / side) as f32])
            .collect();
        let cells = (0..side - 1).flat_map(|z| (0..side - 1).map(move |x| (z * side + x) as u32));
        let w = side as u32;
        // Cut along the other diagonal in every second cell.
        let indices: Vec<u32> = cells
            .flat_map(|a| match a % 2 {
                0 => [a, a + w, a + w + 1, a, a + w + 1, a + 1],
                _ => [a, a + w, a + 1, a + 1, a + w, a + w + 1],
            })
            .collect();
        let (mut hidden, mut visible) = ([0; 2], 0);
        for (turn, eye) in [[5.0, 0.0, 5.0], [48.0, 0.0, 90.0], [70.0, 0.0, 20.0]]
            .iter()
            .enumerate()
        {
            let ground = hill(eye[0], eye[2]);
            let eye = [eye[0], ground + 3.0, eye[2]];
            let target = [48.0, ground, 48.0];
            let lens = Projection::perspective(1.2, 1.5, 0.1, f64::INFINITY);
            let eye = Eye::look_at(eye, target, [0.0, 1.0, 0.0], lens);
            let view = View::mono(eye);
            let mut reference = Reference::new(&eye, 96 * 4, 64 * 4).unwrap();
            reference.add(&fine, &indices, Affine::IDENTITY, false);
            reference.finish();
            let boxes: Vec<Aabb> = (0..900)
                .map(|i| {
                    let (x, z) = ((i % 30) as f32 * 3.1 + 1.0, (i / 30) as f32 * 3.1 + 1.0);
                    let y = hill(f64::from(x), f64::from(z)) as f32 + 0.2 + (i % 7) as f32 * 0.4;
                    Aabb::new([x, y, z], [x + 0.8, y + 1.2, z + 0.8])
                })
                .collect();
            for (k, step) in [1, 6].into_iter().enumerate() {
                let options = BakeOptions::default();
                let mesh = OccluderMesh::from_heights(&heights, side, [1.0, 1.0], step, options);
                let mut set = OccluderSet::new();
                set.add(Arc::new(mesh.unwrap()), Affine::IDENTITY).unwrap();
                let mut culler = Culler::new(96, 64).unwrap();
                let frame = FrameOptions::default();
                culler
                    .rasterize(&view, &set, &frame, &SingleThread)
                    .unwrap();
                let mut results = vec![Visibility::Visible; boxes.len()];
                culler.query(&boxes, [0.0; 3], &mut results).unwrap();
                for (bounds, result) in boxes.iter().zip(&results) {
                    let seen = reference.seen(bounds, [0.0; 3]);
                    visible += usize::from(seen == Seen::Visible);
                    if *result == Visibility::Occluded {
                        hidden[k] += 1;
                        assert_ne!(seen, Seen::Visible, "view {turn}, step {step}: {bounds:?}");
                    }
                }
            }
        }
        assert!(visible > 300, "{visible}");
        // A coarse surface hides less, but most of it.
        assert!(hidden[0] > 300 && hidden[1] <= hidden[0], "{hidden:?}");
        assert!(hidden[1] * 2 > hidden[0], "{hidden:?}");
    }
}
