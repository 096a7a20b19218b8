//! What the window knows, and what becomes of input: from the hands to the next request for a
//! picture.

mod capturing;
pub(crate) mod drops;
mod files;
mod hands;
#[cfg(test)]
mod news_tests;
#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use egui::{TextureHandle, TextureOptions};
use foveal::{AdapterStats, Settings};
use foveal_scene::{Camera, Clip};
use toml::Table;

use crate::Host;
use crate::browser::Browser;
use crate::history::History;
use crate::memory::Memory;
use crate::navigator::Navigator;
use crate::needs::{self, Abilities};
use crate::pick::Picked;
use crate::worker::{LoadedScene, News, Quality, Request, Rgba, Shown, Worker};
use crate::{panels, viewport};

pub(crate) use crate::capture::Ended;
pub(crate) use capturing::{Capture, Phase, Way};

/// A line that tells the user something for a while, or until it is dismissed.
#[derive(Debug)]
pub(crate) struct Message {
    pub(crate) text: String,
    pub(crate) is_error: bool,
    /// Seconds on the interface's clock after which it goes.
    pub(crate) until_s: f64,
}

/// How the picture is shown, besides what the settings say.
#[derive(Debug)]
pub(crate) struct Display {
    /// The picture has the size of its place in the window.
    pub(crate) fit: bool,
    /// Size of the picture against its place.
    pub(crate) scale: f32,
    pub(crate) always: bool,
    pub(crate) gaze_follows: bool,
    pub(crate) boxes: bool,
    pub(crate) depth: bool,
    pub(crate) frozen: bool,
    pub(crate) compare: bool,
    /// Where the reference ends, as a fraction of the picture's width.
    pub(crate) split: f32,
    pub(crate) panels: bool,
    /// Whether the list of keys is shown.
    pub(crate) keys: bool,
    /// Whether the interface waits for the screen.
    pub(crate) vsync: bool,
    pub(crate) playing: bool,
    pub(crate) time_s: f32,
    /// Which animation plays.
    pub(crate) clip: Clip,
}

/// Everything behind the window.
pub(crate) struct App {
    pub(crate) host: Arc<Host>,
    worker: Worker,
    /// The settings as the panels hold them; may be wrong for a moment.
    pub(crate) draft: Table,
    /// The last ones that made sense.
    pub(crate) settings: Settings,
    /// What is wrong with the draft.
    pub(crate) wrong: Option<String>,
    /// What the split slider shows on the left.
    pub(crate) reference: Settings,
    pub(crate) display: Display,
    pub(crate) navigator: Option<Navigator>,
    pub(crate) bookmarks: [Option<Camera>; 9],
    pub(crate) memory: Memory,
    /// The open dialog.
    pub(crate) browser: Option<Browser>,
    pub(crate) selected: Option<Picked>,
    pub(crate) capture: Capture,
    pub(crate) scene: Option<LoadedScene>,
    pub(crate) scene_name: String,
    /// The scene that is being opened. Until it is there, nothing is asked for: it would be asked
    /// of a scene that goes.
    pub(crate) opening: Option<String>,
    pub(crate) adapter: Option<AdapterStats>,
    pub(crate) abilities: Abilities,
    pub(crate) shown: Option<Box<Shown>>,
    /// Of the view and the settings that are asked for.
    pub(crate) quality: Option<Box<Quality>>,
    pub(crate) picture: Option<TextureHandle>,
    pub(crate) reference_picture: Option<TextureHandle>,
    pub(crate) depth_picture: Option<TextureHandle>,
    pub(crate) history: History,
    pub(crate) messages: Vec<Message>,
    pub(crate) settings_file: String,
    /// Size of the picture's place, in pixels.
    pub(crate) place: (u32, u32),
    asked: Option<Request>,
    /// Whether the window's device shall be lost after this frame.
    pub(crate) loses_devices: bool,
}

impl App {
    pub(crate) fn new(host: Host, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let host = Arc::new(host);
        let worker = Worker::start(Arc::clone(&host), wake)?;
        worker.load(host.scene.clone());
        Ok(Self::with(host, worker))
    }

    fn with(host: Arc<Host>, worker: Worker) -> Self {
        let settings = host.settings.clone();
        let mut this = Self {
            worker,
            draft: Table::try_from(&settings).unwrap_or_default(),
            wrong: None,
            reference: Settings::default(),
            display: Display {
                fit: host.fit,
                scale: 1.0,
                always: false,
                gaze_follows: false,
                boxes: false,
                depth: false,
                frozen: false,
                compare: false,
                split: 0.5,
                panels: true,
                keys: false,
                vsync: true,
                playing: false,
                time_s: 0.0,
                clip: Clip::default(),
            },
            navigator: None,
            bookmarks: Default::default(),
            memory: Memory::default(),
            browser: None,
            selected: None,
            capture: Capture::default(),
            scene: None,
            scene_name: host.scene.clone(),
            opening: Some(host.scene.clone()),
            adapter: None,
            abilities: Abilities::default(),
            shown: None,
            quality: None,
            picture: None,
            reference_picture: None,
            depth_picture: None,
            history: History::default(),
            messages: Vec::new(),
            settings_file: "foveal.toml".to_owned(),
            place: (0, 0),
            asked: None,
            loses_devices: false,
            settings,
            host,
        };
        match Memory::recalled(this.host.files.as_ref()) {
            Ok(memory) => this.memory = memory,
            Err(error) => this.complain(format!("{error:#}")),
        }
        this
    }

    /// One pass of the interface.
    pub(crate) fn show(&mut self, ui: &mut egui::Ui) {
        self.take_news(ui.ctx());
        self.take_drops(ui.ctx());
        self.take_keys(ui.ctx());
        panels::show(self, ui);
        viewport::show(self, ui);
        self.note_flight(ui.ctx());
        self.take_settings();
        self.ask();
        self.forget_messages(ui.ctx());
    }

    /// Loads another scene in place of this one.
    pub(crate) fn open_scene(&mut self, name: String) {
        // Its poses belong to the scene that goes.
        self.cancel_capture();
        self.asked = None;
        self.worker.load(name.clone());
        self.opening = Some(name.clone());
        self.scene_name = name;
    }

    /// Changes what is remembered from run to run.
    pub(crate) fn remember(&mut self, change: impl FnOnce(&mut Memory)) {
        if let Err(error) = self.memory.change(self.host.files.as_ref(), change) {
            self.complain(format!("{error:#}"));
        }
    }

    pub(crate) fn say(&mut self, context: &egui::Context, text: impl Into<String>) {
        self.messages.push(Message {
            text: printable_lines(&text.into()),
            is_error: false,
            until_s: context.input(|i| i.time) + 5.0,
        });
    }

    pub(crate) fn complain(&mut self, text: impl Into<String>) {
        let text = printable_lines(&text.into());
        self.messages.retain(|message| message.text != text);
        self.messages.push(Message {
            text,
            is_error: true,
            until_s: f64::INFINITY,
        });
    }

    fn forget_messages(&mut self, context: &egui::Context) {
        let now = context.input(|i| i.time);
        self.messages.retain(|message| message.until_s > now);
        if let Some(first) = self
            .messages
            .iter()
            .map(|m| m.until_s)
            .min_by(f64::total_cmp)
            && first.is_finite()
        {
            context.request_repaint_after_secs((first - now) as f32);
        }
    }

    fn take_news(&mut self, context: &egui::Context) {
        let news: Vec<News> = self.worker.news().collect();
        for news in news {
            match news {
                News::Picked(picked) => self.selected = picked,
                News::Captured(written, of) => self.capture.phase = Phase::Drawing(written, of),
                News::CaptureEnded(ended) => self.take_capture_end(context, ended),
                News::Adapter(adapter, abilities) => {
                    self.abilities = abilities;
                    // Half the pixels a side where the processor draws.
                    if self.adapter.is_none() && adapter.kind == "cpu" {
                        self.display.scale = 0.5;
                    }
                    self.adapter = Some(adapter);
                }
                News::Scene(scene) => self.take_scene(context, *scene),
                News::Picture(shown) => self.take_picture(context, shown),
                News::Quality(quality) => {
                    let is_wanted = |asked: &Request| asked.shows_the_same(&quality.request);
                    if self.asked.as_ref().is_some_and(is_wanted) {
                        self.quality = Some(quality);
                    }
                }
                News::LoadFailed(scene, cause) => {
                    // What was typed stays, to be mended.
                    self.has_opened(&scene);
                    self.complain(cause);
                }
                News::Failed(cause) => self.complain(cause),
            }
        }
    }

    /// Notes that a scene was loaded, or could not be; another may have been asked for since.
    fn has_opened(&mut self, scene: &str) {
        self.opening.take_if(|opening| opening == scene);
    }

    fn take_scene(&mut self, context: &egui::Context, scene: LoadedScene) {
        self.has_opened(&scene.source);
        self.navigator = Some(Navigator::new(scene.start.clone(), scene.bounds));
        self.selected = None;
        self.display.clip = scene.clip.clone();
        self.display.playing = scene.duration_s(&scene.clip) > 0.0;
        self.display.time_s = 0.0;
        self.asked = None;
        self.history.clear();
        if scene.warnings > 0 {
            let (many, them) = if scene.warnings == 1 {
                ("", "it")
            } else {
                ("s", "them")
            };
            let text = format!(
                "{}: {} warning{many}; 'foveal scene info' lists {them}",
                scene.name, scene.warnings
            );
            self.say(context, text);
        }
        let name = self.host.files.full_name(&scene.source);
        self.remember(|memory| memory.opened(&name));
        self.bookmarks = Default::default();
        for (number, text) in self.memory.bookmarks(&name) {
            let slot = self.bookmarks.get_mut(usize::from(number) - 1);
            if let (Some(slot), Some(camera)) = (slot, (self.host.read_camera)(text)) {
                *slot = Some(Camera {
                    name: format!("bookmark {number}"),
                    ..camera
                });
            }
        }
        self.scene = Some(scene);
    }

    fn take_picture(&mut self, context: &egui::Context, mut shown: Box<Shown>) {
        self.history.push(shown.stats.frame_ms);
        // The figure stays until the next one: it is measured on some frames only.
        if shown.flip.is_none()
            && let Some(before) = &self.shown
            && before.request.has_the_sides_of(&shown.request)
        {
            shown.flip = before.flip;
        }
        self.shown = Some(shown);
        self.load_textures(context);
    }

    /// Moves to a context that has none of the textures yet, and a clock of its own.
    pub(crate) fn move_to(&mut self, context: &egui::Context, from: &egui::Context) {
        let clock = |context: &egui::Context| context.input(|i| i.time);
        let later_s = clock(context) - clock(from);
        for message in &mut self.messages {
            message.until_s += later_s;
        }
        if let Phase::Flying(since_s, _) = &mut self.capture.phase {
            *since_s += later_s;
        }
        self.picture = None;
        self.reference_picture = None;
        self.depth_picture = None;
        self.load_textures(context);
    }

    /// Makes textures of what is shown.
    pub(crate) fn load_textures(&mut self, context: &egui::Context) {
        let Some(shown) = &self.shown else { return };
        let load =
            |slot: &mut Option<TextureHandle>, name: &str, image: egui::ColorImage| match slot {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => *slot = Some(context.load_texture(name, image, TextureOptions::LINEAR)),
            };
        let image = |picture: &Rgba| {
            let size = [picture.width as usize, picture.height as usize];
            egui::ColorImage::from_rgba_premultiplied(size, &picture.bytes)
        };
        load(&mut self.picture, "picture", image(&shown.picture));
        if let Some((reference, _)) = &shown.reference {
            load(&mut self.reference_picture, "reference", image(reference));
        }
        if let Some(depth) = &shown.depth {
            let size = [depth.width as usize, depth.height as usize];
            let gray = viewport::depth_grays(&depth.near_over_distance);
            let image = egui::ColorImage::from_gray_iter(size, gray);
            load(&mut self.depth_picture, "depth", image);
        }
    }

    /// Takes over the draft where it makes sense.
    fn take_settings(&mut self) {
        let (width, height) = self.place;
        if self.display.fit && width > 0 && height > 0 {
            let scaled = |pixels: u32| ((pixels as f32 * self.display.scale) as i64).max(16);
            self.draft.insert("width".to_owned(), scaled(width).into());
            self.draft
                .insert("height".to_owned(), scaled(height).into());
        }
        match needs::checked(&self.draft) {
            Ok(settings) => {
                self.wrong = None;
                self.settings = settings;
            }
            Err(cause) => self.wrong = Some(cause),
        }
    }

    /// Puts other settings in place of these.
    pub(crate) fn use_settings(&mut self, settings: &Settings) {
        self.draft = Table::try_from(settings).unwrap_or_default();
    }

    /// The reference as it is drawn, or why it cannot be; `None` where nothing is compared.
    pub(crate) fn reference_beside(&self) -> Option<Result<Settings, String>> {
        let beside = || needs::beside(&self.reference, &self.settings);
        self.display.compare.then(beside)
    }

    /// Asks for a picture where a new one is wanted.
    fn ask(&mut self) {
        let can_be_drawn = self.place.0 > 0 && self.opening.is_none();
        let Some(request) = self.request().filter(|_| can_be_drawn) else {
            return;
        };
        if self.asked.as_ref() != Some(&request) {
            let costs_otherwise = |asked: &Request| {
                // The graph goes on while the eye wanders.
                let gaze = asked.settings.eye.gaze;
                request.settings.clone().with(|s| s.eye.gaze = gaze) != asked.settings
            };
            if self.asked.as_ref().is_some_and(costs_otherwise) {
                self.history.clear();
            }
            let is_same = |quality: &Quality| quality.request.shows_the_same(&request);
            if !self.quality.as_deref().is_some_and(is_same) {
                self.quality = None;
            }
            self.worker.draw(request.clone());
            self.asked = Some(request);
        }
    }

    /// What shall be on the screen; `None` without a scene.
    fn request(&self) -> Option<Request> {
        let navigator = self.navigator.as_ref()?;
        Some(Request {
            settings: self.settings.clone(),
            reference: self.reference_beside().and_then(Result::ok),
            camera: navigator.camera().clone(),
            frozen: self.display.frozen,
            boxes: self.display.boxes,
            depth: self.display.depth,
            time_s: self.display.time_s,
            clip: self.display.clip.clone(),
            always: self.display.always,
        })
    }

    /// Why a setting has no effect beside the others; `None` where it has one.
    pub(crate) fn missing(&self, key: &str) -> Option<&'static str> {
        needs::missing(key, &self.settings, self.abilities, self.display.compare)
    }
}

/// Text line by line, without control characters that would change the text around it.
fn printable_lines(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(foveal_scene::printable).collect();
    lines.join("\n")
}
