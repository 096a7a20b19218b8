//! A window on the renderer: fly through a scene, switch every setting, see what it costs.
//!
//! [`run`] opens it. The window draws itself on a device of its own and asks a thread for pictures
//! of the scene, so that it answers whatever a frame takes. Panels are made from the table of the
//! settings; files, flags and loading are the [`Host`]'s.
#![forbid(unsafe_code)]

mod app;
mod boxes;
mod clock;
mod command;
mod graphics;
mod history;
mod keys;
mod legend;
mod look;
mod navigator;
mod panels;
mod settled;
mod viewport;
mod window;
mod worker;

pub use keys::help as keys_help;
pub use settled::{Settled, Settler, Sight};

use std::path::Path;

use foveal::{RateImage, Settings};
use foveal_scene::{Camera, Scene};

/// A scene and where it is first seen from.
#[derive(Debug)]
pub struct Loaded {
    /// The scene, lit.
    pub scene: Scene,
    /// The first view.
    pub camera: Camera,
}

/// Loads the scene of this path or name.
pub type LoadScene = dyn Fn(&str) -> anyhow::Result<Loaded> + Send + Sync;

/// What the program that opens the window lends it.
pub struct Host {
    /// The first scene: a path or the name of a generated scene.
    pub scene: String,
    /// The names of the generated scenes.
    pub generated: Vec<String>,
    /// The first settings. Their size is the picture's until the picture follows the window's size.
    pub settings: Settings,
    /// Whether the picture follows the window's size.
    pub fit: bool,
    /// Part of the adapter's name; `None`: the most capable one.
    pub adapter: Option<String>,
    /// Size of the window in pixels.
    pub window: (u32, u32),
    /// Loads or generates a scene.
    pub load: Box<LoadScene>,
    /// Reads a settings file.
    pub read_settings: fn(&Path) -> anyhow::Result<Settings>,
    /// The picture that the settings name as the source of their rate map.
    pub rate_image: fn(&Settings) -> anyhow::Result<Option<RateImage>>,
    /// The flags that make these settings out of the defaults.
    pub flags: fn(&Settings) -> Vec<String>,
    /// A camera to the last bit, as `foveal render --exact-camera` takes it.
    pub exact_camera: fn(&Camera) -> String,
    /// A word as a shell takes it.
    pub quoted: fn(&str) -> String,
    /// The flags of `foveal render` that stand for what `load` adds to a scene, and for the
    /// adapter.
    pub scene_flags: Vec<String>,
}

impl std::fmt::Debug for Host {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Host").field("scene", &self.scene).finish()
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// Where there is no display or no graphics adapter that can draw to it.
pub fn run(host: Host) -> anyhow::Result<()> {
    window::run(host)
}
