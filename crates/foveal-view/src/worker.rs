//! The thread that loads and draws, so that the window answers while a frame takes its time.
//!
//! It has its own device: whatever happens to it, the window stays, says what happened, and a new
//! device is opened. Only the newest request counts; a request that is settled is drawn a few
//! times, until what adapts from frame to frame has adapted. With a reference both sides are drawn
//! in turn until they can be told apart, or have been drawn often enough to say that they cannot.

mod capturing;
mod drawing;
mod inbox;
mod judge;
mod measuring;
#[cfg(test)]
mod tests;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use foveal::{AdapterStats, CullingStats, Error, FrameStats, SceneStats, Settings, Visibility};
use foveal_scene::{Aabb, Camera, Clip};

use crate::Host;
use crate::capture::{Ended, Job};
use crate::needs::Abilities;
use crate::pick::{Picked, Ray};
use capturing::Capturing;
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
    /// Which of its animations plays.
    pub(crate) clip: Clip,
    /// Whether to draw on without a change.
    pub(crate) always: bool,
}

impl Request {
    /// Whether both ask for the same pictures.
    pub(crate) fn shows_the_same(&self, other: &Self) -> bool {
        self.has_the_sides_of(other) && (self.time_s, &self.clip) == (other.time_s, &other.clip)
    }

    /// Whether both ask for the same two sides from the same place, at whatever moment. Where
    /// culling is frozen, one side draws what it found elsewhere, and finds nothing.
    pub(crate) fn has_the_sides_of(&self, other: &Self) -> bool {
        (&self.settings, &self.reference, &self.camera, self.frozen)
            == (
                &other.settings,
                &other.reference,
                &other.camera,
                other.frozen,
            )
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
    /// What it was drawn for.
    pub(crate) request: Request,
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
    /// Names of its animations, as the file has them, and their lengths in seconds.
    pub(crate) clips: Vec<(String, f32)>,
    /// The one that plays at first.
    pub(crate) clip: Clip,
    pub(crate) warnings: usize,
}

impl LoadedScene {
    /// Length of a clip in seconds; 0 for what does not move.
    pub(crate) fn duration_s(&self, clip: &Clip) -> f32 {
        let longest = || self.clips.iter().map(|c| c.1).fold(0.0, f32::max);
        match clip {
            Clip::Number(number) => self.clips.get(*number as usize).map_or(0.0, |c| c.1),
            Clip::Named(name) => {
                let named = self.clips.iter().find(|c| c.0 == *name);
                named.map_or(0.0, |c| c.1)
            }
            Clip::All => longest(),
        }
    }
}

/// What the thread tells the window.
#[derive(Debug)]
pub(crate) enum News {
    Adapter(AdapterStats, Abilities),
    /// What is under the pointer.
    Picked(Option<Picked>),
    /// How many pictures of a capture are written, and of how many.
    Captured(usize, usize),
    CaptureEnded(Ended),
    Scene(Box<LoadedScene>),
    Picture(Box<Shown>),
    /// How visible the difference of two sides is that were drawn before.
    Quality(Box<Quality>),
    Failed(String),
    /// The scene, and why it could not be loaded.
    LoadFailed(String, String),
}

/// The window's end.
pub(crate) struct Worker {
    inbox: Arc<Inbox>,
    news: Receiver<News>,
    thread: Option<std::thread::JoinHandle<()>>,
    #[cfg(test)]
    imagined: Sender<News>,
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
        #[cfg(test)]
        let imagined = sender.clone();
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
            #[cfg(test)]
            imagined,
        })
    }

    /// Without a thread: news are imagined.
    #[cfg(test)]
    pub(crate) fn idle() -> Self {
        let (sender, news) = channel();
        Self {
            inbox: Arc::default(),
            news,
            thread: None,
            imagined: sender,
        }
    }

    #[cfg(test)]
    pub(crate) fn imagine(&self, news: News) {
        self.imagined.send(news).unwrap();
    }

    /// Takes the orders that wait, by name, in the order in which the thread would.
    #[cfg(test)]
    pub(crate) fn ordered(&self) -> Vec<&'static str> {
        let next = || match self.inbox.next(false) {
            Order::Load(_) => Some("load"),
            Order::Draw(_) => Some("draw"),
            Order::Pick(_) => Some("pick"),
            Order::Capture(_) => Some("capture"),
            Order::CancelCapture => Some("cancel"),
            Order::LoseDevice => Some("lose"),
            Order::Quit | Order::Nothing => None,
        };
        std::iter::from_fn(next).collect()
    }

    pub(crate) fn load(&self, scene: String) {
        self.inbox.load(scene);
    }

    pub(crate) fn draw(&self, request: Request) {
        self.inbox.draw(request);
    }

    /// Asks which object a ray meets.
    pub(crate) fn pick(&self, ray: Ray) {
        self.inbox.pick(ray);
    }

    /// Starts a capture; other pictures wait for its end.
    pub(crate) fn capture(&self, job: Job) {
        self.inbox.capture(job);
    }

    /// Gives the capture up that runs.
    pub(crate) fn cancel_capture(&self) {
        self.inbox.cancel_capture();
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
    let mut capturing: Option<Capturing> = None;
    loop {
        let is_settled = wanted.as_ref().is_none_or(|request| {
            settled >= SETTLING_FRAMES && !request.always && drawing.is_measured()
        });
        let idle = is_settled && capturing.is_none();
        match inbox.next(idle) {
            Order::Quit => return,
            Order::Load(name) => {
                settled = 0;
                if let Some(capturing) = capturing.take() {
                    tell.tell(News::CaptureEnded(capturing.cancelled()));
                }
                let loaded = drawing
                    .open(host)
                    .map(|adapter| {
                        adapter
                            .into_iter()
                            .for_each(|(a, can)| tell.tell(News::Adapter(a, can)))
                    })
                    .and_then(|()| drawing.load(host, &name));
                match loaded {
                    Ok(scene) => {
                        // A view of the old scene is no longer wanted.
                        wanted = None;
                        tell.tell(News::Scene(Box::new(scene)));
                    }
                    Err(error) => tell.tell(News::LoadFailed(name, format!("{error:#}"))),
                }
                continue;
            }
            Order::Draw(request) => {
                settled = 0;
                wanted = Some(*request);
            }
            Order::Pick(ray) => {
                tell.tell(News::Picked(drawing.pick(ray)));
                continue;
            }
            Order::Capture(job) => match Capturing::start(host, *job) {
                Ok(started) => capturing = Some(started),
                Err(error) => tell.tell(News::CaptureEnded(Ended::Failed(format!("{error:#}")))),
            },
            Order::CancelCapture => {
                let ended = match capturing.take() {
                    Some(capturing) => capturing.cancelled(),
                    None => Ended::Cancelled("Capture cancelled before its first frame".to_owned()),
                };
                tell.tell(News::CaptureEnded(ended));
                settled = 0;
                continue;
            }
            Order::LoseDevice => {
                drawing.lose_device();
                settled = 0;
            }
            Order::Nothing => {}
        }
        if let Some(mut running) = capturing.take() {
            match running.step(host, &mut drawing) {
                Ok(shown) => {
                    tell.tell(News::Captured(running.written(), running.of()));
                    if let Some(shown) = shown {
                        tell.tell(News::Picture(Box::new(shown)));
                    }
                    if running.is_done() {
                        tell.tell(News::CaptureEnded(running.finished()));
                        settled = 0;
                    } else {
                        capturing = Some(running);
                    }
                }
                Err(error) => {
                    tell.tell(News::CaptureEnded(running.failed(&error)));
                    drawing.give_up(&error);
                    settled = 0;
                }
            }
            continue;
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
                drawing.give_up(&error);
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
