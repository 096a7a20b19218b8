//! Pictures and videos with distortions, from integers alone: the same bytes on every machine.

/// Number of picture scenes.
pub(crate) const SCENES: usize = 5;
/// Number of distortions of pictures.
pub(crate) const DISTORTIONS: usize = 10;
/// Number of distortions of videos.
pub(crate) const VIDEO_DISTORTIONS: usize = 4;

/// 8-bit sRGB.
#[derive(Clone)]
pub(crate) struct Frame {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 3]>,
}

/// A picture (one frame) or a video.
pub(crate) struct Clip {
    pub(crate) name: String,
    pub(crate) frames: Vec<Frame>,
}

impl Clip {
    /// A scene's picture, as it is or distorted away from the gaze.
    pub(crate) fn picture(scene: usize, distortion: Option<usize>, gaze: (f32, f32)) -> Self {
        // Even and odd heights, and more pixels for one scene.
        let size = [(480, 270), (512, 288), (480, 270), (400, 225), (960, 540)][scene];
        let clip = Self::sized(size, scene, distortion, gaze);
        Self {
            name: format!("p{scene}-{}", name_of(distortion)),
            ..clip
        }
    }

    /// The same with another number of pixels.
    pub(crate) fn sized(
        (width, height): (usize, usize),
        scene: usize,
        distortion: Option<usize>,
        gaze: (f32, f32),
    ) -> Self {
        let frame = Frame::draw(width, height, |x, y| scene_colour(scene, x, y, 0));
        let frame = match distortion {
            None => frame,
            Some(kind) => frame.distorted(kind, gaze),
        };
        Self {
            name: format!("s{scene}-{width}x{height}-{}", name_of(distortion)),
            frames: vec![frame],
        }
    }

    /// Ten frames of a scene that moves, as they are or distorted.
    pub(crate) fn video(scene: usize, distortion: Option<usize>, gaze: (f32, f32)) -> Self {
        let (width, height) = (256, 144);
        let draw = |time: usize| Frame::draw(width, height, |x, y| scene_colour(scene, x, y, time));
        let frames = (0..10).map(|time| match distortion {
            None => draw(time),
            // Coarse blocks that stay where they are on the screen.
            Some(0) => draw(time).blocks(8, gaze),
            // Noise that is new in each frame.
            Some(1) => draw(time).noise(9, time),
            // Every second frame is shown twice.
            Some(2) => draw(time / 2 * 2),
            // The light goes up and down.
            Some(_) => draw(time).map(|c, _| c as i32 * (100 + 5 * (time as i32 % 3)) / 100),
        });
        Self {
            name: format!("v{scene}-{}", name_of(distortion)),
            frames: frames.collect(),
        }
    }
}

fn name_of(distortion: Option<usize>) -> String {
    distortion.map_or("ref".to_owned(), |kind| kind.to_string())
}

impl Frame {
    fn draw(width: usize, height: usize, colour: impl Fn(i32, i32) -> [u8; 3]) -> Self {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x as i32, y as i32)));
        Self {
            width,
            height,
            pixels: places.map(|(x, y)| colour(x, y)).collect(),
        }
    }

    /// A binary PPM file.
    pub(crate) fn ppm(&self) -> Vec<u8> {
        let mut file = format!("P6\n{} {}\n255\n", self.width, self.height).into_bytes();
        file.extend_from_slice(self.pixels.as_flattened());
        file
    }

    fn at(&self, x: i32, y: i32) -> [u8; 3] {
        let x = x.clamp(0, self.width as i32 - 1) as usize;
        let y = y.clamp(0, self.height as i32 - 1) as usize;
        self.pixels[y * self.width + x]
    }

    /// Each channel (its value and number) becomes another.
    fn map(&self, change: impl Fn(u8, usize) -> i32) -> Self {
        let pixels = self.pixels.iter();
        let mut channels = [0, 1, 2].into_iter().cycle();
        let pixels = pixels.map(|pixel| {
            pixel.map(|c| change(c, channels.next().unwrap_or(0)).clamp(0, 255) as u8)
        });
        Self {
            pixels: pixels.collect(),
            ..*self
        }
    }

    fn distorted(&self, kind: usize, gaze: (f32, f32)) -> Self {
        match kind {
            0 => self.blocks(16, gaze),
            1 => self.blocks(4, gaze),
            2 => self.box_blur(2),
            3 => self.noise(7, 0),
            4 => self.map(|c, channel| i32::from(c) * [108, 100, 90][channel] / 100),
            5 => self.map(|c, _| i32::from(c) / 24 * 24 + 12),
            6 => self.resampled(2),
            7 => Self::draw(self.width, self.height, |x, y| self.at(x + 1, y)),
            8 => self.map(|c, _| 128 + (i32::from(c) - 128) * 85 / 100),
            _ => self.quantised_blocks(),
        }
    }

    /// Blocks of up to `largest` pixels a side, by the distance to the gaze, with their middle's
    /// colour.
    fn blocks(&self, largest: i32, gaze: (f32, f32)) -> Self {
        let (gaze_x, gaze_y) = (
            (gaze.0 * self.width as f32) as i32,
            (gaze.1 * self.height as f32) as i32,
        );
        Self::draw(self.width, self.height, |x, y| {
            let (x16, y16) = (x / 16 * 16 + 8 - gaze_x, y / 16 * 16 + 8 - gaze_y);
            let distance_squared = x16 * x16 + y16 * y16;
            let mut side = 1;
            let mut reach = self.height as i32 / 6;
            while side < largest && distance_squared > reach * reach {
                side *= 2;
                reach = reach * 8 / 5;
            }
            self.at(x / side * side + side / 2, y / side * side + side / 2)
        })
    }

    fn box_blur(&self, reach: i32) -> Self {
        Self::draw(self.width, self.height, |x, y| {
            let mut sums = [0; 3];
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let pixel = self.at(x + dx, y + dy);
                    (0..3).for_each(|c| sums[c] += u32::from(pixel[c]));
                }
            }
            let count = ((2 * reach + 1) * (2 * reach + 1)) as u32;
            sums.map(|sum| (sum / count) as u8)
        })
    }

    /// Half the size and back, by linear interpolation in code values.
    fn resampled(&self, side: i32) -> Self {
        Self::draw(self.width, self.height, |x, y| {
            let (left, upper) = (x / side * side, y / side * side);
            let (fx, fy) = (x - left, y - upper);
            let mix = |a: u8, b: u8, f: i32| (i32::from(a) * (side - f) + i32::from(b) * f) / side;
            let corners = [(0, 0), (side, 0), (0, side), (side, side)]
                .map(|(dx, dy)| self.at(left + dx, upper + dy));
            [0, 1, 2].map(|c| {
                let upper = mix(corners[0][c], corners[1][c], fx) as u8;
                let lower = mix(corners[2][c], corners[3][c], fx) as u8;
                mix(upper, lower, fy) as u8
            })
        })
    }

    fn noise(&self, amplitude: i32, seed: usize) -> Self {
        Self::draw(self.width, self.height, |x, y| {
            let pixel = self.at(x, y);
            let noise =
                (hash(x, y, 77 + seed as i32) % (2 * amplitude as u32 + 1)) as i32 - amplitude;
            pixel.map(|c| (i32::from(c) + noise).clamp(0, 255) as u8)
        })
    }

    /// Blocks of 8x8 pixels whose deviation from their mean is quantised coarsely, as strong
    /// compression does.
    fn quantised_blocks(&self) -> Self {
        Self::draw(self.width, self.height, |x, y| {
            let (left, upper) = (x / 8 * 8, y / 8 * 8);
            let mut sums = [0; 3];
            for i in 0..64 {
                let pixel = self.at(left + i % 8, upper + i / 8);
                (0..3).for_each(|c| sums[c] += i32::from(pixel[c]));
            }
            let pixel = self.at(x, y);
            [0, 1, 2].map(|c| {
                let mean = sums[c] / 64;
                let quantised = (i32::from(pixel[c]) - mean) / 20 * 20;
                (mean + quantised).clamp(0, 255) as u8
            })
        })
    }
}

fn scene_colour(scene: usize, x: i32, y: i32, time: usize) -> [u8; 3] {
    let time = time as i32;
    match scene {
        // Cobbles: cells of 12 pixels with dark joints and some grain, which move to the left.
        0 => {
            let x = x + 3 * time;
            let x = x + (y / 12 % 2) * 6;
            let joint = x % 12 < 2 || y % 12 < 2;
            let stone = 70 + (hash(x / 12, y / 12, 1) % 110) as i32;
            let grain = (hash(x, y, 2) % 17) as i32 - 8;
            grey_tinted(if joint { 30 } else { stone + grain })
        }
        // Cloth: stripes that grow finer to the right, under a light that falls off; they move
        // down.
        1 => {
            let phase = (x * x / 300 + y + 2 * time) % 16;
            let bright = 150 - y / 3;
            grey_tinted(if phase < 8 { bright } else { bright / 2 })
        }
        // Clouds: four octaves of smooth noise, which drift.
        2 => {
            let octave = |size: i32, seed: i32| smooth_noise(x + 2 * time, y + time, size, seed);
            grey_tinted(
                20 + (octave(64, 3) * 8 + octave(32, 4) * 4 + octave(16, 5) * 2 + octave(8, 6))
                    / 16,
            )
        }
        // Discs, light and dark, on a gradient.
        3 => {
            let (cell_x, cell_y) = (x / 40, y / 40);
            let (dx, dy) = (x % 40 - 20, y % 40 - 20);
            let radius = 4 + (hash(cell_x, cell_y, 7) % 14) as i32;
            if dx * dx + dy * dy < radius * radius {
                let kind = hash(cell_x, cell_y, 8);
                [
                    (kind % 256) as u8,
                    (kind / 256 % 256) as u8,
                    (kind / 65_536 % 256) as u8,
                ]
            } else {
                grey_tinted(15 + x / 4 + y / 4)
            }
        }
        // Bricks in the dark beside a bright window.
        _ => {
            let window = (x / 160 % 2 == 1) && (y / 120 % 2 == 1);
            let grain = (hash(x / 2, y / 2, 9) % 25) as i32;
            let brick = if (x + y / 16 % 2 * 20) % 40 < 3 || y % 16 < 3 {
                18
            } else {
                40
            };
            let value = if window { 215 + grain } else { brick + grain };
            [value as u8, (value * 9 / 10) as u8, (value * 3 / 4) as u8]
        }
    }
}

fn grey_tinted(value: i32) -> [u8; 3] {
    let value = value.clamp(0, 255);
    [value as u8, (value * 15 / 16) as u8, (value * 7 / 8) as u8]
}

/// 0 to 255, linear between points `size` pixels apart.
fn smooth_noise(x: i32, y: i32, size: i32, seed: i32) -> i32 {
    let at = |x: i32, y: i32| (hash(x, y, seed) % 256) as i32;
    let (cx, cy, fx, fy) = (x / size, y / size, x % size, y % size);
    let upper = at(cx, cy) * (size - fx) + at(cx + 1, cy) * fx;
    let lower = at(cx, cy + 1) * (size - fx) + at(cx + 1, cy + 1) * fx;
    (upper * (size - fy) + lower * fy) / (size * size)
}

fn hash(x: i32, y: i32, seed: i32) -> u32 {
    let mut value = (x as u32)
        .wrapping_mul(0x9E37_79B1)
        .wrapping_add((y as u32).wrapping_mul(0x85EB_CA77))
        .wrapping_add((seed as u32).wrapping_mul(0xC2B2_AE3D));
    value = (value ^ (value >> 15)).wrapping_mul(0x2C1B_3C6D);
    value = (value ^ (value >> 12)).wrapping_mul(0x297A_2D39);
    value ^ (value >> 15)
}
