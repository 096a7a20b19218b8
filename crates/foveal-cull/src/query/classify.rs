//! Classification of one projected box: by frustum, by size, then by the occlusion buffer.

use super::axis_planes::AxisPlanes;
use super::coarse::CoarseTest;
use super::rect::{PixelRect, hidden};
use crate::camera::{Camera, frustum_planes};
use crate::depth::buffer::OcclusionBuffer;
use crate::depth::hiz::Hiz;
use crate::format::{SAMPLES, encode};
use crate::projection::boxes::{Boxes8, ROUNDING};
use crate::projection::near::{Clipped, clip_box};
use crate::projection::points::Corners8;
use crate::projection::project::Projected8;
use crate::projection::screen::Screen;
use crate::simd::Lanes;
use crate::view::View;
use crate::visibility::Visibility;
use glam::{DVec3, Vec3};

/// Growth of boxes on the screen, samples. Their rectangles then touch every pixel that has a
/// sample within one sample of them. That is more than all rounding, and a box that reaches the
/// edge of an occluder also tests what is beside it.
const DILATE: f32 = 0.5;
/// Growth where not only samples count but everything between them.
const DILATE_REGION: f32 = 1.0;

/// Groups over more blocks than this are opened, not tested block by block.
const GROUP_BLOCKS: u32 = 64;

/// State of the frame that was rasterized.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) camera: Camera,
    pub(crate) view: View,
    pub(crate) occludee_size_threshold: f32,
    pub(crate) occlusion: bool,
}

/// A frame, prepared for queries with boxes relative to one origin.
pub(crate) struct Query<'a> {
    pub(crate) buffer: &'a OcclusionBuffer,
    pub(crate) screen: Screen<'a>,
    pub(crate) occlusion: bool,
    /// `threshold² * tan(fov / 2)`.
    pub(crate) small: f32,
    /// Set for view regions.
    region: Option<Region>,
    /// Planes of boxes, for boxes that their rectangle leaves undecided. Only for one eye at its
    /// exact position.
    pub(super) axis_planes: Option<AxisPlanes>,
}

impl<'a> Query<'a> {
    pub(crate) fn new(buffer: &'a OcclusionBuffer, frame: &Frame, origin: DVec3) -> Self {
        let camera = &frame.camera;
        let from_origin = origin - camera.eye;
        let rows = camera.rows.map(|r| {
            let t = r.truncate();
            [
                t.x as f32,
                t.y as f32,
                t.z as f32,
                (t.dot(from_origin) + r.w) as f32,
            ]
        });
        let screen = Screen {
            rows,
            width: (buffer.width * SAMPLES) as f32,
            height: (buffer.height * SAMPLES) as f32,
            far_depth: (camera.far_depth * (1.0 - 1e-5)) as f32,
            dilate: if camera.radius > 0.0 {
                DILATE_REGION
            } else {
                DILATE
            },
            grow: ROUNDING * from_origin.length() as f32,
            hiz: frame.occlusion.then(|| Hiz::new(buffer)).flatten(),
        };
        let t = f64::from(frame.occludee_size_threshold.max(0.0));
        let axis_planes = (camera.radius == 0.0)
            .then(|| AxisPlanes::new(camera, origin, screen.width, screen.height))
            .flatten();
        Self {
            axis_planes,
            buffer,
            screen,
            occlusion: frame.occlusion,
            small: (t * t * camera.tan_half_fov_y) as f32,
            region: (camera.radius > 0.0).then(|| Region {
                frusta: [Some(frame.view.eye), frame.view.second_eye].map(|eye| {
                    eye.map(|e| frustum_planes(&e, frame.view.validity_radius_m, origin))
                }),
                clamp_depth: camera.clamp_depth as f32,
            }),
        }
    }

    /// Classifies one of eight projected boxes. `object`: not a group, so that it may be too small,
    /// and its faces decide if its rectangle does not.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn classify<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
        object: bool,
    ) -> Visibility {
        if self.region.is_some() {
            return self.classify_region(l, p, i, boxes, object);
        }
        if p.outside >> i & 1 != 0 {
            return Visibility::Outside;
        }
        if self.is_small(i, boxes, object) {
            return Visibility::Small;
        }
        if p.crossing >> i & 1 != 0 {
            return self.classify_crossing(l, i, boxes);
        }
        if p.hidden >> i & 1 != 0 {
            return Visibility::Occluded;
        }
        if !self.occlusion {
            return Visibility::Visible;
        }
        let (rect, code) = rectangle(p, i);
        // The members of a large group are better tested themselves.
        if !object && rect.block_count() > GROUP_BLOCKS {
            return Visibility::Visible;
        }
        // If the centre is in front of the buffer, the box is visible.
        let [x, y, center_code] = [0, 1, 2].map(|k| p.center[k][i]);
        let known = self.buffer.code_of_pixel(x as u32, y as u32);
        if center_code > i32::from(known) {
            return Visibility::Visible;
        }
        let place = object.then(|| place(boxes, i));
        // So it is where the ray through the centre's pixel enters it.
        if let (Some(planes), Some((center, half))) = (&self.axis_planes, place) {
            let sample = |v: i32| (v as f32 + 0.5) * SAMPLES as f32;
            if planes.entry(sample(x), sample(y), center, half) > known {
                return Visibility::Visible;
            }
        }
        self.classify_rect(l, rect, code, place)
    }

    /// The coarse test, for frames in which frustum and HiZ alone decide most boxes.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(crate) fn coarse_test(&self) -> Option<CoarseTest<'a>> {
        (self.occlusion && self.region.is_none())
            .then(|| CoarseTest::new(&self.screen))
            .flatten()
    }

    /// Classifies a box that neither its centre nor its corners decided, in frames of one exact
    /// eye.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn classify_remaining<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
    ) -> Visibility {
        if p.crossing >> i & 1 != 0 {
            return self.classify_crossing(l, i, boxes);
        }
        let (rect, code) = rectangle(p, i);
        self.classify_rect(l, rect, code, Some(place(boxes, i)))
    }

    /// Classifies a group: visible means that it must be opened.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn classify_group<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
    ) -> Visibility {
        if p.crossing >> i & 1 != 0 {
            // Its members seldom cross the near plane too.
            let (center, half) = place(boxes, i);
            let beside = self.screen.is_beside(center, half + self.screen.grow);
            return if beside {
                Visibility::Outside
            } else {
                Visibility::Visible
            };
        }
        let (rect, code) = rectangle(p, i);
        if rect.block_count() > GROUP_BLOCKS {
            return Visibility::Visible;
        }
        self.classify_rect(l, rect, code, None)
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn is_small(&self, i: usize, boxes: &Boxes8, object: bool) -> bool {
        if !(object && self.small > 0.0) {
            return false;
        }
        let (c, h) = place(boxes, i);
        let [x, y, z, w] = self.screen.rows[3];
        // The sum has the order in which lanes are added.
        let distance = (c.x * x + c.y * y) + (c.z * z + w);
        distance > 1.0 && h.length_squared() < distance * self.small
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_rect<L: Lanes>(
        &self,
        l: L,
        rect: PixelRect,
        code: i16,
        place: Option<(Vec3, Vec3)>,
    ) -> Visibility {
        if !self.occlusion {
            return Visibility::Visible;
        }
        let place = place.map(|(center, half)| (center, half + self.screen.grow));
        let faces = self.axis_planes.as_ref().zip(place);
        if hidden(l, self.buffer, rect, code, faces) {
            Visibility::Occluded
        } else {
            Visibility::Visible
        }
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_crossing<L: Lanes>(&self, l: L, i: usize, boxes: &Boxes8) -> Visibility {
        let (center, half) = place(boxes, i);
        if self.screen.is_beside(center, half + self.screen.grow) {
            return Visibility::Outside;
        }
        match clip_box(&self.screen, center, half + self.screen.grow) {
            Clipped::Outside => Visibility::Outside,
            Clipped::Visible => Visibility::Visible,
            Clipped::Rect(rect, depth) => {
                self.classify_rect(l, self.pixels(rect), encode(depth), Some((center, half)))
            }
        }
    }

    #[cfg_attr(not(unoptimized), inline(always))]
    fn pixels(&self, samples: [f32; 4]) -> PixelRect {
        PixelRect::from_samples(samples, self.buffer.width, self.buffer.height)
    }

    /// Classifies a box for a view region. Frusta are tested one by one, and what the centre eye's
    /// buffer cannot decide for all eyes is visible.
    #[cfg_attr(not(unoptimized), inline(always))]
    fn classify_region<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
        object: bool,
    ) -> Visibility {
        let Some(region) = &self.region else {
            return Visibility::Visible;
        };
        let (center, half) = place(boxes, i);
        let half = half + self.screen.grow;
        let outside = |planes: &[[f32; 4]; 6]| {
            planes.iter().any(|&[x, y, z, w]| {
                let n = Vec3::new(x, y, z);
                n.dot(center) + n.abs().dot(half) + w + 1e-6 * n.abs().dot(center.abs()) < 0.0
            })
        };
        if region.frusta.iter().flatten().all(outside) {
            return Visibility::Outside;
        }
        if self.is_small(i, boxes, object) {
            return Visibility::Small;
        }
        if (p.outside | p.crossing) >> i & 1 != 0 {
            return Visibility::Visible;
        }
        let (w, h) = (self.screen.width, self.screen.height);
        let cut = p.x0[i] < 0.0 || p.y0[i] < 0.0 || p.x1[i] > w || p.y1[i] > h;
        if cut && p.depth[i] >= region.clamp_depth {
            return Visibility::Visible;
        }
        let rect = self.pixels([p.x0[i], p.y0[i], p.x1[i], p.y1[i]]);
        self.classify_rect(l, rect, encode(p.depth[i]), None)
    }
}

impl Query<'_> {
    /// Whether a depth code is in front of a pixel.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn is_in_front(&self, at: i32, code: i32) -> bool {
        code > i32::from(self.buffer.code_at(at as usize))
    }

    /// Whether any corner of a box that lies wholly beyond the near plane is in front of its pixel.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn corner_seen(&self, corners: &Corners8, i: usize) -> bool {
        let mut seen = false;
        for (at, code) in corners.at.iter().zip(&corners.code) {
            seen |= self.is_in_front(at[i], code[i]);
        }
        seen
    }
}

/// Data of a view region.
#[derive(Clone, Copy, Debug)]
struct Region {
    /// Frustum planes of one or two eyes.
    frusta: [Option<[[f32; 4]; 6]>; 2],
    clamp_depth: f32,
}

/// Rectangle of one of eight boxes, and its depth code.
#[cfg_attr(not(unoptimized), inline(always))]
fn rectangle(p: &Projected8, i: usize) -> (PixelRect, i16) {
    let [x0, y0, x1, y1] = p.pixels.map(|v| v[i] as u32);
    let code = p.code[i].clamp(-32768, 32767) as i16;
    (PixelRect { x0, y0, x1, y1 }, code)
}

/// Centre and half extent of one of eight boxes.
#[cfg_attr(not(unoptimized), inline(always))]
fn place(boxes: &Boxes8, i: usize) -> (Vec3, Vec3) {
    let [cx, cy, cz] = boxes.center;
    let [hx, hy, hz] = boxes.half;
    (
        Vec3::new(cx[i], cy[i], cz[i]),
        Vec3::new(hx[i], hy[i], hz[i]),
    )
}
