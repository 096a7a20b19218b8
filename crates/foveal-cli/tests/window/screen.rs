//! A virtual screen with the window on it: its pixels, and hands for keys and pointer.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::common;

/// Colours of the interface, as `look.rs` has them.
pub(crate) const PANEL: [u8; 3] = [0x1c, 0x1f, 0x25];
pub(crate) const BACKGROUND: [u8; 3] = [0x14, 0x16, 0x1a];
pub(crate) const CARD: [u8; 3] = [0x25, 0x29, 0x31];
pub(crate) const BAD: [u8; 3] = [0xff, 0x7b, 0x72];
pub(crate) const VISIBLE: [u8; 3] = [0x5f, 0xd3, 0x7f];

/// How long anything may take on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(90);

/// A program that ends with the test.
pub(crate) struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen, and the program's window on it.
pub(crate) struct Screen {
    pub(crate) window: Running,
    _server: Running,
    pub(crate) folder: TempDir,
    pub(crate) display: String,
    /// The window's number at the server.
    pub(crate) id: u32,
    size: (usize, usize),
}

/// RGB of a screen.
#[derive(Clone, PartialEq)]
pub(crate) struct Shot {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Shot {
    /// The pixels of a rectangle, given as fractions of the screen.
    pub(crate) fn part(&self, left: f64, top: f64, right: f64, bottom: f64) -> Vec<[u8; 3]> {
        let x = (left * self.width as f64) as usize..(right * self.width as f64) as usize;
        let y = (top * self.height as f64) as usize..(bottom * self.height as f64) as usize;
        let row = |y: usize| &self.pixels[y * self.width..][..self.width];
        y.flat_map(|y| row(y)[x.clone()].to_vec()).collect()
    }

    /// Whether both panels are there, with text on them that stands out; else why not.
    pub(crate) fn legibility(&self) -> Result<(), String> {
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
    pub(crate) fn picture(&self) -> Vec<[u8; 3]> {
        self.part(0.3, 0.3, 0.7, 0.7)
    }
}

pub(crate) fn count(pixels: &[[u8; 3]], color: [u8; 3], tolerance: u8) -> usize {
    let near = |p: &&[u8; 3]| (0..3).all(|c| p[c].abs_diff(color[c]) <= tolerance);
    pixels.iter().filter(near).count()
}

/// How many colours, coarsely.
pub(crate) fn colors(pixels: &[[u8; 3]]) -> usize {
    let coarse: std::collections::HashSet<_> = pixels.iter().map(|p| p.map(|c| c >> 4)).collect();
    coarse.len()
}

pub(crate) fn differing(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let differ = a.iter().zip(b).filter(|(a, b)| a != b).count();
    differ as f64 / a.len() as f64
}

pub(crate) fn has(program: &str) -> bool {
    let found = Command::new("sh")
        .args(["-c", &format!("command -v {program}")])
        .stdout(Stdio::null())
        .status();
    found.is_ok_and(|status| status.success())
}

/// Whether the test can run; says why not.
pub(crate) fn is_possible() -> bool {
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
    pub(crate) fn open(size: (usize, usize), words: &[&str]) -> Self {
        let folder = common::folder();
        let (server, display) = start_server(folder.path(), size);
        let window = start_window(folder.path(), &display, size, words);
        let mut screen = Self {
            window,
            _server: server,
            folder,
            display,
            id: 0,
            size,
        };
        screen.wait_for_picture();
        screen
    }

    /// Ends the window and starts it anew with these words.
    pub(crate) fn restart(&mut self, words: &[&str]) {
        let _ = self.window.0.kill();
        let _ = self.window.0.wait();
        self.window = start_window(self.folder.path(), &self.display, self.size, words);
        self.wait_for_picture();
    }

    fn wait_for_picture(&mut self) {
        self.id = self.until("the window is there", |screen| {
            let id = screen.xdotool(&["search", "--name", "^Foveal$"])?;
            let id = id.lines().next()?.to_owned();
            // There is no window manager: nobody else places it or gives it the keys.
            screen.xdotool(&["windowmove", &id, "0", "0"])?;
            screen.xdotool(&["windowfocus", &id])?;
            id.parse().ok()
        });
        self.until("a picture is drawn", |screen| {
            let picture = screen.shot().picture();
            let empty = count(&picture, BACKGROUND, 1);
            (colors(&picture) > 12 && empty < picture.len() / 10).then_some(())
        });
    }

    pub(crate) fn xdotool(&self, words: &[&str]) -> Option<String> {
        let output = Command::new("xdotool")
            .args(words)
            .env("DISPLAY", &self.display)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        output.status.success().then_some(text)
    }

    pub(crate) fn key(&self, key: &str) {
        self.xdotool(&["key", key]).unwrap();
    }

    /// A drag with the first button, from and to fractions of the screen.
    pub(crate) fn drag(&self, from: (f64, f64), to: (f64, f64)) {
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

    pub(crate) fn click(&self, x: usize, y: usize) {
        self.xdotool(&["mousemove", &x.to_string(), &y.to_string()])
            .unwrap();
        std::thread::sleep(Duration::from_millis(200));
        self.xdotool(&["click", "1"]).unwrap();
    }

    /// The screen once it has stopped changing.
    pub(crate) fn settled(&mut self) -> Shot {
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

    /// Waits until the window takes no more time of the processor.
    pub(crate) fn until_at_rest(&mut self) {
        // Hundredths of a second: the program's own and what the system did for it.
        let taken = |screen: &Self| -> u64 {
            let stat = std::fs::read_to_string(format!("/proc/{}/stat", screen.window.0.id()));
            let stat = stat.unwrap();
            let after_name = stat.rsplit_once(") ").unwrap().1;
            let fields = after_name.split(' ').skip(11).take(2);
            fields.map(|field| field.parse::<u64>().unwrap()).sum()
        };
        let mut seconds_at_rest = 0;
        self.until("the window rests", |screen| {
            let before = taken(screen);
            std::thread::sleep(Duration::from_secs(1));
            let rests = taken(screen) - before < 3;
            seconds_at_rest = if rests { seconds_at_rest + 1 } else { 0 };
            (seconds_at_rest >= 3).then_some(())
        });
    }

    /// Tries until `ready` gives something.
    pub(crate) fn until<T>(&mut self, what: &str, mut ready: impl FnMut(&Self) -> Option<T>) -> T {
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

    pub(crate) fn said(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("stderr")).unwrap_or_default()
    }

    /// What is on the screen.
    pub(crate) fn shot(&self) -> Shot {
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
    pub(crate) fn keep(&self, name: &str, shot: &Shot) {
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

/// The window on this display, with its memory in the folder.
fn start_window(folder: &Path, display: &str, size: (usize, usize), words: &[&str]) -> Running {
    let window = Command::new(env!("CARGO_BIN_EXE_foveal"))
        .arg("view")
        .args(words)
        .args(["--window", &format!("{}x{}", size.0, size.1)])
        .current_dir(folder)
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_CONFIG_HOME", folder.join("config"))
        .stderr(Stdio::from(
            std::fs::File::create(folder.join("stderr")).unwrap(),
        ))
        .spawn()
        .unwrap();
    Running(window)
}

/// A server that answers, and its display.
pub(crate) fn start_server(folder: &Path, (width, height): (usize, usize)) -> (Running, String) {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    // Far from where people's displays are, and different in each process and thread.
    let first = 200 + 16 * (std::process::id() % 3000);
    for _ in 0..16 {
        let display = format!(":{}", first + NEXT.fetch_add(1, Ordering::Relaxed) % 16);
        let server = Command::new("Xvfb")
            // Else it starts anew when its last client goes, as the one that asks below does, and
            // turns the window away.
            .args([&display, "-noreset", "-nolisten", "tcp", "-screen", "0"])
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
