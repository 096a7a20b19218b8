//! The thread that loads and draws, so that the window answers while a frame takes its time.
//!
//! It has its own device: whatever happens to it, the window stays, says what happened, and a new
//! device is opened. Only the newest request counts; a request that is settled is drawn a few
//! times, until what adapts from frame to frame has adapted. With a reference both sides are drawn
//! in turn until they can be told apart, or have been drawn often enough to say that they cannot.

mod drawing;
mod inbox;
mod judge;
mod measuring;
#[cfg(test)]
mod tests;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use foveal::{AdapterStats, CullingStats, Error, FrameStats, SceneStats, Settings, Visibility};
use foveal_scene::{Aabb, Camera};

use crate::Host;
use drawing::Drawing;
use inbox::{Inbox, Order};
use judge::Judge;
pub(crate) use judge::Quality;
pub(crate) use measuring::Compared;

/// How often a settled request is drawn.
pub(crate) const SETTLING_FRAMES: u32 = 9;

/// What shall be drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Request {
    pub(crate) settings: Settings,
    /// Drawn beside it for comparison.
    pub(crate) reference: Option<Settings>,
    pub(crate) camera: Camera,
    /// Whether to draw what culling last found, whatever the camera sees.
    pub(crate) frozen: bool,
    /// Whether boxes are wanted with the picture.
    pub(crate) boxes: bool,
    /// Whether the culler's depth is wanted with the picture.
    pub(crate) depth: bool,
    /// The moment of an animated scene, in seconds.
    pub(crate) time_s: f32,
    /// Whether to draw on without a change.
    pub(crate) always: bool,
}

impl Request {
    /// Whether both ask for the same pictures.
    pub(crate) fn shows_the_same(&self, other: &Self) -> bool {
        (&self.settings, &self.reference, &self.camera)
            == (&other.settings, &other.reference, &other.camera)
            && self.time_s == other.time_s
    }
}

/// sRGB RGBA8 rows, top to bottom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rgba {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) bytes: Vec<u8>,
}

/// The culler's depth: near / distance, 0 where nothing is proven.
#[derive(Clone, Debug)]
pub(crate) struct OccluderDepth {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) near_over_distance: Vec<f32>,
}

/// A frame that was drawn.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    pub(crate) picture: Rgba,
    pub(crate) stats: FrameStats,
    pub(crate) camera: Camera,
    pub(crate) reference: Option<(Rgba, FrameStats)>,
    /// What both sides took, drawn in turn.
    pub(crate) compared: Option<Compared>,
    /// Mean FLIP error against the reference, once the view stands still.
    pub(crate) flip: Option<f32>,
    pub(crate) culling: Option<CullingStats>,
    pub(crate) boxes: Vec<(Aabb, Visibility)>,
    pub(crate) depth: Option<OccluderDepth>,
}

/// A scene that was loaded.
#[derive(Clone, Debug)]
pub(crate) struct LoadedScene {
    pub(crate) name: String,
    /// The path or name that it was opened by.
    pub(crate) source: String,
    pub(crate) counts: SceneStats,
    pub(crate) start: Camera,
    pub(crate) cameras: Vec<Camera>,
    pub(crate) bounds: Aabb,
    pub(crate) is_animated: bool,
    pub(crate) warnings: usize,
}

/// What the thread tells the window.
#[derive(Debug)]
pub(crate) enum News {
    Adapter(AdapterStats),
    Scene(Box<LoadedScene>),
    Picture(Box<Shown>),
    /// How visible the difference of two sides is that were drawn before.
    Quality(Box<Quality>),
    Failed(String),
}

/// The window's end.
pub(crate) struct Worker {
    inbox: Arc<Inbox>,
    news: Receiver<News>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread; it calls `wake` when there is news.
    pub(crate) fn start(
        host: Arc<Host>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let inbox = Arc::new(Inbox::default());
        let (sender, news) = channel();
        let theirs = Arc::clone(&inbox);
        let wake = Arc::new(Mutex::new(wake));
        let tell = Teller { sender, wake };
        let judged = tell.clone();
        let judge = Judge::start(move |quality| judged.tell(News::Quality(Box::new(quality))))?;
        let thread = std::thread::Builder::new()
            .name("draw".to_owned())
            // Debug builds decode deep files with large frames.
            .stack_size(16 << 20)
            .spawn(move || {
                work(&host, &theirs, &judge, &tell);
            })?;
        Ok(Self {
            inbox,
            news,
            thread: Some(thread),
        })
    }

    pub(crate) fn load(&self, scene: String) {
        self.inbox.load(scene);
    }

    pub(crate) fn draw(&self, request: Request) {
        self.inbox.draw(request);
    }

    /// Has the device lost, as a driver does that starts anew: to see that work goes on.
    pub(crate) fn lose_device(&self) {
        self.inbox.lose_device();
    }

    pub(crate) fn news(&self) -> impl Iterator<Item = News> + '_ {
        self.news.try_iter()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.inbox.quit();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Teller<W> {
    sender: Sender<News>,
    wake: Arc<Mutex<W>>,
}

impl<W> Clone for Teller<W> {
    fn clone(&self) -> Self {
        Self {
            sender: self.sender.clone(),
            wake: Arc::clone(&self.wake),
        }
    }
}

impl<W: Fn()> Teller<W> {
    fn tell(&self, news: News) {
        if self.sender.send(news).is_ok() {
            (self.wake.lock().unwrap_or_else(PoisonError::into_inner))();
        }
    }

    fn fail(&self, error: &anyhow::Error) {
        self.tell(News::Failed(format!("{error:#}")));
    }
}

fn work<W: Fn()>(host: &Host, inbox: &Inbox, judge: &Judge, tell: &Teller<W>) {
    let mut drawing = Drawing::default();
    let mut settled = 0;
    let mut is_second_try = false;
    let mut wanted: Option<Request> = None;
    loop {
        let idle = wanted.as_ref().is_none_or(|request| {
            settled >= SETTLING_FRAMES && !request.always && drawing.is_measured()
        });
        match inbox.next(idle) {
            Order::Quit => return,
            Order::Load(name) => {
                settled = 0;
                let loaded = drawing
                    .open(host)
                    .map(|adapter| {
                        adapter
                            .into_iter()
                            .for_each(|a| tell.tell(News::Adapter(a)))
                    })
                    .and_then(|()| drawing.load(host, &name));
                match loaded {
                    Ok(scene) => {
                        // A view of the old scene is no longer wanted.
                        wanted = None;
                        tell.tell(News::Scene(Box::new(scene)));
                    }
                    Err(error) => tell.fail(&error),
                }
                continue;
            }
            Order::Draw(request) => {
                settled = 0;
                wanted = Some(*request);
            }
            Order::LoseDevice => {
                drawing.lose_device();
                settled = 0;
            }
            Order::Nothing => {}
        }
        let Some(request) = &wanted else { continue };
        match drawing.draw(host, request, settled) {
            Ok(Some(shown)) => {
                if let (true, Some((reference, _))) = (shown.flip.is_some(), &shown.reference) {
                    judge.judge(request, reference, &shown.picture);
                }
                tell.tell(News::Picture(Box::new(shown)));
            }
            Ok(None) => {}
            Err(error) => {
                tell.fail(&error);
                drawing.give_up_device();
                // A lost device is no fault of the request: once more, on a new one. All else not
                // again until something changes.
                let was_lost = matches!(error.downcast_ref(), Some(Error::DeviceLost { .. }));
                if !was_lost || std::mem::replace(&mut is_second_try, true) {
                    wanted = None;
                }
                settled = 0;
                continue;
            }
        }
        is_second_try = false;
        settled += 1;
    }
}
