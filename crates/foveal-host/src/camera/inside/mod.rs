//! A good view for scenes that bring no camera and are buildings: from within.
//!
//! An overview from outside shows a building's outer walls only. So the scene is put into a coarse
//! voxel grid, and a place in it is *inside* when every horizontal ray from it meets a surface,
//! nearly all of them the front of one, and the floor is below: in a room the walls face the
//! viewer, whereas inside a solid thing (a helmet, a duck) one sees backs of surfaces. Fronts go by
//! the winding, even of double-sided materials: a solid that is drawn from both sides is still
//! solid. Among the places inside the camera takes one that is roomy and has a long view.

mod grid;
#[cfg(test)]
mod tests;

use foveal_scene::{Aabb, Camera, Scene};
use glam::{IVec3, Vec3};

use grid::{Grid, Hit};

/// Places to try along each edge of the scene's box.
const PLACES: [i32; 3] = [16, 8, 16];
/// Directions around.
const HEADINGS: usize = 16;
/// Slopes (rise per run) of the rays that judge a view: a picture is wider than high.
const SLOPES: [f32; 3] = [-0.25, 0.0, 0.35];
/// Least width and depth in metres of a scene that one can be in, and least room around the eye. A
/// helmet with a modelled lining has an inside too, but nobody wants to look at it from there.
const LEAST_SIZE_M: f32 = 3.0;
const LEAST_ROOM_M: f32 = 0.4;
/// Of a view's rays, how many may meet the back of a surface (a curtain's, say).
const MOST_BACKS: usize = HEADINGS * SLOPES.len() / 6;

/// The camera inside, or `None` where the scene has no inside.
pub(super) fn camera(scene: &Scene, fov_y_rad: f32) -> Option<Camera> {
    let (size, min) = (scene.bounds().size(), scene.bounds().min);
    if !(size.x >= LEAST_SIZE_M && size.z >= LEAST_SIZE_M && size.y > 0.0) {
        return None;
    }
    let grid = Grid::of(scene)?;
    let mut best: Option<(f32, Vec3, Vec3)> = None;
    for y in 0..PLACES[1] {
        for z in 0..PLACES[2] {
            for x in 0..PLACES[0] {
                let place = (IVec3::new(x, y, z).as_vec3() + 0.5) / IVec3::from(PLACES).as_vec3();
                let eye = min + place * size;
                if let Some((score, forward)) = best_view(&grid, eye)
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

/// How far one sees from `eye` in the best direction, and that direction; `None` outside and in
/// walls.
fn best_view(grid: &Grid, eye: Vec3) -> Option<(f32, Vec3)> {
    if !grid.is_free(eye) || !matches!(grid.cast(eye, Vec3::NEG_Y), Hit::Front(_)) {
        return None;
    }
    let mut sight_m = [0.0f32; HEADINGS];
    let mut backs = 0;
    for (heading, sight_m) in sight_m.iter_mut().enumerate() {
        for slope in SLOPES {
            let direction = (heading_direction(heading) + slope * Vec3::Y).normalize();
            let distance_m = match grid.cast(eye, direction) {
                Hit::Front(distance_m) => distance_m,
                Hit::Back(distance_m) => {
                    backs += 1;
                    distance_m
                }
                // Without a roof it is still a courtyard.
                Hit::Nothing(distance_m) if slope > 0.0 => distance_m,
                Hit::Nothing(_) => return None,
            };
            if distance_m < LEAST_ROOM_M.max(2.0 * grid.cell_m) || backs > MOST_BACKS {
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
            let center = eye + forward * (0.5 * view_m / (3 * SLOPES.len()) as f32);
            (
                view_m * room_m.sqrt() * centrality(grid.bounds, center),
                forward,
            )
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
}

/// 1 in the centre of the ground, less towards the walls and the roof: the way around a building
/// gives long views as well, but the building is what the scene is about.
fn centrality(bounds: Aabb, point: Vec3) -> f32 {
    let place = (point - bounds.min) / bounds.size();
    let across = (1.0 - (2.0 * place - 1.0).abs()).max(Vec3::splat(0.05));
    across.x * across.z * (1.2 - place.y)
}

fn heading_direction(heading: usize) -> Vec3 {
    let (sin, cos) = (heading as f32 / HEADINGS as f32 * std::f32::consts::TAU).sin_cos();
    Vec3::new(cos, 0.0, sin)
}
