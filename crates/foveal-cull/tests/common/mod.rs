//! Random scenes for the property tests, all from one seed.
#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    reason = "shared by several test programs, each using a part"
)]

pub mod promise;

use foveal_cull::reference::{Reference, Seen};
use foveal_cull::{
    Aabb, BakeOptions, Culler, Eye, FrameOptions, OccludeeId, OccludeeSet, OccluderMesh,
    OccluderSet, Projection, Threads, View, Visibility, testing,
};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use std::sync::Arc;

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn range(&mut self, lo: f64, hi: f64) -> f64 {
        lo + self.next() * (hi - lo)
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
    pub fn vec(&mut self, reach: f64) -> DVec3 {
        DVec3::new(
            self.range(-reach, reach),
            self.range(-reach, reach),
            self.range(-reach, reach),
        )
    }
}

pub struct Object {
    pub positions: Vec<Vec3>,
    pub indices: Vec<u32>,
    pub transform: DAffine3,
    pub two_sided: bool,
}

pub struct Scene {
    pub objects: Vec<Object>,
    pub boxes: Vec<Aabb>,
    pub origin: DVec3,
}

fn grid(n: u32, height: impl Fn(f32, f32) -> Vec3) -> (Vec<Vec3>, Vec<u32>) {
    let positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i as f32 / n as f32, j as f32 / n as f32)))
        .map(|(u, v)| height(u, v))
        .collect();
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let indices = (0..n)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            [
                at(i, j),
                at(i + 1, j),
                at(i + 1, j + 1),
                at(i, j),
                at(i + 1, j + 1),
                at(i, j + 1),
            ]
        })
        .collect();
    (positions, indices)
}

/// A wall with slits, a bumpy grid, a ball, a soup or a box.
fn shape(r: &mut Random) -> (Vec<Vec3>, Vec<u32>) {
    match r.below(5) {
        0 => {
            let (mut p, mut i) = (Vec::new(), Vec::new());
            let mut x = -3.0f32;
            while x < 3.0 {
                let w = r.range(0.1, 1.5) as f32;
                let b = p.len() as u32;
                p.extend([
                    Vec3::new(x, -2.0, 0.0),
                    Vec3::new(x + w, -2.0, 0.0),
                    Vec3::new(x + w, 2.0, 0.0),
                    Vec3::new(x, 2.0, 0.0),
                ]);
                i.extend([b, b + 1, b + 2, b, b + 2, b + 3]);
                // Gaps from none to some centimetres.
                x += w + [0.0, 0.001, 0.01, 0.05][r.below(4)];
            }
            (p, i)
        }
        1 => {
            let (a, k) = (r.range(0.0, 0.6) as f32, r.range(1.0, 9.0) as f32);
            grid(2 + r.below(14) as u32, |u, v| {
                Vec3::new(
                    u * 4.0 - 2.0,
                    v * 4.0 - 2.0,
                    a * (u * k).sin() * (v * k).cos(),
                )
            })
        }
        2 => grid(4 + r.below(16) as u32, |u, v| {
            let (a, b) = (
                u * core::f32::consts::TAU,
                (v - 0.5) * core::f32::consts::PI,
            );
            Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * 1.5
        }),
        3 => {
            let n = 1 + r.below(40);
            let p: Vec<Vec3> = (0..n * 3).map(|_| r.vec(2.5).as_vec3()).collect();
            let i = (0..p.len() as u32).collect();
            (p, i)
        }
        _ => {
            let h = Vec3::new(
                r.range(0.0, 2.0) as f32,
                r.range(0.1, 2.0) as f32,
                r.range(0.1, 2.0) as f32,
            );
            let p: Vec<Vec3> = (0..8)
                .map(|i| {
                    Vec3::new(
                        if i & 1 == 0 { -h.x } else { h.x },
                        if i & 2 == 0 { -h.y } else { h.y },
                        if i & 4 == 0 { -h.z } else { h.z },
                    )
                })
                .collect();
            let q = [
                [0, 4, 6, 2],
                [1, 3, 7, 5],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 2, 3, 1],
                [4, 5, 7, 6],
            ];
            (
                p,
                q.iter()
                    .flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]])
                    .collect(),
            )
        }
    }
}

pub fn scene(r: &mut Random, objects: usize, boxes: usize, origin: DVec3) -> Scene {
    let objects = (0..objects)
        .map(|_| {
            let (positions, indices) = shape(r);
            let rotation = if r.below(3) == 0 {
                DQuat::IDENTITY
            } else {
                DQuat::from_euler(
                    glam::EulerRot::XYZ,
                    r.range(-0.6, 0.6),
                    r.range(-3.2, 3.2),
                    r.range(-0.6, 0.6),
                )
            };
            let mut scale = DVec3::splat(r.range(0.4, 3.0));
            if r.below(3) == 0 {
                scale *= DVec3::new(r.range(0.3, 2.0), 1.0, r.range(0.3, 2.0));
            }
            if r.below(3) == 0 {
                scale.x = -scale.x;
            }
            let at =
                DVec3::new(r.range(-6.0, 6.0), r.range(-3.0, 3.0), r.range(-14.0, 1.0)) + origin;
            let m = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
            Object {
                positions,
                indices,
                transform: DAffine3::from_mat3_translation(m, at),
                two_sided: r.below(4) == 0,
            }
        })
        .collect();
    let boxes = (0..boxes)
        .map(|_| {
            let c =
                DVec3::new(r.range(-9.0, 9.0), r.range(-5.0, 5.0), r.range(-20.0, 2.0)).as_vec3();
            let s = 10f64.powf(r.range(-2.0, 0.6));
            let h = Vec3::new(
                r.range(0.0, s) as f32,
                r.range(0.0, s) as f32,
                r.range(0.0, s) as f32,
            );
            Aabb::new(c - h, c + h)
        })
        .collect();
    Scene {
        objects,
        boxes,
        origin,
    }
}

pub fn eye(r: &mut Random, origin: DVec3, orthographic: bool) -> Eye {
    let position = origin + r.vec(1.0) * DVec3::new(3.0, 1.5, 2.0);
    let target = position + DVec3::new(r.range(-0.6, 0.6), r.range(-0.4, 0.4), -1.0);
    let near = [0.02, 0.1, 0.5][r.below(3)];
    let far = if r.below(2) == 0 {
        f64::INFINITY
    } else {
        r.range(10.0, 40.0)
    };
    let projection = if orthographic {
        let (w, h) = (r.range(1.0, 8.0), r.range(1.0, 8.0));
        Projection::Orthographic {
            left: -w * r.next(),
            right: w,
            bottom: -h * r.next(),
            top: h,
            near_m: r.range(-2.0, 0.5),
            far_m: 30.0,
        }
    } else {
        let (w, h) = (r.range(0.2, 1.3), r.range(0.2, 1.3));
        Projection::Perspective {
            left: -w * r.range(0.2, 1.0),
            right: w,
            bottom: -h * r.range(0.2, 1.0),
            top: h,
            near_m: near,
            far_m: far,
        }
    };
    Eye::look_at(position, target, DVec3::Y, projection)
}

pub fn occluders(scene: &Scene, order: &[usize]) -> OccluderSet {
    let mut set = OccluderSet::new();
    for &i in order {
        let o = &scene.objects[i];
        let mesh = OccluderMesh::bake(
            &o.positions,
            &o.indices,
            BakeOptions::default()
                .with_two_sided(o.two_sided)
                .with_adjacency(i % 3 != 2),
        )
        .unwrap();
        set.add(Arc::new(mesh), o.transform).unwrap();
    }
    set
}

pub fn answers(
    culler: &mut Culler,
    view: &View,
    set: &OccluderSet,
    scene: &Scene,
    threads: &dyn Threads,
) -> Vec<Visibility> {
    culler
        .rasterize(view, set, &FrameOptions::default(), threads)
        .unwrap();
    let mut results = vec![Visibility::Visible; scene.boxes.len()];
    culler
        .query(&scene.boxes, scene.origin, &mut results)
        .unwrap();
    results
}

/// The reference of a scene at `n` times the samples of a buffer.
pub struct Exact {
    reference: Reference,
    size: (u32, u32),
    n: u32,
}

impl Exact {
    pub fn new(scene: &Scene, eye: &Eye, (w, h): (u32, u32), n: u32) -> Self {
        let mut reference = Reference::new(eye, w * n, h * n).unwrap();
        for o in &scene.objects {
            reference.add(&o.positions, &o.indices, o.transform, o.two_sided);
        }
        reference.finish();
        let size = (w, h);
        Self { reference, size, n }
    }

    /// Per pixel of the buffer, the farthest depth of its samples; 0 where one is not covered.
    pub fn farthest(&self) -> Vec<f32> {
        let ((w, h), n) = (self.size, self.n);
        let at = |x: u32, y: u32| self.reference.depth()[(y * w * n + x) as usize];
        let pixel = |x: u32, y: u32| {
            (0..n * n)
                .map(|i| at(x * n + i % n, y * n + i / n))
                .fold(f32::INFINITY, f32::min)
        };
        (0..w * h).map(|i| pixel(i % w, i / w)).collect()
    }

    /// Boxes that are seen although they were culled.
    pub fn wrongly_culled(&self, scene: &Scene, results: &[Visibility]) -> Vec<usize> {
        let seen = |i: usize| self.reference.seen(&scene.boxes[i], scene.origin);
        (0..results.len())
            .filter(|&i| !results[i].is_visible() && seen(i) == Seen::Visible)
            .collect()
    }
}

/// Boxes that the reference at `n` times the size sees although they were culled.
pub fn wrongly_culled(
    scene: &Scene,
    eye: &Eye,
    size: (u32, u32),
    n: u32,
    results: &[Visibility],
) -> Vec<usize> {
    if results.iter().all(|r| r.is_visible()) {
        return Vec::new();
    }
    Exact::new(scene, eye, size, n).wrongly_culled(scene, results)
}

/// Results of a set, by its hierarchy and as it chooses itself: what the list shows it shows, but for
/// groups that are hidden as a whole. How many the hierarchy culls, and how many of them the list does
/// not.
pub fn assert_as_a_list(culler: &Culler, set: &OccludeeSet, ids: &[OccludeeId]) -> [usize; 2] {
    let mut by_tree = set.clone();
    testing::prefer_tree(&mut by_tree);
    of_set_and_list(culler, set, ids);
    of_set_and_list(culler, &by_tree, ids)
}

fn of_set_and_list(culler: &Culler, set: &OccludeeSet, ids: &[OccludeeId]) -> [usize; 2] {
    let boxes: Vec<Aabb> = ids.iter().map(|id| set.bounds(*id).unwrap()).collect();
    let mut list = vec![Visibility::Visible; ids.len()];
    culler.query(&boxes, DVec3::ZERO, &mut list).unwrap();
    let mut results = vec![Visibility::Visible; set.result_count()];
    culler.query_set(set, &mut results).unwrap();
    let (mut culled, mut more) = (0, 0);
    for ((id, bounds), of_list) in ids.iter().zip(&boxes).zip(list) {
        let of_set = results[id.index()];
        culled += usize::from(!of_set.is_visible());
        more += usize::from(of_list.is_visible() && !of_set.is_visible());
        assert!(!of_set.is_visible() || of_list.is_visible(), "{bounds:?}");
        assert!(bounds.is_valid() || of_set.is_visible(), "{bounds:?}");
    }
    [culled, more]
}
