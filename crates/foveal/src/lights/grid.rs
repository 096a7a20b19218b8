//! The grid of clusters.

use super::LightUniform;
use crate::stereo::{Eye, EyeLayout, cluster_shifts};
use foveal_scene::{Camera, Projection};

/// Slices along the view axis.
const SLICES: u32 = 24;
/// Tiles grow until the bits of all clusters fit into this.
const MAX_BYTES: u64 = 32 << 20;

/// How the view is cut into clusters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClusterGrid {
    /// Tiles across, tiles down, slices.
    pub(crate) counts: [u32; 3],
    /// Side of a tile in pixels.
    pub(crate) tile_px: u32,
    /// Distance where the second slice begins.
    pub(crate) near_m: f32,
    /// Slices per doubling of the distance.
    pub(crate) slices_per_doubling: f32,
    /// Lights that share the grid.
    pub(crate) light_count: u32,
    /// Pixels by which each eye's picture lies to the right and below in the grid.
    pub(crate) shifts: [[u32; 2]; 2],
}

impl ClusterGrid {
    /// A grid for the eyes' pictures that resolves the distances at which the lights are.
    pub(crate) fn new(
        layout: &EyeLayout,
        eyes: &[Eye; 2],
        camera: &Camera,
        lights: &[LightUniform],
    ) -> Self {
        let shifts = cluster_shifts(eyes, layout);
        let width = layout.width + shifts[0][0].max(shifts[1][0]);
        let height = layout.height + shifts[0][1].max(shifts[1][1]);
        let light_count = lights.len() as u32;
        let words = u64::from(light_count.div_ceil(32));
        let mut tile_px = 64;
        let tiles = |tile: u32| (width.div_ceil(tile), height.div_ceil(tile));
        while {
            let (x, y) = tiles(tile_px);
            u64::from(x) * u64::from(y) * u64::from(SLICES) * words * 4 > MAX_BYTES
        } {
            tile_px *= 2;
        }
        let (x, y) = tiles(tile_px);
        let near_plane = match camera.projection {
            Projection::Perspective { near_m, .. } | Projection::Orthographic { near_m, .. } => {
                near_m
            }
        };
        let near_m = near_plane.max(0.25);
        let eye = camera.eye();
        let far = lights
            .iter()
            .filter(|l| l.kind != 0)
            .map(|l| eye.distance(l.position.into()) + l.range)
            .filter(|d| d.is_finite())
            .fold(near_m * 4.0, f32::max);
        let slices_per_doubling = (SLICES - 1) as f32 / (far / near_m).log2();
        Self {
            counts: [x, y, SLICES],
            tile_px,
            near_m,
            slices_per_doubling,
            light_count,
            shifts,
        }
    }

    /// 32-light words per cluster.
    pub(crate) fn light_words(&self) -> u32 {
        self.light_count.div_ceil(32)
    }

    /// Words of all clusters together.
    pub(crate) fn total_words(&self) -> u64 {
        self.counts.iter().map(|&c| u64::from(c)).product::<u64>() * u64::from(self.light_words())
    }
}
