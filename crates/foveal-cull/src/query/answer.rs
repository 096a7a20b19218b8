//! From a projected box to an answer: frustum, size, then the depth buffer; for one eye, two, or a radius.

use super::near::{Clipped, clip_box};
use super::project::{Boxes8, Projected8, Screen, project};
use super::test::{PixelRect, hidden};
use crate::depth::{DepthBuffer, SAMPLES, encode};
use crate::simd::{Kernel, Lanes};
use crate::view::{Camera, frustum_planes};
use crate::{Aabb, View, Visibility};
use glam::{DVec3, Vec3};

/// Boxes grow by this on the screen before they are tested, samples (a quarter pixel each): more than all
/// rounding, and enough that a box which reaches an occluder's border also asks what is behind it.
const DILATE: f32 = 1.0;
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
    pub(crate) screen: Screen,
    pub(crate) occlusion: bool,
    /// `threshold² * tan(fov / 2)`.
    pub(crate) small: f32,
    /// For a result that holds around the eye.
    around: Option<Around>,
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
            dilate: DILATE,
            grow: 6e-7 * from_origin.length() as f32,
        };
        let t = f64::from(frame.occludee_size_threshold);
        Self {
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

    /// Centre and half extent for the kernels, grown against rounding; NaN for what is not a volume.
    #[inline(always)]
    pub(crate) fn prepare(b: &Aabb) -> (Vec3, Vec3) {
        let (center, half) = (b.center(), b.half_extent());
        let reach = center.abs().max_element() + half.max_element();
        let valid = b.min.cmple(b.max).all();
        (
            center,
            if valid {
                half + 6e-7 * reach
            } else {
                Vec3::NAN
            },
        )
    }

    /// Answers for one of eight projected boxes. `object`: a single one, which may be too small.
    #[inline(always)]
    pub(crate) fn answer(
        &self,
        p: &Projected8,
        i: usize,
        boxes: &Boxes8,
        object: bool,
    ) -> Visibility {
        if self.around.is_some() {
            return self.answer_around(p, i, boxes, object);
        }
        if p.outside >> i & 1 != 0 {
            return Visibility::Outside;
        }
        if self.is_small(i, boxes, object) {
            return Visibility::Small;
        }
        if p.crossing >> i & 1 != 0 {
            return self.answer_crossing(i, boxes);
        }
        self.answer_rect([p.x0[i], p.y0[i], p.x1[i], p.y1[i]], p.depth[i])
    }

    #[inline(always)]
    fn is_small(&self, i: usize, boxes: &Boxes8, object: bool) -> bool {
        if !(object && self.small > 0.0) {
            return false;
        }
        let (c, h) = place(boxes, i);
        let [x, y, z, w] = self.screen.rows[3];
        let distance = c.dot(Vec3::new(x, y, z)) + w;
        distance > 1.0 && h.length_squared() < distance * self.small
    }

    #[inline(always)]
    fn answer_rect(&self, [x0, y0, x1, y1]: [f32; 4], depth: f32) -> Visibility {
        if !self.occlusion {
            return Visibility::Visible;
        }
        let rect = PixelRect::from_samples(x0, y0, x1, y1, self.buffer.width, self.buffer.height);
        if hidden(self.buffer, rect, encode(depth)) {
            Visibility::Occluded
        } else {
            Visibility::Visible
        }
    }

    #[cold]
    fn answer_crossing(&self, i: usize, boxes: &Boxes8) -> Visibility {
        let (center, half) = place(boxes, i);
        match clip_box(&self.screen, center, half + self.screen.grow) {
            Clipped::Outside => Visibility::Outside,
            Clipped::Visible => Visibility::Visible,
            Clipped::Rect(rect, depth) => self.answer_rect(rect, depth),
        }
    }

    /// The same for two eyes or a validity radius: the frusta are tested one by one, and what the buffer of
    /// the middle cannot answer for all of them is visible.
    fn answer_around(&self, p: &Projected8, i: usize, boxes: &Boxes8, object: bool) -> Visibility {
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
        self.answer_rect([p.x0[i], p.y0[i], p.x1[i], p.y1[i]], p.depth[i])
    }
}

/// What a result that holds around the eye needs.
#[derive(Clone, Copy, Debug)]
struct Around {
    /// Of one or two eyes.
    planes: [Option<[[f32; 4]; 6]>; 2],
    clamp_depth: f32,
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

/// All boxes, eight at a time.
pub(crate) struct Flat<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) boxes: &'a [Aabb],
    pub(crate) results: &'a mut [Visibility],
}

impl Kernel for Flat<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        for (boxes, results) in self.boxes.chunks(8).zip(self.results.chunks_mut(8)) {
            let mut eight = Boxes8::NONE;
            for (i, b) in boxes.iter().enumerate() {
                let (c, h) = Query::prepare(b);
                eight.set(i, c, h);
            }
            let p = project(l, &self.query.screen, &eight);
            for (i, r) in results.iter_mut().enumerate() {
                *r = self.query.answer(&p, i, &eight, true);
            }
        }
    }
}
