//! A scene on the device: geometry, textures, materials, instances, lights.

mod bindings;
#[cfg(test)]
mod blocks_tests;
mod families;
mod geometry;
mod indices;
mod instances;
mod lobes;
mod material_uniform;
mod materials;
mod numbers;
#[cfg(test)]
mod posed_tests;
mod provoking;
mod samplers;
mod strokes;
mod textures;
mod uploads;

pub(crate) use bindings::{BoundEnvironment, FrameBindings};
#[cfg(test)]
pub(crate) use families::FamilyUniform;
pub(crate) use families::{FAMILY_BYTES, MaterialDispatch, family_layout};
use geometry::MeshRange;
#[cfg(test)]
pub(crate) use geometry::PlaceUniform;
pub(crate) use geometry::{SceneGeometry, VERTEX_LAYOUTS, geometry_layout};
use indices::check_indices;
pub(crate) use instances::InstanceUniform;
pub(crate) use lobes::LobeClass;
#[cfg(test)]
pub(crate) use lobes::LobesUniform;
pub(crate) use material_uniform::MaterialUniform;
pub(crate) use materials::{SceneMaterials, lobes_layout, material_layout};
use numbers::check_numbers;
pub(crate) use textures::ArrayLimits;

use std::borrow::Cow;

use foveal_scene::{Aabb, AlphaMode, Environment, ImageLight, Light, Scene, Texture};
use glam::Mat4;

use crate::culling::CullingScene;
use crate::gpu::{Gpu, Table};
use crate::lights::{LightUniform, LightsHeader, MAX_LIGHTS};
use crate::{Error, SceneStats, Settings};

/// One instance as drawing sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnInstance {
    pub(crate) mesh: u32,
    pub(crate) material: u32,
    pub(crate) object: u32,
    pub(crate) bounds: Aabb,
    /// Its object is drawn.
    pub(crate) visible: bool,
    /// Its transform turns front faces into clockwise ones.
    pub(crate) mirrored: bool,
    pub(crate) alpha_mode: AlphaMode,
    pub(crate) double_sided: bool,
    /// Its material emits light.
    pub(crate) glows: bool,
    /// `material_class` of its material.
    pub(crate) material_class: u32,
}

/// Everything of a scene that outlives a frame.
#[derive(Debug)]
pub(crate) struct SceneOnGpu {
    pub(crate) geometry: SceneGeometry,
    pub(crate) materials: SceneMaterials,
    pub(crate) instances: Vec<DrawnInstance>,
    /// At the exposure that they are seen at.
    pub(crate) lights: Vec<LightUniform>,
    /// As the scene has them.
    lights_of_scene: Vec<Light>,
    exposure_stops: f32,
    pub(crate) light_table: Table,
    pub(crate) environment: Environment,
    /// Its own, where it has one.
    pub(crate) image_light: Option<ImageLight>,
    /// The box around all that casts or receives shadows.
    pub(crate) bounds: Aabb,
    /// From corner to corner of that box as the scene was set, in metres; poses do not change it.
    pub(crate) diagonal_m: f32,
    pub(crate) stats: SceneStats,
    pub(crate) culling: CullingScene,
    uniforms: Vec<InstanceUniform>,
    /// Whether anything may have moved with the last pose.
    in_motion: bool,
    /// Whether a frame has shown the pose.
    pub(crate) is_shown: bool,
}

/// What a new pose differs in from the one before.
#[derive(Debug)]
pub(crate) struct PoseChange {
    /// Anything has moved, now or a pose before.
    pub(crate) moves: bool,
    /// No frame has shown the pose before, with which things had moved: motion is not what it is since
    /// the last frame.
    pub(crate) skips: bool,
    /// Around each instance that casts shadows, now or before, and has moved, may have changed its
    /// shape or its holes, has appeared or disappeared: where it was and is.
    pub(crate) boxes: Vec<Aabb>,
    /// Around each instance whose material treats light otherwise: centre and radius in metres,
    /// world space.
    pub(crate) places: Vec<[f32; 4]>,
    pub(crate) lights_before: Vec<LightUniform>,
}

impl SceneOnGpu {
    /// Uploads `scene` with these textures, of which its own may have lost their texels.
    ///
    /// # Errors
    /// [`Error::Scene`] where an index names nothing, a number is not finite, or the environment
    /// lacks texels;
    /// [`Error::Limit`], [`Error::NoTexels`].
    pub(crate) fn new(
        gpu: &Gpu,
        scene: &Scene,
        textures: Vec<Cow<'_, Texture>>,
        settings: &Settings,
        material_layout: &wgpu::BindGroupLayout,
        limits: ArrayLimits,
    ) -> Result<Self, Error> {
        check_lights(scene)?;
        check_indices(scene)?;
        check_numbers(scene)?;
        let exposure_stops = settings.picture.exposure_stops;
        let lights = LightUniform::all(&scene.lights, exposure_stops);
        let light_table = table_of_lights(gpu, &lights);
        let materials =
            SceneMaterials::new(gpu, scene, textures, settings, material_layout, limits)?;
        let material_families = materials.families().count() as u64;
        let texture_bytes = materials.texture_bytes();
        let geometry = SceneGeometry::new(gpu, scene, materials.families().ranks())?;
        let bounds = shadowed_bounds(scene, &geometry.meshes);
        Ok(Self {
            bounds,
            diagonal_m: (bounds.max - bounds.min).length(),
            geometry,
            instances: drawn_instances(scene, &materials),
            materials,
            lights,
            lights_of_scene: scene.lights.clone(),
            exposure_stops,
            light_table,
            environment: scene.environment,
            image_light: scene.image_light.clone(),
            culling: CullingScene::new(scene, settings),
            stats: SceneStats {
                meshes: scene.meshes.len() as u64,
                materials: scene.materials.len() as u64,
                material_families,
                textures: scene.textures.len() as u64,
                texture_bytes,
                objects: scene.objects.len() as u64,
                instances: scene.instances.len() as u64,
                triangles: scene.triangle_count(),
                lines: scene.line_count(),
                points: scene.point_count(),
                lights: scene.lights.len() as u64,
            },
            uniforms: scene
                .instances
                .iter()
                .map(|i| InstanceUniform::still(i.world_from_object))
                .collect(),
            in_motion: false,
            is_shown: false,
        })
    }

    /// Refuses poses of scenes other than the one that is here, and those with numbers that are not
    /// finite.
    pub(crate) fn check_pose(&self, scene: &Scene) -> Result<(), Error> {
        check_lights(scene)?;
        let other = |difference: String| Err(Error::OtherScene { difference });
        let stats = &self.stats;
        for (what, found, expected) in [
            ("meshes", scene.meshes.len(), stats.meshes),
            ("materials", scene.materials.len(), stats.materials),
            ("objects", scene.objects.len(), stats.objects),
            ("instances", scene.instances.len(), stats.instances),
        ] {
            if found as u64 != expected {
                return other(format!("it has {found} {what} in place of {expected}"));
            }
        }
        for (i, (now, before)) in scene.instances.iter().zip(&self.instances).enumerate() {
            let parts = [
                ("mesh", now.mesh, before.mesh),
                ("material", now.material, before.material),
                ("object", now.object, before.object),
            ];
            if let Some((what, found, expected)) = parts.iter().find(|(_, a, b)| a != b) {
                return other(format!(
                    "instance {i} has the {what} {found} in place of {expected}"
                ));
            }
        }
        let mut pairs = scene.meshes.iter().zip(&self.geometry.meshes).enumerate();
        let otherwise = pairs.find_map(|(i, (mesh, range))| Some((i, range.differs_from(mesh)?)));
        if let Some((i, how)) = otherwise {
            return other(format!("mesh {i} {how}"));
        }
        check_numbers(scene)
    }

    /// Takes over a new pose of the same scene; the pose so far becomes the previous one.
    pub(crate) fn update_pose(&mut self, gpu: &Gpu, scene: &Scene) -> PoseChange {
        let skips = self.in_motion && !self.is_shown;
        let changes = self.materials.update(gpu, &scene.materials);
        let mut moves = self.geometry.deforms() || changes.iter().any(|c| c.is_other);
        let (mut boxes, mut places) = (Vec::new(), Vec::new());
        let mut instances = drawn_instances(scene, &self.materials);
        for (now, before) in instances.iter_mut().zip(&self.instances) {
            now.alpha_mode = before.alpha_mode;
            now.double_sided = before.double_sided;
        }
        let pairs = self.uniforms.iter_mut().zip(&scene.instances);
        let drawn = self.instances.iter().zip(&instances);
        for ((uniform, instance), (before, now)) in pairs.zip(drawn) {
            let moved = uniform.moved_to(instance.world_from_object);
            moves |= bytemuck::bytes_of(&moved) != bytemuck::bytes_of(uniform);
            *uniform = moved;
            if !before.visible && !now.visible {
                continue;
            }
            let change = changes.get(instance.material as usize);
            let change = change.copied().unwrap_or_default();
            let mesh = &scene.meshes[instance.mesh as usize];
            let is_masked = matches!(before.alpha_mode, AlphaMode::Mask { .. });
            let appears = before.visible != now.visible;
            moves |= appears;
            let is_elsewhere = moved.is_elsewhere() || mesh.deforms;
            let casts_otherwise = appears || before.glows != now.glows || is_masked && change.holes;
            let casts = before.alpha_mode != AlphaMode::Blend && mesh.triangle_count() > 0;
            let around = before.bounds.union(instance.bounds);
            if !around.is_valid() {
                continue;
            }
            if (is_elsewhere || casts_otherwise) && casts {
                boxes.push(around);
            }
            // What is blended keeps no light from frame to frame.
            if change.is_lit_otherwise && before.alpha_mode != AlphaMode::Blend {
                // Corners are not to be missed by rounding.
                let radius = around.half_extent().length() * 1.001;
                places.push(around.center().extend(radius).to_array());
            }
        }
        self.bounds = shadowed_bounds(scene, &self.geometry.meshes);
        self.instances = instances;
        self.lights_of_scene.clone_from(&scene.lights);
        let lights_before = std::mem::take(&mut self.lights);
        self.upload_lights(gpu);
        self.geometry.update_pose(gpu, scene);
        self.culling.update_pose(scene);
        self.in_motion =
            self.geometry.deforms() || self.uniforms.iter().any(InstanceUniform::is_elsewhere);
        self.is_shown = false;
        PoseChange {
            moves,
            skips,
            boxes,
            places,
            lights_before,
        }
    }

    /// Lights the scene for an exposure in stops: more shows where lights without a range end.
    pub(crate) fn expose(&mut self, gpu: &Gpu, exposure_stops: f32) {
        if exposure_stops != self.exposure_stops {
            self.exposure_stops = exposure_stops;
            self.upload_lights(gpu);
        }
    }

    fn upload_lights(&mut self, gpu: &Gpu) {
        self.lights = LightUniform::all(&self.lights_of_scene, self.exposure_stops);
        write_lights(gpu, &mut self.light_table, &self.lights);
    }

    /// The next frame shows the pose again that a frame has shown: nothing moves any more. Whether
    /// anything did.
    pub(crate) fn end_motion(&mut self, gpu: &Gpu) -> bool {
        if !(self.is_shown && std::mem::take(&mut self.in_motion)) {
            return false;
        }
        for uniform in &mut self.uniforms {
            *uniform = InstanceUniform::still(uniform.world_from_object());
        }
        self.geometry.end_motion(gpu);
        true
    }

    /// Brings the cells that may receive shadows to the pose.
    pub(crate) fn place_cells(&mut self) {
        let instances = self.instances.iter().map(|i| i.bounds);
        let places = self.uniforms.iter().map(|u| u.world_from_object());
        self.culling.place_cells(instances.zip(places));
    }

    /// Uploads lights and materials once more: where a call failed, theirs may have been refused.
    /// The lights' table may be invalid, where it was to grow.
    pub(crate) fn write_posed(&mut self, gpu: &Gpu) {
        self.light_table = table_of_lights(gpu, &self.lights);
        self.materials.write_all(gpu);
    }

    /// The instances as the vertex shader reads them.
    pub(crate) fn instance_uniforms(&self) -> &[InstanceUniform] {
        &self.uniforms
    }
}

fn table_of_lights(gpu: &Gpu, lights: &[LightUniform]) -> Table {
    let mut table = Table::new(gpu, "lights");
    write_lights(gpu, &mut table, lights);
    table
}

fn write_lights(gpu: &Gpu, table: &mut Table, lights: &[LightUniform]) {
    let header = LightsHeader::new(lights);
    let mut bytes = bytemuck::bytes_of(&header).to_vec();
    // A binding must hold one light, even where there is none.
    let none = [LightUniform::default()];
    let lights = if lights.is_empty() { &none } else { lights };
    bytes.extend_from_slice(bytemuck::cast_slice(lights));
    table.write(gpu, &bytes);
}

/// The box around all that is visible, but points and lines that are not lit: no shadow comes from them or falls on
/// them.
fn shadowed_bounds(scene: &Scene, meshes: &[MeshRange]) -> Aabb {
    let takes_part = |mesh: &MeshRange| mesh.index_count > 0 || mesh.lights_strokes;
    (scene.instances.iter())
        .filter(|instance| scene.is_visible(instance))
        .filter(|instance| takes_part(&meshes[instance.mesh as usize]))
        .filter(|instance| instance.bounds.is_valid())
        .fold(Aabb::EMPTY, |all, instance| all.union(instance.bounds))
}

fn check_lights(scene: &Scene) -> Result<(), Error> {
    let what = "the scene's number of lights";
    Error::if_above(MAX_LIGHTS as u64, what, scene.lights.len())
}

fn drawn_instances(scene: &Scene, materials: &SceneMaterials) -> Vec<DrawnInstance> {
    scene
        .instances
        .iter()
        .map(|i| {
            let material = &scene.materials[i.material as usize];
            DrawnInstance {
                mesh: i.mesh,
                material: i.material,
                object: i.object,
                bounds: i.bounds,
                visible: scene.is_visible(i),
                mirrored: is_mirrored(i.world_from_object),
                alpha_mode: material.alpha_mode,
                double_sided: material.double_sided,
                glows: material.emissive != glam::Vec3::ZERO,
                material_class: materials.class(i.material),
            }
        })
        .collect()
}

fn is_mirrored(world_from_object: Mat4) -> bool {
    let [x, y, z] = [
        world_from_object.x_axis,
        world_from_object.y_axis,
        world_from_object.z_axis,
    ]
    .map(|c| c.truncate());
    x.dot(y.cross(z)) < 0.0
}
