//! A yard where light is sharp: what coarse shading finds hardest.

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};

use super::build::{MeshBuilder, SceneBuilder, named};
use super::hash::Rng;
use super::lights::point;
use super::texture::{Baked, hammered, leaves};
use super::trig::{pitch, roll, shift, yaw};
use foveal_scene::{AlphaMode, Camera, Environment, Light, LightKind, Material, Scene, TextureRef};

/// Metres from one part of the yard to the next.
const APART_M: f32 = 16.0;

/// Sunlight through a fence onto the ground, sunlight through leaves onto ground and wall, and a dark
/// hall whose polished floor and hammered plate mirror 24 lamps. Cameras: `fence`, `fence low`,
/// `leaves`, `leaves wall`, `floor`, `floor low`, `plate`.
#[must_use]
pub fn yard() -> Scene {
    let mut scene = SceneBuilder::new("yard");
    let stone = scene.material(plain("stone", [0.5, 0.48, 0.44], 0.9));
    add_fence(&mut scene, stone);
    add_leaves(&mut scene, stone);
    add_hall(&mut scene, stone);
    scene.light(Light {
        kind: LightKind::Directional,
        color: Vec3::new(1.0, 0.97, 0.9),
        intensity: 3.5,
        position: Vec3::ZERO,
        direction: Vec3::new(0.38, -0.72, -0.58).normalize(),
        range_m: None,
        node: None,
    });
    for (name, part, eye, target) in [
        ("fence", 0.0, [0.0, 1.6, -5.5], [0.0, 0.3, -1.0]),
        ("fence low", 0.0, [1.0, 0.5, -4.0], [0.0, 0.2, -0.7]),
        ("leaves", 1.0, [0.0, 1.6, 1.5], [0.0, 0.0, -2.5]),
        ("leaves wall", 1.0, [2.0, 1.6, 0.0], [-1.0, 2.0, -6.0]),
        ("floor", 2.0, [0.0, 1.6, 5.0], [0.0, 0.4, -3.0]),
        ("floor low", 2.0, [0.0, 0.7, 3.0], [-1.0, 0.3, -4.0]),
        ("plate", 2.0, [3.0, 1.6, -1.0], [3.0, 0.2, -4.5]),
    ] {
        let away = Vec3::X * (part * APART_M);
        let (eye, target) = (Vec3::from(eye) + away, Vec3::from(target) + away);
        let camera = Camera::look_at(eye, target, Vec3::Y, 55f32.to_radians());
        scene.camera(named(camera, name));
    }
    let mut scene = scene.finish();
    scene.environment = Environment {
        zenith: Vec3::new(0.15, 0.23, 0.4),
        horizon: Vec3::new(0.3, 0.32, 0.35),
        nadir: Vec3::new(0.08, 0.07, 0.06),
    };
    scene
}

fn plain(name: &str, color: [f32; 3], roughness: f32) -> Material {
    Material {
        name: name.to_owned(),
        base_color: Vec3::from(color).extend(1.0),
        metallic: 0.0,
        roughness,
        ..Material::default()
    }
}

fn of_texture(texture: u32, scale: f32) -> Option<TextureRef> {
    Some(TextureRef {
        texture,
        uv_set: 0,
        uv_transform: Mat3::from_scale(Vec2::splat(scale)),
    })
}

fn add(scene: &mut SceneBuilder, name: &str, mesh: MeshBuilder, material: u32, place: Mat4) {
    let mesh = scene.mesh(mesh.finish(name));
    scene.object(name.to_owned(), None, None, &[(mesh, material)], place);
}

/// A square of ground around a part's origin.
fn add_ground(scene: &mut SceneBuilder, name: &str, material: u32, place: Mat4) {
    let (corner, side) = (Vec3::new(-7.5, 0.0, 7.5), 15.0);
    let mut ground = MeshBuilder::new();
    ground.panel(corner, Vec3::X * side, Vec3::NEG_Z * side);
    add(scene, name, ground, material, place);
}

fn add_fence(scene: &mut SceneBuilder, ground: u32) {
    let wood = scene.material(plain("wood", [0.3, 0.25, 0.2], 0.8));
    add_ground(scene, "ground", ground, Mat4::IDENTITY);
    let mut fence = MeshBuilder::new();
    for picket in 0..120u8 {
        let at = Vec3::new(-6.0 + 0.1 * f32::from(picket), 0.0, 0.0);
        fence.block(at, at + Vec3::new(0.03, 1.5, 0.03));
    }
    for height in [0.3, 0.8, 1.3] {
        let at = Vec3::new(-6.0, height, 0.03);
        fence.block(at, at + Vec3::new(12.0, 0.03, 0.03));
    }
    add(scene, "fence", fence, wood, shift(0.0, 0.0, -1.2));
}

fn add_leaves(scene: &mut SceneBuilder, stone: u32) {
    let part = shift(APART_M, 0.0, 0.0);
    let picture = scene.texture(leaves());
    let leaf = scene.material(Material {
        base_color_texture: of_texture(picture, 1.0),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        double_sided: true,
        ..plain("leaves", [1.0; 3], 0.6)
    });
    add_ground(scene, "path", stone, part);
    let mut wall = MeshBuilder::new();
    wall.block(Vec3::new(-7.5, 0.0, -6.3), Vec3::new(7.5, 5.0, -6.0));
    add(scene, "wall", wall, stone, part);
    let mut spray = MeshBuilder::new();
    let (corner, one) = (Vec3::new(-0.3, -0.3, 0.0), Vec2::ONE);
    spray.panel_uv(corner, Vec3::X * 0.6, Vec3::Y * 0.6, Vec2::ZERO, one);
    let spray = scene.mesh(spray.finish("spray"));
    for i in 0..300 {
        let mut rng = Rng::new(77, i);
        let at = shift(
            rng.range(-6.0, 6.0),
            rng.range(1.8, 4.5),
            rng.range(-4.0, 1.0),
        );
        let turned = yaw(rng.unit()) * pitch(rng.unit()) * roll(rng.unit());
        let place = part * at * turned;
        scene.object(format!("spray {i}"), None, None, &[(spray, leaf)], place);
    }
}

fn add_hall(scene: &mut SceneBuilder, stone: u32) {
    let part = shift(2.0 * APART_M, 0.0, 0.0);
    let polished = scene.material(plain("polished", [0.3, 0.3, 0.32], 0.2));
    let Baked { color, normal, orm } = hammered();
    let [color, normal, orm] = [color, normal, orm].map(|t| scene.texture(t));
    let plate = scene.material(Material {
        name: "hammered".to_owned(),
        base_color: Vec4::ONE,
        base_color_texture: of_texture(color, 2.0),
        normal_texture: of_texture(normal, 2.0),
        metallic_roughness_texture: of_texture(orm, 2.0),
        ..Material::default()
    });
    add_ground(scene, "floor", polished, part);
    let mut shell = MeshBuilder::new();
    // Roof, back wall, side walls: no sun comes in but from the front.
    for (min, max) in [
        ([-7.5, 4.0, -7.7], [7.5, 4.2, 7.5]),
        ([-7.5, 0.0, -7.7], [7.5, 4.0, -7.5]),
        ([-7.7, 0.0, -7.7], [-7.5, 4.2, 7.5]),
        ([7.5, 0.0, -7.7], [7.7, 4.2, 7.5]),
    ] {
        shell.block(min.into(), max.into());
    }
    add(scene, "hall", shell, stone, part);
    let mut table = MeshBuilder::new();
    table.block(Vec3::new(1.5, 0.1, -5.5), Vec3::new(4.5, 0.2, -3.0));
    add(scene, "plate", table, plate, part);
    let colors = [[1.0, 0.9, 0.8], [0.6, 0.8, 1.0], [1.0, 0.5, 0.4]];
    for i in 0..24usize {
        let (column, row) = (i % 6, i / 6);
        let at = Vec3::new(
            -5.0 + 2.0 * column as f32,
            1.8 + 0.3 * (row % 2) as f32,
            -6.0 + 2.5 * row as f32,
        );
        let color = Vec3::from(colors[(column + row) % 3]);
        scene.light(point(part.transform_point3(at), color, 5.0, 8.0));
    }
}
