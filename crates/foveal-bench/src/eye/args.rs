//! Arguments of `foveal bench eye`.

use foveal_host::values;

use super::screen::{self, Fit, Screen};
use crate::shared::SharedArgs;
use crate::subject::SubjectArgs;

/// Where the eye looks in the second picture of each way.
pub(super) const OFF_GAZE: [f32; 2] = [0.25, 0.6];

/// Arguments of `foveal bench eye`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub(super) subject: SubjectArgs,

    #[command(flatten)]
    pub(super) shared: SharedArgs,

    /// Displays, by name [default: all]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = screen::named)]
    pub(super) display: Vec<Screen>,

    /// Largest width and height in pixels; of a larger display its centre is drawn, at the
    /// display's own pixels per degree. `whole`: all pixels of each display [default: 640x360; with
    /// --quick 480x270]
    #[arg(long, value_name = "WxH|whole", value_parser = screen::fit)]
    size: Option<Fit>,

    /// Number of coloured point lights to add to the scene
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::point_lights)]
    pub(super) point_lights: u32,

    /// Timed frames of each way, after eight that warm up. Below 10 there is no verdict; 0: no
    /// times [default: 20; with --quick 10]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=200))]
    rounds: Option<u32>,

    /// Frames of the video along --path, which is the demo scene's own path there and `sway`
    /// elsewhere; 0: no video [default: 16; with --quick 6]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: Option<u32>,

    /// Frames of the video per second, 5 to 1000
    #[arg(long, value_name = "N", value_parser = values::metric_rate, default_value_t = 30.0)]
    pub(super) fps: f32,

    /// Smaller pictures, fewer frames
    #[arg(long)]
    quick: bool,
}

impl Args {
    pub(super) fn fit(&self) -> Fit {
        let (width, height) = if self.quick { (480, 270) } else { (640, 360) };
        self.size.unwrap_or(Fit::Within { width, height })
    }

    pub(super) fn rounds(&self) -> u32 {
        self.rounds.unwrap_or(if self.quick { 10 } else { 20 })
    }

    pub(super) fn frames(&self) -> u32 {
        self.frames.unwrap_or(if self.quick { 6 } else { 16 })
    }
}
