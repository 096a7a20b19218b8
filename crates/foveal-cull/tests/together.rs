//! What is asked together is answered as if it were asked alone.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, answers, eye, occluders, scene};
use foveal_cull::{Culler, SingleThread, View, Visibility};
use glam::DVec3;

#[test]
fn boxes_get_the_same_answers_in_any_company() {
    let mut kinds = [0; 4];
    for seed in 0..30 {
        let mut r = Random::new(seed);
        // More than one round of boxes, and a rest.
        let scene = scene(&mut r, 4, 700, DVec3::ZERO);
        let view = View::mono(eye(&mut r, DVec3::ZERO, seed % 3 == 0));
        let set = occluders(&scene, &[0, 1, 2, 3]);
        let mut culler = Culler::new(70 + seed as u32, 50).unwrap();
        let together = answers(&mut culler, &view, &set, &scene, &SingleThread);
        for (bounds, together) in scene.boxes.iter().zip(together) {
            let mut alone = [Visibility::Visible];
            culler.query(&[*bounds], scene.origin, &mut alone).unwrap();
            assert_eq!(alone[0], together, "{seed}: {bounds:?}");
            kinds[together as usize] += 1;
        }
    }
    let [visible, outside, _, occluded] = kinds;
    assert!(
        visible > 100 && outside > 100 && occluded > 100,
        "{kinds:?}"
    );
}
