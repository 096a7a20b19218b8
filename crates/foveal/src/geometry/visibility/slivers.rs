//! Materials of triangles thinner than a pixel, at places where these are not seen: the centres of pixels
//! with anti-aliasing, and of samples of several pixels.

use foveal_generate as generate;
use foveal_scene::{Camera, Material, Mesh, Scene, Vertex};
use glam::{Mat4, Vec3};

use crate::shading::twin::unpack_surface;
use crate::testing::{Film, add, small, texels};
use crate::{Antialiasing, Geometry, RateSource, RateStage, Settings, Shading};

const SIZE: (u32, u32) = (93, 61);
/// Triangles: near the rim each is a fifth of a pixel wide.
const COUNT: u32 = 800;
/// Of the disc in metres.
const RADIUS: f32 = 1.0;

fn vertex(x: f32, y: f32) -> Vertex {
    let part = |v: f32| ((0.5 + 0.4 * v / RADIUS) * f32::from(u16::MAX)) as u16;
    Vertex {
        position: [x, y, 0.0],
        normal: [0.0, 0.0, 1.0],
        color: [part(x), part(y), u16::MAX / 2, u16::MAX],
        ..bytemuck::Zeroable::zeroed()
    }
}

/// A disc of triangles that meet in its centre, whose colour tells the place.
fn fan() -> (Scene, Camera) {
    let mut scene = generate::cornell();
    scene.meshes.clear();
    scene.objects.clear();
    scene.instances.clear();
    let rim = (0..COUNT).map(|i| {
        let (y, x) = (i as f32 * std::f32::consts::TAU / COUNT as f32).sin_cos();
        vertex(RADIUS * x, RADIUS * y)
    });
    let mesh = Mesh {
        vertices: std::iter::once(vertex(0.0, 0.0)).chain(rim).collect(),
        indices: (0..COUNT)
            .flat_map(|i| [0, 1 + i, 1 + (i + 1) % COUNT])
            .collect(),
        ..Mesh::default()
    };
    add(&mut scene, mesh, Material::default(), Mat4::IDENTITY);
    let camera = Camera::look_at(Vec3::new(0.1, 0.2, 2.2), Vec3::ZERO, Vec3::Y, 1.0);
    (scene, camera)
}

/// Base colours of the third frame; `None` where nothing is seen.
fn colors(scene: &Scene, camera: &Camera, settings: &Settings) -> Vec<Option<Vec3>> {
    let mut film = Film::new(scene, settings);
    for _ in 0..3 {
        film.draw(camera);
    }
    let gbuffer = &film.renderer.targets().gbuffer;
    let ids = texels::<[u32; 2]>(&gbuffer.identity_view);
    let words = texels::<[u32; 4]>(&gbuffer.surface_view);
    let seen = ids.iter().zip(&words);
    seen.map(|(id, words)| (id[0] > 0).then(|| unpack_surface(*words, Vec3::ZERO).base_color))
        .collect()
}

/// The colours of the disc are those of places at most so many pixels away.
fn assert_near(settings: &Settings, pixels: f32) {
    let (scene, camera) = fan();
    let expected = colors(&scene, &camera, &small(SIZE.0, SIZE.1));
    let found = colors(&scene, &camera, settings);
    // Of red or green from one pixel to the next, where the disc is nearest.
    let per_pixel = 0.4 / (RADIUS * 0.5 * SIZE.1 as f32 / (2.1 * 0.5f32.tan()));
    let both = expected.iter().zip(&found);
    let off: Vec<f32> = both
        .filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs().max_element()))
        .collect();
    let most = off.iter().copied().fold(0.0, f32::max) / per_pixel;
    assert!(off.len() > 1500, "{} pixels see the disc", off.len());
    assert!(most <= pixels, "off by {most} pixels");
}

#[test]
fn an_antialiased_pixel_shows_the_colour_of_its_own_place_on_a_thin_triangle() {
    let settings = small(SIZE.0, SIZE.1).with(|s| {
        s.geometry.path = Geometry::Visibility;
        s.antialiasing.mode = Antialiasing::Msaa;
    });
    assert_near(&settings, 1.0);
}

#[test]
fn a_sample_of_several_pixels_shows_the_colour_of_its_own_place_on_a_thin_triangle() {
    let settings = small(SIZE.0, SIZE.1).with(|s| {
        s.geometry.path = Geometry::Visibility;
        s.shading.mode = Shading::Variable;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 2;
        s.variable.blocks_4x4 = true;
        s.rate.stage = RateStage::Both;
    });
    assert_near(&settings, 4.0);
}
