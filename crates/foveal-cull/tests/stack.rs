//! Every call fits into the stack that the README names.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Random, eye, occluders, scene};
use foveal_cull::{
    BakeOptions, Culler, FrameOptions, InstructionSet, OccludeeSet, OccludeeTree, OccluderMesh,
    OccluderSet, OccluderUsefulness, ReceiverMask, SingleThread, View, Visibility,
};
use glam::DVec3;
use std::sync::Arc;

const STACK_BYTES: usize = 256 << 10;

#[test]
fn a_small_stack_is_enough() {
    for instruction_set in InstructionSet::available() {
        for seed in 0..6 {
            std::thread::Builder::new()
                .name(format!("{instruction_set:?} {seed}"))
                .stack_size(STACK_BYTES)
                .spawn(move || everything(instruction_set, seed))
                .unwrap()
                .join()
                .unwrap();
        }
    }
}

fn everything(instruction_set: InstructionSet, seed: u64) {
    let mut r = Random::new(seed);
    let scene = scene(&mut r, 6, 400, DVec3::ZERO);
    let mut set = occluders(&scene, &[0, 1, 2, 3, 4, 5]);
    add_inner_shapes(&mut set, &scene);
    let eye = eye(&mut r, DVec3::ZERO, seed.is_multiple_of(3));
    let view = match seed % 3 {
        1 => View::stereo(eye, eye),
        2 => View::mono(eye).with_validity_radius(0.05),
        _ => View::mono(eye),
    };
    let mut culler = Culler::for_picture(320, 180).unwrap();
    culler.set_instruction_set(instruction_set);
    let mut usefulness = OccluderUsefulness::new();
    let tree = OccludeeTree::build(&scene.boxes, scene.origin);
    let mut moving = OccludeeSet::new(scene.origin);
    for bounds in &scene.boxes {
        moving.insert(*bounds);
    }
    for _ in 0..2 {
        let options = FrameOptions::default()
            .with_occluder_pixels_per_quad(0.0)
            .with_usefulness(Some(&usefulness));
        let view = view.for_picture(320, 180);
        culler
            .rasterize(&view, &set, &options, &SingleThread)
            .unwrap();
        let mut results = vec![Visibility::Visible; scene.boxes.len()];
        culler
            .query(&scene.boxes, scene.origin, &mut results)
            .unwrap();
        usefulness
            .observe(&culler, &scene.boxes, scene.origin, &results)
            .unwrap();
        let mut of_set = vec![Visibility::Visible; moving.result_count()];
        culler.query_set(&moving, &mut of_set).unwrap();
        let mut of_tree = vec![Visibility::Visible; scene.boxes.len()];
        culler.query_tree(&tree, &mut of_tree).unwrap();
        culler.count(&of_tree, None).unwrap();
    }
    let light = View::mono(eye);
    let mut mask = ReceiverMask::new(&light, 256).unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    mask.receive(&scene.boxes, scene.origin, &results).unwrap();
    mask.cull(&scene.boxes, scene.origin, &mut results).unwrap();
}

fn add_inner_shapes(set: &mut OccluderSet, scene: &common::Scene) {
    for o in &scene.objects {
        let options = BakeOptions::default().with_inner_shape(true);
        let mesh = OccluderMesh::bake(&o.positions, &o.indices, options).unwrap();
        set.add(Arc::new(mesh), o.transform).unwrap();
    }
}
