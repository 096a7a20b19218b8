//! Shadow maps without the casters that are left out give the same shadows wherever they are seen.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Object, Random, Scene, eye, occluders, scene};
use foveal_cull::Visibility::{Occluded, Outside, Visible};
use foveal_cull::reference::Reference;
use foveal_cull::{
    Aabb, CullError, Culler, Eye, FrameOptions, Projection, ReceiverMask, SingleThread, View,
    Visibility,
};
use glam::{DVec3, Vec3};

/// Side of the shadow maps, texels.
const SIDE: u32 = 64;

fn bounds_of(object: &Object) -> Aabb {
    let place = |p: &Vec3| object.transform.transform_point3(p.as_dvec3());
    let (low, high) = object
        .positions
        .iter()
        .map(place)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    // Rounded outwards.
    Aabb::new(low.as_vec3() - 1e-5, high.as_vec3() + 1e-5)
}

/// The faces that a shadow map draws.
#[derive(Clone, Copy)]
enum Faces {
    Both,
    /// Front faces, and both of two-sided casters.
    Occluding,
    Back,
}

/// The depths of a shadow map of the casters that count: 0 where there is none, rising to the light.
fn shadow_map<'a>(
    light: &Eye,
    casters: impl Iterator<Item = &'a Object>,
    faces: Faces,
) -> Vec<f32> {
    let mut map = Reference::new(light, SIDE, SIDE).unwrap();
    for o in casters {
        let (mut indices, mut both) = (o.indices.clone(), o.two_sided);
        match faces {
            Faces::Both => both = true,
            Faces::Occluding => {}
            Faces::Back => indices.reverse(),
        }
        map.add(&o.positions, &indices, o.transform, both);
    }
    map.finish();
    map.depth().to_vec()
}

/// The texel that a place falls on, and its depth there; None beside the map, before the near plane
/// and beyond the far one.
fn lookup(light: &Eye, place: DVec3) -> Option<([i64; 2], f64)> {
    let a = light.world_from_eye;
    let p = place - DVec3::from(a.translation);
    let [right, up, back] = [a.x_axis, a.y_axis, a.z_axis].map(|axis| DVec3::from(axis).dot(p));
    let along = -back;
    let [left, far_right, bottom, top] = light.projection.extents();
    let [near, far] = light.projection.near_far_m();
    if !(near..=far).contains(&along) {
        return None;
    }
    let (w, depth) = if light.projection.is_orthographic() {
        (1.0, (far - along) / (far - near))
    } else {
        (along, near / along)
    };
    let side = f64::from(SIDE);
    let x = (right / w - left) / (far_right - left) * side;
    let y = (top - up / w) / (top - bottom) * side;
    let on = |v: f64| (0.0..side).contains(&v);
    (on(x) && on(y)).then_some(([x as i64, y as i64], depth))
}

/// Whether each texel within `reach` of a place is in its shadow.
fn shadows(map: &[f32], (texel, depth): ([i64; 2], f64), reach: i64) -> Vec<bool> {
    let (side, [x, y]) = (i64::from(SIDE), texel);
    (y - reach..=y + reach)
        .flat_map(|y| (x - reach..=x + reach).map(move |x| [x, y].map(|v| v.clamp(0, side - 1))))
        .map(|[x, y]| f64::from(map[(y * side + x) as usize]) > depth)
        .collect()
}

#[test]
fn what_is_left_out_changes_no_lookup_for_a_place_that_is_seen() {
    let (mut left_out, mut hidden, mut kept, mut looked, mut shaded) = (0, 0, 0, 0, 0);
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let scene = scene(&mut r, 14, 8, DVec3::ZERO);
        let light = eye(&mut r, DVec3::ZERO, seed % 3 == 2);
        let casters: Vec<Aabb> = scene.objects.iter().map(bounds_of).collect();
        // Some occlude, all cast shadows.
        let occluders = occluders(&scene, &[0, 1, 2, 3, 4, 5, 6]);
        let mut results = vec![Visible; casters.len()];
        let mut culler = Culler::new(SIDE / 4, SIDE / 4).unwrap();
        let (view, options) = (View::mono(light), FrameOptions::default());
        culler
            .rasterize(&view, &occluders, &options, &SingleThread)
            .unwrap();
        culler.query(&casters, DVec3::ZERO, &mut results).unwrap();
        let by_light = results.clone();

        let (reach, moved) = (r.below(4), [0.0, 0.05][r.below(2)]);
        let mut mask = ReceiverMask::new(&view, SIDE)
            .unwrap()
            .with_reach(reach as f64, moved);
        let seen: Vec<Visibility> = (0..scene.boxes.len())
            .map(|i| [Visible, Occluded][usize::from(i > 2)])
            .collect();
        mask.receive(&scene.boxes, DVec3::ZERO, &seen).unwrap();
        mask.cull(&casters, DVec3::ZERO, &mut results).unwrap();

        let visible = scene.objects.iter().zip(&results);
        let visible = visible.filter(|(_, v)| v.is_visible()).map(|(o, _)| o);
        let maps = [Faces::Both, Faces::Occluding].map(|faces| {
            let all = shadow_map(&light, scene.objects.iter(), faces);
            [all, shadow_map(&light, visible.clone(), faces)]
        });
        for (bounds, _) in scene
            .boxes
            .iter()
            .zip(&seen)
            .filter(|(_, s)| s.is_visible())
        {
            let [low, high] = [bounds.min, bounds.max].map(|v| Vec3::from(v).as_dvec3());
            for _ in 0..200 {
                let part = DVec3::new(r.next(), r.next(), r.next());
                let place = low + (high - low) * part + r.vec(moved);
                let Some(at) = lookup(&light, place) else {
                    continue;
                };
                assert!(!mask.is_empty(), "{seed}: {bounds:?}");
                for maps in &maps {
                    let [all, fewer] = maps.each_ref().map(|m| shadows(m, at, reach as i64));
                    assert_eq!(all, fewer, "{seed}: {bounds:?} {place}");
                    shaded += usize::from(all.iter().any(|s| *s));
                }
                looked += 1;
            }
        }
        for (after, before) in results.iter().zip(&by_light) {
            hidden += usize::from(*before == Occluded);
            left_out += usize::from(before.is_visible() && *after == Occluded);
            kept += usize::from(after.is_visible());
            assert!(before.is_visible() || before == after, "other results stay");
        }
    }
    assert!(
        left_out > 60 && hidden > 10 && kept > 100 && looked > 5_000 && shaded > 1_000,
        "{left_out} {hidden} {kept} {looked} {shaded}"
    );
}

#[test]
fn a_map_of_back_faces_keeps_the_shadows_behind_closed_occluders_only() {
    let view = side_of_a_lamp();
    let corners = |[near, far]: [f32; 2]| {
        let corner = |i: u8| {
            let side = |bit: u8| if i >> bit & 1 == 0 { -3.0 } else { 3.0 };
            Vec3::new(side(0), side(1), if i < 4 { far } else { near })
        };
        (0..8).map(corner).collect::<Vec<_>>()
    };
    let quads = |of: &[[u32; 4]]| {
        let triangles = of.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]);
        triangles.collect::<Vec<_>>()
    };
    // A wall whose front looks at the lamp, and a box with the same front.
    let front = [4, 5, 7, 6];
    let rest = [
        [0, 2, 3, 1],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
    ];
    let closed = [&[front][..], &rest[..]].concat();
    for (faces, keeps) in [(&[front][..], false), (&closed[..], true)] {
        let wall = Object {
            positions: corners([-4.0, -4.5]),
            indices: quads(faces),
            transform: glam::DAffine3::IDENTITY,
            two_sided: false,
        };
        let scene = Scene {
            objects: vec![wall],
            boxes: Vec::new(),
            origin: DVec3::ZERO,
        };
        let mut culler = Culler::for_picture(SIDE, SIDE).unwrap();
        let (view, options) = (view.for_picture(SIDE, SIDE), FrameOptions::default());
        let set = occluders(&scene, &[0]);
        (culler.rasterize(&view, &set, &options, &SingleThread)).unwrap();
        let mut behind = [Visible];
        let crate_behind = around([0.0, 0.0, -7.0], 0.5);
        (culler.query(&[crate_behind], [0.0; 3], &mut behind)).unwrap();
        assert_eq!(behind, [Occluded], "left out of the map");
        let at = lookup(&view.eye, DVec3::new(0.1, 0.1, -9.0)).unwrap();
        for (drawn, expected) in [(Faces::Occluding, true), (Faces::Back, keeps)] {
            let map = shadow_map(&view.eye, scene.objects.iter(), drawn);
            assert_eq!(shadows(&map, at, 0), [expected]);
        }
    }
}

fn side_of_a_lamp() -> View {
    let side = Projection::perspective(core::f64::consts::FRAC_PI_2, 1.0, 0.1, 20.0);
    View::mono(Eye::look_at(
        [0.0; 3],
        [0.0, 0.0, -1.0],
        [0.0, 1.0, 0.0],
        side,
    ))
}

fn around(at: [f32; 3], half: f32) -> Aabb {
    Aabb::new(at.map(|v| v - half), at.map(|v| v + half))
}

#[test]
fn casters_behind_beside_and_outside_are_left_out() {
    let mut mask = ReceiverMask::new(&side_of_a_lamp(), 256).unwrap();
    let casters = [
        around([0.0, 0.0, -5.0], 0.3),
        around([0.5, 0.0, -10.0], 1.0),
        around([0.0, 0.0, -13.0], 0.3),
        around([4.0, 0.0, -5.0], 0.3),
        around([0.0, 0.0, 5.0], 0.3),
        around([0.0, 0.0, -30.0], 0.3),
        around([9.0, 0.0, -2.0], 0.3),
        around([0.0, 0.0, 0.0], 0.4),
        Aabb::new([f32::NAN; 3], [1.0; 3]),
    ];
    let cull = |mask: &ReceiverMask| {
        let mut results = [Visible; 9];
        mask.cull(&casters, [0.0; 3], &mut results).unwrap();
        results
    };
    assert!(mask.is_empty());
    assert_eq!(
        cull(&mask),
        [
            Occluded, Occluded, Occluded, Occluded, Outside, Outside, Outside, Occluded, Visible
        ]
    );
    let receiver = [around([0.0, 0.0, -10.0], 1.0)];
    mask.receive(&receiver, [0.0; 3], &[Occluded]).unwrap();
    assert!(mask.is_empty(), "it is not seen");
    mask.receive(&receiver, [0.0; 3], &[Visible]).unwrap();
    let with_receiver = [
        Visible, Visible, Occluded, Occluded, Outside, Outside, Outside, Visible, Visible,
    ];
    assert_eq!(cull(&mask), with_receiver);
    // The same relative to another origin.
    let mut far = ReceiverMask::new(&side_of_a_lamp(), 256).unwrap();
    let moved = [around([-1e3, 0.0, -10.0], 1.0)];
    far.receive(&moved, [1e3, 0.0, 0.0], &[Visible]).unwrap();
    assert_eq!(cull(&far), with_receiver);
    mask.clear();
    assert!(mask.is_empty());
}

#[test]
fn a_mask_that_takes_another_map_is_a_new_one_with_the_same_reach() {
    let sun = Projection::orthographic(8.0, 1.0, 0.0, 20.0);
    let down = Eye::look_at([0.0, 10.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0], sun);
    let sun = View::mono(down);
    let mut r = Random::new(3);
    let boxes: Vec<Aabb> = (0..400)
        .map(|_| around(r.vec(9.0).as_vec3().to_array(), 0.2))
        .collect();
    let seen: Vec<Visibility> = (0..boxes.len())
        .map(|i| [Visible, Occluded][usize::from(i % 20 > 0)])
        .collect();
    let results = |mask: &mut ReceiverMask| {
        mask.receive(&boxes, [0.0; 3], &seen).unwrap();
        let mut results = vec![Visible; boxes.len()];
        mask.cull(&boxes, [0.0; 3], &mut results).unwrap();
        results
    };
    let mut reused = ReceiverMask::new(&side_of_a_lamp(), 256)
        .unwrap()
        .with_reach(9.0, 0.1);
    results(&mut reused);
    for (view, side) in [(sun, 2048), (side_of_a_lamp(), 3), (sun, 64)] {
        reused.reset(&view, side).unwrap();
        assert!(reused.is_empty());
        let mut new = ReceiverMask::new(&view, side).unwrap().with_reach(9.0, 0.1);
        let of_new = results(&mut new);
        assert!(of_new.contains(&Visible) && of_new.contains(&Outside));
        assert_eq!(results(&mut reused), of_new);
        // One that cannot be is refused, and changes nothing.
        assert!(reused.reset(&view, 0).is_err());
        let mut bad = view;
        bad.eye.world_from_eye.translation[1] = f64::NAN;
        assert!(reused.reset(&bad, 64).is_err());
        assert_eq!(results(&mut reused), of_new);
    }
}

#[test]
fn what_cannot_be_computed_with_is_everywhere() {
    let caster = [around([0.0, 0.0, -5.0], 0.3)];
    let cull = |mask: &ReceiverMask, origin: [f64; 3]| {
        let mut results = [Visible];
        mask.cull(&caster, origin, &mut results).unwrap();
        results[0]
    };
    let empty = ReceiverMask::new(&side_of_a_lamp(), 256).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        assert_eq!(cull(&empty, [bad, 0.0, 0.0]), Visible, "{bad}");
        let mut mask = empty.clone();
        mask.receive(&caster, [0.0, bad, 0.0], &[Visible]).unwrap();
        assert_eq!(cull(&mask, [0.0; 3]), Visible, "{bad}");
    }
    let mut mask = empty.clone();
    mask.receive(&[Aabb::EMPTY], [0.0; 3], &[Visible]).unwrap();
    assert_eq!(cull(&mask, [0.0; 3]), Visible);
    // A reach that is no number is none.
    let mut mask = empty.with_reach(f64::NAN, -1.0);
    mask.receive(&caster, [0.0; 3], &[Visible]).unwrap();
    assert_eq!(cull(&mask, [0.0; 3]), Visible);
}

#[test]
fn bad_input_is_refused() {
    for side in [0, 16_385, u32::MAX] {
        let error = ReceiverMask::new(&side_of_a_lamp(), side).unwrap_err();
        assert!(matches!(error, CullError::BadShadowMap { .. }), "{side}");
    }
    let mut view = side_of_a_lamp();
    view.eye.world_from_eye.translation[0] = f64::NAN;
    assert!(ReceiverMask::new(&view, 64).is_err());
    let mut mask = ReceiverMask::new(&side_of_a_lamp(), 1).unwrap();
    let (boxes, origin) = ([around([0.0; 3], 1.0)], [0.0; 3]);
    assert!(mask.receive(&boxes, origin, &[]).is_err());
    assert!(mask.cull(&boxes, origin, &mut []).is_err());
}

/// A box around all that a lamp reaches: where it is hidden, nothing that the lamp lights is seen.
#[test]
fn a_lamp_whose_whole_reach_is_hidden_is_left_out_by_its_box() {
    let wall = Aabb::new([-9.0, -9.0, -5.0], [9.0, 9.0, -4.9]);
    let mut occluders = foveal_cull::OccluderSet::new();
    let mesh = foveal_cull::OccluderMesh::from_box(wall).unwrap();
    occluders
        .add(mesh.into(), foveal_cull::Affine::IDENTITY)
        .unwrap();
    let mut culler = Culler::new(64, 64).unwrap();
    let view = side_of_a_lamp();
    culler
        .rasterize(&view, &occluders, &FrameOptions::default(), &SingleThread)
        .unwrap();
    let lamps = [
        around([0.0, 0.0, -9.0], 3.0),
        around([0.0, 0.0, -9.0], 4.5),
        around([0.0, 0.0, 9.0], 3.0),
    ];
    let mut results = [Visible; 3];
    culler.query(&lamps, [0.0; 3], &mut results).unwrap();
    assert_eq!(results, [Occluded, Visible, Outside]);
}

#[test]
fn a_receiver_on_the_far_plane_and_a_caster_on_the_near_one_count() {
    // A sun straight above. 0.1 as `f32` lies below 0.1: the ground is a little beyond the far plane.
    let down = |near: f64, far: f64| {
        let square = Projection::orthographic(8.0, 1.0, near, far);
        View::mono(Eye::look_at(
            [0.0, 10.1, 0.0],
            [0.0; 3],
            [0.0, 0.0, -1.0],
            square,
        ))
    };
    let ground = [Aabb::new([-2.0, -0.3, -2.0], [2.0, -0.1, 2.0])];
    let roof = [Aabb::new([-1.0, 5.0, -1.0], [1.0, 5.1, 1.0])];
    let mut mask = ReceiverMask::new(&down(0.0, 10.2), SIDE).unwrap();
    mask.receive(&ground, DVec3::ZERO, &[Visible]).unwrap();
    assert!(!mask.is_empty());
    let mut results = [Visible];
    mask.cull(&roof, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results, [Visible]);

    // 5.3 as `f32` lies above 5.3: the roof is a little before the near plane.
    let flat = [Aabb::new([-1.0, 5.3, -1.0], [1.0, 5.3, 1.0])];
    let mut mask = ReceiverMask::new(&down(4.8, 12.0), SIDE).unwrap();
    mask.receive(&ground, DVec3::ZERO, &[Visible]).unwrap();
    mask.cull(&flat, DVec3::ZERO, &mut results).unwrap();
    assert_eq!(results, [Visible]);
}

#[test]
fn boxes_without_end_cast_and_receive_everywhere() {
    let projection = Projection::perspective(std::f64::consts::FRAC_PI_2, 1.0, 0.1, 1e3);
    let light = View::mono(Eye::look_at(
        [0.0; 3],
        [0.0, 0.0, -1.0],
        [0.0, 1.0, 0.0],
        projection,
    ));
    let near = [Aabb::new([3.9, -0.1, -5.1], [4.1, 0.1, -4.9])];
    for end in [1e7, 1e20, 1e38] {
        let long = [Aabb::new([-1.0, -1.0, -end], [1.0, 1.0, end])];
        for (receiver, caster) in [(&near, &long), (&long, &near)] {
            let mut mask = ReceiverMask::new(&light, 512).unwrap();
            mask.receive(receiver, DVec3::ZERO, &[Visible]).unwrap();
            let mut results = [Visible];
            mask.cull(caster, DVec3::ZERO, &mut results).unwrap();
            assert_eq!(results, [Visible], "{end}");
        }
    }
}
