//! Long runs in which everything changes: sizes, settings, scenes, lights, environments, and devices
//! that are lost. Every few frames the picture must be that of a renderer which has never drawn
//! anything else, and at each tenth of the run the program must hold no more than at the first.
//!
//! `FOVEAL_SOAK_FRAMES=10000 FOVEAL_SOAK_SEED=1 cargo test --release -p foveal --test soak` makes it
//! long; with `FOVEAL_SOAK_PACE=10` all but the frames is ten times as rare.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a test says what it measured, and a failed unwrap is a failed test"
)]

mod memory;

use foveal::{
    Antialiasing, CoarseBackend, Composite, Culling, DebugView, EnvironmentMap, EnvironmentSource,
    Error, Frame, Geometry, Gpu, LightAssignment, Output, RateImage, Renderer, RendererOptions,
    Settings, Shading, Shadows, Stereo, ToneMap,
};
use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::{Mat4, Vec3};
use pollster::block_on;

/// Frames of a run that is not asked to be longer.
const FRAMES: u64 = 60;
/// Frames between two comparisons with a new renderer.
const BETWEEN: u64 = 7;

/// Bytes of the program's own memory that differ by chance: lists of the graphics library that have
/// grown, and what a test writes down.
const NOISE: u64 = 1 << 20;

/// Numbers that look random; the same ones for the same seed.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) % n
    }

    fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }
}

fn number(name: &str, default: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(default, |text| text.parse().expect("a number"))
}

/// Everything that a picture depends on.
#[derive(Clone)]
struct State {
    settings: Settings,
    scene: Scene,
    map: EnvironmentMap,
    camera: Camera,
}

fn scene(dice: &mut Dice) -> Scene {
    let name = dice.of(&["cornell", "alpha", "materials-grid"]);
    let mut scene = generate::by_name(name).unwrap();
    generate::add_point_lights(&mut scene, dice.below(40) as u32, dice.below(1000));
    scene.light_by_default();
    scene
}

fn map(dice: &mut Dice) -> EnvironmentMap {
    let (width, height, rgb) = generate::surroundings(dice.of(&[8, 16, 32]));
    EnvironmentMap::new(width, height, &rgb).unwrap()
}

/// Settings whose picture depends on nothing that was drawn before.
fn settings(dice: &mut Dice, before: &Settings) -> Settings {
    before.clone().with(|s| {
        s.coarse.history = false;
        match dice.below(12) {
            0 | 1 => s.picture.width = 16 + dice.below(80) as u32,
            2 | 3 => s.picture.height = 16 + dice.below(60) as u32,
            4 => s.picture.render_scale = dice.of(&[1.0, 0.5]),
            5 => {
                s.lighting.shadows = dice.of(&[Shadows::Off, Shadows::Hard, Shadows::Soft]);
                s.lighting.shadow_atlas = dice.of(&[256, 512]);
            }
            6 => {
                s.lighting.environment = dice.of(&[
                    EnvironmentSource::Gradient,
                    EnvironmentSource::Sky,
                    EnvironmentSource::Image,
                    EnvironmentSource::None,
                ]);
                s.lighting.environment_rotation_deg = dice.below(360) as f32 - 180.0;
            }
            7 => {
                s.shading.mode = dice.of(&[Shading::Full, Shading::Coarse]);
                s.coarse.backend = dice.of(&[CoarseBackend::Stencil, CoarseBackend::Compute]);
                s.coarse.composite = dice.of(&[Composite::Light, Composite::Nearest]);
            }
            8 => {
                s.antialiasing.mode =
                    dice.of(&[Antialiasing::None, Antialiasing::Msaa, Antialiasing::Ssaa])
            }
            9 => {
                s.stereo.mode = dice.of(&[Stereo::Off, Stereo::Instanced, Stereo::TwoPass]);
                s.stereo.output = dice.of(&[Output::SideBySide, Output::Anaglyph]);
            }
            10 => {
                s.geometry.path = dice.of(&[Geometry::Gbuffer, Geometry::Visibility]);
                s.culling.mode = dice.of(&[
                    Culling::Off,
                    Culling::Auto,
                    Culling::Frustum,
                    Culling::Occlusion,
                ]);
            }
            _ => {
                s.picture.view = dice.of(&[DebugView::Final, DebugView::Final, DebugView::Normals]);
                s.picture.tone_map = dice.of(&[ToneMap::Aces, ToneMap::Linear]);
                s.picture.exposure_stops = dice.below(5) as f32 - 2.0;
                s.lighting.assignment =
                    dice.of(&[LightAssignment::Clustered, LightAssignment::Brute]);
            }
        }
    })
}

async fn renderer(gpu: &Gpu, state: &State) -> Result<Renderer, Error> {
    let mut renderer = Renderer::new(gpu, &state.settings, RendererOptions::default()).await?;
    renderer
        .set_rate_image(RateImage::new(2, 1, vec![0, 128]).unwrap())
        .unwrap();
    renderer.set_environment(state.map.clone()).await?;
    renderer.set_scene(&state.scene).await?;
    Ok(renderer)
}

/// The frame's picture; nothing in it moves. A frame of anti-aliasing that leaves surfaces out, in
/// want of room, is followed by one that has the room.
async fn picture(renderer: &mut Renderer, state: &State) -> Result<Vec<u8>, Error> {
    let frame = Frame::new(&state.camera);
    for _ in 0..4 {
        if renderer.render(&frame).await?.surfaces_left_out == 0 {
            break;
        }
    }
    renderer.read_picture().await
}

/// Whether two pictures are the same to the byte. With shadows a few bytes may differ by one: a tile
/// lies where earlier frames have left room in the atlas, and at another place it is rasterized with
/// other rounding (12 bytes of 21,672 were seen).
fn is_the_same(a: &[u8], b: &[u8], shadows: Shadows) -> bool {
    if shadows == Shadows::Off || a.len() != b.len() {
        return a == b;
    }
    let differences = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let others = differences().filter(|d| *d > 0).count();
    differences().all(|d| d <= 1) && others <= a.len() / 500
}

/// Bytes of the program's own memory when all is as it was in the beginning. What a renderer keeps
/// beside what it draws with, or what a lost device leaves behind, makes them more.
fn at_rest(gpu: &Gpu, renderer: &mut Renderer, first: &State) -> u64 {
    let mut sky = first.settings.clone();
    sky.lighting.environment = EnvironmentSource::Sky;
    block_on(async {
        renderer.set_environment(first.map.clone()).await?;
        renderer.set_scene(&first.scene).await?;
        // The last sky that was filtered is kept: here always this one.
        renderer.set_settings(&sky).await?;
        renderer.set_settings(&first.settings).await?;
        renderer.set_scene(&first.scene).await?;
        for _ in 0..3 {
            picture(renderer, first).await?;
        }
        Ok::<(), Error>(())
    })
    .unwrap();
    // Pipelines of other settings.
    gpu.trim();
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    memory::live()
}

#[test]
fn whatever_happens_a_renderer_draws_what_a_new_one_draws() {
    let (frames, seed, pace) = (
        number("FOVEAL_SOAK_FRAMES", FRAMES),
        number("FOVEAL_SOAK_SEED", 1),
        number("FOVEAL_SOAK_PACE", 1),
    );
    let mut dice = Dice(seed);
    let mut gpu = block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let cornell = scene(&mut dice);
    let mut state = State {
        settings: Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 36;
            s.coarse.history = false;
            s.rate.force = true;
        }),
        camera: cornell.cameras[0].clone(),
        scene: cornell,
        map: map(&mut dice),
    };
    let mut drawing = block_on(renderer(&gpu, &state)).unwrap();
    let (mut lost, mut refused, mut compared) = (0, 0, 0u64);
    let first = state.clone();
    let mut memory = Vec::new();
    let mut resident = Vec::new();
    for frame in 0..frames {
        let what = format!("frame {frame} of seed {seed}");
        if dice.one_in(3 * pace) {
            let wanted = settings(&mut dice, &state.settings);
            match block_on(drawing.set_settings(&wanted)) {
                Ok(()) => {
                    let again = wanted.needs_scene_again(&state.settings);
                    state.settings = wanted;
                    if again {
                        block_on(drawing.set_scene(&state.scene)).unwrap();
                    }
                }
                // Some settings exclude each other: the old ones hold.
                Err(Error::Setting { .. } | Error::Limit { .. }) => refused += 1,
                Err(other) => panic!("{what}: {other}"),
            }
        }
        if dice.one_in(12 * pace) {
            state.scene = scene(&mut dice);
            state.camera = state.scene.cameras[0].clone();
            block_on(drawing.set_scene(&state.scene)).unwrap();
        }
        if dice.one_in(15 * pace) {
            state.map = map(&mut dice);
            block_on(drawing.set_environment(state.map.clone())).unwrap();
        }
        if dice.one_in(2) {
            let step = Vec3::new(0.01 * (dice.below(21) as f32 - 10.0), 0.0, 0.0);
            state.camera.world_from_view =
                Mat4::from_translation(step) * state.camera.world_from_view;
        }
        if dice.one_in(20 * pace) {
            lost += 1;
            gpu.device.destroy();
            let error = block_on(picture(&mut drawing, &state)).unwrap_err();
            assert!(matches!(error, Error::DeviceLost { .. }), "{what}: {error}");
            gpu = block_on(Gpu::open(None)).unwrap();
            drawing = block_on(renderer(&gpu, &state)).unwrap();
        }
        let drawn =
            block_on(picture(&mut drawing, &state)).unwrap_or_else(|e| panic!("{what}: {e}"));
        if frame % (BETWEEN * pace) == 0 {
            compared += 1;
            let mut anew = block_on(renderer(&gpu, &state)).unwrap();
            let expected = block_on(picture(&mut anew, &state)).unwrap();
            assert!(
                is_the_same(&drawn, &expected, state.settings.lighting.shadows),
                "{what}: another picture with {:?}",
                state.settings
            );
        }
        if frame % (frames / 10).max(1) == 0 {
            state = first.clone();
            memory.push(at_rest(&gpu, &mut drawing, &first));
            resident.push(memory::resident_mib());
            println!(
                "frame {frame}: {} bytes held, {} MiB resident",
                memory[memory.len() - 1],
                resident[resident.len() - 1]
            );
        }
    }
    println!(
        "{frames} frames, {lost} devices lost, {refused} settings refused, {compared} pictures compared; \
         at each tenth {memory:?} bytes held, {resident:?} MiB resident"
    );
    // Devices are lost by chance.
    assert!((lost > 0 || frames < 300 * pace) && compared >= frames / (BETWEEN * pace));
    for (tenth, held) in memory.iter().enumerate() {
        assert!(*held < memory[0] + NOISE, "tenth {tenth}: {memory:?}");
    }
}
