//! The culler: one occlusion buffer, one frame at a time.

mod queries;

use crate::camera::Camera;
use crate::depth::band::Band;
use crate::depth::buffer::OcclusionBuffer;
use crate::depth::hiz_build::BuildHiz;
use crate::depth::record::{Record, Touched};
use crate::error::CullError;
use crate::format::{EMPTY, SAMPLES, decode};
use crate::limits::MAX_SIDE_PX;
use crate::occluder::set::OccluderSet;
use crate::options::{Budget, FrameOptions};
use crate::query::classify::Frame;
use crate::raster::candidates::{Candidate, FrameScratch};
use crate::raster::draw::Draw;
use crate::raster::facing::ValidityRadius;
use crate::raster::scratch::Scratch;
use crate::raster::select::Choice;
use crate::simd::InstructionSet;
use crate::stats::CullStats;
use crate::threads::Threads;
use crate::view::{PICTURE_PX, View};
use std::sync::Mutex;

/// Most bands of a frame.
const MAX_BANDS: usize = 64;
const _: () = assert!(PICTURE_PX == SAMPLES, "a sample in each pixel of a picture");

/// Rasterizes the occluders of a frame, and answers queries about it.
///
/// A frame is [`rasterize`](Self::rasterize), then any number of queries. Queries take `&self` and
/// may run on many threads at once. A culler allocates when it is made and while its lists grow,
/// then no more. It takes about 3 MB for 640x360 pixels.
///
/// Typical costs on one core of an AMD EPYC (Zen 5, AVX-512) at 640x360: 0.22 ms to rasterize
/// 48,700 triangles of a castle seen from around it, 5 ns for a query of one random box.
/// docs/benchmarks/culling.md in the repository has more, with commands.
#[derive(Debug)]
pub struct Culler {
    buffer: OcclusionBuffer,
    instruction_set: InstructionSet,
    frame: FrameScratch,
    scratch: Vec<Scratch>,
    drawn: Vec<Vec<u32>>,
    seen: Vec<(u32, u32)>,
    view: Option<Frame>,
    stats: CullStats,
    /// What clusters changed, by band, where that is recorded.
    touched: Vec<Vec<Touched>>,
    /// Nanoseconds of the last drawing by the clock of its budget; 0 without one.
    drawing_ns: u64,
    /// Bands of the frame, if it was recorded.
    bands_recorded: Option<usize>,
}

/// What was drawn in a frame, as far as it is recorded.
pub(crate) struct Drawn<'a> {
    pub(crate) candidates: &'a [Candidate],
    /// Numbers of the candidates that were drawn, by band.
    pub(crate) drawn: &'a [Vec<u32>],
    /// What they changed, by band.
    pub(crate) touched: &'a [Vec<Touched>],
    /// Blocks of the buffer across and down.
    pub(crate) blocks: [u32; 2],
    /// Time of drawing by the clock of the budget, nanoseconds; 0 without one.
    pub(crate) ns: u64,
}

impl Culler {
    /// A culler with an occlusion buffer of `width_px` x `height_px` pixels.
    ///
    /// The natural size is that of [`for_picture`](Self::for_picture). The picture's own size is as
    /// safe: fewer hidden boxes are reported as visible, and a frame takes longer. With other sizes
    /// boxes may be reported hidden that show between the buffer's samples, unless the view has a
    /// [validity radius](View::with_validity_radius). So may they with a quarter of a size that is
    /// no multiple of 4, if it is rounded down.
    ///
    /// # Errors
    /// [`CullError::BadSize`] for a side of 0 or of more than [`MAX_SIDE_PX`] pixels.
    pub fn new(width_px: u32, height_px: u32) -> Result<Self, CullError> {
        let fits = |side| (1..=MAX_SIDE_PX).contains(&side);
        if !(fits(width_px) && fits(height_px)) {
            return Err(CullError::BadSize {
                width_px,
                height_px,
            });
        }
        Ok(Self {
            buffer: OcclusionBuffer::new(width_px, height_px),
            instruction_set: InstructionSet::detect(),
            frame: FrameScratch::default(),
            scratch: Vec::new(),
            drawn: Vec::new(),
            seen: Vec::new(),
            view: None,
            stats: CullStats::default(),
            touched: Vec::new(),
            drawing_ns: 0,
            bands_recorded: None,
        })
    }

    /// A culler for a picture of `width_px` x `height_px` pixels, or for a shadow map of so many
    /// texels: the buffer has a quarter of that per axis, rounded up. Rasterize with the view of
    /// [`View::for_picture`], which widens it to the buffer's last pixels. The buffer's 4x4 samples
    /// in a pixel are then the picture's own pixel centres.
    ///
    /// # Errors
    /// [`CullError::BadSize`] for a side of 0 or of more than four times [`MAX_SIDE_PX`] pixels.
    pub fn for_picture(width_px: u32, height_px: u32) -> Result<Self, CullError> {
        Self::new(
            width_px.div_ceil(PICTURE_PX),
            height_px.div_ceil(PICTURE_PX),
        )
    }

    /// Forces an instruction set. All give equal results; this is for tests and measurements. One
    /// that the machine lacks falls back to the next smaller one.
    pub fn set_instruction_set(&mut self, instruction_set: InstructionSet) {
        self.instruction_set = instruction_set;
    }

    /// The instruction set in use.
    #[must_use]
    pub fn instruction_set(&self) -> InstructionSet {
        self.instruction_set
    }

    /// Width and height of the occlusion buffer, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.buffer.width, self.buffer.height)
    }

    /// Begins a frame: clears the buffer, draws the occluders that `view` can see, and resets the
    /// stats.
    ///
    /// The result depends on the scene and the view only: neither on the order of occluders, nor on
    /// the number of threads, nor on the instruction set. (A [budget](FrameOptions::budget) adds the
    /// clock, and [usefulness](FrameOptions::usefulness) the frames before.) Cost grows with the
    /// clusters that may be visible and the blocks that they touch; see [`FrameOptions`] for limits.
    /// For worker threads that sleep from frame to frame, call [`Threads::wake`] 20 to 60
    /// microseconds before.
    ///
    /// If a task or the clock panics on the way, the panic passes on, and everything is visible
    /// until the next successful one.
    ///
    /// # Errors
    /// [`CullError::BadView`], [`CullError::NotFinite`] or [`CullError::Negative`] (its validity
    /// radius) for a bad view. Everything is then visible until the next successful one.
    pub fn rasterize(
        &mut self,
        view: &View,
        occluders: &OccluderSet,
        options: &FrameOptions<'_>,
        threads: &dyn Threads,
    ) -> Result<(), CullError> {
        if options.occlusion {
            threads.wake();
        }
        self.clear();
        let (width, height) = (self.buffer.width * SAMPLES, self.buffer.height * SAMPLES);
        let camera = Camera::new(view, f64::from(width), f64::from(height))?;
        if options.occlusion {
            self.occlude(&camera, occluders, options, threads);
        }
        self.view = Some(Frame {
            camera,
            view: *view,
            occludee_size_threshold: options.occludee_size_threshold,
            occlusion: options.occlusion,
        });
        Ok(())
    }

    /// Forgets the frame: everything is visible until the next one.
    pub fn clear(&mut self) {
        self.view = None;
        self.bands_recorded = None;
        self.stats = CullStats::default();
        self.buffer.clear();
    }

    /// Fills the buffer.
    fn occlude(
        &mut self,
        camera: &Camera,
        occluders: &OccluderSet,
        options: &FrameOptions<'_>,
        threads: &dyn Threads,
    ) {
        let (width, height) = (
            (self.buffer.width * SAMPLES) as f32,
            (self.buffer.height * SAMPLES) as f32,
        );
        let shift = (camera.radius * camera.shift_per_metre) as f32;
        let choice = Choice {
            camera,
            set: occluders,
            width,
            height,
            size_threshold: options.occluder_size_threshold,
            pixels_per_quad: options.occluder_pixels_per_quad,
            shift,
            usefulness: options.usefulness,
        };
        self.stats = self.frame.select(&choice, self.instruction_set, threads);
        let begun = options.budget.map(|b| (b.clock)());
        if let (Some(usefulness), Some(budget), Some(now)) =
            (options.usefulness, options.budget, begun)
            && let Some(work) = usefulness.work_within(budget.deadline_ns.saturating_sub(now))
        {
            let left_out = self.frame.keep_best(occluders, usefulness, work);
            self.stats.clusters_over_budget = left_out;
        }
        let radius = (camera.radius > 0.0).then(|| ValidityRadius {
            shift,
            shifts: camera.shift.map(|s| s as f32),
            per_depth: if camera.orthographic {
                0.0
            } else {
                (camera.radius / camera.near) as f32
            },
        });
        let records = options.usefulness.is_some();
        self.draw(occluders, options.budget, radius, records, threads);
        let ended = options.budget.map(|b| (b.clock)());
        self.drawing_ns = ended
            .zip(begun)
            .map_or(0, |(end, begin)| end.saturating_sub(begin));
        self.instruction_set.run(BuildHiz(&mut self.buffer));
    }

    fn draw(
        &mut self,
        set: &OccluderSet,
        budget: Option<Budget<'_>>,
        radius: Option<ValidityRadius>,
        records: bool,
        threads: &dyn Threads,
    ) {
        let rows = self.buffer.blocks_y;
        let bands = match threads.count() {
            0 | 1 => 1,
            n => n.min(rows as usize).min(MAX_BANDS),
        };
        let mut ends = [0; MAX_BANDS];
        self.buffer.cut(bands, &mut ends);
        self.scratch
            .resize_with(self.scratch.len().max(bands), Scratch::default);
        self.drawn
            .resize_with(self.drawn.len().max(bands), Vec::new);
        self.touched.iter_mut().for_each(Vec::clear);
        self.touched
            .resize_with(self.touched.len().max(bands), Vec::new);
        type Job<'a> = Option<(Band<'a>, &'a mut Scratch, &'a mut Vec<u32>)>;
        let mut jobs: [Mutex<Job<'_>>; MAX_BANDS] = [const { Mutex::new(None) }; MAX_BANDS];
        let mut rest = self.buffer.band();
        let mut first = 0;
        for ((((job, scratch), drawn), touched), end) in jobs
            .iter_mut()
            .zip(&mut self.scratch)
            .zip(&mut self.drawn)
            .zip(&mut self.touched)
            .zip(&ends[..bands])
        {
            (scratch.polygons, scratch.clusters) = (0, 0);
            drawn.clear();
            let (mut band, after) = rest.split(end - first);
            band.record = records.then_some(Record {
                touched,
                candidate: 0,
            });
            (rest, first) = (after, *end);
            *job = Mutex::new(Some((band, scratch, drawn)));
        }
        let frame = &self.frame;
        let isa = self.instruction_set;
        let skipped = core::sync::atomic::AtomicU64::new(0);
        let task = |i: usize| {
            let job = jobs.get(i).and_then(|job| job.lock().ok()?.take());
            if let Some((band, scratch, drawn)) = job {
                let left_out = isa.run(Draw {
                    set,
                    frame,
                    band,
                    scratch,
                    drawn: Some(drawn),
                    budget,
                    radius,
                });
                skipped.fetch_max(left_out, core::sync::atomic::Ordering::Relaxed);
            }
        };
        if bands == 1 {
            task(0)
        } else {
            threads.run(bands, &task)
        }
        self.stats.clusters_over_budget += skipped.into_inner();
        self.bands_recorded = records.then_some(bands);
        self.count_drawn(set, bands);
    }

    fn count_drawn(&mut self, set: &OccluderSet, bands: usize) {
        self.seen.clear();
        for drawn in &self.drawn[..bands] {
            self.seen.extend(
                drawn
                    .iter()
                    .map(|&n| self.frame.candidates[n as usize].place()),
            );
        }
        self.seen.sort_unstable();
        self.seen.dedup();
        self.stats.polygons_rasterized = self.scratch[..bands].iter().map(|s| s.polygons).sum();
        self.stats.clusters_rasterized = self.seen.len() as u64;
        let mut last = None;
        for &(instance, cluster) in &self.seen {
            self.stats.occluder_models_rasterized += u64::from(last != Some(instance));
            last = Some(instance);
            if let Some(mesh) = set.instances[instance as usize].mesh.as_deref() {
                self.stats.occluder_triangles_rasterized +=
                    u64::from(mesh.clusters[cluster as usize].triangle_count);
            }
        }
    }

    /// The record of the frame; none if none was made.
    pub(crate) fn recorded(&self) -> Option<Drawn<'_>> {
        self.bands_recorded.map(|bands| Drawn {
            candidates: &self.frame.candidates,
            drawn: &self.drawn[..bands],
            touched: &self.touched[..bands],
            blocks: [self.buffer.blocks_x, self.buffer.blocks_y],
            ns: self.drawing_ns,
        })
    }

    /// The stats of the frame so far.
    #[must_use]
    pub fn stats(&self) -> CullStats {
        self.stats
    }

    /// Copies the depth, row by row from the top left: `near / distance` for perspective views, 1
    /// at the near plane to 0 at the far plane for orthographic ones; 0 where no occluder covers the
    /// pixel.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `pixels` is not `width * height` long.
    pub fn read_depth(&self, pixels: &mut [f32]) -> Result<(), CullError> {
        let (w, h) = self.size();
        CullError::check_length((w * h) as usize, pixels.len())?;
        for (y, row) in (0..h).zip(pixels.chunks_exact_mut(w as usize)) {
            for (x, pixel) in (0..w).zip(row) {
                *pixel = decode(self.buffer.code_of_pixel(x, y));
            }
        }
        Ok(())
    }

    /// Whether the pixel at (x, y), from the top left, is proven to be covered by occluders.
    /// `false` outside the buffer.
    #[must_use]
    pub fn is_covered(&self, x: u32, y: u32) -> bool {
        x < self.buffer.width && y < self.buffer.height && self.buffer.code_of_pixel(x, y) != EMPTY
    }
}
