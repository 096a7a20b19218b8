//! The scene: everything that a frame is made from.

use glam::{Mat4, Vec3};

use crate::{Aabb, Camera, Environment, Light, LoadTimings, Material, Mesh, Rig, Texture};

/// One thing as the file's author sees it: a node with a mesh, or one element of its GPU instancing.
/// It is what culling answers for; it has one [`Instance`] per primitive of its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The node's name.
    pub name: String,
    /// The glTF node's index; for generated scenes the object's own index.
    pub node: u32,
    /// The element's number within EXT_mesh_gpu_instancing, 0 without.
    pub element: u32,
    /// The node's `extras.occluder`, where the file says it: whether it is meant to occlude.
    pub occluder: Option<bool>,
    /// The node's `extras.set`, where the file says it: the part of the scene that it belongs to.
    pub set: Option<String>,
    /// Smallest box around all its instances' vertices in world space.
    pub bounds: Aabb,
    /// Its instances: a range of [`Scene::instances`].
    pub instances: std::ops::Range<u32>,
}

/// A mesh with a material at a place: the unit of drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// Index into [`Scene::objects`].
    pub object: u32,
    /// World space from the mesh's object space; affine, finite, invertible or not, of either handedness.
    pub world_from_object: Mat4,
    /// Smallest box around the transformed vertices (not around the transformed box).
    pub bounds: Aabb,
}

/// Something in a file that was understood but not honoured, in one sentence that names the place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning(
    /// The sentence.
    pub String,
);

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// Everything that a frame is made from.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// File name or the generator's name.
    pub name: String,
    /// Geometry.
    pub meshes: Vec<Mesh>,
    /// Surfaces.
    pub materials: Vec<Material>,
    /// Pictures.
    pub textures: Vec<Texture>,
    /// Things.
    pub objects: Vec<Object>,
    /// What is drawn.
    pub instances: Vec<Instance>,
    /// Punctual lights.
    pub lights: Vec<Light>,
    /// Cameras of the file or the generator, in order.
    pub cameras: Vec<Camera>,
    /// Backdrop and ambient light.
    pub environment: Environment,
    /// What the importer could not honour.
    pub warnings: Vec<Warning>,
    /// How it moves; opaque, still by default. See [`Scene::pose`].
    pub rig: Rig,
    /// How long loading took; zero for generated scenes.
    pub timings: LoadTimings,
}

impl Scene {
    /// The box around all objects; [`Aabb::EMPTY`] for a scene without geometry.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.objects
            .iter()
            .fold(Aabb::EMPTY, |b, o| b.union(o.bounds))
    }

    /// Number of triangles drawn: each mesh's, once per instance.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.instances
            .iter()
            .map(|i| self.meshes[i.mesh as usize].triangle_count() as u64)
            .sum()
    }

    /// A camera that sees the whole scene: from the front, a little above, 60° high.
    #[must_use]
    pub fn overview_camera(&self) -> Camera {
        let bounds = self.bounds();
        let (center, radius) = if bounds.is_empty() {
            (Vec3::ZERO, 1.0)
        } else {
            (bounds.center(), (0.5 * bounds.size().length()).max(1e-3))
        };
        let fov_y_rad = 60f32.to_radians();
        let distance = 0.85 * radius / (0.5 * fov_y_rad).sin();
        let eye = center + Vec3::new(0.25, 0.3, 1.0).normalize() * distance;
        let mut camera = Camera::look_at(eye, center, Vec3::Y, fov_y_rad);
        camera.name = "overview".to_owned();
        if let crate::Projection::Perspective { near_m, .. } = &mut camera.projection {
            *near_m = distance * 0.005;
        }
        camera
    }
}
