//! Which tiles a frame wants, and how large: a function of lights, view, gaze, settings and the box of
//! the scene in its pose alone, so that the picture does not depend on what was drawn before, nor on
//! culling.

use std::collections::BTreeSet;

use foveal_scene::Aabb;
use glam::{Mat4, Vec3, Vec4};

use super::atlas::LEAST_LEVEL;
use super::part::part_of_picture;
use super::volume::{BORDER, Volume, axes_along, cube_axes, frustum_planes};
use crate::Settings;
use crate::lights::LightUniform;
use crate::rate::FinestRate;
use crate::stereo::Eye;

/// Tiles that a light may have: the sides of a cube, or cascades.
pub(super) const TILES_PER_LIGHT: usize = 6;
/// Cascades of a directional light.
pub(super) const CASCADES: usize = 4;
/// Each cascade is wider by this factor than the one before.
const CASCADE_STEP: i32 = 2;
/// Cascades move in steps of this part of their radius, and hold everything within
/// `1 - CASCADE_MOVE / 2` of it around the eye, or around the place of the scene's box that is nearest
/// to the eye.
const CASCADE_MOVE: f32 = 0.25;
/// Largest tiles, as powers of two: a cube's side, a spot light's, a cascade.
const LARGEST_SIDE: u32 = 9;
const LARGEST_SPOT: u32 = 10;
const LARGEST_CASCADE: u32 = 10;
/// Powers of two by which other tiles have shrunk before cascades do: directional lights shine on
/// everything.
const CASCADES_LAST: f32 = 1.0;
/// Cones wider than this have a cube's sides (tangent of the half angle).
const WIDEST_SPOT: f32 = 2.0;
/// Distance from the light, as part of its range, where most of its shadows are seen.
const TYPICAL_DISTANCE: f32 = 0.3;
/// Sizes shrink by the least of so many parts of a power of two at which all fit: from one to the next
/// few tiles change their size.
const SHRINK_PARTS: u32 = 32;
/// Most powers of two by which they shrink: to the least size.
const MOST_SHRUNK: u32 = 16;

/// A tile that a frame wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    /// Light and its tile: `light * TILES_PER_LIGHT + tile`.
    pub(super) slot: u32,
    pub(super) level: u32,
    pub(super) volume: Volume,
    /// It is coarser than the view alone asks for.
    pub(super) follows_rate: bool,
}

/// What the wanted tiles follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewOfPlan {
    clip_from_world: [Mat4; 2],
    /// Between the eyes.
    center: Vec3,
    /// Metres that a texel is to cover where most of a light's shadows are seen, at a distance of
    /// one metre from the eye, or at any where rays are parallel.
    texel: f32,
    orthographic: bool,
    eyes: [Eye; 2],
    /// Part of the picture by which points and lines reach into it from beside.
    beside: f32,
    /// How finely parts of the picture are shaded, where tiles are to be as coarse.
    rates: Option<FinestRate>,
}

impl ViewOfPlan {
    pub(super) fn new(eyes: &[Eye; 2], settings: &Settings, rates: Option<FinestRate>) -> Self {
        let widest = (settings.geometry.point_size_px).max(settings.geometry.line_width_px);
        // Of the denser eye.
        let [left, right] = [0, 1].map(|eye: usize| eyes[eye].view_from_ndc()[1].abs());
        let pixel = 2.0 * left.min(right) / settings.picture.height as f32;
        Self {
            clip_from_world: [eyes[0].clip_from_world(), eyes[1].clip_from_world()],
            center: 0.5 * (eyes[0].position() + eyes[1].position()),
            texel: pixel * settings.lighting.shadow_texel_px,
            orthographic: eyes[0].orthographic,
            eyes: *eyes,
            beside: widest / settings.picture.width.min(settings.picture.height) as f32,
            rates,
        }
    }

    /// The planes of what the eyes see, and of what reaches into it.
    fn planes(&self) -> [[Vec4; 6]; 2] {
        let shrink = 1.0 / (1.0 + self.beside);
        let shrink = Mat4::from_scale(Vec3::new(shrink, shrink, 1.0));
        self.clip_from_world
            .map(|clip| frustum_planes(shrink * clip))
    }

    /// Powers of two by which samples are farther apart than pixels wherever a tile's shadows are
    /// seen.
    fn coarser_by(&self, volume: &Volume) -> f32 {
        let Some(rates) = &self.rates else {
            return 0.0;
        };
        let of_eye = |eye: usize| {
            let part = part_of_picture(volume, &self.eyes[eye])?;
            Some(rates.level_within(eye, part))
        };
        let alike = self.eyes[0] == self.eyes[1] && rates.is_alike();
        let eyes = if alike { 1 } else { 2 };
        // What no eye sees is as coarse as it gets.
        let finest = (0..eyes).filter_map(of_eye).min();
        finest.unwrap_or(rates.coarsest()) as f32
    }

    fn texel_at(&self, distance: f32) -> f32 {
        if self.orthographic {
            self.texel
        } else {
            self.texel * distance
        }
    }
}

/// The tiles that a frame wants, in an atlas of `2^atlas_level` texels a side.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// By slot.
    pub(super) wanted: Vec<Wanted>,
    /// Slots of tiles for which there is no room.
    left_out: BTreeSet<u32>,
    /// By how many powers of two tiles are smaller than the view asks for.
    pub(super) shrunk_by: f32,
}

/// A tile before its size is settled.
struct Request {
    slot: u32,
    /// Power of two, not whole.
    level: f32,
    /// The same by the view alone.
    level_by_view: f32,
    largest: u32,
    volume: Volume,
}

impl Plan {
    /// `scene`: the box around everything that casts or receives shadows.
    pub(super) fn new(
        lights: &[LightUniform],
        view: &ViewOfPlan,
        scene: &Aabb,
        atlas_level: u32,
    ) -> Self {
        let planes = view.planes();
        let mut requests = Vec::new();
        for (number, light) in (0..).zip(lights) {
            let slot = number * TILES_PER_LIGHT as u32;
            if light.is_directional() {
                cascades(light, view, scene, slot, &mut requests);
            } else {
                sides(light, view, &planes, slot, &mut requests);
            }
        }
        settle(requests, atlas_level)
    }

    /// Those of another plan's tiles for which this one has no room.
    pub(super) fn left_out_of<'a>(&self, wanted: &'a [Wanted]) -> impl Iterator<Item = &'a Wanted> {
        let is_out = |want: &&Wanted| self.left_out.contains(&want.slot);
        wanted.iter().filter(is_out)
    }

    /// Lights that some tile would have held, had there been room.
    pub(super) fn lights_left_out(&self) -> usize {
        let light = |slot: &u32| slot / TILES_PER_LIGHT as u32;
        let lights: BTreeSet<u32> = self.left_out.iter().map(light).collect();
        lights.len()
    }
}

fn unit_area(level: u32) -> u64 {
    1 << (2 * level)
}

/// Finds the sizes at which all fit: all shrink alike; where not even the smallest fit, the tiles
/// that would have been the smallest are left out.
fn settle(mut requests: Vec<Request>, atlas_level: u32) -> Plan {
    let room = unit_area(atlas_level);
    // No tile takes more than a sixteenth.
    let most = atlas_level - 2;
    let whole = |r: &Request, level: f32, shrunk: f32| {
        let level = (level - shrunk + 0.5).floor().max(LEAST_LEVEL as f32) as u32;
        level.min(r.largest.min(most).max(LEAST_LEVEL))
    };
    let level_of = |r: &Request, shrunk: f32| whole(r, r.level, shrunk);
    let area = |requests: &[Request], shrunk: f32| -> u64 {
        requests
            .iter()
            .map(|r| unit_area(level_of(r, shrunk)))
            .sum()
    };
    let shrunk = |parts: u32| parts as f32 / SHRINK_PARTS as f32;
    let fits = |parts: u32| area(&requests, shrunk(parts)) <= room;
    // More than `low`, at most `high`; where all fits there is nothing to find.
    let (mut low, mut high) = (0, MOST_SHRUNK * SHRINK_PARTS);
    while low < high && !fits(0) {
        let middle = low.midpoint(high);
        (low, high) = if fits(middle) {
            (low, middle)
        } else {
            (middle + 1, high)
        };
    }
    let shrunk_by = shrunk(low);
    let mut left_out = BTreeSet::new();
    if area(&requests, shrunk_by) > room {
        requests.sort_by(|a, b| b.level.total_cmp(&a.level).then(a.slot.cmp(&b.slot)));
        let fitting = (room / unit_area(LEAST_LEVEL)) as usize;
        let out = requests.split_off(fitting.min(requests.len()));
        left_out = out.iter().map(|r| r.slot).collect();
        requests.sort_by_key(|r| r.slot);
    }
    Plan {
        wanted: requests
            .iter()
            .map(|r| Wanted {
                slot: r.slot,
                level: level_of(r, shrunk_by),
                volume: r.volume,
                follows_rate: level_of(r, shrunk_by) < whole(r, r.level_by_view, shrunk_by),
            })
            .collect(),
        left_out,
        shrunk_by,
    }
}

/// The nearest distance from which things are drawn into a light's tiles: `shadow_near` in
/// `shadow/lookup.wgsl`.
pub(super) fn near_of(light: &LightUniform) -> f32 {
    (light.range * 1e-3).clamp(1e-4, 0.02)
}

/// Half the width of a spot light's tile at distance 1; `None` where it needs a cube's sides.
pub(super) fn spot_tangent(light: &LightUniform) -> Option<f32> {
    let tangent = light.cone_sin / light.cone_cos.max(1e-6);
    (light.kind == 2 && light.cone_cos > 0.0 && tangent <= WIDEST_SPOT).then_some(tangent.max(1e-3))
}

/// The tiles of a point or spot light that may be seen.
fn sides(
    light: &LightUniform,
    view: &ViewOfPlan,
    planes: &[[Vec4; 6]; 2],
    slot: u32,
    requests: &mut Vec<Request>,
) {
    if light.radiant.iter().all(|&c| c <= 0.0) || !(light.range > 0.0 && light.range.is_finite()) {
        return;
    }
    let apex = Vec3::from(light.position);
    // Where most of its shadows are seen, seen from as near as they may be.
    let typical = TYPICAL_DISTANCE * light.seen_m;
    let away = (apex.distance(view.center) - typical).max(0.5 * typical);
    let wanted_texel = view.texel_at(away);
    let spot = spot_tangent(light);
    let tangent = spot.unwrap_or(1.0);
    // Texels without the border.
    let inner = 2.0 * tangent * typical / wanted_texel;
    let pyramid = |axes| Volume::Pyramid {
        apex,
        axes,
        tangent,
        range: light.range,
        near: near_of(light),
    };
    let in_view = |volume: &Volume| planes.iter().any(|p| volume.is_in_view(p));
    let volumes: Vec<(u32, Volume)> = match spot {
        Some(_) => vec![(0, pyramid(axes_along(light.direction.into())))],
        None => (0..6)
            .map(|side| (side, pyramid(cube_axes(side))))
            .collect(),
    };
    for (tile, volume) in volumes {
        if in_view(&volume) {
            let level = |inner: f32| (inner + 2.0 * BORDER).max(1.0).log2();
            requests.push(Request {
                slot: slot + tile,
                level: level(inner / view.coarser_by(&volume).exp2()),
                level_by_view: level(inner),
                largest: if spot.is_some() {
                    LARGEST_SPOT
                } else {
                    LARGEST_SIDE
                },
                volume,
            });
        }
    }
}

/// The cascades of a directional light: squares around the eye, or around the place of the scene that
/// is nearest to it, each four times as wide as the one before; the last one holds the scene. They
/// move in steps, so that they stay as they are while the eye turns or moves a little.
fn cascades(
    light: &LightUniform,
    view: &ViewOfPlan,
    scene: &Aabb,
    slot: u32,
    requests: &mut Vec<Request>,
) {
    if light.radiant.iter().all(|&c| c <= 0.0) || !scene.is_valid() {
        return;
    }
    let axes = axes_along(light.direction.into());
    let around = view.center.clamp(scene.min, scene.max);
    let (center, half) = (scene.center(), scene.half_extent());
    let extent = |axis: Vec3| (axis.dot(center), axis.abs().dot(half));
    let (along, reach) = extent(axes[2]);
    // Whole steps: as boxes of moving things grow and shrink, most frames have the same.
    let step = 2.0_f32.powi((reach.max(1e-3) * 0.125).log2().ceil() as i32);
    let begin = ((along - reach) / step).floor() * step - 0.01 * step;
    let end = ((along + reach) / step).ceil() * step + 0.01 * step;
    let farthest = (0..2)
        .map(|i| {
            let (at, reach) = extent(axes[i]);
            (axes[i].dot(around) - at).abs() + reach
        })
        .fold(0.0, f32::max);
    let held = 1.0 - 0.5 * CASCADE_MOVE - 0.05;
    let last = (farthest.max(1e-2) / held).log2().ceil() as i32;
    for cascade in 0..CASCADES {
        let radius = 2.0_f32.powi(last - CASCADE_STEP * (CASCADES - 1 - cascade) as i32);
        let step = radius * CASCADE_MOVE;
        let snapped = |axis: Vec3| (axis.dot(around) / step).round() * step;
        requests.push(Request {
            slot: slot + cascade as u32,
            level: LARGEST_CASCADE as f32 + CASCADES_LAST,
            level_by_view: LARGEST_CASCADE as f32 + CASCADES_LAST,
            largest: LARGEST_CASCADE,
            volume: Volume::Column {
                axes,
                center: [snapped(axes[0]), snapped(axes[1])],
                radius,
                span: [begin, end],
            },
        });
    }
}

#[cfg(test)]
mod tests;
