//! Samples' light and the composite that puts pixels' surfaces into it, beside their twins.

use std::collections::BTreeSet;

use foveal_generate as generate;
use foveal_scene::{Camera, Light, LightKind, Material, Mesh, Scene, Vertex};
use glam::{Mat4, UVec2, Vec3};

use super::light_twin::{Inputs, SampleLight, highlight, unpack_light};
use crate::shading::twin::{squared_alpha, to_eye};
use crate::testing::{add, f32_of_half, rendered, small, texels};
use crate::{
    CoarseSample, Composite, RateSource, RefineEdges, Renderer, Settings, Shading, Shadows,
};

fn radiance(renderer: &Renderer) -> Vec<[u16; 4]> {
    texels(&renderer.targets().radiance_view)
}

fn settings(size: (u32, u32), coarse_sample: CoarseSample) -> Settings {
    small(size.0, size.1).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.composite = Composite::Light;
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.05;
        s.coarse.fovea_outer = 0.5;
        s.eye.gaze = [0.3, 0.6];
        s.coarse.refine_edges = RefineEdges::Graded;
        s.coarse.sample = coarse_sample;
    })
}

fn scene() -> Scene {
    let mut scene = generate::by_name("demo:1000").unwrap();
    generate::add_point_lights(&mut scene, 20, 5);
    scene
}

#[test]
fn samples_hold_the_lamps_light() {
    let scene = scene();
    for shadows in [Shadows::Off, Shadows::Hard, Shadows::Soft] {
        assert_samples_hold_the_lamps_light(&scene, shadows);
    }
}

/// Whether two deviations are packed within three quarters of a step of one another.
fn is_close(a: f32, b: f32) -> bool {
    let [a, b] = [a, b].map(|d| d / (0.5 + d));
    (a - b).abs() < 0.05
}

fn assert_samples_hold_the_lamps_light(scene: &Scene, shadows: Shadows) {
    let camera = &scene.cameras[0];
    let settings = settings((240, 150), CoarseSample::Center).with(|s| {
        s.lighting.shadows = shadows;
        s.lighting.shadow_atlas = 2048;
    });
    let renderer = rendered(scene, camera, &settings);
    let inputs = Inputs::of(&renderer, scene, camera);
    let (mut seen, mut wrong) = ([0; 9], Vec::new());
    let (mut by_normals, mut shadowed, mut tilted) = (0, 0, 0);
    let all = (0..150u32).flat_map(|y| (0..240u32).map(move |x| UVec2::new(x, y)));
    for texel in all {
        let level = inputs.level(texel);
        let block = texel >> level;
        let at = inputs.sample(block, level, 0);
        if at != texel || inputs.depth(at) == 0.0 {
            continue;
        }
        let (twin, by_shadows) = inputs.light(block, level);
        let found = unpack_light(inputs.light[level as usize][inputs.index(block, level)]);
        let near =
            |a: Vec3, b: Vec3| (a - b).abs().max_element() <= 0.03 * b.max_element().max(0.01);
        assert!(found.normal.dot(twin.normal) > 0.99, "normal at {texel}");
        by_normals += u32::from(twin.deviation > by_shadows + 0.2);
        shadowed += u32::from(by_shadows > 0.3);
        tilted += u32::from(twin.tilted_deviation > 0.3);
        let mut is_right = near(found.diffuse, twin.diffuse)
            && found.direction.dot(twin.direction) > 0.999
            && is_close(found.deviation, twin.deviation)
            && is_close(found.tilted_deviation, twin.tilted_deviation);
        // A highlight's direction and height hang on each other: what a pixel makes of them counts.
        let s = inputs.surface(texel);
        let v = to_eye(camera, s.position);
        let shown = |l: &SampleLight| {
            l.specular
                * highlight(
                    s.normal,
                    v,
                    l.specular_direction,
                    squared_alpha(&s) + l.spread,
                )
        };
        let (a, b) = (shown(&found), shown(&twin));
        is_right &= (a - b).abs().max_element() <= 0.1 * b.max_element().max(0.02);
        if !is_right {
            wrong.push((
                texel,
                level,
                found.diffuse,
                twin.diffuse,
                [found.deviation, twin.deviation],
                [found.tilted_deviation, twin.tilted_deviation],
            ));
        }
        seen[level as usize] += 1;
    }
    assert!(seen[..5].iter().all(|&n| n > 5), "{seen:?}");
    let all: usize = seen.iter().sum();
    // Where a comparison with a shadow's depth is a matter of the last bit, both are right.
    let most = if shadows == Shadows::Off {
        0
    } else {
        all / 100
    };
    println!(
        "{shadows:?}: {all} samples, {shadowed} uneven by shadows, {by_normals} by normals, {tilted} on tilted surfaces, {} differ",
        wrong.len()
    );
    assert!(
        wrong.len() <= most,
        "{shadows:?}: {} of {all}: {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(4)]
    );
    assert!(by_normals > 5 && tilted > 5, "{by_normals} {tilted}");
    assert_eq!(shadowed > 20, shadows != Shadows::Off, "{shadowed}");
}

#[test]
fn the_composite_of_light_equals_its_twin_and_shades_or_leads_pixels_without_a_sample() {
    let scene = scene();
    let camera = &scene.cameras[0];
    for (size, sample, shadows) in [
        ((150, 93), CoarseSample::Center, Shadows::Off),
        ((67, 131), CoarseSample::Typical, Shadows::Off),
        ((150, 93), CoarseSample::Center, Shadows::Soft),
    ] {
        let shadowed = |s: &mut Settings| {
            s.lighting.shadows = shadows;
            s.lighting.shadow_atlas = 2048;
        };
        let coarse = settings(size, sample).with(shadowed);
        let renderer = rendered(&scene, camera, &coarse);
        let full = small(size.0, size.1).with(shadowed);
        let full = radiance(&rendered(&scene, camera, &full));
        let inputs = Inputs::of(&renderer, &scene, camera);
        let all = (0..size.1).flat_map(|y| (0..size.0).map(move |x| UVec2::new(x, y)));
        let has_sample = |at: &UVec2| inputs.level(*at) > 0 && inputs.depth(*at) > 0.0;
        let joined: Vec<_> = (all.clone().filter(has_sample))
            .map(|at| (at, inputs.pixel(at)))
            .collect();
        let unlit = joined.iter().filter(|(_, twin)| twin.radiance.is_none());
        let leaders: BTreeSet<_> = (unlit.filter_map(|&(at, _)| inputs.leader(at).0))
            .map(<[u32; 2]>::from)
            .collect();
        let drawn = radiance(&renderer);
        let index = |at: UVec2| (at.y * size.0 + at.x) as usize;
        for at in all.filter(|at| !has_sample(at)) {
            let is_full = drawn[index(at)] == full[index(at)];
            assert!(is_full, "{at}: needs no sample");
        }
        let led = joined
            .iter()
            .filter(|(_, twin)| twin.radiance.is_none() && !twin.is_close);
        for leader in led.filter_map(|&(at, _)| match inputs.leader(at) {
            (Some(leader), false) => Some(index(leader)),
            _ => None,
        }) {
            assert_eq!(drawn[leader], full[leader], "{leader} leads");
        }
        let (mut wrong, mut compared) = (Vec::new(), 0);
        let (mut unlit, mut led, mut disputed, mut uneven) = (0, 0, 0, 0);
        for (at, twin) in joined {
            let (texel, full) = (drawn[index(at)], full[index(at)]);
            let (leader, is_close) = inputs.leader(at);
            // Where float and float disagree about a threshold, either is right. Leaders are shaded,
            // whatever the samples say of them.
            if twin.is_close
                || (twin.radiance.is_none() && is_close)
                || (texel == full && leaders.contains(&<[u32; 2]>::from(at)))
            {
                continue;
            }
            if twin.radiance.is_none() {
                unlit += 1;
                disputed += u32::from(twin.is_disputed);
                uneven += u32::from(twin.is_uneven);
            }
            let expected = match (twin.radiance, leader) {
                (Some(joined), _) => joined,
                (None, Some(leader)) => {
                    led += 1;
                    inputs.led(at, leader)
                }
                (None, None) => {
                    assert_eq!(texel, full, "{at} is shaded by itself");
                    continue;
                }
            };
            compared += 1;
            let shown = Vec3::from_array([0, 1, 2].map(|c| f32_of_half(texel[c])));
            if (shown - expected).abs().max_element() > 0.01 * expected.max_element().max(0.05) {
                wrong.push((at, leader, shown, expected));
            }
        }
        println!(
            "{size:?}, {shadows:?}: {compared} joined, {unlit} without a sample, {led} of them led, {uneven} by what is within blocks, {} differ",
            wrong.len()
        );
        // Across steep depth a last bit decides over a weight.
        assert!(
            wrong.len() * 200 <= compared,
            "{} of {compared}: {:?}",
            wrong.len(),
            &wrong[..4]
        );
        assert!(compared > 2000, "{compared}");
        assert!(disputed > 20 && unlit - disputed > 20, "{unlit} {disputed}");
        assert!(uneven > 20 && led > 100, "{uneven} {led}");
    }
}

/// A level floor of strips a finger wide, of which every eighth is tilted towards +x.
fn ridged_floor() -> Mesh {
    let tilted = Vec3::new(0.45, 1.0, 0.0).normalize();
    let mut mesh = Mesh::default();
    for strip in 0..160 {
        let normal = if strip % 8 == 0 { tilted } else { Vec3::Y };
        let first = mesh.vertices.len() as u32;
        for (across, z) in [(0, 2.0), (1, 2.0), (1, -2.0), (0, -2.0)] {
            mesh.vertices.push(Vertex {
                position: [0.02 * (strip + across - 80) as f32, 0.0, z],
                normal: normal.to_array(),
                color: [u16::MAX; 4],
                ..bytemuck::Zeroable::zeroed()
            });
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    mesh
}

/// A lamp below the floor's horizon lights ridges alone. A sample on level floor holds nothing of it.
#[test]
fn ridges_are_lit_by_a_lamp_that_no_sample_faces() {
    let mut scene = Scene::default();
    let matte = Material {
        metallic: 0.0,
        ..Material::default()
    };
    add(&mut scene, ridged_floor(), matte, Mat4::IDENTITY);
    scene.lights.push(Light {
        kind: LightKind::Point,
        color: Vec3::ONE,
        intensity: 4000.0,
        position: Vec3::new(20.0, -0.1, 0.0),
        direction: Vec3::NEG_Y,
        range_m: Some(100.0),
        node: None,
    });
    let camera = Camera::look_at(Vec3::new(0.0, 2.0, 0.01), Vec3::ZERO, Vec3::Y, 0.8);
    let coarse = settings((160, 160), CoarseSample::Center).with(|s| {
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 4;
        s.coarse.refine_edges = RefineEdges::Off;
    });
    let coarse = radiance(&rendered(&scene, &camera, &coarse));
    let full = radiance(&rendered(&scene, &camera, &small(160, 160)));
    let bright = |texel: &[u16; 4]| f32_of_half(texel[1]);
    let least = full.iter().map(bright).fold(f32::MAX, f32::min);
    let ridges: Vec<_> = (full.iter().zip(&coarse))
        .filter(|(full, _)| bright(full) > least + 0.3)
        .collect();
    let differ =
        |(a, b): &&(&[u16; 4], &[u16; 4])| (bright(a) - bright(b)).abs() > 0.05 * bright(a);
    let right = ridges.iter().filter(|pair| !differ(pair));
    let (seen, right) = (ridges.len(), right.count());
    assert!(seen > 1500 && right * 20 > seen * 19, "{right} of {seen}");
}
