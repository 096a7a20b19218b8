//! A level from a glTF file, and the longest walk through it at eye height.

use super::paths::longest_walk;
use super::place::Place;
use bevy::asset::{AssetPath, LoadState};
use bevy::ecs::entity::EntityHashMap;
use bevy::gltf::{GltfAssetLabel, GltfLoaderSettings};
use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use bevy_foveal_cull::AutomaticOccluders;
use std::path::{Path, PathBuf};
use std::process::exit;

/// A level and the way through it.
#[derive(Clone, Debug)]
pub struct Level {
    file: PathBuf,
    /// Point lights with shadows along the way; without them a light without shadows stands in the
    /// sky.
    lights: usize,
    /// Eye positions, empty until the level is loaded.
    walk: Vec<Vec3>,
    handle: Handle<WorldAsset>,
    /// Frames since it was loaded.
    frames: usize,
}

impl Level {
    /// A level from a file that exists.
    pub fn open(file: &Path, lights: usize) -> Self {
        match file.canonicalize() {
            Ok(file) if file.is_file() => Self {
                file,
                lights,
                walk: Vec::new(),
                handle: Handle::default(),
                frames: 0,
            },
            Ok(_) => fail(&format!("{} is not a file", file.display())),
            Err(error) => fail(&format!("{}: {error}", file.display())),
        }
    }

    /// The way, metres from its begin.
    fn at(&self, metres: f32) -> Vec3 {
        let mut rest = metres.max(0.0);
        for pair in self.walk.windows(2) {
            let length = pair[0].distance(pair[1]);
            if rest <= length {
                return pair[0].lerp(pair[1], rest / length.max(1e-6));
            }
            rest -= length;
        }
        self.walk.last().copied().unwrap_or_default()
    }

    /// What `WorldAssetRoot` does with Bevy's feature `reflect_auto_register`.
    fn spawn_scene(&self, world: &mut World) {
        let mut scenes = world.resource_mut::<Assets<WorldAsset>>();
        let Some(mut scene) = scenes.remove(&self.handle) else {
            return;
        };
        let mut entities = scene.world.query::<(
            Entity,
            &Transform,
            Option<&Mesh3d>,
            Option<&MeshMaterial3d<StandardMaterial>>,
            Option<&ChildOf>,
        )>();
        let mut spawned = EntityHashMap::default();
        let mut parents = Vec::new();
        for (entity, transform, mesh, material, parent) in entities.iter(&scene.world) {
            let mut copy = world.spawn((*transform, Visibility::default()));
            if let Some((mesh, material)) = mesh.zip(material) {
                copy.insert((mesh.clone(), material.clone()));
            }
            spawned.insert(entity, copy.id());
            parents.extend(parent.map(|parent| (entity, parent.parent())));
        }
        for (child, parent) in parents {
            world
                .entity_mut(spawned[&child])
                .insert(ChildOf(spawned[&parent]));
        }
    }

    fn find_walk(&mut self, world: &mut World) {
        let mut triangles = Vec::new();
        let mut entities = world.query::<(&Mesh3d, &GlobalTransform)>();
        let meshes = world.resource::<Assets<Mesh>>();
        for (mesh, transform) in entities.iter(world) {
            let Some(mesh) = meshes.get(&mesh.0) else {
                continue;
            };
            let Some(VertexAttributeValues::Float32x3(positions)) =
                mesh.attribute(Mesh::ATTRIBUTE_POSITION)
            else {
                continue;
            };
            let place = |i: usize| transform.transform_point(positions[i].into());
            let indices: Vec<usize> = match mesh.indices() {
                Some(Indices::U16(list)) => list.iter().map(|&i| usize::from(i)).collect(),
                Some(Indices::U32(list)) => list.iter().map(|&i| i as usize).collect(),
                None => (0..positions.len()).collect(),
            };
            let corners = indices.as_chunks::<3>().0;
            triangles.extend(corners.iter().map(|corners| corners.map(place)));
        }
        self.walk = longest_walk(&triangles);
        if self.walk.is_empty() {
            fail(&format!("{}: no floor to walk on", self.file.display()));
        }
    }

    fn light(&self, world: &mut World) {
        for i in 0..self.lights {
            let part = (i as f32 + 0.5) / self.lights as f32;
            world.spawn((
                PointLight {
                    shadow_maps_enabled: true,
                    intensity: 300_000.0,
                    range: 15.0,
                    ..default()
                },
                Transform::from_translation(self.at(part * self.length()) + Vec3::Y * 0.3),
            ));
        }
    }
}

impl Place for Level {
    fn spawn(&mut self, world: &mut World) {
        let scene =
            GltfAssetLabel::Scene(0).from_asset(AssetPath::from_path_buf(self.file.clone()));
        let settings = |settings: &mut GltfLoaderSettings| {
            settings.load_cameras = false;
            settings.load_lights = false;
        };
        let server = world.resource::<AssetServer>();
        self.handle = server.load_builder().with_settings(settings).load(scene);
        world.insert_resource(AutomaticOccluders::default());
        world.insert_resource(GlobalAmbientLight {
            brightness: 400.0,
            ..default()
        });
        if self.lights == 0 {
            world.spawn((
                DirectionalLight {
                    illuminance: 3000.0,
                    ..default()
                },
                Transform::from_xyz(3.0, 8.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y),
            ));
        }
    }

    fn is_ready(&mut self, world: &mut World) -> bool {
        let server = world.resource::<AssetServer>();
        if let LoadState::Failed(error) = server.load_state(&self.handle) {
            fail(&format!("{}: {error}", self.file.display()));
        }
        if !server.is_loaded_with_dependencies(&self.handle) {
            return false;
        }
        if self.frames == 0 {
            self.spawn_scene(world);
        }
        self.frames += 1;
        // Until entities are placed, and found to stand still.
        if self.frames < 20 {
            return false;
        }
        if self.walk.is_empty() {
            self.find_walk(world);
        }
        self.light(world);
        true
    }

    fn walker(&self, metres: f32) -> Transform {
        let eye = self.at(metres);
        // Level with the eye, but for stairs.
        let mut ahead = self.at(metres + 3.0) - eye;
        ahead.y *= 0.5;
        if ahead.length() < 0.5 {
            ahead = eye - self.at(metres - 3.0);
        }
        let sway = Quat::from_rotation_y(0.5 * (metres * 0.4).sin());
        Transform::from_translation(eye).looking_to(sway * ahead, Vec3::Y)
    }

    fn length(&self) -> f32 {
        self.walk.windows(2).map(|w| w[0].distance(w[1])).sum()
    }
}

#[expect(clippy::print_stderr, reason = "a program says what is wrong")]
fn fail(message: &str) -> ! {
    eprintln!("{message}");
    exit(1)
}
