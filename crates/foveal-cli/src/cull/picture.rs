//! Pictures of a culled frame: the depth buffer, and the boxes over it.

use foveal_cull::{Aabb, Culler, Eye, Visibility};
use glam::DVec4;

use foveal_host::culling::{clip_position, corners};
use foveal_host::picture::Picture;

const EMPTY: [u8; 4] = [16, 20, 48, 255];
const VISIBLE: [u8; 4] = [40, 220, 70, 255];
const OCCLUDED: [u8; 4] = [230, 40, 40, 255];
const SMALL: [u8; 4] = [240, 220, 40, 255];
/// The overlay is at least this wide where whole pixels allow, so that boxes can be told apart.
const OVERLAY_WIDTH: u32 = 1280;

/// The depth buffer in greys, logarithmic between its own nearest (white) and farthest (dark)
/// pixel; dark blue where nothing is proven to be covered.
pub(super) fn depth(culler: &Culler) -> anyhow::Result<Picture> {
    let (width, height) = culler.size();
    let mut depth = vec![0.0; width as usize * height as usize];
    culler.read_depth(&mut depth)?;
    let covered = || depth.iter().copied().filter(|&d| d > 0.0);
    let near = covered().fold(f32::MIN_POSITIVE, f32::max).log2();
    let far = covered().fold(1.0, f32::min).log2();
    let span = (near - far).max(1e-6);
    let pixels = depth
        .iter()
        .map(|&d| {
            if d > 0.0 {
                let grey = (56.0 + 199.0 * ((d.log2() - far) / span).clamp(0.0, 1.0)) as u8;
                [grey, grey, grey, 255]
            } else {
                EMPTY
            }
        })
        .collect();
    Ok(Picture {
        width,
        height,
        pixels,
    })
}

/// The depth buffer, enlarged, with the edges of all boxes in the frustum. What is seen is drawn
/// last.
pub(super) fn overlay(
    culler: &Culler,
    eye: &Eye,
    boxes: &[Aabb],
    results: &[Visibility],
) -> anyhow::Result<Picture> {
    let depth = depth(culler)?;
    let mut picture = enlarge(&depth, (OVERLAY_WIDTH / depth.width).max(1));
    for (kind, color) in [
        (Visibility::Occluded, OCCLUDED),
        (Visibility::Small, SMALL),
        (Visibility::Visible, VISIBLE),
    ] {
        for (bounds, _) in boxes.iter().zip(results).filter(|(_, r)| **r == kind) {
            draw_box(&mut picture, eye, bounds, color);
        }
    }
    Ok(picture)
}

fn enlarge(picture: &Picture, by: u32) -> Picture {
    let (width, height) = (picture.width * by, picture.height * by);
    let pixels = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x / by, y / by)))
        .map(|(x, y)| picture.pixels[(y * picture.width + x) as usize])
        .collect();
    Picture {
        width,
        height,
        pixels,
    }
}

fn draw_box(picture: &mut Picture, eye: &Eye, bounds: &Aabb, color: [u8; 4]) {
    let corners = corners(bounds).map(|corner| clip_position(eye, corner));
    for a in 0..8_usize {
        for bit in [1, 2, 4] {
            if a & bit == 0
                && let Some(line) = clipped(corners[a], corners[a | bit])
            {
                draw_line(picture, line, color);
            }
        }
    }
}

/// The part of an edge that is on the screen (Liang and Barsky 1984), as x0, y0, x1, y1 in -1..1.
fn clipped(a: DVec4, b: DVec4) -> Option<[f64; 4]> {
    let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
    let planes = |p: DVec4| [p.z, p.w + p.x, p.w - p.x, p.w + p.y, p.w - p.y];
    for (da, db) in planes(a).into_iter().zip(planes(b)) {
        match (da >= 0.0, db >= 0.0) {
            (true, true) => {}
            (false, false) => return None,
            (false, true) => t0 = t0.max(da / (da - db)),
            (true, false) => t1 = t1.min(da / (da - db)),
        }
    }
    let at = |t: f64| {
        let p = a.lerp(b, t);
        [p.x / p.w, p.y / p.w]
    };
    let ([x0, y0], [x1, y1]) = (at(t0), at(t1));
    (t0 <= t1 && [x0, y0, x1, y1].iter().all(|v| v.is_finite())).then_some([x0, y0, x1, y1])
}

fn draw_line(picture: &mut Picture, [x0, y0, x1, y1]: [f64; 4], color: [u8; 4]) {
    let (w, h) = (f64::from(picture.width), f64::from(picture.height));
    let (x0, y0) = ((x0 + 1.0) * 0.5 * w, (1.0 - y0) * 0.5 * h);
    let (x1, y1) = ((x1 + 1.0) * 0.5 * w, (1.0 - y1) * 0.5 * h);
    let steps = (x1 - x0).abs().max((y1 - y0).abs()).ceil().max(1.0) as u32;
    for i in 0..=steps {
        let t = f64::from(i) / f64::from(steps);
        let x = ((x0 + (x1 - x0) * t).max(0.0) as u32).min(picture.width - 1);
        let y = ((y0 + (y1 - y0) * t).max(0.0) as u32).min(picture.height - 1);
        picture.pixels[(y * picture.width + x) as usize] = color;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_cull::Projection;
    use glam::{DVec3, Vec3};

    #[test]
    fn edges_that_cross_the_near_plane_are_cut_there() {
        let projection = Projection::perspective(1.0, 1.0, 0.1, f64::INFINITY);
        let eye = Eye::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection);
        let across = |z0: f64, z1: f64| {
            clipped(
                clip_position(&eye, DVec3::new(0.0, 0.01, z0)),
                clip_position(&eye, DVec3::new(0.0, 0.01, z1)),
            )
        };
        assert!(across(1.0, 2.0).is_none());
        let [_, y0, _, y1] = across(5.0, -5.0).unwrap();
        assert!((y0 - 0.1 / 0.5_f64.tan()).abs() < 1e-9 && y1 < y0);
    }

    #[test]
    fn a_box_in_view_is_drawn_in_its_colour() {
        let projection = Projection::perspective(1.0, 1.0, 0.1, f64::INFINITY);
        let eye = Eye::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection);
        let culler = Culler::new(64, 64).unwrap();
        let bounds = Aabb::new(Vec3::new(-1.0, -1.0, -6.0), Vec3::new(1.0, 1.0, -5.0));
        let picture = overlay(&culler, &eye, &[bounds], &[Visibility::Small]).unwrap();
        assert!(picture.pixels.contains(&SMALL) && !picture.pixels.contains(&VISIBLE));
    }
}
