//! What a bench on a graphics adapter is about, and where its figures go: the same arguments for
//! each.

use foveal::{AdapterStats, Gpu, Renderer, RendererOptions, Settings};
use foveal_host::clock::now_ns;
use foveal_host::command_line::quoted;
use foveal_host::environment::environment;
use foveal_scene::{Camera, Scene};
use pollster::block_on;
use serde::Serialize;

use super::figures::FigureArgs;
use foveal_host::camera::{CameraArgs, Viewpoint};
use foveal_host::import_args::ImportArgs;
use foveal_host::{console, scene_source};

/// Frames that compile shaders, and in which what adapts from frame to frame adapts.
pub(super) const WARM_UP: u32 = 8;

/// A scene, where it is seen from, and what draws it.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct SubjectArgs {
    /// A glTF 2.0, OBJ or PLY file, or a generated scene
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    pub(super) scene: String,

    #[command(flatten)]
    pub(super) camera: CameraArgs,

    #[command(flatten)]
    pub(super) figures: FigureArgs,

    #[command(flatten)]
    pub(super) import: ImportArgs,
}

/// A renderer that shows the scene and times its frames.
pub(super) fn timed_renderer(
    gpu: &Gpu,
    scene: &Scene,
    settings: &Settings,
) -> anyhow::Result<Renderer> {
    let options = RendererOptions::default().with_clock(now_ns);
    let mut renderer = block_on(Renderer::new(gpu, settings, options))?;
    if let Some(map) = environment(settings)? {
        block_on(renderer.set_environment(map))?;
    }
    block_on(renderer.set_scene(scene))?;
    Ok(renderer)
}

/// Says what is wrong with a scene: what is measured may not be what its author means.
pub(super) fn warn(scene: &Scene) {
    let warnings = scene.warnings.iter();
    warnings.for_each(|warning| console::warn(&warning.text));
}

/// A scene with so many lights added, as `foveal render` adds them.
pub(super) fn lit(mut scene: Scene, point_lights: u32) -> Scene {
    scene_source::add_point_lights(&mut scene, point_lights, 0);
    scene.light_by_default();
    scene
}

/// Where a camera that sways sideways is in a frame: two centimetres a frame, to and fro within
/// half a metre.
pub(super) fn swayed(camera: &Camera, frame: u32) -> Camera {
    const STEP_M: f32 = 0.02;
    const STEPS: u32 = 24;
    let turn = frame % (2 * STEPS);
    let away = turn.min(2 * STEPS - turn) as f32 * STEP_M;
    let mut camera = camera.clone();
    let right = camera.world_from_view.x_axis;
    camera.world_from_view.w_axis += right * away;
    camera
}

/// What a bench's JSON begins with.
#[derive(Debug, Serialize)]
pub(super) struct Header {
    schema: &'static str,
    schema_version: u32,
    pub(super) adapter: AdapterStats,
    pub(super) scene: String,
    camera: String,
}

impl Header {
    pub(super) fn new(
        (schema, schema_version): (&'static str, u32),
        gpu: &Gpu,
        scene: &Scene,
        camera: &Camera,
    ) -> Self {
        Self {
            schema,
            schema_version,
            adapter: gpu.adapter_stats(),
            scene: scene.name.clone(),
            camera: camera.name.clone(),
        }
    }
}

/// The device and the scene, lit, with the first view of it.
pub(super) struct Subject {
    pub(super) gpu: Gpu,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
}

impl SubjectArgs {
    /// Opens the device; fails before that where the figures could not be written, or where the
    /// camera's flags contradict each other.
    pub(super) fn begin(&self) -> anyhow::Result<Gpu> {
        self.camera.check()?;
        (self.figures).begin(std::slice::from_ref(&self.scene), &self.camera)
    }

    /// The scene as its file has it.
    pub(super) fn load(&self) -> anyhow::Result<Scene> {
        scene_source::load_with(&self.scene, &self.import.options())
    }

    /// The scene as `foveal render` draws it with so many lights added.
    pub(super) fn scene(&self, point_lights: u32) -> anyhow::Result<Scene> {
        Ok(lit(self.load()?, point_lights))
    }

    /// Where the scene is seen from.
    pub(super) fn viewpoint(&self, scene: &Scene) -> anyhow::Result<Viewpoint> {
        Viewpoint::choose(&self.camera, scene, &self.scene)
    }

    /// Where the scene is seen from along another path.
    pub(super) fn along(&self, path: &CameraArgs, scene: &Scene) -> anyhow::Result<Viewpoint> {
        Viewpoint::choose(path, scene, &self.scene)
    }

    /// Device, scene and first view.
    pub(super) fn open(&self, point_lights: u32) -> anyhow::Result<Subject> {
        let gpu = self.begin()?;
        let scene = self.scene(point_lights)?;
        warn(&scene);
        let camera = self.viewpoint(&scene)?.at(&scene, 0.0);
        Ok(Subject { gpu, scene, camera })
    }

    /// What `foveal render` is told to draw the subject as a bench does that has warmed up, but for
    /// settings.
    pub(super) fn words(&self, point_lights: u32, output: &str) -> String {
        let mut words = vec![self.scene.clone(), "--output".to_owned(), output.to_owned()];
        words.extend(["--warmup".to_owned(), WARM_UP.to_string()]);
        if point_lights > 0 {
            words.extend(["--point-lights".to_owned(), point_lights.to_string()]);
        }
        words.extend(self.camera.flags());
        words.extend(self.import.flags());
        words.extend(self.figures.adapter_flags());
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        words.join(" ")
    }

    /// Writes the report where it was asked for, and prints it or the table.
    pub(super) fn give(&self, report: &impl Serialize, table: &str) -> anyhow::Result<()> {
        self.figures.give(report, table)
    }
}

impl Subject {
    /// What the bench's JSON begins with.
    pub(super) fn header(&self, schema: &'static str, schema_version: u32) -> Header {
        Header::new(
            (schema, schema_version),
            &self.gpu,
            &self.scene,
            &self.camera,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        subject: SubjectArgs,
    }

    #[test]
    fn what_is_drawn_again_is_read_in_the_same_way() {
        let words = "bench my.glb --clip Run --max-texture-size 64 --outside-files --adapter 0";
        let line = Line::try_parse_from(words.split(' ')).unwrap();
        let said = line.subject.words(3, "a.png");
        assert_eq!(
            said,
            "my.glb --output a.png --warmup 8 --point-lights 3 --clip Run --max-texture-size 64 \
             --outside-files --adapter 0"
        );
    }
}
