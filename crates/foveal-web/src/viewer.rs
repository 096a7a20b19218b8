//! What the page calls.

use foveal::{FrameStats, Gpu, Settings};
use foveal_measure::{Comparison, Finding, FrameTimes, Turns};
use foveal_scene::Scene;
use serde::{Deserialize, Serialize};
use wasm_bindgen::prelude::*;

use crate::camera::Place;
use crate::present::Present;
use crate::scenes::{self, Beside, Shown};
use crate::side::Side;

/// One frame, as the page asks for it.
#[derive(Clone, PartialEq, Deserialize)]
struct FrameRequest {
    camera: Place,
    /// Size of the picture in pixels.
    width: u32,
    height: u32,
    /// Where the line stands, from 0 (all right) to 1 (all left). The hidden side is not drawn.
    split: f32,
}

impl FrameRequest {
    /// Whether both show the same, wherever the line stands.
    fn shows_the_same(&self, other: &Self) -> bool {
        let split = other.split;
        Self {
            split,
            ..self.clone()
        } == *other
    }
}

/// Which side is faster, as the page tells it.
#[derive(Serialize)]
struct Told {
    /// "1.26x (1.22 to 1.30)", "no difference (0.98 to 1.03)".
    text: String,
    finding: Finding,
    pairs: usize,
}

impl Told {
    fn of(found: &Comparison) -> Self {
        Self {
            text: found.text(),
            finding: found.finding,
            pairs: found.pairs,
        }
    }
}

/// What a frame cost, per side that was drawn.
#[derive(Serialize)]
struct Cost {
    reference: Option<CostOfSide>,
    chosen: Option<CostOfSide>,
    /// Whole frames and all passes of both sides compared; `None` until enough frames were drawn.
    frame: Option<Told>,
    passes: Option<Told>,
    /// Whether more frames can tell nothing more of the two sides.
    is_measured: bool,
    /// Milliseconds from the request to the canvas.
    total_ms: f64,
}

#[derive(Serialize)]
struct CostOfSide {
    #[serde(flatten)]
    stats: FrameStats,
    /// Pixels of all eyes' pictures at the size at which they are drawn.
    drawn_pixels: u64,
}

impl CostOfSide {
    fn new(side: &Side, stats: FrameStats) -> Self {
        Self {
            stats,
            drawn_pixels: side.drawn_pixels(),
        }
    }
}

/// A scene, two renderers and a canvas.
#[wasm_bindgen]
pub struct Viewer {
    gpu: Gpu,
    present: Present,
    scene: Scene,
    reference: Side,
    chosen: Side,
    /// Which side draws first, and what the pairs of this view say.
    turns: Turns,
    /// The view that the pairs are of.
    turns_of: Option<FrameRequest>,
    #[cfg(feature = "webgl")]
    _pump: crate::pump::Pump,
}

/// What this build draws with.
const BACKENDS: wgpu::Backends = if cfg!(feature = "webgl") {
    wgpu::Backends::GL
} else {
    wgpu::Backends::BROWSER_WEBGPU
};

/// The settings of a page that was just opened: the program's own, as JSON.
#[wasm_bindgen]
#[must_use]
pub fn default_settings() -> String {
    serde_json::to_string(&Settings::default()).unwrap_or_default()
}

/// What is to be known of each setting in order to offer it: a list of `{key, stage, label, help,
/// kind, names, least, most}`, `kind` one of `switch`, `choice` (of `names`), `integer` and
/// `number` (between `least` and `most`), `place`, `text`, `file`. With the feature `webgl` only
/// those that the reduced renderer can meet.
#[wasm_bindgen]
#[must_use]
pub fn settings_table() -> String {
    crate::table::json()
}

/// Reads a file as [`Viewer::load`] does, and forgets it: for a worker, which the page can end where
/// that takes too long.
///
/// # Errors
/// As [`Viewer::load`].
#[wasm_bindgen]
pub fn rehearse(name: &str, bytes: Vec<u8>, beside: &js_sys::Map) -> Result<(), String> {
    scenes::from_bytes(name, &bytes, &Beside::new(beside)).map(drop)
}

#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}

#[wasm_bindgen]
impl Viewer {
    /// Opens the browser's graphics device and draws into `canvas`. The scene is empty.
    ///
    /// # Errors
    /// A sentence: no WebGPU (with the feature `webgl`: no WebGL 2), no adapter, no device.
    pub async fn open(canvas: web_sys::HtmlCanvasElement) -> Result<Viewer, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: BACKENDS,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let surface = instance
            .create_surface(wgpu::SurfaceTarget::Canvas(canvas))
            .map_err(|cause| format!("the canvas cannot be drawn into: {cause}"))?;
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: Some(&surface),
                ..Default::default()
            })
            .await
            .map_err(|_| "the browser found no graphics adapter")?;
        let gpu = Gpu::from_adapter(&adapter)
            .await
            .map_err(|cause| cause.to_string())?;
        #[cfg(feature = "webgl")]
        let pump = crate::pump::Pump::start(&gpu.device)?;
        let present = Present::new(&gpu, surface, &adapter)?;
        let scene = Scene::default();
        let settings = Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 64;
        });
        let reference = Side::new(&gpu, &settings, &scene).await?;
        let chosen = Side::new(&gpu, &settings, &scene).await?;
        Ok(Viewer {
            gpu,
            present,
            scene,
            reference,
            chosen,
            turns: Turns::default(),
            turns_of: None,
            #[cfg(feature = "webgl")]
            _pump: pump,
        })
    }

    /// The adapter and driver, as JSON.
    #[must_use]
    pub fn adapter(&self) -> String {
        serde_json::to_string(&self.gpu.adapter_stats()).unwrap_or_default()
    }

    /// Shows a generated scene; tells its figures and its camera as JSON. The old scene stays where
    /// it fails.
    ///
    /// # Errors
    /// A sentence: no such scene, or it does not fit.
    pub async fn generate(&mut self, name: String) -> Result<String, String> {
        let scene = scenes::generated(&name)?;
        self.show(scene).await
    }

    /// Shows a `.glb` or a `.gltf`; tells its figures and its camera as JSON. `beside` holds the
    /// files that it names, as far as they were given: a map of `ArrayBuffer`s by the way to them
    /// from its folder, or by their names alone. The old scene stays where it fails.
    ///
    /// # Errors
    /// A sentence that names the file, the place and the cause.
    pub async fn load(
        &mut self,
        name: String,
        bytes: Vec<u8>,
        beside: js_sys::Map,
    ) -> Result<String, String> {
        let scene = scenes::from_bytes(&name, &bytes, &Beside::new(&beside))?;
        drop((bytes, beside));
        self.show(scene).await
    }

    /// Takes over both sides' settings (JSON, the words of the program's TOML; sizes are the
    /// frame's own).
    ///
    /// # Errors
    /// A sentence that names the setting.
    pub fn set_settings(&mut self, reference: &str, chosen: &str) -> Result<(), String> {
        let read = |text: &str| {
            serde_json::from_str::<Settings>(text).map_err(|cause| {
                // Where in the JSON it stands tells the page's user nothing.
                let sentence = cause.to_string();
                let end = sentence.find(" at line ").unwrap_or(sentence.len());
                sentence[..end].to_owned()
            })
        };
        let (reference, chosen) = (read(reference)?, read(chosen)?);
        self.compare_anew();
        self.reference.request(reference);
        self.chosen.request(chosen);
        Ok(())
    }

    /// Draws one frame and presents it; tells what it cost as JSON.
    ///
    /// # Errors
    /// A sentence: settings that cannot be met, out of memory, the device was lost.
    pub async fn draw(&mut self, request: String) -> Result<String, String> {
        let request: FrameRequest =
            serde_json::from_str(&request).map_err(|cause| cause.to_string())?;
        let started_ms = crate::side::now_ms();
        let camera = request.camera.camera()?;
        let size = (request.width, request.height);
        let (mut reference, mut chosen) = (None, None);
        if !(self.turns_of.as_ref()).is_some_and(|shown| shown.shows_the_same(&request)) {
            self.compare_anew();
            self.turns_of = Some(request.clone());
        }
        let order = if self.turns.reference_first() {
            [0, 1]
        } else {
            [1, 0]
        };
        for side in order {
            if side == 0 && request.split > 0.0 {
                reference = Some(self.reference.draw(&self.scene, &camera, size).await?);
            } else if side == 1 && request.split < 1.0 {
                chosen = Some(self.chosen.draw(&self.scene, &camera, size).await?);
            }
        }
        if let (Some(reference), Some(chosen)) = (&reference, &chosen) {
            self.turns.add(times(reference), times(chosen));
        }
        let left = if reference.is_some() {
            &self.reference
        } else {
            &self.chosen
        };
        let right = if chosen.is_some() {
            &self.chosen
        } else {
            &self.reference
        };
        self.present
            .show(&self.gpu, left.picture(), right.picture(), request.split)?;
        let is_one_alone = reference.is_none() || chosen.is_none();
        let cost = Cost {
            reference: reference.map(|stats| CostOfSide::new(&self.reference, stats)),
            chosen: chosen.map(|stats| CostOfSide::new(&self.chosen, stats)),
            frame: self.turns.frame().map(Told::of),
            passes: self.turns.passes().map(Told::of),
            is_measured: is_one_alone || self.turns.is_done(),
            total_ms: crate::side::now_ms() - started_ms,
        };
        serde_json::to_string(&cost).map_err(|cause| cause.to_string())
    }

    /// The last picture of the chosen side, or of the reference: RGBA8 rows, sRGB-encoded, top to
    /// bottom.
    ///
    /// # Errors
    /// A sentence: the device was lost.
    pub async fn picture(&self, chosen: bool) -> Result<Vec<u8>, String> {
        let side = if chosen {
            &self.chosen
        } else {
            &self.reference
        };
        side.read_picture().await
    }

    /// Gives the device back, so that the page can be seen to survive its loss.
    pub fn lose_device(&self) {
        self.gpu.device.destroy();
    }
}

fn times(stats: &FrameStats) -> FrameTimes {
    FrameTimes {
        frame_ms: stats.frame_ms,
        passes_ms: stats.gpu_ms.iter().map(|pass| pass.ms).sum(),
    }
}

impl Viewer {
    /// Forgets all pairs.
    fn compare_anew(&mut self) {
        (self.turns, self.turns_of) = (Turns::default(), None);
    }

    async fn show(&mut self, scene: Scene) -> Result<String, String> {
        self.compare_anew();
        self.reference.set_scene(&scene).await?;
        if let Err(cause) = self.chosen.set_scene(&scene).await {
            // Both sides show the same scene, whatever happens.
            self.reference.set_scene(&self.scene).await?;
            return Err(cause);
        }
        let shown = Shown::of(&scene);
        self.scene = scene;
        serde_json::to_string(&shown).map_err(|cause| cause.to_string())
    }
}
