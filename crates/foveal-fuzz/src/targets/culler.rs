//! The culler's interface: every instruction set, one thread and several, a list and a tree give
//! the same answers, and what is culled is never visible.

use std::sync::{Arc, OnceLock};

use foveal_cull::{
    BakeOptions, CullError, Culler, Eye, FrameOptions, InstructionSet, OccludeeSet, OccludeeTree,
    OccluderMesh, OccluderSet, SingleThread, Threads, View, Visibility, WorkerThreads, testing,
};
use glam::{DAffine3, DVec3, Vec3};

use super::receivers::shadows_stay;
use super::scenes::promise::{
    culls_nothing_that_either_eye_sees, culls_nothing_visible, culls_nothing_visible_around, size,
};
use super::scenes::{Object, Random, Scene, eye, scene, wrongly_culled};
use crate::random::{Choices, random_bytes};

/// Culls a random scene as it is, and another one with odd numbers in it.
pub fn culler(input: &[u8]) {
    let mut choices = Choices::new(input);
    let seed = choices.bits();
    let kept = match choices.below(5) {
        0 => culls_nothing_visible(seed, false, DVec3::ZERO).map(drop),
        1 => culls_nothing_visible(seed, true, DVec3::ZERO).map(drop),
        2 => culls_nothing_visible(seed, seed.is_multiple_of(4), DVec3::new(1e6, -2e5, 3e6))
            .map(drop),
        3 => culls_nothing_visible_around(seed),
        _ => culls_nothing_that_either_eye_sees(seed).map(drop),
    };
    if let Err(broken) = kept {
        panic!("{broken}");
    }
    agree(&mut choices);
}

/// Coordinates at which something happens: on grids of samples, doubled, very large and very small.
const ODD: [f32; 20] = [
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.0,
    -1.0,
    0.25,
    0.125,
    2.0,
    -8.0,
    1e-20,
    -1e-38,
    1e-45,
    1e4,
    -1e6,
    3e9,
    1e20,
    3e38,
    f32::INFINITY,
    f32::NAN,
];
/// The first of them are within what the reference computes exactly enough.
const MODEST: usize = 14;

fn agree(choices: &mut Choices<'_>) {
    let mut r = Random::new(choices.bits());
    let far = choices.one_in(8);
    let origin = if far {
        DVec3::new(-3e5, 1e3, 8e5)
    } else {
        DVec3::ZERO
    };
    let mut scene = scene(&mut r, 1 + choices.below(6), 120, origin);
    let modest = twist(&mut scene, choices);
    let eye = eye(&mut r, origin, choices.one_in(4));
    let mut view = View::mono(eye);
    // Where else the results hold: none where it is no radius, or one beyond what the reference knows.
    let mut beside = Some(eye);
    if choices.one_in(6) {
        let radius = choices.pick(&[1e-6, 0.01, 0.3, 1e9, f64::NAN, -1.0]);
        view = view.with_validity_radius(radius);
        let within = DAffine3::from_translation(r.vec(1.0).normalize() * radius * 0.999);
        beside = (0.0..1.0)
            .contains(&radius)
            .then(|| Eye::new(within * DAffine3::from(eye.world_from_eye), eye.projection));
    }
    let size = size(&mut r);
    let set = occluders(&mut scene, choices);
    let options = FrameOptions::default()
        .with_occluder_pixels_per_quad(choices.pick(&[0.0, 1.0, 16.0, 1e9, f32::NAN]))
        .with_occluder_size_threshold(choices.pick(&[0.0, 0.001, 0.1]))
        .with_occludee_size_threshold(choices.pick(&[0.0, 0.01, 0.3, f32::NAN]))
        .with_occlusion(!choices.one_in(12));

    let tree = OccludeeTree::build(&scene.boxes, scene.origin);
    let mut objects = OccludeeSet::new(scene.origin);
    // Few objects would be a list otherwise.
    testing::prefer_tree(&mut objects);
    for bounds in &scene.boxes {
        objects.insert(*bounds);
    }
    objects.rebuild();
    let Ok(mut culler) = Culler::new(size.0, size.1) else {
        panic!("a culler of {size:?} pixels");
    };
    let mut first: Option<Answers> = None;
    for instruction_set in InstructionSet::available() {
        culler.set_instruction_set(instruction_set);
        for threads in [&SingleThread as &dyn Threads, workers()] {
            let drawn = culler.rasterize(&view, &set, &options, threads);
            let answers = Answers::of(drawn, &culler, &scene, &tree, &objects);
            match &first {
                Some(first) => {
                    let which = first.difference(&answers);
                    assert!(
                        which.is_none(),
                        "{instruction_set:?} with {} threads differs in {which:?}",
                        threads.count()
                    );
                }
                None => first = Some(answers),
            }
        }
    }
    shadows_stay(&view, &scene, choices);
    let Some(Answers {
        drawn: Ok(()),
        list,
        tree,
        set,
        ..
    }) = first
    else {
        return;
    };
    if modest && let Some(beside) = beside {
        for (name, found) in [("list", list), ("tree", tree), ("set", set)] {
            // Small things are left out on purpose.
            let results: Vec<Visibility> = found
                .into_iter()
                .map(|v| match v {
                    Visibility::Small => Visibility::Visible,
                    other => other,
                })
                .collect();
            for n in [1, 4] {
                let wrong = wrongly_culled(&scene, &beside, size, n, &results);
                assert!(
                    wrong.is_empty(),
                    "{name}, {n}x: {wrong:?} are culled and visible"
                );
            }
        }
    }
}

/// Gives some corners and boxes odd numbers; says whether all are modest.
fn twist(scene: &mut Scene, choices: &mut Choices<'_>) -> bool {
    let reach = if choices.one_in(3) { ODD.len() } else { MODEST };
    for _ in 0..choices.below(12) {
        let (object, vertex) = (choices.bits(), choices.bits());
        let (axis, value) = (choices.below(3), ODD[choices.below(reach)]);
        let count = scene.objects.len() as u64;
        let positions = &mut scene.objects[(object % count) as usize].positions;
        let place = (vertex % positions.len() as u64) as usize;
        match choices.below(4) {
            // The same corner twice: folded and empty triangles.
            0 => positions[place] = positions[0],
            // Corners on a grid: edges through samples.
            1 => positions
                .iter_mut()
                .for_each(|p| *p = (*p * 8.0).round() / 8.0),
            _ => positions[place][axis] = value,
        }
    }
    for _ in 0..choices.below(6) {
        let place = choices.below(scene.boxes.len());
        let (axis, value) = (choices.below(3), ODD[choices.below(reach)]);
        let bounds = &mut scene.boxes[place];
        if choices.one_in(2) {
            bounds.min[axis] = value;
        } else {
            bounds.max[axis] = value;
        }
    }
    reach == MODEST
}

/// Bakes what can be baked, and leaves out the rest.
fn occluders(scene: &mut Scene, choices: &mut Choices<'_>) -> OccluderSet {
    let mut set = OccluderSet::new();
    scene.objects.retain(|object| {
        let options = BakeOptions::default()
            .with_two_sided(object.two_sided)
            .with_adjacency(!choices.one_in(3))
            .with_inner_shape(choices.one_in(2));
        let finite = object.positions.iter().all(|p| Vec3::is_finite(*p));
        let deforms = choices.one_in(4);
        match bake(object, options.with_deformable(deforms), choices) {
            Ok(mesh) => {
                assert!(finite, "positions that are not finite were baked");
                let bytes = mesh.to_bytes();
                let again = OccluderMesh::from_bytes(&bytes);
                assert!(
                    again.is_ok_and(|m| m.to_bytes() == bytes),
                    "bytes of a mesh"
                );
                set.add(Arc::new(mesh), object.transform).is_ok()
            }
            Err(_) => false,
        }
    });
    set
}

/// Bakes an object, or where it deforms another shape of it that then takes the object's.
fn bake(
    object: &Object,
    options: BakeOptions,
    choices: &mut Choices<'_>,
) -> Result<OccluderMesh, CullError> {
    if !options.deformable {
        return OccluderMesh::bake(&object.positions, &object.indices, options);
    }
    let mut moved = |p: &Vec3| {
        let by = [0, 1, 2].map(|_| choices.below(9) as f32 * 0.25 - 1.0);
        if p.is_finite() {
            *p * 0.5 + Vec3::from(by)
        } else {
            Vec3::from(by)
        }
    };
    let other: Vec<Vec3> = object.positions.iter().map(&mut moved).collect();
    let mut mesh = OccluderMesh::bake(&other, &object.indices, options)?;
    mesh.set_positions(&object.positions)?;
    Ok(mesh)
}

/// Threads that stay from input to input.
fn workers() -> &'static WorkerThreads {
    static WORKERS: OnceLock<WorkerThreads> = OnceLock::new();
    WORKERS.get_or_init(|| WorkerThreads::new(3))
}

struct Answers {
    drawn: Result<(), CullError>,
    depth: Vec<u32>,
    list: Vec<Visibility>,
    tree: Vec<Visibility>,
    set: Vec<Visibility>,
}

impl Answers {
    fn of(
        drawn: Result<(), CullError>,
        culler: &Culler,
        scene: &Scene,
        tree: &OccludeeTree,
        objects: &OccludeeSet,
    ) -> Self {
        let (w, h) = culler.size();
        let mut depth = vec![0.0; (w * h) as usize];
        let mut list = vec![Visibility::Visible; scene.boxes.len()];
        let (mut by_tree, mut by_set) = (list.clone(), list.clone());
        let asked = [
            culler.read_depth(&mut depth),
            culler.query(&scene.boxes, scene.origin, &mut list),
            culler.query_tree(tree, &mut by_tree),
            culler.query_set(objects, &mut by_set),
        ];
        assert!(asked.iter().all(Result::is_ok), "{asked:?}");
        assert!(
            depth.iter().all(|d| (0.0..=1.0).contains(d)),
            "a depth beyond 0 to 1"
        );
        if drawn.is_err() {
            let culled = |v: &Visibility| !v.is_visible();
            assert!(
                !list.iter().any(culled),
                "a frame that failed culls nothing"
            );
        }
        Self {
            drawn,
            depth: depth.iter().map(|d| d.to_bits()).collect(),
            list,
            tree: by_tree,
            set: by_set,
        }
    }
}

impl Answers {
    /// The first part that is not the same.
    fn difference(&self, other: &Self) -> Option<(&'static str, usize)> {
        let at = |name, a: &[Visibility], b: &[Visibility]| {
            let place = a.iter().zip(b).position(|(a, b)| a != b);
            place.map(|place| (name, place))
        };
        if self.drawn != other.drawn {
            return Some(("success", 0));
        }
        let pixel = self
            .depth
            .iter()
            .zip(&other.depth)
            .position(|(a, b)| a != b);
        pixel
            .map(|pixel| ("pixel", pixel))
            .or_else(|| at("box", &self.list, &other.list))
            .or_else(|| at("box of the tree", &self.tree, &other.tree))
            .or_else(|| at("box of the set", &self.set, &other.set))
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    random_bytes(48)
}
