//! The CPU twin of points and lines: which pixels they cover, what hides them, how they are lit.

use foveal_scene::{
    AlphaMode, Camera, Environment, Light, LightKind, Material, Mesh, Projection, Scene, Vertex,
};
use glam::{Mat4, Vec2, Vec3, Vec4};

use super::twin::quads;
use crate::testing::{add, picture, radiance, rendered, small};
use crate::{Antialiasing, Geometry, Output, SamplePattern, Settings, Shading, Shadows, Stereo};

pub(super) const SIZE: (u32, u32) = (47, 31);

/// Further from an edge than this, in pixels, the device must agree; where a line is cut by the near
/// plane, its end lies far outside the picture, and rasterizers count in fractions of a pixel.
const CLOSE: f32 = 0.02;
const CLOSE_TO_CUT: f32 = 0.1;

fn camera() -> Camera {
    let eye = Vec3::new(0.7, 0.5, 4.0);
    Camera::look_at(eye, Vec3::ZERO, Vec3::new(0.2, 1.0, 0.0), 0.8)
}

pub(super) fn vertex(position: Vec3, color: [u8; 3]) -> Vertex {
    let [r, g, b] = color.map(|c| 257 * u16::from(c));
    Vertex {
        position: position.to_array(),
        color: [r, g, b, u16::MAX],
        ..bytemuck::Zeroable::zeroed()
    }
}

pub(super) fn black() -> Environment {
    Environment {
        zenith: Vec3::ZERO,
        horizon: Vec3::ZERO,
        nadir: Vec3::ZERO,
    }
}

/// Points and lines of one colour, and where they are seen from.
pub(crate) fn strokes() -> (Scene, Camera) {
    let mut scene = scene_of(lines(), white());
    add(&mut scene, points(), white(), Mat4::IDENTITY);
    (scene, camera())
}

pub(super) fn scene_of(mesh: Mesh, material: Material) -> Scene {
    let mut scene = Scene {
        environment: black(),
        ..Scene::default()
    };
    add(&mut scene, mesh, material, Mat4::IDENTITY);
    scene
}

/// Lines of one colour to all sides, the last from behind the eye.
pub(super) fn lines() -> Mesh {
    let ends = [
        [Vec3::new(-1.3, -0.7, 0.2), Vec3::new(1.2, 0.8, -0.4)],
        [Vec3::new(-1.0, 0.9, 0.0), Vec3::new(1.5, 0.85, 0.3)],
        [Vec3::new(0.4, -0.8, 1.0), Vec3::new(0.35, 0.9, -1.0)],
        [Vec3::new(-0.9, -0.5, 0.0), Vec3::new(1.1, 0.4, 6.0)],
    ];
    Mesh {
        vertices: (ends.as_flattened().iter())
            .map(|&p| vertex(p, [255; 3]))
            .collect(),
        lines: (0..4).map(|i| [2 * i, 2 * i + 1]).collect(),
        ..Mesh::default()
    }
}

pub(super) fn points() -> Mesh {
    let places = (0..25).map(|i| {
        let (x, y) = ((i % 5) as f32, (i / 5) as f32);
        Vec3::new(x * 0.53 - 1.1, y * 0.41 - 0.8, 0.3 * (x - y))
    });
    Mesh {
        vertices: places.map(|p| vertex(p, [255; 3])).collect(),
        points: (0..25).collect(),
        ..Mesh::default()
    }
}

/// Places of the picture in pixels.
fn on_screen(clip: Vec4, size: Vec2) -> Vec2 {
    (Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * size
}

/// How far within a line's rectangle a place lies, negative outside, both in pixels; the ends beyond
/// the near plane are cut.
fn within_line(clip: [Vec4; 2], width: f32, size: Vec2, at: Vec2) -> f32 {
    let ahead = clip.map(|c| c.w - c.z);
    let cut = |i: usize, other: usize| {
        if ahead[i] >= 0.0 {
            return clip[i];
        }
        clip[i].lerp(clip[other], ahead[i] / (ahead[i] - ahead[other]))
    };
    let [a, b] = [cut(0, 1), cut(1, 0)].map(|c| on_screen(c, size));
    // Seen end-on it is a point.
    let along = (b - a).try_normalize().unwrap_or(Vec2::X);
    let (x, y) = ((at - a).dot(along), (at - a).perp_dot(along));
    let beyond_ends = (x + width / 2.0).min((b - a).length() + width / 2.0 - x);
    beyond_ends.min(width / 2.0 - y.abs())
}

fn within_point(clip: Vec4, side: f32, size: Vec2, at: Vec2) -> f32 {
    side / 2.0 - (at - on_screen(clip, size)).abs().max_element()
}

/// How far within any of the strokes a pixel's centre lies.
fn within(mesh: &Mesh, camera: &Camera, settings: &Settings, pixel: u32) -> f32 {
    let (width, height) = (settings.picture.width, settings.picture.height);
    let size = Vec2::new(width as f32, height as f32);
    let at = Vec2::new((pixel % width) as f32, (pixel / width) as f32) + 0.5;
    let clip_from_world = camera.clip_from_world(size.x / size.y);
    let clip = |vertex: u32| {
        clip_from_world * Vec3::from(mesh.vertices[vertex as usize].position).extend(1.0)
    };
    let g = &settings.geometry;
    let lines = mesh
        .lines
        .iter()
        .map(|ends| within_line(ends.map(clip), g.line_width_px, size, at));
    let points = mesh
        .points
        .iter()
        .map(|&p| within_point(clip(p), g.point_size_px, size, at));
    lines.chain(points).fold(f32::NEG_INFINITY, f32::max)
}

pub(super) fn sized(width: f32) -> Settings {
    small(SIZE.0, SIZE.1).with(|s| {
        s.geometry.line_width_px = width;
        s.geometry.point_size_px = width;
    })
}

pub(super) fn white() -> Material {
    Material {
        base_color: Vec4::new(1.0, 0.5, 0.25, 1.0),
        ..Material::default()
    }
}

/// Compares a picture on black with the twin; returns how many pixels are covered.
pub(super) fn compare(mesh: &Mesh, camera: &Camera, settings: &Settings, drawn: &[Vec3]) -> usize {
    let mut covered = 0;
    let view_from_world = camera.world_from_view.inverse();
    let is_behind = |v: &Vertex| view_from_world.transform_point3(v.position.into()).z > 0.0;
    let is_cut = mesh.vertices.iter().any(is_behind);
    let close = if is_cut { CLOSE_TO_CUT } else { CLOSE };
    for (pixel, drawn) in (0..).zip(drawn) {
        let within = within(mesh, camera, settings, pixel);
        if within.abs() < close {
            continue;
        }
        let expected = if within > 0.0 {
            Vec3::new(1.0, 0.5, 0.25)
        } else {
            Vec3::ZERO
        };
        assert!(
            (*drawn - expected).abs().max_element() < 1e-3,
            "pixel {pixel}: {drawn}, {within} px within"
        );
        covered += usize::from(within > 0.0);
    }
    covered
}

#[test]
fn points_and_lines_cover_the_pixels_of_their_width() {
    let mut orthographic = camera();
    orthographic.projection = Projection::Orthographic {
        height_m: 2.5,
        near_m: 1.0,
        far_m: 20.0,
    };
    for camera in [camera(), orthographic] {
        let mut uncut = lines();
        uncut.lines.pop();
        uncut.vertices.truncate(6);
        for mesh in [lines(), uncut, points()] {
            let scene = scene_of(mesh, white());
            for width in [1.0, 2.5, 6.0] {
                let settings = sized(width);
                let drawn = radiance(&rendered(&scene, &camera, &settings));
                let covered = compare(&scene.meshes[0], &camera, &settings, &drawn);
                assert!(covered as f32 > 15.0 * width, "{covered}");
            }
        }
    }
}

#[test]
fn lines_that_are_seen_end_on_are_points() {
    let mut camera = super::twin::front();
    camera.projection = Projection::Orthographic {
        height_m: 2.0,
        near_m: 1.0,
        far_m: 20.0,
    };
    let ends = |x: f32, z: [f32; 2]| z.map(|z| vertex(Vec3::new(x, 0.21, z), [255; 3]));
    let vertices = [
        ends(-0.5, [-1.0, 1.0]),
        ends(0.02, [1.0, -1.0]),
        ends(0.6, [0.0, 0.0]),
        // From behind the eye.
        ends(0.95, [-1.0, 9.0]),
    ];
    let mesh = Mesh {
        vertices: vertices.as_flattened().to_vec(),
        lines: (0..4).map(|i| [2 * i, 2 * i + 1]).collect(),
        ..Mesh::default()
    };
    let scene = scene_of(mesh, white());
    for width in [1.0, 4.0] {
        let settings = sized(width);
        let drawn = radiance(&rendered(&scene, &camera, &settings));
        let covered = compare(&scene.meshes[0], &camera, &settings, &drawn);
        assert_eq!(covered as f32, 4.0 * width * width);
    }
}

#[test]
fn every_way_of_drawing_shows_the_same_points_and_lines() {
    let mut mesh = lines();
    let count = mesh.vertices.len() as u32;
    mesh.points = points().points.iter().map(|p| p + count).collect();
    mesh.vertices.extend(points().vertices);
    let mut scene = scene_of(mesh, white());
    // A wall behind some and in front of others.
    let wall = Material {
        base_color: Vec4::new(0.1, 0.2, 0.9, 1.0),
        unlit: true,
        double_sided: true,
        ..Material::default()
    };
    let mesh = quads(vec![wall.clone()], &[0.0]).meshes.remove(0);
    add(&mut scene, mesh, wall, Mat4::from_rotation_y(0.4));
    let expected = picture(&rendered(&scene, &camera(), &sized(2.0)));
    let shown = |color: [u8; 3]| expected.chunks_exact(4).filter(|p| p[..3] == color).count();
    assert!(shown([0; 3]) > 50);
    let ways: [fn(&mut Settings); 5] = [
        |s| s.geometry.path = Geometry::Visibility,
        |s| s.shading.mode = Shading::Coarse,
        |s| s.shading.mode = Shading::Variable,
        |s| s.culling.mode = crate::Culling::Off,
        |s| {
            s.geometry.path = Geometry::Visibility;
            s.shading.mode = Shading::Variable;
        },
    ];
    for (number, way) in ways.into_iter().enumerate() {
        let renderer = rendered(&scene, &camera(), &sized(2.0).with(way));
        // The wall is unlit, so that every way gives it the same colour.
        let drawn = picture(&renderer);
        let off = drawn
            .iter()
            .zip(&expected)
            .filter(|(a, b)| a.abs_diff(**b) > 2);
        assert!(off.count() < 12, "way {number}");
    }
}

#[test]
fn both_eyes_see_them_where_they_are() {
    let scene = scene_of(lines(), white());
    let picture_of = |settings: &Settings| radiance(&rendered(&scene, &camera(), settings));
    let eyes = |stereo: Stereo| {
        let settings = sized(2.0).with(|s| {
            s.stereo.mode = stereo;
            s.stereo.output = Output::SideBySide;
        });
        picture_of(&settings)
    };
    let (two, one) = (eyes(Stereo::TwoPass), eyes(Stereo::Instanced));
    let lit = |drawn: &[Vec3]| drawn.iter().filter(|c| c.x > 0.5).count();
    let off = two
        .iter()
        .zip(&one)
        .filter(|(a, b)| (**a - **b).abs().max_element() > 1e-3);
    assert!(off.count() < 4 && lit(&two) > 100, "{}", lit(&two));
    // Each eye's own camera sees what its half shows.
    let half = lit(&picture_of(&sized(2.0)));
    assert!(
        lit(&two).abs_diff(2 * half) < half / 4,
        "{} {half}",
        lit(&two)
    );
}

#[test]
fn smoothed_lines_are_those_of_a_picture_of_n_times_the_size() {
    let scene = scene_of(lines(), white());
    let big = small(SIZE.0 * 2, SIZE.1 * 2).with(|s| s.geometry.line_width_px = 4.0);
    let big = radiance(&rendered(&scene, &camera(), &big));
    for (mode, geometry) in [
        (Antialiasing::Msaa, Geometry::Gbuffer),
        (Antialiasing::Ssaa, Geometry::Gbuffer),
        (Antialiasing::Msaa, Geometry::Visibility),
    ] {
        let settings = sized(2.0).with(|s| {
            s.antialiasing.mode = mode;
            s.geometry.path = geometry;
        });
        let drawn = radiance(&rendered(&scene, &camera(), &settings));
        let mut off = 0;
        for (pixel, drawn) in (0..).zip(drawn) {
            let (x, y) = (2 * (pixel % SIZE.0), 2 * (pixel / SIZE.0));
            let at = |x: u32, y: u32| big[(y * SIZE.0 * 2 + x) as usize];
            let twin = (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0;
            off += usize::from((drawn - twin).abs().max_element() > 2e-3);
        }
        assert!(off < 8, "{mode:?} {geometry:?}: {off}");
    }
    let rotated = sized(2.0).with(|s| {
        s.antialiasing.mode = Antialiasing::Msaa;
        s.antialiasing.pattern = SamplePattern::Rotated;
    });
    let drawn = radiance(&rendered(&scene, &camera(), &rotated));
    assert!(drawn.iter().any(|c| c.x > 0.2 && c.x < 0.8));
}

#[test]
fn the_nearer_stroke_wins_and_blended_ones_mix() {
    let at = |z: f32, color| Mesh {
        vertices: vec![
            vertex(Vec3::new(-5.0, 0.0, z), color),
            vertex(Vec3::new(5.0, 0.0, z), color),
        ],
        lines: vec![[0, 1]],
        ..Mesh::default()
    };
    let front = super::twin::front();
    let middle = |scene: &Scene| {
        let settings = small(31, 31).with(|s| s.geometry.line_width_px = 5.0);
        radiance(&rendered(scene, &front, &settings))[15 * 31 + 15]
    };
    let white = Material::default();
    for order in [[0.5, -0.5], [-0.5, 0.5]] {
        let mut scene = scene_of(at(order[0], [255, 0, 0]), white.clone());
        add(
            &mut scene,
            at(order[1], [0, 255, 0]),
            white.clone(),
            Mat4::IDENTITY,
        );
        let nearer = if order[0] > order[1] {
            Vec3::X
        } else {
            Vec3::Y
        };
        assert!((middle(&scene) - nearer).abs().max_element() < 1e-3);
    }
    // Blended over a line that lies behind, and hidden by one before it.
    let glass = Material {
        base_color: Vec4::new(1.0, 1.0, 1.0, 0.25),
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    };
    for (z, expected) in [(0.5, Vec3::new(0.75, 0.25, 0.0)), (-0.5, Vec3::X)] {
        let mut scene = scene_of(at(z, [0, 255, 0]), glass.clone());
        add(
            &mut scene,
            at(0.0, [255, 0, 0]),
            white.clone(),
            Mat4::IDENTITY,
        );
        assert!(
            (middle(&scene) - expected).abs().max_element() < 2e-3,
            "{z}: {}",
            middle(&scene)
        );
    }
    // A blended surface behind a line leaves it as it is.
    let mut scene = scene_of(at(0.5, [255, 0, 0]), white);
    let pane = quads(vec![glass.clone()], &[0.0]).meshes.remove(0);
    add(&mut scene, pane, glass, Mat4::IDENTITY);
    assert!((middle(&scene) - Vec3::X).abs().max_element() < 1e-3);
}

#[test]
fn strokes_with_normals_are_lit_and_others_are_not() {
    let shadows = [Shadows::Off, Shadows::Hard];
    for (normal, expected) in [
        // Lambert: the base colour over pi, under an irradiance of pi.
        (Vec3::Z, Vec3::new(0.5, 0.25, 0.125)),
        (-Vec3::Z, Vec3::ZERO),
        (Vec3::ZERO, Vec3::new(0.6, 0.35, 0.225)),
    ] {
        let mut mesh = Mesh {
            vertices: vec![vertex(Vec3::ZERO, [255; 3])],
            points: vec![0],
            ..Mesh::default()
        };
        mesh.vertices[0].normal = normal.to_array();
        let emits = normal == Vec3::ZERO;
        let mut scene = scene_of(
            mesh,
            Material {
                base_color: Vec4::new(0.5, 0.25, 0.125, 1.0),
                emissive: if emits { Vec3::splat(0.1) } else { Vec3::ZERO },
                metallic: 0.0,
                roughness: 1.0,
                specular: 0.0,
                ..Material::default()
            },
        );
        scene.lights.push(Light {
            kind: LightKind::Directional,
            color: Vec3::ONE,
            intensity: std::f32::consts::PI,
            position: Vec3::ZERO,
            direction: -Vec3::Z,
            range_m: None,
            node: None,
        });
        for shadows in shadows {
            let settings = small(31, 31).with(|s| {
                s.geometry.point_size_px = 9.0;
                s.lighting.shadows = shadows;
            });
            let drawn = radiance(&rendered(&scene, &super::twin::front(), &settings));
            let middle = drawn[15 * 31 + 15];
            assert!(
                (middle - expected).abs().max_element() < 2e-3,
                "{normal}: {middle}"
            );
        }
    }
}

#[test]
fn the_last_of_many_strokes_is_drawn() {
    // More than are written to the device at a time, of vertices as of indices.
    let count = 50_000;
    let mut mesh = Mesh {
        vertices: vec![vertex(Vec3::splat(1000.0), [255; 3]); 3],
        points: vec![0; count],
        ..Mesh::default()
    };
    mesh.vertices[1].position = [0.5, 0.5, 0.0];
    mesh.vertices[2].position = [-0.5, -0.5, 0.0];
    mesh.points[count - 1] = 1;
    mesh.points.push(2);
    let scene = scene_of(mesh, Material::default());
    let settings = sized(3.0);
    let drawn = radiance(&rendered(&scene, &super::twin::front(), &settings));
    let lit = drawn.iter().filter(|c| c.x > 0.5).count();
    assert_eq!(lit, 2 * 9);
}
