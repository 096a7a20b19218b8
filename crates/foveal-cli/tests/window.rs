//! The real window on a virtual screen, driven by real keys and a real pointer.
//!
//! Needs Xvfb and xdotool; without them it says so and passes, unless `FOVEAL_WINDOW_TEST=required`, as `./run test`
//! sets it. Screenshots come from Xvfb's frame buffer; `FOVEAL_SCREENSHOTS=DIR` keeps them as PNG files.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]
#![allow(clippy::print_stdout, reason = "a test says what it skipped")]
#![cfg(target_os = "linux")]

mod common;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Colours of the interface, as `look.rs` has them.
const PANEL: [u8; 3] = [0x1c, 0x1f, 0x25];
const BACKGROUND: [u8; 3] = [0x14, 0x16, 0x1a];
const CARD: [u8; 3] = [0x25, 0x29, 0x31];
const BAD: [u8; 3] = [0xff, 0x7b, 0x72];
const VISIBLE: [u8; 3] = [0x5f, 0xd3, 0x7f];

/// How long anything may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen, and the program's window on it.
struct Screen {
    window: Running,
    _server: Running,
    folder: TempDir,
    display: String,
    size: (usize, usize),
}

/// RGB of a screen.
#[derive(Clone, PartialEq)]
struct Shot {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Shot {
    /// The pixels of a rectangle, given as fractions of the screen.
    fn part(&self, left: f64, top: f64, right: f64, bottom: f64) -> Vec<[u8; 3]> {
        let x = (left * self.width as f64) as usize..(right * self.width as f64) as usize;
        let y = (top * self.height as f64) as usize..(bottom * self.height as f64) as usize;
        let row = |y: usize| &self.pixels[y * self.width..][..self.width];
        y.flat_map(|y| row(y)[x.clone()].to_vec()).collect()
    }

    /// Whether both panels are there, with text on them that stands out; else why not.
    fn legibility(&self) -> Result<(), String> {
        let side = 268.0 / self.width as f64;
        for (name, part) in [
            ("settings", self.part(0.0, 0.1, side, 0.9)),
            ("figures", self.part(1.0 - side, 0.1, 1.0, 0.9)),
        ] {
            let ground = count(&part, PANEL, 2) + count(&part, CARD, 2);
            let bright = part.iter().filter(|p| p.iter().all(|&c| c > 0x80)).count();
            let share = |n: usize| n as f64 / part.len() as f64;
            if share(ground) < 0.4 || !(0.01..0.4).contains(&share(bright)) {
                return Err(format!(
                    "{name}: {:.3} is ground, {:.3} text",
                    share(ground),
                    share(bright)
                ));
            }
        }
        Ok(())
    }

    /// The middle, where nothing but the picture is.
    fn picture(&self) -> Vec<[u8; 3]> {
        self.part(0.3, 0.3, 0.7, 0.7)
    }
}

fn count(pixels: &[[u8; 3]], color: [u8; 3], tolerance: u8) -> usize {
    let near = |p: &&[u8; 3]| (0..3).all(|c| p[c].abs_diff(color[c]) <= tolerance);
    pixels.iter().filter(near).count()
}

/// How many colours, coarsely.
fn colors(pixels: &[[u8; 3]]) -> usize {
    let coarse: std::collections::HashSet<_> = pixels.iter().map(|p| p.map(|c| c >> 4)).collect();
    coarse.len()
}

fn differing(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let differ = a.iter().zip(b).filter(|(a, b)| a != b).count();
    differ as f64 / a.len() as f64
}

fn has(program: &str) -> bool {
    let found = Command::new("sh")
        .args(["-c", &format!("command -v {program}")])
        .stdout(Stdio::null())
        .status();
    found.is_ok_and(|status| status.success())
}

/// Whether the test can run; says why not.
fn is_possible() -> bool {
    let missing: Vec<_> = ["Xvfb", "xdotool"]
        .into_iter()
        .filter(|p| !has(p))
        .collect();
    if missing.is_empty() {
        return true;
    }
    let said = format!("the window test needs {}", missing.join(" and "));
    assert!(
        std::env::var_os("FOVEAL_WINDOW_TEST").is_none_or(|v| v != "required"),
        "{said}"
    );
    println!("skipped: {said}");
    false
}

impl Screen {
    /// A screen of this size, all of it the window of `foveal view` with these words.
    fn open(size: (usize, usize), words: &[&str]) -> Self {
        let folder = common::folder();
        let (server, display) = start_server(folder.path(), size);
        let window_size = format!("{}x{}", size.0, size.1);
        let window = Command::new(env!("CARGO_BIN_EXE_foveal"))
            .arg("view")
            .args(words)
            .args(["--window", &window_size])
            .current_dir(folder.path())
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder.path())
            .stderr(Stdio::from(
                std::fs::File::create(folder.path().join("stderr")).unwrap(),
            ))
            .spawn()
            .unwrap();
        let mut screen = Self {
            window: Running(window),
            _server: server,
            folder,
            display,
            size,
        };
        screen.until("the window is there", |screen| {
            let id = screen.xdotool(&["search", "--name", "^Foveal$"])?;
            let id = id.lines().next()?.to_owned();
            // There is no window manager: nobody else places it or gives it the keys.
            screen.xdotool(&["windowmove", &id, "0", "0"])?;
            screen.xdotool(&["windowfocus", &id])
        });
        screen.until("a picture is drawn", |screen| {
            let picture = screen.shot().picture();
            let empty = count(&picture, BACKGROUND, 1);
            (colors(&picture) > 12 && empty < picture.len() / 10).then_some(())
        });
        screen
    }

    fn xdotool(&self, words: &[&str]) -> Option<String> {
        let output = Command::new("xdotool")
            .args(words)
            .env("DISPLAY", &self.display)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        output.status.success().then_some(text)
    }

    fn key(&self, key: &str) {
        self.xdotool(&["key", key]).unwrap();
    }

    /// A drag with the first button, from and to fractions of the screen.
    fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        let at = |(x, y): (f64, f64)| {
            let [x, y] = [x * self.size.0 as f64, y * self.size.1 as f64];
            [format!("{x:.0}"), format!("{y:.0}")]
        };
        let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
        let pointer = |place| {
            let [x, y] = at(place);
            self.xdotool(&["mousemove", &x, &y]).unwrap();
            std::thread::sleep(Duration::from_millis(200));
        };
        pointer(from);
        self.xdotool(&["mousedown", "1"]).unwrap();
        pointer(middle);
        pointer(to);
        self.xdotool(&["mouseup", "1"]).unwrap();
    }

    fn click(&self, x: usize, y: usize) {
        self.xdotool(&["mousemove", &x.to_string(), &y.to_string()])
            .unwrap();
        std::thread::sleep(Duration::from_millis(200));
        self.xdotool(&["click", "1"]).unwrap();
    }

    /// The screen once it has stopped changing.
    fn settled(&mut self) -> Shot {
        let mut before = self.shot();
        let mut same = 0;
        self.until("the screen stands still", |screen| {
            std::thread::sleep(Duration::from_millis(300));
            let now = screen.shot();
            same = if now == before { same + 1 } else { 0 };
            before = now;
            (same >= 3).then(|| before.clone())
        })
    }

    /// Tries until `ready` gives something.
    fn until<T>(&mut self, what: &str, mut ready: impl FnMut(&Self) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(status) = self.window.0.try_wait().unwrap() {
                panic!(
                    "the window closed ({status}) before {what}: {}",
                    self.said()
                );
            }
            if let Some(found) = ready(self) {
                return found;
            }
            if start.elapsed() > PATIENCE {
                self.keep("failed", &self.shot());
                panic!("it took too long until {what}: {}", self.said());
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn said(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("stderr")).unwrap_or_default()
    }

    /// What is on the screen.
    fn shot(&self) -> Shot {
        let dump = std::fs::read(self.folder.path().join("Xvfb_screen0")).unwrap();
        // XWDFileHeader: big-endian words, then a colour map of 12 bytes an entry, then the rows.
        let word = |i: usize| {
            let bytes: [u8; 4] = dump[4 * i..][..4].try_into().unwrap();
            u32::from_be_bytes(bytes) as usize
        };
        let (header, width, height) = (word(0), word(4), word(5));
        let (bits, row_bytes, map_entries) = (word(11), word(12), word(19));
        assert_eq!(bits, 32, "the screen has 24 bits a pixel in 32");
        let rows = &dump[header + 12 * map_entries..];
        let pixels = (0..height)
            .flat_map(|y| rows[y * row_bytes..][..4 * width].as_chunks::<4>().0)
            .map(|&[b, g, r, _]| [r, g, b])
            .collect();
        Shot {
            width,
            height,
            pixels,
        }
    }

    /// Writes a screenshot where the caller wants them.
    fn keep(&self, name: &str, shot: &Shot) {
        let Some(folder) = std::env::var_os("FOVEAL_SCREENSHOTS") else {
            return;
        };
        let path = PathBuf::from(folder).join(format!("{name}-{}.png", shot.width));
        let (width, height) = (shot.width as u32, shot.height as u32);
        image::save_buffer(
            path,
            shot.pixels.as_flattened(),
            width,
            height,
            image::ColorType::Rgb8,
        )
        .unwrap();
    }
}

/// A server that answers, and its display.
fn start_server(folder: &Path, (width, height): (usize, usize)) -> (Running, String) {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    // Far from where people's displays are, and different in each process and thread.
    let first = 200 + 16 * (std::process::id() % 3000);
    for _ in 0..16 {
        let display = format!(":{}", first + NEXT.fetch_add(1, Ordering::Relaxed) % 16);
        let server = Command::new("Xvfb")
            .args([&display, "-nolisten", "tcp", "-screen", "0"])
            .arg(format!("{width}x{height}x24"))
            .args(["-fbdir", "."])
            .current_dir(folder)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut server = Running(server);
        let start = Instant::now();
        while start.elapsed() < PATIENCE && server.0.try_wait().unwrap().is_none() {
            let answer = Command::new("xdotool")
                .arg("getmouselocation")
                .env("DISPLAY", &display)
                .output()
                .unwrap();
            if answer.status.success() && server.0.try_wait().unwrap().is_none() {
                return (server, display);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
    panic!("Xvfb does not start");
}

#[test]
fn the_window_shows_a_scene_and_obeys_keys_and_pointer() {
    if !is_possible() {
        return;
    }
    let words = ["cornell", "--culling", "occlusion"];
    let mut screen = Screen::open((1280, 720), &words);
    let start = screen.settled();
    screen.keep("start", &start);
    assert_eq!(start.legibility(), Ok(()));

    // Keys that are held move the camera, a drag turns it, Home goes back.
    screen.xdotool(&["keydown", "w"]).unwrap();
    screen.until("the camera moves", |s| {
        (differing(&start.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    screen.xdotool(&["keyup", "w"]).unwrap();
    let nearer = screen.settled();
    screen.until("the camera turns", |s| {
        // On a busy machine the window may see press and release at once, which is no drag.
        s.drag((0.5, 0.6), (0.56, 0.6));
        std::thread::sleep(Duration::from_millis(500));
        (differing(&nearer.picture(), &s.shot().picture()) > 0.2).then_some(())
    });
    screen.keep("turned", &screen.shot());
    screen.key("Home");
    screen.until("the camera is back", |s| {
        (differing(&start.picture(), &s.shot().picture()) < 0.01).then_some(())
    });

    // Boxes, with the depth that hides them.
    let green = |shot: &Shot| count(&shot.picture(), VISIBLE, 24);
    screen.key("b");
    screen.key("z");
    screen.until("boxes are drawn", |s| {
        (green(&s.shot()) > green(&start) + 100).then_some(())
    });
    let boxes = screen.settled();
    screen.keep("boxes", &boxes);
    screen.key("b");
    screen.key("z");

    // The reference on the left, with a white line between.
    screen.key("x");
    screen.until("the split is drawn", |s| {
        let middle = s.shot().part(0.45, 0.3, 0.55, 0.4);
        (count(&middle, [255; 3], 2) > 100).then_some(())
    });
    let compare = screen.settled();
    screen.keep("compare", &compare);
    screen.key("x");

    // Without panels the picture has the whole width.
    screen.key("h");
    screen.until("the panels are gone", |s| {
        let left = s.shot().part(0.0, 0.1, 0.2, 0.9);
        (count(&left, PANEL, 0) < left.len() / 10).then_some(())
    });
    let wide = screen.settled();
    screen.keep("wide", &wide);
    screen.key("h");
    screen.until("the panels are back", |s| s.shot().legibility().ok());

    // A picture of the picture.
    screen.key("p");
    let file = screen.folder.path().join("foveal-001.png");
    screen.until("the screenshot is written", |_| {
        image::open(&file).is_ok().then_some(())
    });

    // A scene that is not there is an error in the window, which goes on.
    screen.click(150, 20);
    screen.key("ctrl+a");
    screen.xdotool(&["type", "missing.glb"]).unwrap();
    screen.key("Return");
    screen.until("the error is shown", |s| {
        let above = s.shot().part(0.22, 0.05, 0.78, 0.3);
        (count(&above, BAD, 24) > 100).then_some(())
    });
    let error = screen.settled();
    screen.keep("error", &error);
    assert!(colors(&error.picture()) > 12, "the old picture stays");
    screen.click(640, 400);
    screen.key("h");
    screen.until("the window still obeys", |s| {
        let left = s.shot().part(0.0, 0.1, 0.2, 0.9);
        (count(&left, PANEL, 0) < left.len() / 10).then_some(())
    });
}

#[test]
fn a_large_window_is_legible_too_and_shows_coarse_shading() {
    if !is_possible() {
        return;
    }
    let words = ["demo:1000", "--shading", "coarse", "--view", "rate"];
    let mut screen = Screen::open((1920, 1080), &words);
    let shot = screen.settled();
    screen.keep("coarse", &shot);
    assert_eq!(shot.legibility(), Ok(()));
}

#[test]
fn without_a_display_the_error_says_so() {
    let folder = common::folder();
    let output = Command::new(env!("CARGO_BIN_EXE_foveal"))
        .args(["view", "cornell"])
        .current_dir(folder.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        common::stderr(&output).contains("display"),
        "{}",
        common::stderr(&output)
    );
}
