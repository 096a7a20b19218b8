//! Receiver masks: which shadow casters can shade anything that the camera sees.
//!
//! Source: Bittner, Mattausch, Silvennoinen and Wimmer 2011, *Shadow caster culling for efficient
//! shadow mapping*; here on the CPU, from boxes.

use crate::bounds::Aabb;
use crate::camera::Camera;
use crate::error::CullError;
use crate::limits::MAX_SIDE_PX;
use crate::view::View;
use crate::visibility::Visibility;
use glam::{DVec3, DVec4};

/// Most cells along a side, and texels that a cell has at least.
const CELLS: u32 = 64;
const TEXELS: u32 = 2;
/// Texels by which a caster's rectangle is grown: what covers a texel in part may fill it.
const ROUNDING_TEXELS: f64 = 1.0;
/// Part of a distance within which near and far plane count as touched: boxes are rounded to `f32`.
const ROUNDING: f64 = 1e-6;
/// Part of a caster's distance by which a receiver may lie before it and still be behind it: shadow
/// maps round depth.
const DEPTH_STEP: f64 = 1e-4;
/// A corner that many times as far away as the near plane is too far to find where an edge crosses
/// that plane; and the least such distance, metres.
const TOO_FAR: f64 = 1e9;
const TOO_FAR_M: f64 = 1e6;

/// The places of one shadow map where a shadow can be seen, and how far from the light they are.
///
/// First the camera's [`Culler`](crate::Culler) says which boxes are visible: the receivers.
/// [`receive`](Self::receive) enters them. [`cull`](Self::cull) then leaves out casters whose shadows
/// fall on none of them.
///
/// Leaving casters out changes no lookup in the shadow map for a place in a receiver's box that the
/// light's view shows, as long as lookups read no farther than the [reach](Self::with_reach), compare
/// planar depth texel by texel, and stay within one map. Places before the near plane, beyond the far
/// plane and beside the map have no shadow here. Give a bias towards the light, and depth steps above a
/// ten thousandth of the distance, as metres of reach; filters across the seams of a cube need a wider
/// view. About 0.1 microseconds a box.
///
/// ```
/// use foveal_cull::*;
///
/// // A lamp above the ground, which shines down. Of the ground only the part at x = 3 is seen.
/// let down = Projection::perspective(1.6, 1.0, 0.1, 20.0);
/// let lamp = Eye::look_at([0.0, 5.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0], down);
/// let ground = [Aabb::new([2.0, -0.1, -1.0], [4.0, 0.0, 1.0])];
/// let mut mask = ReceiverMask::new(&View::mono(lamp), 512)?;
/// mask.receive(&ground, [0.0; 3], &[Visibility::Visible])?;
///
/// // A crate between the lamp and that part, one on the other side, and one below the ground.
/// let crates = [[2.0, 1.0], [-2.0, 1.0], [3.0, -2.0]]
///     .map(|[x, y]| Aabb::new([x - 0.2, y, -0.2], [x + 0.2, y + 0.4, 0.2]));
/// let mut results = [Visibility::Visible; 3];
/// mask.cull(&crates, [0.0; 3], &mut results)?;
/// assert_eq!(results.map(Visibility::is_visible), [true, false, false]);
/// # Ok::<(), CullError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ReceiverMask {
    /// The light, with the shadow map's texels for samples.
    camera: Camera,
    far_m: f64,
    /// Side of the shadow map, texels.
    side: f64,
    cells: usize,
    reach_texels: f64,
    reach_m: f64,
    /// The farthest receiver in each cell, row by row, metres along the light's axis.
    farthest: Vec<f64>,
}

/// The part of a shadow map that a box covers.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    /// Left, top, right and bottom edge, texels.
    rect: [f64; 4],
    /// Distances along the light's axis, metres.
    nearest: f64,
    farthest: f64,
}

impl ReceiverMask {
    /// An empty mask for a square shadow map of so many texels per side, as a light sees it: one
    /// view for a spot light or a cascade, six for a point light. A second eye and a validity radius
    /// of the view count nothing.
    ///
    /// # Errors
    /// [`CullError::BadView`] or [`CullError::NotFinite`] for a bad view,
    /// [`CullError::BadShadowMap`] for a side of 0 texels or of more than four times
    /// [`MAX_SIDE_PX`].
    pub fn new(light: &View, shadow_map_px: u32) -> Result<Self, CullError> {
        let camera = camera_of(light, shadow_map_px)?;
        Ok(Self::of(camera, light, shadow_map_px, Vec::new()))
    }

    /// Empties the mask and takes another shadow map for it: what [`new`](Self::new) makes, with the
    /// reach and the memory of this one. After an error the mask is as it was.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn reset(&mut self, light: &View, shadow_map_px: u32) -> Result<(), CullError> {
        let camera = camera_of(light, shadow_map_px)?;
        let memory = core::mem::take(&mut self.farthest);
        let (texels, metres) = (self.reach_texels, self.reach_m);
        *self = Self::of(camera, light, shadow_map_px, memory).with_reach(texels, metres);
        Ok(())
    }

    fn of(camera: Camera, light: &View, shadow_map_px: u32, mut memory: Vec<f64>) -> Self {
        let cells = (shadow_map_px / TEXELS).clamp(1, CELLS) as usize;
        memory.clear();
        memory.resize(cells * cells, f64::NEG_INFINITY);
        Self {
            camera,
            far_m: light.eye.projection.near_far_m()[1],
            side: f64::from(shadow_map_px),
            cells,
            reach_texels: 2.0,
            reach_m: 0.0,
            farthest: memory,
        }
    }

    /// The same mask for lookups that read up to so many texels beside a place, for instance half
    /// the width of a filter and a texel more, after moving the place by up to so many metres, for
    /// instance along its normal. 2 texels and 0 metres by default. NaN and negative numbers count as
    /// 0. Set it before [`receive`](Self::receive): receivers that were entered keep the old reach.
    #[must_use]
    pub fn with_reach(mut self, texels: f64, metres: f64) -> Self {
        self.set_reach(texels, metres);
        self
    }

    /// Sets what [`with_reach`](Self::with_reach) says, for receivers that are entered from now on.
    pub fn set_reach(&mut self, texels: f64, metres: f64) {
        self.reach_texels = texels.max(0.0);
        self.reach_m = metres.max(0.0);
    }

    /// Empties the mask.
    pub fn clear(&mut self) {
        self.farthest.fill(f64::NEG_INFINITY);
    }

    /// Whether no receiver meets the shadow map, which then need not be drawn. The light may still
    /// light what lies before its near plane, beyond its far plane, or beside its maps.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.farthest.iter().all(|far| *far == f64::NEG_INFINITY)
    }

    /// Enters receivers: the boxes, in metres relative to `origin` (world), that `results` call
    /// visible. Boxes that are not volumes are everywhere.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if there are not as many results as boxes.
    pub fn receive(
        &mut self,
        boxes: &[Aabb],
        origin: impl Into<[f64; 3]>,
        results: &[Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(boxes.len(), results.len())?;
        let from = DVec3::from(origin.into()) - self.camera.eye;
        for (bounds, _) in boxes.iter().zip(results).filter(|(_, r)| r.is_visible()) {
            let Some(seen) = self.footprint(bounds, from, self.reach_m) else {
                continue;
            };
            let [columns, rows] = self.cells_of(&seen, self.reach_texels + ROUNDING_TEXELS);
            for row in rows {
                let first = row * self.cells;
                for far in &mut self.farthest[first + columns.start..first + columns.end] {
                    *far = far.max(seen.farthest);
                }
            }
        }
        Ok(())
    }

    /// Leaves out casters: of the boxes that `results` call visible, those outside the shadow map
    /// become [`Outside`](Visibility::Outside), and those whose shadows fall on no receiver
    /// [`Occluded`](Visibility::Occluded). Other results stay, so that those of
    /// [`Culler::query`](crate::Culler::query) with the light's view go in: casters that others hide
    /// from the light. That culler must be made by
    /// [`Culler::for_picture`](crate::Culler::for_picture) with the map's side, and its view by
    /// [`View::for_picture`], so that its samples are the map's texels. Boxes that are not volumes
    /// stay visible.
    ///
    /// The map must draw the faces that the culler's occluders hide with: front faces, and both
    /// faces of two-sided ones. For a map of back faces only the occluders must be one-sided and
    /// closed, or shadows are lost.
    ///
    /// What lies before the light's near plane casts no shadow here: let the near plane lie before
    /// all casters, also where the shadow map is drawn with depth clamp.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if there are not as many results as boxes.
    pub fn cull(
        &self,
        boxes: &[Aabb],
        origin: impl Into<[f64; 3]>,
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(boxes.len(), results.len())?;
        let from = DVec3::from(origin.into()) - self.camera.eye;
        for (bounds, result) in boxes.iter().zip(results) {
            if !result.is_visible() {
                continue;
            }
            *result = match self.footprint(bounds, from, 0.0) {
                None => Visibility::Outside,
                Some(cast) if self.shades(&cast) => Visibility::Visible,
                Some(_) => Visibility::Occluded,
            };
        }
        Ok(())
    }

    /// Whether any receiver lies behind a caster.
    fn shades(&self, cast: &Footprint) -> bool {
        // Minus infinity, of what is everywhere, stays what it is.
        let nearest = cast.nearest - (DEPTH_STEP * cast.nearest).abs().min(1e9);
        let [columns, mut rows] = self.cells_of(cast, ROUNDING_TEXELS);
        rows.any(|row| {
            let first = row * self.cells;
            let cells = &self.farthest[first + columns.start..first + columns.end];
            cells.iter().any(|far| *far >= nearest)
        })
    }

    /// The columns and rows of cells that a footprint touches, grown by so many texels. What lies
    /// beyond the edge belongs to the cells there.
    fn cells_of(&self, of: &Footprint, grow: f64) -> [core::ops::Range<usize>; 2] {
        let [left, top, right, bottom] = of.rect;
        let cell = |texel: f64| {
            let at = texel * (self.cells as f64 / self.side);
            at.clamp(0.0, (self.cells - 1) as f64) as usize
        };
        let range = |low: f64, high: f64| cell(low - grow)..cell(high + grow) + 1;
        [range(left, right), range(top, bottom)]
    }

    /// The part of the shadow map that a box covers, which lies relative to `from`, and grows by so
    /// many metres. None where it covers nothing.
    fn footprint(&self, bounds: &Aabb, from: DVec3, grow_m: f64) -> Option<Footprint> {
        if !bounds.is_valid() {
            return Some(Footprint::EVERYWHERE);
        }
        let low = DVec3::from(bounds.min.map(f64::from)) + from - grow_m;
        let high = DVec3::from(bounds.max.map(f64::from)) + from + grow_m;
        let far_off = (TOO_FAR * self.camera.near.abs()).max(TOO_FAR_M);
        if low.abs().max(high.abs()).max_element() >= far_off {
            return Some(Footprint::EVERYWHERE);
        }
        let corners: [DVec4; 8] = core::array::from_fn(|i| {
            let pick = |k: usize| if i >> k & 1 != 0 { high[k] } else { low[k] };
            self.corner(DVec3::new(pick(0), pick(1), pick(2)))
        });
        if !corners.iter().all(|corner| corner.is_finite()) {
            return Some(Footprint::EVERYWHERE);
        }
        let mut all = Footprint::NOWHERE;
        let [near, far] = self.depth_range(from.length());
        for (i, a) in corners.iter().enumerate() {
            if a.z >= near {
                all.add(*a);
            }
            // The edges that leave this corner, where the near plane cuts them.
            for b in [1, 2, 4].map(|k| i ^ k).into_iter().filter(|b| *b > i) {
                let b = corners[b];
                if (a.z < near) != (b.z < near) {
                    all.add(*a + (b - *a) * ((near - a.z) / (b.z - a.z)));
                }
            }
        }
        let [left, top, right, bottom] = all.rect;
        let edge = self.reach_texels + 2.0 * ROUNDING_TEXELS;
        let beside = right < -edge
            || bottom < -edge
            || left > self.side + edge
            || top > self.side + edge
            || all.nearest > far;
        // Nothing beyond the near plane: no corner was added.
        (all.nearest <= all.farthest && !beside).then_some(all)
    }

    /// Near and far plane, moved apart by what boxes may be rounded by whose origin is so far away.
    fn depth_range(&self, origin_m: f64) -> [f64; 2] {
        let slack = |plane: f64| ROUNDING * (plane.abs() + origin_m);
        let (near, far) = (self.camera.near, self.far_m);
        // Before the eye nothing has a place in a perspective.
        let parallel = self.camera.rows[3].truncate() == DVec3::ZERO;
        let least = if parallel {
            f64::NEG_INFINITY
        } else {
            0.5 * near
        };
        [(near - slack(near)).max(least), far + slack(far)]
    }

    /// A corner relative to the light: X and Y times W in texels, the distance along the axis, W.
    fn corner(&self, p: DVec3) -> DVec4 {
        let [x, y, _, w] = self.camera.rows;
        let p1 = p.extend(1.0);
        DVec4::new(x.dot(p1), y.dot(p1), self.camera.forward.dot(p), w.dot(p1))
    }
}

impl Footprint {
    /// What is no volume, or cannot be computed with.
    const EVERYWHERE: Self = Self {
        rect: [
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::INFINITY,
        ],
        nearest: f64::NEG_INFINITY,
        farthest: f64::INFINITY,
    };
    const NOWHERE: Self = Self {
        rect: [
            f64::INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
        ],
        nearest: f64::INFINITY,
        farthest: f64::NEG_INFINITY,
    };

    /// Widens it by a corner beyond the near plane.
    fn add(&mut self, corner: DVec4) {
        let [x, y] = [corner.x / corner.w, corner.y / corner.w];
        let [left, top, right, bottom] = self.rect;
        self.rect = [left.min(x), top.min(y), right.max(x), bottom.max(y)];
        self.nearest = self.nearest.min(corner.z);
        self.farthest = self.farthest.max(corner.z);
    }
}

/// The light, with the shadow map's texels for samples.
fn camera_of(light: &View, shadow_map_px: u32) -> Result<Camera, CullError> {
    if !(1..=4 * MAX_SIDE_PX).contains(&shadow_map_px) {
        return Err(CullError::BadShadowMap {
            side_px: shadow_map_px,
        });
    }
    let side = f64::from(shadow_map_px);
    Camera::new(&View::mono(light.eye), side, side)
}
