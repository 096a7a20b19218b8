//! From a projected box to an answer: frustum, size, then the depth buffer; for one eye, two, or a radius.

use super::axis_planes::Planes;
use super::coarse::Sieve;
use super::rect::{PixelRect, hidden};
use crate::camera::{Camera, frustum_planes};
use crate::depth::buffer::DepthBuffer;
use crate::depth::hiz::Coarse;
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

/// Boxes grow by this on the screen before they are tested, samples: their rectangles then touch every pixel
/// that has a sample within one sample of them. That is more than all rounding, and enough that a box which
/// reaches an occluder's border also asks what is behind it.
const DILATE: f32 = 0.5;
/// The same where not only samples count but all that lies between them.
const DILATE_AROUND: f32 = 1.0;

/// Groups are tested block by block up to this many blocks.
const GROUP_BLOCKS: u32 = 64;

/// What queries need to know of the frame that was rasterized.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) camera: Camera,
    pub(crate) view: View,
    pub(crate) occludee_size_threshold: f32,
    pub(crate) occlusion: bool,
}

/// A frame, as queries see it.
pub(crate) struct Query<'a> {
    pub(crate) buffer: &'a DepthBuffer,
    pub(crate) screen: Screen<'a>,
    pub(crate) occlusion: bool,
    /// `threshold² * tan(fov / 2)`.
    pub(crate) small: f32,
    /// For a result that holds around the eye.
    around: Option<Around>,
    /// For boxes whose rectangle does not say enough; only for one eye at its exact place.
    pub(super) planes: Option<Planes>,
}

impl<'a> Query<'a> {
    pub(crate) fn new(buffer: &'a DepthBuffer, frame: &Frame, origin: DVec3) -> Self {
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
                DILATE_AROUND
            } else {
                DILATE
            },
            grow: ROUNDING * from_origin.length() as f32,
            coarse: frame.occlusion.then(|| Coarse::new(buffer)).flatten(),
        };
        let t = f64::from(frame.occludee_size_threshold);
        let planes = (camera.radius == 0.0)
            .then(|| Planes::new(camera, origin, screen.width, screen.height))
            .flatten();
        Self {
            planes,
            buffer,
            screen,
            occlusion: frame.occlusion,
            small: (t * t * camera.tan_half_fov_y) as f32,
            around: (camera.radius > 0.0).then(|| Around {
                planes: [Some(frame.view.eye), frame.view.second_eye].map(|eye| {
                    eye.map(|e| frustum_planes(&e, frame.view.validity_radius_m, origin))
                }),
                clamp_depth: camera.clamp_depth as f32,
            }),
        }
    }

    /// Answers for one of eight projected boxes. `object`: a single one, which may be too small, and whose
    /// faces are looked at where its rectangle does not say enough.
    #[inline(always)]
    pub(crate) fn answer<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
        object: bool,
    ) -> Visibility {
        if self.around.is_some() {
            return self.answer_around(l, p, i, boxes, object);
        }
        if p.outside >> i & 1 != 0 {
            return Visibility::Outside;
        }
        if self.is_small(i, boxes, object) {
            return Visibility::Small;
        }
        if p.crossing >> i & 1 != 0 {
            return self.answer_crossing(l, i, boxes);
        }
        if p.hidden >> i & 1 != 0 {
            return Visibility::Occluded;
        }
        if !self.occlusion {
            return Visibility::Visible;
        }
        let (rect, code) = rectangle(p, i);
        // Of a large group the members had better be asked.
        if !object && rect.block_count() > GROUP_BLOCKS {
            return Visibility::Visible;
        }
        // Where even the middle lies before all that is known, nothing closer will hide the box.
        let [x, y, middle] = [0, 1, 2].map(|k| p.middle[k][i]);
        let known = self.buffer.pixel(x as u32, y as u32);
        if middle > i32::from(known) {
            return Visibility::Visible;
        }
        let place = object.then(|| place(boxes, i));
        // Or where the ray through that pixel enters it.
        if let (Some(planes), Some((center, half))) = (&self.planes, place) {
            let sample = |v: i32| (v as f32 + 0.5) * SAMPLES as f32;
            if planes.entry(sample(x), sample(y), center, half) > known {
                return Visibility::Visible;
            }
        }
        self.answer_rect(l, rect, code, place)
    }

    /// What a first look is taken with, where frustum and summary alone tell what most boxes are.
    #[inline(always)]
    pub(super) fn sieve(&self) -> Option<Sieve<'a>> {
        (self.occlusion && self.around.is_none())
            .then(|| Sieve::new(&self.screen))
            .flatten()
    }

    /// Answers for a box of which looks at its middle and its corners say nothing, in plain frames.
    #[inline(always)]
    pub(super) fn answer_open<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
    ) -> Visibility {
        if p.crossing >> i & 1 != 0 {
            return self.answer_crossing(l, i, boxes);
        }
        let (rect, code) = rectangle(p, i);
        self.answer_rect(l, rect, code, Some(place(boxes, i)))
    }

    /// The same for a group, which is to be opened where that is the better way.
    #[inline(always)]
    pub(super) fn answer_group<L: Lanes>(
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
        self.answer_rect(l, rect, code, None)
    }

    #[inline(always)]
    fn is_small(&self, i: usize, boxes: &Boxes8, object: bool) -> bool {
        if !(object && self.small > 0.0) {
            return false;
        }
        let (c, h) = place(boxes, i);
        let [x, y, z, w] = self.screen.rows[3];
        // In the order in which lanes are added.
        let distance = (c.x * x + c.y * y) + (c.z * z + w);
        distance > 1.0 && h.length_squared() < distance * self.small
    }

    #[inline(always)]
    fn answer_rect<L: Lanes>(
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
        let faces = self.planes.as_ref().zip(place);
        if hidden(l, self.buffer, rect, code, faces) {
            Visibility::Occluded
        } else {
            Visibility::Visible
        }
    }

    #[inline(always)]
    fn answer_crossing<L: Lanes>(&self, l: L, i: usize, boxes: &Boxes8) -> Visibility {
        let (center, half) = place(boxes, i);
        if self.screen.is_beside(center, half + self.screen.grow) {
            return Visibility::Outside;
        }
        match clip_box(&self.screen, center, half + self.screen.grow) {
            Clipped::Outside => Visibility::Outside,
            Clipped::Visible => Visibility::Visible,
            Clipped::Rect(rect, depth) => {
                self.answer_rect(l, self.pixels(rect), encode(depth), Some((center, half)))
            }
        }
    }

    #[inline(always)]
    fn pixels(&self, samples: [f32; 4]) -> PixelRect {
        PixelRect::from_samples(samples, self.buffer.width, self.buffer.height)
    }

    /// The same for two eyes or a validity radius: the frusta are tested one by one, and what the buffer of
    /// the middle cannot answer for all of them is visible.
    #[inline(always)]
    fn answer_around<L: Lanes>(
        &self,
        l: L,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
        object: bool,
    ) -> Visibility {
        let Some(around) = &self.around else {
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
        if around.planes.iter().flatten().all(outside) {
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
        if cut && p.depth[i] >= around.clamp_depth {
            return Visibility::Visible;
        }
        let rect = self.pixels([p.x0[i], p.y0[i], p.x1[i], p.y1[i]]);
        self.answer_rect(l, rect, encode(p.depth[i]), None)
    }
}

impl Query<'_> {
    /// Whether a code lies before all that is known in a pixel.
    #[inline(always)]
    pub(super) fn before(&self, at: i32, code: i32) -> bool {
        code > i32::from(self.buffer.known(at as usize))
    }

    /// Whether any corner of a box that is all beyond the near plane lies before all that is known in its pixel.
    #[inline(always)]
    pub(super) fn corner_seen(&self, corners: &Corners8, i: usize) -> bool {
        let mut seen = false;
        for (at, code) in corners.at.iter().zip(&corners.code) {
            seen |= self.before(at[i], code[i]);
        }
        seen
    }
}

/// What a result that holds around the eye needs.
#[derive(Clone, Copy, Debug)]
struct Around {
    /// Of one or two eyes.
    planes: [Option<[[f32; 4]; 6]>; 2],
    clamp_depth: f32,
}

/// The rectangle of one of eight, and the code of its depth.
#[inline(always)]
fn rectangle(p: &Projected8, i: usize) -> (PixelRect, i16) {
    let [x0, y0, x1, y1] = p.pixels.map(|v| v[i] as u32);
    let code = p.code[i].clamp(-32768, 32767) as i16;
    (PixelRect { x0, y0, x1, y1 }, code)
}

/// Centre and half extent of one of eight.
#[inline(always)]
fn place(boxes: &Boxes8, i: usize) -> (Vec3, Vec3) {
    let [cx, cy, cz] = boxes.center;
    let [hx, hy, hz] = boxes.half;
    (
        Vec3::new(cx[i], cy[i], cz[i]),
        Vec3::new(hx[i], hy[i], hz[i]),
    )
}
