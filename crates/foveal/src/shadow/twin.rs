//! The CPU twin of `shadow/lookup.wgsl`.

use glam::{Vec2, Vec3};

use super::records::{CONTACT_REACH, LookupSettings, ROWS, Row};
use super::volume::{BORDER, axes_along, cube_axes};
use crate::Shadows;
use crate::lights::LightUniform;
use crate::shading::twin::{ALL_ARRIVES, Arriving};

/// What the shader looks up.
pub(crate) struct Lookup {
    pub(crate) rows: Vec<Row>,
    /// Texels of the atlas, row by row.
    pub(crate) atlas: Vec<f32>,
    pub(crate) side: u32,
    pub(super) settings: LookupSettings,
}

pub(super) struct ShadowTile {
    corner: [u32; 2],
    side: u32,
    is_narrow: bool,
}

/// Where a light's rays to a surface are looked up: `ShadowPlace` in the shader.
struct Place {
    tile: ShadowTile,
    at: Vec2,
    depth: f32,
    softness: f32,
    /// Place and depth of each pixel at the rim that counts.
    rim: Vec<(Vec2, f32)>,
}

/// `Block` in `shared/light.wgsl`: what the pixels at a block's rim show, those that count, from the
/// sample's place.
pub(crate) type Rim = [Vec3];

fn tile_of(word: u32) -> Option<ShadowTile> {
    (word != 0).then(|| ShadowTile {
        corner: [(word & 0x3ff) * 16, (word >> 10 & 0x3ff) * 16],
        side: 1 << (word >> 20 & 31),
        is_narrow: word >> 25 & 1 != 0,
    })
}

/// Places that `shadow/contact.wgsl` looks at, and compares.
/// Of `shadow/lookup.wgsl`.
const VARIANCE_OF_APART: f32 = 0.2;
const SEARCHED: usize = 16;
const COMPARED: usize = 24;

/// Unit vectors, each turned by the golden angle from the one before.
fn golden_spiral() -> impl Iterator<Item = Vec2> {
    let by = Vec2::new(-0.737_368_9, 0.675_490_3);
    std::iter::successors(Some(Vec2::X), move |d| Some(by.rotate(*d)))
}

impl Lookup {
    fn row(&self, row: usize) -> [f32; 4] {
        self.rows[row].map(f32::from_bits)
    }

    fn passes(&self, tile: &ShadowTile, x: u32, y: u32, depth: f32) -> f32 {
        let [left, top] = tile.corner;
        let nearest = self.atlas[((top + y) * self.side + left + x) as usize];
        f32::from(u8::from(depth >= nearest))
    }

    fn passing(&self, tile: &ShadowTile, at: Vec2, depth: f32, softness: f32) -> f32 {
        let side = tile.side as f32;
        if self.settings.shadows == Shadows::Contact {
            return self.contact_passing(tile, at, depth, softness);
        }
        if self.settings.shadows == Shadows::Hard {
            let inside = at.floor().clamp(Vec2::ZERO, Vec2::splat(side - 1.0));
            return self.passes(tile, inside.x as u32, inside.y as u32, depth);
        }
        // The mean of three by three comparisons a texel apart, each blended between four texels;
        // one of them where the filter is narrow.
        let inside = at.clamp(Vec2::splat(2.0), Vec2::splat(side - 2.0));
        let mut sum = 0.0;
        let taps = if tile.is_narrow { 4..5 } else { 0..9 };
        let count = taps.len() as f32;
        for (i, j) in taps.map(|k| (k % 3, k / 3)) {
            let p = inside + Vec2::new(i as f32, j as f32) - 1.5;
            let low = p.floor();
            let f = p - low;
            let at = |x: u32, y: u32| {
                // A texel beyond the last has no weight.
                let [x, y] = [low.x as u32 + x, low.y as u32 + y].map(|v| v.min(tile.side - 1));
                self.passes(tile, x, y, depth)
            };
            let upper = at(0, 0) * (1.0 - f.x) + at(1, 0) * f.x;
            let lower = at(0, 1) * (1.0 - f.x) + at(1, 1) * f.x;
            sum += upper * (1.0 - f.y) + lower * f.y;
        }
        sum / count
    }

    /// `mean_softness` in `shadow/contact.wgsl`.
    fn mean_softness(&self, tile: &ShadowTile, at: Vec2, depth: f32, softness: f32) -> f32 {
        let (mut sum, mut found) = (0.0, 0.0);
        for (i, direction) in golden_spiral().take(SEARCHED).enumerate() {
            let radius = CONTACT_REACH * (i as f32 + 0.5) / SEARCHED as f32;
            let last = Vec2::splat(tile.side as f32 - 1.0);
            let texel = (at + radius * direction).floor().clamp(Vec2::ZERO, last);
            let [left, top] = tile.corner;
            let row = (top + texel.y as u32) * self.side;
            let nearest = self.atlas[(row + left + texel.x as u32) as usize];
            let fade = (nearest - depth) * softness;
            if fade > radius {
                (sum, found) = (sum + fade, found + 1.0);
            }
        }
        sum / f32::max(found, 1.0)
    }

    /// `compared_at` in `shadow/contact.wgsl`.
    fn compared_at(&self, tile: &ShadowTile, at: Vec2, depth: f32) -> f32 {
        let side = tile.side as f32;
        let inside = at.clamp(Vec2::ONE, Vec2::splat(side - 1.0)) - 0.5;
        let first = inside.floor().min(Vec2::splat(side - 2.0));
        let f = inside - first;
        let at = |x: u32, y: u32| self.passes(tile, first.x as u32 + x, first.y as u32 + y, depth);
        let upper = at(0, 0) * (1.0 - f.x) + at(1, 0) * f.x;
        let lower = at(0, 1) * (1.0 - f.x) + at(1, 1) * f.x;
        upper * (1.0 - f.y) + lower * f.y
    }

    /// `contact_passing` in `shadow/contact.wgsl`.
    fn contact_passing(&self, tile: &ShadowTile, at: Vec2, depth: f32, softness: f32) -> f32 {
        let fades = self.mean_softness(tile, at, depth, softness);
        let reach = fades.clamp(1.0, CONTACT_REACH);
        let slack = if fades > 1.0 {
            0.5 * reach / softness
        } else {
            0.0
        };
        let compared = golden_spiral().take(COMPARED).enumerate();
        let sum: f32 = compared
            .map(|(i, direction)| {
                let part = ((i as f32 + 0.5) / COMPARED as f32).sqrt();
                self.compared_at(tile, at + reach * part * direction, depth + slack * part)
            })
            .sum();
        sum / COMPARED as f32
    }

    fn pyramid_softness(&self, near: f32, tangent: f32, inner: f32, height: f32) -> f32 {
        self.settings.light_radius_m.min(0.5 * height) * (0.5 * inner) / (tangent * near)
    }

    fn offset(&self, tile: &ShadowTile, texel_m: f32, cosine: f32) -> f32 {
        let slope = (1.0 - cosine * cosine).max(0.0).sqrt();
        let filter = if tile.is_narrow && self.settings.shadows != Shadows::Contact {
            0.5
        } else {
            1.0
        };
        texel_m * self.settings.texels_moved * (0.4 + slope) * filter
    }

    /// Part of a light that reaches a surface's sample, by position and vertex normal.
    pub(crate) fn light_passing(
        &self,
        index: usize,
        light: &LightUniform,
        surface: (Vec3, Vec3),
    ) -> f32 {
        self.light_arriving(index, light, surface, &[]).part
    }

    /// `directional_arriving` and `light_arriving` in the shader.
    pub(crate) fn light_arriving(
        &self,
        index: usize,
        light: &LightUniform,
        surface: (Vec3, Vec3),
        rim: &Rim,
    ) -> Arriving {
        let first = index * ROWS;
        let place = if light.is_directional() {
            self.place_from_sun(first, Vec3::from(light.direction), surface, rim)
        } else {
            self.place_from_point(first, light, surface, rim)
        };
        let Some(place) = place else {
            return ALL_ARRIVES;
        };
        let passing = |(at, depth): &(Vec2, f32)| self.compared_at(&place.tile, *at, *depth);
        let part = self.passing(&place.tile, place.at, place.depth, place.softness);
        let apart = place.rim.iter().map(|at| (passing(at) - part).abs());
        Arriving {
            part,
            variance: VARIANCE_OF_APART * apart.fold(0.0, f32::max),
        }
    }

    fn place_from_point(
        &self,
        first: usize,
        light: &LightUniform,
        (position, normal): (Vec3, Vec3),
        rim: &Rim,
    ) -> Option<Place> {
        let from_light = position - Vec3::from(light.position);
        let near = super::plan::near_of(light);
        let spot = self.row(first)[3];
        let side = side_of_cube(from_light);
        let axes = match spot > 0.0 {
            true => axes_along(light.direction.into()),
            false => cube_axes(side),
        };
        let word = self.rows[first + side as usize / 3][side as usize % 3];
        let tile = tile_of(word)?;
        let tangent = if spot > 0.0 { spot } else { 1.0 };
        let inner = tile.side as f32 - 2.0 * BORDER;
        let texel_m = 2.0 * tangent * axes[2].dot(from_light) / inner;
        let moved = from_light + normal * self.offset(&tile, texel_m, axes[2].dot(normal));
        let at = Vec3::from(axes.map(|axis| axis.dot(moved)));
        if at.z <= near {
            return None;
        }
        let place = Vec2::new(at.x, -at.y) * (0.5 * inner / (at.z * tangent));
        let height = f32::max(-normal.dot(from_light), 0.0);
        let seen = |offset: &Vec3| {
            let p = at + Vec3::from(axes.map(|axis| axis.dot(*offset)));
            let in_tile = Vec2::new(p.x, -p.y) / (p.z * tangent);
            let is_inside = p.z > near && in_tile.abs().max_element() <= 1.0;
            let texel = 0.5 * tile.side as f32 + 0.5 * inner * in_tile;
            is_inside.then_some((texel, near / p.z))
        };
        let rim = rim.iter().filter_map(seen).collect();
        Some(Place {
            at: place + 0.5 * tile.side as f32,
            depth: near / at.z,
            softness: self.pyramid_softness(near, tangent, inner, height),
            rim,
            tile,
        })
    }

    fn place_from_sun(
        &self,
        first: usize,
        direction: Vec3,
        (position, normal): (Vec3, Vec3),
        rim: &Rim,
    ) -> Option<Place> {
        let cosine = -normal.dot(direction);
        let (tile, center, texel_m) = self.cascade_at(first, direction, position)?;
        let [_, _, end, per_length] = self.row(first + 1);
        let moved = position + normal * self.offset(&tile, texel_m, cosine);
        let at = (on_plane(direction, moved) - center) / texel_m;
        let half = 0.5 * tile.side as f32;
        let depth = (end - direction.dot(moved)) * per_length;
        let seen = |offset: &Vec3| {
            let p = at + on_plane(direction, *offset) / texel_m;
            let texel = Vec2::new(p.x, -p.y) + half;
            let is_inside = p.abs().max_element() <= half - 1.0;
            is_inside.then_some((texel, depth - direction.dot(*offset) * per_length))
        };
        let rim = rim.iter().filter_map(seen).collect();
        Some(Place {
            at: Vec2::new(at.x, -at.y) + half,
            depth,
            softness: self.settings.sun_tangent / (per_length * texel_m),
            rim,
            tile,
        })
    }

    /// The finest cascade that holds a place: its tile, its centre, and metres per texel.
    pub(super) fn cascade_at(
        &self,
        first: usize,
        direction: Vec3,
        position: Vec3,
    ) -> Option<(ShadowTile, Vec2, f32)> {
        (0..4).find_map(|cascade| {
            let tile = tile_of(self.rows[first][cascade])?;
            let [u, v, radius, _] = self.row(self.rows[first + 1][0] as usize + cascade);
            let center = Vec2::new(u, v);
            let texel_m = 2.0 * radius / tile.side as f32;
            let away = (on_plane(direction, position) - center).abs();
            let reach = match self.settings.shadows {
                Shadows::Contact => CONTACT_REACH + 2.0,
                _ => BORDER,
            };
            let margin = if cascade == 3 { 0.0 } else { reach * texel_m };
            (away.max_element() <= radius - margin).then_some((tile, center, texel_m))
        })
    }
}

/// The side of a cube that a direction from its centre points to.
fn side_of_cube(d: Vec3) -> u32 {
    let away = d.abs();
    let axis = if away.x >= away.y && away.x >= away.z {
        0
    } else if away.y >= away.z {
        1
    } else {
        2
    };
    2 * axis + u32::from(d[axis as usize] < 0.0)
}

/// Across and up, seen along a directional light's rays.
fn on_plane(direction: Vec3, p: Vec3) -> Vec2 {
    let [across, up, _] = axes_along(direction);
    Vec2::new(across.dot(p), up.dot(p))
}
