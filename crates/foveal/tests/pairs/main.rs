//! Pairs of settings that show the same, in scenes, from cameras and with other settings by chance.
//!
//! A failure is made smaller, towards default settings, and printed.
//! `FOVEAL_PAIRS=400 FOVEAL_PAIRS_SEED=7 cargo test --release -p foveal --test pairs` makes it long.
//! `FOVEAL_PAIR=0,11,0,235` draws the pair of these numbers alone, which a failure tells.

use std::sync::LazyLock;

#[path = "../common/host.rs"]
mod host;
mod kinds;
mod motion;
mod placement;
mod settings;
mod textured;

use foveal::{Error, Frame, Gpu, Renderer, RendererOptions, Settings};
use foveal_generate as generate;
use foveal_scene::{Camera, LightKind, Scene};
use glam::Vec3;
use pollster::block_on;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

use settings::Chance;

/// Numbers by which a pair, its scene, its cameras, its poses and its settings are chosen.
const NUMBERS: usize = 32 + 2 * settings::NUMBERS;

/// Frames until light that is kept has been shaded anew everywhere.
const ROUND: usize = 20;

static GPU: LazyLock<Gpu> =
    LazyLock::new(|| block_on(Gpu::open(None)).expect("the tests need a graphics adapter"));

/// A device that was asked for no more than WebGL 2 has.
static REDUCED: LazyLock<Gpu> = LazyLock::new(|| {
    let (device, queue) = host::device(wgpu::Features::empty(), Gpu::reduced_limits());
    Gpu::from_device(device, queue)
});

static SCENES: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let names = ["cornell", "alpha", "lobes", "materials-grid", "demo:1000"];
    let named = |name| generate::by_name(name).expect("a scene of that name");
    let named = names.map(named).into_iter();
    named.chain([textured::textured()]).map(lit).collect()
});

fn lit(mut scene: Scene) -> Scene {
    scene.light_by_default();
    generate::add_point_lights(&mut scene, 12, 3);
    for lamp in scene.lights.iter_mut().rev().take(12).step_by(3) {
        lamp.kind = LightKind::Spot {
            inner_rad: 0.3,
            outer_rad: 0.8,
        };
        lamp.direction = Vec3::new(0.3, -0.9, -0.3).normalize();
    }
    let last = scene.instances.last().expect("an instance").mesh;
    scene.meshes[last as usize].deforms = true;
    scene
}

/// `None` where these settings cannot be drawn.
fn drawable<T>(result: Result<T, Error>) -> Option<T> {
    match result {
        Err(Error::Setting { .. } | Error::Limit { .. }) => None,
        result => Some(result.expect("nothing else fails")),
    }
}

/// The pictures of all frames from `first` on, or of the last one; `None` where these settings cannot
/// be drawn. Until the last frame of motion the renderer has the settings `before`.
fn pictures(
    gpu: &Gpu,
    poses: &[Scene],
    cameras: &[Camera],
    settings: &Settings,
    before: Option<&Settings>,
    last_alone: bool,
    first: usize,
) -> Option<Vec<Vec<u8>>> {
    block_on(async {
        let start = before.unwrap_or(settings);
        let new = Renderer::new(gpu, start, RendererOptions::default());
        let mut renderer = drawable(new.await)?;
        let start = &poses[first.min(poses.len() - 1)];
        renderer.set_scene(start).await.expect("it fits");
        let mut found = Vec::new();
        for (i, camera) in cameras.iter().enumerate().skip(first) {
            let pose = poses.get(i).filter(|_| i > first);
            if let (3, Some(before)) = (i, before) {
                drawable(renderer.set_settings(settings).await)?;
                if settings.needs_scene_again(before) {
                    let pose = pose.unwrap_or(&poses[0]);
                    renderer.set_scene(pose).await.expect("it fits");
                }
            }
            if let Some(pose) = pose {
                renderer.update_pose(pose).await.expect("it fits");
            }
            let frame = Frame::new(camera).with_previous(&cameras[i.saturating_sub(1)]);
            drawable(renderer.render(&frame).await)?;
            if !last_alone || i + 1 == cameras.len() {
                found.push(renderer.read_picture().await.expect("read"));
            }
        }
        Some(found)
    })
}

/// Draws both sides; tells whether they could be.
fn compare(numbers: &[u8]) -> Result<bool, String> {
    // Each has numbers of its own, so that fewer choices of one leave the others alone.
    let of = |range: std::ops::Range<usize>| Chance(numbers[range].iter());
    let scene = &SCENES[of(0..1).of(&[0, 1, 2, 3, 4, 5])];
    let both = 32..32 + settings::NUMBERS;
    let before = both.end..NUMBERS;
    let both = settings::settings(&mut of(both));
    let pair = kinds::pair(&mut of(1..8), &both, &mut of(before));
    let frames = if pair.at_rest { 4 + ROUND } else { 4 };
    let cameras = motion::cameras(&mut of(8..20), scene, frames);
    let poses = motion::poses(&mut of(20..32), scene);
    let draw = |gpu, poses: &[_], cameras: &[_], side, before, first| {
        pictures(gpu, poses, cameras, side, before, pair.at_rest, first)
    };
    let first = if pair.skips { cameras.len() - 1 } else { 0 };
    let (mut other_poses, mut other_cameras) = (poses.clone(), cameras.clone());
    if let Some(placement) = pair.placement {
        other_poses
            .iter_mut()
            .for_each(|pose| placement.scene(pose));
        other_cameras
            .iter_mut()
            .for_each(|camera| placement.camera(camera));
    }
    let [a, b] = &pair.sides;
    let a = draw(&GPU, &poses, &cameras, a, None, 0);
    let gpu = if pair.is_reduced { &REDUCED } else { &GPU };
    let b = draw(
        gpu,
        &other_poses,
        &other_cameras,
        b,
        pair.before.as_ref(),
        first,
    );
    let (Some(a), Some(b)) = (a, b) else {
        return Ok(false);
    };
    for (frame, (a, b)) in a.iter().zip(&b).enumerate() {
        assert_eq!(a.len(), b.len());
        let apart = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
        let most = apart.clone().max();
        let beyond = apart.filter(|apart| *apart > pair.tolerance).count();
        if beyond as f32 > pair.beyond * a.len() as f32 {
            let (name, bytes, before) = (pair.name, a.len(), pair.before);
            let used = NUMBERS - numbers.iter().rev().take_while(|n| **n == 0).count();
            let numbers: Vec<_> = numbers[..used].iter().map(u8::to_string).collect();
            let numbers = numbers.join(",");
            return Err(format!(
                "{name}, frame {frame}: {beyond} of {bytes} bytes are apart, by up to {most:?}, with \
                 {both:?}, before {before:?}, by FOVEAL_PAIR={numbers}"
            ));
        }
    }
    Ok(true)
}

/// Zeros in place of numbers, as long as it fails; the failure of what is left.
fn smaller(mut numbers: Vec<u8>, mut failure: String) -> String {
    let mut length = NUMBERS.div_ceil(2);
    while length > 0 {
        for start in (0..NUMBERS).step_by(length) {
            let mut fewer = numbers.clone();
            fewer[start..NUMBERS.min(start + length)].fill(0);
            if fewer != numbers
                && let Err(smaller) = compare(&fewer)
            {
                (numbers, failure) = (fewer, smaller);
            }
        }
        length /= 2;
    }
    failure
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

/// The numbers of [`compare`] that a failure told.
fn told(text: &str) -> Vec<u8> {
    let told = text.split(',').map(|n| n.trim().parse().expect("a number"));
    told.chain(std::iter::repeat(0)).take(NUMBERS).collect()
}

#[test]
fn both_sides_of_a_pair_show_the_same() {
    if let Ok(text) = std::env::var("FOVEAL_PAIR") {
        compare(&told(&text))
            .map(drop)
            .unwrap_or_else(|failure| panic!("{failure}"));
        return;
    }
    let pairs = number("FOVEAL_PAIRS", 24);
    let seed = number("FOVEAL_PAIRS_SEED", 1).to_le_bytes().repeat(4);
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let mut drawn = 0;
    let mut failures = Vec::new();
    for _ in 0..pairs {
        let mut numbers = vec![0; NUMBERS];
        random.fill_bytes(&mut numbers);
        match compare(&numbers) {
            Ok(could) => drawn += u64::from(could),
            Err(failure) => failures.push(smaller(numbers, failure)),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    assert!(2 * drawn > pairs, "of {pairs} pairs {drawn} could be drawn");
}
