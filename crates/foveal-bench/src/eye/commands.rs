//! The commands that make a row's figures again, but for times, which only the bench itself can
//! take.

use foveal::Settings;
use foveal_host::command_line::quoted;
use foveal_vdp::Display;
use serde::Serialize;

use super::args::{Args, OFF_GAZE};
use super::screen::Shown;
use super::ways::Way;
use foveal_host::camera::CameraArgs;
use foveal_host::settings::flags;

/// How a row's pictures and videos are drawn and compared.
#[derive(Debug, Serialize)]
pub(super) struct MadeBy {
    /// Full shading, this way, and the comparison of both.
    picture: [String; 3],
    off: [String; 3],
    /// The same after the folders of both are made.
    video: Option<[String; 4]>,
}

/// What all rows' commands share.
pub(super) struct Commands {
    /// Scene, lights, how it is read, adapter.
    scene: Vec<String>,
    camera: Vec<String>,
    path: Vec<String>,
    frames: u32,
    fps: f32,
}

impl Commands {
    pub(super) fn new(args: &Args, path: &CameraArgs) -> Self {
        let mut scene = vec![args.subject.scene.clone()];
        if args.point_lights > 0 {
            scene.extend(["--point-lights".to_owned(), args.point_lights.to_string()]);
        }
        scene.extend(args.subject.import.flags());
        scene.extend(args.subject.figures.adapter_flags());
        Self {
            scene,
            camera: args.subject.camera.flags(),
            path: path.flags(),
            frames: args.frames(),
            fps: args.fps,
        }
    }

    /// The commands of one row: full shading, this way, and this way with the gaze off the centre.
    pub(super) fn of(
        &self,
        shown: &Shown,
        way: &Way,
        [full, chosen, off]: [&Settings; 3],
    ) -> MadeBy {
        let still = |file: &str, settings: &Settings, warmup: u32| {
            let mut words = vec!["--output".to_owned(), file.to_owned()];
            words.extend(self.camera.iter().cloned());
            if warmup > 0 {
                words.extend(["--warmup".to_owned(), warmup.to_string()]);
            }
            self.render(words, settings)
        };
        let moving = |folder: &str, settings: &Settings| {
            let mut words = vec!["--output".to_owned(), format!("{folder}/f_####.png")];
            words.extend(self.path.iter().cloned());
            words.extend(["--frames".to_owned(), self.frames.to_string()]);
            words.extend(["--fps".to_owned(), self.fps.to_string()]);
            self.render(words, settings)
        };
        let center = Settings::default().eye.gaze;
        MadeBy {
            picture: [
                still("full.png", full, 0),
                still("this.png", chosen, way.warmup),
                compare("full.png this.png", shown, center, ""),
            ],
            off: [
                still("full.png", full, 0),
                still("off.png", off, way.warmup),
                compare("full.png off.png", shown, OFF_GAZE, ""),
            ],
            video: (self.frames > 0).then(|| {
                let fps = format!(" --fps {}", self.fps);
                [
                    "mkdir -p full this".to_owned(),
                    moving("full", full),
                    moving("this", chosen),
                    compare("full this", shown, center, &fps),
                ]
            }),
        }
    }

    fn render(&self, words: Vec<String>, settings: &Settings) -> String {
        let words = self.scene.iter().chain(&words).map(|word| quoted(word));
        let flags = flags(settings);
        let words = words.chain(flags.iter().map(|word| quoted(word)));
        format!("foveal render {}", words.collect::<Vec<String>>().join(" "))
    }
}

/// The comparison at the display, whose light is named where its part alone would not have it.
fn compare(what: &str, shown: &Shown, [x, y]: [f32; 2], more: &str) -> String {
    let base = Display::parse(&shown.spelled).unwrap_or(Display::DEGREES_60);
    let mut light = String::new();
    if base.peak != shown.display.peak {
        light += &format!(" --peak {}", shown.display.peak);
    }
    if base.ambient_lux != shown.display.ambient_lux {
        light += &format!(" --ambient {}", shown.display.ambient_lux);
    }
    format!(
        "foveal compare {what} --display {}{light} --gaze {x},{y}{more}",
        shown.spelled
    )
}
