//! Cameras where people stand: at eye height over floors, with free space around.
//!
//! Points are spread over what faces up, as many per square metre everywhere, and lifted to eye
//! height. One is kept where the floor under it is the one that it was lifted from, nothing is just
//! above it, nothing is near around it, and most level rays meet the front of a surface: in a room,
//! a street or a court, neither within a solid nor out in the open. Kept ones lie far apart while
//! there are such. From each the camera looks in four level directions.

use foveal_cull::{Eye, Projection};
use foveal_scene::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::boxes::unit;
use foveal_host::camera::near_m;
use foveal_host::culling::NamedEye;
use foveal_host::culling::Occluders;

/// Places that are looked for, and directions from each.
const PLACES: usize = 12;
const DIRECTIONS: u32 = 4;
/// Metres.
const EYE_HEIGHT_M: f32 = 1.7;
const LEAST_ABOVE_M: f32 = 0.4;
const LEAST_AROUND_M: f32 = 0.5;
/// How far apart places are at first, and of what they are after every batch.
const APART_M: f32 = 6.0;
const CLOSER: f32 = 0.8;
/// Points that are looked at before places may lie closer, and how often.
const BATCH: u32 = 128;
const BATCHES: u32 = 16;
/// Level rays, and how many of them must meet the front of a surface.
const RAYS: usize = 12;
const LEAST_FRONTS: usize = 8;
/// Vertical part of the normal of what is a floor.
const LEAST_UP: f32 = 0.8;

/// Where to stand: points at eye height, as many as there are up to [`PLACES`].
pub(super) fn places(occluders: &Occluders) -> Vec<Vec3> {
    let triangles = triangles(occluders);
    let floors = Floors::of(&triangles);
    let mut places: Vec<Vec3> = Vec::new();
    let mut apart_m = APART_M;
    for batch in 0..BATCHES {
        let numbers: Vec<u32> = (batch * BATCH..(batch + 1) * BATCH).collect();
        let good: Vec<Vec3> = numbers
            .into_par_iter()
            .filter_map(|n| floors.point(&triangles, n))
            .map(|floor| floor + Vec3::Y * EYE_HEIGHT_M)
            .filter(|eye| can_stand(&triangles, *eye))
            .collect();
        for eye in good {
            if places.len() < PLACES && places.iter().all(|p| p.distance(eye) >= apart_m) {
                places.push(eye);
            }
        }
        if places.len() == PLACES {
            break;
        }
        apart_m *= CLOSER;
    }
    places
}

/// The cameras at these places, for a picture of `aspect` = width / height: 60° in height.
pub(super) fn eyes(scene: &Scene, places: &[Vec3], aspect: f64) -> Vec<NamedEye> {
    let near = f64::from(near_m(scene));
    let projection = Projection::perspective(60_f64.to_radians(), aspect, near, f64::INFINITY);
    let mut eyes = Vec::new();
    for (number, place) in (0u32..).zip(places) {
        for k in 0..DIRECTIONS {
            // The first direction is another one at every place.
            let turn = f64::from(k) + f64::from(unit(number));
            let (sin, cos) = (turn * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            let eye = place.as_dvec3();
            let ahead = DVec3::new(cos, 0.0, sin);
            eyes.push(NamedEye {
                name: format!("inside {number}.{k}"),
                eye: Eye::look_at(eye, eye + ahead, DVec3::Y, projection),
            });
        }
    }
    eyes
}

/// Corners, counter-clockwise from the front.
type Triangle = [Vec3; 3];

/// All that occludes, in the world.
fn triangles(occluders: &Occluders) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for &(shape, world_from_mesh) in &occluders.placed {
        let shape = &occluders.shapes[shape];
        let mirrored = world_from_mesh.matrix3.determinant() < 0.0;
        for [a, b, c] in shape.indices.as_chunks::<3>().0 {
            let corner = |i: u32| {
                let p = shape.positions[i as usize].as_dvec3();
                world_from_mesh.transform_point3(p).as_vec3()
            };
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            triangles.push([corner(*a), corner(*b), corner(*c)]);
        }
    }
    triangles
}

/// What faces up: numbers of triangles, and their areas summed up.
struct Floors {
    triangles: Vec<u32>,
    areas: Vec<f64>,
}

impl Floors {
    fn of(triangles: &[Triangle]) -> Self {
        let (mut floors, mut areas, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for (number, [a, b, c]) in (0u32..).zip(triangles) {
            let normal = (*b - *a).cross(*c - *a);
            let size = normal.length();
            if size.is_finite() && size > 0.0 && normal.y > LEAST_UP * size {
                sum += f64::from(size);
                floors.push(number);
                areas.push(sum);
            }
        }
        Self {
            triangles: floors,
            areas,
        }
    }

    /// Point `n` of as many as one likes.
    fn point(&self, triangles: &[Triangle], n: u32) -> Option<Vec3> {
        let [which, u, v] = [0, 1, 2].map(|k| unit(n.wrapping_mul(3) + k));
        let at = f64::from(which) * self.areas.last()?;
        let floor = self.areas.partition_point(|sum| *sum <= at);
        let number = self.triangles.get(floor).or(self.triangles.last())?;
        let [a, b, c] = triangles[*number as usize];
        let [u, v] = if u + v > 1.0 {
            [1.0 - u, 1.0 - v]
        } else {
            [u, v]
        };
        Some(a + (b - a) * u + (c - a) * v)
    }
}

fn can_stand(triangles: &[Triangle], eye: Vec3) -> bool {
    let below = first_hit(triangles, eye, Vec3::NEG_Y);
    let on_floor = below.is_some_and(|hit| hit.front && hit.distance_m > 0.95 * EYE_HEIGHT_M);
    let free = |hit: Option<Hit>, least_m: f32| hit.is_none_or(|h| h.distance_m >= least_m);
    if !on_floor || !free(first_hit(triangles, eye, Vec3::Y), LEAST_ABOVE_M) {
        return false;
    }
    let mut fronts = 0;
    for ray in 0..RAYS {
        let (sin, cos) = (ray as f32 / RAYS as f32 * std::f32::consts::TAU).sin_cos();
        let hit = first_hit(triangles, eye, Vec3::new(cos, 0.0, sin));
        if !free(hit, LEAST_AROUND_M) {
            return false;
        }
        fronts += usize::from(hit.is_some_and(|h| h.front));
    }
    fronts >= LEAST_FRONTS
}

/// What a ray meets first.
#[derive(Clone, Copy)]
struct Hit {
    distance_m: f32,
    front: bool,
}

/// Möller and Trumbore's test (1997) with every triangle.
fn first_hit(triangles: &[Triangle], origin: Vec3, direction: Vec3) -> Option<Hit> {
    let mut first: Option<Hit> = None;
    for [a, b, c] in triangles {
        let (ab, ac) = (*b - *a, *c - *a);
        let across = direction.cross(ac);
        let facing = ab.dot(across);
        if facing.abs() < 1e-12 {
            continue;
        }
        let from = origin - *a;
        let u = from.dot(across) / facing;
        if !(0.0..=1.0).contains(&u) {
            continue;
        }
        let along = from.cross(ab);
        let v = direction.dot(along) / facing;
        let distance_m = ac.dot(along) / facing;
        if v >= 0.0
            && u + v <= 1.0
            && distance_m > 0.0
            && first.is_none_or(|f| distance_m < f.distance_m)
        {
            first = Some(Hit {
                distance_m,
                front: facing > 0.0,
            });
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_host::culling::Shape;
    use glam::DAffine3;

    /// A box of walls that face inwards, or outwards.
    fn room(size: Vec3, inwards: bool) -> Occluders {
        let positions: Vec<Vec3> = (0..8)
            .map(|i| size * Vec3::from_array([0, 1, 2].map(|k| ((i >> k) & 1) as f32)))
            .collect();
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
            .flat_map(|&[a, b, c, d]| {
                if inwards {
                    [a, c, b, a, d, c]
                } else {
                    [a, b, c, a, c, d]
                }
            })
            .collect();
        let shape = Shape {
            positions,
            indices,
            two_sided: false,
        };
        Occluders::bake(vec![shape], vec![(0, DAffine3::IDENTITY)]).unwrap()
    }

    #[test]
    fn one_stands_on_the_floor_of_a_room_away_from_its_walls() {
        let size = Vec3::new(30.0, 3.0, 20.0);
        let places = places(&room(size, true));
        assert_eq!(places.len(), PLACES);
        for place in &places {
            assert!((place.y - EYE_HEIGHT_M).abs() < 1e-3, "{place}");
            let inset = Vec3::new(LEAST_AROUND_M, 0.0, LEAST_AROUND_M);
            assert!(place.cmpge(inset).all() && place.cmple(size - inset).all());
        }
        let least = places
            .iter()
            .flat_map(|p| places.iter().map(move |q| p.distance(*q)))
            .filter(|d| *d > 0.0)
            .fold(f32::INFINITY, f32::min);
        assert!(least > 0.5, "{least}");
    }

    #[test]
    fn nobody_stands_in_a_low_room_in_a_solid_or_on_a_roof() {
        assert!(places(&room(Vec3::new(30.0, 2.0, 20.0), true)).is_empty());
        assert!(places(&room(Vec3::new(30.0, 3.0, 20.0), false)).is_empty());
        assert!(places(&Occluders::default()).is_empty());
    }

    #[test]
    fn every_place_has_four_level_directions() {
        let scene = foveal_host::scene_source::load("cornell").unwrap();
        let eyes = eyes(&scene, &[Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO], 1.5);
        assert_eq!(eyes.len(), 8);
        for pair in eyes[..4].windows(2) {
            let [a, b] = [0, 1].map(|i| -DVec3::from(pair[i].eye.world_from_eye.z_axis));
            assert!(a.y.abs() < 1e-9 && a.dot(b).abs() < 1e-9, "{a} {b}");
        }
    }
}
