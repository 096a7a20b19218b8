//! What the window shows of a view that stands still, without a window: by the thread that draws
//! for it.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use anyhow::{Context, bail};
use foveal::Settings;
use foveal_scene::{Camera, Clip};

use crate::worker::{LoadedScene, News, Request, SETTLING_FRAMES, Worker};
use crate::{Host, command};

/// How long a picture may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// What the window is turned to.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The settings, the picture's size among them.
    pub settings: Settings,
    /// Where it is seen from; `None`: from where the scene is seen first.
    pub camera: Option<Camera>,
    /// The moment of an animated scene, in seconds.
    pub time_s: f32,
    /// The animation that plays; `None`: the one that plays first.
    pub clip: Option<Clip>,
}

/// The picture on which the window settles.
#[derive(Clone, Debug)]
pub struct Settled {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// sRGB RGBA8 rows, top to bottom.
    pub rgba: Vec<u8>,
    /// The command that *Copy command* copies, word by word.
    pub command: Vec<String>,
}

/// The window's drawing thread with a scene.
pub struct Settler {
    host: Arc<Host>,
    worker: Worker,
    woken: Receiver<()>,
    scene: LoadedScene,
}

impl std::fmt::Debug for Settler {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Settler")
            .field("scene", &self.scene)
            .finish()
    }
}

impl Settler {
    /// Opens the host's scene.
    ///
    /// # Errors
    /// Where the scene cannot be loaded, or there is no graphics adapter.
    pub fn open(host: Host) -> anyhow::Result<Self> {
        let (wake, woken) = channel();
        let host = Arc::new(host);
        let worker = Worker::start(Arc::clone(&host), move || {
            let _ = wake.send(());
        })?;
        worker.load(host.scene.clone());
        let scene = wait(&worker, &woken, |news| match news {
            News::Scene(scene) => Some(*scene),
            _ => None,
        })?;
        Ok(Self {
            host,
            worker,
            woken,
            scene,
        })
    }

    /// Where the scene is seen from first.
    #[must_use]
    pub fn start(&self) -> &Camera {
        &self.scene.start
    }

    /// Draws until the view has settled.
    ///
    /// # Errors
    /// What the window would complain about.
    pub fn settle(&self, sight: &Sight) -> anyhow::Result<Settled> {
        let camera = sight.camera.as_ref().unwrap_or(&self.scene.start);
        let clip = sight.clip.as_ref().unwrap_or(&self.scene.clip);
        self.worker.draw(Request {
            settings: sight.settings.clone(),
            reference: None,
            camera: camera.clone(),
            frozen: false,
            boxes: false,
            depth: false,
            time_s: sight.time_s,
            clip: clip.clone(),
            always: false,
        });
        let mut frames = 0;
        let shown = wait(&self.worker, &self.woken, |news| match news {
            News::Picture(shown) => {
                frames += 1;
                (frames == SETTLING_FRAMES).then_some(shown)
            }
            _ => None,
        })?;
        Ok(Settled {
            width: shown.picture.width,
            height: shown.picture.height,
            rgba: shown.picture.bytes,
            command: command::words(
                &self.host,
                &self.scene,
                &sight.settings,
                camera,
                (clip, sight.time_s),
            ),
        })
    }
}

/// The first news that `wanted` takes.
fn wait<T>(
    worker: &Worker,
    woken: &Receiver<()>,
    mut wanted: impl FnMut(News) -> Option<T>,
) -> anyhow::Result<T> {
    loop {
        for news in worker.news() {
            if let News::Failed(cause) | News::LoadFailed(_, cause) = news {
                bail!(cause);
            }
            if let Some(found) = wanted(news) {
                return Ok(found);
            }
        }
        woken
            .recv_timeout(PATIENCE)
            .context("the drawing thread gave no picture")?;
    }
}
