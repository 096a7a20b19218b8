//! A scene in the making: objects from meshes and materials, bounds at the end.

use glam::{Mat4, Vec3};
use rayon::prelude::*;

use foveal_scene::{Aabb, Camera, Instance, Light, Material, Mesh, Object, Scene, Texture};

/// Collects a [`Scene`].
#[derive(Debug, Default)]
pub(crate) struct SceneBuilder {
    scene: Scene,
}

impl SceneBuilder {
    /// An empty scene.
    pub(crate) fn new(name: &str) -> Self {
        Self {
            scene: Scene {
                name: name.to_owned(),
                ..Scene::default()
            },
        }
    }

    /// Adds a mesh and returns its index.
    pub(crate) fn mesh(&mut self, mesh: Mesh) -> u32 {
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() as u32 - 1
    }

    /// Adds a material and returns its index.
    pub(crate) fn material(&mut self, material: Material) -> u32 {
        self.scene.materials.push(material);
        self.scene.materials.len() as u32 - 1
    }

    /// Adds a texture and returns its index.
    pub(crate) fn texture(&mut self, texture: Texture) -> u32 {
        self.scene.textures.push(texture);
        self.scene.textures.len() as u32 - 1
    }

    /// Adds a light.
    pub(crate) fn light(&mut self, light: Light) {
        self.scene.lights.push(light);
    }

    /// Adds a camera.
    pub(crate) fn camera(&mut self, camera: Camera) {
        self.scene.cameras.push(camera);
    }

    /// Adds an object of (mesh, material) parts that share one transform.
    pub(crate) fn object(
        &mut self,
        name: String,
        set: Option<&str>,
        occluder: Option<bool>,
        parts: &[(u32, u32)],
        world_from_object: Mat4,
    ) {
        let scene = &mut self.scene;
        let object = scene.objects.len() as u32;
        let first = scene.instances.len() as u32;
        scene
            .instances
            .extend(parts.iter().map(|&(mesh, material)| Instance {
                mesh,
                material,
                object,
                world_from_object,
                bounds: Aabb::EMPTY,
            }));
        scene.objects.push(Object {
            name,
            node: object,
            element: 0,
            visible: true,
            occluder,
            set: set.map(str::to_owned),
            bounds: Aabb::EMPTY,
            instances: first..scene.instances.len() as u32,
        });
    }

    /// The finished scene, with exact bounds for all instances and objects.
    pub(crate) fn finish(self) -> Scene {
        let mut scene = self.scene;
        let positions: Vec<_> = scene.meshes.par_iter().map(distinct_positions).collect();
        scene.instances.par_iter_mut().for_each(|instance| {
            let to_world = instance.world_from_object;
            instance.bounds = Aabb::of_points(
                positions[instance.mesh as usize]
                    .iter()
                    .map(|&p| to_world.transform_point3(p)),
            );
        });
        for object in &mut scene.objects {
            let range = object.instances.start as usize..object.instances.end as usize;
            object.bounds = scene.instances[range]
                .iter()
                .fold(Aabb::EMPTY, |b, i| b.union(i.bounds));
        }
        scene
    }
}

/// The mesh's positions without repetition: shared corners need to be transformed only once.
fn distinct_positions(mesh: &Mesh) -> Vec<Vec3> {
    let mut bits: Vec<[u32; 3]> = mesh
        .indices
        .iter()
        .map(|&i| mesh.vertices[i as usize].position.map(f32::to_bits))
        .collect();
    bits.sort_unstable();
    bits.dedup();
    bits.into_iter()
        .map(|p| Vec3::from(p.map(f32::from_bits)))
        .collect()
}

/// The camera with a name.
pub(crate) fn named(mut camera: Camera, name: &str) -> Camera {
    name.clone_into(&mut camera.name);
    camera
}
