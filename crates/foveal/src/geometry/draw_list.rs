//! Which draws a frame issues, and in which order.

use std::collections::BTreeMap;

use foveal_scene::{Aabb, AlphaMode, Camera, Projection};
use glam::Vec3;

use super::{Faces, PipelineKey, Shape};
use crate::scene::{DrawnInstance, LobeClass, SceneOnGpu};
use crate::stereo::Drawn;

/// One draw: equal meshes with equal materials, `count` instances from `first` in
/// [`DrawList::drawn`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Batch {
    pub(crate) key: PipelineKey,
    pub(crate) material: u32,
    pub(crate) mesh: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// The draws of one frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawList {
    /// Instance numbers in draw order.
    pub(crate) drawn: Vec<u32>,
    /// Opaque and masked surfaces: front to back by [`Nearness`], within it with the fewest state
    /// changes.
    pub(crate) solid: Vec<Batch>,
    /// Those of `solid` that have lobes, which are shaded in a pass over what the G-buffer shows.
    pub(crate) lobed: Vec<Batch>,
    /// Opaque and masked points and lines, which are not in the G-buffer.
    pub(crate) strokes: Vec<Batch>,
    /// Surfaces that light passes, which are not in the G-buffer.
    pub(crate) transmissive: Vec<Batch>,
    /// Blended surfaces, points and lines, back to front.
    pub(crate) blended: Vec<Batch>,
    /// Triangles of all draws.
    pub(crate) triangles: u64,
}

/// The pipeline's key for an instance's points and lines. Lobes need a surface's tangents: they have
/// none.
fn key_of_strokes(instance: &DrawnInstance, lit: bool) -> PipelineKey {
    PipelineKey {
        class: instance.material_class,
        masked: matches!(instance.alpha_mode, AlphaMode::Mask { .. }),
        mirrored: false,
        faces: Faces::Both,
        lobes: LobeClass::default(),
        shape: if lit {
            Shape::LitStrokes
        } else {
            Shape::UnlitStrokes
        },
    }
}

/// How far from the eye an instance's box ends, in steps of a factor of 2. What is drawn from small
/// to large hides what is behind before that is shaded: what ends near is near, whereas what begins
/// near may be the ground. By an instance alone, so that what else is drawn does not change the
/// order of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Nearness(u32);

impl Nearness {
    fn of(bounds: &Aabb, eye: Vec3) -> Self {
        let farthest = (eye - bounds.min).abs().max((eye - bounds.max).abs());
        // The exponent of a square, which is not negative: two of its steps are a factor of 2.
        Self(farthest.length_squared().to_bits() >> 24)
    }
}

/// What blended things are sorted by, from large to small: the depth of a box's centre in a parallel
/// projection, its squared distance from the eye in a perspective.
fn farness(bounds: &Aabb, camera: &Camera) -> f32 {
    let away = bounds.center() - camera.eye();
    match camera.projection {
        Projection::Perspective { .. } => away.length_squared(),
        Projection::Orthographic { .. } => -away.dot(camera.world_from_view.z_axis.truncate()),
    }
}

/// A scene and what a frame draws of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draws<'a> {
    pub(crate) scene: &'a SceneOnGpu,
    pub(crate) list: &'a DrawList,
}

impl DrawList {
    /// Lists the draws of the instances of `scene` whose object `is_visible`, seen by `camera`;
    /// where they `merge`, equal ones become instances of one draw.
    pub(crate) fn build(
        &mut self,
        scene: &SceneOnGpu,
        camera: &Camera,
        merge: bool,
        is_visible: impl Fn(u32) -> bool,
    ) {
        self.drawn.clear();
        self.solid.clear();
        self.lobed.clear();
        self.strokes.clear();
        self.transmissive.clear();
        self.blended.clear();
        self.triangles = 0;
        let mut solid: Vec<(Nearness, PipelineKey, u32, u32, u32)> =
            Vec::with_capacity(scene.instances.len());
        let mut strokes: Vec<(PipelineKey, u32, u32, u32)> = Vec::new();
        let mut blended: Vec<(f32, u32, Shape)> = Vec::new();
        let all = (0..).zip(&scene.instances);
        for (index, instance) in all.filter(|(_, instance)| instance.visible) {
            let mesh = scene.geometry.mesh(instance.mesh);
            let farness = || farness(&instance.bounds, camera);
            // They reach beyond their boxes by half their width, so culling does not judge them.
            if mesh.stroke_index_count > 0 {
                let key = key_of_strokes(instance, mesh.lights_strokes);
                if instance.alpha_mode == AlphaMode::Blend {
                    blended.push((farness(), index, key.shape));
                } else {
                    strokes.push((key, instance.material, instance.mesh, index));
                }
            }
            if mesh.index_count == 0 || !is_visible(instance.object) {
                continue;
            }
            match instance.alpha_mode {
                AlphaMode::Opaque | AlphaMode::Mask { .. } => {
                    let key = PipelineKey {
                        class: instance.material_class,
                        masked: matches!(instance.alpha_mode, AlphaMode::Mask { .. }),
                        mirrored: instance.mirrored,
                        faces: if instance.double_sided {
                            Faces::Both
                        } else {
                            Faces::Front
                        },
                        lobes: LobeClass::default(),
                        shape: Shape::Triangles,
                    };
                    let nearness = Nearness::of(&instance.bounds, camera.eye());
                    solid.push((nearness, key, instance.material, instance.mesh, index));
                }
                AlphaMode::Blend => blended.push((farness(), index, Shape::Triangles)),
            }
        }
        solid.sort_unstable();
        let batch = |(key, material, mesh, index)| Batch {
            key,
            material,
            mesh,
            first: 0,
            count: index,
        };
        let Self {
            solid: list,
            drawn,
            triangles,
            ..
        } = self;
        let lobes = |material| scene.materials.lobes(material);
        for &(_, key, material, mesh, index) in &solid {
            if !lobes(material).is_some_and(LobeClass::transmits) {
                let one = batch((key, material, mesh, index));
                Self::push(list, drawn, scene, merge, triangles, one);
            }
        }
        // One list after the other: a draw's instances follow each other in `drawn`.
        for (transmits, to) in [(false, &mut self.lobed), (true, &mut self.transmissive)] {
            for &(_, key, material, mesh, index) in &solid {
                if let Some(lobes) = lobes(material)
                    && lobes.transmits() == transmits
                {
                    let one = batch((PipelineKey { lobes, ..key }, material, mesh, index));
                    Self::push(to, drawn, scene, merge, triangles, one);
                }
            }
        }
        strokes.sort_unstable();
        for one in strokes {
            Self::push(
                &mut self.strokes,
                drawn,
                scene,
                merge,
                triangles,
                batch(one),
            );
        }
        blended.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, index, shape) in blended {
            let instance = &scene.instances[index as usize];
            if shape != Shape::Triangles {
                let key = key_of_strokes(instance, shape == Shape::LitStrokes);
                let one = batch((key, instance.material, instance.mesh, index));
                let to = &mut self.blended;
                Self::push(to, &mut self.drawn, scene, merge, &mut self.triangles, one);
                continue;
            }
            // The far side of a two-sided thing lies behind its near side.
            let sides: &[Faces] = if instance.double_sided {
                &[Faces::Back, Faces::Front]
            } else {
                &[Faces::Front]
            };
            for &faces in sides {
                let key = PipelineKey {
                    class: instance.material_class,
                    masked: false,
                    mirrored: instance.mirrored,
                    faces,
                    // What is behind shows by alpha.
                    lobes: (scene.materials.lobes(instance.material))
                        .map_or_else(LobeClass::default, LobeClass::without_transmission),
                    shape: Shape::Triangles,
                };
                Self::push(
                    &mut self.blended,
                    &mut self.drawn,
                    scene,
                    merge,
                    &mut self.triangles,
                    Batch {
                        key,
                        material: instance.material,
                        mesh: instance.mesh,
                        first: 0,
                        count: index,
                    },
                );
            }
        }
    }

    /// Whether anything is drawn forward.
    pub(crate) fn has_forward(&self) -> bool {
        !(self.strokes.is_empty() && self.lobed.is_empty() && self.blended.is_empty())
    }

    /// Lists the draws of instances of which only the depth matters; `key` is the pipeline's for a
    /// material's class, and whether alpha cuts holes.
    pub(crate) fn of_casters(
        scene: &SceneOnGpu,
        instances: impl Iterator<Item = u32>,
        key: impl Fn(u32, bool) -> PipelineKey,
    ) -> Self {
        let mut casters: Vec<_> = instances
            .filter(|&index| {
                let mesh = scene.instances[index as usize].mesh;
                scene.geometry.mesh(mesh).index_count > 0
            })
            .map(|index| {
                let instance = &scene.instances[index as usize];
                let masked = matches!(instance.alpha_mode, AlphaMode::Mask { .. });
                // What has no holes is drawn alike whatever its material.
                let material = if masked { instance.material } else { 0 };
                let key = key(instance.material_class, masked);
                (key, material, instance.mesh, index)
            })
            .collect();
        casters.sort_unstable();
        let mut list = Self::default();
        for (key, material, mesh, index) in casters {
            let batch = Batch {
                key,
                material,
                mesh,
                first: 0,
                count: index,
            };
            let (solid, drawn, triangles) = (&mut list.solid, &mut list.drawn, &mut list.triangles);
            Self::push(solid, drawn, scene, true, triangles, batch);
        }
        list
    }

    /// Appends one instance (`batch.count` is its number), to the last draw where that is alike.
    fn push(
        list: &mut Vec<Batch>,
        drawn: &mut Vec<u32>,
        scene: &SceneOnGpu,
        merge: bool,
        triangles: &mut u64,
        batch: Batch,
    ) {
        if batch.key.shape == Shape::Triangles {
            *triangles += u64::from(scene.geometry.mesh(batch.mesh).index_count / 3);
        }
        let instance = batch.count;
        match list.last_mut() {
            Some(last)
                if merge
                    && last.first + last.count == drawn.len() as u32
                    && (last.key, last.material, last.mesh)
                        == (batch.key, batch.material, batch.mesh) =>
            {
                last.count += 1;
            }
            _ => list.push(Batch {
                first: drawn.len() as u32,
                count: 1,
                ..batch
            }),
        }
        drawn.push(instance);
    }

    /// Issues `batches` into a pass that has bind group 0 and the geometry bound, `drawn` for one
    /// eye or both.
    pub(crate) fn issue(
        batches: &[Batch],
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneOnGpu,
        pipelines: &super::Pipelines,
        drawn: Drawn,
    ) {
        Self::issue_with(batches, pass, scene, |key| pipelines.get(key), false, drawn);
    }

    /// As [`DrawList::issue`], with the pipeline that each key gets; `pulled`: the shader fetches
    /// the vertices, by provoking indices.
    pub(crate) fn issue_with<'p>(
        batches: &[Batch],
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneOnGpu,
        pipeline: impl Fn(PipelineKey) -> &'p wgpu::RenderPipeline,
        pulled: bool,
        drawn: Drawn,
    ) {
        let (mut key, mut material) = (None, None);
        for batch in batches {
            if key != Some(batch.key) {
                key = Some(batch.key);
                pass.set_pipeline(pipeline(batch.key));
            }
            if material != Some(batch.material) {
                material = Some(batch.material);
                let materials = &scene.materials;
                let group = if batch.key.lobes == LobeClass::default() {
                    materials.group(batch.material)
                } else {
                    materials.group_with_lobes(batch.material)
                };
                pass.set_bind_group(1, group, &[]);
            }
            let mesh = scene.geometry.mesh(batch.mesh);
            let instances = drawn.range(batch.first, batch.count);
            if pulled {
                pass.draw_indexed(mesh.provoking_indices(), 0, instances);
            } else {
                let indices = mesh.indices(batch.key.shape != Shape::Triangles);
                pass.draw_indexed(indices, mesh.index_base, instances);
            }
        }
    }

    /// Materials of the solid draws with their classes, each once.
    pub(crate) fn solid_materials(&self) -> BTreeMap<u32, u32> {
        let draws = self.solid.iter();
        draws.map(|b| (b.material, b.key.class)).collect()
    }

    /// Families of the solid draws' materials with their classes, each once.
    pub(crate) fn solid_families(&self, scene: &SceneOnGpu) -> BTreeMap<u32, u32> {
        let families = scene.materials.families();
        let draws = self.solid.iter();
        draws
            .map(|b| (families.of(b.material), b.key.class))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_near_is_nearer_than_the_ground_below_the_eye() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        let around = |half: Vec3, away: Vec3| Aabb {
            min: eye + away - half,
            max: eye + away + half,
        };
        let nearness = |half, away| Nearness::of(&around(half, away), eye);
        let small = nearness(Vec3::splat(0.5), Vec3::X * 2.0);
        let ground = nearness(Vec3::new(50.0, 0.1, 50.0), -2.0 * Vec3::Y);
        assert!(small < ground);
        // Within a factor of 2 state changes decide.
        let farther = |by: f32| nearness(Vec3::ZERO, Vec3::Z * by);
        assert_eq!(farther(2.9), farther(5.5));
        assert!(farther(2.7) < farther(2.9) && farther(5.5) < farther(5.8));
    }

    #[test]
    fn two_draws_keep_their_order_whatever_else_is_drawn() {
        let scene = foveal_generate::by_name("demo:1000").unwrap();
        let renderer =
            crate::testing::rendered(&scene, &scene.cameras[0], &crate::testing::small(16, 16));
        let scene_on_gpu = renderer.scene();
        let order = |is_visible: &dyn Fn(u32) -> bool| {
            let mut list = DrawList::default();
            list.build(scene_on_gpu, &scene.cameras[0], true, is_visible);
            list.drawn
        };
        let all = order(&|_| true);
        let some = order(&|object| object % 3 == 0);
        let expected: Vec<u32> = all.iter().copied().filter(|i| some.contains(i)).collect();
        assert!(some.len() < all.len() && !some.is_empty());
        assert_eq!(some, expected);
    }

    #[test]
    fn merged_draws_hold_their_own_instances_where_glass_and_coats_alternate() {
        let all = foveal_generate::lobes().materials;
        let coated = all
            .iter()
            .find(|m| m.clearcoat.is_some() && m.transmission.is_none());
        let glass = all.iter().find(|m| m.transmission.is_some());
        let plain = |of: Option<&foveal_scene::Material>| foveal_scene::Material {
            clearcoat: of.and_then(|m| m.clearcoat),
            transmission: of.and_then(|m| m.transmission),
            ..foveal_scene::Material::default()
        };
        let materials = vec![plain(coated), plain(glass)];
        let depths = [-2.0, -4.0, -8.0, -16.0, -32.0, -64.0];
        let mut scene = crate::forward::twin::quads(materials, &depths);
        for (instance, material) in scene.instances.iter_mut().zip([0, 1].into_iter().cycle()) {
            instance.material = material;
        }
        let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
        let settings = crate::testing::small(16, 16);
        let renderer = crate::testing::rendered(&scene, &camera, &settings);
        let mut list = DrawList::default();
        list.build(renderer.scene(), &camera, true, |_| true);
        for batches in [&list.lobed, &list.transmissive] {
            let mut count = 0;
            for batch in batches {
                for i in batch.first..batch.first + batch.count {
                    let instance = &scene.instances[list.drawn[i as usize] as usize];
                    assert_eq!(instance.material, batch.material);
                    count += 1;
                }
            }
            assert_eq!(count, 3);
        }
    }

    #[test]
    fn parallel_cameras_sort_what_is_blended_by_its_depth() {
        use glam::{Mat4, Vec4};
        let pane = |color| foveal_scene::Material {
            base_color: color,
            alpha_mode: AlphaMode::Blend,
            unlit: true,
            ..foveal_scene::Material::default()
        };
        let (red, green) = (Vec4::new(1.0, 0.0, 0.0, 0.5), Vec4::new(0.0, 1.0, 0.0, 0.5));
        let mut scene = crate::forward::twin::quads(vec![pane(red), pane(green)], &[0.0, -1.0]);
        // The nearer one is to the side, so that its centre is farther from the eye.
        let places = [(Vec3::X * 8.0, 4.0), (-Vec3::Z, 6.0)];
        for (instance, (at, scale)) in scene.instances.iter_mut().zip(places) {
            let scaled = Mat4::from_scale(Vec3::splat(scale));
            instance.world_from_object = Mat4::from_translation(at) * scaled;
            instance.bounds = (scene.meshes[0].bounds).transformed(instance.world_from_object);
            scene.objects[instance.object as usize].bounds = instance.bounds;
        }
        let mut camera = Camera::look_at(Vec3::Z * 10.0, Vec3::ZERO, Vec3::Y, 1.0);
        camera.projection = Projection::Orthographic {
            height_m: 20.0,
            near_m: 0.1,
            far_m: 40.0,
        };
        let settings =
            crate::testing::small(40, 40).with(|s| s.lighting.background = crate::Background::None);
        let renderer = crate::testing::rendered(&scene, &camera, &settings);
        let radiance = crate::testing::texels::<[u16; 4]>(&renderer.targets().radiance_view);
        // Both are seen at x = 5, y = 0: red over green.
        let [r, g, ..] = radiance[20 * 40 + 30].map(crate::testing::f32_of_half);
        assert_eq!([r, g], [0.5, 0.25]);
    }
}
