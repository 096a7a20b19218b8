//! Surfaces with lobes: shaders against the twin, lobes against integrals, ways of shading against
//! each other.

use std::f32::consts::PI;

use foveal_generate as generate;
use foveal_scene::{Camera, Clearcoat, ColorSpace, Iridescence, Material, Scene};
use glam::{Vec2, Vec3, Vec4};

use super::lobes_twin::{Lobed, sheen_lobe, sheen_part, sheen_parts};
use crate::shading::dielectric::PLAIN_DIELECTRIC;
use crate::shading::twin::{Surface, position_at, to_eye, unpack_surface};
use crate::testing::{one_texel, picture, radiance, rendered, slot, small, texels};
use crate::{
    Antialiasing, Composite, EdgeTest, Geometry, LightingModel, RateSource, Renderer, Settings,
    Shading,
};

/// The material seen at each pixel.
fn materials<'a>(scene: &'a Scene, renderer: &Renderer) -> Vec<Option<&'a Material>> {
    let identity: Vec<[u32; 2]> = texels(&renderer.targets().gbuffer.identity_view);
    let material = |instance: u32| {
        let instance = &scene.instances[instance as usize];
        &scene.materials[instance.material as usize]
    };
    let numbers = identity
        .into_iter()
        .map(|[number, _]| number.checked_sub(1));
    numbers.map(|number| number.map(material)).collect()
}

/// Lobes without those whose highlights are so sharp that the G-buffer's 8 bits of roughness show.
fn scene() -> Scene {
    let mut scene = generate::lobes();
    for material in &mut scene.materials {
        if let Some(coat) = &mut material.clearcoat {
            coat.roughness = coat.roughness.max(0.2);
        }
    }
    // One film in part over what is half metal: the mix of both.
    let mut films = scene
        .materials
        .iter_mut()
        .filter(|m| m.iridescence.is_some());
    if let Some(half) = films.next() {
        half.metallic = 0.5;
        half.iridescence = half.iridescence.map(|film| Iridescence {
            factor: 0.6,
            ..film
        });
    }
    scene
}

/// The tangent of the vertex whose normal is nearest: spheres have one direction per normal.
fn tangent_of(scene: &Scene, normal: Vec3) -> Vec3 {
    let vertices = scene.meshes[0].vertices.iter();
    let near = |v: &&foveal_scene::Vertex| Vec3::from(v.normal).dot(normal);
    let nearest = vertices.max_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
    let [x, y, z, _] = nearest.tangent;
    Vec3::new(x, y, z)
        .reject_from_normalized(normal)
        .normalize()
}

#[test]
fn lobes_equal_their_twin() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let (width, height) = (121, 97);
    let renderer = rendered(&scene, camera, &small(width, height));
    let words: Vec<[u32; 4]> = texels(&renderer.targets().gbuffer.surface_view);
    let depth: Vec<f32> = texels(&renderer.targets().gbuffer.depth_view);
    let size = Vec2::new(width as f32, height as f32);
    let (mut compared, mut off) = ([0; 4], Vec::new());
    for (i, (device, material)) in radiance(&renderer)
        .into_iter()
        .zip(materials(&scene, &renderer))
        .enumerate()
    {
        let Some(material) = material.filter(|m| m.has_lobes()) else {
            continue;
        };
        let pixel = Vec2::new((i as u32 % width) as f32, (i as u32 / width) as f32) + 0.5;
        let base = unpack_surface(words[i], position_at(camera, size, pixel, depth[i]));
        let v = to_eye(camera, base.position);
        // At flat angles a last bit of the normal counts for much.
        if base.normal.dot(v) < 0.15 {
            continue;
        }
        let along = tangent_of(&scene, base.normal);
        let lobed = Lobed {
            base,
            material,
            along,
        };
        let twin = lobed.lit(&scene, renderer.lights().1, v);
        let kind = usize::from(material.sheen.is_some())
            + 2 * usize::from(material.anisotropy.is_some())
            + 3 * usize::from(material.iridescence.is_some());
        compared[kind] += 1;
        // The G-buffer's colours are of 8 bits, and tangents are a vertex's.
        let tolerance = if kind == 2 { 0.1 } else { 0.04 };
        if (device - twin).abs().max_element() > tolerance * twin.max_element().max(0.05) {
            off.push((material.name.clone(), pixel, device, twin));
        }
    }
    assert!(compared.iter().all(|&n| n > 300), "{compared:?}");
    let all: usize = compared.iter().sum();
    assert!(
        off.len() * 50 < all,
        "{} of {all}: {:?}",
        off.len(),
        &off[..8.min(off.len())]
    );
}

/// A surface in the xy plane.
fn flat(metallic: f32, roughness: f32) -> Surface {
    Surface {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        vertex_normal: Vec3::Z,
        base_color: Vec3::ONE,
        metallic,
        roughness,
        occlusion: 1.0,
        emissive: Vec3::ZERO,
        dielectric: PLAIN_DIELECTRIC,
    }
}

/// Directions of the upper half, each of the same solid angle.
fn above(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let z = (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * cos, across * sin, z)
    })
}

fn views() -> impl Iterator<Item = Vec3> {
    let cosines = [0.15f32, 0.4, 0.7, 0.95];
    cosines.into_iter().map(|c| {
        let across = (1.0 - c * c).sqrt();
        Vec3::new(across * 0.6, across * 0.8, c)
    })
}

/// Metals with one lobe each.
fn kinds() -> Vec<Material> {
    generate::lobes()
        .materials
        .into_iter()
        .filter(|m| m.has_lobes() && m.transmission.is_none())
        .filter(|m| m.clearcoat.is_none_or(|c| c.roughness >= 0.5))
        .filter(|m| m.sheen.is_none_or(|s| s.roughness >= 0.4))
        .collect()
}

#[test]
fn lobes_give_back_no_more_light_than_they_get() {
    let table = sheen_parts();
    for material in kinds() {
        for v in views() {
            let lobed = Lobed {
                base: flat(1.0, 0.6),
                material: &material,
                along: Vec3::X,
            };
            let count = 20_000;
            let sum: Vec3 = above(count)
                .map(|l| lobed.reflected(&table, v, l) * l.z)
                .sum();
            let given = sum * (2.0 * PI / count as f32);
            let name = &material.name;
            assert!(
                given.max_element() <= 1.02,
                "{name}, cosine {}: {given}",
                v.z
            );
            assert!(given.min_element() > 0.3, "{name}, cosine {}: {given}", v.z);
        }
    }
}

#[test]
fn the_table_of_sheen_is_the_integral_of_its_lobe() {
    let table = sheen_parts();
    assert_eq!(table.len(), 64);
    for roughness in [0.3f32, 0.45, 0.7, 1.0] {
        for v in views() {
            let count = 40_000;
            let lobe = |l: Vec3| sheen_lobe(Vec3::Z, v, l, roughness) * l.z;
            let integral = above(count).map(lobe).sum::<f32>() * (2.0 * PI / count as f32);
            let found = sheen_part(&table, v.z, roughness);
            let off = (found - integral).abs();
            assert!(
                off < 0.04,
                "roughness {roughness}, cosine {}: {found}, {integral}",
                v.z
            );
        }
    }
}

#[test]
fn lobes_below_the_coat_are_the_same_with_eye_and_light_exchanged() {
    let table = sheen_parts();
    for material in kinds().iter().filter(|m| m.clearcoat.is_none()) {
        let lobed = Lobed {
            base: flat(0.5, 0.4),
            material,
            along: Vec3::X,
        };
        for (v, l) in views().flat_map(|v| above(50).map(move |l| (v, l))) {
            let (there, back) = (lobed.reflected(&table, v, l), lobed.reflected(&table, l, v));
            let off = (there - back).abs().max_element();
            assert!(
                off <= 2e-3 * there.max_element(),
                "{}: {there} {back}",
                material.name
            );
        }
    }
}

/// Lobes that change next to nothing.
fn faint() -> Scene {
    let mut scene = generate::materials_grid();
    for material in &mut scene.materials {
        material.clearcoat = Some(Clearcoat {
            factor: 1e-6,
            texture: None,
            roughness: 0.5,
            roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
        });
    }
    scene
}

#[test]
fn a_coat_that_is_hardly_there_leaves_the_picture_as_it_is() {
    let plain = generate::materials_grid();
    let camera = &plain.cameras[0];
    for mode in [Antialiasing::None, Antialiasing::Ssaa, Antialiasing::Msaa] {
        let settings = small(131, 97).with(|s| s.antialiasing.mode = mode);
        let [a, b] = [&plain, &faint()].map(|scene| picture(&rendered(scene, camera, &settings)));
        assert_ne!(a, b, "the G-buffer rounds, the forward pass does not");
        let off = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b));
        let far = off.filter(|&d| d > 4).count();
        // Sharp highlights show the G-buffer's rounding, and edges the average, in which bright
        // weighs less.
        assert!(
            far * 20 < a.len(),
            "{mode:?}: {far} of {} values differ",
            a.len()
        );
    }
}

#[test]
fn lobes_are_lit_at_every_pixel_in_every_way_of_shading() {
    let scene = scene();
    let camera: &Camera = &scene.cameras[0];
    let settings = small(131, 97);
    let full = rendered(&scene, camera, &settings);
    let seen = materials(&scene, &full);
    let full = radiance(&full);
    let coarse = |composite| {
        settings.clone().with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.composite = composite;
            s.coarse.source = RateSource::Radii;
        })
    };
    let by_triangles = |s: Settings| s.with(|s| s.geometry.path = Geometry::Visibility);
    for settings in [
        coarse(Composite::Light),
        coarse(Composite::Smooth),
        by_triangles(coarse(Composite::Nearest)),
        by_triangles(settings.clone()),
        settings
            .clone()
            .with(|s| s.shading.mode = Shading::Variable),
    ] {
        let other = radiance(&rendered(&scene, camera, &settings));
        let mut compared = 0;
        for ((a, b), material) in full.iter().zip(&other).zip(&seen) {
            if material.is_some_and(Material::has_lobes) {
                assert_eq!(a, b, "{:?}", settings.shading.mode);
                compared += 1;
            }
        }
        assert!(compared > 2000, "{compared}");
    }
}

#[test]
fn rims_of_lobes_are_between_what_meets_there_where_edges_are_not_averaged() {
    let scene = scene();
    let camera = &scene.cameras[0];
    let (width, height) = (131, 97);
    let large = radiance(&rendered(&scene, camera, &small(2 * width, 2 * height)));
    for test in [EdgeTest::Never, EdgeTest::Paper] {
        let settings = small(width, height).with(|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.antialiasing.edge_test = test;
            s.antialiasing.samples = 4;
        });
        let drawn = radiance(&rendered(&scene, camera, &settings));
        let mut beyond = 0;
        for (i, color) in drawn.iter().enumerate() {
            let (x, y) = (i as u32 % width, i as u32 / width);
            let [xs, ys] = [(x, 2 * width), (y, 2 * height)]
                .map(|(at, end)| (2 * at).saturating_sub(1)..(2 * at + 3).min(end));
            let near = ys.flat_map(|y| xs.clone().map(move |x| (y * 2 * width + x) as usize));
            let near: Vec<Vec3> = near.map(|i| large[i]).collect();
            let least = near.iter().copied().fold(Vec3::INFINITY, Vec3::min);
            let most = near.iter().copied().fold(Vec3::ZERO, Vec3::max);
            let is_between =
                color.cmpge(0.8 * least - 0.01).all() && color.cmple(1.25 * most + 0.01).all();
            beyond += usize::from(!is_between);
        }
        assert!(beyond < 40, "{test:?}: {beyond} pixels");
    }
}

#[test]
fn a_lit_coat_is_brighter_and_the_blinn_phong_model_has_it_too() {
    let with = scene();
    let mut without = with.clone();
    for material in &mut without.materials {
        (material.clearcoat, material.sheen, material.anisotropy) = (None, None, None);
        material.iridescence = None;
    }
    for model in [LightingModel::Ggx, LightingModel::BlinnPhong] {
        let settings = small(131, 97).with(|s| s.lighting.model = model);
        let [a, b] = [&with, &without].map(|scene| {
            let drawn = rendered(scene, &scene.cameras[0], &settings);
            let seen = materials(&with, &drawn);
            let pairs = radiance(&drawn).into_iter().zip(seen);
            let coated = pairs.filter(|(_, m)| m.is_some_and(|m| m.clearcoat.is_some()));
            coated.map(|(r, _)| r.element_sum()).sum::<f32>()
        });
        assert!(a > 1.05 * b, "{model:?}: {a} {b}");
    }
}

#[test]
fn textures_of_lobes_are_read_where_their_places_say() {
    let coat = |factor, texture, roughness, roughness_texture| Clearcoat {
        factor,
        texture,
        roughness,
        roughness_texture,
        normal_texture: None,
        normal_scale: 1.0,
    };
    let drawn = |coat: Clearcoat| {
        let material = Material {
            base_color: Vec4::new(0.3, 0.1, 0.1, 1.0),
            metallic: 0.0,
            clearcoat: Some(coat),
            ..Material::default()
        };
        let mut scene = super::twin::quads(vec![material], &[0.0]);
        scene.textures = [[51, 7, 7, 7], [9, 102, 9, 9]]
            .map(|texel| one_texel(ColorSpace::Linear, texel))
            .to_vec();
        scene.light_by_default();
        radiance(&rendered(&scene, &super::twin::front(), &small(31, 31)))
    };
    let by_textures = drawn(coat(1.0, slot(0), 1.0, slot(1)));
    let by_factors = drawn(coat(0.2, None, 0.4, None));
    let off = by_textures.iter().zip(&by_factors);
    let off = off
        .map(|(a, b)| (a - b).abs().max_element())
        .fold(0.0, f32::max);
    assert!(off < 2e-3, "{off}");
    let other = drawn(coat(0.2, None, 0.9, None));
    assert_ne!(by_factors, other);
}

#[test]
fn a_smooth_coat_seen_from_the_side_takes_away_no_more_than_all() {
    let material = Material {
        emissive: Vec3::splat(100.0),
        clearcoat: faint().materials[0].clearcoat.map(|coat| Clearcoat {
            factor: 1.0,
            roughness: 0.0,
            ..coat
        }),
        ..Material::default()
    };
    let lobed = Lobed {
        base: Surface {
            emissive: material.emissive,
            ..flat(0.0, 0.5)
        },
        material: &material,
        along: Vec3::X,
    };
    let dark = Scene::default();
    assert!(lobed.lit(&dark, &[], Vec3::Y).min_element() >= 0.0);
    let mut scene = super::twin::quads(vec![material], &[0.0]);
    for vertex in &mut scene.meshes[0].vertices {
        vertex.normal = [1.0, 0.0, 0.0];
    }
    let settings = small(33, 33).with(|s| s.lighting.environment = crate::EnvironmentSource::None);
    let drawn = rendered(&scene, &super::twin::front(), &settings);
    let all = radiance(&drawn);
    assert!(all.iter().any(|r| r.x > 0.0));
    assert!(all.iter().all(|r| r.min_element() >= 0.0));
}
