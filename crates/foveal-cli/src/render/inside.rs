//! A good view for scenes that bring no camera and are buildings: from within.
//!
//! An overview from outside shows a building's outer walls only. So the scene is put into a coarse voxel grid, and
//! a place in it is *inside* when every horizontal ray from it meets a surface, nearly all of them the front of one, and
//! the floor is below: in a room the walls face the viewer, whereas inside a solid thing (a helmet, a duck) one
//! sees backs of surfaces. Fronts go by the winding, even of double-sided materials: a solid that is drawn from
//! both sides is still solid. Among the places inside the camera takes one that is roomy and has a long view.

use foveal_scene::{Aabb, AlphaMode, Camera, Scene};
use glam::{IVec3, Vec3};

/// Cells along the scene's longest edge.
const RESOLUTION: f32 = 72.0;
/// Places to try along each edge of the scene's box.
const PLACES: [i32; 3] = [16, 8, 16];
/// Directions around.
const HEADINGS: usize = 16;
/// Slopes (rise per run) of the rays that judge a view: a picture is wider than high.
const SLOPES: [f32; 3] = [-0.25, 0.0, 0.35];
/// Least width and depth in metres of a scene that one can be in, and least room around the eye. A helmet with
/// a modelled lining has an inside too, but nobody wants to look at it from there.
const LEAST_SIZE_M: f32 = 3.0;
const LEAST_ROOM_M: f32 = 0.4;
/// Of a view's rays, how many may meet the back of a surface (a curtain's, say).
const MOST_BACKS: usize = HEADINGS * SLOPES.len() / 6;

/// The camera inside, or `None` where the scene has no inside.
pub(super) fn camera(scene: &Scene, fov_y_rad: f32) -> Option<Camera> {
    let grid = Grid::of(scene)?;
    let (size, min) = (grid.bounds.size(), grid.bounds.min);
    let mut best: Option<(f32, Vec3, Vec3)> = None;
    for y in 0..PLACES[1] {
        for z in 0..PLACES[2] {
            for x in 0..PLACES[0] {
                let place = (IVec3::new(x, y, z).as_vec3() + 0.5) / IVec3::from(PLACES).as_vec3();
                let eye = min + place * size;
                if let Some((score, forward)) = grid.best_view(eye)
                    && best.is_none_or(|(highest, ..)| score > highest)
                {
                    best = Some((score, eye, forward));
                }
            }
        }
    }
    let (_, eye, forward) = best?;
    let camera = Camera::look_at(eye, eye + forward, Vec3::Y, fov_y_rad);
    Some(Camera {
        name: "inside".to_owned(),
        ..camera
    })
}

/// The scene's surfaces: area per cell, by the six axis directions that they face.
struct Grid {
    bounds: Aabb,
    cell_m: f32,
    cells: IVec3,
    /// +x, +y, +z, −x, −y, −z.
    area: Vec<[Vec3; 2]>,
}

/// What a ray meets first, after how many metres.
enum Hit {
    Front(f32),
    Back(f32),
    Nothing(f32),
}

impl Grid {
    fn of(scene: &Scene) -> Option<Self> {
        let bounds = scene.bounds();
        let size = bounds.size();
        let cell_m = size.max_element() / RESOLUTION;
        if !(size.x >= LEAST_SIZE_M && size.z >= LEAST_SIZE_M && size.y > 0.0 && cell_m.is_finite())
        {
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
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            let material = scene.materials.get(instance.material as usize);
            if material.is_some_and(|m| m.alpha_mode == AlphaMode::Blend) {
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
                grid.add_triangle(a, b, c);
            }
        }
        Some(grid)
    }

    /// Spreads a triangle's area over the cells that it passes, by points less than a cell apart.
    fn add_triangle(&mut self, a: Vec3, b: Vec3, c: Vec3) {
        let normal_area = 0.5 * (b - a).cross(c - a);
        if !normal_area.is_finite() || normal_area == Vec3::ZERO {
            return;
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

    fn cast(&self, origin: Vec3, direction: Vec3) -> Hit {
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

    /// How far one sees from `eye` in the best direction, and that direction; `None` outside and in walls.
    fn best_view(&self, eye: Vec3) -> Option<(f32, Vec3)> {
        if self
            .cell(eye)
            .is_none_or(|index| self.area[index] != [Vec3::ZERO; 2])
        {
            return None;
        }
        if !matches!(self.cast(eye, Vec3::NEG_Y), Hit::Front(_)) {
            return None;
        }
        let mut sight_m = [0.0f32; HEADINGS];
        let mut backs = 0;
        for (heading, sight_m) in sight_m.iter_mut().enumerate() {
            for slope in SLOPES {
                let direction = (heading_direction(heading) + slope * Vec3::Y).normalize();
                let distance_m = match self.cast(eye, direction) {
                    Hit::Front(distance_m) => distance_m,
                    Hit::Back(distance_m) => {
                        backs += 1;
                        distance_m
                    }
                    // Without a roof it is still a courtyard.
                    Hit::Nothing(distance_m) if slope > 0.0 => distance_m,
                    Hit::Nothing(_) => return None,
                };
                if distance_m < LEAST_ROOM_M.max(2.0 * self.cell_m) || backs > MOST_BACKS {
                    return None;
                }
                *sight_m += distance_m;
            }
        }
        let room_m: f32 = sight_m.iter().sum();
        (0..HEADINGS)
            .map(|heading| {
                let forward = heading_direction(heading);
                let view_m: f32 = [HEADINGS - 1, 0, 1]
                    .map(|turn| sight_m[(heading + turn) % HEADINGS])
                    .iter()
                    .sum();
                let middle = eye + forward * (0.5 * view_m / (3 * SLOPES.len()) as f32);
                (view_m * room_m.sqrt() * self.centrality(middle), forward)
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// 1 in the middle of the ground, less towards the walls and the roof: the way around a building gives long
    /// views as well, but the building is what the scene is about.
    fn centrality(&self, point: Vec3) -> f32 {
        let place = (point - self.bounds.min) / self.bounds.size();
        let across = (1.0 - (2.0 * place - 1.0).abs()).max(Vec3::splat(0.05));
        across.x * across.z * (1.2 - place.y)
    }
}

fn heading_direction(heading: usize) -> Vec3 {
    let (sin, cos) = (heading as f32 / HEADINGS as f32 * std::f32::consts::TAU).sin_cos();
    Vec3::new(cos, 0.0, sin)
}

#[cfg(test)]
mod tests {
    use foveal_scene::{Instance, Material, Mesh, Object, Vertex};
    use glam::Mat4;

    use super::*;

    /// A box of 12 x 3 x 4 m whose faces look outwards, or inwards when the transform mirrors them.
    fn hollow_box(world_from_object: Mat4) -> Scene {
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::new(12.0, 3.0, 4.0),
        };
        let vertex = |p: Vec3| Vertex {
            position: p.into(),
            normal: [0.0; 3],
            tangent: [0.0; 4],
            uv: [[0.0; 2]; 2],
            color: [255; 4],
            reserved: 0,
        };
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let indices = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [a, b, c, a, c, d])
            .collect();
        let mesh = Mesh {
            vertices: bounds.corners().map(vertex).to_vec(),
            indices,
            bounds,
            ..Mesh::default()
        };
        let bounds = bounds.transformed(world_from_object);
        Scene {
            meshes: vec![mesh],
            materials: vec![Material::default()],
            objects: vec![Object {
                name: String::new(),
                node: 0,
                element: 0,
                occluder: None,
                set: None,
                bounds,
                instances: 0..1,
            }],
            instances: vec![Instance {
                mesh: 0,
                material: 0,
                object: 0,
                world_from_object,
                bounds,
            }],
            ..Scene::default()
        }
    }

    /// The same box seen from within: its faces are turned over by exchanging two corners of each.
    fn room() -> Scene {
        let mut scene = hollow_box(Mat4::IDENTITY);
        for triangle in scene.meshes[0].indices.as_chunks_mut::<3>().0 {
            triangle.swap(1, 2);
        }
        scene
    }

    #[test]
    fn a_solid_box_has_no_inside() {
        assert!(camera(&hollow_box(Mat4::IDENTITY), 1.0).is_none());
        assert!(
            camera(
                &hollow_box(Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))),
                1.0
            )
            .is_none()
        );
        assert!(camera(&Scene::default(), 1.0).is_none());
    }

    #[test]
    fn a_room_is_seen_along_its_length() {
        let camera = camera(&room(), 1.0).unwrap();
        let forward = -camera.world_from_view.z_axis.truncate();
        assert!(forward.x.abs() > 0.9, "{forward}");
        // From one end towards the other.
        assert!(
            (camera.eye().x - 6.0) * forward.x < -3.0,
            "{}",
            camera.eye()
        );
    }

    #[test]
    fn a_room_without_a_wall_is_seen_from_outside() {
        let mut scene = room();
        scene.meshes[0].indices.drain(30..36);
        assert!(camera(&scene, 1.0).is_none());
    }
}
