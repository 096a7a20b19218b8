//! A scene as a coarse voxel grid that remembers which way surfaces face.

use foveal_scene::{Aabb, AlphaMode, Scene};
use glam::{IVec3, Vec3};

/// Cells along the scene's longest edge.
const RESOLUTION: f32 = 72.0;
/// Most points to spread triangles with: a second's work.
const MOST_POINTS: u64 = 50_000_000;

/// The scene's surfaces: area per cell, by the six axis directions that they face.
pub(super) struct Grid {
    /// The scene's box.
    pub(super) bounds: Aabb,
    /// A cell's edge in metres.
    pub(super) cell_m: f32,
    cells: IVec3,
    /// Square metres that face +x, +y, +z, and −x, −y, −z.
    area: Vec<[Vec3; 2]>,
}

/// What a ray meets first, after how many metres.
pub(super) enum Hit {
    Front(f32),
    Back(f32),
    Nothing(f32),
}

impl Grid {
    /// `None` where the scene is empty, or so full of large triangles that it would take long.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let bounds = scene.bounds();
        let size = bounds.size();
        let cell_m = size.max_element() / RESOLUTION;
        if bounds.is_empty() || !(cell_m > 0.0 && cell_m.is_finite()) {
            return None;
        }
        let cells = (size / cell_m).ceil().as_ivec3().max(IVec3::ONE);
        let count = cells.x as usize * cells.y as usize * cells.z as usize;
        let mut grid = Self {
            bounds,
            cell_m,
            cells,
            area: vec![[Vec3::ZERO; 2]; count],
        };
        let mut points = 0;
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            let material = scene.materials.get(instance.material as usize);
            let is_glass = material.is_some_and(|m| m.alpha_mode == AlphaMode::Blend);
            if is_glass || !scene.is_visible(instance) {
                continue;
            }
            let mirrored = instance.world_from_object.determinant() < 0.0;
            for triangle in mesh.indices.as_chunks::<3>().0 {
                let corner = |i: usize| {
                    let position = mesh.vertices[triangle[i] as usize].position;
                    instance.world_from_object.transform_point3(position.into())
                };
                let [a, b, c] = [
                    corner(0),
                    corner(if mirrored { 2 } else { 1 }),
                    corner(if mirrored { 1 } else { 2 }),
                ];
                points += grid.add_triangle(a, b, c);
                if points > MOST_POINTS {
                    return None;
                }
            }
        }
        Some(grid)
    }

    /// Spreads a triangle's area over the cells that it passes, by points less than a cell apart;
    /// gives their number.
    fn add_triangle(&mut self, a: Vec3, b: Vec3, c: Vec3) -> u64 {
        let normal_area = 0.5 * (b - a).cross(c - a);
        if !normal_area.is_finite() || normal_area == Vec3::ZERO {
            return 0;
        }
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let steps = (longest / (0.6 * self.cell_m))
            .ceil()
            .clamp(1.0, 4.0 * RESOLUTION) as i32;
        let share = normal_area / (steps * steps) as f32;
        for i in 0..steps {
            for j in 0..steps - i {
                let (u, v) = (
                    (i as f32 + 0.33) / steps as f32,
                    (j as f32 + 0.33) / steps as f32,
                );
                let point = a + (b - a) * u + (c - a) * v;
                let Some(cell) = self.cell(point).and_then(|index| self.area.get_mut(index)) else {
                    continue;
                };
                cell[0] += share.max(Vec3::ZERO);
                cell[1] += (-share).max(Vec3::ZERO);
            }
        }
        steps as u64 * (steps as u64 + 1) / 2
    }

    /// No surface passes the point's cell.
    pub(super) fn is_free(&self, point: Vec3) -> bool {
        self.cell(point)
            .is_some_and(|index| self.area[index] == [Vec3::ZERO; 2])
    }

    fn cell(&self, point: Vec3) -> Option<usize> {
        let cell = ((point - self.bounds.min) / self.cell_m).floor().as_ivec3();
        // The upper faces of the box belong to the last cells.
        let cell = cell.min(self.cells - 1).max(IVec3::ZERO);
        let outside = (point - self.bounds.center())
            .abs()
            .cmpgt(0.5 * self.bounds.size() + 1e-3 * self.cell_m);
        (!outside.any())
            .then(|| ((cell.z * self.cells.y + cell.y) * self.cells.x + cell.x) as usize)
    }

    /// Follows a ray, half a cell at a time.
    pub(super) fn cast(&self, origin: Vec3, direction: Vec3) -> Hit {
        let step_m = 0.5 * self.cell_m;
        let mut distance_m = step_m;
        while let Some(index) = self.cell(origin + direction * distance_m) {
            let [positive, negative] = self.area[index];
            if positive + negative != Vec3::ZERO {
                let (along, against) = (direction.max(Vec3::ZERO), (-direction).max(Vec3::ZERO));
                let front = against.dot(positive) + along.dot(negative);
                let back = along.dot(positive) + against.dot(negative);
                if front >= 0.5 * back && front > 0.0 {
                    return Hit::Front(distance_m);
                }
                if back > 0.0 {
                    return Hit::Back(distance_m);
                }
            }
            distance_m += step_m;
        }
        Hit::Nothing(distance_m)
    }
}
