//! What poses change besides places (KHR_animation_pointer): pictures of a pose are, to the bit,
//! those of a file with the values that the pose has.

use foveal_scene::{Camera, LoadOptions, Material, Scene, load_bytes};
use foveal_seeds::File;
use foveal_seeds::pointers::{MOVES, Moved, animate, hold, movable};
use pollster::block_on;

use crate::testing::{Film, gpu, gpu_with, picture, rendered_on, small, texels};
use crate::{
    Antialiasing, Culling, DebugView, Geometry, MaterialDispatch, RateSource, Settings, Shading,
    Shadows,
};

/// Frames after which a picture at rest no longer changes.
const ROUND: usize = 18;

fn load(file: &File) -> Scene {
    let options = LoadOptions::default();
    let no_files = |_: &str| Err("no files".to_owned());
    load_bytes(&file.glb(), "test.glb", &options, &no_files).expect("a good file")
}

fn moving(moves: &[Moved]) -> Scene {
    let mut file = movable();
    hold(&mut file, moves, 0.0);
    animate(&mut file, moves);
    load(&file)
}

fn still(moves: &[Moved], time_s: f32) -> Scene {
    let mut file = movable();
    hold(&mut file, moves, time_s);
    load(&file)
}

fn settings() -> Settings {
    small(120, 80).with(|s| {
        s.lighting.shadows = Shadows::Soft;
        s.lighting.shadow_atlas = 1024;
    })
}

/// What the settings show of a scene that rests.
fn at_rest(film: &mut Film, camera: &Camera, settings: &Settings) -> Vec<u8> {
    let frames = match settings.shading.mode {
        Shading::Full => 1,
        Shading::Coarse | Shading::Variable => ROUND,
    };
    for _ in 0..frames {
        film.draw(camera);
    }
    picture(&film.renderer)
}

fn fresh(scene: &Scene, settings: &Settings) -> Vec<u8> {
    at_rest(&mut Film::new(scene, settings), &scene.cameras[0], settings)
}

/// A film that goes forth and back in a clip shows at each time what the file with that time's values
/// shows.
fn assert_pictures(moves: &[Moved], settings: &Settings) {
    let mut scene = moving(moves);
    scene.pose(0.0);
    let mut film = Film::new(&scene, settings);
    let mut known: Vec<(f32, Vec<u8>)> = Vec::new();
    for time_s in [0.25, 1.0, 0.75, 0.25] {
        scene.pose(time_s);
        block_on(film.renderer.update_pose(&scene)).expect("it fits");
        let found = at_rest(&mut film, &scene.cameras[0].clone(), settings);
        let before = known.iter().find(|(at, _)| *at == time_s);
        let expected = match before {
            Some((_, picture)) => picture.clone(),
            None => fresh(&still(moves, time_s), settings),
        };
        let texels = found
            .as_chunks::<4>()
            .0
            .iter()
            .zip(expected.as_chunks::<4>().0);
        let differing = texels.filter(|(a, b)| a != b).count();
        let pointers: Vec<&str> = moves.iter().map(|m| m.pointer).take(3).collect();
        assert_eq!(differing, 0, "{pointers:?} at {time_s}");
        assert!(
            before.is_some() || known.iter().all(|(_, other)| *other != expected),
            "{pointers:?}: nothing is seen of it at {time_s}"
        );
        known.push((time_s, expected));
    }
}

#[test]
fn a_pose_is_drawn_as_a_file_with_its_values() {
    assert_pictures(MOVES, &settings());
    let visibility = settings().with(|s| s.geometry.path = Geometry::Visibility);
    for by in [MaterialDispatch::Material, MaterialDispatch::Family] {
        let settings = visibility
            .clone()
            .with(|s| s.geometry.material_dispatch = by);
        assert_pictures(MOVES, &settings);
    }
}

#[test]
fn light_that_is_kept_becomes_that_of_the_pose() {
    for path in [Geometry::Gbuffer, Geometry::Visibility] {
        assert_pictures(
            MOVES,
            &settings().with(|s| {
                s.geometry.path = path;
                s.shading.mode = Shading::Coarse;
                s.coarse.history = true;
                s.coarse.source = RateSource::Radii;
                s.coarse.fovea_inner = 0.1;
                s.coarse.fovea_outer = 1.0;
            }),
        );
    }
}

#[test]
fn rates_become_those_of_the_pose() {
    assert_pictures(
        MOVES,
        &settings().with(|s| s.shading.mode = Shading::Variable),
    );
}

#[test]
fn sub_samples_and_culling_follow_the_pose() {
    assert_pictures(
        MOVES,
        &settings().with(|s| s.antialiasing.mode = Antialiasing::Msaa),
    );
    assert_pictures(
        MOVES,
        &settings().with(|s| s.culling.mode = Culling::Occlusion),
    );
}

/// A host may set the pose before each frame, whether or not anything moves.
#[test]
fn a_pose_that_is_set_again_and_again_leaves_the_picture_still() {
    let room = foveal_generate::cornell();
    let camera = room.cameras[0].clone();
    for (shading, source) in [
        (Shading::Coarse, RateSource::Foveated),
        (Shading::Variable, RateSource::Content),
    ] {
        let settings = settings().with(|s| {
            s.shading.mode = shading;
            s.coarse.history = true;
            s.coarse.source = source;
        });
        let mut film = Film::new(&room, &settings);
        let shown = at_rest(&mut film, &camera, &settings);
        for frame in 0..ROUND {
            block_on(film.renderer.update_pose(&room)).expect("it fits");
            film.draw(&camera);
            assert!(picture(&film.renderer) == shown, "{shading:?}, {frame}");
        }
    }
}

/// One kind of change at a time: nothing else tells the stages that something has changed.
#[test]
fn each_change_alone_is_seen_and_shadows_follow() {
    let kept = settings().with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.history = true;
        s.culling.mode = Culling::Occlusion;
    });
    for pointer in [
        "/nodes/4/extensions/KHR_node_visibility/visible",
        "/nodes/5/extensions/KHR_node_visibility/visible",
        "/materials/2/alphaCutoff",
        "/materials/2/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset",
        "/materials/0/pbrMetallicRoughness/roughnessFactor",
        "/materials/0/pbrMetallicRoughness/baseColorFactor",
        "/materials/0/emissiveFactor",
        "/materials/4/extensions/KHR_materials_transmission/transmissionFactor",
        "/extensions/KHR_lights_punctual/lights/0/intensity",
        "/cameras/0/perspective/yfov",
    ] {
        let moved: Vec<Moved> = MOVES
            .iter()
            .copied()
            .filter(|m| m.pointer == pointer)
            .collect();
        assert_eq!(moved.len(), 1, "{pointer}");
        assert_alone(&moved, &kept);
    }
}

/// As [`assert_pictures`] at the end of the clip and back at its beginning.
fn assert_alone(moves: &[Moved], settings: &Settings) {
    let mut scene = moving(moves);
    let mut film = Film::new(&scene, settings);
    let mut pictures = Vec::new();
    for time_s in [0.5, 1.0, 0.5] {
        scene.pose(time_s);
        block_on(film.renderer.update_pose(&scene)).expect("it fits");
        pictures.push(at_rest(&mut film, &scene.cameras[0].clone(), settings));
    }
    let pointer = moves[0].pointer;
    assert!(pictures[0] == pictures[2], "{pointer}: there and back");
    assert!(pictures[0] != pictures[1], "{pointer} changes nothing");
    let expected = fresh(&still(moves, 1.0), settings);
    let texels = pictures[1]
        .as_chunks::<4>()
        .0
        .iter()
        .zip(expected.as_chunks::<4>().0);
    let differing = texels.filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "{pointer}");
}

/// Objects that a pose hides are drawn in no mode of culling, and culled in none.
#[test]
fn hidden_objects_are_not_counted() {
    let hides = MOVES
        .iter()
        .copied()
        .filter(|m| m.pointer.starts_with("/nodes/4/extensions"));
    let mut scene = moving(&hides.collect::<Vec<_>>());
    for mode in [
        Culling::Off,
        Culling::Frustum,
        Culling::Occlusion,
        Culling::Auto,
    ] {
        let settings = settings().with(|s| s.culling.mode = mode);
        let drawn = [0.0, 1.0].map(|time_s| {
            scene.pose(time_s);
            let stats = Film::new(&scene, &settings).draw(&scene.cameras[0]);
            let culled = stats.objects_outside + stats.objects_occluded + stats.objects_small;
            (stats.objects_visible, stats.objects_visible + culled)
        });
        assert_eq!(drawn[0].0, drawn[1].0 + 1, "{mode:?}");
        assert_eq!(drawn[0].1, drawn[1].1 + 1, "{mode:?}");

        // All of them, those in view and the others.
        let mut camera = scene.cameras[0].clone();
        camera.world_from_view *= glam::Mat4::from_rotation_y(0.7);
        let counts = [true, false].map(|is_shown| {
            scene.objects.iter_mut().for_each(|o| o.visible = is_shown);
            let stats = Film::new(&scene, &settings).draw(&camera);
            let culled = stats.objects_outside + stats.objects_occluded + stats.objects_small;
            [stats.objects_visible, culled]
        });
        assert!(counts[0][1] > 0 || mode == Culling::Off, "{mode:?}");
        assert_eq!(counts[1], [0, 0], "{mode:?}");
        scene.objects.iter_mut().for_each(|o| o.visible = true);
    }
}

/// A move of where the normal map is read, from the file's own coordinates.
fn of_normal_map(pointer: &'static str, from: &'static [f32], to: &'static [f32]) -> Moved {
    let kind = if from.len() == 1 { "SCALAR" } else { "VEC2" };
    Moved {
        pointer,
        kind,
        from,
        to,
    }
}

#[test]
fn generated_tangents_turn_with_the_normal_map() {
    let turn = |to| {
        let pointer = "/materials/0/normalTexture/extensions/KHR_texture_transform/rotation";
        of_normal_map(pointer, &[0.0], to)
    };
    let stretch = |to| {
        let pointer = "/materials/0/normalTexture/extensions/KHR_texture_transform/scale";
        of_normal_map(pointer, &[1.0, 1.0], to)
    };
    let turned = assert_tangents(&[turn(&[1.5])]);
    assert!((turned.tangent_turn_rad - 1.5).abs() < 1e-6 && !turned.tangents_mirrored);
    assert!(assert_tangents(&[stretch(&[-1.0, 1.0])]).tangents_mirrored);
    assert_tangents(&[turn(&[0.7]), stretch(&[1.0, 4.0])]);
}

/// A pose of generated tangents looks as a file with its values does; gives the posed material.
fn assert_tangents(moves: &[Moved]) -> Material {
    let bare = |mut file: File| {
        for mesh in file.json["meshes"].as_array_mut().expect("meshes") {
            let attributes = &mut mesh["primitives"][0]["attributes"];
            attributes
                .as_object_mut()
                .expect("attributes")
                .remove("TANGENT");
        }
        load(&file)
    };
    let (mut moving, mut still) = (movable(), movable());
    hold(&mut moving, moves, 0.0);
    animate(&mut moving, moves);
    hold(&mut still, moves, 1.0);
    let (mut moving, still) = (bare(moving), bare(still));
    moving.pose(1.0);
    let expected = fresh(&still, &settings());
    let off = |scene: &Scene| -> f64 {
        let found = fresh(scene, &settings());
        let pairs = found.iter().zip(&expected);
        pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum()
    };
    let turned = off(&moving);
    let posed = moving.materials[0].clone();
    moving.materials[0].tangent_turn_rad = 0.0;
    moving.materials[0].tangents_mirrored = false;
    let unturned = off(&moving);
    println!("turned {turned}, unturned {unturned}");
    // Where u and v do not meet at right angles on the surface, turned tangents are not quite new ones.
    let is_near = turned < 0.15 * unturned;
    assert!(unturned > 500.0 && is_near, "{turned} {unturned}");
    posed
}

/// A scene of which one thing moves by a pose, and the camera that sees it.
fn slid(scene: &Scene, by: f32) -> Scene {
    let mut scene = scene.clone();
    let instance = scene.instances.last_mut().expect("an instance");
    instance.world_from_object =
        glam::Mat4::from_translation(glam::Vec3::new(by, 0.0, 0.0)) * instance.world_from_object;
    let moved = instance
        .bounds
        .transformed(glam::Mat4::from_translation(glam::Vec3::X * by));
    instance.bounds = moved;
    let object = instance.object as usize;
    scene.objects[object].bounds = scene.objects[object].bounds.union(moved);
    scene
}

/// Motion ends with the pose: the next frame without one shows what stands still.
#[test]
fn a_frame_without_a_new_pose_shows_no_motion() {
    let room = foveal_generate::cornell();
    let camera = room.cameras[0].clone();
    for path in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = small(96, 64).with(|s| {
            s.geometry.path = path;
            s.shading.mode = Shading::Variable;
        });
        let mut film = Film::new(&room, &settings);
        film.draw(&camera);
        assert_eq!(in_motion(&film), 0);
        let posed = slid(&room, 0.2);
        block_on(film.renderer.update_pose(&posed)).expect("it fits");
        film.draw(&camera);
        assert!(in_motion(&film) > 20, "{path:?}: {}", in_motion(&film));
        for _ in 0..ROUND {
            film.draw(&camera);
            assert_eq!(in_motion(&film), 0, "{path:?}");
        }
        assert!(picture(&film.renderer) == fresh(&posed, &settings));
    }
}

/// Pixels that something in motion shows.
fn in_motion(film: &Film) -> usize {
    let identity: Vec<[u32; 2]> = texels(&film.renderer.targets().gbuffer.identity_view);
    let moves = |[_, motion]: &&[u32; 2]| *motion & 0x7fff_7fff != 0;
    identity.iter().filter(moves).count()
}

/// A mesh that deforms rests too.
#[test]
fn a_frame_without_a_new_shape_shows_no_motion() {
    let mut scene = foveal_generate::cornell();
    let mesh = scene.instances.last().expect("an instance").mesh as usize;
    scene.meshes[mesh].deforms = true;
    let camera = scene.cameras[0].clone();
    for path in [Geometry::Gbuffer, Geometry::Visibility] {
        let settings = small(96, 64).with(|s| {
            s.geometry.path = path;
            s.picture.view = DebugView::Motion;
        });
        let mut film = Film::new(&scene, &settings);
        let mut bent = scene.clone();
        for vertex in &mut bent.meshes[mesh].vertices {
            vertex.position[0] += 0.1;
        }
        block_on(film.renderer.update_pose(&bent)).expect("it fits");
        film.draw(&camera);
        assert!(in_motion(&film) > 20, "{path:?}: {}", in_motion(&film));
        film.draw(&camera);
        assert_eq!(in_motion(&film), 0, "{path:?}");
    }
}

/// Alpha modes and sides are those of the scene as it was set, whatever a pose's materials say.
#[test]
fn a_pose_changes_no_alpha_modes_and_no_sides() {
    let room = foveal_generate::cornell();
    let camera = room.cameras[0].clone();
    let settings = settings().with(|s| {
        s.culling.mode = Culling::Occlusion;
        s.shading.mode = Shading::Coarse;
        s.coarse.history = true;
    });
    let mut film = Film::new(&room, &settings);
    let before = at_rest(&mut film, &camera, &settings);
    let mut posed = room.clone();
    for material in &mut posed.materials {
        material.alpha_mode = foveal_scene::AlphaMode::Blend;
        material.double_sided = !material.double_sided;
    }
    block_on(film.renderer.update_pose(&posed)).expect("it fits");
    assert!(at_rest(&mut film, &camera, &settings) == before);
}

/// Nothing of them is taken over.
#[test]
fn poses_of_other_scenes_are_refused() {
    let room = foveal_generate::cornell();
    let camera = room.cameras[0].clone();
    let settings = settings().with(|s| s.culling.mode = Culling::Occlusion);
    let mut film = Film::new(&room, &settings);
    let before = at_rest(&mut film, &camera, &settings);
    type Change = fn(&mut Scene);
    let changes: [(Change, &str); 8] = [
        (|s| s.instances.truncate(s.instances.len() - 1), "instances"),
        (|s| s.instances.extend_from_within(..1), "instances"),
        (|s| drop(s.objects.pop()), "objects"),
        (|s| s.materials.extend_from_within(..1), "materials"),
        (|s| s.instances[1].material ^= 1, "instance 1"),
        (
            |s| {
                s.meshes[0].deforms = true;
                let again = s.meshes[0].vertices[0];
                s.meshes[0].vertices.push(again);
            },
            "mesh 0 has another number of vertices",
        ),
        (
            |s| s.meshes[1].indices.truncate(3),
            "mesh 1 has another number of vertices or indices",
        ),
        // It may be an occluder.
        (|s| s.meshes[1].deforms = true, "mesh 1 deforms"),
    ];
    for (change, named) in changes {
        let mut other = room.clone();
        other.lights.clear();
        change(&mut other);
        let error = block_on(film.renderer.update_pose(&other)).unwrap_err();
        assert!(matches!(error, crate::Error::OtherScene { .. }), "{error}");
        assert!(error.to_string().contains(named), "{error}");
        assert!(at_rest(&mut film, &camera, &settings) == before, "{named}");
    }
}

#[test]
fn a_pose_does_not_wait_for_the_device() {
    let mut scene = foveal_generate::cornell();
    let mesh = &mut scene.meshes[0];
    mesh.deforms = true;
    let more = mesh.vertices[0];
    mesh.vertices.resize(140_000, more);
    let gpu = gpu_with(gpu().device.features(), gpu().device.limits());
    let mut renderer = rendered_on(&gpu, &scene, &scene.cameras[0], &settings());
    gpu.device.faults.disarm();
    block_on(renderer.update_pose(&scene)).expect("it fits");
    assert_eq!(gpu.device.faults.waits(), 0);
}
