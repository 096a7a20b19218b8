//! The scene: everything that a frame is made from.

use std::fmt;

use glam::{Mat4, Vec3};

use crate::{
    Aabb, AlphaMode, Camera, Code, Environment, ImageLight, Light, LightKind, LoadTimings,
    Material, Mesh, Rig, Texture,
};

/// One thing as the file's author sees it: a node with a mesh, or one element of its GPU
/// instancing. It is what culling answers for; it has one [`Instance`] per primitive of its mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The node's name.
    pub name: String,
    /// The glTF node's index; for generated scenes the object's own index.
    pub node: u32,
    /// The element's number within EXT_mesh_gpu_instancing, 0 without.
    pub element: u32,
    /// Whether it is drawn. In a scene whose clips change visibility each pose sets it for all objects;
    /// in others it is a program's own.
    pub visible: bool,
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
    /// World space from the mesh's object space; affine, finite, invertible or not, of either
    /// handedness.
    pub world_from_object: Mat4,
    /// Smallest box around the transformed vertices (not around the transformed box).
    pub bounds: Aabb,
}

/// Something in a file that was understood but not honoured.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Warning {
    /// What it is about, for programs.
    pub code: Code,
    /// One sentence that names the place.
    pub text: String,
}

impl Warning {
    /// A warning of this text.
    pub fn new(code: Code, text: impl Into<String>) -> Self {
        Self {
            code,
            text: text.into(),
        }
    }

    /// The same, of the thing at `place`.
    pub(crate) fn at(mut self, place: impl fmt::Display) -> Self {
        self.text = format!("{place}: {}", self.text);
        self
    }

    /// The same, its place within `outer`.
    pub(crate) fn within(mut self, outer: impl fmt::Display) -> Self {
        self.text = format!("{outer}.{}", self.text);
        self
    }

    /// The same, and what follows from it.
    pub(crate) fn and(mut self, consequence: &str) -> Self {
        self.text = format!("{}; {consequence}", self.text);
        self
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Everything that a frame is made from.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// File name or the generator's name.
    pub name: String,
    /// Meshes, indexed by [`Instance::mesh`].
    pub meshes: Vec<Mesh>,
    /// Materials, indexed by [`Instance::material`].
    pub materials: Vec<Material>,
    /// Textures, indexed by [`TextureRef::texture`](crate::TextureRef::texture).
    pub textures: Vec<Texture>,
    /// Objects, indexed by [`Instance::object`].
    pub objects: Vec<Object>,
    /// Instances: what is drawn. Those of an object follow each other
    /// ([`Object::instances`]).
    pub instances: Vec<Instance>,
    /// Punctual lights, world space.
    pub lights: Vec<Light>,
    /// Cameras of the file or the generator, in order.
    pub cameras: Vec<Camera>,
    /// Backdrop and ambient light.
    pub environment: Environment,
    /// The file's own environment of pictures, where it has one: more exact than `environment`.
    pub image_light: Option<ImageLight>,
    /// Names of the file's variants of materials;
    /// [`LoadOptions::variant`](crate::LoadOptions::variant) chooses one.
    pub variants: Vec<String>,
    /// Names of the scenes that the file holds, empty where one has none;
    /// [`LoadOptions::file_scene`](crate::LoadOptions::file_scene) chooses one.
    pub file_scenes: Vec<String>,
    /// Warnings of the importer: parts of the file that it could not honour.
    pub warnings: Vec<Warning>,
    /// Animations, with their nodes, skins and morph targets, that [`Scene::pose`] plays; none by
    /// default.
    pub rig: Rig,
    /// How long loading took; zero for generated scenes.
    pub timings: LoadTimings,
}

impl Scene {
    /// The box around all objects, visible or not; [`Aabb::EMPTY`] for a scene without geometry.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.objects
            .iter()
            .fold(Aabb::EMPTY, |b, o| b.union(o.bounds))
    }

    /// Whether an instance is drawn: its object is visible.
    #[must_use]
    pub fn is_visible(&self, instance: &Instance) -> bool {
        let object = self.objects.get(instance.object as usize);
        object.is_none_or(|object| object.visible)
    }

    /// Whether an instance's surface, where it is visible, can hide things for certain: made of triangles, opaque (masks
    /// have holes, blended and transmissive surfaces show what is behind them) and rigid (an occluder
    /// that deforms would have to be prepared in every pose). False where its mesh or material is
    /// missing.
    #[must_use]
    pub fn can_occlude(&self, instance: &Instance) -> bool {
        let material = self.materials.get(instance.material as usize);
        let mesh = self.meshes.get(instance.mesh as usize);
        material.is_some_and(|m| m.alpha_mode == AlphaMode::Opaque && m.transmission.is_none())
            && mesh.is_some_and(|mesh| mesh.triangle_count() > 0 && !mesh.deforms)
    }

    /// Whether the scene says of any object that it is meant to occlude.
    #[must_use]
    pub fn marks_occluders(&self) -> bool {
        self.objects.iter().any(|o| o.occluder == Some(true))
    }

    /// Number of triangles drawn: each mesh's, once per instance.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.count_drawn(Mesh::triangle_count)
    }

    /// Number of lines drawn: each mesh's, once per instance.
    #[must_use]
    pub fn line_count(&self) -> u64 {
        self.count_drawn(|mesh| mesh.lines.len())
    }

    /// Number of points drawn: each mesh's, once per instance.
    #[must_use]
    pub fn point_count(&self) -> u64 {
        self.count_drawn(|mesh| mesh.points.len())
    }

    /// The sum over all instances; one whose mesh is missing draws nothing.
    fn count_drawn(&self, count: impl Fn(&Mesh) -> usize) -> u64 {
        let meshes = self.instances.iter().map(|i| i.mesh as usize);
        let meshes = meshes.filter_map(|mesh| self.meshes.get(mesh));
        meshes.map(|mesh| count(mesh) as u64).sum()
    }

    /// Adds a sun where the scene has neither a punctual light nor an environment of its own, so that
    /// it is not seen in the dark; true if it did. It stands high, to the left of and behind a viewer who looks down -z.
    pub fn light_by_default(&mut self) -> bool {
        let needed = self.lights.is_empty() && self.image_light.is_none();
        if needed {
            self.lights.push(Light {
                kind: LightKind::Directional,
                color: Vec3::new(1.0, 0.96, 0.9),
                intensity: 3.0,
                position: Vec3::ZERO,
                direction: Vec3::new(0.45, -0.8, -0.5).normalize(),
                range_m: None,
                node: None,
            });
        }
        needed
    }

    /// A camera that sees the whole scene in a picture at least 6:5 wide: from the front, a little
    /// above and to the right, 45° high. Of a scene that is next to nothing in this pose it sees what
    /// there is at rest.
    #[must_use]
    pub fn overview_camera(&self) -> Camera {
        const TAN_HALF_FOV: f32 = 0.414_213_57;
        const WIDTH_TO_HEIGHT: f32 = 1.2;
        const MARGIN: f32 = 1.08;
        let bounds = match self.overview_bounds() {
            empty if empty.is_empty() => Aabb {
                min: -Vec3::ONE,
                max: Vec3::ONE,
            },
            bounds => bounds,
        };
        let center = bounds.center();
        let backward = Vec3::new(0.4, 0.35, 1.0).normalize();
        let right = Vec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        // Far enough back that each corner of the box lies within the frame.
        let distance = bounds
            .corners()
            .map(|corner| {
                let p = corner - center;
                let half_extent = (p.dot(right).abs() / WIDTH_TO_HEIGHT).max(p.dot(up).abs());
                half_extent * MARGIN / TAN_HALF_FOV + p.dot(backward)
            })
            .into_iter()
            .fold(1e-3, f32::max);
        let fov_y_rad = 2.0 * TAN_HALF_FOV.atan();
        let mut camera = Camera::look_at(center + backward * distance, center, Vec3::Y, fov_y_rad);
        camera.name = "overview".to_owned();
        if let crate::Projection::Perspective { near_m, .. } = &mut camera.projection {
            *near_m = distance * 0.002;
        }
        camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene_of_box(min: Vec3, max: Vec3) -> Scene {
        let object = Object {
            name: "box".to_owned(),
            node: 0,
            element: 0,
            visible: true,
            occluder: None,
            set: None,
            bounds: Aabb { min, max },
            instances: 0..0,
        };
        Scene {
            objects: vec![object],
            ..Scene::default()
        }
    }

    #[test]
    fn the_overview_camera_frames_the_scene() {
        for size in [
            Vec3::new(10.0, 1.0, 3.0),
            Vec3::new(1.0, 20.0, 1.0),
            Vec3::splat(1e-3),
            Vec3::splat(1e5),
        ] {
            let scene = scene_of_box(Vec3::splat(7.0), Vec3::splat(7.0) + size);
            let clip_from_world = scene.overview_camera().clip_from_world(1.2);
            let corners = scene
                .bounds()
                .corners()
                .map(|c| clip_from_world.project_point3(c));
            let extent = corners
                .iter()
                .map(|c| c.x.abs().max(c.y.abs()))
                .fold(0.0, f32::max);
            assert!((0.85..1.0).contains(&extent), "{size}: {extent}");
            assert!(
                corners.iter().all(|c| (0.0..1.0).contains(&c.z)),
                "{size}: {corners:?}"
            );
        }
    }

    #[test]
    fn an_instance_of_what_is_missing_draws_and_hides_nothing() {
        let mut scene = scene_of_box(Vec3::ZERO, Vec3::ONE);
        let instance = Instance {
            mesh: 0,
            material: 0,
            object: 3,
            world_from_object: Mat4::IDENTITY,
            bounds: Aabb::EMPTY,
        };
        scene.instances.push(instance);
        let counts = |s: &Scene| [s.triangle_count(), s.line_count(), s.point_count()];
        assert_eq!(counts(&scene), [0; 3]);
        assert!(!scene.can_occlude(&instance) && scene.is_visible(&instance));
        scene.meshes.push(Mesh {
            indices: vec![0; 3],
            lines: vec![[0; 2]; 2],
            points: vec![0; 5],
            ..Mesh::default()
        });
        assert_eq!(counts(&scene), [1, 2, 5]);
        assert!(!scene.can_occlude(&instance));
        scene.materials.push(Material::default());
        assert!(scene.can_occlude(&instance));
    }

    #[test]
    fn a_scene_without_geometry_has_an_overview_too() {
        assert!(Scene::default().overview_camera().eye().is_finite());
    }

    #[test]
    fn a_sun_rises_only_where_there_is_no_light() {
        let mut scene = Scene::default();
        assert!(scene.light_by_default());
        assert!(!scene.light_by_default());
        assert_eq!(scene.lights.len(), 1);
    }
}
