//! Pictures of any size: the buffer's samples are the picture's own pixel centres.
#![allow(clippy::unwrap_used, reason = "tests")]

use foveal_cull::{
    Aabb, Affine, CullError, Culler, Eye, FrameOptions, OccluderMesh, OccluderSet, Projection,
    Quantity, SingleThread, View, Visibility,
};
use std::sync::Arc;

/// Sides that leave every remainder of 4.
const PICTURES: [(u32, u32); 4] = [(1366, 768), (1365, 767), (640, 361), (1367, 766)];
/// Distance of the slits, metres.
const DISTANCE: f64 = 5.0;

fn perspective((width, height): (u32, u32)) -> Projection {
    let aspect = f64::from(width) / f64::from(height);
    Projection::Perspective {
        left: -0.4 * aspect,
        right: 0.6 * aspect,
        bottom: -0.6,
        top: 0.4,
        near_m: 0.1,
        far_m: f64::INFINITY,
    }
}

fn orthographic((width, height): (u32, u32)) -> Projection {
    let aspect = f64::from(width) / f64::from(height);
    Projection::orthographic(4.0, aspect, 0.1, 100.0)
}

fn view(projection: Projection) -> View {
    let (eye, ahead, up) = ([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
    View::mono(Eye::look_at(eye, ahead, up, projection))
}

/// How often a box behind a slit is called hidden that the pixel centre in the slit's middle shows.
/// Slits are 0.9 pixels wide, along both axes.
fn wrong(culler: &mut Culler, seen_by: &View, picture: (u32, u32), projection: Projection) -> u32 {
    let ([left, right, bottom, top], sides) = (projection.extents(), [picture.0, picture.1]);
    let [spread, spread_behind] = if projection.is_orthographic() {
        [1.0; 2]
    } else {
        [DISTANCE, DISTANCE + 1.0]
    };
    let options = FrameOptions::default().with_occluder_pixels_per_quad(0.0);
    let mut wrong = 0;
    for axis in 0..2 {
        let (first, last) = [(left, right), (top, bottom)][axis];
        let pixel = spread * (last - first) / f64::from(sides[axis]);
        for i in (sides[axis] / 3..sides[axis]).step_by(7) {
            let center = spread * first + (f64::from(i) + 0.5) * pixel;
            let half = 0.45 * pixel.abs();
            let mut occluders = OccluderSet::new();
            for (from, to) in [(-30.0, center - half), (center + half, 30.0)] {
                let mut bounds = Aabb::new([-30.0, -30.0, -5.001], [30.0, 30.0, -5.0]);
                (bounds.min[axis], bounds.max[axis]) = (from as f32, to as f32);
                let mesh = Arc::new(OccluderMesh::from_box(bounds).unwrap());
                occluders.add(mesh, Affine::IDENTITY).unwrap();
            }
            let mut behind = Aabb::new([-0.2, -0.2, -6.0], [0.2, 0.2, -5.9]);
            let at = center / spread * spread_behind;
            (behind.min[axis], behind.max[axis]) = ((at - 0.2) as f32, (at + 0.2) as f32);
            (culler.rasterize(seen_by, &occluders, &options, &SingleThread)).unwrap();
            let mut result = [Visibility::Visible];
            culler.query(&[behind], [0.0; 3], &mut result).unwrap();
            wrong += u32::from(result[0] != Visibility::Visible);
        }
    }
    wrong
}

#[test]
fn nothing_is_culled_that_a_pixel_centre_of_a_picture_of_any_size_shows() {
    let mut rounded_down = 0;
    for picture in PICTURES {
        let (width, height) = picture;
        for projection in [perspective(picture), orthographic(picture)] {
            let view = view(projection);
            // Places where samples that are not the picture's miss a slit.
            let mut culler = Culler::new(width / 4, height / 4).unwrap();
            rounded_down += wrong(&mut culler, &view, picture, projection);
            let mut culler = Culler::for_picture(width, height).unwrap();
            let view = view.for_picture(width, height);
            assert_eq!(
                wrong(&mut culler, &view, picture, projection),
                0,
                "{picture:?}"
            );
        }
    }
    assert!(rounded_down > 50, "{rounded_down} slits were missed");
}

#[test]
fn the_view_of_a_picture_ends_with_whole_pixels_of_its_culler() {
    for picture in [(1, 1), (2, 3), (5, 1366), (7, 9), (16_381, 16_383)] {
        let (width, height) = picture;
        let culler = Culler::for_picture(width, height).unwrap();
        let (buffer, exact) = (culler.size(), perspective(picture));
        assert_eq!(buffer, (width.div_ceil(4), height.div_ceil(4)));
        let wide = view(exact).for_picture(width, height).eye.projection;
        let ([l, r, b, t], [wl, wr, wb, wt]) = (exact.extents(), wide.extents());
        assert_eq!((wl, wt, wide.near_far_m()), (l, t, exact.near_far_m()));
        let pixel = |side: f64, px: u32| side / f64::from(px);
        let (x, y) = (pixel(r - l, width), pixel(t - b, height));
        assert!((pixel(wr - wl, 4 * buffer.0) - x).abs() < 1e-12 * x);
        assert!((pixel(wt - wb, 4 * buffer.1) - y).abs() < 1e-12 * y);
    }
    // Nothing changes, to the bit, where the sides are multiples of 4.
    let picture = (1280, 720);
    let exact = view(perspective(picture));
    assert_eq!(exact.for_picture(picture.0, picture.1), exact);
}

#[test]
fn both_eyes_of_a_view_see_the_picture_and_its_radius_stays() {
    let size = (1366, 767);
    let (left, right) = (view(perspective(size)).eye, view(orthographic(size)).eye);
    let both = View::stereo(left, right).with_validity_radius(0.01);
    let both = both.for_picture(size.0, size.1);
    assert_eq!(both.eye, View::mono(left).for_picture(1366, 767).eye);
    let second = View::mono(right).for_picture(1366, 767).eye;
    assert_eq!(
        (both.second_eye, both.validity_radius_m),
        (Some(second), 0.01)
    );
}

#[test]
fn pictures_without_pixels_and_too_large_ones_are_refused() {
    for (width, height) in [(0, 5), (5, 0), (16_385, 5), (5, u32::MAX)] {
        let refused = Culler::for_picture(width, height);
        assert!(matches!(refused, Err(CullError::BadSize { .. })));
    }
    let (mut culler, occluders) = (Culler::for_picture(5, 5).unwrap(), OccluderSet::new());
    let view = view(perspective((5, 5)));
    for (width, height) in [(0, 5), (5, 0)] {
        let view = view.for_picture(width, height);
        let options = FrameOptions::default();
        let drawn = culler.rasterize(&view, &occluders, &options, &SingleThread);
        assert_eq!(drawn, Err(CullError::NotFinite(Quantity::Projection)));
    }
    // No sum overflows.
    let huge = view.for_picture(u32::MAX, u32::MAX);
    assert!(huge.eye.projection.extents().iter().all(|v| v.is_finite()));
}
