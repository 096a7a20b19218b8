//! Casters of the demo scene's shadow maps: by the frusta of 16 point lights alone, and without those
//! that `foveal-cull` leaves out.
//!
//! `cargo test --release -p foveal-generate --test shadow_casters -- --nocapture` prints the counts.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use foveal_cull::reference::Reference;
use foveal_cull::{
    Aabb, Affine, BakeOptions, Culler, Eye, FrameOptions, Matrix4, OccluderMesh, OccluderSet,
    Projection, ReceiverMask, SingleThread, View, Visibility,
};
use foveal_generate::DemoOptions;
use foveal_scene::{AlphaMode, Instance, LightKind, Scene};
use glam::{DVec3, Vec3};

/// Side of a shadow map, texels; of the reference's, which is slow, and whose texels have their
/// centres at every seventh one of the others.
const MAP: u32 = 448;
const EXACT_MAP: u32 = MAP / 7;
/// Sides of the cells that surfaces are cut into, metres.
const CELL_M: f32 = 1.0;
/// What the six sides of a lamp's cube look at, and what is above there.
const SIDES: [[[f64; 3]; 2]; 6] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
];

fn aabb(b: foveal_scene::Aabb) -> Aabb {
    Aabb::new(b.min, b.max)
}

fn affine(instance: &Instance) -> Affine {
    Affine::from_matrix(Matrix4::from(instance.world_from_object.to_cols_array_2d())).unwrap()
}

fn meets_sphere(b: &Aabb, center: Vec3, radius: f32) -> bool {
    let nearest = center.clamp(Vec3::from(b.min), Vec3::from(b.max));
    nearest.distance_squared(center) <= radius * radius
}

/// Instances that cast shadows: all opaque and masked ones.
fn casters(scene: &Scene) -> Vec<Instance> {
    let casts = |i: &&Instance| {
        let material = &scene.materials[i.material as usize];
        !matches!(material.alpha_mode, AlphaMode::Blend) && scene.is_visible(i)
    };
    scene.instances.iter().filter(casts).copied().collect()
}

fn occluders(scene: &Scene, all: bool) -> OccluderSet {
    let (mut set, mut baked) = (OccluderSet::new(), HashMap::new());
    for i in scene.instances.iter().filter(|i| scene.can_occlude(i)) {
        let two_sided = scene.materials[i.material as usize].double_sided;
        if !all && scene.objects[i.object as usize].occluder != Some(true) {
            continue;
        }
        let mesh = baked.entry((i.mesh, two_sided)).or_insert_with(|| {
            let mesh = &scene.meshes[i.mesh as usize];
            let positions: Vec<[f32; 3]> = mesh.vertices.iter().map(|v| v.position).collect();
            let options = BakeOptions::default().with_two_sided(two_sided);
            Arc::new(OccluderMesh::bake(&positions, &mesh.indices, options).unwrap())
        });
        set.add(Arc::clone(mesh), affine(i)).unwrap();
    }
    set
}

/// Boxes around the surfaces in each cell of a grid, near the lamps.
fn cells(scene: &Scene, lamps: &[(Vec3, f32)]) -> Vec<Aabb> {
    let mut cells: HashMap<[i32; 3], Aabb> = HashMap::new();
    for i in &scene.instances {
        let b = aabb(i.bounds);
        if !lamps.iter().any(|&(at, range)| meets_sphere(&b, at, range)) {
            continue;
        }
        let mesh = &scene.meshes[i.mesh as usize];
        let place = |v: u32| {
            let p = mesh.vertices[v as usize].position;
            i.world_from_object.transform_point3(p.into())
        };
        for t in mesh.indices.as_chunks::<3>().0 {
            let all = Aabb::of_points(t.map(place));
            let [low, high] = [all.min, all.max].map(|v| v.map(|v| (v / CELL_M).floor() as i32));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        let corner = [x, y, z].map(|v| v as f32 * CELL_M);
                        let min = [0, 1, 2].map(|k| all.min[k].max(corner[k]));
                        let max = [0, 1, 2].map(|k| all.max[k].min(corner[k] + CELL_M));
                        let here = cells.entry([x, y, z]).or_insert(Aabb::EMPTY);
                        *here = here.union(Aabb::new(min, max));
                    }
                }
            }
        }
    }
    let near = |b: &Aabb| lamps.iter().any(|&(at, range)| meets_sphere(b, at, range));
    cells.into_values().filter(near).collect()
}

fn visible(results: &[Visibility]) -> impl Iterator<Item = usize> {
    let number = |(i, r): (usize, &Visibility)| r.is_visible().then_some(i);
    results.iter().enumerate().filter_map(number)
}

/// Depths of a shadow map of some casters, without any culling.
fn shadow_map(scene: &Scene, side: &Eye, casters: impl Iterator<Item = Instance>) -> Vec<f32> {
    let mut map = Reference::new(side, EXACT_MAP, EXACT_MAP).unwrap();
    for i in casters {
        let mesh = &scene.meshes[i.mesh as usize];
        let positions: Vec<[f32; 3]> = mesh.vertices.iter().map(|v| v.position).collect();
        map.add(&positions, &mesh.indices, affine(&i), true);
    }
    map.finish();
    map.depth().to_vec()
}

/// The texel of a place in a lamp's side, and its depth there.
fn lookup(side: &Eye, place: DVec3, far_m: f64) -> Option<(usize, f64)> {
    let a = side.world_from_eye;
    let p = place - DVec3::from(a.translation);
    let [right, up, back] = [a.x_axis, a.y_axis, a.z_axis].map(|axis| DVec3::from(axis).dot(p));
    let along = -back;
    let size = f64::from(EXACT_MAP);
    let [x, y] = [right / along, -up / along].map(|v| (0.5 + 0.5 * v) * size);
    let on = (0.0..size).contains(&x) && (0.0..size).contains(&y);
    if !on || !(NEAR_M..far_m).contains(&along) {
        return None;
    }
    let texel = y as usize * EXACT_MAP as usize + x as usize;
    Some((texel, NEAR_M / along))
}

const NEAR_M: f64 = 0.05;

/// Draws of casters into all shadow maps.
#[derive(Debug, Default)]
struct Draws {
    by_frusta: usize,
    not_hidden: usize,
    left: usize,
    /// Lamps whose whole reach is hidden from the camera or beside its picture, and maps without a
    /// receiver.
    lamps: usize,
    maps: usize,
    compared: usize,
    /// Of the compared places those in shadow.
    shaded: usize,
}

fn draws(scene: &Scene, camera: &foveal_scene::Camera, all: bool) -> Draws {
    let foveal_scene::Projection::Perspective { fov_y_rad, near_m } = camera.projection else {
        panic!("the demo's cameras are pinholes");
    };
    let lamps: Vec<(Vec3, f32)> = (scene.lights.iter())
        .filter(|l| l.kind == LightKind::Point)
        .map(|l| (l.position, l.range_m.unwrap()))
        .collect();
    assert_eq!(lamps.len(), 16);
    let (casters, occluders) = (casters(scene), occluders(scene, all));
    let boxes: Vec<Aabb> = casters.iter().map(|i| aabb(i.bounds)).collect();
    let (origin, options) = ([0.0; 3], FrameOptions::default());

    // What the camera sees.
    let pose = Affine::from_matrix(Matrix4::from(camera.world_from_view.to_cols_array_2d()));
    let projection =
        Projection::perspective(fov_y_rad.into(), 16.0 / 9.0, near_m.into(), f64::INFINITY);
    let view = View::mono(Eye::new(pose.unwrap(), projection));
    let mut culler = Culler::new(480, 270).unwrap();
    culler
        .rasterize(&view, &occluders, &options, &SingleThread)
        .unwrap();
    let receivers = cells(scene, &lamps);
    let mut seen = vec![Visibility::Visible; receivers.len()];
    culler.query(&receivers, origin, &mut seen).unwrap();
    let spheres: Vec<Aabb> = (lamps.iter())
        .map(|&(at, range)| Aabb::new(at - range, at + range))
        .collect();
    let mut lamps_seen = vec![Visibility::Visible; lamps.len()];
    culler.query(&spheres, origin, &mut lamps_seen).unwrap();

    let mut draws = Draws::default();
    for (lamp, &(at, range)) in lamps.iter().enumerate() {
        let in_reach = |i: &usize| meets_sphere(&boxes[*i], at, range);
        draws.lamps += usize::from(!lamps_seen[lamp].is_visible());
        for [forward, up] in SIDES {
            let at = at.as_dvec3();
            let frustum = Projection::perspective(FRAC_PI_2, 1.0, NEAR_M, range.into());
            let side = Eye::look_at(at, at + DVec3::from(forward), up, frustum);
            let view = View::mono(side);
            let mut map = Culler::new(MAP / 4, MAP / 4).unwrap();
            let mut results = vec![Visibility::Visible; boxes.len()];
            let frusta = options.with_occlusion(false);
            map.rasterize(&view, &occluders, &frusta, &SingleThread)
                .unwrap();
            map.query(&boxes, origin, &mut results).unwrap();
            let by_frustum: Vec<usize> = visible(&results).filter(in_reach).collect();
            draws.by_frusta += by_frustum.len();
            if !lamps_seen[lamp].is_visible() {
                continue;
            }
            map.rasterize(&view, &occluders, &options, &SingleThread)
                .unwrap();
            map.query(&boxes, origin, &mut results).unwrap();
            draws.not_hidden += visible(&results).filter(in_reach).count();
            // As far as the centre of the reference's texel.
            let mut mask = ReceiverMask::new(&view, MAP).unwrap().with_reach(4.0, 0.0);
            let lit: Vec<Visibility> = (receivers.iter().zip(&seen))
                .map(|(b, s)| {
                    if meets_sphere(b, at.as_vec3(), range) {
                        *s
                    } else {
                        Visibility::Outside
                    }
                })
                .collect();
            mask.receive(&receivers, origin, &lit).unwrap();
            draws.maps += usize::from(mask.is_empty());
            mask.cull(&boxes, origin, &mut results).unwrap();
            let left: Vec<usize> = visible(&results).filter(in_reach).collect();
            draws.left += left.len();

            // The same shadows at every place that is seen.
            let [all, fewer] = [&by_frustum, &left]
                .map(|of| shadow_map(scene, &side, of.iter().map(|&i| casters[i])));
            for b in visible(&lit).map(|i| &receivers[i]) {
                let [low, high] = [b.min, b.max].map(|v| Vec3::from(v).as_dvec3());
                for part in [[0.5, 0.5, 0.5], [0.1, 0.9, 0.3], [0.8, 0.2, 0.6]] {
                    let place = low + (high - low) * DVec3::from(part);
                    if let Some((texel, depth)) = lookup(&side, place, range.into()) {
                        let [a, b] = [&all, &fewer].map(|map| f64::from(map[texel]) > depth);
                        assert_eq!(a, b, "lamp {lamp}, {forward:?}: {place}");
                        draws.compared += 1;
                        draws.shaded += usize::from(a);
                    }
                }
            }
        }
    }
    draws
}

#[test]
fn sixteen_lamps_need_fewer_casters_and_no_shadow_that_is_seen_changes() {
    let options = DemoOptions {
        lights: 16,
        ..DemoOptions::default()
    };
    let scene = foveal_generate::demo(&options).unwrap();
    for camera in &scene.cameras {
        // Walls, houses, gates and the ground occlude, or everything that is opaque.
        for all in [false, true] {
            let d = draws(&scene, camera, all);
            println!(
                "camera {}, {}: {} draws of casters by frusta, {} that lamps see, {} left: {:.2} times \
                 fewer; without {} lamps, and {} maps of the others; {} lookups compared, {} in shadow",
                camera.name,
                if all { "all occlude" } else { "walls occlude" },
                d.by_frusta,
                d.not_hidden,
                d.left,
                d.by_frusta as f64 / d.left as f64,
                d.lamps,
                d.maps,
                d.compared,
                d.shaded
            );
            assert!(
                d.left * 5 < d.by_frusta * 4 && d.compared > 1000 && d.shaded > 100,
                "{}: {d:?}",
                camera.name
            );
        }
    }
}
