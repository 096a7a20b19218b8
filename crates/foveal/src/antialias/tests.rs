//! Anti-aliased frames against their twins, against each other and against plain frames of n times
//! the size.

use foveal_generate as generate;
use foveal_scene::{Camera, Projection, Scene};
use glam::{Mat4, Vec3};

use super::twin::{SampleTexels, resolve};
use crate::testing::{picture, radiance, rate_cells, rendered, small, texels};
use crate::{Antialiasing, EdgeTest, Geometry, Renderer, SamplePattern, Settings};

const WIDTH: u32 = 41;
const HEIGHT: u32 = 27;

fn settings(aa: Antialiasing, edge_test: EdgeTest, samples: u32) -> Settings {
    small(WIDTH, HEIGHT).with(|s| {
        s.antialiasing.mode = aa;
        s.antialiasing.edge_test = edge_test;
        s.antialiasing.samples = samples;
    })
}

fn samples_of(renderer: &Renderer) -> SampleTexels {
    let targets = renderer
        .targets()
        .samples
        .as_ref()
        .expect("anti-aliasing is on");
    let settings = renderer.settings();
    SampleTexels {
        pattern: targets.pattern,
        width: settings.picture.width,
        height: settings.picture.height,
        surface: texels(&targets.samples.surface_view),
        identity: texels(&targets.samples.identity_view),
        depth: texels(&targets.samples.depth_view),
    }
}

fn tally(renderer: &Renderer) -> Vec<[u8; 2]> {
    let targets = renderer
        .targets()
        .samples
        .as_ref()
        .expect("anti-aliasing is on");
    texels(&targets.tally_view)
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)))
}

fn orthographic(camera: &Camera) -> Camera {
    Camera {
        projection: Projection::Orthographic {
            height_m: 4.0,
            near_m: 0.05,
            far_m: 30.0,
        },
        ..camera.clone()
    }
}

#[test]
fn ssaa_is_the_resolve_of_a_plain_frame_of_n_times_the_size() {
    for scene in [generate::cornell(), generate::materials_grid()] {
        let camera = &scene.cameras[0];
        // Weights of blinding light are far below what halves hold.
        for (side, stops) in [
            (2, 0.0),
            (3, 0.0),
            (4, 0.0),
            (2, 14.0),
            (4, 30.0),
            (2, 64.0),
        ] {
            let exposed = |s: &mut Settings| s.picture.exposure_stops = stops;
            let big = small(WIDTH * side, HEIGHT * side).with(exposed);
            let big = radiance(&rendered(&scene, camera, &big));
            let ssaa = settings(Antialiasing::Ssaa, EdgeTest::Surface, side * side).with(exposed);
            let ssaa = radiance(&rendered(&scene, camera, &ssaa));
            for (i, (x, y)) in pixels().enumerate() {
                let parts = (0..side * side).map(|k| {
                    let (x, y) = (x * side + k % side, y * side + k / side);
                    (big[(y * WIDTH * side + x) as usize], 1.0)
                });
                let twin = resolve(parts, stops.exp2());
                let off = (ssaa[i] - twin).abs().max_element();
                assert!(
                    off <= 4e-3 * twin.max_element() + 1e-4,
                    "{side} x {side}, {stops} stops at {x}, {y}: {} not {twin}",
                    ssaa[i]
                );
            }
        }
    }
}

#[test]
fn by_the_papers_test_edges_equal_ssaa_and_the_rest_equals_the_first_subsample_alone() {
    let scene = generate::cornell();
    for camera in [scene.cameras[0].clone(), orthographic(&scene.cameras[0])] {
        for samples in [4, 9] {
            let draw = |aa, test| rendered(&scene, &camera, &settings(aa, test, samples));
            let msaa = draw(Antialiasing::Msaa, EdgeTest::Paper);
            let none = draw(Antialiasing::Msaa, EdgeTest::Never);
            let ssaa = draw(Antialiasing::Ssaa, EdgeTest::Paper);
            let (tally, samples_of) = (tally(&msaa), samples_of(&msaa));
            let texels =
                [&msaa, &none, &ssaa].map(|r| texels::<[u16; 4]>(&r.targets().radiance_view));
            let pictures = [&msaa, &none, &ssaa].map(picture);
            let mut edges = 0;
            for (i, (x, y)) in pixels().enumerate() {
                let edge = samples_of.depths_differ(x, y);
                assert_eq!(tally[i][0] > 1, edge, "at {x}, {y}");
                let like = if edge { 2 } else { 1 };
                assert_eq!(texels[0][i], texels[like][i], "at {x}, {y}");
                let bytes = i * 4..i * 4 + 4;
                assert_eq!(pictures[0][bytes.clone()], pictures[like][bytes]);
                edges += usize::from(edge);
            }
            assert!((20..tally.len() - 20).contains(&edges), "{edges} edges");
        }
    }
}

fn assert_surfaces_equal_twin(scene: &Scene, camera: &Camera, settings: &Settings) {
    let renderer = rendered(scene, camera, settings);
    let (tally, samples) = (tally(&renderer), samples_of(&renderer));
    let mut edges = 0;
    for (i, (x, y)) in pixels().enumerate() {
        assert_eq!(tally[i], samples.surfaces(camera, x, y), "at {x}, {y}");
        edges += usize::from(tally[i][0] > 1);
    }
    assert!((20..tally.len() / 2).contains(&edges), "{edges} edges");
}

#[test]
fn the_surface_test_equals_its_twin() {
    let scene = generate::cornell();
    let msaa = |samples| settings(Antialiasing::Msaa, EdgeTest::Surface, samples);
    for samples in [4, 9, 16] {
        assert_surfaces_equal_twin(&scene, &scene.cameras[0], &msaa(samples));
    }
    for samples in [4, 8] {
        let rotated = msaa(samples).with(|s| s.antialiasing.pattern = SamplePattern::Rotated);
        assert_surfaces_equal_twin(&scene, &scene.cameras[0], &rotated);
    }
    assert_surfaces_equal_twin(&scene, &orthographic(&scene.cameras[0]), &msaa(4));
}

/// Mean absolute difference of two pictures' bytes.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    let sum: u64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| u64::from(a.abs_diff(*b)))
        .sum();
    sum as f64 / a.len() as f64
}

#[test]
fn every_mode_is_nearer_to_64_samples_than_none_is() {
    for scene in [generate::cornell(), generate::alpha()] {
        let camera = &scene.cameras[0];
        let draw = |settings: &Settings| picture(&rendered(&scene, camera, settings));
        let truth = draw(&settings(Antialiasing::Ssaa, EdgeTest::Surface, 64));
        let none = difference(&draw(&small(WIDTH, HEIGHT)), &truth);
        for aa in [Antialiasing::Ssaa, Antialiasing::Msaa] {
            for (pattern, samples) in [
                (SamplePattern::Grid, 4),
                (SamplePattern::Grid, 16),
                (SamplePattern::Rotated, 4),
                (SamplePattern::Rotated, 8),
            ] {
                let settings = settings(aa, EdgeTest::Surface, samples)
                    .with(|s| s.antialiasing.pattern = pattern);
                let off = difference(&draw(&settings), &truth);
                assert!(
                    off < 0.6 * none,
                    "{aa:?} {pattern:?} {samples}: {off} of {none}"
                );
            }
        }
    }
}

#[test]
fn bands_leave_no_trace() {
    let scene = generate::cornell();
    for (pattern, geometry) in [
        (SamplePattern::Grid, Geometry::Gbuffer),
        (SamplePattern::Rotated, Geometry::Gbuffer),
        (SamplePattern::Grid, Geometry::Visibility),
    ] {
        for aa in [Antialiasing::Ssaa, Antialiasing::Msaa] {
            let settings = settings(aa, EdgeTest::Surface, 4).with(|s| {
                s.antialiasing.pattern = pattern;
                s.geometry.path = geometry;
            });
            let mut renderer = rendered(&scene, &scene.cameras[0], &settings);
            let whole = picture(&renderer);
            for rows in [1, 4, 13] {
                renderer.redraw_in_bands(&scene.cameras[0], rows);
                assert_eq!(picture(&renderer), whole, "{aa:?} {pattern:?}, {rows} rows");
            }
        }
    }
}

#[test]
fn the_stats_count_what_is_shaded() {
    let scene = generate::cornell();
    let pixels = u64::from(WIDTH * HEIGHT);
    let stats = |settings: &Settings| {
        let mut renderer = rendered(&scene, &scene.cameras[0], settings);
        let stats = renderer.redraw(&scene.cameras[0]);
        (stats, tally(&renderer))
    };
    let (ssaa, _) = stats(&settings(Antialiasing::Ssaa, EdgeTest::Surface, 9));
    assert_eq!(ssaa.shaded_samples, pixels * 9);
    assert_eq!(ssaa.edge_fraction, 1.0);
    for (edge_test, done) in [(EdgeTest::Surface, 1), (EdgeTest::Paper, 0)] {
        let (msaa, tally) = stats(&settings(Antialiasing::Msaa, edge_test, 4));
        let edges = tally.iter().filter(|t| t[0] > 1);
        let extra: u64 = edges.clone().map(|t| u64::from(t[0]) - done).sum();
        assert_eq!(msaa.shaded_samples, pixels + extra);
        assert_eq!(msaa.edge_fraction, edges.count() as f64 / pixels as f64);
    }
}

#[test]
fn two_by_two_at_1080p_stays_under_250_megabytes() {
    let settings = Settings::default().with(|s| {
        s.picture.width = 1920;
        s.picture.height = 1080;
        s.antialiasing.mode = Antialiasing::Msaa;
    });
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = settings.clone().with(|s| s.geometry.path = geometry);
        let bytes = crate::targets::Targets::new(
            crate::testing::gpu(),
            &settings,
            crate::stereo::Submission::Mono,
        )
        .bytes();
        assert!(bytes < 300_000_000, "{bytes}");
        assert!(
            geometry == Geometry::Visibility || bytes < 250_000_000,
            "{bytes}"
        );
    }
}

/// The surfaces that triangles are sorted into against those of stored sub-samples, which have a
/// twin.
#[test]
fn triangles_are_sorted_into_the_same_surfaces_as_stored_subsamples() {
    for scene in [generate::cornell(), generate::materials_grid()] {
        for camera in [scene.cameras[0].clone(), orthographic(&scene.cameras[0])] {
            for samples in [4, 9, 16] {
                let stored = settings(Antialiasing::Msaa, EdgeTest::Surface, samples);
                let sorted = stored
                    .clone()
                    .with(|s| s.geometry.path = Geometry::Visibility);
                let [stored, sorted] =
                    [stored, sorted].map(|s| tally(&rendered(&scene, &camera, &s)));
                let edges = stored.iter().filter(|t| t[0] > 1).count();
                // A stored normal has 8 bits: on round things a sub-sample may fall on either side.
                let differs = |(a, b): &(&[u8; 2], &[u8; 2])| {
                    (a[0] > 1) != (b[0] > 1) || u32::from(a[1].abs_diff(b[1])) > samples / 8
                };
                let differing = stored.iter().zip(&sorted).filter(differs).count();
                assert!(edges > 20, "{edges}");
                assert!(
                    differing * 20 <= edges,
                    "{differing} of {edges}, {samples} samples"
                );
            }
        }
    }
}

/// The same scene and what sees it, larger or smaller.
fn scaled(scene: &Scene, by: f32) -> Scene {
    let mut scene = scene.clone();
    let grown = Mat4::from_scale(Vec3::splat(by));
    for instance in &mut scene.instances {
        instance.world_from_object = grown * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(grown);
    }
    for object in &mut scene.objects {
        object.bounds = object.bounds.transformed(grown);
    }
    let eye = &mut scene.cameras[0].world_from_view.w_axis;
    *eye = (eye.truncate() * by).extend(1.0);
    if let Projection::Perspective { near_m, .. } = &mut scene.cameras[0].projection {
        *near_m *= by;
    }
    scene
}

#[test]
fn triangles_of_any_size_are_sorted_into_the_same_surfaces() {
    let scene = generate::cornell();
    let settings = settings(Antialiasing::Msaa, EdgeTest::Surface, 4)
        .with(|s| s.geometry.path = Geometry::Visibility);
    // By powers of two all is rounded alike.
    let [plain, small, large] = [0.0, -20.0, 20.0].map(|power: f32| {
        let scene = scaled(&scene, power.exp2());
        tally(&rendered(&scene, &scene.cameras[0], &settings))
    });
    let edges = plain.iter().filter(|t| t[0] > 1).count();
    assert!(edges > 20, "{edges}");
    for (name, other) in [("small", small), ("large", large)] {
        let off = plain.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert_eq!(off, 0, "{name}, of {edges}");
    }
}

#[test]
fn over_a_visibility_buffer_pixels_within_a_triangle_equal_none_and_edges_come_near_ssaa() {
    let scene = generate::cornell();
    let with =
        |aa| settings(aa, EdgeTest::Surface, 4).with(|s| s.geometry.path = Geometry::Visibility);
    let draw = |aa| rendered(&scene, &scene.cameras[0], &with(aa));
    let msaa = draw(Antialiasing::Msaa);
    let tally = tally(&msaa);
    let [none, ssaa] = [Antialiasing::None, Antialiasing::Ssaa].map(|aa| radiance(&draw(aa)));
    let msaa = radiance(&msaa);
    let distance = |a: Vec3, b: Vec3| (a - b).length() / (a + b).length().max(1e-3);
    let (mut of_none, mut of_msaa) = (0.0, 0.0);
    for i in 0..tally.len() {
        if tally[i][0] > 1 {
            of_none += distance(none[i], ssaa[i]);
            of_msaa += distance(msaa[i], ssaa[i]);
        } else {
            // The mean of the sub-samples' depths rounds otherwise than the centre's.
            assert!(distance(msaa[i], none[i]) < 0.01, "{} {}", msaa[i], none[i]);
        }
    }
    assert!(of_msaa < 0.25 * of_none, "{of_msaa} and {of_none}");
}

/// Mean distance of msaa and of none to ssaa, over pixels that msaa shades once.
fn within_surfaces(scene: &Scene, geometry: Geometry) -> [f32; 2] {
    let draw = |aa| {
        let settings = settings(aa, EdgeTest::Surface, 4).with(|s| {
            s.geometry.path = geometry;
            // With more of it, no anti-aliasing is near to ssaa, too.
            s.lighting.anisotropy = 1;
        });
        rendered(scene, &scene.cameras[0], &settings)
    };
    let msaa = draw(Antialiasing::Msaa);
    let tally = tally(&msaa);
    let [ssaa, none] = [Antialiasing::Ssaa, Antialiasing::None].map(|aa| radiance(&draw(aa)));
    [radiance(&msaa), none].map(|picture| {
        let off = (picture.iter().zip(&ssaa).zip(&tally))
            .filter(|(_, tally)| tally[0] == 1)
            .map(|((a, b), _)| (a - b).length() / (a + b).length().max(1e-3));
        off.clone().sum::<f32>() / off.count() as f32
    })
}

#[test]
fn within_surfaces_msaa_is_near_to_ssaa_by_gbuffer_and_nearer_than_none_over_a_visibility_buffer() {
    let options = generate::DemoOptions {
        instances: 1000,
        lights: 20,
        seed: 1,
    };
    let scene = generate::demo(&options).expect("it can be");
    let [msaa, none] = within_surfaces(&scene, Geometry::Gbuffer);
    assert!(msaa < 0.2 * none, "{msaa} and {none}");
    let [msaa, none] = within_surfaces(&scene, Geometry::Visibility);
    assert!(msaa < 0.8 * none, "{msaa} and {none}");
}

#[test]
fn with_samples_of_colour_pixels_of_level_0_are_antialiased_and_the_others_coarse() {
    use crate::{Composite, RateSource, RefineEdges, Shading};
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let fine =
            settings(Antialiasing::Msaa, EdgeTest::Surface, 4).with(|s| s.geometry.path = geometry);
        let coarse = fine.clone().with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.source = RateSource::Radii;
            s.coarse.refine_edges = RefineEdges::Off;
            s.coarse.composite = Composite::Smooth;
        });
        assert_fine_where_the_level_is_0(&fine, &coarse);
    }
}

fn assert_fine_where_the_level_is_0(antialiased: &Settings, coarse: &Settings) {
    let scene = generate::cornell();
    let draw = |settings: &Settings| rendered(&scene, &scene.cameras[0], settings);
    let radiance =
        |renderer: &Renderer| -> Vec<[u16; 4]> { texels(&renderer.targets().radiance_view) };
    let mut both = draw(coarse);
    let stats = both.redraw(&scene.cameras[0]);
    let antialiased = radiance(&draw(antialiased));
    let owners = &both.targets().coarse.as_ref().expect("coarse").rate.owner;
    let across = owners.blocks(1).0;
    let levels = rate_cells(owners, 1);
    let (mut fine, mut kept) = (0, 0);
    let mut evaluations = stats.coarse.expect("coarse").shaded_samples();
    let tally = tally(&both);
    let both = radiance(&both);
    for (i, (x, y)) in pixels().enumerate() {
        let level = levels[(y / 2 * across + x / 2) as usize] & 15;
        if level == 0 {
            assert_eq!(both[i], antialiased[i], "at {x}, {y}");
            fine += usize::from(tally[i][0] > 1);
        } else {
            kept += usize::from(tally[i][0] > 1);
        }
        // Stored sub-samples are shaded before levels are known.
        if level == 0 || coarse.geometry.path == Geometry::Gbuffer {
            evaluations += u64::from(tally[i][0]) - 1;
        }
    }
    assert_eq!(stats.shaded_samples, evaluations);
    assert!(
        fine > 5 && kept > 5,
        "{fine} fine edges, {kept} coarse ones"
    );
}

#[test]
fn surfaces_without_room_are_counted_and_have_it_in_the_next_frame() {
    let scene = generate::cornell();
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings =
            settings(Antialiasing::Msaa, EdgeTest::Surface, 4).with(|s| s.geometry.path = geometry);
        let camera = &scene.cameras[0];
        let mut renderer = rendered(&scene, camera, &settings);
        let whole = picture(&renderer);
        renderer.cut_room_for_edges();
        let short = renderer.redraw(camera);
        assert!(short.surfaces_left_out > 0, "{geometry:?}");
        assert_ne!(picture(&renderer), whole, "{geometry:?}");
        let enough = renderer.redraw(camera);
        assert_eq!(enough.surfaces_left_out, 0, "{geometry:?}");
        assert_eq!(picture(&renderer), whole, "{geometry:?}");
    }
}
