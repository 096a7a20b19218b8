//! Ambient occlusion in pictures: against the twin, what open places and corners get, with every way
//! of shading.

use foveal_generate as generate;
use foveal_scene::{Aabb, Camera, Instance, Material, Mesh, Object, Projection, Scene, Vertex};
use glam::{Mat4, UVec2, Vec3};

use super::OcclusionUniform;
use super::twin::Twin;
use crate::testing::{
    Film, f32_of_half, picture, rate_cells, rendered, rounds_alike, shifted, small, texels,
};
use crate::{
    AmbientOcclusion, Antialiasing, Composite, EnvironmentSource, Geometry, Renderer, Settings,
    Shading, Stereo,
};

const WIDTH: u32 = 97;
const HEIGHT: u32 = 65;

fn occluded(width: u32, height: u32) -> Settings {
    small(width, height).with(|s| {
        s.lighting.ambient_occlusion = AmbientOcclusion::Screen;
        s.lighting.environment = EnvironmentSource::Sky;
    })
}

/// Visibility and distance of each texel of the target.
fn found(renderer: &Renderer) -> Vec<[f32; 2]> {
    let targets = renderer.targets().ambient.as_ref();
    texels(&targets.expect("it is on").resolved)
}

fn depths(renderer: &Renderer) -> Vec<f32> {
    texels(&renderer.targets().gbuffer.depth_view)
}

/// Floor, and with two or three of them walls, of a room that reaches from the origin along x, y
/// and z: squares of side 4 that look inwards.
fn corner(sides: usize) -> Scene {
    let axes = [Vec3::Y, Vec3::X, Vec3::Z];
    let meshes: Vec<Mesh> = (axes[..sides].iter().enumerate())
        .map(|(i, &normal)| {
            let (a, b) = (4.0 * axes[(i + 1) % 3], 4.0 * axes[(i + 2) % 3]);
            let corners = [Vec3::ZERO, a, a + b, b];
            let vertices = corners.map(|position| Vertex {
                position: position.into(),
                normal: normal.into(),
                tangent: [0.0; 4],
                uv: [[0.0; 2]; 2],
                color: [u16::MAX; 4],
            });
            Mesh {
                name: format!("side {i}"),
                vertices: vertices.to_vec(),
                indices: vec![0, 1, 2, 0, 2, 3],
                bounds: Aabb::of_points(corners),
                ..Mesh::default()
            }
        })
        .collect();
    let material = Material {
        metallic: 0.0,
        roughness: 1.0,
        double_sided: true,
        ..Material::default()
    };
    let instances: Vec<Instance> = (0..)
        .zip(&meshes)
        .map(|(i, mesh)| Instance {
            mesh: i,
            material: 0,
            object: i,
            world_from_object: Mat4::IDENTITY,
            bounds: mesh.bounds,
        })
        .collect();
    let objects = (0..)
        .zip(&instances)
        .map(|(i, instance)| Object {
            name: format!("side {i}"),
            node: i,
            element: 0,
            visible: true,
            occluder: None,
            set: None,
            bounds: instance.bounds,
            instances: i..i + 1,
        })
        .collect();
    Scene {
        meshes,
        materials: vec![material],
        objects,
        instances,
        ..Scene::default()
    }
}

fn look(from: [f32; 3], to: [f32; 3], degrees: f32) -> Camera {
    Camera::look_at(from.into(), to.into(), Vec3::Y, degrees.to_radians())
}

fn flat(camera: &Camera) -> Camera {
    Camera {
        projection: Projection::Orthographic {
            height_m: 5.0,
            near_m: 0.1,
            far_m: 40.0,
        },
        ..camera.clone()
    }
}

/// Levels of the frame's rate map, where it has one.
fn levels(renderer: &Renderer) -> impl Fn(UVec2) -> u32 {
    let coarse = renderer.targets().coarse.as_ref();
    let (across, cells) = coarse.map_or((1, Vec::new()), |coarse| {
        let owner = &coarse.rate.owner;
        (owner.blocks(1).0, rate_cells(owner, 1))
    });
    move |at: UVec2| {
        let cell = cells.get((at.y / 2 * across + at.x / 2) as usize);
        cell.map_or(0, |cell| u32::from(cell & 15))
    }
}

fn assert_equals_twin(scene: &Scene, camera: &Camera, settings: &Settings) {
    let renderer = rendered(scene, camera, settings);
    let depths = depths(&renderer);
    let level_at = levels(&renderer);
    let size = UVec2::new(settings.picture.width, settings.picture.height);
    let twin = Twin {
        camera,
        size,
        depths: &depths,
        reach: OcclusionUniform::new(settings, renderer.diagonal_m()),
    };
    let (mut surfaces, mut off, mut dark, mut blocks) = (0, 0, 0, 0);
    for (i, device) in found(&renderer).into_iter().enumerate() {
        let at = UVec2::new(i as u32 % size.x, i as u32 / size.x);
        if depths[i] == 0.0 {
            assert_eq!(device, [1.0, -1.0], "background at {at}");
            continue;
        }
        let cpu = twin.resolved(at, &level_at);
        assert!((device[1] - twin.distance(depths[i])).abs() <= 1e-4 * device[1]);
        // A step that ends between two texels may be rounded to either.
        off += usize::from((device[0] - cpu).abs() > 0.01);
        assert!(
            (device[0] - cpu).abs() <= 0.15,
            "at {at}: {device:?}, twin {cpu}"
        );
        surfaces += 1;
        dark += usize::from(cpu < 0.8);
        blocks += usize::from(level_at(at) > 0);
    }
    assert!(surfaces > 500 && dark > 5, "{surfaces} seen, {dark} dark");
    assert!(off * 50 <= surfaces, "{off} of {surfaces}");
    let is_coarse = settings.shading.mode == Shading::Coarse;
    assert_eq!(blocks > 200, is_coarse, "{blocks} in blocks");
}

#[test]
fn what_is_found_equals_the_twin_at_pixels_and_at_blocks() {
    let settings = occluded(WIDTH, HEIGHT);
    let coarse = settings.clone().with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = crate::RateSource::Radii;
    });
    let grid = generate::materials_grid();
    let cornell = generate::cornell();
    for settings in [&settings, &coarse] {
        assert_equals_twin(&grid, &grid.cameras[0], settings);
        assert_equals_twin(&cornell, &cornell.cameras[0], settings);
    }
    let small = settings.with(|s| s.lighting.ambient_occlusion_radius_m = 0.3);
    assert_equals_twin(&cornell, &cornell.cameras[0], &small);
    let camera = flat(&look([3.0, 2.5, 3.5], [0.8, 0.5, 0.8], 50.0));
    assert_equals_twin(&corner(3), &camera, &small);
}

#[test]
fn an_open_plane_gets_all_of_the_light_from_every_side_and_with_every_field_of_view() {
    let scene = corner(1);
    for camera in [
        look([2.0, 3.0, 2.1], [2.0, 0.0, 2.0], 60.0),
        look([2.0, 0.3, 5.0], [2.0, 0.0, 2.0], 60.0),
        look([2.0, 0.5, 2.0], [2.3, 0.0, 2.0], 150.0),
        look([-1.0, 0.2, 2.0], [2.0, 0.0, 2.5], 120.0),
        flat(&look([2.0, 1.0, 5.0], [2.0, 0.0, 2.0], 60.0)),
    ] {
        for shading in [Shading::Full, Shading::Coarse] {
            let settings = occluded(WIDTH, HEIGHT).with(|s| s.shading.mode = shading);
            let renderer = rendered(&scene, &camera, &settings);
            let all = found(&renderer);
            let seen = all.iter().filter(|found| found[1] > 0.0);
            assert!(seen.clone().count() > 100);
            for [visibility, _] in seen {
                assert!(*visibility >= 0.999, "{visibility}");
            }
        }
    }
}

#[test]
fn a_crease_is_darker_than_a_plane_and_a_corner_darker_than_a_crease() {
    let camera = look([3.0, 2.0, 3.0], [0.0, 0.05, 0.0], 8.0);
    let darkest = |sides| {
        let settings =
            occluded(WIDTH, HEIGHT).with(|s| s.lighting.ambient_occlusion_radius_m = 1.0);
        let all = found(&rendered(&corner(sides), &camera, &settings));
        let seen = all.iter().filter(|found| found[1] > 0.0);
        seen.map(|found| found[0]).fold(1.0, f32::min)
    };
    let [plane, crease, corner] = [1, 2, 3].map(darkest);
    assert!(plane >= 0.999, "{plane}");
    // Half of the hemisphere's light, and a quarter of it.
    assert!((0.4..0.65).contains(&crease), "{crease}");
    assert!((0.15..0.4).contains(&corner), "{corner}");
}

#[test]
fn far_from_the_crease_nothing_is_occluded() {
    let camera = look([3.0, 2.0, 3.0], [1.5, 1.0, 1.5], 70.0);
    let settings = occluded(WIDTH, HEIGHT).with(|s| s.lighting.ambient_occlusion_radius_m = 0.2);
    let renderer = rendered(&corner(3), &camera, &settings);
    let twin = |i: usize| UVec2::new(i as u32 % WIDTH, i as u32 / WIDTH).as_vec2() + 0.5;
    let depths = depths(&renderer);
    let size = UVec2::new(WIDTH, HEIGHT).as_vec2();
    let mut open = 0;
    for (i, [visibility, distance]) in found(&renderer).into_iter().enumerate() {
        if distance > 0.0 {
            let at = crate::shading::twin::position_at(&camera, size, twin(i), depths[i]);
            let mut away = at.to_array();
            away.sort_by(f32::total_cmp);
            if away[1] > 0.35 {
                assert!(visibility >= 0.99, "{visibility} at {at}");
                open += 1;
            }
        }
    }
    assert!(open > 500, "{open}");
}

#[test]
fn without_an_environment_or_a_size_worth_naming_it_does_nothing_wrong() {
    let scene = generate::cornell();
    let camera = &scene.cameras[0];
    let none = occluded(WIDTH, HEIGHT).with(|s| s.lighting.environment = EnvironmentSource::None);
    let off = none
        .clone()
        .with(|s| s.lighting.ambient_occlusion = AmbientOcclusion::Off);
    let renderer = rendered(&scene, camera, &none);
    assert!(renderer.targets().ambient.is_none(), "nothing to dim");
    assert_eq!(picture(&renderer), picture(&rendered(&scene, camera, &off)));
    for (width, height) in [(1, 1), (2, 1), (1, 7), (3, 3)] {
        for shading in [Shading::Full, Shading::Coarse, Shading::Variable] {
            let settings = occluded(width, height).with(|s| s.shading.mode = shading);
            let all = found(&rendered(&scene, camera, &settings));
            assert_eq!(all.len() as u32, width * height);
            assert!(all.iter().all(|found| (0.0..=1.0).contains(&found[0])));
        }
    }
}

#[test]
fn radii_that_make_no_sense_are_refused() {
    for radius in [-1.0, f32::NAN, f32::INFINITY] {
        let settings = occluded(8, 8).with(|s| s.lighting.ambient_occlusion_radius_m = radius);
        let refused = settings.validate(&wgpu::Limits::default());
        let text = refused.expect_err("makes no sense").to_string();
        assert!(text.contains("ambient-occlusion-radius"), "{text}");
    }
}

#[test]
fn it_takes_memory_only_where_it_is_on() {
    let scene = generate::cornell();
    let bytes = |settings: &Settings| {
        let renderer = rendered(&scene, &scene.cameras[0], settings);
        renderer.targets().bytes()
    };
    let on = occluded(64, 64);
    let off = small(64, 64).with(|s| s.lighting.environment = EnvironmentSource::Sky);
    assert_eq!(bytes(&on) - bytes(&off), 64 * 64 * 12);
}

#[test]
fn the_same_frame_gives_the_same_bytes() {
    let scene = generate::materials_grid();
    let camera = &scene.cameras[0];
    for shading in [Shading::Full, Shading::Coarse, Shading::Variable] {
        for history in [false, true] {
            let settings = occluded(WIDTH, HEIGHT).with(|s| {
                s.shading.mode = shading;
                s.coarse.history = history;
            });
            let mut films = [0, 1].map(|_| Film::new(&scene, &settings));
            for frame in 0..3 {
                let there = shifted(camera, 0.02 * frame as f32);
                let pictures = films.each_mut().map(|film| {
                    film.draw(&there);
                    (found(&film.renderer), film.radiance())
                });
                assert!(pictures[0] == pictures[1], "{shading:?}, frame {frame}");
            }
        }
    }
}

#[test]
fn two_eyes_see_what_each_sees_alone() {
    let scene = generate::cornell();
    let mut camera = scene.cameras[0].clone();
    let settings = occluded(64, 48).with(|s| s.lighting.ambient_occlusion_radius_m = 0.7);
    let alone = found(&rendered(&scene, &camera, &settings));
    for shading in [Shading::Full, Shading::Coarse] {
        let both = settings.clone().with(|s| {
            s.stereo.mode = Stereo::Instanced;
            s.stereo.ipd_m = 0.0;
            s.stereo.output = crate::Output::SideBySide;
            s.shading.mode = shading;
            s.coarse.source = crate::RateSource::Constant;
        });
        let renderer = rendered(&scene, &camera, &both);
        let width = renderer.targets().radiance_view.texture().width();
        let all = found(&renderer);
        for (i, one) in alone.iter().enumerate() {
            let (x, y) = (i as u32 % 64, i as u32 / 64);
            for eye in 0..2 {
                let at = (y * width + eye * (width - 64) + x) as usize;
                let off = (0..2).map(|i| (all[at][i] - one[i]).abs() / one[i].abs().max(1.0));
                let most = if rounds_alike() { 0.0 } else { 1e-5 };
                assert!(
                    off.clone().all(|off| off <= most),
                    "{shading:?}, eye {eye}, at {x}, {y}: {:?} and {one:?}",
                    all[at]
                );
            }
        }
    }
    camera.world_from_view.w_axis.x += 0.1;
    assert!(alone != found(&rendered(&scene, &camera, &settings)));
}

#[test]
fn at_rest_what_is_found_is_that_of_full_shading() {
    let scene = generate::materials_grid();
    let camera = &scene.cameras[0];
    let full = rendered(&scene, camera, &occluded(WIDTH, HEIGHT));
    let settings = occluded(WIDTH, HEIGHT).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = crate::RateSource::Radii;
        s.coarse.history = true;
    });
    let mut film = Film::new(&scene, &settings);
    film.draw(&shifted(camera, 0.1));
    film.draw(camera);
    assert!(found(&film.renderer) != found(&full), "in motion");
    for _ in 0..20 {
        film.draw(camera);
    }
    assert!(found(&film.renderer) == found(&full), "at rest");
    let radiance: Vec<[u16; 4]> = texels(&full.targets().radiance_view);
    assert!(film.radiance() == radiance, "at rest");
}

#[test]
fn every_way_of_shading_dims_alike() {
    let mut scene = generate::cornell();
    scene.lights.clear();
    for material in &mut scene.materials {
        material.emissive = Vec3::ZERO;
    }
    let camera = &scene.cameras[0];
    let light = |settings: &Settings| {
        let renderer = rendered(&scene, camera, settings);
        let texels: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
        let sum: f32 = texels.iter().map(|t| f32_of_half(t[1])).sum();
        sum / texels.len() as f32
    };
    let plain = occluded(96, 64).with(|s| {
        s.lighting.ambient_occlusion_radius_m = 1.0;
        s.lighting.background = crate::Background::None;
    });
    let open = light(
        &plain
            .clone()
            .with(|s| s.lighting.ambient_occlusion = AmbientOcclusion::Off),
    );
    let full = light(&plain);
    assert!(full < 0.95 * open, "{full} of {open}");
    let ways: [&dyn Fn(&mut Settings); 9] = [
        &|s| s.geometry.path = Geometry::Visibility,
        &|s| s.shading.mode = Shading::Coarse,
        &|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.history = true;
        },
        &|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.composite = Composite::Smooth;
        },
        &|s| s.shading.mode = Shading::Variable,
        &|s| s.antialiasing.mode = Antialiasing::Msaa,
        &|s| s.antialiasing.mode = Antialiasing::Ssaa,
        &|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.geometry.path = Geometry::Visibility;
        },
        &|s| {
            s.antialiasing.mode = Antialiasing::Ssaa;
            s.geometry.path = Geometry::Visibility;
        },
    ];
    for (i, way) in ways.into_iter().enumerate() {
        let mut settings = plain.clone();
        way(&mut settings);
        let found = light(&settings);
        assert!(
            (found - full).abs() < 0.02 * full,
            "way {i}: {found}, {full}"
        );
    }
}

#[test]
fn surfaces_with_lobes_are_dimmed_and_glass_is_drawn_as_before() {
    let mut scene = generate::lobes();
    scene.lights.clear();
    assert!(scene.materials.iter().any(|m| m.transmission.is_some()));
    let camera = &scene.cameras[0];
    for aa in [Antialiasing::None, Antialiasing::Msaa] {
        let light = |occlusion| {
            let settings = occluded(96, 64).with(|s| {
                s.lighting.ambient_occlusion = occlusion;
                s.lighting.ambient_occlusion_radius_m = 2.0;
                s.lighting.background = crate::Background::None;
                s.antialiasing.mode = aa;
            });
            let renderer = rendered(&scene, camera, &settings);
            let texels: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
            let green = texels.iter().map(|t| f32_of_half(t[1]));
            green.sum::<f32>()
        };
        let [off, screen] = [AmbientOcclusion::Off, AmbientOcclusion::Screen].map(light);
        assert!(
            screen < 0.995 * off && screen > 0.3 * off,
            "{screen}, {off}"
        );
    }
}

#[test]
fn what_lies_behind_the_eye_of_a_parallel_camera_is_dimmed_alike() {
    let scene = corner(3);
    let camera = flat(&look([3.0, 2.5, 3.5], [0.0; 3], 50.0));
    let settings = occluded(WIDTH, HEIGHT);
    let green = |camera: &Camera, settings: &Settings| -> Vec<f32> {
        let drawn = rendered(&scene, camera, settings);
        let texels = texels::<[u16; 4]>(&drawn.targets().radiance_view);
        texels.into_iter().map(|t| f32_of_half(t[1])).collect()
    };
    let before = green(&camera, &settings);
    // Past the room.
    let mut moved = camera.clone();
    let by = 20.0;
    moved.world_from_view.w_axis -= by * camera.world_from_view.z_axis;
    moved.projection = Projection::Orthographic {
        height_m: 5.0,
        near_m: 0.1 - by,
        far_m: 40.0 - by,
    };
    let after = green(&moved, &settings);
    let off = |other: &[f32]| {
        let pairs = before.iter().zip(other);
        let off = pairs.filter(|(a, b)| (*a - *b).abs() > 0.02 * a.max(0.01));
        off.count() as f32 / before.len() as f32
    };
    assert!(off(&after) < 0.02, "{}", off(&after));
    // The test can tell.
    let open = settings.with(|s| s.lighting.ambient_occlusion = AmbientOcclusion::Off);
    let open = green(&camera, &open);
    assert!(off(&open) > 0.1, "{}", off(&open));
}
