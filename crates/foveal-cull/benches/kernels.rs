//! The culler's hot kernels, on a town that this file makes.
//!
//! `cargo bench -p foveal-cull` runs all of them; a name after `--` selects some, as in `cargo
//! bench -p foveal-cull -- query`.
#![allow(clippy::unwrap_used, reason = "a bench has no caller to tell")]

use divan::Bencher;
use divan::counter::ItemsCount;
use foveal_cull::bench::{self, BlockUpdates, FullBuffer};
use foveal_cull::{
    Aabb, BakeOptions, Culler, Eye, FrameOptions, InstructionSet, OccludeeId, OccludeeSet,
    OccludeeTree, OccluderMesh, OccluderSet, Projection, SingleThread, View, Visibility,
};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use std::sync::Arc;

fn main() {
    divan::main();
}

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|k| self.between(low[k].into(), high[k].into()) as f32))
    }
}

/// Positions and indices of a surface of `n` x `n` quads.
fn surface(n: u32, point: impl Fn(f32, f32) -> Vec3) -> (Vec<Vec3>, Vec<u32>) {
    let at = |i: u32| i as f32 / n as f32;
    let positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i, j)))
        .map(|(i, j)| point(at(i), at(j)))
        .collect();
    let indices = (0..n)
        .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
        .flat_map(|a| [a, a + 1, a + n + 2, a, a + n + 2, a + n + 1])
        .collect();
    (positions, indices)
}

fn hills() -> (Vec<Vec3>, Vec<u32>) {
    surface(96, |u, v| {
        let height = (u * 9.0).sin() + (v * 7.0).cos();
        Vec3::new(u * 120.0 - 60.0, height, 60.0 - v * 120.0)
    })
}

fn ball() -> (Vec<Vec3>, Vec<u32>) {
    surface(24, |u, v| {
        let (around, down) = (
            u * core::f32::consts::TAU,
            (1.0 - v) * core::f32::consts::PI,
        );
        let side = down.sin();
        Vec3::new(around.cos() * side, down.cos(), -around.sin() * side) * 2.0
    })
}

/// Hills with 260 houses and domes on them.
fn town() -> OccluderSet {
    let baked = |(positions, indices): (Vec<Vec3>, Vec<u32>)| {
        Arc::new(OccluderMesh::bake(&positions, &indices, BakeOptions::default()).unwrap())
    };
    let (low, high) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 8.0, 1.0));
    let house = Arc::new(OccluderMesh::from_box(Aabb::new(low, high)).unwrap());
    let dome = baked(ball());
    let mut set = OccluderSet::new();
    set.add(baked(hills()), DAffine3::IDENTITY).unwrap();
    let mut r = Random(1);
    for k in 0..260 {
        let (low, high) = (Vec3::new(-50.0, -1.0, -50.0), Vec3::new(50.0, 1.0, 50.0));
        let at = r.point(low, high).as_dvec3();
        let scale = r
            .point(Vec3::splat(0.4), Vec3::new(3.0, 2.0, 3.0))
            .as_dvec3();
        let turn = DQuat::from_rotation_y(r.between(0.0, 6.0));
        let mesh = if k % 3 == 0 { &dome } else { &house };
        let place = DAffine3::from_scale_rotation_translation(scale, turn, at);
        set.add(Arc::clone(mesh), place).unwrap();
    }
    set
}

fn boxes(count: usize) -> Vec<Aabb> {
    let mut r = Random(2);
    let one = |_| {
        let center = r.point(Vec3::new(-60.0, -2.0, -60.0), Vec3::new(60.0, 8.0, 60.0));
        let half = r.point(Vec3::splat(0.1), Vec3::splat(1.5));
        Aabb::new(center - half, center + half)
    };
    (0..count).map(one).collect()
}

/// An eye in a street, or above the town; to the right by `right_m`.
fn eye(place: &str, right_m: f64) -> Eye {
    let (at, target) = match place {
        "inside" => (DVec3::new(22.0, 2.5, 19.0), DVec3::new(0.0, 2.0, 0.0)),
        _ => (DVec3::new(60.0, 30.0, 50.0), DVec3::ZERO),
    };
    let right = (target - at).cross(DVec3::Y).normalize() * right_m;
    let projection = Projection::perspective(1.05, 16.0 / 9.0, 0.05, f64::INFINITY);
    Eye::look_at(at + right, target + right, DVec3::Y, projection)
}

const PLACES: [&str; 2] = ["inside", "around"];

fn rasterized(place: &str) -> Culler {
    let mut culler = Culler::new(640, 360).unwrap();
    let view = View::mono(eye(place, 0.0));
    let options = FrameOptions::default();
    culler
        .rasterize(&view, &town(), &options, &SingleThread)
        .unwrap();
    culler
}

/// A whole frame, 640x360 pixels; items are occluder triangles.
#[divan::bench(args = PLACES)]
fn rasterize(bencher: Bencher<'_, '_>, place: &str) {
    frames(bencher, &View::mono(eye(place, 0.0)));
}

/// The same for two eyes.
#[divan::bench(args = PLACES)]
fn rasterize_two_eyes(bencher: Bencher<'_, '_>, place: &str) {
    frames(
        bencher,
        &View::stereo(eye(place, -0.032), eye(place, 0.032)),
    );
}

fn frames(bencher: Bencher<'_, '_>, view: &View) {
    let (set, options) = (town(), FrameOptions::default());
    let mut culler = Culler::new(640, 360).unwrap();
    bencher
        .counter(ItemsCount::new(set.triangle_count()))
        .bench_local(|| culler.rasterize(view, &set, &options, &SingleThread));
}

/// A closed ball of 82,944 triangles with a radius of 1 m, whose points `shape` moves.
fn closed_ball(shape: impl Fn(Vec3) -> Vec3) -> (Vec<Vec3>, Vec<u32>) {
    let (rows, around) = (144, 288);
    let point = |i: u32, j: u32| {
        let turn = i as f32 / around as f32 * core::f32::consts::TAU;
        let down = j as f32 / rows as f32 * core::f32::consts::PI;
        let side = if j.is_multiple_of(rows) {
            0.0
        } else {
            down.sin()
        };
        shape(Vec3::new(turn.cos() * side, down.cos(), -turn.sin() * side))
    };
    let at = |i: u32, j: u32| {
        j * around
            + if j.is_multiple_of(rows) {
                0
            } else {
                i % around
            }
    };
    let positions = (0..=rows).flat_map(|j| (0..around).map(move |i| point(i, j)));
    let quads = (0..rows).flat_map(|j| (0..around).map(move |i| (i, j)));
    let indices = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [a, b, c, a, c, d]
    });
    (positions.collect(), indices.collect())
}

/// Bumps of several sizes.
fn stone(p: Vec3) -> Vec3 {
    let wave = |x: f32, y: f32, z: f32, k: f32| (p.dot(Vec3::new(x, y, z)) * k).sin();
    let bumps = 0.12 * wave(0.8, 0.3, 0.5, 5.0) + 0.08 * wave(-0.3, 0.9, 0.3, 9.0);
    let fine = 0.04 * wave(0.5, -0.5, 0.7, 17.0) + 0.02 * wave(0.1, 0.5, -0.8, 40.0);
    p * (1.0 + bumps + fine) * Vec3::new(1.3, 0.8, 1.0)
}

const SOLIDS: [&str; 6] = [
    "balls",
    "balls, every cluster",
    "balls, inner",
    "stones",
    "stones, every cluster",
    "stones, inner",
];

/// 60 balls or stones of 82,944 triangles, 4 to 60 m in front of the eye: themselves, with fine
/// detail left out or not, or the boxes inside. Prints how many of 20,000 small boxes among and
/// behind them are hidden.
#[divan::bench(args = SOLIDS, max_time = 3)]
fn rasterize_solids(bencher: Bencher<'_, '_>, solids: &str) {
    let (positions, indices) = if solids.starts_with("balls") {
        closed_ball(|p| p)
    } else {
        closed_ball(stone)
    };
    let options = BakeOptions::default().with_inner_shape(solids.ends_with("inner"));
    let mesh = Arc::new(OccluderMesh::bake(&positions, &indices, options).unwrap());
    let mut set = OccluderSet::new();
    let mut r = Random(3);
    let place = |r: &mut Random| {
        let away = r.between(4.0, 60.0);
        let side = r.between(-0.9, 0.9) * away;
        DVec3::new(side, r.between(-0.4, 0.4) * away, -away)
    };
    for _ in 0..60 {
        let turn = DQuat::from_euler(
            glam::EulerRot::XYZ,
            r.between(0.0, 6.0),
            r.between(0.0, 6.0),
            r.between(0.0, 6.0),
        );
        let scale = DVec3::splat(r.between(0.7, 3.0));
        let at = place(&mut r);
        let place = DAffine3::from_scale_rotation_translation(scale, turn, at);
        set.add(Arc::clone(&mesh), place).unwrap();
    }
    let small = |_| {
        let center = place(&mut r).as_vec3();
        Aabb::new(center - 0.1, center + 0.1)
    };
    let boxes: Vec<Aabb> = (0..20_000).map(small).collect();
    let projection = Projection::perspective(1.05, 16.0 / 9.0, 0.05, f64::INFINITY);
    let view = View::mono(Eye::look_at(
        DVec3::ZERO,
        DVec3::NEG_Z,
        DVec3::Y,
        projection,
    ));
    let mut culler = Culler::new(640, 360).unwrap();
    let mut options = FrameOptions::default();
    if solids.ends_with("every cluster") {
        options.occluder_pixels_per_quad = 0.0;
    }
    culler
        .rasterize(&view, &set, &options, &SingleThread)
        .unwrap();
    let mut results = vec![Visibility::Visible; boxes.len()];
    culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
    let hidden = results.iter().filter(|r| **r == Visibility::Occluded);
    eprintln!("{solids}: {} hidden", hidden.count());
    bencher
        .counter(ItemsCount::new(set.triangle_count()))
        .bench_local(|| culler.rasterize(&view, &set, &options, &SingleThread));
}

/// Random boxes one after the other.
#[divan::bench(args = PLACES)]
fn query_boxes(bencher: Bencher<'_, '_>, place: &str) {
    let (culler, boxes) = (rasterized(place), boxes(9000));
    let mut results = vec![Visibility::Visible; boxes.len()];
    bencher
        .counter(ItemsCount::new(boxes.len()))
        .bench_local(|| culler.query(&boxes, DVec3::ZERO, &mut results));
}

/// The same boxes by their tree.
#[divan::bench(args = PLACES)]
fn query_tree(bencher: Bencher<'_, '_>, place: &str) {
    let (culler, boxes) = (rasterized(place), boxes(9000));
    let tree = OccludeeTree::build(&boxes, DVec3::ZERO);
    let mut results = vec![Visibility::Visible; boxes.len()];
    bencher
        .counter(ItemsCount::new(boxes.len()))
        .bench_local(|| culler.query_tree(&tree, &mut results));
}

/// Fitting a tree to moved boxes.
#[divan::bench]
fn refit_tree(bencher: Bencher<'_, '_>) {
    let boxes = boxes(9000);
    let mut tree = OccludeeTree::build(&boxes, DVec3::ZERO);
    bencher
        .counter(ItemsCount::new(boxes.len()))
        .bench_local(|| tree.refit(&boxes));
}

/// Moving 1,000 occluders.
#[divan::bench]
fn move_occluders(bencher: Bencher<'_, '_>) {
    let bounds = Aabb::new([-1.0, 0.0, -1.0], [1.0, 8.0, 1.0]);
    let mesh = Arc::new(OccluderMesh::from_box(bounds).unwrap());
    let mut set = OccluderSet::new();
    let place = |i: f64, t: f64| {
        let turn = DQuat::from_rotation_y(t);
        DAffine3::from_rotation_translation(turn, DVec3::new(i, t, 0.1 * i))
    };
    let mut ids = Vec::new();
    for i in 0..1000 {
        ids.push(set.add(Arc::clone(&mesh), place(i.into(), 0.0)).unwrap());
    }
    let places = [0.1, 0.2].map(|t| [0, 1, 2, 3, 4, 5, 6, 7].map(|i| place(i.into(), t)));
    let mut frame = 0;
    bencher.counter(ItemsCount::new(ids.len())).bench_local(|| {
        frame += 1;
        for (i, id) in ids.iter().enumerate() {
            set.set_transform(*id, places[frame % 2][i % 8]).unwrap();
        }
    });
}

/// A set of many objects, of which every `1 / part` moves a little in each frame.
struct Moving {
    set: OccludeeSet,
    ids: Vec<OccludeeId>,
    boxes: Vec<Aabb>,
    frame: usize,
}

impl Moving {
    fn new(count: usize) -> Self {
        let boxes = boxes(count);
        let mut set = OccludeeSet::new(DVec3::ZERO);
        let ids = boxes.iter().map(|b| set.insert(*b)).collect();
        set.rebuild();
        Self {
            set,
            ids,
            boxes,
            frame: 0,
        }
    }

    fn step(&mut self, moved: usize) {
        self.frame += 1;
        let by = if self.frame.is_multiple_of(2) {
            0.1
        } else {
            -0.1
        };
        let stride = self.ids.len() / moved;
        for k in 0..moved {
            let i = k * stride;
            // A new box: one that was changed in part and is read as a whole would be waited for.
            let Aabb { min, max } = self.boxes[i];
            let moved = Aabb::new([min[0] + by, min[1], min[2]], [max[0] + by, max[1], max[2]]);
            self.set.set_bounds(self.ids[i], moved).unwrap();
            self.boxes[i] = moved;
        }
        self.set.refit();
    }
}

/// Moving 10,000 of so many objects, and fitting their hierarchy; items are moved objects.
#[divan::bench(args = [10_000, 25_000, 100_000])]
fn move_objects(bencher: Bencher<'_, '_>, count: usize) {
    let mut moving = Moving::new(count);
    bencher
        .counter(ItemsCount::new(10_000usize))
        .bench_local(|| moving.step(10_000));
}

/// Building that hierarchy again.
#[divan::bench(args = [10_000, 25_000, 100_000], max_time = 1)]
fn rebuild_set(bencher: Bencher<'_, '_>, count: usize) {
    let mut moving = Moving::new(count);
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| moving.set.rebuild());
}

const COUNTS: [usize; 4] = [100, 1000, 10_000, 25_000];

/// So many boxes as a set that has moved, from inside.
#[divan::bench(args = COUNTS)]
fn query_moved_set(bencher: Bencher<'_, '_>, count: usize) {
    query_set(bencher, "inside", count);
}

/// The same from around, where almost a half of them are visible.
#[divan::bench(args = COUNTS)]
fn query_moved_set_around(bencher: Bencher<'_, '_>, count: usize) {
    query_set(bencher, "around", count);
}

fn query_set(bencher: Bencher<'_, '_>, place: &str, count: usize) {
    let (culler, mut moving) = (rasterized(place), Moving::new(count));
    moving.step(count / 2);
    let mut results = vec![Visibility::Visible; moving.set.result_count()];
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| culler.query_set(&moving.set, &mut results));
}

/// 10,000 boxes as a set in which every object has moved by up to so many metres along each axis,
/// and the hierarchy was not built again.
#[divan::bench(args = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 60.0])]
fn query_spread_set(bencher: Bencher<'_, '_>, reach_m: f32) {
    let count = 10_000;
    let (culler, mut moving) = (rasterized("inside"), Moving::new(count));
    let mut r = Random(5);
    for (bounds, id) in moving.boxes.iter_mut().zip(&moving.ids) {
        let by = r.point(Vec3::splat(-reach_m), Vec3::splat(reach_m));
        let [min, max] = [bounds.min, bounds.max].map(|corner| Vec3::from(corner) + by);
        *bounds = Aabb::new(min, max);
        moving.set.set_bounds(*id, *bounds).unwrap();
    }
    moving.set.refit();
    let mut results = vec![Visibility::Visible; moving.set.result_count()];
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| culler.query_set(&moving.set, &mut results));
}

/// The same boxes as a list.
#[divan::bench(args = COUNTS)]
fn query_moved_list(bencher: Bencher<'_, '_>, count: usize) {
    query_list(bencher, "inside", count);
}

/// The same as a list, from around.
#[divan::bench(args = COUNTS)]
fn query_moved_list_around(bencher: Bencher<'_, '_>, count: usize) {
    query_list(bencher, "around", count);
}

fn query_list(bencher: Bencher<'_, '_>, place: &str, count: usize) {
    let (culler, mut moving) = (rasterized(place), Moving::new(count));
    moving.step(count / 2);
    let mut results = vec![Visibility::Visible; count];
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| culler.query(&moving.boxes, DVec3::ZERO, &mut results));
}

/// Polygons that cover a part of one block.
#[divan::bench]
fn update_block(bencher: Bencher<'_, '_>) {
    const POLYGONS: u32 = 64;
    let (mut block, set) = (BlockUpdates::new(POLYGONS), InstructionSet::detect());
    bencher
        .counter(ItemsCount::new(POLYGONS))
        .bench_local(|| block.run(set));
}

/// The HiZ of a full buffer of 640x360 pixels.
#[divan::bench]
fn build_hiz(bencher: Bencher<'_, '_>) {
    let (mut buffer, set) = (FullBuffer::new(640, 360), InstructionSet::detect());
    bencher.bench_local(|| buffer.build_hiz(set));
}

/// Boxes from rows to lanes.
#[divan::bench]
fn transpose(bencher: Bencher<'_, '_>) {
    let (boxes, set) = (boxes(1024), InstructionSet::detect());
    bencher
        .counter(ItemsCount::new(boxes.len()))
        .bench_local(|| bench::transpose(&boxes, set));
}

/// Baking the hills, 18,432 triangles, for one exact eye (`false`) and for view regions (`true`).
#[divan::bench(args = [false, true], max_time = 1)]
fn bake(bencher: Bencher<'_, '_>, adjacency: bool) {
    let (positions, indices) = hills();
    let options = BakeOptions::default().with_adjacency(adjacency);
    bencher
        .counter(ItemsCount::new(indices.len() / 3))
        .bench_local(|| OccluderMesh::bake(&positions, &indices, options));
}
