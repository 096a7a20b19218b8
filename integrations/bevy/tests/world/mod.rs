//! A world with a camera, a wall and balls, as far as visibility goes: no renderer, no window.
#![allow(dead_code, reason = "each test program uses a part of it")]
#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]
#![allow(unreachable_pub, reason = "a module of a program")]

use bevy::asset::AssetPlugin;
use bevy::camera::visibility::VisibleEntities;
use bevy::camera::{CameraPlugin, RenderTargetInfo};
use bevy::ecs::component::Mutable;
use bevy::gizmos::GizmoPlugin;
use bevy::light::LightPlugin;
use bevy::light::cluster::{GlobalClusterGpuSettings, GlobalClusterSettings};
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_foveal_cull::{CpuOcclusionCulling, CpuOcclusionPlugin, CpuOcclusionStats, Occluder};

/// Pixels of the picture that nobody draws.
pub const SIZE: UVec2 = UVec2::new(638, 361);

/// Three in which it is drawn but not relied on, and one in which it is.
pub const FRAMES: usize = 4;

pub struct TestWorld {
    pub app: App,
    /// At the origin, looking along -z.
    pub camera: Entity,
    ball: Handle<Mesh>,
}

impl TestWorld {
    pub fn new() -> Self {
        Self::with(|_| ())
    }

    /// With plugins of the test.
    pub fn with(add: impl FnOnce(&mut App)) -> Self {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            TransformPlugin,
            AssetPlugin::default(),
            MeshPlugin,
            CameraPlugin,
            GizmoPlugin,
            LightPlugin,
            CpuOcclusionPlugin,
        ))
        .init_asset::<Image>()
        .init_asset::<StandardMaterial>()
        .insert_resource(clusters());
        add(&mut app);
        app.finish();
        app.cleanup();
        let ball = app
            .world_mut()
            .resource_mut::<Assets<Mesh>>()
            .add(Sphere::new(0.5));
        let mut world = Self {
            app,
            camera: Entity::PLACEHOLDER,
            ball,
        };
        world.camera = world.add_camera(Transform::default());
        world
    }

    pub fn add_camera(&mut self, transform: Transform) -> Entity {
        let camera = self
            .app
            .world_mut()
            .spawn((
                Camera3d::default(),
                transform,
                CpuOcclusionCulling::default(),
            ))
            .id();
        self.aim(
            camera,
            Projection::Perspective(PerspectiveProjection::default()),
        );
        camera
    }

    /// Gives the first camera another projection.
    pub fn look_through(&mut self, projection: Projection) {
        self.aim(self.camera, projection);
    }

    /// What Bevy's renderer does with a new projection.
    fn aim(&mut self, camera: Entity, mut projection: Projection) {
        projection.update(SIZE.x as f32, SIZE.y as f32);
        let mut entity = self.app.world_mut().entity_mut(camera);
        let mut of_camera = entity.get_mut::<Camera>().unwrap();
        of_camera.computed.clip_from_view = projection.get_clip_from_view();
        of_camera.computed.target_info = Some(RenderTargetInfo {
            physical_size: SIZE,
            scale_factor: 1.0,
        });
        entity.insert(projection);
    }

    /// A wall of 8 m x 8 m, 5 m before the camera.
    pub fn wall(&mut self, occluder: Occluder) -> Entity {
        let mesh = Mesh3d(self.add_mesh(Cuboid::new(8.0, 8.0, 0.2)));
        let material = MeshMaterial3d(self.add_material(StandardMaterial::default()));
        let place = Transform::from_xyz(0.0, 0.0, -5.0);
        self.app
            .world_mut()
            .spawn((mesh, material, place, occluder))
            .id()
    }

    pub fn ball(&mut self, z: f32) -> Entity {
        self.spawn_ball(Vec3::new(0.0, 0.0, z), ())
    }

    pub fn spawn_ball(&mut self, at: Vec3, with: impl Bundle) -> Entity {
        let mesh = Mesh3d(self.ball.clone());
        self.app
            .world_mut()
            .spawn((mesh, Transform::from_translation(at), with))
            .id()
    }

    pub fn add_mesh(&mut self, mesh: impl Into<Mesh>) -> Handle<Mesh> {
        self.app
            .world_mut()
            .resource_mut::<Assets<Mesh>>()
            .add(mesh.into())
    }

    pub fn add_material(&mut self, material: StandardMaterial) -> Handle<StandardMaterial> {
        self.app
            .world_mut()
            .resource_mut::<Assets<StandardMaterial>>()
            .add(material)
    }

    pub fn get_mut<C: Component<Mutability = Mutable>>(&mut self, entity: Entity) -> Mut<'_, C> {
        self.app.world_mut().get_mut::<C>(entity).unwrap()
    }

    /// As many frames as it takes until what is new is relied on.
    pub fn update(&mut self) {
        for _ in 0..FRAMES {
            self.app.update();
        }
    }

    pub fn stats(&self) -> CpuOcclusionStats {
        *self.app.world().resource()
    }

    /// Gives an entity a material.
    pub fn paint(&mut self, entity: Entity, material: StandardMaterial) {
        let material = MeshMaterial3d(self.add_material(material));
        self.app.world_mut().entity_mut(entity).insert(material);
    }

    /// The first camera's meshes.
    pub fn visible(&self) -> Vec<Entity> {
        let list = self
            .app
            .world()
            .get::<VisibleEntities>(self.camera)
            .unwrap();
        list.get(core::any::TypeId::of::<Mesh3d>()).to_vec()
    }

    pub fn sees(&self, entity: Entity) -> bool {
        self.visible().contains(&entity)
    }
}

/// As Bevy's renderer has them where the device fills clusters.
fn clusters() -> GlobalClusterSettings {
    GlobalClusterSettings {
        supports_storage_buffers: true,
        clustered_decals_are_usable: false,
        gpu_clustering: Some(GlobalClusterGpuSettings {
            initial_z_slice_list_capacity: 1024,
            initial_index_list_capacity: 1024,
        }),
        max_uniform_buffer_clusterable_objects: 204,
        view_cluster_bindings_max_indices: 16384,
    }
}

/// The order of Bevy's lists.
pub fn sorted<const N: usize>(mut entities: [Entity; N]) -> Vec<Entity> {
    entities.sort_unstable();
    entities.to_vec()
}
