//! Frames on rayon's pool: `foveal_cull::Rayon`, of the feature `rayon`.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, eye, occluders, scene};
use foveal_cull::{Culler, Rayon, SingleThread, Threads, View, Visibility};
use glam::DVec3;

#[test]
fn rayons_pool_finds_what_one_thread_finds() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
    let pool = pool.unwrap();
    assert_eq!(pool.install(|| Rayon.count()), 3);
    let mut r = Random::new(7);
    let mut occluded = 0;
    for _ in 0..40 {
        let scene = scene(&mut r, 12, 200, DVec3::ZERO);
        let order: Vec<usize> = (0..scene.objects.len()).collect();
        let set = occluders(&scene, &order);
        let view = View::mono(eye(&mut r, DVec3::ZERO, false));
        let (mut one, mut many) = (Culler::new(160, 90).unwrap(), Culler::new(160, 90).unwrap());
        let expected = answers(&mut one, &view, &set, &scene, &SingleThread);
        let found = pool.install(|| answers(&mut many, &view, &set, &scene, &Rayon));
        assert!(found == expected);
        let hidden = |result: &&Visibility| **result == Visibility::Occluded;
        occluded += expected.iter().filter(hidden).count();
    }
    assert!(occluded > 100, "{occluded}");
}
