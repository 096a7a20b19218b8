//! Light assignment on the CPU, for devices that have no compute shaders: what `clusters.wgsl`
//! finds.

use glam::{Mat4, Vec2, Vec3, Vec4};

use super::LightUniform;
use crate::frame::{FrameUniform, ViewUniform};

/// One bit per cluster and light that shines from a point, `light_words` words per cluster: as
/// `assign` in `clusters.wgsl`.
pub(crate) fn cluster_bits(frame: &FrameUniform, eyes: usize, lights: &[LightUniform]) -> Vec<u32> {
    let [across, down, slices] = frame.cluster_counts;
    let words = lights.len().div_ceil(32);
    let mut bits = vec![0u32; (across * down * slices) as usize * words];
    for (index, light) in lights.iter().enumerate() {
        if light.is_directional() {
            continue;
        }
        let radius = light.range * 1.0001 + 1e-4;
        let centers: Vec<Vec3> = frame.views[..eyes]
            .iter()
            .map(|view| center_in(view, light.position.into()))
            .collect();
        let nearest = -centers[0].z - radius;
        let farthest = -centers[0].z + radius;
        if farthest < 0.0 && frame.orthographic == 0 {
            continue;
        }
        let first = slice_of(frame, nearest).saturating_sub(1);
        let last = (slice_of(frame, farthest) + 1).min(slices - 1);
        let begin = if frame.orthographic != 0 {
            nearest
        } else {
            nearest.max(0.0)
        };
        for slice in first..=last {
            let span = slice_span(frame, slice);
            let z = [span[0].max(begin), span[1].min(farthest)];
            for row in 0..down {
                for column in 0..across {
                    let mut views = frame.views[..eyes].iter().zip(&centers);
                    let touches = views.any(|(view, &seen)| {
                        let (low, high) = cluster_box(frame, view, [column, row], z);
                        let gap = (low - seen).max(seen - high).max(Vec3::ZERO);
                        gap.length_squared() <= radius * radius
                    });
                    if touches {
                        let cluster = (column + across * (row + down * slice)) as usize;
                        bits[cluster * words + index / 32] |= 1 << (index % 32);
                    }
                }
            }
        }
    }
    bits
}

fn center_in(view: &ViewUniform, position: Vec3) -> Vec3 {
    let world_from_view = Mat4::from_cols_array_2d(&view.world_from_view);
    let offset = position - world_from_view.w_axis.truncate();
    Vec3::new(
        world_from_view.x_axis.truncate().dot(offset),
        world_from_view.y_axis.truncate().dot(offset),
        world_from_view.z_axis.truncate().dot(offset),
    )
}

fn slice_of(frame: &FrameUniform, distance: f32) -> u32 {
    let slice = (distance / frame.cluster_near).max(1e-6).log2() * frame.cluster_scale + 1.0;
    slice.clamp(0.0, (frame.cluster_counts[2] - 1) as f32) as u32
}

/// Distances along the view axis where a slice begins and ends.
fn slice_span(frame: &FrameUniform, slice: u32) -> [f32; 2] {
    let at = |step: f32| frame.cluster_near * (step / frame.cluster_scale).exp2();
    [
        if slice == 0 {
            -1e30
        } else {
            at(slice as f32 - 1.0)
        },
        if slice == frame.cluster_counts[2] - 1 {
            1e30
        } else {
            at(slice as f32)
        },
    ]
}

/// View-space corners of a cluster between two distances.
fn cluster_box(
    frame: &FrameUniform,
    view: &ViewUniform,
    tile: [u32; 2],
    z: [f32; 2],
) -> (Vec3, Vec3) {
    let shift = Vec2::new(view.cluster_shift_x, view.cluster_shift_y);
    let corner = Vec2::new(tile[0] as f32, tile[1] as f32) * frame.cluster_tile - shift;
    let to_view = Vec4::from_array(view.view_from_ndc);
    let at = |pixel: Vec2, distance: f32| {
        let ndc =
            Vec2::new(2.0, -2.0) * pixel / Vec2::from_array(frame.size) + Vec2::new(-1.0, 1.0);
        let scale = if frame.orthographic != 0 {
            1.0
        } else {
            distance
        };
        (ndc * Vec2::new(to_view.x, to_view.y) + Vec2::new(to_view.z, to_view.w)) * scale
    };
    let end = corner + frame.cluster_tile;
    let [a, b, c, d] = [
        at(corner, z[0]),
        at(end, z[0]),
        at(corner, z[1]),
        at(end, z[1]),
    ];
    (
        a.min(b).min(c.min(d)).extend(-z[1]),
        a.max(b).max(c.max(d)).extend(-z[0]),
    )
}
