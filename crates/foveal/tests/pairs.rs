//! Pairs of settings that show the same, in scenes, from cameras and with other settings by chance.
//!
//! A failure is made smaller, towards default settings, and printed.
//! `FOVEAL_PAIRS=400 FOVEAL_PAIRS_SEED=7 cargo test --release -p foveal --test pairs` makes it long.

use std::sync::LazyLock;

use foveal::{
    AmbientOcclusion, Antialiasing, CoarseBackend, Composite, Culling, CullingEyes,
    EnvironmentSource, Error, EyeClipping, Frame, Geometry, Gpu, LightAssignment, LightingPass,
    MaterialDispatch, Output, RateSource, Renderer, RendererOptions, SamplePattern, Settings,
    Shading, Shadows, Stereo,
};
use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::{Mat4, Vec3};
use pollster::block_on;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestError, TestRng, TestRunner};

/// Numbers by which a pair, its scene, its cameras and its settings are chosen.
const NUMBERS: usize = 36;

/// Frames until light that is kept has been shaded anew everywhere.
const ROUND: usize = 20;

static GPU: LazyLock<Gpu> =
    LazyLock::new(|| block_on(Gpu::open(None)).expect("the tests need a graphics adapter"));

static SCENES: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let names = ["cornell", "alpha", "lobes", "materials-grid", "demo:1000"];
    let named = |name| generate::by_name(name).expect("a scene of that name");
    names.map(named).into_iter().map(lit).collect()
});

fn lit(mut scene: Scene) -> Scene {
    scene.light_by_default();
    generate::add_point_lights(&mut scene, 12, 3);
    let last = scene.instances.last().expect("an instance").mesh;
    scene.meshes[last as usize].deforms = true;
    scene
}

/// Choices in turn; where numbers end, the first of each list.
struct Chance<'a>(std::slice::Iter<'a, u8>);

impl Chance<'_> {
    fn of<T: Copy>(&mut self, list: &[T]) -> T {
        let number = self.0.next().copied().unwrap_or(0);
        list[usize::from(number) % list.len()]
    }
}

/// What is set on both sides. The first of each list is the default, or simplest.
fn settings(chance: &mut Chance<'_>) -> Settings {
    Settings::default().with(|s| {
        (s.picture.width, s.picture.height) = chance.of(&[(64, 48), (97, 61), (33, 90)]);
        s.picture.exposure_stops = chance.of(&[0.0, 2.0, -3.0]);
        s.picture.render_scale = chance.of(&[1.0, 1.0, 0.7]);
        s.geometry.path = chance.of(&[Geometry::Gbuffer, Geometry::Visibility]);
        s.lighting.shadow_atlas = 512;
        s.lighting.shadows =
            chance.of(&[Shadows::Off, Shadows::Soft, Shadows::Hard, Shadows::Contact]);
        s.lighting.environment = chance.of(&[
            EnvironmentSource::Scene,
            EnvironmentSource::Sky,
            EnvironmentSource::None,
        ]);
        s.lighting.ambient_occlusion =
            chance.of(&[AmbientOcclusion::Off, AmbientOcclusion::Screen]);
        s.antialiasing.mode = chance.of(&[
            Antialiasing::None,
            Antialiasing::Msaa,
            Antialiasing::None,
            Antialiasing::Ssaa,
        ]);
        s.antialiasing.pattern = chance.of(&[SamplePattern::Grid, SamplePattern::Rotated]);
        s.shading.mode = chance.of(&[Shading::Full, Shading::Coarse, Shading::Variable]);
        s.rate.force = true;
        s.coarse.backend = chance.of(&[CoarseBackend::Compute, CoarseBackend::Stencil]);
        s.coarse.composite = chance.of(&[
            Composite::Light,
            Composite::Light,
            Composite::Smooth,
            Composite::Paper,
            Composite::Nearest,
        ]);
        s.coarse.history = chance.of(&[true, false]);
        s.coarse.source = chance.of(&[RateSource::Foveated, RateSource::Radii]);
        s.variable.blocks_4x4 = chance.of(&[false, true]);
        s.stereo.mode = chance.of(&[Stereo::Off, Stereo::Off, Stereo::Instanced]);
        s.stereo.output = chance.of(&[Output::Flat, Output::SideBySide, Output::Headset]);
    })
}

/// Two sides, how far apart a byte of their pictures may be, the share of bytes that may be farther,
/// whether the last frame alone counts, and whether the second side draws no other.
struct Pair {
    name: &'static str,
    sides: [Settings; 2],
    tolerance: u8,
    beyond: f32,
    at_rest: bool,
    skips: bool,
}

fn pair(chance: &mut Chance<'_>, both: &Settings) -> Pair {
    type Change<'a> = &'a dyn Fn(&mut Settings);
    let sides = |a: Change<'_>, b: Change<'_>| [both.clone().with(a), both.clone().with(b)];
    let of = |name, sides| Pair {
        name,
        sides,
        tolerance: 0,
        beyond: 0.0,
        at_rest: false,
        skips: false,
    };
    match chance.of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]) {
        0 => {
            let eyes = chance.of(&[CullingEyes::Each, CullingEyes::Shared]);
            let scale = chance.of(&[4, 1, 2, 7]);
            let radius_m = chance.of(&[0.0, 0.3]);
            let culled = |s: &mut Settings| {
                s.culling.mode = Culling::Occlusion;
                s.culling.eyes = eyes;
                s.culling.buffer_scale = scale;
                s.culling.radius_m = radius_m;
            };
            of(
                "culling",
                sides(&|s| s.culling.mode = Culling::Off, &culled),
            )
        }
        1 => {
            let clipping = chance.of(&[EyeClipping::Discard, EyeClipping::Clip]);
            let side = |mode| {
                move |s: &mut Settings| {
                    s.stereo.mode = mode;
                    s.stereo.clipping = clipping;
                }
            };
            of(
                "eyes",
                sides(&side(Stereo::TwoPass), &side(Stereo::Instanced)),
            )
        }
        2 => {
            let side = |dispatch| {
                move |s: &mut Settings| {
                    s.geometry.path = Geometry::Visibility;
                    s.geometry.material_dispatch = dispatch;
                }
            };
            let [a, b] = [MaterialDispatch::Family, MaterialDispatch::Material];
            of("materials", sides(&side(a), &side(b)))
        }
        3 => of("draws", sides(&|s| s.geometry.merge_draws = false, &|_| ())),
        4 => of("again", sides(&|_| (), &|_| ())),
        5 => {
            let common = |s: &mut Settings| {
                s.stereo.mode = Stereo::Off;
                if s.antialiasing.mode == Antialiasing::Ssaa {
                    s.antialiasing.mode = Antialiasing::Msaa;
                }
            };
            let full = |s: &mut Settings| {
                common(s);
                s.shading.mode = Shading::Full;
            };
            let kept = |s: &mut Settings| {
                common(s);
                s.shading.mode = Shading::Coarse;
                s.coarse.backend = CoarseBackend::Compute;
                s.coarse.composite = Composite::Light;
                s.coarse.history = true;
            };
            Pair {
                at_rest: true,
                ..of("light at rest", sides(&full, &kept))
            }
        }
        6 => {
            let every = |s: &mut Settings| {
                s.shading.mode = Shading::Variable;
                s.coarse.source = RateSource::Constant;
                s.coarse.constant_level = 0;
                s.stereo.mode = Stereo::Off;
            };
            let full = |s: &mut Settings| {
                s.shading.mode = Shading::Full;
                s.stereo.mode = Stereo::Off;
            };
            Pair {
                tolerance: 1,
                ..of("every pixel", sides(&full, &every))
            }
        }
        7 => {
            let side = |pass| move |s: &mut Settings| s.lighting.pass = pass;
            let [a, b] = [LightingPass::Fragment, LightingPass::Compute];
            of("passes", sides(&side(a), &side(b)))
        }
        8 => {
            let full = |s: &mut Settings| {
                s.shading.mode = Shading::Full;
                // Else it follows the size of the scene as it was set.
                s.lighting.ambient_occlusion_radius_m = 0.4;
            };
            // Tiles lie elsewhere in the atlas of shadows, so that a texel at an edge may turn.
            let has_shadows = both.lighting.shadows != Shadows::Off;
            Pair {
                beyond: if has_shadows { 0.005 } else { 0.0 },
                at_rest: true,
                skips: true,
                ..of("afresh", sides(&full, &full))
            }
        }
        _ => Pair {
            tolerance: 1,
            ..of(
                "lights",
                sides(&|s| s.lighting.assignment = LightAssignment::Brute, &|s| {
                    s.lighting.assignment = LightAssignment::Clustered
                }),
            )
        },
    }
}

/// The cameras of some frames, each a step and a turn from the one before.
fn cameras(chance: &mut Chance<'_>, scene: &Scene, pair: &Pair) -> Vec<Camera> {
    let first = chance.of(&[0, 1, 2]) % scene.cameras.len();
    let step = chance.of(&[0.0, 0.02, 0.3]);
    let turn = chance.of(&[0.0, 0.01, 0.2]);
    let frames = if pair.at_rest { 4 + ROUND } else { 4 };
    (0..frames)
        .map(|frame| {
            let frame = frame.min(3) as f32;
            let mut camera = scene.cameras[first].clone();
            let moved = Mat4::from_translation(Vec3::new(step * frame, 0.0, 0.0));
            camera.world_from_view *= moved * Mat4::from_rotation_y(turn * frame);
            camera
        })
        .collect()
}

/// The scene's poses in some frames; after the last one it rests.
fn poses(chance: &mut Chance<'_>, scene: &Scene) -> Vec<Scene> {
    let what = chance.of(&["", "", "thing", "lamp", "dim", "color", "shape", "all"]);
    let which = usize::from(chance.of(&[0_u8, 1, 7, 50, 255]));
    let frames = if what.is_empty() { 1 } else { 4 };
    (0..frames)
        .map(|frame| posed(scene, what, which, frame as f32))
        .collect()
}

fn posed(scene: &Scene, what: &str, which: usize, frame: f32) -> Scene {
    let mut scene = scene.clone();
    let moves = |one| what == one || what == "all";
    let along = Mat4::from_translation(Vec3::new(0.1, 0.02, -0.05) * frame);
    if moves("thing") {
        let count = scene.instances.len();
        let instance = &mut scene.instances[which % count];
        instance.world_from_object = along * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(along);
        let object = &mut scene.objects[instance.object as usize];
        object.bounds = object.bounds.union(instance.bounds);
    }
    let lamps = scene.lights.len();
    let lamp = &mut scene.lights[which % lamps];
    if moves("lamp") {
        lamp.position += Vec3::new(0.2, 0.1, 0.0) * frame;
    }
    if moves("dim") {
        lamp.intensity *= 1.0 - 0.3 * frame;
    }
    if moves("color") {
        let materials = scene.materials.len();
        scene.materials[which % materials].base_color[0] *= 1.0 - 0.2 * frame;
    }
    if moves("shape") {
        let mesh = scene.instances.last().expect("an instance").mesh;
        let shape = &mut scene.meshes[mesh as usize];
        for vertex in &mut shape.vertices {
            vertex.position[0] *= 1.0 + 0.1 * frame;
        }
        shape.bounds =
            shape
                .bounds
                .transformed(Mat4::from_scale(Vec3::new(1.0 + 0.1 * frame, 1.0, 1.0)));
        let bounds = shape.bounds;
        for instance in scene.instances.iter_mut().filter(|i| i.mesh == mesh) {
            instance.bounds = bounds.transformed(instance.world_from_object);
            let object = &mut scene.objects[instance.object as usize];
            object.bounds = object.bounds.union(instance.bounds);
        }
    }
    scene
}

/// The pictures of all frames from `first` on, or of the last one; `None` where these settings cannot
/// be drawn.
fn pictures(
    poses: &[Scene],
    cameras: &[Camera],
    settings: &Settings,
    last_alone: bool,
    first: usize,
) -> Option<Vec<Vec<u8>>> {
    block_on(async {
        let new = Renderer::new(&GPU, settings, RendererOptions::default());
        let mut renderer = match new.await {
            Err(Error::Setting { .. } | Error::Limit { .. }) => return None,
            renderer => renderer.expect("nothing else fails"),
        };
        let start = &poses[first.min(poses.len() - 1)];
        renderer.set_scene(start).await.expect("it fits");
        let mut found = Vec::new();
        for (i, camera) in cameras.iter().enumerate().skip(first) {
            if let Some(pose) = poses.get(i).filter(|_| i > first) {
                renderer.update_pose(pose).await.expect("it fits");
            }
            let frame = Frame::new(camera).with_previous(&cameras[i.saturating_sub(1)]);
            renderer.render(&frame).await.expect("drawn");
            if !last_alone || i + 1 == cameras.len() {
                found.push(renderer.read_picture().await.expect("read"));
            }
        }
        Some(found)
    })
}

/// Draws both sides; tells whether they could be.
fn compare(numbers: &[u8]) -> Result<bool, TestCaseError> {
    // Each has numbers of its own, so that fewer choices of one leave the others alone.
    let of = |range: std::ops::Range<usize>| Chance(numbers[range].iter());
    let scene = &SCENES[of(0..1).of(&[0, 1, 2, 3, 4])];
    let both = settings(&mut of(8..32));
    let pair = pair(&mut of(1..5), &both);
    let cameras = cameras(&mut of(5..8), scene, &pair);
    let poses = poses(&mut of(32..NUMBERS), scene);
    let draw = |side, first| pictures(&poses, &cameras, side, pair.at_rest, first);
    let first = if pair.skips { cameras.len() - 1 } else { 0 };
    let (Some(a), Some(b)) = (draw(&pair.sides[0], 0), draw(&pair.sides[1], first)) else {
        return Ok(false);
    };
    for (frame, (a, b)) in a.iter().zip(&b).enumerate() {
        prop_assert_eq!(a.len(), b.len());
        let apart = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
        let most = apart.clone().max();
        let beyond = apart.filter(|apart| *apart > pair.tolerance).count();
        prop_assert!(
            beyond as f32 <= pair.beyond * a.len() as f32,
            "{}, frame {frame}: apart by {most:?} with {both:?}",
            pair.name
        );
    }
    Ok(true)
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

#[test]
fn both_sides_of_a_pair_show_the_same() {
    let pairs = number("FOVEAL_PAIRS", 24) as u32;
    let config = ProptestConfig {
        cases: pairs,
        max_shrink_iters: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let seed = number("FOVEAL_PAIRS_SEED", 1).to_le_bytes().repeat(4);
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let numbers = proptest::collection::vec(any::<u8>(), NUMBERS);
    let drawn = std::cell::Cell::new(0);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let result = runner.run(&numbers, |numbers| {
        drawn.set(drawn.get() + u32::from(compare(&numbers)?));
        Ok(())
    });
    match result {
        Ok(()) => (),
        Err(TestError::Abort(reason)) => panic!("{reason}"),
        Err(TestError::Fail(reason, numbers)) => panic!("{reason}, by {numbers:?}"),
    }
    let drawn = drawn.get();
    assert!(2 * drawn > pairs, "of {pairs} pairs {drawn} could be drawn");
}
