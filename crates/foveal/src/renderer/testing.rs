//! What tests ask of a renderer.

use super::{Frame, Renderer, Stages};
use crate::FrameStats;
use crate::frame::FrameUniform;
use crate::geometry::{GeometryPass, ResolveAt};
use crate::lights::{ClusterGrid, LightAssigner};
use crate::recorder::Recorder;
use crate::scene::SceneOnGpu;
use crate::shading::{Balance, CoarseShading, HistoryStage};
use crate::stereo::{EyeLayout, eyes};
use crate::targets::Targets;
use foveal_scene::Camera;

impl Renderer {
    /// Makes coarse samples affine functions of their position from the next frame on.
    pub(crate) fn shade_affine(&mut self) {
        let stages = &mut self.stages;
        if let Some(coarse) = &mut stages.coarse {
            coarse.shading = CoarseShading::with_shaders(
                &self.gpu,
                &stages.settings,
                self.frame_bindings.layout(),
                stages.shading.input_layout(),
                [
                    crate::shader::SHADING_COARSE_SHADE_DRAW.variant(&["AFFINE"]),
                    crate::shader::SHADING_COARSE_SHADE_LIST.variant(&["AFFINE"]),
                ],
            );
        }
    }

    /// Leaves coarse shading off for as long as losses do.
    pub(crate) fn turn_coarse_off(&mut self) {
        self.set_balance(Balance::turned_off());
    }

    /// Compares coarse shading with full shading from the next frame on, and leaves it on.
    pub(crate) fn compare_coarse(&mut self) {
        self.set_balance(Balance::new(true, 0, true));
    }

    /// Leaves variable shading off for as long as losses do.
    pub(crate) fn turn_variable_off(&mut self) {
        let variable = self.stages.variable.as_mut();
        let variable = variable.expect("variable shading");
        variable.set_balance(Balance::turned_off());
    }

    fn set_balance(&mut self, balance: Balance) {
        let coarse = self.stages.coarse.as_mut();
        coarse.expect("coarse shading").set_balance(balance);
    }

    /// From corner to corner of the scene as it was set, in metres.
    pub(crate) fn diagonal_m(&self) -> f32 {
        self.scene.diagonal_m
    }

    /// How many cells may receive shadows, and of how many culling has said whether they are seen.
    pub(crate) fn cells_placed_and_tested(&self) -> (usize, usize) {
        let tested = self.stages.culling.as_ref().map_or(0, |c| c.cells_tested());
        (self.scene.culling.cells().len(), tested)
    }

    /// Encodes and submits passes besides a frame's.
    fn encode(&mut self, passes: impl FnOnce(&mut Recorder<'_>, &Stages, &SceneOnGpu)) {
        let Self {
            gpu,
            timer,
            frame_bindings,
            stages,
            scene,
            ..
        } = self;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorder = &mut Recorder {
            gpu,
            encoder: &mut encoder,
            timer,
            frame: frame_bindings,
        };
        passes(recorder, stages, scene);
        timer.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        timer.end_frame();
    }

    /// Sorts the last frame's pixels by material again, all of them or the samples of its mask.
    pub(crate) fn sort_again(&mut self, rated: bool, subgroups: bool) {
        self.encode(|recorder, stages, scene| {
            let targets = &stages.targets;
            let mask = targets.variable.as_ref().filter(|_| rated);
            let at = mask.map_or(ResolveAt::FULL, |v| ResolveAt::at_rates(&v.mask));
            let pass = stages.geometry.triangles().expect("a visibility buffer");
            pass.sort_again(recorder, scene, &targets.gbuffer, &at, subgroups);
        });
    }

    pub(crate) fn geometry(&self) -> &GeometryPass {
        &self.stages.geometry
    }

    pub(crate) fn scene(&self) -> &SceneOnGpu {
        &self.scene
    }

    pub(crate) fn targets(&self) -> &Targets {
        &self.stages.targets
    }

    pub(crate) fn history(&self) -> &HistoryStage {
        let coarse = self.stages.coarse.as_ref();
        let history = coarse.and_then(|coarse| coarse.history.as_ref());
        history.expect("light is kept")
    }

    pub(crate) fn lights(&self) -> (&LightAssigner, &[crate::lights::LightUniform]) {
        (&self.stages.lights, &self.scene.lights)
    }

    pub(crate) fn shadows(&self) -> &crate::shadow::ShadowStage {
        &self.stages.shadows
    }

    pub(crate) fn shadows_mut(&mut self) -> &mut crate::shadow::ShadowStage {
        &mut self.stages.shadows
    }

    /// What shaders are told of a frame.
    pub(crate) fn frame_uniform(&self, camera: &Camera) -> FrameUniform {
        let settings = &self.stages.settings;
        let eyes = eyes(settings, camera).expect("a camera that makes sense");
        let lights = &self.scene.lights;
        let grid = ClusterGrid::new(&EyeLayout::of(settings), &eyes, camera, lights);
        let environment = self.environment.terms(&self.scene.environment);
        FrameUniform::new(settings, camera, &eyes, &eyes, environment, &grid)
    }

    /// Draws the frame again.
    pub(crate) fn redraw(&mut self, camera: &Camera) -> FrameStats {
        let frame = Frame::new(camera);
        pollster::block_on(self.render(&frame)).expect("frame is drawn")
    }

    /// Draws the frame again in bands of `rows` rows.
    pub(crate) fn redraw_in_bands(&mut self, camera: &Camera, rows: u32) -> FrameStats {
        let settings = &self.stages.settings;
        let targets = crate::antialias::SampleTargets::in_bands(&self.gpu, settings, rows);
        self.stages.targets.samples = Some(targets);
        self.redraw(camera)
    }

    /// Leaves anti-aliasing room for one entry or, over a visibility buffer, one row of them.
    pub(crate) fn cut_room_for_edges(&mut self) {
        let settings = &self.stages.settings;
        let rows = settings.picture.height;
        let targets = crate::antialias::SampleTargets::with_room(&self.gpu, settings, rows, 1);
        self.stages.targets.samples = Some(targets);
    }
}
