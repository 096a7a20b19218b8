//! The promise: what is culled is never visible. Held against the reference in random scenes.

use super::{Exact, Random, Scene, eye, occluders, scene, wrongly_culled};
use foveal_cull::{Culler, Eye, FrameOptions, SingleThread, View, Visibility};
use glam::{DAffine3, DVec3};

pub fn size(r: &mut Random) -> (u32, u32) {
    (8 + r.below(90) as u32, 8 + r.below(60) as u32)
}

/// Whether a random scene keeps the promise, seen from one place; gives how many boxes are hidden.
pub fn culls_nothing_visible(
    seed: u64,
    orthographic: bool,
    origin: DVec3,
) -> Result<usize, String> {
    culls_nothing_visible_in(None, seed, orthographic, origin)
}

/// In a buffer of this size, or of any.
pub fn culls_nothing_visible_in(
    buffer: Option<(u32, u32)>,
    seed: u64,
    orthographic: bool,
    origin: DVec3,
) -> Result<usize, String> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(7);
    let scene = scene(&mut r, objects, 150, origin);
    let eye = eye(&mut r, origin, orthographic);
    let of_any = size(&mut r);
    let (w, h) = buffer.unwrap_or(of_any);
    let set = occluders(&scene, &(0..objects).collect::<Vec<_>>());
    let mut culler = Culler::new(w, h).unwrap();
    let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    culler
        .rasterize(&View::mono(eye), &set, &all, &SingleThread)
        .unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    let mut depth = vec![0.0; (w * h) as usize];
    culler.read_depth(&mut depth).unwrap();
    for n in [1, 4] {
        let exact = Exact::new(&scene, &eye, (w, h), n);
        for (i, (claimed, farthest)) in depth.iter().zip(exact.farthest()).enumerate() {
            if *claimed > farthest {
                return Err(format!(
                    "seed {seed}, {n}x: pixel {i} of {w} x {h} claims {claimed}, the reference has {farthest}"
                ));
            }
        }
        let wrong = exact.wrongly_culled(&scene, &results);
        none_culled(&scene, n, &wrong, &results).map_err(|e| format!("seed {seed}, {e}"))?;
    }
    Ok(hidden(&results))
}

fn see_nothing_culled(
    scene: &Scene,
    eyes: &[Eye],
    size: (u32, u32),
    results: &[Visibility],
) -> Result<(), String> {
    for (eye, n) in eyes.iter().flat_map(|e| [(e, 1), (e, 4)]) {
        let wrong = wrongly_culled(scene, eye, size, n, results);
        none_culled(scene, n, &wrong, results)?;
    }
    Ok(())
}

fn none_culled(
    scene: &Scene,
    n: u32,
    wrong: &[usize],
    results: &[Visibility],
) -> Result<(), String> {
    if wrong.is_empty() {
        return Ok(());
    }
    let which = |&i: &usize| (scene.boxes[i], results[i]);
    let which: Vec<_> = wrong.iter().map(which).collect();
    Err(format!("{n}x: {wrong:?} {which:?}"))
}

pub fn hidden(results: &[Visibility]) -> usize {
    results
        .iter()
        .filter(|r| **r == Visibility::Occluded)
        .count()
}

/// The same for places within a validity radius.
pub fn culls_nothing_visible_around(seed: u64) -> Result<(), String> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(6);
    let scene = scene(&mut r, objects, 150, DVec3::ZERO);
    let center = eye(&mut r, DVec3::ZERO, seed.is_multiple_of(5));
    let size = size(&mut r);
    let radius = [0.005, 0.03, 0.2][r.below(3)];
    let view = View::mono(center).with_validity_radius(radius);
    let results = answers_to_all(&scene, &view, size);
    let eyes = [0, 1, 2].map(|k| {
        let far = if k == 0 { 1.0 } else { r.next() };
        let step = r.vec(1.0).normalize() * (radius * far);
        let pose = DAffine3::from_translation(step) * DAffine3::from(center.world_from_eye);
        Eye::new(pose, center.projection)
    });
    see_nothing_culled(&scene, &eyes, size, &results)
}

/// The same for two eyes; gives how many boxes are hidden from one eye, and from both.
pub fn culls_nothing_that_either_eye_sees(seed: u64) -> Result<[usize; 2], String> {
    let mut r = Random::new(seed);
    let objects = 1 + r.below(6);
    let scene = scene(&mut r, objects, 150, DVec3::ZERO);
    let left = eye(&mut r, DVec3::ZERO, false);
    // The other eye: beside it, in every fourth scene at the same place, turned a little outwards
    // in most, with its own asymmetric frustum.
    let cant = r.range(-0.15, 0.15);
    let (apart, cant) = match seed % 8 {
        0 => (0.0, cant),
        4 => (0.0, 0.0),
        _ => (0.063, cant),
    };
    let cant = DAffine3::from_rotation_y(cant);
    let apart = DAffine3::from_translation(DVec3::new(apart, 0.0, 0.0));
    let mut right = eye(&mut r, DVec3::ZERO, false);
    right.world_from_eye = (DAffine3::from(left.world_from_eye) * apart * cant).into();
    let size = size(&mut r);
    let results = answers_to_all(&scene, &View::stereo(left, right), size);
    see_nothing_culled(&scene, &[left, right], size, &results)?;
    let of_one = answers_to_all(&scene, &View::mono(left), size);
    Ok([hidden(&of_one), hidden(&results)])
}

/// Answers where fine detail is not left out.
pub fn answers_to_all(scene: &Scene, view: &View, (w, h): (u32, u32)) -> Vec<Visibility> {
    let all = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let set = occluders(scene, &(0..scene.objects.len()).collect::<Vec<_>>());
    let mut culler = Culler::new(w, h).unwrap();
    culler.rasterize(view, &set, &all, &SingleThread).unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    results
}
