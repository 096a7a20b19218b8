//! Everything about transparency and faces in one picture.

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};

use super::build::{MeshBuilder, SceneBuilder, named};
use super::lights::point;
use super::texture::{Texel, bake, paint_masked};
use super::trig::{pitch, roll, shift, yaw};
use foveal_scene::{AlphaMode, Camera, Environment, Material, Scene, TextureRef};

/// Nine things on a floor, left to right and back to front: masked, masked and double-sided,
/// blended panes behind each other, a single-sided pane seen from behind (invisible), a
/// double-sided one, a mirrored pair with a normal texture, vertex colours, emissive, unlit.
/// Camera: `front`.
#[must_use]
pub fn alpha() -> Scene {
    let mut scene = SceneBuilder::new("alpha");
    let holes = scene.texture(paint_masked("holes", 128, |p| {
        let q = (p * 4.0).fract() - 0.5;
        let mut texel = Texel::new(Vec3::new(0.45 + 0.5 * p.x, 0.75, 0.35 + 0.5 * p.y));
        texel.alpha = ((0.12 - q.length_squared()) * 12.0 + 0.5).clamp(0.0, 1.0);
        texel
    }));
    let ridges = bake("ridges", 64, 0.5, |p| {
        let mut texel = Texel::new(Vec3::splat(0.7));
        // Slanted, so that a mirrored picture differs from a turned one.
        texel.height_m = 0.02 * ((p.x * 4.0 + p.y * 2.0).fract() - 0.5).abs();
        texel
    });
    let ridges = scene.texture(ridges.normal);
    let slot = |texture| {
        Some(TextureRef {
            texture,
            uv_set: 0,
            uv_transform: Mat3::IDENTITY,
        })
    };
    let plain = |name: &str, color: Vec4| Material {
        name: name.to_owned(),
        base_color: color,
        metallic: 0.0,
        roughness: 0.6,
        ..Material::default()
    };
    let masked = Material {
        base_color_texture: slot(holes),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..plain("masked", Vec4::ONE)
    };
    let glass = |name: &str, color: [f32; 4]| Material {
        alpha_mode: AlphaMode::Blend,
        roughness: 0.1,
        double_sided: true,
        ..plain(name, color.into())
    };
    let materials = [
        plain("floor", Vec4::new(0.5, 0.5, 0.5, 1.0)),
        Material {
            double_sided: true,
            name: "masked, double-sided".to_owned(),
            ..masked.clone()
        },
        masked,
        glass("red glass", [0.9, 0.15, 0.1, 0.5]),
        glass("blue glass", [0.1, 0.3, 0.9, 0.5]),
        plain("single-sided", Vec4::new(0.9, 0.6, 0.1, 1.0)),
        Material {
            double_sided: true,
            ..plain("double-sided", Vec4::new(0.9, 0.6, 0.1, 1.0))
        },
        Material {
            normal_texture: slot(ridges),
            ..plain("ridges", Vec4::new(0.7, 0.7, 0.75, 1.0))
        },
        plain("vertex colours", Vec4::ONE),
        Material {
            emissive: Vec3::new(2.5, 0.9, 0.2),
            ..plain("emissive", Vec4::new(0.05, 0.05, 0.05, 1.0))
        },
        Material {
            unlit: true,
            ..plain("unlit", Vec4::new(0.1, 0.8, 0.6, 1.0))
        },
    ];
    let [
        floor,
        masked_both,
        masked,
        red,
        blue,
        single,
        double,
        ridged,
        colored,
        glowing,
        unlit,
    ] = materials.map(|m| scene.material(m));

    let mut ground = MeshBuilder::new();
    ground.panel(Vec3::new(-3.0, 0.0, 2.0), Vec3::X * 6.0, Vec3::NEG_Z * 4.0);
    let ground = scene.mesh(ground.finish("floor"));
    let mut pane = MeshBuilder::new();
    let (one, corner) = (Vec2::ONE, Vec3::new(-0.5, 0.0, 0.0));
    pane.panel_uv(corner, Vec3::X, Vec3::Y, Vec2::ZERO, one);
    let pane = scene.mesh(pane.finish("pane"));
    let mut wedge = MeshBuilder::new();
    wedge.bevel_box(
        Vec3::new(-0.35, 0.0, -0.25),
        Vec3::new(0.35, 0.9, 0.25),
        0.08,
    );
    let wedge = scene.mesh(wedge.finish("block"));
    let mut rainbow = MeshBuilder::new();
    for (i, color) in [[255, 40, 20], [255, 190, 30], [40, 200, 60], [40, 90, 255]]
        .into_iter()
        .enumerate()
    {
        let center = Vec3::new(0.0, 0.15 + 0.25 * i as f32, 0.0);
        rainbow
            .tint(color)
            .ellipsoid(center, Vec3::splat(0.2), 16, 10);
    }
    let rainbow = scene.mesh(rainbow.finish("spheres"));
    let mut ball = MeshBuilder::new();
    ball.ellipsoid(Vec3::Y * 0.35, Vec3::splat(0.35), 24, 14);
    let ball = scene.mesh(ball.finish("ball"));

    let behind = yaw(0.5);
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let things = [
        ("floor", ground, floor, Mat4::IDENTITY),
        ("masked", pane, masked, shift(-2.3, 0.0, -1.0) * yaw(0.06)),
        (
            "masked from behind",
            pane,
            masked_both,
            shift(-1.1, 0.0, -1.2) * yaw(0.43),
        ),
        ("red pane", pane, red, shift(0.2, 0.0, -0.7)),
        (
            "blue pane",
            pane,
            blue,
            shift(0.45, 0.25, -1.1) * roll(0.02),
        ),
        (
            "invisible from behind",
            pane,
            single,
            shift(1.4, 0.0, -1.4) * behind,
        ),
        (
            "visible from behind",
            pane,
            double,
            shift(2.3, 0.0, -1.2) * behind * pitch(0.03),
        ),
        ("ridged", wedge, ridged, shift(-2.1, 0.0, 0.6) * yaw(0.07)),
        (
            "ridged, mirrored",
            wedge,
            ridged,
            shift(-1.1, 0.0, 0.6) * yaw(-0.07) * mirror,
        ),
        ("vertex colours", rainbow, colored, shift(0.0, 0.0, 0.7)),
        (
            "vertex colours, mirrored",
            rainbow,
            colored,
            shift(0.55, 0.0, 0.9) * mirror,
        ),
        ("emissive", ball, glowing, shift(1.3, 0.0, 0.4)),
        ("unlit", ball, unlit, shift(2.2, 0.0, 0.5)),
    ];
    for (name, mesh, material, place) in things {
        scene.object(name.to_owned(), None, None, &[(mesh, material)], place);
    }
    for (position, color, intensity) in [
        ([-2.0, 3.0, 3.0], [1.0, 0.92, 0.8], 14.0),
        ([2.5, 2.0, 1.5], [0.6, 0.75, 1.0], 6.0),
        ([0.3, 1.2, -2.0], [1.0, 0.7, 0.5], 3.0),
    ] {
        scene.light(point(position.into(), color.into(), intensity, 12.0));
    }
    let eye = Vec3::new(0.0, 2.1, 4.9);
    let camera = Camera::look_at(eye, Vec3::new(0.0, 0.35, -0.3), Vec3::Y, 42f32.to_radians());
    scene.camera(named(camera, "front"));
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec3::new(0.16, 0.20, 0.28),
        horizon: Vec3::new(0.24, 0.22, 0.20),
        nadir: Vec3::new(0.06, 0.05, 0.05),
    };
    scene
}
