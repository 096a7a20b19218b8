//! What shaders know of tiles: `shadow_words` in `shadow/tile.wgsl`.
//!
//! Two rows per light. Of a point light: three tiles' words and a zero in each, so that a lookup
//! reads one row. Of a spot light that has one tile: its word three times and the cone's tangent in
//! each, so that a lookup need not know first which kind it is. Of a directional light: the words of
//! its four cascades; the number of its first cascade's row, 0, the end of its rays, and one by
//! their length. After all lights a row per cascade: centre across and up, and half the width.

use super::footprint::MOST_MOVED;
use super::kept::KeptTiles;
use super::plan::{CASCADES, Plan, TILES_PER_LIGHT, spot_tangent};
use super::volume::Volume;
use crate::lights::LightUniform;
use crate::{LightingSettings, Shadows};

/// Rows of a light: `SHADOW_ROWS` in the shader.
pub(super) const ROWS: usize = 2;
/// Bit of a tile's word: its filter is a texel wide instead of three.
const NARROW_BIT: u32 = 25;

/// One row.
pub(super) type Row = [u32; 4];

/// Settings that lookups follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookupSettings {
    /// Texels by which places are moved along their normals.
    pub(crate) texels_moved: f32,
    /// Of point and spot lights.
    pub(crate) light_radius_m: f32,
    /// Of half the angle that directional lights fill.
    pub(crate) sun_tangent: f32,
    pub(super) shadows: Shadows,
}

impl LookupSettings {
    pub(crate) fn new(lighting: &LightingSettings) -> Self {
        Self {
            texels_moved: lighting.shadow_bias,
            light_radius_m: lighting.light_radius_m,
            sun_tangent: (0.5 * lighting.sun_angle_deg).to_radians().tan(),
            shadows: lighting.shadows,
        }
    }

    /// Sizes of the lamps as far as shadows fade by them: radius in metres, and tangent.
    pub(super) fn lamps(&self) -> [f32; 2] {
        match self.shadows {
            Shadows::Contact => [self.light_radius_m, self.sun_tangent],
            Shadows::Off | Shadows::Hard | Shadows::Soft => [0.0; 2],
        }
    }

    /// Texels by which a lookup may reach beside its place, in any direction, where no lamp's size
    /// makes it reach farther: as the place is moved, and as its filter reads to both sides.
    pub(super) fn beside(&self) -> f32 {
        MOST_MOVED * self.texels_moved + std::f32::consts::SQRT_2 * SOFT_REACH
    }

    /// Texels that a lookup reads beside the place that it is asked for.
    pub(super) fn reach(&self) -> f32 {
        match self.shadows {
            Shadows::Contact => CONTACT_REACH + 2.0,
            Shadows::Off | Shadows::Hard | Shadows::Soft => SOFT_REACH,
        }
    }
}

/// Texels that filters of one width reach, with what is blended.
const SOFT_REACH: f32 = 3.0;
/// As in `shadow/contact.wgsl`.
pub(super) const CONTACT_REACH: f32 = 12.0;

/// The rows of a frame.
pub(super) fn rows(lights: &[LightUniform], plan: &Plan, kept: &KeptTiles) -> Vec<Row> {
    // A binding must hold a row, even where there is no light.
    let mut rows = vec![[0; 4]; (lights.len() * ROWS).max(1)];
    for (number, light) in lights.iter().enumerate() {
        if !light.is_directional() {
            let tangent = spot_tangent(light).unwrap_or(0.0).to_bits();
            rows[number * ROWS][3] = tangent;
            rows[number * ROWS + 1][3] = tangent;
        }
    }
    for want in &plan.wanted {
        let number = want.slot as usize / TILES_PER_LIGHT;
        let tile = want.slot as usize % TILES_PER_LIGHT;
        let Some((place, held)) = kept.shown(want) else {
            // Nobody sees what it would shade, or it waits and nothing stands in for it.
            continue;
        };
        let first = number * ROWS;
        let word = place.word() | u32::from(want.follows_rate) << NARROW_BIT;
        if lights[number].is_directional() {
            rows[first][tile] = word;
        } else if spot_tangent(&lights[number]).is_some() {
            rows[first][..3].fill(word);
            rows[first + 1][..3].fill(word);
        } else {
            rows[first + tile / 3][tile % 3] = word;
        }
        let Volume::Column {
            center,
            radius,
            span: [begin, end],
            ..
        } = held
        else {
            continue;
        };
        if rows[first + 1][3] == 0 {
            rows[first + 1] = [
                rows.len() as u32,
                0,
                end.to_bits(),
                (1.0 / (end - begin)).to_bits(),
            ];
            rows.resize(rows.len() + CASCADES, [0; 4]);
        }
        debug_assert!(lights[number].is_directional());
        let cascades = rows[first + 1][0] as usize;
        rows[cascades + tile] = [center[0], center[1], radius, 0.0].map(f32::to_bits);
    }
    rows
}
