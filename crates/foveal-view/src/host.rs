//! What the program that opens the window lends it: scenes, files, flags.

use std::path::{Path, PathBuf};

use foveal::{EnvironmentMap, RateImage, Settings};
use foveal_scene::{Camera, Clip, Scene};

/// A scene and where it is first seen from.
#[derive(Debug)]
pub struct Loaded {
    /// The scene with its own lights, posed at time 0.
    pub scene: Scene,
    /// The first view.
    pub camera: Camera,
    /// The animation that the scene plays.
    pub clip: Clip,
}

/// Loads the scene of this path or name.
pub type LoadScene = dyn Fn(&str) -> anyhow::Result<Loaded> + Send + Sync;

/// Lights a scene that is posed at time 0.
pub type LightScene = dyn Fn(&mut Scene) + Send + Sync;

/// Flags for the scene of this path or name.
pub type SceneFlags = dyn Fn(&str) -> Vec<String> + Send + Sync;

/// Starts a recording in pictures of `size` pixels, `per_second` of them.
pub type Record =
    dyn Fn(Format, (u32, u32), f32) -> anyhow::Result<Box<dyn Recording>> + Send + Sync;

/// The form in which a captured sequence is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// A folder of numbered PNG files.
    #[default]
    Pictures,
    /// A video file.
    Video,
}

/// A sequence of pictures on its way to files. Dropped before its end it is given up.
pub trait Recording: Send {
    /// Name of the file or folder that it becomes.
    fn name(&self) -> String;

    /// Whether what was added is kept where the recording is given up.
    fn keeps_parts(&self) -> bool;

    /// Adds a picture: sRGB RGBA8 rows, top to bottom, of the size that was agreed.
    ///
    /// # Errors
    /// What kept the picture from being written.
    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()>;

    /// Ends the recording.
    ///
    /// # Errors
    /// What kept the files from being finished.
    fn finish(self: Box<Self>) -> anyhow::Result<()>;
}

/// A folder's contents as the open dialog lists them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// Names of the folders within, sorted.
    pub folders: Vec<String>,
    /// Names of the scene files within, sorted.
    pub scenes: Vec<String>,
}

/// Folders, and the text that the window keeps from run to run.
pub trait Files: Send + Sync {
    /// The folder that the open dialog shows first.
    fn start(&self) -> PathBuf;

    /// What is in a folder.
    ///
    /// # Errors
    /// Why it cannot be read.
    fn list(&self, folder: &Path) -> anyhow::Result<Listing>;

    /// Whether a folder is there.
    fn is_folder(&self, path: &Path) -> bool;

    /// Whether the scene of this path or name is there.
    fn is_there(&self, scene: &str) -> bool;

    /// The one name of a scene: a generated scene's own, a file's absolute path.
    fn full_name(&self, scene: &str) -> String;

    /// Where the text that is remembered lies, as messages say it.
    fn memory(&self) -> String;

    /// The text that was remembered last; empty at first.
    ///
    /// # Errors
    /// Why it cannot be read.
    fn recall(&self) -> anyhow::Result<String>;

    /// Keeps a text in place of the last.
    ///
    /// # Errors
    /// Why it cannot be written.
    fn remember(&self, text: &str) -> anyhow::Result<()>;
}

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
    /// Adds the lights that a scene has besides its own. They may depend on its pose, so that it is
    /// called again when another animation plays.
    pub light: Box<LightScene>,
    /// Folders, and what is kept from run to run.
    pub files: Box<dyn Files>,
    /// Starts recordings.
    pub record: Box<Record>,
    /// Why videos cannot be recorded; `None` where they can.
    pub no_video: Option<String>,
    /// Reads a settings file, and whether it says how large the picture is.
    pub read_settings: fn(&Path) -> anyhow::Result<(Settings, bool)>,
    /// Writes a file whole or not at all.
    pub write_file: fn(&Path, &[u8]) -> anyhow::Result<()>,
    /// The picture that the settings name as the source of their rate map.
    pub rate_image: fn(&Settings) -> anyhow::Result<Option<RateImage>>,
    /// The environment that the settings name the file of.
    pub environment: fn(&Settings) -> anyhow::Result<Option<EnvironmentMap>>,
    /// The flags that make these settings out of the defaults.
    pub flags: fn(&Settings) -> Vec<String>,
    /// A camera to the last bit, as `foveal render --exact-camera` takes it.
    pub exact_camera: fn(&Camera) -> String,
    /// The camera that such a text stands for; `None` where it stands for none.
    pub read_camera: fn(&str) -> Option<Camera>,
    /// A word as a shell takes it.
    pub quoted: fn(&str) -> String,
    /// The flags of `foveal render` that stand for what `load` makes of a scene, the clip aside,
    /// and for the adapter.
    pub scene_flags: Box<SceneFlags>,
}

impl std::fmt::Debug for Host {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Host").field("scene", &self.scene).finish()
    }
}
