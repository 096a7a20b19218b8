//! The culling of a frame: rasterizes occluders where that pays, and tests objects and cells.
//!
//! The occlusion buffer has by default a quarter of the picture's size per axis, and its frustum is
//! the picture's, widened to whole buffer pixels: the 4x4 coverage samples in each of its pixels
//! then lie on the picture's own pixel centres, so that what is culled could not have changed a
//! single pixel, but through cracks that rounding opens between surfaces that meet. Where the
//! picture shows what lies between the centres too (anti-aliasing), and where the buffer has
//! another size, views ask for every point of the picture.

use foveal_cull::{
    Budget, CullStats, Culler, Eye, FrameOptions, MAX_SIDE_PX, Projection, View, Visibility,
};
use foveal_scene::Camera;
use glam::Mat4;

use super::cells::Cells;
use super::found_for::FoundFor;
use super::pace::{Pace, has_receivers, hidden_triangles};
use super::scene::{CullingScene, affine};
use super::workers::Workers;
use crate::clock::{self, ms_between};
use crate::{Antialiasing, Clock, CullingEyes, Error, Settings, Shading};

/// What the culler found in a frame, as Intel's occlusion culling sample shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CullingStats {
    /// Counts.
    pub stats: CullStats,
    /// Width and height of the occlusion buffer.
    pub buffer: (u32, u32),
    /// Threads that rasterize.
    pub threads: usize,
    /// Time for the occluders, in milliseconds; 0 without a clock.
    pub rasterize_ms: f64,
    /// Time for the tests of all objects, in milliseconds; 0 without a clock.
    pub test_ms: f64,
    /// Time for the tests of what may receive shadows, in milliseconds; 0 without a clock, without
    /// shadows, and where all of each visible object counts.
    pub receivers_ms: f64,
    /// Whether the result is an earlier frame's, which still holds.
    pub reused: bool,
}

/// How many objects culling found visible in a frame, and how many not, and at what cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ObjectStats {
    pub(crate) visible: u64,
    pub(crate) outside: u64,
    pub(crate) occluded: u64,
    pub(crate) small: u64,
    pub(crate) occluder_triangles: u64,
    /// Clusters of occluders that the time budget left out.
    pub(crate) over_budget: u64,
    /// Whether the result is an earlier frame's.
    pub(crate) reused: bool,
}

/// Decides what is seen.
#[derive(Debug)]
pub(crate) struct CullingStage {
    /// Frames that rasterize occluders.
    occlusion: Pace,
    occluder_size: f32,
    occludee_size: f32,
    /// Picture pixels per buffer pixel and axis.
    scale: u32,
    threads: Workers,
    culler: Culler,
    results: Vec<Visibility>,
    of_eye: Vec<Visibility>,
    /// Whether shadows ask for the scene's cells, so that they are tested too.
    has_cells: bool,
    /// What became of each of the scene's cells.
    cells: Vec<Visibility>,
    cells_of_eye: Vec<Visibility>,
    rasterize_ms: f64,
    test_ms: f64,
    receivers_ms: f64,
    /// Metres that eyes may move while the result holds.
    radius_m: f64,
    /// The same, as views are told: above 0 where the picture shows more than the buffer's samples.
    view_radius_m: f64,
    eyes: CullingEyes,
    /// 0: none.
    budget_ms: f64,
    /// What the result was found for.
    found_for: Option<FoundFor>,
    /// For what occluders were rasterized last.
    tried_for: Option<FoundFor>,
    reused: bool,
    over_budget: u64,
}

impl CullingStage {
    /// `None` where nothing is culled.
    ///
    /// # Errors
    /// [`Error::Limit`] where the picture is too large for the occlusion buffer.
    pub(crate) fn new(settings: &Settings) -> Result<Option<Self>, Error> {
        let (width, height) = (settings.picture.width, settings.picture.height);
        let scale = u32::from(settings.culling.buffer_scale);
        let Some(occlusion) = Pace::new(settings) else {
            return Ok(None);
        };
        let has_cells = occlusion.is_every_frame() && has_cells(settings);
        let culler = Culler::new(width.div_ceil(scale), height.div_ceil(scale));
        let culler = culler.map_err(|cause| Error::Limit {
            what: "the larger side of a picture with occlusion culling".to_owned(),
            value: u64::from(width.max(height)),
            limit: u64::from(MAX_SIDE_PX) * u64::from(scale),
            hint: format!(": raise occlusion-scale ({cause})"),
        })?;
        Ok(Some(Self {
            occlusion,
            occluder_size: settings.culling.occluder_size,
            occludee_size: settings.culling.occludee_size,
            scale,
            threads: if occlusion == Pace::Never {
                Workers::One
            } else {
                Workers::new(settings.culling.threads)
            },
            culler,
            results: Vec::new(),
            of_eye: Vec::new(),
            has_cells,
            cells: Vec::new(),
            cells_of_eye: Vec::new(),
            rasterize_ms: 0.0,
            test_ms: 0.0,
            receivers_ms: 0.0,
            radius_m: settings.culling.radius_m.into(),
            view_radius_m: view_radius_m(settings),
            eyes: settings.culling.eyes,
            budget_ms: settings.culling.budget_ms.into(),
            found_for: None,
            tried_for: None,
            reused: false,
            over_budget: 0,
        }))
    }

    /// The next frame shows another scene.
    pub(crate) fn forget(&mut self) {
        self.occlusion.wake();
        self.results.clear();
        self.cells.clear();
        self.found_for = None;
    }

    /// Takes over what another stage found of the same scene.
    pub(crate) fn keep(&mut self, found: &Self, scene: &CullingScene) {
        self.results.clone_from(&found.results);
        self.cells.clone_from(&found.cells);
        self.count(scene);
    }

    /// Wakes the threads that will soon have to rasterize.
    pub(crate) fn wake(&self) {
        if self.occlusion.is_next() {
            self.threads.threads().wake();
        }
    }

    /// Tests all objects for a picture of `width` x `height` pixels, or two of them where there are
    /// two eyes: what is hidden is hidden from both. A view that makes no sense culls nothing.
    ///
    /// Each eye is tested for itself, exactly; the stats and the buffer that are shown are then
    /// the left eye's. Or both are tested at once, from their centre. A result that holds for some
    /// way around the eyes is kept until they leave it.
    pub(crate) fn cull(
        &mut self,
        scene: &CullingScene,
        camera: &Camera,
        eyes: Option<&[crate::stereo::Eye; 2]>,
        (width, height): (u32, u32),
        clock: Option<Clock>,
    ) -> ObjectStats {
        (self.rasterize_ms, self.test_ms, self.receivers_ms) = (0.0, 0.0, 0.0);
        let size = (width, height);
        let eye = |world_from_view: Mat4, projection: Projection| {
            Eye::new(affine(world_from_view), projection)
        };
        let wanted = FoundFor {
            pose: scene.pose,
            eyes: match eyes {
                None => {
                    let projection = projection(camera, size, self.scale);
                    [Some(eye(camera.world_from_view, projection)), None]
                }
                Some(eyes) => eyes.each_ref().map(|e| {
                    let projection = eye_projection(e, camera, size, self.scale);
                    Some(eye(e.world_from_view, projection))
                }),
            },
        };
        self.reused = self.occlusion.may_keep()
            && self
                .found_for
                .is_some_and(|found| found.holds_for(&wanted, self.radius_m));
        if self.reused {
            self.occlusion.keep();
            return self.object_stats();
        }
        if !self.tried_for.is_some_and(|tried| tried.is_like(&wanted)) {
            self.occlusion.wake();
        }
        if self.occlusion.is_next() {
            self.tried_for = Some(wanted);
        }
        self.results.clear();
        self.cells.clear();
        self.over_budget = 0;
        let both = match wanted.eyes {
            [Some(left), Some(right)] if self.eyes == CullingEyes::Shared => {
                Some(View::stereo(left, right))
            }
            _ => None,
        };
        // Eyes that look too far apart have no centre.
        if !both.is_some_and(|view| self.cull_for(scene, view, clock)) {
            self.results.clear();
            self.cells.clear();
            // The stats that are shown are the first eye's.
            for eye in wanted.eyes.into_iter().flatten().rev() {
                self.cull_for(scene, View::mono(eye), clock);
            }
        }
        self.found_for = Some(wanted);
        self.count(scene);
        // Occluders are the first eye's: the other one's are about as many.
        let rasterized = self.culler.stats().occluder_triangles_rasterized;
        let is_shown = |object| scene.is_shown(object);
        let hidden = hidden_triangles(&self.results, &scene.triangles, is_shown);
        self.occlusion.advance(hidden, rasterized);
        self.object_stats()
    }

    /// Adds the results to the stats of the culler's frame, where there are any: there are none
    /// before the first frame of a scene.
    fn count(&mut self, scene: &CullingScene) {
        if !self.results.is_empty() {
            let counted = self.culler.count(&self.results, Some(&scene.triangles));
            debug_assert_eq!(counted, Ok(()));
        }
    }

    /// Adds what is seen in a view to the results: all of it if the view makes no sense, which is
    /// false then.
    fn cull_for(&mut self, scene: &CullingScene, view: View, clock: Option<Clock>) -> bool {
        let radius_m = if self.occlusion.is_next() {
            self.view_radius_m
        } else {
            self.radius_m
        };
        let view = view.with_validity_radius(radius_m);
        let budget = clock.as_ref().filter(|_| self.budget_ms > 0.0);
        let budget_ns = (self.budget_ms * 1e6) as u64;
        let budget = budget.map(|clock| Budget::new(clock, clock().saturating_add(budget_ns)));
        let options = FrameOptions::default()
            .with_occlusion(self.occlusion.is_next())
            .with_occluder_size_threshold(self.occluder_size)
            .with_occludee_size_threshold(self.occludee_size)
            .with_budget(budget);
        self.of_eye.clear();
        self.of_eye.resize(scene.boxes.len(), Visibility::Visible);
        let now = || clock::read(clock);
        let start = now();
        let threads = self.threads.threads();
        let rasterized = self
            .culler
            .rasterize(&view, &scene.occluders, &options, threads);
        let rasterized_at = now();
        if rasterized.is_ok()
            && self
                .culler
                .query_tree(&scene.objects, &mut self.of_eye)
                .is_err()
        {
            self.of_eye.fill(Visibility::Visible);
        }
        let tested_at = now();
        self.over_budget += self.culler.stats().clusters_over_budget;
        self.rasterize_ms += ms_between(start, rasterized_at);
        self.test_ms += ms_between(rasterized_at, tested_at);
        join(&mut self.results, &self.of_eye);
        if let Some(cells) = scene.cells.as_ref().filter(|_| self.has_cells) {
            self.test_cells(cells, rasterized.is_ok());
            self.receivers_ms += ms_between(tested_at, now());
        }
        rasterized.is_ok()
    }

    /// Adds the cells that are seen in the view that has been rasterized last.
    fn test_cells(&mut self, cells: &Cells, is_rasterized: bool) {
        let results = &mut self.cells_of_eye;
        results.clear();
        results.resize(cells.boxes().len(), Visibility::Visible);
        if is_rasterized && self.culler.query_tree(cells.tree(), results).is_err() {
            results.fill(Visibility::Visible);
        }
        // A small cell of a larger object is drawn.
        for cell in results.iter_mut() {
            if *cell == Visibility::Small {
                *cell = Visibility::Visible;
            }
        }
        join(&mut self.cells, results);
    }

    /// What the last frame found.
    pub(crate) fn object_stats(&self) -> ObjectStats {
        let s = self.culler.stats();
        ObjectStats {
            visible: s.occludees_visible,
            outside: s.occludees_outside,
            occluded: s.occludees_occluded,
            small: s.occludees_small,
            occluder_triangles: s.occluder_triangles_rasterized,
            over_budget: self.over_budget,
            reused: self.reused,
        }
    }

    /// All stats of the last frame.
    pub(crate) fn stats(&self) -> CullingStats {
        CullingStats {
            stats: self.culler.stats(),
            buffer: self.culler.size(),
            threads: self.threads.threads().count(),
            rasterize_ms: self.rasterize_ms,
            test_ms: self.test_ms,
            receivers_ms: self.receivers_ms,
            reused: self.reused,
        }
    }

    /// What became of each object in the last frame.
    pub(crate) fn visibility(&self) -> &[Visibility] {
        &self.results
    }

    /// The scene's cells that the last frame may show, in ascending order; `None` where the scene has
    /// none. `by_object`: all cells of the objects that are drawn, for pictures that show more than
    /// the culler has looked at.
    pub(crate) fn cells_seen(&self, scene: &CullingScene, by_object: bool) -> Option<Vec<u32>> {
        let cells = scene.cells.as_ref().filter(|_| self.has_cells)?;
        if !by_object && self.cells.len() != cells.boxes().len() {
            return None;
        }
        Some(cells.drawn(
            |object| scene.is_shown(object) && self.is_visible(object),
            |cell| by_object || self.cells[cell].is_visible(),
        ))
    }

    #[cfg(test)]
    pub(crate) fn cells_tested(&self) -> usize {
        self.cells.len()
    }

    /// The occlusion buffer of the last frame.
    pub(crate) fn depth(&self) -> (u32, u32, Vec<f32>) {
        let (width, height) = self.culler.size();
        let mut pixels = vec![0.0; (width * height) as usize];
        // The only error is a wrong length.
        let _ = self.culler.read_depth(&mut pixels);
        (width, height, pixels)
    }

    /// What became of an object in the last frame.
    pub(crate) fn result(&self, object: u32) -> Visibility {
        let result = self.results.get(object as usize);
        result.copied().unwrap_or(Visibility::Visible)
    }

    /// Whether the last frame's object is to be drawn.
    pub(crate) fn is_visible(&self, object: u32) -> bool {
        self.result(object).is_visible()
    }
}

/// Whether frames of these settings ask on which parts of things shadows fall. Variable shading and
/// anti-aliasing light the mean of several places, which need not be on any surface.
pub(crate) fn has_cells(settings: &Settings) -> bool {
    has_receivers(settings)
        && settings.shading.mode != Shading::Variable
        && settings.antialiasing.mode == Antialiasing::None
}

/// A radius that answers for every point of the picture, in metres.
const EVERY_POINT_M: f64 = 1e-6;

/// Metres that views are asked to hold for: above 0 where the buffer's samples are not all that the
/// picture shows.
fn view_radius_m(settings: &Settings) -> f64 {
    let radius_m = f64::from(settings.culling.radius_m);
    let at_centres = matches!(settings.culling.buffer_scale, 1 | 4);
    if at_centres && settings.antialiasing.mode == Antialiasing::None {
        return radius_m;
    }
    radius_m.max(EVERY_POINT_M)
}

/// Adds what is seen in one more view.
fn join(results: &mut Vec<Visibility>, of_eye: &[Visibility]) {
    if results.is_empty() {
        results.extend(of_eye);
    }
    for (result, of_eye) in results.iter_mut().zip(of_eye) {
        if !result.is_visible() {
            *result = *of_eye;
        }
    }
}

/// How far a frustum is widened to the right and downwards, relative to its size, to end at whole
/// buffer pixels.
fn widened((width, height): (u32, u32), scale: u32) -> (f64, f64) {
    let of = |pixels: u32| f64::from(pixels.next_multiple_of(scale)) / f64::from(pixels);
    (of(width), of(height))
}

/// An eye's frustum, widened; the near plane is the camera's.
fn eye_projection(
    eye: &crate::stereo::Eye,
    camera: &Camera,
    size: (u32, u32),
    scale: u32,
) -> Projection {
    let [left, right, bottom, top] = eye.borders().map(f64::from);
    let (right_over_width, down_over_height) = widened(size, scale);
    let near_m = match camera.projection {
        foveal_scene::Projection::Perspective { near_m, .. }
        | foveal_scene::Projection::Orthographic { near_m, .. } => near_m,
    };
    Projection::Perspective {
        left,
        right: left + (right - left) * right_over_width,
        bottom: top - (top - bottom) * down_over_height,
        top,
        near_m: near_m.into(),
        far_m: f64::INFINITY,
    }
}

/// The camera's frustum, widened.
fn projection(camera: &Camera, size: (u32, u32), scale: u32) -> Projection {
    let aspect = f64::from(size.0) / f64::from(size.1);
    let (right_over_width, down_over_height) = widened(size, scale);
    let extents = |half_height: f64| {
        let half_width = half_height * aspect;
        let right = -half_width + 2.0 * half_width * right_over_width;
        let bottom = half_height - 2.0 * half_height * down_over_height;
        (-half_width, right, bottom, half_height)
    };
    match camera.projection {
        foveal_scene::Projection::Perspective { fov_y_rad, near_m } => {
            let (left, right, bottom, top) = extents((0.5 * f64::from(fov_y_rad)).tan());
            Projection::Perspective {
                left,
                right,
                bottom,
                top,
                near_m: near_m.into(),
                far_m: f64::INFINITY,
            }
        }
        foveal_scene::Projection::Orthographic {
            height_m,
            near_m,
            far_m,
        } => {
            let (left, right, bottom, top) = extents(0.5 * f64::from(height_m));
            Projection::Orthographic {
                left,
                right,
                bottom,
                top,
                near_m: near_m.into(),
                far_m: far_m.into(),
            }
        }
    }
}
