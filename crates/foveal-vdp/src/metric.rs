//! The metric from pixels to JOD: pictures at once, videos frame by frame.

use std::collections::VecDeque;
use std::ops::RangeInclusive;

use crate::difference::{Channel, Pair, band, jod_lost, join_channels};
use crate::display::Photometry;
use crate::eye::Geometry;
use crate::flicker::FlickerMeter;
use crate::levels::Level;
use crate::pyramid::Plane;
use crate::temporal::Filters;
use crate::{Display, Gaze, VdpError};

/// Frames per second of videos that can be compared.
pub const FRAME_RATES: RangeInclusive<f32> = 5.0..=1000.0;

/// 8-bit sRGB pixels, rows top to bottom.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Red, green, blue.
    Rgb(&'a [[u8; 3]]),
    /// Red, green, blue and an alpha that is not looked at.
    Rgba(&'a [[u8; 4]]),
}

impl Pixels<'_> {
    fn len(self) -> usize {
        match self {
            Self::Rgb(pixels) => pixels.len(),
            Self::Rgba(pixels) => pixels.len(),
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = [u8; 3]> {
        (0..self.len()).map(|i| match self {
            Self::Rgb(pixels) => pixels[i],
            Self::Rgba(pixels) => [pixels[i][0], pixels[i][1], pixels[i][2]],
        })
    }
}

/// A comparison of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Quality in just-objectionable differences: 10 is no visible difference, 9 one that 75 % of
    /// observers take for the worse; strong distortions give less, even less than 0.
    pub jod: f32,
    /// Where it is visible.
    pub heat_map: HeatMap,
}

/// A comparison of two videos.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoComparison {
    /// Quality in just-objectionable differences, as in [`Comparison::jod`].
    pub jod: f32,
    /// Where the difference is visible, over all frames.
    pub heat_map: HeatMap,
    /// Number of frames.
    pub frames: usize,
    /// The test's change from frame to frame in the periphery, by the reference's: mean absolute
    /// difference of luma (code values) low-passed with σ = 4 pixels, farther from the gaze than
    /// 0.35 of the height. A reference that changes less counts as changing by
    /// 0.01. `None` for a single frame, or without a periphery.
    pub flicker: Option<f32>,
}

/// Visible difference per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Rows top to bottom: the JOD that it would cost if all of the picture differed as this pixel
    /// does.
    pub jod_lost: Vec<f32>,
}

/// The metric for one display, one size of picture and one gaze.
///
/// ```
/// use foveal_vdp::{Display, Gaze, Metric, Pixels};
/// let metric = Metric::new(&Display::DEGREES_60, 64, 48, Gaze::CENTRE)?;
/// let grey = vec![[120; 3]; 64 * 48];
/// let mut noisy = grey.clone();
/// noisy.iter_mut().step_by(3).for_each(|pixel| *pixel = [140; 3]);
/// assert_eq!(metric.compare(Pixels::Rgb(&grey), Pixels::Rgb(&grey))?.jod, 10.0);
/// assert!(metric.compare(Pixels::Rgb(&grey), Pixels::Rgb(&noisy))?.jod < 9.9);
/// # Ok::<(), foveal_vdp::VdpError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Metric {
    width: usize,
    height: usize,
    gaze: Gaze,
    pixels_per_degree: f32,
    photometry: Photometry,
    levels: Vec<Level>,
}

impl Metric {
    /// A metric for pictures of `width` times `height` pixels that fill the display.
    ///
    /// # Errors
    /// Sizes, gazes and displays that [`VdpError`] names.
    pub fn new(
        display: &Display,
        width: usize,
        height: usize,
        gaze: Gaze,
    ) -> Result<Self, VdpError> {
        let sides = 4..=16_384;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(VdpError::Size { width, height });
        }
        display.check()?;
        gaze.check()?;
        let pixels_per_degree = display.pixels_per_degree(width);
        let geometry = Geometry::new(display, width, height, gaze);
        Ok(Self {
            width,
            height,
            gaze,
            pixels_per_degree,
            photometry: Photometry::new(display),
            levels: Level::all(&geometry, pixels_per_degree, width, height),
        })
    }

    /// Pixels per degree of the visual field in the display's middle.
    #[must_use]
    pub fn pixels_per_degree(&self) -> f32 {
        self.pixels_per_degree
    }

    /// Compares two pictures.
    ///
    /// # Errors
    /// [`VdpError::PixelCount`].
    pub fn compare(&self, reference: Pixels<'_>, test: Pixels<'_>) -> Result<Comparison, VdpError> {
        let (reference, test) = (self.luminance(reference)?, self.luminance(test)?);
        let mut sums = Sums::new(self);
        sums.add(self, [reference, test], None);
        Ok(Comparison {
            jod: sums.jod(),
            heat_map: sums.heat_map(self),
        })
    }

    /// Begins to compare two videos.
    ///
    /// # Errors
    /// [`VdpError::FrameRate`].
    pub fn video(&self, frames_per_second: f32) -> Result<VideoMetric<'_>, VdpError> {
        if !FRAME_RATES.contains(&frames_per_second) {
            return Err(VdpError::FrameRate(frames_per_second));
        }
        let meter = || FlickerMeter::new(self.width, self.height, self.gaze);
        Ok(VideoMetric {
            metric: self,
            filters: Filters::new(frames_per_second),
            newest_first: [VecDeque::new(), VecDeque::new()],
            flicker: [meter(), meter()],
            sums: Sums::new(self),
        })
    }

    fn luminance(&self, pixels: Pixels<'_>) -> Result<Plane, VdpError> {
        let (expected, found) = (self.width * self.height, pixels.len());
        if expected != found {
            return Err(VdpError::PixelCount { expected, found });
        }
        let values = pixels.iter().map(|rgb| self.photometry.luminance(rgb));
        Ok(Plane::new(self.width, self.height, values.collect()))
    }
}

/// A comparison of two videos under way: [`Metric::video`] begins it.
#[derive(Clone, Debug)]
pub struct VideoMetric<'a> {
    metric: &'a Metric,
    filters: Filters,
    /// Luminance of the frames within the filters' reach, reference and test.
    newest_first: [VecDeque<Plane>; 2],
    flicker: [FlickerMeter; 2],
    sums: Sums,
}

impl VideoMetric<'_> {
    /// Adds the next frame of both videos.
    ///
    /// # Errors
    /// [`VdpError::PixelCount`]; the frame is then not added.
    pub fn push(&mut self, reference: Pixels<'_>, test: Pixels<'_>) -> Result<(), VdpError> {
        let frames = [
            self.metric.luminance(reference)?,
            self.metric.luminance(test)?,
        ];
        for (queue, frame) in self.newest_first.iter_mut().zip(frames) {
            queue.truncate(self.filters.sustained.len() - 1);
            queue.push_front(frame);
        }
        self.flicker[0].push(reference);
        self.flicker[1].push(test);
        let [(reference, reference_change), (test, test_change)] = self
            .newest_first
            .each_ref()
            .map(|queue| self.filters.apply(queue.iter()));
        let changes = [reference_change, test_change];
        self.sums.add(self.metric, [reference, test], Some(changes));
        Ok(())
    }

    /// Ends the comparison. A single frame is compared as a picture.
    ///
    /// # Errors
    /// [`VdpError::NoFrames`].
    pub fn finish(mut self) -> Result<VideoComparison, VdpError> {
        let frames = self.sums.frames;
        if frames == 0 {
            return Err(VdpError::NoFrames);
        }
        if frames == 1 {
            // The transient filter does not quite sum to zero: it would see a change.
            let frame = self.newest_first.each_mut().map(|queue| queue.pop_front());
            if let [Some(reference), Some(test)] = frame {
                self.sums = Sums::new(self.metric);
                self.sums.add(self.metric, [reference, test], None);
            }
        }
        let changes = self.flicker.each_ref().map(FlickerMeter::sum);
        let per_change = self.flicker[0].samples() * (frames - 1) as f64;
        let flicker = match changes {
            [Some(reference), Some(test)] if frames > 1 => {
                Some((test / per_change / (reference / per_change).max(AT_REST)) as f32)
            }
            _ => None,
        };
        Ok(VideoComparison {
            jod: self.sums.jod(),
            heat_map: self.sums.heat_map(self.metric),
            frames,
            flicker,
        })
    }
}

/// Mean change, in code values a frame, below which the reference counts as changing by this much: a
/// ratio to what rests would say nothing.
const AT_REST: f64 = 0.01;

/// Differences summed over frames.
#[derive(Clone, Debug)]
struct Sums {
    frames: usize,
    difference: f64,
    /// Per pixel, by channel.
    maps: [Vec<f32>; 2],
}

impl Sums {
    fn new(metric: &Metric) -> Self {
        let pixels = metric.width * metric.height;
        Self {
            frames: 0,
            difference: 0.0,
            maps: [vec![0.0; pixels], vec![0.0; pixels]],
        }
    }

    /// Adds a frame: reference and test, as they last and as they change.
    fn add(&mut self, metric: &Metric, lasting: [Plane; 2], changing: Option<[Plane; 2]>) {
        let [mut reference, mut test] = lasting;
        let mut changing = changing;
        let mut totals = [0.0; 2];
        let mut maps: [Vec<Plane>; 2] = [Vec::new(), Vec::new()];
        for level in &metric.levels {
            let (lower_reference, lower_test) = (reference.reduced(), test.reduced());
            let (width, height) = (reference.width, reference.height);
            let background = lower_reference.expanded(width, height);
            let test_low = lower_test.expanded(width, height);
            let pair = Pair {
                reference: &reference,
                test: &test,
                reference_low: &background,
                test_low: &test_low,
            };
            let (total, map) = band(level, Channel::Sustained, &pair, &background);
            totals[0] += total;
            maps[0].push(map);
            if let Some([reference, test]) = &mut changing {
                let lower = [reference.reduced(), test.reduced()];
                let [reference_low, test_low] = lower.each_ref().map(|l| l.expanded(width, height));
                let pair = Pair {
                    reference,
                    test,
                    reference_low: &reference_low,
                    test_low: &test_low,
                };
                let (total, map) = band(level, Channel::Transient, &pair, &background);
                totals[1] += total;
                maps[1].push(map);
                [*reference, *test] = lower;
            }
            (reference, test) = (lower_reference, lower_test);
        }
        self.frames += 1;
        self.difference += join_channels(totals[0], totals[1]);
        for (sum, bands) in self.maps.iter_mut().zip(maps) {
            for (sum, value) in sum.iter_mut().zip(sum_of_bands(bands)) {
                *sum += value;
            }
        }
    }

    fn jod(&self) -> f32 {
        (10.0 - jod_lost(self.difference / self.frames as f64)) as f32
    }

    fn heat_map(&self, metric: &Metric) -> HeatMap {
        let mean = |sum: f32| f64::from(sum) / self.frames as f64;
        let channels = self.maps[0].iter().zip(&self.maps[1]);
        HeatMap {
            width: metric.width,
            height: metric.height,
            jod_lost: channels
                .map(|(&s, &t)| jod_lost(join_channels(mean(s), mean(t))) as f32)
                .collect(),
        }
    }
}

/// All bands' values at the finest one's pixels.
fn sum_of_bands(bands: Vec<Plane>) -> Vec<f32> {
    let mut coarser: Option<Plane> = None;
    for mut plane in bands.into_iter().rev() {
        if let Some(coarser) = coarser {
            let expanded = coarser.expanded(plane.width, plane.height);
            for (value, from_coarser) in plane.values.iter_mut().zip(expanded.values) {
                *value += from_coarser;
            }
        }
        coarser = Some(plane);
    }
    coarser.map(|plane| plane.values).unwrap_or_default()
}
