//! Points and lines among other things: what hides them and what they hide, light, and settings.

use foveal_scene::{AlphaMode, Light, LightKind, Material, Mesh, Scene, Vertex};
use glam::{Mat4, Vec3, Vec4};
use pollster::block_on;

use super::strokes_tests::{SIZE, black, compare, lines, scene_of, sized, vertex, white};
use super::twin::{assert_near, front, glass, quads};
use crate::testing::{Film, add, picture, radiance, rendered, rendered_on, small};
use crate::{Antialiasing, Culling, Geometry, Gpu, Settings, Shadows, Stereo};

const SIDE: u32 = 31;

const ALL: [Antialiasing; 3] = [Antialiasing::None, Antialiasing::Msaa, Antialiasing::Ssaa];

fn wide(width: f32) -> Settings {
    small(SIDE, SIDE).with(|s| {
        s.geometry.line_width_px = width;
        s.geometry.point_size_px = width;
    })
}

/// A line across the whole picture, and a point in its middle.
fn across(z: f32, color: [u8; 3]) -> Mesh {
    Mesh {
        vertices: [-5.0, 5.0, 0.0]
            .map(|x| vertex(Vec3::new(x, 0.0, z), color))
            .to_vec(),
        lines: vec![[0, 1]],
        points: vec![2],
        ..Mesh::default()
    }
}

fn unlit(color: Vec3) -> Material {
    Material {
        base_color: color.extend(1.0),
        unlit: true,
        double_sided: true,
        ..Material::default()
    }
}

fn sun(direction: Vec3) -> Light {
    Light {
        kind: LightKind::Directional,
        color: Vec3::ONE,
        intensity: std::f32::consts::PI,
        position: Vec3::ZERO,
        direction: direction.normalize(),
        range_m: None,
        node: None,
    }
}

/// The surfaces of `quads`, and nothing else that shines.
fn surfaces(materials: Vec<Material>, z: &[f32]) -> Scene {
    Scene {
        environment: black(),
        ..quads(materials, z)
    }
}

fn middle(scene: &Scene, settings: &Settings) -> Vec3 {
    let drawn = rendered(scene, &front(), settings);
    let row = drawn.targets().radiance_view.texture().width();
    radiance(&drawn)[(SIDE / 2 * row + SIDE / 2) as usize]
}

#[test]
fn glass_behind_strokes_leaves_them_and_before_them_shows_them() {
    let green = Vec3::new(0.2, 0.9, 0.5);
    let one = ALL.map(|mode| (mode, Stereo::Off));
    let two = [Stereo::TwoPass, Stereo::Instanced].map(|stereo| (Antialiasing::Msaa, stereo));
    for (mode, stereo) in one.into_iter().chain(two) {
        let settings = wide(5.0).with(|s| {
            s.antialiasing.mode = mode;
            s.stereo.mode = stereo;
            s.stereo.ipd_m = 0.01;
        });
        // Through the holes of masked strokes the glass is seen.
        let mut hole = unlit(Vec3::X);
        hole.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        hole.base_color.w = 0.25;
        for (z, material, expected) in [
            (0.5, unlit(Vec3::X), Vec3::X),
            (-0.5, unlit(Vec3::X), green * Vec3::X),
            (0.5, hole, green),
        ] {
            let mut scene = surfaces(vec![unlit(Vec3::ONE), glass(green)], &[-1.0, 0.0]);
            add(&mut scene, across(z, [255; 3]), material, Mat4::IDENTITY);
            let what = format!("{mode:?} {stereo:?} {z}");
            let drawn = rendered(&scene, &front(), &settings);
            let row = drawn.targets().radiance_view.texture().width();
            let all = radiance(&drawn);
            // Of each eye's picture; with one eye twice the same.
            for first in [0, row - SIDE] {
                let found = all[(SIDE / 2 * row + first + SIDE / 2) as usize];
                assert_near(found, expected, &what);
            }
        }
    }
}

#[test]
fn masks_cut_holes_into_strokes() {
    for (alpha, expected) in [(0.25, Vec3::Y), (0.75, Vec3::X)] {
        let masked = Material {
            base_color: Vec4::new(1.0, 0.0, 0.0, alpha),
            alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
            ..Material::default()
        };
        let mut scene = surfaces(vec![unlit(Vec3::Y)], &[0.0]);
        add(&mut scene, across(0.5, [255; 3]), masked, Mat4::IDENTITY);
        for mode in ALL {
            let settings = wide(5.0).with(|s| s.antialiasing.mode = mode);
            assert_near(
                middle(&scene, &settings),
                expected,
                &format!("{mode:?} {alpha}"),
            );
        }
    }
}

/// The wall must be sorted and lit by its own sub-samples, not by those that lines lie before.
#[test]
fn smoothed_lines_before_a_lit_wall_leave_its_light() {
    let matte = Material {
        metallic: 0.0,
        roughness: 1.0,
        specular: 0.0,
        base_color: Vec4::new(0.2, 0.4, 0.8, 1.0),
        ..Material::default()
    };
    let mut scene = surfaces(vec![matte], &[-1.0]);
    scene.instances[0].world_from_object =
        Mat4::from_translation(Vec3::new(0.0, 0.0, -1.0)) * Mat4::from_scale(Vec3::splat(20.0));
    let mesh = scene.meshes[0].bounds;
    let bounds = mesh.transformed(scene.instances[0].world_from_object);
    scene.instances[0].bounds = bounds;
    scene.objects[0].bounds = bounds;
    // Its light changes with the place, and with it where a sub-sample is taken for one of a line.
    scene.lights.push(Light {
        kind: LightKind::Point,
        position: Vec3::new(0.0, 0.0, 1.5),
        intensity: 6.25 * std::f32::consts::PI,
        ..sun(-Vec3::Z)
    });
    let mut uncut = lines();
    uncut.lines.pop();
    add(&mut scene, uncut, white(), Mat4::IDENTITY);
    let big = small(SIZE.0 * 2, SIZE.1 * 2).with(|s| s.geometry.line_width_px = 4.0);
    let big = radiance(&rendered(&scene, &front(), &big));
    // The wall is blue.
    let bare = big.iter().filter(|c| c.z > 3.0 * c.x && c.z > 0.2);
    assert!(bare.count() > big.len() / 2);
    for (mode, geometry) in [
        (Antialiasing::Msaa, Geometry::Gbuffer),
        (Antialiasing::Ssaa, Geometry::Gbuffer),
        (Antialiasing::Msaa, Geometry::Visibility),
        (Antialiasing::Ssaa, Geometry::Visibility),
    ] {
        let settings = sized(2.0).with(|s| {
            s.antialiasing.mode = mode;
            s.geometry.path = geometry;
        });
        let drawn = radiance(&rendered(&scene, &front(), &settings));
        let mut off = 0;
        for (pixel, drawn) in (0..).zip(drawn) {
            let (x, y) = (2 * (pixel % SIZE.0), 2 * (pixel / SIZE.0));
            let at = |x: u32, y: u32| big[(y * SIZE.0 * 2 + x) as usize];
            let twin = (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0;
            off += usize::from((drawn - twin).abs().max_element() > 1e-2);
        }
        assert!(off < 8, "{mode:?} {geometry:?}: {off}");
    }
}

#[test]
fn culling_leaves_strokes_whose_width_reaches_further_than_their_boxes() {
    let camera = front();
    // The upper border of the picture at the distance 4.
    let top = 4.0 * 20f32.to_radians().tan();
    let mut beyond = across(0.0, [255, 0, 0]);
    beyond
        .vertices
        .iter_mut()
        .for_each(|v| v.position[1] = top * 1.1);
    let outside = scene_of(beyond, Material::default());
    // Behind a wall, so near its border that half of each square is beside it.
    let mut hidden = surfaces(vec![unlit(Vec3::Y)], &[1.0]);
    let behind = Mesh {
        vertices: vec![vertex(Vec3::new(1.2, 0.3, 0.0), [255, 0, 0])],
        points: vec![0],
        ..Mesh::default()
    };
    add(&mut hidden, behind, Material::default(), Mat4::IDENTITY);
    for (scene, least) in [(outside, 60), (hidden, 9)] {
        for mode in [Culling::Off, Culling::Frustum, Culling::Occlusion] {
            let settings = wide(9.0).with(|s| s.culling.mode = mode);
            let drawn = radiance(&rendered(&scene, &camera, &settings));
            let red = drawn.iter().filter(|c| c.x > 0.5).count();
            assert!(red >= least, "{mode:?}: {red}");
        }
    }
}

#[test]
fn lines_on_a_sloped_surface_do_not_sink_into_it() {
    let slope = Mat4::from_rotation_y(0.7);
    let mut scene = surfaces(vec![unlit(Vec3::Y)], &[0.0]);
    scene.instances[0].world_from_object = slope;
    let bounds = scene.meshes[0].bounds.transformed(slope);
    scene.instances[0].bounds = bounds;
    scene.objects[0].bounds = bounds;
    let ends = [[0.3, -0.9], [0.3, 0.9], [-0.4, -0.9], [-0.2, 0.9]];
    let mesh = Mesh {
        vertices: ends
            .map(|[x, y]| vertex(Vec3::new(x, y, 0.0), [255; 3]))
            .to_vec(),
        lines: vec![[0, 1], [2, 3]],
        ..Mesh::default()
    };
    let bare = scene_of(mesh.clone(), white());
    let turned = {
        let mut scene = bare;
        scene.instances[0].world_from_object = slope;
        scene.instances[0].bounds = scene.meshes[0].bounds.transformed(slope);
        scene
    };
    add(&mut scene, mesh, white(), slope);
    for (camera, width) in [
        (front(), 1.0),
        (front(), 3.0),
        (orthographic(), 1.0),
        (orthographic(), 3.0),
    ] {
        let shown = |scene: &Scene| -> Vec<bool> {
            let drawn = radiance(&rendered(scene, &camera, &wide(width)));
            drawn.iter().map(|c| c.x > 0.9).collect()
        };
        let alone = shown(&turned);
        assert!(alone.iter().filter(|shown| **shown).count() > 20);
        assert_eq!(shown(&scene), alone, "{width}");
    }
    // What lies well before them hides them.
    add(
        &mut scene,
        quads(vec![unlit(Vec3::Z)], &[0.0]).meshes.remove(0),
        unlit(Vec3::Z),
        Mat4::from_translation(Vec3::new(0.0, 0.0, 0.4)) * slope,
    );
    let drawn = radiance(&rendered(&scene, &front(), &wide(3.0)));
    assert!(drawn.iter().all(|c| c.x < 0.1));
}

fn orthographic() -> foveal_scene::Camera {
    let mut camera = front();
    camera.projection = foveal_scene::Projection::Orthographic {
        height_m: 2.9,
        near_m: 1.0,
        far_m: 20.0,
    };
    camera
}

#[test]
fn lit_strokes_receive_shadows_and_cast_none() {
    let matte = Material {
        metallic: 0.0,
        roughness: 1.0,
        specular: 0.0,
        ..Material::default()
    };
    let mut mesh = across(0.0, [255; 3]);
    mesh.vertices
        .iter_mut()
        .for_each(|v| v.normal = [0.0, 0.0, 1.0]);
    let mut open = scene_of(mesh, matte.clone());
    // From the right, past the wall that hides nothing from the eye.
    open.lights.push(sun(Vec3::new(-1.0, 0.0, -1.0)));
    let settings = |shadows: Shadows| {
        wide(5.0).with(|s| {
            s.lighting.shadows = shadows;
            s.culling.mode = Culling::Frustum;
        })
    };
    let mut shaded = open.clone();
    let wall = quads(vec![matte.clone()], &[0.0]).meshes.remove(0);
    let aside = Mat4::from_translation(Vec3::new(1.5, 0.0, 1.5));
    add(&mut shaded, wall.clone(), unlit(Vec3::Y), aside);
    let cosine = Vec3::splat(std::f32::consts::FRAC_1_SQRT_2);
    for shadows in [Shadows::Hard, Shadows::Soft] {
        assert_near(middle(&open, &settings(shadows)), cosine, "open");
        assert_near(middle(&shaded, &settings(shadows)), Vec3::ZERO, "shaded");
    }
    assert_near(
        middle(&shaded, &settings(Shadows::Off)),
        cosine,
        "without shadows",
    );
    // A line between the light and a wall.
    let mut below = surfaces(vec![matte], &[0.0]);
    below.lights.push(sun(Vec3::new(0.0, -1.0, -1.0)));
    let mut above = across(1.0, [255; 3]);
    above.vertices.iter_mut().for_each(|v| v.position[1] = 1.0);
    add(&mut below, above, white(), Mat4::IDENTITY);
    assert_near(
        middle(&below, &settings(Shadows::Hard)),
        cosine,
        "no shadow of a line",
    );
}

#[test]
fn each_stroke_is_lit_by_its_own_normals() {
    let at = |x: f32, y: f32, normal: [f32; 3]| Vertex {
        normal,
        ..vertex(Vec3::new(x, y, 0.0), [255; 3])
    };
    let (none, away) = ([0.0; 3], [0.0, 0.0, -1.0]);
    let mesh = Mesh {
        vertices: vec![
            at(-0.8, 0.8, none),
            at(0.8, 0.8, away),
            // Two ends without, one of two, none.
            at(-0.8, 0.0, none),
            at(0.8, 0.0, none),
            at(-0.8, -0.4, none),
            at(0.8, -0.4, away),
            at(-0.8, -0.8, away),
            at(0.8, -0.8, away),
        ],
        points: vec![0, 1],
        lines: vec![[2, 3], [4, 5], [6, 7]],
        ..Mesh::default()
    };
    let mut scene = scene_of(mesh.clone(), Material::default());
    scene.lights.push(sun(-Vec3::Z));
    let drawn = rendered(&scene, &front(), &wide(3.0));
    let drawn = radiance(&drawn);
    let top = 4.0 * 20f32.to_radians().tan();
    let pixel = |x: f32, y: f32| {
        let place = |at: f32| ((at / top * 0.5 + 0.5) * SIDE as f32) as usize;
        drawn[place(-y) * SIDE as usize + place(x)]
    };
    assert_near(pixel(-0.8, 0.8), Vec3::ONE, "a point without a normal");
    assert_near(pixel(0.8, 0.8), Vec3::ZERO, "a point that looks away");
    assert_near(pixel(0.4, 0.0), Vec3::ONE, "a line without normals");
    assert_near(pixel(0.4, -0.4), Vec3::ONE, "a line with one normal");
    assert_near(pixel(0.4, -0.8), Vec3::ZERO, "a line that looks away");
}

#[test]
fn a_smaller_picture_has_thinner_strokes() {
    let scene = scene_of(lines(), white());
    let mut uncut = scene.clone();
    uncut.meshes[0].lines.pop();
    uncut.meshes[0].vertices.truncate(6);
    for (width, scale, drawn_width) in [(4.0, 0.5, 2.0), (1.0, 0.5, 1.0), (6.0, 0.75, 4.5)] {
        let settings = sized(width).with(|s| s.picture.render_scale = scale);
        let drawn = settings.drawn();
        assert_eq!(drawn.geometry.line_width_px, drawn_width);
        assert_eq!(drawn.geometry.point_size_px, drawn_width);
        let pixels = radiance(&rendered(&uncut, &front(), &settings));
        assert!(compare(&uncut.meshes[0], &front(), &drawn, &pixels) > 20);
    }
}

#[test]
fn other_widths_make_nothing_anew_and_another_render_scale_no_pipelines() {
    let gpu = block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let scene = scene_of(lines(), white());
    let settings = sized(2.0);
    let mut renderer = rendered_on(&gpu, &scene, &front(), &settings);
    let mut calls = |settings: &Settings| {
        gpu.device.faults.disarm();
        block_on(renderer.set_settings(settings)).expect("they fit");
        gpu.device.faults.calls()
    };
    let wider = sized(3.0);
    assert_eq!(calls(&wider), 0);
    let resized = calls(&wider.clone().with(|s| s.picture.width *= 2));
    let scaled = calls(&wider.clone().with(|s| s.picture.render_scale = 0.5));
    let whole = calls(
        &wider
            .clone()
            .with(|s| s.antialiasing.mode = Antialiasing::Msaa),
    );
    let most = resized.max(scaled);
    assert!(
        resized.min(scaled) > 0 && most * 4 < whole,
        "{resized}, {scaled}, {whole}"
    );
    // And the new widths are drawn.
    let film = |settings: &Settings| {
        let mut film = Film::new(&scene, &sized(2.0));
        film.draw(&front());
        block_on(film.renderer.set_settings(settings)).expect("they fit");
        film.draw(&front());
        picture(&film.renderer)
    };
    for settings in [wider.clone(), wider.with(|s| s.picture.render_scale = 0.5)] {
        assert!(film(&settings) == picture(&rendered(&scene, &front(), &settings)));
    }
}

#[test]
fn widths_that_make_no_sense_are_refused() {
    let limits = wgpu::Limits::default();
    let base = small(SIDE, SIDE);
    for width in [f32::NAN, f32::INFINITY, 0.0, 0.5, -3.0, 65.0] {
        let point = base.clone().with(|s| s.geometry.point_size_px = width);
        let line = base.clone().with(|s| s.geometry.line_width_px = width);
        for (name, settings) in [("point-size", point), ("line-width", line)] {
            let refused = settings.validate(&limits).expect_err(name).to_string();
            let sentence = format!("the setting {name} is {width}; it must be between 1 and 64");
            assert_eq!(refused, sentence);
        }
    }
    for width in [1.0, 64.0] {
        let settings = wide(width);
        assert!(settings.validate(&limits).is_ok());
    }
}

#[test]
fn strokes_are_counted_as_draws() {
    let scene = scene_of(lines(), white());
    let mut film = Film::new(&scene, &wide(1.0));
    assert_eq!(film.draw(&front()).draws, 1);
}

#[test]
fn strokes_that_move_disturb_no_shadow() {
    let mut scene = surfaces(vec![white()], &[-1.0]);
    scene.lights.push(Light {
        kind: LightKind::Point,
        position: Vec3::new(0.0, 0.0, 1.5),
        range_m: Some(6.0),
        ..sun(-Vec3::Z)
    });
    add(&mut scene, lines(), white(), Mat4::IDENTITY);
    let settings = wide(1.0).with(|s| s.lighting.shadows = Shadows::Hard);
    let mut film = Film::new(&scene, &settings);
    assert!(
        film.draw(&front())
            .shadows
            .expect("there are some")
            .tiles_drawn
            > 0
    );
    let shift = Mat4::from_translation(Vec3::new(0.1, 0.2, 0.0));
    let mut moved = |scene: &mut Scene, number: usize| {
        let instance = &mut scene.instances[number];
        instance.world_from_object = shift * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(shift);
        block_on(film.renderer.update_pose(scene)).expect("it fits");
        let drawn = film
            .draw(&front())
            .shadows
            .expect("there are some")
            .tiles_drawn;
        // What moved until now rests in the frame after.
        block_on(film.renderer.update_pose(scene)).expect("it fits");
        film.draw(&front());
        drawn
    };
    assert_eq!(moved(&mut scene, 1), 0);
    assert!(moved(&mut scene, 0) > 0);
    // Far away they do not make the sun's map coarser.
    let far = Mat4::from_translation(Vec3::splat(500.0));
    let mesh = Mesh {
        vertices: vec![vertex(Vec3::ZERO, [255; 3])],
        points: vec![0],
        ..Mesh::default()
    };
    let before = rendered(&scene, &front(), &settings).scene().bounds;
    add(&mut scene, mesh, white(), far);
    assert_eq!(rendered(&scene, &front(), &settings).scene().bounds, before);
}
